//! Holes filled with triangles: what is filled, what is refused, what stays.

#[path = "../corpus/mod.rs"]
mod corpus;
#[path = "../igl/mod.rs"]
mod igl;
mod large;
#[path = "../shapes/mod.rs"]
mod shapes;

use large::riddle;
use meshwright::cleanup::{CleanOptions, clean};
use meshwright::glam::{DVec2, DVec3, dvec3};
use meshwright::{
    BadOption, Cancelled, Control, FaceKey, FillHolesError, FillHolesOptions, FillMethod, FilledHoles,
    GroupName, HalfedgeKey, HoleRefusal, IndexedMesh, Lineage, Mesh, Progress, Rule, TriangulateHoleError,
};
use proptest::prelude::*;
use shapes::{Noise, both, cube, fanned, grid, icosphere, pool, torus};
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

fn options() -> FillHolesOptions<'static> {
    FillHolesOptions::default()
}

/// Whatever the size of the filler.
fn sheets_too() -> FillHolesOptions<'static> {
    FillHolesOptions { max_area_ratio: f64::INFINITY, ..options() }
}

/// Fills, and checks what holds of every filling.
fn filled(mesh: &mut Mesh, options: FillHolesOptions<'_>) -> FilledHoles {
    let loops = mesh.boundary_loops();
    let (vertices, edges, faces) = (mesh.vertex_count(), mesh.edge_count(), mesh.face_count());
    let account = mesh.fill_holes(options).expect("fills");
    assert_eq!(mesh.validate(), Ok(()));
    assert_eq!(mesh.violations(), []);
    assert_eq!(account.filled.len() + account.refused.len(), loops.len(), "every loop is told");
    assert_eq!(mesh.boundary_loops().len(), account.refused.len());
    assert_eq!(mesh.vertex_count(), vertices, "no vertex is made");
    let (mut new_faces, mut new_edges) = (0, 0);
    for hole in &account.filled {
        let own = loops.iter().find(|l| l.contains(&hole.halfedge)).expect("a loop");
        assert_eq!(own.len(), hole.edges);
        assert!(own.iter().all(|&h| hole.faces.contains(&mesh.face(h).expect("filled"))));
        new_faces += hole.faces.len();
        new_edges += hole.faces.len() - 1;
        let area: f64 = hole.faces.iter().map(|&f| area_of(mesh, f)).sum();
        assert!((area - hole.area).abs() <= 1e-9 * area.max(hole.area), "{area} told as {}", hole.area);
    }
    for hole in &account.refused {
        let own = loops.iter().find(|l| l.contains(&hole.halfedge)).expect("a loop");
        assert_eq!(own.len(), hole.vertices.len());
        let along: Vec<_> = mesh.loop_of(hole.halfedge).map(|h| mesh.origin(h)).collect();
        assert_eq!(along, hole.vertices, "still a boundary");
        assert!(mesh.is_boundary(hole.halfedge));
    }
    assert_eq!([mesh.face_count() - faces, mesh.edge_count() - edges], [new_faces, new_edges]);
    account
}

/// The area of a triangle, or of a flat polygon.
fn area_of(mesh: &Mesh, f: FaceKey) -> f64 {
    let points: Vec<DVec3> = mesh.face_vertices(f).map(|v| mesh.position(v)).collect();
    let fan = points.windows(2).skip(1).map(|w| (w[0] - points[0]).cross(w[1] - points[0]));
    0.5 * fan.sum::<DVec3>().length()
}

fn without(of: &IndexedMesh, gone: impl Fn(u32) -> bool) -> Mesh {
    let faces = of.polygons().iter().zip(0..).filter(|f| !gone(f.1)).map(|f| f.0.to_vec());
    shapes::mesh(&pool(of.positions().to_vec(), faces.collect()))
}

fn reasons(account: &FilledHoles) -> Vec<&HoleRefusal> {
    account.refused.iter().map(|r| &r.reason).collect()
}

fn smallest_hole(mesh: &Mesh) -> HalfedgeKey {
    mesh.boundary_loops().into_iter().min_by_key(Vec::len).expect("a hole")[0]
}

