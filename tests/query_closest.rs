//! Nearest elements beside the tutorial's loops over all of them; inside and outside; mass properties.

mod igl;
#[path = "tutorial/naive.rs"]
mod naive;
mod shapes;

use meshwright::glam::{DMat3, DVec3, dvec3};
use meshwright::{ClosestOptions, Feature, IndexedMesh, Mesh, QueryError, Side};
use naive::Plain;
use shapes::Noise;

const ALL: ClosestOptions = ClosestOptions { max_distance: f64::INFINITY, isolated_vertices: true };

fn point(noise: &mut Noise, size: f64) -> DVec3 {
    (dvec3(noise.unit(), noise.unit(), noise.unit()) - 0.5) * size
}

#[test]
fn nearest_elements_are_those_of_the_naive_loops() {
    let mut noise = Noise(21);
    let cavity = shapes::both(&shapes::cube_at(DVec3::splat(-3.0)), &shapes::torus(9, 7));
    for pool in [shapes::icosphere(2), shapes::torus(12, 8), shapes::cube(), shapes::grid(6), cavity] {
        let mesh = shapes::mesh(&pool);
        let index = mesh.index();
        let (plain, triangles) = (Plain::from(&pool), Plain::from(&shapes::fanned(&pool)));
        let is_flat = pool.polygons().iter().all(|f| f.len() == 3) || pool == shapes::cube();
        let vertices: Vec<_> = mesh.vertices().collect();
        let faces: Vec<_> = mesh.faces().collect();
        for round in 0..500 {
            // Some on a lattice, where there are ties.
            let p = match round % 3 {
                0 => (point(&mut noise, 8.0) * 2.0).round() / 2.0,
                1 => point(&mut noise, 8.0),
                _ => point(&mut noise, 8e3),
            };
            let vertex = index.closest_vertex(p, ALL).expect("asked well").expect("a vertex");
            let (v, distance) = naive::closest_vertex(&plain, p);
            assert_eq!((vertex.element, vertex.point), (vertices[v], mesh.position(vertices[v])));
            assert!((vertex.distance - distance).abs() <= 1e-12 * distance);
            let center = index.closest_face_center(p, ALL).expect("asked well").expect("a face");
            let (f, distance) = naive::closest_face_center(&plain, p);
            assert_eq!(center.element, faces[f], "{p}");
            assert!((center.distance - distance).abs() <= 1e-12 * distance);
            let edge = index.closest_edge(p, ALL).expect("asked well").expect("an edge");
            assert!((edge.distance - naive::closest_edge(&plain, p)).abs() <= 1e-9);
            let h = mesh.edge_halfedge(edge.element);
            let [a, b] = [mesh.origin(h), mesh.target(h)].map(|v| mesh.position(v));
            assert!(naive::on_segment(edge.point, a, b).distance(edge.point) < 1e-9);
            let surface = index.closest_point(p, ALL).expect("asked well").expect("a point");
            if is_flat {
                assert!(
                    (surface.distance - naive::closest_point(&triangles, p)).abs() <= 1e-9,
                    "{p} {surface:?}"
                );
            }
            assert!(surface.distance <= vertex.distance && surface.distance <= edge.distance + 1e-9);
            let at: DVec3 =
                surface.corners.iter().zip(surface.barycentrics).map(|(&v, w)| mesh.position(v) * w).sum();
            assert!(at.distance(surface.point) < 1e-9);
            match surface.feature {
                Feature::Vertex(v) => assert_eq!(surface.point, mesh.position(v)),
                Feature::Edge(e) => assert!(mesh.face_edges(surface.face).any(|g| g == e)),
                Feature::Face(f) => assert_eq!(f, surface.face),
            }
            let face = index.closest_face(p, ALL).expect("asked well").expect("a face");
            assert_eq!((face.element, face.distance), (surface.face, surface.distance));
            // Just within and just without reach.
            for (factor, is_there) in [(1.0 + 1e-12, true), (1.0 - 1e-9, false)] {
                let near = ClosestOptions { max_distance: surface.distance * factor, ..ALL };
                let found = index.closest_point(p, near).expect("asked well");
                assert_eq!(found.is_some(), is_there || surface.distance == 0.0);
            }
        }
    }
}

