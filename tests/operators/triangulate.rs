use crate::shapes::{cube, pool};
use crate::{DVec3, does, faces, hinge, refuses, subject};
use meshwright::TriangulateFaceError;
use meshwright::glam::dvec3;

#[test]
fn triangulate_a_quad_along_its_shorter_diagonal() {
    let points = vec![DVec3::ZERO, dvec3(3., 0., 0.), dvec3(3., 3., 0.), dvec3(1., 2., 0.)];
    let mut s = subject(&pool(points, vec![vec![0, 1, 2, 3]]));
    let f = s.f(0);
    let done = does!(s, triangulate_face, check_triangulate_face(f));
    assert_eq!((done.cuts.len(), s.counts()), (1, [4, 5, 2]));
    assert_eq!(s.e(1, 3), done.cuts[0].edge);
    assert_eq!(s.mesh.degree(done.cuts[0].face), 3);
}

#[test]
fn triangulate_a_triangle_does_nothing() {
    let mut s = hinge();
    let (f, before) = (s.f(0), crate::state(&s.mesh));
    assert!(does!(s, triangulate_face, check_triangulate_face(f)).cuts.is_empty());
    assert!(crate::state(&s.mesh) == before);
}

#[test]
fn triangulate_a_large_polygon_names_every_cut() {
    let n = 40;
    let corners: Vec<u32> = (0..n).collect();
    let mut s = faces(n, &[&corners]);
    let f = s.f(0);
    let done = does!(s, triangulate_face, check_triangulate_face(f));
    assert_eq!((done.cuts.len(), s.counts()), (37, [40, 77, 38]));
    assert!(s.mesh.faces().all(|f| s.mesh.degree(f) == 3));
    assert!(
        done.cuts
            .iter()
            .all(|c| c.face != f && s.mesh.contains_face(c.face) && !s.mesh.is_boundary_edge(c.edge))
    );
}

#[test]
fn triangulate_a_concave_polygon_stays_inside() {
    // A comb: area is kept only if every triangle lies inside.
    let mut points = vec![dvec3(6., -1., 0.), dvec3(6., 3., 0.)];
    points.extend((0..6).rev().map(|i| dvec3(f64::from(i), if i % 2 == 0 { 3.0 } else { 0.0 }, 0.)));
    points.push(dvec3(0., -1., 0.));
    let ring = (0..points.len() as u32).collect();
    let mut s = subject(&pool(points, vec![ring]));
    let (f, area) = (s.f(0), s.mesh.to_indexed().area());
    does!(s, triangulate_face, check_triangulate_face(f));
    let after: f64 = s.mesh.to_indexed().area();
    assert!((after - area).abs() < 1e-12, "{after} is not {area}");
}

#[test]
fn triangulate_a_whole_cube() {
    let mut s = subject(&cube());
    for i in 0..6 {
        let f = s.f(i);
        does!(s, triangulate_face, check_triangulate_face(f));
    }
    assert_eq!((s.counts(), s.mesh.is_closed()), ([8, 18, 12], true));
}

#[test]
fn a_quad_takes_the_other_diagonal_when_the_shorter_is_an_edge() {
    // The shorter diagonal 1-3 is an edge of the triangle behind.
    let points =
        vec![DVec3::ZERO, dvec3(3., 0., 0.), dvec3(3., 3., 0.), dvec3(1., 2., 0.), dvec3(0., 3., -1.)];
    let mut s = subject(&pool(points, vec![vec![0, 1, 2, 3], vec![3, 1, 0]]));
    let (f, taken) = (s.f(0), s.e(1, 3));
    let done = does!(s, triangulate_face, check_triangulate_face(f));
    assert_eq!((s.e(0, 2), s.e(1, 3)), (done.cuts[0].edge, taken));
}

#[test]
fn triangulate_refuses_a_dead_face() {
    let mut s = hinge();
    let f = s.f(0);
    s.mesh.remove_face(f).expect("can be removed");
    refuses!(s, triangulate_face, check_triangulate_face(f), TriangulateFaceError::Missing(dead) if dead == f);
}

#[test]
fn triangulate_refuses_a_pentagon_whose_diagonal_is_an_edge() {
    // A fan on the back of the pentagon has two of its diagonals; some fans leave the rule's alone.
    let mut refused = 0;
    for hub in 0..5 {
        let at = |i: u32| (hub + i) % 5;
        let fan = |i: u32| vec![at(0), at(i + 1), at(i)];
        let mut cells = vec![vec![0, 1, 2, 3, 4]];
        cells.extend((1..4).map(fan));
        let cells: Vec<&[u32]> = cells.iter().map(Vec::as_slice).collect();
        let mut s = faces(5, &cells);
        let [a, c, d] = [at(0), at(2), at(3)].map(|i| i as usize);
        let (f, taken) = (s.f(0), [s.e(a, c), s.e(a, d)]);
        match s.mesh.check_triangulate_face(f) {
            Ok(()) => drop(does!(s, triangulate_face, check_triangulate_face(f))),
            Err(_) => {
                refuses!(
                    s,
                    triangulate_face,
                    check_triangulate_face(f),
                    TriangulateFaceError::Joined(e) if taken.contains(&e)
                );
                refused += 1;
            }
        }
    }
    assert!((1..5).contains(&refused), "{refused}");
}

#[test]
fn triangulate_refuses_a_quad_with_both_diagonals_taken() {
    // Five quads on a torus whose five vertices are all joined to each other.
    let quad = |i: u32| [i, i + 1, i + 3, i + 2].map(|v| v % 5);
    let quads: Vec<[u32; 4]> = (0..5).map(quad).collect();
    let mut s = faces(5, &quads.iter().map(|q| q.as_slice()).collect::<Vec<_>>());
    assert_eq!((s.mesh.is_closed(), s.mesh.euler_characteristic()), (true, 0));
    for i in 0..5 {
        let f = s.f(i);
        refuses!(s, triangulate_face, check_triangulate_face(f), TriangulateFaceError::Joined(_));
    }
}
