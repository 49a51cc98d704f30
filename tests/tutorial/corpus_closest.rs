//! Rows about nearest elements, on the corpus: ties, isolated vertices, sides, faces without area.

use crate::naive::{self, Plain};
use crate::shapes::Noise;
use crate::{assert_met, few, reach, solids, somewhere};
use meshwright::glam::DVec3;
use meshwright::{ClosestOptions, Mesh, Side, VertexKey};

const ALL: ClosestOptions = ClosestOptions { max_distance: f64::INFINITY, isolated_vertices: true };

#[test]
fn of_equally_near_vertices_of_models_the_lowest_is_named_and_isolated_ones_on_demand() {
    let (mut ties, mut isolated) = (0, 0);
    for (name, mesh) in few() {
        let index = mesh.index();
        let vertices: Vec<VertexKey> = mesh.vertices().collect();
        let at = |v: &VertexKey| mesh.position(*v);
        for p in vertices.iter().step_by(5).map(at).chain([mesh.bounds().expect("vertices").center()]) {
            let lowest = |these: &dyn Fn(VertexKey) -> bool| {
                let near = |a: &&VertexKey, b: &&VertexKey| at(a).distance(p).total_cmp(&at(b).distance(p));
                vertices.iter().filter(|v| these(**v)).min_by(near).copied()
            };
            let found = index.closest_vertex(p, ALL).expect("asked well").expect("vertices");
            let expected = lowest(&|_| true).expect("vertices");
            // Two may be as near but for the rounding of a root; where they are, there is none.
            assert_eq!(at(&found.element).distance(p), at(&expected).distance(p), "{name}: {p}");
            assert!(found.distance > 0.0 || found.element == expected, "{name}: {p}");
            ties += vertices.iter().filter(|v| at(v) == at(&expected)).count() - 1;
            let used = ClosestOptions { isolated_vertices: false, ..ALL };
            let found = index.closest_vertex(p, used).expect("asked well").expect("used ones");
            let expected = lowest(&|v| !mesh.is_isolated(v)).expect("used ones");
            assert_eq!(at(&found.element).distance(p), at(&expected).distance(p), "{name}: {p}");
            assert!(!mesh.is_isolated(found.element), "{name}: {p}");
        }
        isolated += mesh.vertices().filter(|&v| mesh.is_isolated(v)).count();
        assert!(index.closest_vertex(DVec3::NAN, ALL).is_err(), "{name}");
    }
    eprintln!("{ties} ties, {isolated} isolated vertices");
    assert_met(ties, 20);
}

#[test]
fn the_nearest_centre_names_the_wrong_face_of_models_and_closest_face_never() {
    let mut noise = Noise(92);
    let (mut asked, mut wrong) = (0, 0);
    for (name, mesh) in few() {
        let (index, bounds) = (mesh.index(), mesh.bounds().expect("vertices"));
        let (size, far) = reach(mesh);
        for _ in 0..10 {
            let p = bounds.center() + somewhere(&mut noise, 1.5 * size);
            let surface = index.closest_point(p, ALL).expect("asked well").expect("a face");
            let face = index.closest_face(p, ALL).expect("asked well").expect("a face");
            assert!(face.distance == surface.distance, "{name}: {p}");
            let center = index.closest_face_center(p, ALL).expect("asked well").expect("a face");
            assert!(center.distance >= surface.distance - 1e-12 * (size + far), "{name}: {p}");
            let corners: Vec<DVec3> = mesh.face_vertices(center.element).map(|v| mesh.position(v)).collect();
            if let [a, b, c] = corners[..] {
                let true_distance = naive::on_triangle(p, [a, b, c]).distance(p);
                wrong += u32::from(true_distance > surface.distance + 1e-9 * (size + far));
                asked += 1;
            }
        }
    }
    eprintln!("{wrong} of {asked}");
    assert_met(asked, 1000);
    assert_met(wrong as usize, 60);
}

#[test]
fn the_nearest_point_of_solid_models_knows_its_side_and_how_far_to_look() {
    let mut noise = Noise(93);
    let mut sides = [0; 2];
    for (name, mesh) in solids().filter(|(_, mesh)| mesh.components().len() == 1) {
        let crossings = mesh.self_intersections(Default::default()).expect("not cancelled");
        if !crossings.pairs.is_empty() {
            continue;
        }
        let inside = crate::volume(mesh);
        let solid = mesh.closed().expect("closed").index();
        let (bounds, (size, far)) = (mesh.bounds().expect("vertices"), reach(mesh));
        for _ in 0..30 {
            let p = bounds.center() + somewhere(&mut noise, 0.8 * size);
            let near = solid.index().closest_point(p, ALL).expect("asked well").expect("a point");
            if near.distance > 1e-9 * (size + far) {
                let winding = solid.winding_number(p).expect("finite").expect("off the surface");
                // Inside out, everything else is inside.
                let is_in = (near.side == Side::Inside) == (inside > 0.0);
                assert_eq!(is_in, winding != 0, "{name}: {p}: {near:?}");
                sides[usize::from(is_in)] += 1;
            }
            let short = ClosestOptions { max_distance: near.distance * 0.999, ..ALL };
            assert_eq!(solid.index().closest_point(p, short), Ok(None), "{name}: {p}");
        }
    }
    eprintln!("{sides:?}");
    assert_met(sides[0], 300);
    assert_met(sides[1], 100);
}

#[test]
fn edges_without_length_and_faces_without_area_of_models_do_no_harm() {
    let mut noise = Noise(94);
    let mut met = 0;
    for (name, model) in few() {
        let mut mesh = model.clone();
        // Every fifth vertex is moved to where a neighbour is.
        for v in mesh.vertices().step_by(5).collect::<Vec<_>>() {
            let beside = mesh.neighbors(v).next();
            if let Some(w) = beside {
                let there = mesh.position(w);
                mesh.set_position(v, there).expect("finite");
                met += 1;
            }
        }
        let (index, plain) = (mesh.index(), Plain::from(&mesh.to_indexed()));
        let (bounds, (size, far)) = (mesh.bounds().expect("vertices"), reach(&mesh));
        let slack = 1e-9 * (size + far);
        for _ in 0..10 {
            let p = bounds.center() + somewhere(&mut noise, 1.5 * size);
            let edge = index.closest_edge(p, ALL).expect("asked well").expect("an edge");
            let ends = |mesh: &Mesh, e| {
                let h = mesh.edge_halfedge(e);
                [mesh.origin(h), mesh.target(h)].map(|v| mesh.position(v))
            };
            let each = mesh.edges().map(|e| {
                let [a, b] = ends(&mesh, e);
                if a == b { a.distance(p) } else { naive::on_segment(p, a, b).distance(p) }
            });
            let least = each.fold(f64::INFINITY, f64::min);
            assert!((edge.distance - least).abs() <= slack, "{name}: {p}");
            let surface = index.closest_point(p, ALL).expect("asked well").expect("a point");
            assert!(surface.distance <= edge.distance + slack && surface.point.is_finite(), "{name}: {p}");
            assert!(surface.barycentrics.iter().all(|w| w.is_finite()), "{name}: {surface:?}");
            let (v, _) = naive::closest_vertex(&plain, p);
            let vertex = index.closest_vertex(p, ALL).expect("asked well").expect("a vertex");
            assert_eq!(vertex.point, plain.points[v], "{name}: {p}");
        }
    }
    assert_met(met, 1000);
}