#[test]
fn ties_go_to_the_lowest_vertex_and_isolated_vertices_are_an_option() {
    let mut points = shapes::cube().positions().to_vec();
    points.push(dvec3(0.5, 0.5, 0.5));
    let faces = shapes::cube().polygons().iter().map(<[u32]>::to_vec).collect();
    let mesh = shapes::mesh(&shapes::pool(points, faces));
    let index = mesh.index();
    let vertices: Vec<_> = mesh.vertices().collect();
    let ask = |isolated_vertices| {
        let options = ClosestOptions { isolated_vertices, ..ALL };
        index.closest_vertex(DVec3::splat(0.5), options).expect("asked well").expect("a vertex").element
    };
    assert_eq!(ask(false), vertices[0], "eight are equally near");
    assert_eq!(ask(true), vertices[8]);
}

#[test]
fn what_cannot_be_asked_is_refused_and_where_there_is_nothing_nothing_is_found() {
    let mesh = shapes::mesh(&shapes::cube());
    let index = mesh.index();
    let bad = dvec3(f64::NAN, 0.0, 0.0);
    assert!(matches!(index.closest_point(bad, ALL), Err(QueryError::NonFinitePoint(_))));
    assert!(matches!(
        index.closest_vertex_batch(&[DVec3::ZERO, bad], ALL),
        Err(QueryError::NonFinitePoint(_))
    ));
    let nan = ClosestOptions { max_distance: f64::NAN, ..ALL };
    assert_eq!(index.closest_edge(DVec3::ZERO, nan), Err(QueryError::MaxDistance));
    let none = ClosestOptions { max_distance: -1.0, ..ALL };
    assert_eq!(index.closest_face(DVec3::ZERO, none), Ok(None));
    assert!(mesh.closed().expect("closed").contains(bad).is_err());
    let empty = Mesh::default();
    assert_eq!(empty.index().closest_point(DVec3::ZERO, ALL), Ok(None));
    assert_eq!(empty.index().closest_vertex(DVec3::ZERO, ALL), Ok(None));
    assert_eq!(empty.index().closest_face_center(DVec3::ZERO, ALL), Ok(None));
    let lone =
        Mesh::build(&IndexedMesh::new(vec![DVec3::ONE], vec![].into()).expect("a pool")).expect("a mesh");
    assert_eq!(
        lone.index().closest_vertex(DVec3::ZERO, ALL).expect("asked").map(|n| n.point),
        Some(DVec3::ONE)
    );
}

#[test]
fn extreme_points_and_sizes_are_answered() {
    for scale in [1e-300, 1e-9, 1.0, 1e9, 1e300] {
        let mut pool = shapes::cube();
        pool.map_positions(|p| p * scale).expect("finite");
        let mesh = shapes::mesh(&pool);
        let index = mesh.index();
        for far in [0.25, 1e3, 1e8, 1e17] {
            if scale * far > 1e307 {
                continue;
            }
            let p = dvec3(0.5, 0.25, 1.0 + far) * scale;
            let found = index.closest_point(p, ALL).expect("asked well").expect("a point");
            assert!(
                found.point.distance(dvec3(0.5, 0.25, 1.0) * scale) <= 1e-6 * scale.max(far * scale * 1e-9)
            );
            assert!((found.distance / scale - far).abs() <= 1e-9 * far, "{scale} {far}");
            // Farther away f64 does not tell near sides from far ones.
            assert!(found.side == Side::Outside || far > 1e8);
        }
        let found = index.closest_vertex(DVec3::splat(f64::MAX), ALL).expect("asked well");
        assert!(found.is_some(), "which of them f64 does not tell");
    }
}

#[test]
fn faces_without_area_and_edges_without_length_are_lines_and_points() {
    let line = shapes::pool(vec![DVec3::ZERO, DVec3::X * 2.0, DVec3::X], vec![vec![0, 1, 2]]);
    let mesh = shapes::mesh(&line);
    let found = mesh.index().closest_point(dvec3(1.5, 1.0, 0.0), ALL).expect("asked well").expect("a point");
    assert_eq!((found.point, found.distance), (dvec3(1.5, 0., 0.), 1.0));
    let spot = shapes::pool(vec![DVec3::ONE; 3], vec![vec![0, 1, 2]]);
    let mesh = shapes::mesh(&spot);
    let index = mesh.index();
    let found = index.closest_point(dvec3(1., 1., 3.), ALL).expect("asked well").expect("a point");
    assert_eq!((found.point, found.distance, found.side), (DVec3::ONE, 2.0, Side::On));
    let edge = index.closest_edge(dvec3(1., 1., 3.), ALL).expect("asked well").expect("an edge");
    assert_eq!((edge.point, edge.distance), (DVec3::ONE, 2.0));
}

