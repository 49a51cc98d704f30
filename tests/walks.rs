//! Walks: their order, what they hold, and what they do with dead keys.

mod shapes;

use meshwright::glam::DVec3;
use meshwright::{EdgeKey, FaceKey, HalfedgeKey, Mesh, VertexKey};
use shapes::{cube, grid, mesh, torus};
use std::collections::BTreeSet;

fn all() -> Vec<Mesh> {
    let open = shapes::pool(
        cube().positions().to_vec(),
        cube().polygons().iter().skip(1).map(<[u32]>::to_vec).collect(),
    );
    [cube(), grid(4), torus(5, 4), shapes::tetrahedron(), open].iter().map(mesh).collect()
}

#[test]
fn elements_are_counted_and_listed_once() {
    for mesh in all() {
        assert_eq!(mesh.vertices().collect::<BTreeSet<_>>().len(), mesh.vertex_count());
        assert_eq!(mesh.edges().collect::<BTreeSet<_>>().len(), mesh.edge_count());
        assert_eq!(mesh.faces().collect::<BTreeSet<_>>().len(), mesh.face_count());
        assert_eq!(mesh.halfedges().collect::<BTreeSet<_>>().len(), 2 * mesh.edge_count());
        assert!(mesh.vertices().rev().eq(mesh.vertices().collect::<Vec<_>>().into_iter().rev()));
    }
}

#[test]
fn steps_lead_back() {
    for mesh in all() {
        for h in mesh.halfedges() {
            assert_eq!(mesh.twin(mesh.twin(h)), h);
            assert_eq!(mesh.prev(mesh.next(h)), h);
            assert_eq!(mesh.rotate_ccw(mesh.rotate_cw(h)), h);
            assert_eq!(mesh.origin(mesh.rotate_cw(h)), mesh.origin(h));
            assert_eq!(mesh.edge(h), mesh.edge(mesh.twin(h)));
            assert_eq!(mesh.target(h), mesh.origin(mesh.twin(h)));
            assert_eq!(mesh.find_halfedge(mesh.origin(h), mesh.target(h)), Some(h));
            let e = mesh.edge_halfedge(mesh.edge(h));
            assert!(e == h || e == mesh.twin(h));
            assert_eq!(mesh.is_boundary(h), mesh.face(h).is_none());
        }
    }
}

#[test]
fn apex_is_the_third_vertex_of_a_triangle_and_of_nothing_else() {
    let tetrahedron = mesh(&shapes::tetrahedron());
    for h in tetrahedron.halfedges() {
        let apex = tetrahedron.apex(h).expect("a triangle");
        assert!(apex != tetrahedron.origin(h) && apex != tetrahedron.target(h));
    }
    let cube = mesh(&cube());
    assert!(cube.halfedges().all(|h| cube.apex(h).is_none()));
    let grid = mesh(&grid(2));
    assert!(grid.boundary_halfedges().all(|h| grid.apex(h).is_none()));
}

#[test]
fn a_walk_around_a_vertex_is_clockwise_and_sees_each_element_once() {
    for mesh in all() {
        for v in mesh.vertices() {
            let out: Vec<HalfedgeKey> = mesh.outgoing(v).collect();
            assert_eq!(out.first().copied(), mesh.vertex_halfedge(v));
            assert_eq!(out.len(), mesh.valence(v));
            for (i, &h) in out.iter().enumerate() {
                assert_eq!(mesh.origin(h), v);
                assert_eq!(mesh.rotate_cw(h), out[(i + 1) % out.len()]);
            }
            // Slowly: every half-edge that starts here.
            let slow: BTreeSet<_> = mesh.halfedges().filter(|&h| mesh.origin(h) == v).collect();
            assert_eq!(out.iter().copied().collect::<BTreeSet<_>>(), slow);
            assert!(mesh.incoming(v).eq(out.iter().map(|&h| mesh.twin(h))));
            assert!(mesh.neighbors(v).eq(out.iter().map(|&h| mesh.target(h))));
            assert!(mesh.edges_around(v).eq(out.iter().map(|&h| mesh.edge(h))));
            assert!(mesh.faces_around(v).eq(out.iter().filter_map(|&h| mesh.face(h))));
            let faces: BTreeSet<_> =
                mesh.faces().filter(|&f| mesh.face_vertices(f).any(|u| u == v)).collect();
            assert_eq!(mesh.faces_around(v).collect::<BTreeSet<_>>(), faces);
        }
    }
}

