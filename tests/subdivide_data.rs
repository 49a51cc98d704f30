//! What subdivision does with attributes and user columns.

mod shapes;

use meshwright::glam::{DVec2, DVec3, dvec2, dvec3};
use meshwright::{
    Column, EdgeKey, Event, FaceKey, GroupName, HalfedgeKey, IndexedMesh, Mesh, Outcome, Rule, Scheme,
    SubdivideOptions, VertexKey,
};
use shapes::Noise;
use std::sync::{Arc, Mutex};

const SCHEMES: [Scheme; 4] = [Scheme::Midpoint, Scheme::Loop, Scheme::CatmullClark, Scheme::Sqrt3];

fn fine(mesh: &Mesh, scheme: Scheme, levels: u32) -> Outcome<Mesh> {
    let outcome = mesh.subdivide(SubdivideOptions { scheme, levels, ..Default::default() });
    let outcome = outcome.expect("subdivided");
    assert_eq!(outcome.value.validate(), Ok(()));
    assert_eq!(outcome.report.not_carried, []);
    outcome
}

/// Every scheme at one and two levels, and midpoint on every third face.
fn all_ways(mesh: &Mesh) -> Vec<(String, Mesh)> {
    let mut all = Vec::new();
    for levels in [1, 2] {
        for scheme in SCHEMES {
            all.push((format!("{scheme:?}, {levels}"), fine(mesh, scheme, levels).value));
        }
        let only: Vec<FaceKey> = mesh.faces().step_by(3).collect();
        let options = SubdivideOptions { only: Some(&only), levels, ..Default::default() };
        all.push((format!("some, {levels}"), mesh.subdivide(options).expect("subdivided").value));
    }
    for (name, fine) in &all {
        assert_eq!(fine.validate(), Ok(()), "{name}");
    }
    all
}

fn examples() -> Vec<(&'static str, IndexedMesh)> {
    let pentagon = {
        let corner = |i: u32| {
            let (y, x) = (f64::from(i) * 1.256637).sin_cos();
            dvec3(x, y, 0.0)
        };
        shapes::pool((0..5).map(corner).collect(), vec![(0..5).collect()])
    };
    vec![
        ("cube", shapes::cube()),
        ("grid", shapes::grid(3)),
        ("sphere", shapes::icosphere(1)),
        ("pentagon", pentagon),
        ("two", shapes::both(&shapes::cube(), &shapes::grid(2))),
    ]
}

/// A linear function of position.
fn linear(p: DVec3) -> f64 {
    p.x * 3.0 - p.y * 0.5 + p.z * 2.0 + 1.0
}

struct Columns {
    vertex: Column<VertexKey, f64>,
    corner: Column<HalfedgeKey, f64>,
}

fn with_linear(pool: &IndexedMesh) -> (Mesh, Columns) {
    let mut mesh = shapes::mesh(pool);
    let vertex = mesh.add_vertex_column(0.0, Rule::interpolate());
    let corner = mesh.add_corner_column(0.0, Rule::interpolate());
    for v in mesh.vertices().collect::<Vec<_>>() {
        mesh.set_value(vertex, v, linear(mesh.position(v))).expect("live");
    }
    for h in corners(&mesh) {
        mesh.set_value(corner, h, linear(mesh.position(mesh.origin(h)))).expect("live");
    }
    (mesh, Columns { vertex, corner })
}

fn corners(mesh: &Mesh) -> Vec<HalfedgeKey> {
    mesh.faces().flat_map(|f| mesh.face_halfedges(f)).collect()
}

fn assert_linear(name: &str, mesh: &Mesh, columns: &Columns) {
    let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
    for v in mesh.vertices() {
        assert!(close(*mesh.value(columns.vertex, v), linear(mesh.position(v))), "{name}");
    }
    for h in corners(mesh) {
        assert!(close(*mesh.value(columns.corner, h), linear(mesh.position(mesh.origin(h)))), "{name}");
    }
}

#[test]
fn linear_functions_stay_linear_under_midpoint() {
    for (name, pool) in examples() {
        let (mesh, columns) = with_linear(&pool);
        for levels in 0..4 {
            assert_linear(name, &fine(&mesh, Scheme::Midpoint, levels).value, &columns);
            let only: Vec<FaceKey> = mesh.faces().step_by(2).collect();
            let options = SubdivideOptions { only: Some(&only), levels, ..Default::default() };
            assert_linear(name, &mesh.subdivide(options).expect("subdivided").value, &columns);
        }
    }
}