/// Quads between rings of `n` vertices each, from the first ring to the last.
fn tube(rings: &[Vec<DVec3>]) -> IndexedMesh {
    let n = rings[0].len() as u32;
    let quad = |r: u32, i: u32| {
        let j = (i + 1) % n;
        vec![r * n + i, r * n + j, (r + 1) * n + j, (r + 1) * n + i]
    };
    let quads = (0..rings.len() as u32 - 1).flat_map(|r| (0..n).map(move |i| quad(r, i)));
    pool(rings.concat(), quads.collect())
}

fn circle(n: u32, radius: f64, z: f64) -> Vec<DVec3> {
    let angle = |i: u32| f64::from(i) / f64::from(n) * TAU;
    (0..n).map(|i| dvec3(radius * angle(i).cos(), radius * angle(i).sin(), z)).collect()
}

/// A prism over a polygon (counter-clockwise seen from above), without its top.
fn pot(polygon: &[[f64; 2]]) -> Mesh {
    let n = polygon.len() as u32;
    let ring = |z: f64| polygon.iter().map(|p| dvec3(p[0], p[1], z)).collect::<Vec<_>>();
    let walls = tube(&[ring(0.0), ring(1.0)]);
    let faces = walls.polygons().iter().map(<[u32]>::to_vec).chain([(0..n).rev().collect()]);
    shapes::mesh(&pool(walls.positions().to_vec(), faces.collect()))
}

/// The torus of seven vertices, all of them joined.
fn seven() -> IndexedMesh {
    let at = |i: u32| dvec3(f64::from(i).cos() * 3.0, f64::from(i * i % 7), f64::from(i * 3 % 7));
    let faces = (0..7).flat_map(|i| [vec![i, (i + 1) % 7, (i + 3) % 7], vec![i, (i + 3) % 7, (i + 2) % 7]]);
    pool((0..7).map(at).collect(), faces.collect())
}

#[test]
fn a_cube_without_a_face_is_closed_by_two_triangles() {
    let mut mesh = without(&cube(), |f| f == 1);
    let account = filled(&mut mesh, options());
    let hole = &account.filled[0];
    assert_eq!((hole.edges, hole.faces.len(), hole.area, hole.method), (4, 2, 1.0, FillMethod::LeastArea));
    assert_eq!(hole.place, dvec3(0.5, 0.5, 1.0));
    assert_eq!(mesh.closed().expect("closed").volume(), 1.0);
}

#[test]
fn a_missing_quad_comes_back_as_a_quad_if_polygons_are_wanted() {
    let mut mesh = without(&cube(), |f| f == 1);
    let account = filled(&mut mesh, FillHolesOptions { polygon_tolerance: Some(0.0), ..options() });
    assert_eq!((account.filled[0].faces.len(), account.filled[0].method), (1, FillMethod::OneFace));
    assert!(mesh.is_closed() && mesh.faces().all(|f| mesh.degree(f) == 4));
    // A top that is not flat.
    let corner = |&p: &DVec3| p + DVec3::Z * (0.1 * p.x * p.y * p.z);
    let bent = pool(
        cube().positions().iter().map(corner).collect(),
        cube().polygons().iter().map(<[u32]>::to_vec).collect(),
    );
    for (tolerance, degree) in [(0.01, 3), (0.05, 4)] {
        let mut mesh = without(&bent, |f| f == 1);
        let account = filled(&mut mesh, FillHolesOptions { polygon_tolerance: Some(tolerance), ..options() });
        assert_eq!(mesh.degree(account.filled[0].faces[0]), degree, "tolerance {tolerance}");
    }
}

#[test]
fn a_flat_loop_that_crosses_itself_is_not_filled_with_a_polygon() {
    let mut mesh = pot(&[[0., 0.], [4., 4.], [4., 0.], [0., 3.]]);
    let account = filled(&mut mesh, FillHolesOptions { polygon_tolerance: Some(0.1), ..sheets_too() });
    assert_eq!(account.filled[0].faces.len(), 2);
}

#[test]
fn a_hole_of_three_edges_gets_its_triangle_back() {
    let mut mesh = without(&icosphere(1), |f| f == 17);
    let account = filled(&mut mesh, options());
    assert_eq!((account.filled[0].faces.len(), account.filled[0].method), (1, FillMethod::OneFace));
    assert!(mesh.is_closed());
}

