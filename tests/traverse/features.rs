//! Dihedral angles, feature edges and paths.

use crate::shapes::{cube, mesh, pool};
use crate::{all, between, cylinder, quads};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{EdgeKey, FeatureOptions, IndexedMesh, Mesh};
use std::collections::BTreeSet;
use std::f64::consts::{FRAC_PI_2, PI};

#[test]
fn dihedral_angles_are_positive_where_the_surface_is_convex() {
    let mut convex = mesh(&cube());
    for e in convex.edges() {
        assert_eq!(convex.dihedral_angle(e), Some(FRAC_PI_2));
    }
    convex.reverse();
    assert!(convex.edges().all(|e| convex.dihedral_angle(e) == Some(-FRAC_PI_2)));
    let flat = mesh(&quads(3, 3));
    for e in flat.edges() {
        let expected = if flat.is_boundary_edge(e) { None } else { Some(0.0) };
        assert_eq!(flat.dihedral_angle(e), expected);
    }
    let (n, tube) = (9u32, mesh(&cylinder(9)));
    for i in 0..n as usize {
        let e = tube.edge(between(&tube, i, i + n as usize));
        let turn = tube.dihedral_angle(e).expect("two faces");
        assert!((turn - std::f64::consts::TAU / f64::from(n)).abs() < 1e-14);
    }
}

#[test]
fn dihedral_angles_of_slivers_keep_their_digits() {
    // Two needles, 1e-9 wide, far from the origin of their plane, turned against each other by a known angle.
    for turn in [1e-3, 0.5, 1.0, FRAC_PI_2, 3.0, -1e-3, -0.5, -3.0f64] {
        for width in [1e-3, 1e-6, 1e-9, 1e-12] {
            for tip in [0.0, 0.3, 1.0] {
                let points = [
                    DVec3::ZERO,
                    DVec3::X,
                    dvec3(tip, width, 0.0),
                    dvec3(tip, -width * turn.cos(), -width * turn.sin()),
                ];
                for start in 0..3 {
                    let mut faces = [[0, 1, 2], [1, 0, 3]];
                    faces.iter_mut().for_each(|f| f.rotate_left(start));
                    let mesh = mesh(&IndexedMesh::from_triangles(points.to_vec(), &faces).expect("fine"));
                    let e = mesh.edge(between(&mesh, 0, 1));
                    let found = mesh.dihedral_angle(e).expect("two faces");
                    assert!((found - turn).abs() < 1e-14, "{turn} {width} {tip} {start}: {found}");
                }
            }
        }
    }
}

#[test]
fn a_needle_far_from_the_origin_has_the_angle_of_its_corners_as_stored() {
    // The short side first, in the middle or last: cutting from the far corner loses the width.
    let far = dvec3(1000.0, 0.0, 0.0);
    let width = 2f64.powi(-30);
    let points = [DVec3::ZERO, DVec3::Y * width, far, dvec3(0.0, 0.0, -width)];
    let mut angles = BTreeSet::new();
    for start in 0..3 {
        let mut faces = [[0, 2, 1], [2, 0, 3]];
        faces.iter_mut().for_each(|f| f.rotate_left(start));
        let mesh = mesh(&IndexedMesh::from_triangles(points.to_vec(), &faces).expect("fine"));
        let found = mesh.dihedral_angle(mesh.edge(between(&mesh, 0, 2))).expect("two faces");
        angles.insert(found.to_bits());
        assert!((found.abs() - FRAC_PI_2).abs() < 1e-15);
    }
    assert_eq!(angles.len(), 1, "whatever the first corner");
}

#[test]
fn dihedral_angles_survive_the_ends_of_f64() {
    for scale in [1e-300, 1e-160, 1e160, 1e300] {
        let points = cube().positions().iter().map(|&p| (p - 0.5) * scale).collect();
        let mesh = mesh(&IndexedMesh::new(points, cube().polygons().clone()).expect("finite"));
        assert!(mesh.edges().all(|e| mesh.dihedral_angle(e) == Some(FRAC_PI_2)), "{scale}");
    }
}

#[test]
fn an_edge_of_a_face_without_area_has_no_angle_and_a_fold_turns_by_half_a_circle() {
    let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0, DVec3::Y];
    let flat = mesh(&IndexedMesh::from_triangles(line.to_vec(), &[[0, 1, 3], [1, 0, 2]]).expect("fine"));
    assert_eq!(flat.dihedral_angle(flat.edge(between(&flat, 0, 1))), None);
    let folded = [DVec3::ZERO, DVec3::X, DVec3::Y, dvec3(0.3, 1.0, 0.0)];
    let folded = mesh(&IndexedMesh::from_triangles(folded.to_vec(), &[[0, 1, 2], [1, 0, 3]]).expect("fine"));
    let turn = folded.dihedral_angle(folded.edge(between(&folded, 0, 1))).expect("two faces");
    assert_eq!(turn.abs(), PI);
}