#[test]
fn values_are_the_mean_of_the_parents_whatever_the_scheme() {
    // What the maps name as parents, each with the same share: the first level is enough to see it.
    for (name, pool) in examples() {
        let (mesh, columns) = with_linear(&pool);
        let old: Vec<VertexKey> = mesh.vertices().collect();
        for scheme in [Scheme::Loop, Scheme::CatmullClark] {
            let outcome = fine(&mesh, scheme, 1);
            if outcome.report.steps.len() > 1 {
                // Cut into triangles first: a vertex on a diagonal has two parents of its face.
                continue;
            }
            for (i, v) in outcome.value.vertices().enumerate() {
                let parents = outcome.maps.vertices.old_of(i);
                let sum: f64 = parents.iter().map(|&p| linear(mesh.position(old[p as usize]))).sum();
                let mean = sum / parents.len() as f64;
                let value = *outcome.value.value(columns.vertex, v);
                assert!((value - mean).abs() < 1e-12, "{name}, {scheme:?}");
            }
        }
    }
}

#[test]
fn corners_that_agree_at_vertices_still_do() {
    for (name, pool) in examples() {
        let (mut mesh, columns) = with_linear(&pool);
        // Any function, and rules that pick.
        let picked = mesh.add_corner_column(0, Rule::keep());
        for h in corners(&mesh) {
            let number = mesh.vertices().position(|v| v == mesh.origin(h)).expect("there");
            mesh.set_value(picked, h, number).expect("live");
        }
        for (way, fine) in all_ways(&mesh) {
            assert!(fine.edges().all(|e| !fine.is_seam(columns.corner, e)), "{name}, {way}");
            // Sqrt3 picks among three corners on each side: the first of its face.
            if !way.starts_with("Sqrt3") {
                let between = |e: &EdgeKey| fine.is_seam(picked, *e);
                let inside = fine.edges().filter(between).count();
                assert_eq!(inside, 0, "{name}, {way}");
            }
            // So vertex and corner hold the same.
            for h in corners(&fine) {
                let of_vertex = *fine.value(columns.vertex, fine.origin(h));
                assert!((fine.value(columns.corner, h) - of_vertex).abs() < 1e-12, "{name}, {way}");
            }
        }
    }
}

/// Gives each face a chart of its own, 10 apart.
fn with_charts(pool: &IndexedMesh) -> Mesh {
    let mut mesh = shapes::mesh(pool);
    for (i, f) in mesh.faces().enumerate().collect::<Vec<_>>() {
        for (k, h) in mesh.face_halfedges(f).enumerate().collect::<Vec<_>>() {
            let (y, x) = (k as f64 * std::f64::consts::TAU / mesh.degree(f) as f64).sin_cos();
            mesh.set_uv(h, Some(dvec2(10.0 * i as f64 + x, y))).expect("finite");
        }
    }
    mesh
}

#[test]
fn every_seam_stays_where_it_is_and_none_is_made() {
    for (name, pool) in examples() {
        let mut mesh = with_charts(&pool);
        let mark = mesh.add_edge_column(false, Rule::keep());
        for e in mesh.edges().collect::<Vec<_>>() {
            mesh.set_value(mark, e, mesh.is_uv_seam(e)).expect("live");
        }
        for (way, fine) in all_ways(&mesh) {
            if !way.starts_with("Sqrt3") {
                for e in fine.edges() {
                    assert_eq!(fine.is_uv_seam(e), *fine.value(mark, e), "{name}, {way}");
                }
            }
            // A part lies in one chart: none reaches across.
            for f in fine.faces() {
                let uvs: Vec<DVec2> = fine.face_halfedges(f).map(|h| fine.uv(h).expect("given")).collect();
                let spread = uvs.iter().flat_map(|a| uvs.iter().map(move |b| a.distance(*b)));
                assert!(spread.fold(0.0, f64::max) <= 3.0, "{name}, {way}: {uvs:?}");
            }
        }
    }
}