#[test]
fn holes_of_any_size_in_a_sphere_are_closed() {
    let sphere = icosphere(3);
    for count in 1..=30 {
        // A patch grown across edges.
        let whole = shapes::mesh(&sphere);
        let faces: Vec<FaceKey> = whole.faces().collect();
        let mut patch = vec![faces[count * 29]];
        let mut at = 0;
        while patch.len() < count {
            for g in whole.face_neighbors(patch[at]) {
                if patch.len() < count && !patch.contains(&g) {
                    patch.push(g);
                }
            }
            at += 1;
        }
        let mut mesh = without(&sphere, |f| patch.contains(&faces[f as usize]));
        let account = filled(&mut mesh, options());
        assert!(mesh.is_closed() && account.refused.is_empty(), "{count} faces gone");
    }
}

#[test]
fn an_l_shaped_hole_is_covered_once() {
    let mut mesh = pot(&[[0., 0.], [3., 0.], [3., 1.], [1., 1.], [1., 3.], [0., 3.]]);
    let account = filled(&mut mesh, options());
    assert!((account.filled[0].area - 5.0).abs() < 1e-12);
    assert!((mesh.closed().expect("closed").volume() - 5.0).abs() < 1e-12);
}

#[test]
fn straight_stretches_give_no_triangle_without_area() {
    let mut mesh = pot(&[
        [0., 0.],
        [0.1, 0.],
        [0.2, 0.],
        [0.3, 0.],
        [1., 0.],
        [1., 0.7],
        [1., 1.],
        [0.9, 1.],
        [0., 1.],
        [0., 0.1],
    ]);
    let account = filled(&mut mesh, options());
    let thin = account.filled[0].faces.iter().filter(|&&f| area_of(&mesh, f) < 1e-9);
    assert_eq!(thin.count(), 0);
}

#[test]
fn the_saddle_takes_the_diagonal_of_less_area() {
    // Two corners high, two low, the high ones further apart.
    let ring = [dvec3(2., 0., 1.), dvec3(0., 1., 0.), dvec3(-2., 0., 1.), dvec3(0., -1., 0.)];
    let low = ring.map(|p| dvec3(p.x, p.y, -3.0));
    let mut mesh = shapes::mesh(&tube(&[low.to_vec(), ring.to_vec()]));
    let account = filled(&mut mesh, options());
    let hole = account.filled.iter().find(|h| h.place.z > 0.0).expect("the upper one");
    // Along the short diagonal: two triangles of base 2 and height sqrt(5).
    assert!((hole.area - 2.0 * 5f64.sqrt()).abs() < 1e-12, "{}", hole.area);
}

#[test]
fn a_tube_gets_two_lids_and_a_torus_cut_open_too() {
    let rings = [circle(20, 1.0, 0.0), circle(20, 1.0, 3.0)];
    let mut mesh = shapes::mesh(&tube(&rings));
    assert_eq!(filled(&mut mesh, options()).filled.len(), 2);
    assert!(mesh.is_closed() && mesh.euler_characteristic() == 2);

    let mut mesh = without(&torus(16, 8), |f| f < 8);
    assert_eq!(filled(&mut mesh, options()).filled.len(), 2);
    assert!(mesh.is_closed() && mesh.euler_characteristic() == 2);
}

#[test]
fn the_least_chord_is_not_taken_if_it_is_an_edge() {
    // A roof: the ridge is an edge already, so its outside is closed the other way: a tetrahedron.
    let points = vec![dvec3(0., 0., 1.), dvec3(1., 0., 1.), dvec3(0.5, -3., 0.), dvec3(0.5, 3., 0.)];
    let mut mesh = shapes::mesh(&pool(points, vec![vec![0, 2, 1], vec![0, 1, 3]]));
    filled(&mut mesh, sheets_too());
    assert!(mesh.is_closed());
    let v: Vec<_> = mesh.vertices().collect();
    assert!(mesh.find_halfedge(v[2], v[3]).is_some());
}

