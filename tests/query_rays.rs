//! Rays: exact, watertight, and in agreement with the winding number on the whole way.

mod corpus;
#[path = "tutorial/naive.rs"]
mod naive;
mod shapes;

use meshwright::cleanup::{CleanOptions, clean};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{Crossing, Feature, IndexedMesh, Mesh, PolygonSoup, Polygons, Ray, RayError, RayHit};
use proptest::prelude::*;
use shapes::Noise;

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray::new(origin, direction).expect("a ray")
}

fn crossings(hits: &[RayHit]) -> usize {
    hits.iter().filter(|h| h.crossing != Crossing::Touch).count()
}

/// How often the surface winds about a point, by solid angles (Van Oosterom and Strackee, "The Solid Angle of a Plane
/// Triangle", 1983); `None` if that is not nearly whole, as on the surface.
fn winding(pool: &IndexedMesh, point: DVec3) -> Option<i32> {
    let mut sum = 0.0;
    for f in pool.polygons().iter() {
        for i in 1..f.len() - 1 {
            let [a, b, c] = [f[0], f[i], f[i + 1]].map(|v| pool.positions()[v as usize] - point);
            let (la, lb, lc) = (a.length(), b.length(), c.length());
            let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
            sum += 2.0 * a.dot(b.cross(c)).atan2(below);
        }
    }
    let turns = sum / (4.0 * std::f64::consts::PI);
    ((turns - turns.round()).abs() < 1e-4).then_some(turns.round() as i32)
}

/// Whether a point lies on a face, as near as f64 tells.
fn is_on(mesh: &Mesh, point: DVec3) -> bool {
    mesh.closed().is_ok_and(|solid| solid.contains(point) == Ok(meshwright::Side::On))
}

/// Follows a ray: between its hits the winding number is what the crossings so far make of that at the origin.
fn follow(pool: &IndexedMesh, mesh: &Mesh, index: &meshwright::MeshIndex<'_>, r: &Ray) -> usize {
    let hits = index.hits(r);
    let context = || format!("{r:?}: {hits:#?}");
    assert!(hits.iter().all(|h| h.t >= 0.0), "{}", context());
    assert!(hits.windows(2).all(|w| w[0].t <= w[1].t), "{}", context());
    assert_eq!(index.first_hit(r), hits.first().copied(), "{}", context());
    assert_eq!(index.is_hit(r), !hits.is_empty(), "{}", context());
    for h in &hits {
        let at = h.corners.iter().zip(h.barycentrics).map(|(&v, w)| mesh.position(v) * w).sum::<DVec3>();
        let size = at.length() + (at - r.origin()).length();
        assert!(at.distance(h.point) <= 1e-12 * size, "{}", context());
        assert!(r.at(h.t).distance(h.point) <= 1e-9 * size, "{}", context());
        assert!(h.barycentrics.iter().all(|w| (-1e-12..=1.0 + 1e-12).contains(w)), "{}", context());
        let on_it = |v| mesh.face_vertices(h.face).any(|w| w == v);
        assert!(h.corners.into_iter().all(on_it), "{}", context());
        match h.feature {
            Feature::Face(f) => assert_eq!(f, h.face),
            Feature::Edge(e) => assert!(mesh.face_edges(h.face).any(|g| g == e)),
            Feature::Vertex(v) => assert!(on_it(v) && h.point == mesh.position(v)),
        }
    }
    let Some(mut inside) = winding(pool, r.origin()).filter(|_| !is_on(mesh, r.origin())) else { return 0 };
    assert_eq!(crossings(&hits) % 2, inside.unsigned_abs() as usize % 2, "parity: {}", context());
    let mut checked = 1;
    for (i, h) in hits.iter().enumerate() {
        inside += match h.crossing {
            Crossing::Enter => 1,
            Crossing::Leave => -1,
            Crossing::Touch => 0,
        };
        let next = hits.get(i + 1).map_or(h.t + 1.0, |n| n.t);
        let middle = r.at((h.t + next) / 2.0);
        // On the surface, and a hair from it, the solid angle tells nothing.
        if next - h.t > 1e-6 * next
            && !is_on(mesh, middle)
            && let Some(there) = winding(pool, middle)
        {
            assert_eq!(inside, there, "after hit {i}: {}", context());
            checked += 1;
        }
    }
    assert_eq!(inside, 0, "outside at the end: {}", context());
    checked
}