#[test]
fn the_charts_of_sqrt3_keep_their_share_and_hang_together() {
    // With a chart on each face, which is the worst there is: all its parts lie across seams, and meet at its centre.
    let mesh = with_charts(&shapes::icosphere(0));
    for levels in [1, 2, 3] {
        let fine = fine(&mesh, Scheme::Sqrt3, levels).value;
        let chart = |h: HalfedgeKey| (fine.uv(h).expect("given").x / 10.0).round() as usize;
        for i in 0..mesh.face_count() {
            let own = |f: &FaceKey| chart(fine.face_halfedge(*f)) == i;
            let parts: Vec<FaceKey> = fine.faces().filter(own).collect();
            assert_eq!(parts.len(), 3usize.pow(levels), "{levels}");
            if levels > 1 {
                continue;
            }
            // Vertices less edges plus faces of a disc.
            let halfedges: Vec<HalfedgeKey> = parts.iter().flat_map(|&f| fine.face_halfedges(f)).collect();
            let mut vertices: Vec<VertexKey> = halfedges.iter().map(|&h| fine.origin(h)).collect();
            let mut edges: Vec<EdgeKey> = halfedges.iter().map(|&h| fine.edge(h)).collect();
            vertices.sort_unstable();
            vertices.dedup();
            edges.sort_unstable();
            edges.dedup();
            assert_eq!(vertices.len() + parts.len(), edges.len() + 1, "{levels}");
        }
    }
}

#[test]
fn a_seam_under_sqrt3_runs_in_a_zigzag_and_both_sides_go_on() {
    // A plane grid in two charts, either side of x = 2; texture coordinates are positions, 100 apart.
    let mut pool = shapes::grid(4);
    pool.map_positions(|p| dvec3(p.x, p.y, 0.0)).expect("finite");
    let mut mesh = shapes::mesh(&pool);
    let is_right =
        |mesh: &Mesh, f: FaceKey| mesh.face_vertices(f).map(|v| mesh.position(v).x).sum::<f64>() / 3.0 > 2.0;
    for h in corners(&mesh) {
        let shift = if is_right(&mesh, mesh.face(h).expect("a corner")) { 100.0 } else { 0.0 };
        let p = mesh.position(mesh.origin(h));
        mesh.set_uv(h, Some(dvec2(p.x + shift, p.y))).expect("finite");
    }
    let fine = fine(&mesh, Scheme::Sqrt3, 1).value;
    assert_eq!(mesh.edges().filter(|&e| mesh.is_uv_seam(e)).count(), 4);
    // From old vertex to old vertex by way of the two centres.
    assert_eq!(fine.edges().filter(|&e| fine.is_uv_seam(e)).count(), 12);
    for h in corners(&fine) {
        let uv = fine.uv(h).expect("given");
        let p = fine.position(fine.origin(h)).truncate();
        let shift = if uv.x > 50.0 { 100.0 } else { 0.0 };
        // A regular grid: the other side is as this one mirrored, so both stay what they were. The scheme moves old ones.
        let is_new = fine.vertices().position(|v| v == fine.origin(h)) >= Some(mesh.vertex_count());
        assert!(!is_new || (uv - dvec2(shift, 0.0)).distance(p) < 1e-12, "{uv} at {p}");
    }
}

#[test]
fn attributes_come_along() {
    let mut mesh = with_charts(&shapes::cube());
    mesh.compute_normals(Default::default());
    for v in mesh.vertices().collect::<Vec<_>>() {
        let p = mesh.position(v).as_vec3();
        mesh.set_color(v, [p.x, p.y, p.z, 1.0]).expect("finite");
    }
    for h in corners(&mesh) {
        let f = mesh.face(h).expect("a corner");
        let normal = mesh.face_normal(f);
        mesh.set_corner_normal(h, Some(normal)).expect("finite");
    }
    let groups: Vec<GroupName> = ["lid", "rest"]
        .map(|name| GroupName { name: name.to_owned(), material: Some("steel".to_owned()) })
        .to_vec();
    for (i, f) in mesh.faces().enumerate().collect::<Vec<_>>() {
        mesh.set_group(f, Some(groups[usize::from(i > 0)].clone())).expect("live");
    }
    for (way, fine) in all_ways(&mesh) {
        assert_eq!(fine.carried_attributes(), mesh.carried_attributes(), "{way}");
        for v in fine.vertices() {
            assert!((fine.normal(v).expect("given").length() - 1.0).abs() < 1e-12, "{way}");
            let color = fine.color(v).expect("given");
            if way.starts_with("Mid") || way.starts_with("some") {
                let p = fine.position(v).as_vec3();
                assert!(
                    (DVec3::from(p) - dvec3(color[0].into(), color[1].into(), color[2].into())).length()
                        < 1e-6
                );
            }
        }
        for h in corners(&fine) {
            let normal = fine.corner_normal(h).expect("given");
            assert!((normal.length() - 1.0).abs() < 1e-12, "{way}");
            if way.starts_with("Mid") {
                let own = fine.face_normal(fine.face(h).expect("a corner"));
                assert!(normal.distance(own) < 1e-12, "{way}: hard edges stay hard");
            }
        }
        let lid = fine.faces().filter(|&f| fine.group(f) == Some(&groups[0])).count();
        let rest = fine.faces().filter(|&f| fine.group(f) == Some(&groups[1])).count();
        assert!(lid > 0 && lid + rest == fine.face_count(), "{way}");
    }
    // And so they reach a file.
    let pool = fine(&mesh, Scheme::Midpoint, 1).value.to_indexed();
    assert_eq!(pool.attributes().kinds().count(), 5);
    assert_eq!(pool.attributes().face_groups.as_ref().expect("carried").of[..5], [0, 0, 0, 0, 1]);
}