#[test]
fn the_side_is_right_at_faces_edges_and_vertices() {
    let mut noise = Noise(22);
    for pool in [shapes::icosphere(2), shapes::fanned(&shapes::torus(9, 7)), shapes::cube()] {
        let mesh = shapes::mesh(&pool);
        let solid = mesh.closed().expect("closed").index();
        let mut features = [0; 3];
        for _ in 0..2000 {
            let p = point(&mut noise, 6.0);
            let near = solid.index().closest_point(p, ALL).expect("asked well").expect("a point");
            assert_eq!(near.side, solid.contains(p).expect("asked well"), "{p} {near:?}");
            let kind = match near.feature {
                Feature::Face(_) => 0,
                Feature::Edge(_) => 1,
                Feature::Vertex(_) => 2,
            };
            features[kind] += 1;
        }
        assert!(features.iter().all(|&n| n > 20), "{features:?}");
    }
}

#[test]
fn contains_counts_windings_and_knows_the_surface() {
    let mut outer = shapes::cube();
    outer.map_positions(|p| p * 3.0).expect("finite");
    let cavity = shapes::both(&outer, &shapes::cube_at(DVec3::ONE).reversed());
    let overlap = shapes::both(&shapes::cube(), &shapes::cube_at(DVec3::splat(0.5)));
    let ask = |pool: &IndexedMesh, p: DVec3| {
        let mesh = shapes::mesh(pool);
        let solid = mesh.closed().expect("closed");
        let index = solid.index();
        assert_eq!(solid.contains(p), index.contains(p), "{p}");
        index.winding_number(p).expect("asked well")
    };
    assert_eq!(ask(&cavity, DVec3::splat(0.5)), Some(1));
    assert_eq!(ask(&cavity, DVec3::splat(1.5)), Some(0));
    assert_eq!(ask(&cavity, DVec3::splat(1.0)), None);
    assert_eq!(ask(&cavity, dvec3(1.0, 1.25, 1.5)), None);
    assert_eq!(ask(&cavity, dvec3(1.0f64.next_down(), 1.25, 1.5)), Some(1));
    assert_eq!(ask(&cavity, dvec3(1.0f64.next_up(), 1.25, 1.5)), Some(0));
    assert_eq!(ask(&overlap, DVec3::splat(0.75)), Some(2));
    assert_eq!(ask(&shapes::cube().reversed(), DVec3::splat(0.75)), Some(-1));
    let mut far = shapes::cube();
    far.map_positions(|p| p + 1e6).expect("finite");
    assert_eq!(ask(&far, DVec3::splat(1e6)), None);
    assert_eq!(ask(&far, dvec3(1e6, 1e6 + 0.5, 1e6f64.next_up())), None);
    assert_eq!(ask(&far, DVec3::splat(1e6f64.next_up())), Some(1));
    assert_eq!(ask(&far, DVec3::splat(1e6f64.next_down())), Some(0));
    let mesh = shapes::mesh(&shapes::icosphere(3));
    let solid = mesh.closed().expect("closed");
    let mut noise = Noise(23);
    let points: Vec<DVec3> = (0..500).map(|_| point(&mut noise, 2.5)).collect();
    let sides = solid.contains_batch(&points).expect("asked well");
    assert!(points.iter().zip(&sides).all(|(&p, &side)| solid.contains(p) == Ok(side)));
    assert!(sides.contains(&Side::Inside) && sides.contains(&Side::Outside));
    // Every vertex is on the surface, exactly.
    let index = solid.index();
    assert!(mesh.vertices().all(|v| index.contains(mesh.position(v)) == Ok(Side::On)));
}

#[test]
fn batches_are_the_single_answers_in_order() {
    let mesh = shapes::mesh(&shapes::icosphere(3));
    let index = mesh.index();
    let mut noise = Noise(24);
    let points: Vec<DVec3> = (0..300).map(|_| point(&mut noise, 3.0)).collect();
    let each = |f: &dyn Fn(DVec3) -> f64| points.iter().map(|&p| f(p)).collect::<Vec<_>>();
    let single = each(&|p| index.closest_point(p, ALL).expect("asked").expect("found").distance);
    let batch = index.closest_point_batch(&points, ALL).expect("asked");
    assert_eq!(batch.iter().flatten().map(|n| n.distance).collect::<Vec<_>>(), single);
    let single = each(&|p| index.closest_edge(p, ALL).expect("asked").expect("found").distance);
    let batch = index.closest_edge_batch(&points, ALL).expect("asked");
    assert_eq!(batch.iter().flatten().map(|n| n.distance).collect::<Vec<_>>(), single);
    assert_eq!(index.closest_face_batch(&points, ALL).expect("asked").len(), 300);
    assert_eq!(index.closest_face_center_batch(&points, ALL).expect("asked").len(), 300);
}

