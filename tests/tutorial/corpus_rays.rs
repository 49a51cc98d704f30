//! Rows about rays, on the corpus: through edges, along them, in planes of faces, from the surface on.

use crate::shapes::Noise;
use crate::{assert_met, few, reach, somewhere};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{Crossing, EdgeKey, Feature, MeshIndex, Ray, RayHit, SolidIndex};

fn ray(from: DVec3, along: DVec3) -> Ray {
    Ray::new(from, along).expect("a ray")
}

/// How often the hits lead out more often than in.
fn outward(hits: &[RayHit]) -> i32 {
    let of = |h: &RayHit| match h.crossing {
        Crossing::Enter => -1,
        Crossing::Leave => 1,
        Crossing::Touch => 0,
    };
    hits.iter().map(of).sum()
}

/// Between its hits the winding number is what the crossings so far make of that at the origin; where it cannot be told,
/// on the surface, nothing is asked. How often it was told.
fn follow(name: &str, solid: &SolidIndex<'_>, r: &Ray) -> usize {
    let hits = solid.index().hits(r);
    assert!(hits.windows(2).all(|w| w[0].t <= w[1].t) && hits.iter().all(|h| h.t >= 0.0), "{name}: {r:?}");
    assert_eq!(solid.index().first_hit(r), hits.first().copied(), "{name}: {r:?}");
    let Some(mut inside) = solid.winding_number(r.origin()).expect("finite") else { return 0 };
    assert_eq!(outward(&hits), inside, "{name}: {r:?}: {hits:#?}");
    let mut told = 1;
    for (i, h) in hits.iter().enumerate() {
        inside -= outward(std::slice::from_ref(h));
        let next = hits.get(i + 1).map_or(h.t + 1.0, |n| n.t);
        // A point of the ray is rounded: a hair from the surface it may be on the other side.
        if next - h.t > 1e-6 * next
            && let Some(there) = solid.winding_number(r.at((h.t + next) / 2.0)).expect("finite")
        {
            // Exactly along a face it would not be told, beside it by rounding it may be.
            let crosses_beside = i + 1 < hits.len()
                && (hits[i].crossing == Crossing::Touch || hits[i + 1].crossing == Crossing::Touch);
            assert!(inside == there || crosses_beside, "{name}: after {i} of {r:?}: {hits:#?}");
            told += 1;
        }
    }
    told
}

#[test]
fn rays_through_edges_and_vertices_of_models_keep_account_of_inside_and_outside() {
    let mut noise = Noise(81);
    let mut told = 0;
    for (name, mesh) in few().iter().filter(|(_, mesh)| mesh.is_closed()) {
        let solid = mesh.closed().expect("closed").index();
        let (bounds, size) = (mesh.bounds().expect("vertices"), reach(mesh).0);
        let edges: Vec<EdgeKey> = mesh.edges().collect();
        for i in 0..40 {
            let h = mesh.edge_halfedge(edges[noise.below(edges.len() as u32) as usize]);
            let [a, b] = [mesh.origin(h), mesh.target(h)].map(|v| mesh.position(v));
            let at = if i % 2 == 0 { a } else { (a + b) / 2.0 };
            // From outside, and from anywhere: inside as often as not.
            let from =
                bounds.center() + if i % 4 < 2 { DVec3::splat(size) } else { somewhere(&mut noise, size) };
            if at != from {
                told += follow(name, &solid, &ray(from, at - from));
            }
        }
    }
    assert_met(told, 5000);
}