#[test]
fn a_loop_whose_chords_are_all_edges_stays_open_and_one_is_named() {
    let all = seven();
    let mut mesh = without(&all, |f| all.polygons()[f as usize].contains(&0));
    let account = filled(&mut mesh, sheets_too());
    let [HoleRefusal::EdgesInTheWay(e)] = reasons(&account)[..] else { panic!("{account:?}") };
    let h = mesh.edge_halfedge(*e);
    let ends = [mesh.origin(h), mesh.target(h)];
    assert!(ends.iter().all(|v| account.refused[0].vertices.contains(v)) && !mesh.is_boundary_edge(*e));
    // With only some of them in the way it is closed.
    let mut mesh = without(&all, |f| f < 2);
    filled(&mut mesh, sheets_too());
    assert!(mesh.is_closed() && mesh.euler_characteristic() == 0);
}

#[test]
fn pinched_loops_are_filled_one_by_one() {
    // Two holes that meet in a vertex of the soup: clean-up gives it two fans, or the surface does.
    let sphere = shapes::mesh(&icosphere(2));
    let v = sphere.vertices().find(|&v| sphere.valence(v) == 6).expect("a vertex");
    let around: Vec<FaceKey> = sphere.faces_around(v).collect();
    let faces: Vec<FaceKey> = sphere.faces().collect();
    let gone = [around[0], around[3]];
    let pool = icosphere(2);
    let kept: Vec<Vec<u32>> = (pool.polygons().iter().zip(&faces))
        .filter(|(_, f)| !gone.contains(f))
        .map(|(c, _)| c.to_vec())
        .collect();
    let soup = shapes::soup(&shapes::pool(pool.positions().to_vec(), kept));
    let mut mesh = clean(&soup, CleanOptions::default()).expect("cleans").value;
    let account = filled(&mut mesh, options());
    assert!(account.refused.is_empty() && mesh.is_closed(), "{account:?}");
}

#[test]
fn a_sheet_stays_open_and_its_inner_hole_does_not() {
    let mut mesh = without(&grid(10), |f| (88..92).contains(&f));
    let account = filled(&mut mesh, options());
    assert_eq!((account.filled.len(), account.filled[0].edges), (1, 6));
    let [HoleRefusal::Sheet(ratio)] = reasons(&account)[..] else { panic!("{account:?}") };
    assert!((0.8..1.1).contains(ratio), "{ratio}");
    assert_eq!(account.refused[0].vertices.len(), 40);
    assert_eq!(filled(&mut mesh, sheets_too()).filled.len(), 1);
    assert!(mesh.is_closed());
}

#[test]
fn the_outside_of_one_face_stays_open() {
    for n in [3, 7] {
        let mut mesh = shapes::mesh(&pool(circle(n, 1.0, 0.0), vec![(0..n).collect()]));
        let f = mesh.faces().next().expect("one");
        let account = filled(&mut mesh, sheets_too());
        assert_eq!(reasons(&account), [&HoleRefusal::OneFace(f)]);
    }
}

#[test]
fn a_limit_leaves_long_loops_open() {
    let mut mesh = shapes::mesh(&tube(&[circle(20, 1.0, 0.0), circle(20, 1.0, 3.0)]));
    let account = filled(&mut mesh, FillHolesOptions { max_edges: Some(19), ..options() });
    assert_eq!(reasons(&account), [&HoleRefusal::TooLong(20); 2]);
    assert_eq!(filled(&mut mesh, FillHolesOptions { max_edges: Some(20), ..options() }).filled.len(), 2);
}

#[test]
fn an_island_in_a_hole_is_named_and_both_loops_stay_open() {
    let sphere = icosphere(4);
    let height = |f: u32| {
        let corners = &sphere.polygons()[f as usize];
        corners.iter().map(|&v| sphere.positions()[v as usize].normalize().z).sum::<f64>() / 3.0
    };
    let mut mesh = without(&sphere, |f| (0.85..0.97).contains(&height(f)));
    assert_eq!(mesh.boundary_loops().len(), 2);
    let account = filled(&mut mesh, options());
    let [HoleRefusal::Islands(a), HoleRefusal::Islands(b)] = reasons(&account)[..] else {
        panic!("{account:?}")
    };
    assert!(a == b && a.len() == 2);
    for h in a {
        assert_eq!(account.refused.iter().filter(|r| mesh.loop_of(*h).any(|h| h == r.halfedge)).count(), 1);
        let one = mesh.triangulate_hole(*h, options());
        assert!(
            matches!(one, Err(TriangulateHoleError::Refused(r)) if matches!(r.reason, HoleRefusal::Islands(_)))
        );
    }
    // The same with a hole elsewhere: that is filled.
    let mut mesh = without(&sphere, |f| (0.85..0.97).contains(&height(f)) || height(f) < -0.9);
    let account = filled(&mut mesh, options());
    assert_eq!((account.filled.len(), account.refused.len()), (1, 2));
}