#[test]
fn faces_hand_their_value_to_their_parts() {
    for (name, pool) in examples() {
        let mut mesh = shapes::mesh(&pool);
        let part = mesh.add_face_column(0, Rule::keep());
        for (i, f) in mesh.faces().enumerate().collect::<Vec<_>>() {
            mesh.set_value(part, f, i + 1).expect("live");
        }
        for scheme in SCHEMES {
            let outcome = fine(&mesh, scheme, 2);
            for (i, f) in outcome.value.faces().enumerate() {
                let value = *outcome.value.value(part, f) as u32 - 1;
                assert!(outcome.maps.faces.old_of(i).contains(&value), "{name}, {scheme:?}");
            }
        }
    }
}

/// One of each rule on vertices, holding x; and on edges and faces, holding 1.
struct Rules {
    on_vertices: [Column<VertexKey, f64>; 5],
    on_edges: [Column<EdgeKey, f64>; 3],
    on_faces: [Column<FaceKey, f64>; 3],
}

fn with_rules(mesh: &mut Mesh, custom: Rule<f64>) -> Rules {
    let rules = [Rule::keep(), Rule::reset(), Rule::interpolate(), Rule::average(), custom];
    let on_vertices = rules.map(|rule| mesh.add_vertex_column(-1.0, rule));
    let some = || [Rule::keep(), Rule::reset(), Rule::interpolate()];
    let on_edges = some().map(|rule| mesh.add_edge_column(-1.0, rule));
    let on_faces = some().map(|rule| mesh.add_face_column(-1.0, rule));
    for v in mesh.vertices().collect::<Vec<_>>() {
        for &c in &on_vertices {
            mesh.set_value(c, v, mesh.position(v).x).expect("live");
        }
    }
    for e in mesh.edges().collect::<Vec<_>>() {
        for &c in &on_edges {
            mesh.set_value(c, e, 1.0).expect("live");
        }
    }
    for f in mesh.faces().collect::<Vec<_>>() {
        for &c in &on_faces {
            mesh.set_value(c, f, 1.0).expect("live");
        }
    }
    Rules { on_vertices, on_edges, on_faces }
}

#[test]
fn each_rule_is_asked_about_what_is_split() {
    let points = vec![DVec3::ZERO, DVec3::X * 3.0, DVec3::Y, dvec3(6.0, 1.0, 0.0)];
    let mut mesh = shapes::mesh(&shapes::pool(points, vec![vec![0, 1, 2], vec![2, 1, 3]]));
    let rules = with_rules(&mut mesh, Rule::custom(|_, s: &[(&f64, f64)]| 100.0 * s.len() as f64));
    let fine = fine(&mesh, Scheme::Midpoint, 1).value;
    let values = |i: usize| {
        let v = fine.vertices().nth(i).expect("there");
        rules.on_vertices.map(|c| *fine.value(c, v))
    };
    // Old ones keep what they have; the fifth vertex is on the first edge, from 0 to 3.
    assert_eq!(values(1), [3.0; 5]);
    assert_eq!(values(4), [0.0, -1.0, 1.5, 1.5, 200.0]);
    let edge = |i: usize| rules.on_edges.map(|c| *fine.value(c, fine.edges().nth(i).expect("there")));
    let counts = |k: usize, of: f64| (0..fine.edge_count()).filter(|&i| edge(i)[k] == of).count();
    // Five edges in halves, and three within each face.
    assert_eq!([counts(0, 1.0), counts(0, -1.0)], [10, 6]);
    assert_eq!([counts(1, 1.0), counts(1, -1.0)], [0, 16]);
    assert_eq!([counts(2, 1.0), counts(2, -1.0)], [10, 6]);
    for f in fine.faces() {
        assert_eq!(rules.on_faces.map(|c| *fine.value(c, f)), [1.0, -1.0, 1.0]);
    }
}