#[test]
fn batches_about_a_large_mesh_are_the_single_answers_in_order() {
    let mesh = shapes::mesh(&shapes::icosphere(6));
    let index = mesh.index();
    let mut noise = Noise(26);
    // Far ones, and some where there are ties.
    let mut points: Vec<DVec3> = (0..3000).map(|i| point(&mut noise, [3.0, 3e300][i % 2])).collect();
    points.extend(mesh.vertices().take(500).map(|v| mesh.position(v)));
    let single: Vec<_> = points.iter().map(|&p| index.closest_point(p, ALL).expect("asked well")).collect();
    assert_eq!(index.closest_point_batch(&points, ALL).expect("asked well"), single);
    points[2000].y = f64::NAN;
    points[1000].x = f64::INFINITY;
    let refused = QueryError::NonFinitePoint(points[1000]);
    assert_eq!(index.closest_point_batch(&points, ALL), Err(refused), "the first of them");
}

fn near(a: DMat3, b: DMat3, slack: f64) -> bool {
    (a - b).to_cols_array().iter().all(|x| x.abs() <= slack)
}

#[test]
fn mass_properties_of_boxes_are_those_of_the_books() {
    // A box of 2 x 3 x 4: m / 12 (b^2 + c^2).
    for offset in [0.0, 1e6] {
        let mut pool = shapes::cube();
        pool.map_positions(|p| p * dvec3(2., 3., 4.) + offset).expect("finite");
        let mass = shapes::mesh(&pool).closed().expect("closed").mass_properties().expect("a volume");
        let expected = DMat3::from_diagonal(dvec3(50., 40., 26.));
        assert!(near(mass.inertia, expected, 1e-9), "{offset}: {:?}", mass.inertia);
        assert!((mass.volume - 24.0).abs() < 1e-9 && (mass.area - 52.0).abs() < 1e-9);
    }
    // A cavity subtracts: 27 * 18 / 12 - 1 / 6.
    let mut outer = shapes::cube();
    outer.map_positions(|p| p * 3.0).expect("finite");
    let cavity = shapes::mesh(&shapes::both(&outer, &shapes::cube_at(DVec3::ONE).reversed()));
    let mass = cavity.closed().expect("closed").mass_properties().expect("a volume");
    assert_eq!(mass.volume, 26.0);
    assert!(near(mass.inertia, DMat3::IDENTITY * (27.0 * 1.5 - 1.0 / 6.0), 1e-12));
    let flat = shapes::both(&shapes::cube(), &shapes::cube().reversed());
    assert!(shapes::mesh(&flat).closed().expect("closed").mass_properties().is_none());
}

#[test]
fn inertia_turns_with_the_solid_and_a_tilted_one_has_products() {
    let turn = DMat3::from_axis_angle(dvec3(1., 2., 3.).normalize(), 0.7);
    let mut pool = shapes::cube();
    pool.map_positions(|p| turn * (p * dvec3(2., 3., 4.))).expect("finite");
    let mass = shapes::mesh(&pool).closed().expect("closed").mass_properties().expect("a volume");
    let expected = turn * DMat3::from_diagonal(dvec3(50., 40., 26.)) * turn.transpose();
    assert!(near(mass.inertia, expected, 1e-10), "{:?}", mass.inertia);
}

#[test]
fn libigl_agrees_on_distances_windings_and_moments() {
    let mut igl = igl::Igl::start();
    let mut noise = Noise(25);
    let two = shapes::both(&shapes::cube(), &shapes::cube_at(DVec3::splat(3.0)));
    for pool in [shapes::icosphere(3), shapes::fanned(&shapes::torus(12, 8)), shapes::fanned(&two)] {
        let points: Vec<DVec3> = (0..1000).map(|_| point(&mut noise, 6.0)).collect();
        let theirs = igl.ask_about(&pool, &points);
        let mesh = shapes::mesh(&pool);
        let solid = mesh.closed().expect("closed").index();
        let ours = solid.index().closest_point_batch(&points, ALL).expect("asked well");
        for (near, square) in ours.iter().flatten().zip(theirs.numbers("point_square")) {
            assert!((near.distance * near.distance - square).abs() < 1e-9);
        }
        for (&p, theirs) in points.iter().zip(theirs.numbers("point_winding")) {
            let ours = solid.winding_number(p).expect("asked well").expect("not on the surface");
            assert!((f64::from(ours) - theirs).abs() < 1e-6, "{p}");
        }
        let inertia = mesh.closed().expect("closed").mass_properties().expect("a volume").inertia;
        let expected = DMat3::from_cols_slice(&theirs.numbers("inertia"));
        assert!(near(inertia, expected, 1e-9 * inertia.x_axis.length()), "{inertia} {expected}");
    }
}