/// A cube of side 3 with a cube of side 1 cut out of its middle.
fn cavity() -> IndexedMesh {
    let mut outer = shapes::cube();
    outer.map_positions(|p| p * 3.0).expect("finite");
    shapes::both(&outer, &shapes::cube_at(DVec3::ONE).reversed())
}

/// The surface of some of the voxels of a 3 x 3 x 3 block, as quads, and made a manifold.
fn voxels(noise: &mut Noise) -> Mesh {
    let filled: Vec<bool> = (0..27).map(|_| noise.below(3) > 0).collect();
    let is_filled =
        |p: [i32; 3]| p.iter().all(|x| (0..3).contains(x)) && filled[(p[0] + 3 * p[1] + 9 * p[2]) as usize];
    let mut positions = Vec::new();
    let mut faces: Vec<Vec<u32>> = Vec::new();
    for i in (0..27).filter(|&i| filled[i]) {
        let at = [i as i32 % 3, i as i32 / 3 % 3, i as i32 / 9];
        for (axis, step) in [(0, -1), (0, 1), (1, -1), (1, 1), (2, -1), (2, 1)] {
            let mut beside = at;
            beside[axis] += step;
            if is_filled(beside) {
                continue;
            }
            let mut corner = |u: i32, v: i32| {
                let mut p = at;
                p[axis] += i32::from(step > 0);
                p[(axis + 1) % 3] += u;
                p[(axis + 2) % 3] += v;
                positions.push(dvec3(f64::from(p[0]), f64::from(p[1]), f64::from(p[2])));
                positions.len() as u32 - 1
            };
            let mut quad = vec![corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            if step < 0 {
                quad.reverse();
            }
            faces.push(quad);
        }
    }
    let soup = PolygonSoup::new(positions, Polygons::from(faces));
    clean(&soup, CleanOptions::default()).expect("always answers").value
}

/// A whole number from `low` to `high`.
fn whole(noise: &mut Noise, low: i32, high: i32) -> f64 {
    f64::from(low + noise.below((high - low + 1) as u32) as i32)
}

#[test]
fn the_cubes_main_diagonal_crosses_twice() {
    for pool in [shapes::cube(), shapes::fanned(&shapes::cube())] {
        let mesh = shapes::mesh(&pool);
        let index = mesh.index();
        for corner in 0..8 {
            let d =
                dvec3(f64::from(corner & 1), f64::from(corner >> 1 & 1), f64::from(corner >> 2)) * 2.0 - 1.0;
            let hits = index.hits(&ray(DVec3::splat(0.5) - d, d));
            let found: Vec<_> = hits.iter().map(|h| (h.t, h.crossing)).collect();
            assert_eq!(found, [(0.5, Crossing::Enter), (1.5, Crossing::Leave)]);
            assert!(hits.iter().all(|h| matches!(h.feature, Feature::Vertex(_))));
        }
    }
}

#[test]
fn the_diagonal_of_a_face_is_crossed_once_and_is_no_edge_of_a_polygon() {
    let through = ray(dvec3(0.5, 0.5, 2.0), DVec3::NEG_Z);
    let quads = shapes::mesh(&shapes::cube());
    let hits = quads.index().hits(&through);
    assert_eq!(hits.iter().map(|h| h.t).collect::<Vec<_>>(), [1.0, 2.0]);
    assert!(hits.iter().all(|h| h.feature == Feature::Face(h.face)));
    let triangles = shapes::mesh(&shapes::fanned(&shapes::cube()));
    let hits = triangles.index().hits(&through);
    assert_eq!(hits.iter().map(|h| h.t).collect::<Vec<_>>(), [1.0, 2.0]);
    assert!(hits.iter().all(|h| matches!(h.feature, Feature::Edge(_))));
}

#[test]
fn grazing_an_edge_a_vertex_or_a_face_is_one_touch() {
    for pool in [shapes::cube(), shapes::fanned(&shapes::cube())] {
        let mesh = shapes::mesh(&pool);
        let index = mesh.index();
        let touch = |origin, direction| {
            let hits = index.hits(&ray(origin, direction));
            assert_eq!(hits.len(), 1, "{hits:#?}");
            assert_eq!(hits[0].crossing, Crossing::Touch);
            hits[0]
        };
        let edge = touch(dvec3(2., 0., 0.5), dvec3(-1., -1., 0.) + dvec3(0., 2., 0.));
        assert!(matches!(edge.feature, Feature::Edge(_)));
        assert_eq!(edge.point, dvec3(1., 1., 0.5));
        let vertex = touch(dvec3(2., 2., 0.), dvec3(-1., -1., 1.));
        assert!(matches!(vertex.feature, Feature::Vertex(_)));
        let along_edge = touch(dvec3(-1., 0., 0.), DVec3::X);
        assert_eq!(along_edge.t, 1.0);
        let in_face = touch(dvec3(-1., 0.5, 1.), DVec3::X);
        assert_eq!((in_face.t, in_face.point), (1.0, dvec3(0., 0.5, 1.)));
        touch(dvec3(-1., -1., 1.), dvec3(1., 1., 0.));
        // From a point of the face on.
        assert_eq!(touch(dvec3(0.25, 0.5, 1.), DVec3::X).t, 0.0);
    }
}

#[test]
fn a_ray_that_runs_along_a_tread_crosses_at_the_riser_once() {
    // Two cubes side by side and one on top: an L.
    let l = shapes::pool(
        [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
            .into_iter()
            .flat_map(|(x, z)| [dvec3(x.into(), 0., z.into()), dvec3(x.into(), 1., z.into())])
            .collect(),
        {
            let side = |i: u32| vec![2 * i, 2 * i + 1, (2 * i + 3) % 12, (2 * i + 2) % 12];
            let mut faces: Vec<Vec<u32>> = (0..6).map(side).collect();
            faces.push((0..6).map(|i| 2 * i).collect());
            faces.push((0..6).rev().map(|i| 2 * i + 1).collect());
            faces
        },
    );
    let mesh = shapes::mesh(&l);
    let volume = mesh.closed().expect("closed").volume();
    assert_eq!(volume.abs(), 3.0);
    let hits = mesh.index().hits(&ray(dvec3(3., 0.5, 1.), DVec3::NEG_X));
    let sides: Vec<_> = hits.iter().map(|h| (h.t, h.crossing)).collect();
    let (first, last) =
        if volume > 0.0 { (Crossing::Enter, Crossing::Leave) } else { (Crossing::Leave, Crossing::Enter) };
    assert_eq!(sides, [(1.0, first), (3.0, last)]);
    // Between the tread and the ceiling it touches only.
    let hits = mesh.index().hits(&ray(dvec3(1.5, -1., 1.), DVec3::Y));
    assert_eq!(hits.iter().map(|h| (h.t, h.crossing)).collect::<Vec<_>>(), [(1.0, Crossing::Touch)]);
}

#[test]
fn the_rim_of_an_open_surface_is_touched() {
    let mesh = shapes::mesh(&shapes::pool(
        vec![DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y],
        vec![vec![0, 1, 2, 3]],
    ));
    let index = mesh.index();
    let look = |x, y| {
        let hits = index.hits(&ray(dvec3(x, y, 1.), DVec3::NEG_Z));
        hits.iter().map(|h| h.crossing).collect::<Vec<_>>()
    };
    assert_eq!(look(0.5, 0.5), [Crossing::Enter], "on the cut");
    assert_eq!(look(0.0, 0.5), [Crossing::Touch]);
    assert_eq!(look(1.0, 1.0), [Crossing::Touch]);
    assert_eq!(look(1.0 + f64::EPSILON, 1.0), []);
}

#[test]
fn open_cubes_are_hit_from_both_sides() {
    let mut faces: Vec<Vec<u32>> = shapes::cube().polygons().iter().map(<[u32]>::to_vec).collect();
    faces.remove(0);
    let mesh = shapes::mesh(&shapes::pool(shapes::cube().positions().to_vec(), faces));
    let hits = mesh.index().hits(&ray(dvec3(0.5, 0.5, -1.), DVec3::Z));
    assert_eq!(hits.iter().map(|h| (h.t, h.crossing)).collect::<Vec<_>>(), [(2.0, Crossing::Leave)]);
}

#[test]
fn what_is_no_ray_is_refused_and_no_mesh_is_not_hit() {
    assert_eq!(Ray::new(DVec3::ONE, DVec3::ZERO), Err(RayError::ZeroDirection));
    assert_eq!(Ray::new(DVec3::ONE, DVec3::INFINITY), Err(RayError::NonFiniteDirection(DVec3::INFINITY)));
    assert!(matches!(Ray::new(DVec3::NAN, DVec3::X), Err(RayError::NonFiniteOrigin(_))));
    let empty = Mesh::default();
    let r = ray(DVec3::ZERO, DVec3::X);
    assert!(empty.index().hits(&r).is_empty() && empty.index().first_hit(&r).is_none());
    assert!(!empty.index().is_hit(&r));
}

#[test]
fn whole_numbered_rays_keep_account_of_the_winding_number() {
    let mut noise = Noise(1);
    let named = [
        shapes::cube(),
        shapes::cubes_at_an_edge(),
        shapes::cubes_at_a_vertex(),
        shapes::tetrahedron(),
        cavity(),
    ];
    let mut meshes: Vec<Mesh> =
        named.iter().flat_map(|p| [shapes::mesh(p), shapes::mesh(&shapes::fanned(p))]).collect();
    meshes.extend((0..40).map(|_| voxels(&mut noise)));
    let mut checked = 0;
    for mesh in &meshes {
        let pool = mesh.to_indexed();
        let index = mesh.index();
        for _ in 0..400 {
            // Origins on the grid and half-way, directions along axes, diagonals and knight's moves.
            let origin =
                dvec3(whole(&mut noise, -4, 10), whole(&mut noise, -4, 10), whole(&mut noise, -4, 10)) / 2.0;
            let direction =
                dvec3(whole(&mut noise, -2, 2), whole(&mut noise, -2, 2), whole(&mut noise, -2, 2));
            if direction != DVec3::ZERO {
                checked += follow(&pool, mesh, &index, &ray(origin, direction));
            }
        }
    }
    assert!(checked > 15_000, "{checked}");
}

#[test]
fn far_from_the_origin_and_at_any_scale_it_is_the_same() {
    let mut noise = Noise(2);
    let changes: [(&str, f64, f64); 6] = [
        ("far", 1.0, 1e6),
        ("farther", 1.0, 1_099_511_627_776.0),
        ("tiny", f64::from_bits(0x0010_0000_0000_0000) * 1024.0, 0.0),
        ("small", 9.313225746154785e-10, 0.0),
        ("huge", f64::from_bits(0x7f00_0000_0000_0000), 0.0),
        ("subnormal", 5e-324 * 1024.0, 0.0),
    ];
    for round in 0..8 {
        let mesh = voxels(&mut noise);
        let pool = mesh.to_indexed();
        let index = mesh.index();
        for (name, scale, offset) in changes {
            let mut changed = pool.clone();
            changed.map_positions(|p| p * scale + offset).expect("finite");
            let other = shapes::mesh(&changed);
            let other_index = other.index();
            for _ in 0..100 {
                let origin =
                    dvec3(whole(&mut noise, -4, 10), whole(&mut noise, -4, 10), whole(&mut noise, -4, 10))
                        / 2.0;
                let direction =
                    dvec3(whole(&mut noise, -2, 2), whole(&mut noise, -2, 2), whole(&mut noise, -2, 2));
                if direction == DVec3::ZERO {
                    continue;
                }
                let here = index.hits(&ray(origin, direction));
                let there = other_index.hits(&ray(origin * scale + offset, direction * scale));
                let short = |hits: &[RayHit]| {
                    hits.iter().map(|h| (h.crossing, (h.t * 1024.0).round())).collect::<Vec<_>>()
                };
                assert_eq!(short(&here), short(&there), "{name} {round}: {origin} {direction}");
            }
        }
    }
}

#[test]
fn rays_aimed_at_vertices_edges_and_faces_of_curved_shapes_keep_account() {
    let mut noise = Noise(3);
    let mut checked = 0;
    for pool in [shapes::icosphere(2), shapes::torus(9, 7), shapes::fanned(&shapes::torus(8, 6))] {
        let mesh = shapes::mesh(&pool);
        let index = mesh.index();
        let at = |noise: &mut Noise| pool.positions()[noise.below(pool.vertex_count() as u32) as usize];
        for _ in 0..1500 {
            let target = match noise.below(4) {
                0 => at(&mut noise),
                1 => (at(&mut noise) + at(&mut noise)) / 2.0,
                2 => {
                    let f = &pool.polygons()[noise.below(pool.face_count() as u32) as usize];
                    (pool.positions()[f[0] as usize] + pool.positions()[f[1] as usize]) / 2.0
                }
                _ => dvec3(noise.unit(), noise.unit(), noise.unit()) - 0.5,
            };
            let origin = match noise.below(3) {
                0 => dvec3(noise.unit(), noise.unit(), noise.unit()) * 8.0 - 4.0,
                1 => dvec3(target.x, target.y, 5.0),
                _ => dvec3(target.x, -5.0, target.z),
            };
            if target != origin {
                checked += follow(&pool, &mesh, &index, &ray(origin, target - origin));
            }
        }
    }
    assert!(checked > 5000, "{checked}");
}

#[test]
fn generic_rays_hit_what_the_naive_loop_hits() {
    let mut noise = Noise(4);
    let pool = shapes::icosphere(3);
    let (mesh, plain) = (shapes::mesh(&pool), naive::Plain::from(&pool));
    let index = mesh.index();
    let rays: Vec<Ray> = (0..2000)
        .map(|_| {
            let mut point = || dvec3(noise.unit(), noise.unit(), noise.unit()) * 4.0 - 2.0;
            ray(point(), point())
        })
        .collect();
    for (r, hits) in rays.iter().zip(index.hits_batch(&rays)) {
        let naive = naive::raycast(&plain, r.origin(), r.direction());
        assert_eq!(hits.len(), naive.len(), "{r:?}");
        assert!(hits.iter().zip(&naive).all(|(h, t)| (h.t - t.0).abs() < 1e-9));
        assert!(hits.iter().all(|h| h.feature == Feature::Face(h.face)));
    }
    let single: Vec<_> = rays.iter().map(|r| index.first_hit(r)).collect();
    assert_eq!(index.first_hit_batch(&rays), single);
    assert_eq!(index.is_hit_batch(&rays), single.iter().map(Option::is_some).collect::<Vec<_>>());
}

#[test]
fn batches_are_the_single_answers_at_edges_and_vertices_too() {
    let mesh = shapes::mesh(&shapes::icosphere(4));
    let index = mesh.index();
    let mut noise = Noise(6);
    let places: Vec<DVec3> = mesh.vertices().map(|v| mesh.position(v)).collect();
    let rays: Vec<Ray> = (0..3000)
        .map(|i| {
            let point = dvec3(noise.unit(), noise.unit(), noise.unit()) * 4.0 - 2.0;
            let place = places[i * 7 % places.len()];
            match i % 4 {
                0 => ray(point, place - point),
                1 => ray(place, place - point),
                2 => ray(place * 2.0, -place),
                _ => ray(point, -point),
            }
        })
        .collect();
    let single: Vec<_> = rays.iter().map(|r| index.first_hit(r)).collect();
    assert!(single.iter().flatten().any(|hit| matches!(hit.feature, Feature::Vertex(_))));
    assert!(single.iter().any(Option::is_none));
    assert_eq!(index.first_hit_batch(&rays), single);
    assert_eq!(index.is_hit_batch(&rays), rays.iter().map(|r| index.is_hit(r)).collect::<Vec<_>>());
    let firsts: Vec<_> = rays.iter().map(|r| index.hits(r).into_iter().next()).collect();
    assert_eq!(single, firsts);
    let none = Mesh::default();
    assert_eq!(none.index().first_hit_batch(&rays), vec![None; rays.len()]);
    assert_eq!(none.index().is_hit_batch(&rays), vec![false; rays.len()]);
}

#[test]
fn faces_without_area_do_no_harm() {
    // A cube's top is cut into triangles, of which some have no area: a vertex on an edge.
    let mut noise = Noise(5);
    let base = shapes::fanned(&shapes::cube());
    let mut points = base.positions().to_vec();
    let mut faces: Vec<Vec<u32>> = base.polygons().iter().map(<[u32]>::to_vec).collect();
    // Each triangle in three, by a point on one of its edges: one of the three is flat.
    for f in 0..faces.len() {
        let t = faces[f].clone();
        let i = noise.below(3) as usize;
        let (a, b, c) = (t[i], t[(i + 1) % 3], t[(i + 2) % 3]);
        points.push((points[a as usize] + points[b as usize]) / 2.0);
        let m = points.len() as u32 - 1;
        faces[f] = vec![a, m, c];
        faces.push(vec![m, b, c]);
        faces.push(vec![a, b, m]);
    }
    let pool = shapes::pool(points, faces);
    let mesh = shapes::mesh(&pool);
    let index = mesh.index();
    for _ in 0..2000 {
        let origin =
            dvec3(whole(&mut noise, -2, 6), whole(&mut noise, -2, 6), whole(&mut noise, -2, 6)) / 4.0;
        let direction = dvec3(whole(&mut noise, -2, 2), whole(&mut noise, -2, 2), whole(&mut noise, -2, 2));
        if direction != DVec3::ZERO {
            follow(&pool, &mesh, &index, &ray(origin, direction));
        }
    }
}

#[test]
fn rays_from_the_end_of_the_world_arrive() {
    let mesh = shapes::mesh(&shapes::cube());
    let index = mesh.index();
    for far in [1e3, 1e9, 1e18, 1e100, 1e280] {
        let hits = index.hits(&ray(dvec3(-far, 0.5, 0.25), DVec3::X));
        assert_eq!(crossings(&hits), 2, "{far}");
        assert_eq!(hits[0].point, dvec3(0., 0.5, 0.25), "{far}");
        let hits = index.hits(&ray(DVec3::splat(-far), DVec3::ONE));
        assert_eq!(crossings(&hits), 2, "{far}");
        assert!(index.hits(&ray(dvec3(-far, 1.0f64.next_up(), 0.25), DVec3::X)).is_empty());
    }
    let short = index.hits(&ray(dvec3(-1., 0.5, 0.25), DVec3::X * 1e-310));
    assert_eq!(crossings(&short), 2);
    let long = index.hits(&ray(dvec3(-1., 0.5, 0.25), DVec3::X * 1e308));
    assert_eq!(long.iter().map(|h| h.t).collect::<Vec<_>>(), [1e-308, 2e-308]);
}

#[test]
fn coplanar_touching_solids_are_left_and_entered() {
    let pool = shapes::both(&shapes::cube(), &shapes::cube_at(DVec3::X));
    let mesh = shapes::mesh(&pool);
    let hits = mesh.index().hits(&ray(dvec3(-1., 0.5, 0.5), DVec3::X));
    assert_eq!(hits.iter().map(|h| h.t).collect::<Vec<_>>(), [1., 2., 2., 3.]);
    assert_eq!(crossings(&hits), 4);
}

#[test]
fn real_parts_are_left_as_often_as_they_are_entered() {
    let Some(rows) = corpus::rows() else { return };
    let mut noise = Noise(6);
    let mut cast = 0;
    for row in rows.iter().filter(|r| r.is_readable()) {
        let Ok(soup) = row.load() else { continue };
        let mesh = clean(&soup, CleanOptions::default()).expect("always answers").value;
        if mesh.face_count() > 100_000 || !mesh.is_closed() {
            continue;
        }
        let index = mesh.index();
        let vertices: Vec<DVec3> = mesh.vertices().map(|v| mesh.position(v)).collect();
        let mut at = || vertices[noise.below(vertices.len() as u32) as usize];
        let bounds = mesh.to_indexed().bounds().expect("faces");
        let outside = bounds.max + (bounds.max - bounds.min) * 0.25;
        for i in 0..60 {
            // From outside through a vertex, a middle of two, or along an axis through a vertex.
            let (target, origin) = match i % 3 {
                0 => (at(), outside),
                1 => ((at() + at()) / 2.0, outside),
                _ => {
                    let p = at();
                    (p, dvec3(p.x, p.y, outside.z))
                }
            };
            if target != origin {
                let hits = index.hits(&ray(origin, target - origin));
                let count = |c| hits.iter().filter(|h| h.crossing == c).count();
                assert_eq!(count(Crossing::Enter), count(Crossing::Leave), "{}: {origin} {target}", row.path);
                cast += 1;
            }
        }
    }
    assert!(cast > 1000, "{cast}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Corners on a small grid make touching, folded and overlapping faces; still everything that goes in comes out.
    #[test]
    fn any_closed_surface_is_crossed_as_its_winding_numbers_tell(
        points in prop::collection::vec((-2i8..3, -2i8..3, -2i8..3), 8),
        rays in prop::collection::vec(((-3i8..4, -3i8..4, -3i8..4), (-2i8..3, -2i8..3, -2i8..3)), 40),
    ) {
        let at = |(x, y, z): (i8, i8, i8)| dvec3(x.into(), y.into(), z.into());
        let positions: Vec<DVec3> = points.into_iter().map(at).collect();
        // The cube's faces over any eight points: closed, and often folded.
        let faces = shapes::fanned(&shapes::cube()).polygons().clone();
        let pool = IndexedMesh::new(positions, faces).expect("a pool");
        let mesh = shapes::mesh(&pool);
        let index = mesh.index();
        let solid = mesh.closed().expect("closed").index();
        for (o, d) in rays {
            if d == (0, 0, 0) {
                continue;
            }
            let r = ray(at(o), at(d));
            let hits = index.hits(&r);
            let net: i32 = hits.iter().map(|h| match h.crossing {
                Crossing::Enter => -1,
                Crossing::Leave => 1,
                Crossing::Touch => 0,
            }).sum();
            // The skew ray of the winding number and this ray agree, though one meets edges and the other does not.
            if let Some(inside) = solid.winding_number(r.origin()).expect("finite") {
                prop_assert_eq!(net, inside);
                prop_assert_eq!(winding(&pool, r.origin()).unwrap_or(inside), inside);
            }
            prop_assert_eq!(index.first_hit(&r), hits.first().copied());
        }
    }
}

#[cfg(feature = "rayon")]
#[test]
fn the_number_of_threads_changes_nothing() {
    let pool = shapes::icosphere(5);
    let mesh = shapes::mesh(&pool);
    let mut noise = Noise(7);
    let mut point = || dvec3(noise.unit(), noise.unit(), noise.unit()) * 4.0 - 2.0;
    let rays: Vec<Ray> = (0..2000).map(|_| ray(point(), point())).collect();
    let run = |threads| {
        let threads = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        threads.install(|| mesh.index().hits_batch(&rays))
    };
    assert_eq!(run(1), run(4));
}