fn naive_features(mesh: &Mesh, options: FeatureOptions) -> BTreeSet<EdgeKey> {
    let normal = |h| mesh.face(h).map(|f| mesh.face_normal(f));
    let is_feature = |&e: &EdgeKey| {
        let h = mesh.edge_halfedge(e);
        match (normal(h), normal(mesh.twin(h))) {
            (Some(a), Some(b)) => a.dot(b).clamp(-1.0, 1.0).acos().to_degrees() > options.degrees,
            _ => options.boundary,
        }
    };
    mesh.edges().filter(is_feature).collect()
}

pub(crate) fn check_features(mesh: &Mesh, options: FeatureOptions) {
    let features: Vec<_> = mesh.feature_edges(options).collect();
    assert!(features.is_sorted());
    let features: BTreeSet<_> = features.into_iter().collect();
    assert_eq!(features, naive_features(mesh, options));
    let paths = mesh.feature_paths(options);
    let listed: Vec<_> = paths.iter().flat_map(|p| &p.halfedges).map(|&h| mesh.edge(h)).collect();
    assert_eq!(listed.len(), features.len(), "each edge in one path");
    assert_eq!(listed.into_iter().collect::<BTreeSet<_>>(), features);
    let degree = |v| mesh.edges_around(v).filter(|e| features.contains(e)).count();
    let mut first = None;
    for path in &paths {
        let h = &path.halfedges;
        for pair in h.windows(2) {
            assert_eq!(mesh.target(pair[0]), mesh.origin(pair[1]));
            assert_eq!(degree(mesh.target(pair[0])), 2, "inside a path there is no corner");
        }
        let (start, end) = (mesh.origin(h[0]), mesh.target(h[h.len() - 1]));
        if path.closed {
            assert_eq!(start, end);
            assert_eq!(degree(start), 2);
        } else {
            assert!(degree(start) != 2 && degree(end) != 2, "a path goes on to a corner");
        }
        let lowest = h.iter().copied().min_by_key(|&h| mesh.edge(h)).expect("an edge");
        assert_eq!(lowest, mesh.edge_halfedge(mesh.edge(lowest)));
        assert!(first.replace(mesh.edge(lowest)) < Some(mesh.edge(lowest)), "in order");
    }
}

#[test]
fn feature_paths_hold_every_feature_edge_once_and_end_at_corners() {
    for mesh in all() {
        for degrees in [0.005, 12.0, 60.0, 85.0, 200.0] {
            for boundary in [false, true] {
                check_features(&mesh, FeatureOptions { degrees, boundary });
            }
        }
    }
}

#[test]
fn the_features_of_a_cylinder_are_its_two_rims_and_of_a_cube_its_edges() {
    let options = FeatureOptions { degrees: 60.0, boundary: false };
    let rims = mesh(&cylinder(12)).feature_paths(options);
    assert_eq!(rims.iter().map(|p| (p.halfedges.len(), p.closed)).collect::<Vec<_>>(), [(12, true); 2]);
    let cube = mesh(&cube()).feature_paths(options);
    assert!(cube.len() == 12 && cube.iter().all(|p| p.halfedges.len() == 1 && !p.closed));
    let outline = mesh(&quads(3, 2)).feature_paths(FeatureOptions { boundary: true, ..options });
    assert_eq!(outline.iter().map(|p| (p.halfedges.len(), p.closed)).collect::<Vec<_>>(), [(10, true)]);
}

#[test]
fn a_path_back_to_its_own_corner_is_not_closed() {
    // A fan of triangles with one crease, from its apex to the outline.
    let n = 24u32;
    let rim = |i: u32| {
        let turn = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
        dvec3(turn.cos(), turn.sin(), (turn / 2.0).sin())
    };
    let points = std::iter::once(DVec3::ZERO).chain((0..n).map(rim)).collect();
    let mesh = mesh(&pool(points, (0..n).map(|i| vec![0, 1 + i, 1 + (i + 1) % n]).collect()));
    let paths = mesh.feature_paths(FeatureOptions { degrees: 30.0, boundary: true });
    let found: Vec<_> = paths.iter().map(|p| (p.halfedges.len(), p.closed)).collect();
    assert_eq!(found, [(1, false), (n as usize, false)]);
    let outline = &paths[1].halfedges;
    assert_eq!(mesh.origin(outline[0]), mesh.target(outline[outline.len() - 1]));
}