#[test]
fn clockwise_is_as_seen_from_outside() {
    let mesh = mesh(&cube());
    for v in mesh.vertices() {
        let ring: Vec<DVec3> = mesh.neighbors(v).map(|n| mesh.position(n) - mesh.position(v)).collect();
        let outward = mesh.position(v) - DVec3::splat(0.5);
        assert!(ring[0].cross(ring[1]).dot(outward) < 0.0);
    }
}

#[test]
fn a_walk_around_a_boundary_vertex_begins_at_its_boundary_half_edge() {
    let mesh = mesh(&grid(3));
    for v in mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)) {
        let out: Vec<_> = mesh.outgoing(v).collect();
        assert!(mesh.is_boundary(out[0]));
        assert!(mesh.is_boundary(mesh.twin(out[out.len() - 1])), "the other boundary edge comes last");
        assert_eq!(mesh.faces_around(v).count() + 1, mesh.valence(v));
    }
}

#[test]
fn a_walk_around_a_face_begins_at_its_first_corner() {
    for pool in [cube(), grid(4), torus(5, 4)] {
        let mesh = mesh(&pool);
        let keys: Vec<VertexKey> = mesh.vertices().collect();
        for (f, corners) in mesh.faces().zip(pool.polygons().iter()) {
            assert!(mesh.face_vertices(f).eq(corners.iter().map(|&v| keys[v as usize])));
            assert_eq!(mesh.degree(f), corners.len());
            let loop_: Vec<_> = mesh.face_halfedges(f).collect();
            assert_eq!(loop_[0], mesh.face_halfedge(f));
            assert!(mesh.loop_of(loop_[0]).eq(loop_.iter().copied()));
            assert!(loop_.iter().all(|&h| mesh.face(h) == Some(f)));
            assert!(mesh.face_edges(f).eq(loop_.iter().map(|&h| mesh.edge(h))));
            assert!(mesh.face_neighbors(f).eq(loop_.iter().filter_map(|&h| mesh.face(mesh.twin(h)))));
        }
    }
}

#[test]
fn boundary_loops_hold_every_boundary_half_edge_once() {
    for mesh in all() {
        let loops = mesh.boundary_loops();
        let listed: Vec<HalfedgeKey> = loops.iter().flatten().copied().collect();
        assert_eq!(listed.len(), listed.iter().collect::<BTreeSet<_>>().len());
        assert_eq!(
            listed.iter().copied().collect::<BTreeSet<_>>(),
            mesh.boundary_halfedges().collect::<BTreeSet<_>>()
        );
        for l in loops {
            assert!((0..l.len()).all(|i| mesh.next(l[i]) == l[(i + 1) % l.len()]));
        }
    }
    assert_eq!(mesh(&grid(4)).boundary_loops().len(), 1);
    assert!(mesh(&cube()).boundary_loops().is_empty());
}

#[test]
fn components_hold_every_face_once() {
    let three = shapes::both(&shapes::both(&cube(), &shapes::cube_at(DVec3::splat(4.0))), &torus(4, 3));
    let components = mesh(&three).components();
    assert_eq!(components.iter().map(Vec::len).collect::<Vec<_>>(), [6, 6, 12]);
}