#[test]
fn the_rims_of_a_wall_are_one_hole() {
    // A thick tube without its upper ring, a bagel cut in half, and two tubes of one part each.
    let inside_out = |rings: &[Vec<DVec3>]| tube(&rings.iter().rev().cloned().collect::<Vec<_>>());
    let thick =
        tube(&[circle(24, 0.7, 2.0), circle(24, 0.7, 0.0), circle(24, 1.0, 0.0), circle(24, 1.0, 2.0)]);
    let half: Vec<_> = (0..=8).map(|i| PI * f64::from(i) / 8.0 + PI).collect();
    let half: Vec<_> = half.iter().map(|a| circle(24, 2.0 + a.cos(), a.sin())).collect();
    let inner = inside_out(&[circle(24, 0.7, 0.0), circle(24, 0.7, 2.0)]);
    let outer = tube(&[circle(24, 1.0, 0.0), circle(24, 1.0, 2.0)]);
    for (shape, groups) in [(thick, 1), (tube(&half), 1), (both(&inner, &outer), 2)] {
        let mut mesh = shapes::mesh(&shape);
        let account = filled(&mut mesh, options());
        assert_eq!((account.filled.len(), account.refused.len()), (0, 2 * groups));
        assert!(account.refused.iter().all(|r| matches!(&r.reason, HoleRefusal::Islands(l) if l.len() == 2)));
    }
}

#[test]
fn a_shell_within_a_shell_keeps_its_own_lid() {
    // Both open at the top, the inner one far below.
    let cup = |r: f64, z: f64| [circle(16, r * 0.1, z - r), circle(16, r, z - r), circle(16, r, z)];
    let outer = tube(&cup(2.0, 0.0));
    let mut inner: Vec<_> = cup(0.8, -0.9).to_vec();
    inner.reverse();
    let mut mesh = shapes::mesh(&both(&outer, &tube(&inner)));
    let account = filled(&mut mesh, options());
    assert_eq!((account.filled.len(), account.refused.len()), (4, 0), "{account:?}");
}

#[test]
fn one_hole_is_filled_as_all_are_and_wherever_its_loop_begins() {
    let shape = torus(16, 8);
    let gone = |f: u32| [3, 4, 11, 12, 20, 70].contains(&f);
    let mut all = without(&shape, gone);
    let account = filled(&mut all, options());
    let hole = account.filled.iter().max_by_key(|h| h.edges).expect("filled");
    for turn in 0..hole.edges {
        let mut mesh = without(&shape, gone);
        let h = mesh.loop_of(hole.halfedge).nth(turn).expect("a loop");
        let one = mesh.triangulate_hole(h, options()).expect("fills");
        let corners = |m: &Mesh, f: &FaceKey| m.face_vertices(*f).collect::<Vec<_>>();
        let ours: Vec<_> = one.faces.iter().map(|f| corners(&mesh, f)).collect();
        assert_eq!(ours, hole.faces.iter().map(|f| corners(&all, f)).collect::<Vec<_>>());
        assert_eq!((one.area, one.halfedge, one.edges), (hole.area, hole.halfedge, hole.edges));
        assert_eq!(mesh.validate(), Ok(()));
    }
}