#[test]
fn rays_along_edges_and_in_planes_of_faces_of_models_are_defined() {
    let mut noise = Noise(82);
    let (mut along, mut within, mut told) = (0, 0, 0);
    for (name, mesh) in few().iter().filter(|(_, mesh)| mesh.is_closed()) {
        let solid = mesh.closed().expect("closed").index();
        let size = reach(mesh).0;
        // Along edges that are parallel to an axis: two coordinates are exactly those of the edge.
        for e in mesh.edges() {
            let h = mesh.edge_halfedge(e);
            let [a, b] = [mesh.origin(h), mesh.target(h)].map(|v| mesh.position(v));
            let equal = a.cmpeq(b);
            if equal.bitmask().count_ones() == 2 && noise.below(4) == 0 {
                let way = (b - a).signum() * DVec3::select(equal, DVec3::ZERO, DVec3::ONE);
                told += follow(name, &solid, &ray(a - way * 2.0 * size, way * size));
                along += 1;
            }
        }
        // Within the planes of faces that are upright on an axis, through their corners' mean.
        for f in mesh.faces() {
            let corners: Vec<DVec3> = mesh.face_vertices(f).map(|v| mesh.position(v)).collect();
            let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
            for axis in 0..3 {
                if corners.iter().all(|p| p[axis] == corners[0][axis]) && noise.below(4) == 0 {
                    let mut from = middle;
                    from[axis] = corners[0][axis];
                    let mut way = somewhere(&mut noise, 1.0);
                    way[axis] = 0.0;
                    from -= way.normalize_or(DVec3::ZERO) * 2.0 * size;
                    if way != DVec3::ZERO {
                        told += follow(name, &solid, &ray(from, way));
                        within += 1;
                    }
                }
            }
        }
    }
    eprintln!("{along} along edges, {within} in planes, {told} told");
    assert_met(along, 200);
    assert_met(within, 200);
    assert_met(told, 800);
}

#[test]
fn rays_that_graze_models_at_their_farthest_vertices_touch_and_never_cross() {
    let mut met = 0;
    for (name, mesh) in few() {
        let (index, size) = (mesh.index(), reach(mesh).0);
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let used = mesh.vertices().filter(|&v| !mesh.is_isolated(v)).map(|v| mesh.position(v));
                let p = used.max_by(|a, b| (a[axis] * sign).total_cmp(&(b[axis] * sign))).expect("a face");
                // The whole model lies on one side of the plane that the ray runs in.
                let mut way = DVec3::ZERO;
                way[(axis + 1) % 3] = size;
                let hits = index.hits(&ray(p - way * 2.0, way));
                assert!(!hits.is_empty(), "{name}: {axis} {sign}");
                assert!(
                    hits.iter().all(|h| h.crossing == Crossing::Touch),
                    "{name}: {axis} {sign}: {hits:?}"
                );
                met += 1;
            }
        }
    }
    assert_met(met, 600);
}

/// What the ray meets of one face.
fn on_face(index: &MeshIndex<'_>, r: &Ray, f: meshwright::FaceKey) -> usize {
    index.hits(r).iter().filter(|h| h.face == f).count()
}

#[test]
fn polygons_of_models_give_one_hit_on_their_diagonals() {
    let mut met = 0;
    for (name, mesh) in few() {
        let index = mesh.index();
        for f in mesh.faces().filter(|&f| mesh.degree(f) == 4) {
            let corners: Vec<DVec3> = mesh.face_vertices(f).map(|v| mesh.position(v)).collect();
            let normal = mesh.face_normal(f);
            // Both triangles on either side look the same way: then the polygon is met once from its front.
            let turn = |i: usize| {
                let [a, b, c] = [0, 1, 2].map(|k| corners[(i + k) % 4]);
                (b - a).cross(c - b).dot(normal)
            };
            if (0..4).all(|i| turn(i) > 0.0) {
                for i in 0..2 {
                    let middle = (corners[i] + corners[i + 2]) / 2.0;
                    let back = corners[i].distance(corners[i + 2]);
                    let met_once = on_face(&index, &ray(middle + normal * back, -normal), f);
                    // Where surfaces lie on each other, one of them is named.
                    let doubled = index.hits(&ray(middle + normal * back, -normal));
                    assert!(
                        met_once == 1 || met_once == 0 && !doubled.is_empty(),
                        "{name}: {f:?}: {met_once}"
                    );
                    met += met_once;
                }
            }
        }
    }
    assert_met(met, 200);
}

#[test]
fn rays_that_start_on_models_hit_at_zero() {
    let mut met = 0;
    for (name, mesh) in few() {
        let (index, center) = (mesh.index(), mesh.bounds().expect("vertices").center());
        for v in mesh.vertices().filter(|&v| !mesh.is_isolated(v)).step_by(7) {
            let p = mesh.position(v);
            let way = p - center + dvec3(0.1, 0.2, 0.3) * reach(mesh).0;
            let r = ray(p, way);
            let first = index.first_hit(&r).expect("it starts on the surface");
            assert!(first.t == 0.0 && first.point == p, "{name}: {first:?}");
            assert!(index.is_hit(&r), "{name}");
            // Where another face lies on it, one of the two is named.
            if let Feature::Vertex(at) = first.feature {
                assert!(mesh.position(at) == p, "{name}");
                met += 1;
            }
        }
    }
    assert_met(met, 800);
}