#[test]
fn what_is_not_cut_keeps_its_values_whatever_the_rule() {
    let mut mesh = shapes::mesh(&shapes::grid(6));
    let rules = with_rules(&mut mesh, Rule::keep());
    let only: Vec<FaceKey> = mesh.faces().take(1).collect();
    let outcome = mesh.subdivide(SubdivideOptions { only: Some(&only), ..Default::default() });
    let outcome = outcome.expect("subdivided");
    let fine = outcome.value;
    for (i, f) in fine.faces().enumerate() {
        let parts = outcome.maps.faces.new_of(outcome.maps.faces.old_of(i)[0] as usize).len();
        let reset = if parts == 1 { 1.0 } else { -1.0 };
        assert_eq!(rules.on_faces.map(|c| *fine.value(c, f)), [1.0, reset, 1.0]);
    }
    let whole = fine.edges().filter(|&e| *fine.value(rules.on_edges[1], e) == 1.0).count();
    assert_eq!(whole, mesh.edge_count() - 3);
}

#[test]
fn a_custom_rule_is_told_of_vertices_that_move() {
    let seen: Arc<Mutex<Vec<(Event, usize)>>> = Arc::default();
    let log = Arc::clone(&seen);
    let rule = Rule::custom(move |event, s: &[(&f64, f64)]| {
        log.lock().expect("one thread").push((event, s.len()));
        *s[0].0
    });
    let mut mesh = shapes::mesh(&shapes::tetrahedron());
    mesh.add_vertex_column(0.0, rule);
    let count = |scheme, event: Event| {
        fine(&mesh, scheme, 1);
        let all = std::mem::take(&mut *seen.lock().expect("one thread"));
        all.iter().filter(|e| e.0 == event).count()
    };
    assert_eq!(count(Scheme::Loop, Event::Move), 4);
    assert_eq!(count(Scheme::Midpoint, Event::Move), 0);
    assert_eq!(count(Scheme::Midpoint, Event::Split), 6);
    assert_eq!(count(Scheme::Sqrt3, Event::Split), 4);
}

#[test]
fn levels_at_once_are_levels_one_by_one_for_columns_too() {
    for (name, pool) in examples() {
        let (mut mesh, columns) = with_linear(&pool);
        let mut noise = Noise(5);
        for v in mesh.vertices().collect::<Vec<_>>() {
            mesh.set_value(columns.vertex, v, noise.unit()).expect("live");
        }
        for scheme in [Scheme::Midpoint, Scheme::Loop, Scheme::CatmullClark] {
            let at_once = fine(&mesh, scheme, 2).value;
            let by_one = fine(&fine(&mesh, scheme, 1).value, scheme, 1).value;
            let sorted = |m: &Mesh| {
                let mut all: Vec<[u64; 4]> = m
                    .vertices()
                    .map(|v| {
                        let p = m.position(v);
                        [p.x, p.y, p.z, *m.value(columns.vertex, v)].map(|x| (x * 1e9).round() as i64 as u64)
                    })
                    .collect();
                all.sort_unstable();
                all
            };
            assert_eq!(sorted(&at_once), sorted(&by_one), "{name}, {scheme:?}");
        }
    }
}

#[test]
fn keys_of_columns_read_the_finer_mesh_and_removed_ones_do_not() {
    let mut mesh = shapes::mesh(&shapes::cube());
    let gone = mesh.add_vertex_column(DVec3::ZERO, Rule::keep());
    let name = mesh.add_vertex_column(String::new(), Rule::keep());
    mesh.remove_column(gone);
    mesh.compute_normals(Default::default());
    let v = mesh.vertices().next().expect("there");
    mesh.set_value(name, v, "here".to_owned()).expect("live");
    let mut fine = fine(&mesh, Scheme::CatmullClark, 1).value;
    let first = fine.vertices().next().expect("there");
    assert_eq!(fine.value(name, first), "here");
    assert!(!fine.has_column(gone));
    // The columns are kept up from here on.
    let h = fine.halfedges().next().expect("there");
    fine.split_edge(fine.edge(h), DVec3::ZERO).expect("always");
    assert_eq!(fine.validate(), Ok(()));
}