#[test]
fn reversing_one_component_leaves_the_other_alone() {
    let pool = shapes::both(&grid(3), &cube());
    let mut mesh = mesh(&pool);
    let last = mesh.faces().last().expect("a face");
    let keys: Vec<HalfedgeKey> = mesh.halfedges().collect();
    mesh.reverse_component(last).expect("live");
    assert_eq!(mesh.validate(), Ok(()));
    let back = mesh.to_indexed();
    for (f, (old, new)) in pool.polygons().iter().zip(back.polygons().iter()).enumerate() {
        let is_cube = f >= grid(3).face_count();
        assert_eq!(old[0], new[0]);
        assert_eq!(old != new, is_cube);
    }
    mesh.reverse_component(last).expect("live");
    assert_eq!(mesh.to_indexed(), pool);
    assert!(mesh.halfedges().eq(keys), "keys live on");
    assert!(mesh.reverse_component(FaceKey::default()).is_err());
}

#[test]
fn reversal_twice_is_the_identity_for_every_link() {
    for mut mesh in all() {
        let links = |m: &Mesh| {
            let steps =
                m.halfedges().map(|h| (m.next(h), m.prev(h), m.origin(h), m.face(h))).collect::<Vec<_>>();
            let starts = m.vertices().map(|v| m.vertex_halfedge(v)).collect::<Vec<_>>();
            (steps, starts, m.faces().map(|f| m.face_halfedge(f)).collect::<Vec<_>>())
        };
        let before = links(&mesh);
        mesh.reverse();
        assert_eq!(mesh.validate(), Ok(()));
        assert_ne!(links(&mesh), before);
        mesh.reverse();
        assert_eq!(links(&mesh), before);
    }
}

#[test]
fn get_readers_answer_none_to_dead_keys() {
    let mesh = mesh(&cube());
    // Larger than the mesh: every slot of this key is beyond its columns.
    let other = shapes::mesh(&grid(9));
    let (v, f) = (other.vertices().last().expect("a vertex"), other.faces().last().expect("a face"));
    let (e, h) = (other.edges().last().expect("an edge"), other.halfedges().last().expect("a half-edge"));
    for v in [v, VertexKey::default()] {
        assert!(!mesh.contains_vertex(v));
        assert!(mesh.get_position(v).is_none() && mesh.get_normal(v).is_none());
        assert!(
            mesh.get_vertex_halfedge(v).is_none()
                && mesh.get_outgoing(v).is_none()
                && mesh.get_incoming(v).is_none()
        );
        assert!(mesh.get_neighbors(v).is_none() && mesh.get_faces_around(v).is_none());
        assert!(mesh.get_edges_around(v).is_none() && mesh.get_valence(v).is_none());
        assert!(mesh.get_is_boundary_vertex(v).is_none() && mesh.get_is_isolated(v).is_none());
        assert_eq!(mesh.find_halfedge(v, v), None);
    }
    for f in [f, FaceKey::default()] {
        assert!(!mesh.contains_face(f));
        assert!(mesh.get_face_halfedge(f).is_none() && mesh.get_face_halfedges(f).is_none());
        assert!(mesh.get_face_vertices(f).is_none() && mesh.get_face_edges(f).is_none());
        assert!(mesh.get_face_neighbors(f).is_none() && mesh.get_degree(f).is_none());
    }
    for e in [e, EdgeKey::default()] {
        assert!(!mesh.contains_edge(e));
        assert!(mesh.get_edge_halfedge(e).is_none() && mesh.get_is_boundary_edge(e).is_none());
    }
    assert!(!mesh.contains_halfedge(h));
    assert!(mesh.get_next(h).is_none() && mesh.get_prev(h).is_none() && mesh.get_twin(h).is_none());
    assert!(mesh.get_origin(h).is_none() && mesh.get_target(h).is_none() && mesh.get_face(h).is_none());
    assert!(
        mesh.get_edge(h).is_none() && mesh.get_rotate_cw(h).is_none() && mesh.get_rotate_ccw(h).is_none()
    );
    assert!(mesh.get_apex(h).is_none() && mesh.get_is_boundary(h).is_none() && mesh.get_loop_of(h).is_none());
}

#[test]
#[should_panic(expected = "names no live element")]
fn reading_with_a_dead_key_panics_as_documented() {
    mesh(&cube()).position(VertexKey::default());
}