#[test]
fn bad_keys_and_options_are_refused() {
    let mut mesh = without(&cube(), |f| f == 1);
    let open = smallest_hole(&mesh);
    let inner = mesh.twin(open);
    let not_open = mesh.triangulate_hole(inner, options());
    assert_eq!(not_open, Err(TriangulateHoleError::NotBoundary(inner)));
    let mut other = without(&cube(), |f| f == 1);
    let f = other.face(inner).expect("a face");
    other.remove_face(f).expect("removes");
    let dead = mesh.halfedges().find(|&h| other.get_twin(h).is_none());
    if let Some(dead) = dead {
        assert_eq!(other.triangulate_hole(dead, options()), Err(TriangulateHoleError::Missing(dead)));
    }
    let refused = |options: FillHolesOptions<'_>, option: &'static str| {
        let mut mesh = without(&cube(), |f| f == 1);
        let error = mesh.fill_holes(options);
        assert!(
            matches!(error, Err(FillHolesError::BadOption(BadOption { option: o, .. })) if o == option),
            "{option}: {error:?}"
        );
        assert!(!mesh.is_closed());
    };
    refused(FillHolesOptions { exact_edges: 2001, ..options() }, "exact_edges");
    refused(FillHolesOptions { max_area_ratio: f64::NAN, ..options() }, "max_area_ratio");
    refused(FillHolesOptions { max_area_ratio: 0.0, ..options() }, "max_area_ratio");
    refused(FillHolesOptions { island_depth: f64::INFINITY, ..options() }, "island_depth");
    refused(FillHolesOptions { polygon_tolerance: Some(-1.0), ..options() }, "polygon_tolerance");
}

#[test]
fn a_cancelled_call_changes_nothing() {
    let mut shape = shapes::mesh(&torus(40, 20));
    riddle(&mut shape, 1, 15);
    let mut calls = 0;
    let mut last = -1.0;
    let mut count = |p: Progress| {
        assert!(p.fraction >= last);
        (calls, last) = (calls + 1, p.fraction);
        ControlFlow::Continue(())
    };
    shape
        .clone()
        .fill_holes(FillHolesOptions { control: Control::new(&mut count), ..options() })
        .expect("fills");
    assert!(calls >= 3);
    for stop in 1..=calls {
        let (mut mesh, mut left) = (shape.clone(), stop);
        let mut hook = |_: Progress| {
            left -= 1;
            if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let cancelled = mesh.fill_holes(FillHolesOptions { control: Control::new(&mut hook), ..options() });
        assert_eq!(cancelled, Err(FillHolesError::Cancelled(Cancelled)));
        assert_eq!(mesh.to_indexed(), shape.to_indexed());
        assert!(mesh.boundary_halfedges().eq(shape.boundary_halfedges()));
    }
}

#[test]
fn checkpoints_changes_and_columns_follow() {
    let mut mesh = without(&fanned(&cube()), |f| f < 2);
    let part = mesh.add_face_column(7, Rule::keep());
    for f in mesh.faces().collect::<Vec<_>>() {
        mesh.set_value(part, f, 1).expect("sets");
    }
    for h in mesh.halfedges().filter(|&h| !mesh.is_boundary(h)).collect::<Vec<_>>() {
        mesh.set_uv(h, Some(DVec2::ONE)).expect("sets");
    }
    let before = (mesh.to_indexed(), mesh.numbering());
    let mark = mesh.checkpoint();
    mesh.record_changes();
    let account = filled(&mut mesh, options());
    for &f in &account.filled[0].faces {
        assert_eq!(*mesh.value(part, f), 7, "the default");
        assert!(mesh.face_halfedges(f).all(|h| mesh.uv(h).is_none()));
    }
    let maps = Lineage::of(mesh.take_changes()).maps(&before.1, &mesh.numbering());
    assert_eq!(
        (maps.faces.old_of(9), maps.faces.old_of(10), maps.faces.old_of(11)),
        (&[9][..], &[][..], &[][..])
    );
    mesh.restore(mark).expect("known");
    assert_eq!(mesh.to_indexed(), before.0);
    assert_eq!(mesh.validate(), Ok(()));
}

#[test]
fn new_faces_take_the_group_of_most_of_the_border() {
    let named = |name: &str| GroupName { name: name.into(), material: None };
    let mut mesh = without(&cube(), |f| f == 1);
    let faces: Vec<FaceKey> = mesh.faces().collect();
    mesh.set_group(faces[0], Some(named("bottom"))).expect("sets");
    for (f, name) in [(faces[1], "a"), (faces[2], "b"), (faces[3], "b"), (faces[4], "c")] {
        mesh.set_group(f, Some(named(name))).expect("sets");
    }
    let account = filled(&mut mesh, options());
    assert!(account.filled[0].faces.iter().all(|&f| mesh.group(f) == Some(&named("b"))));
}
