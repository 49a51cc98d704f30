//! Every invariant broken by hand, and found by name.

use crate::matching::NONE;
use crate::{IndexedMesh, Mesh, Polygons, Violation};
use glam::{DVec3, dvec3};

/// A strip of two quads and a triangle, open.
fn strip() -> Mesh {
    let points = (0..8).map(|i| dvec3(f64::from(i / 2), f64::from(i % 2), 0.0)).collect();
    let faces = vec![vec![0, 2, 3, 1], vec![2, 4, 5, 3], vec![4, 6, 5]];
    Mesh::build(&IndexedMesh::new(points, Polygons::from(faces)).unwrap()).unwrap()
}

fn cube_of(faces: &[[u32; 4]], points: usize) -> Mesh {
    let at = |i: usize| dvec3((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
    let faces: Polygons = faces.iter().copied().collect();
    Mesh::build(&IndexedMesh::new((0..points).map(at).collect(), faces).unwrap()).unwrap()
}

/// The unit cube.
fn cube() -> Mesh {
    cube_of(&[[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]], 8)
}

/// Both checks must see it, whatever else they see.
#[track_caller]
fn finds(mesh: &Mesh, expected: impl Fn(&Violation) -> bool) {
    let found = mesh.violations();
    assert!(found.iter().any(expected), "{found:?}");
    assert_eq!(mesh.validate(), Err(found[0]), "validate tells the first");
}

/// A half-edge slot of the mesh with a face, and one without.
fn inner_and_outer(mesh: &Mesh) -> (usize, usize) {
    let outer = mesh.boundary_slots().next().unwrap() as usize;
    (outer ^ 1, outer)
}

#[test]
fn sound_meshes_have_no_violations() {
    for mesh in [strip(), cube(), Mesh::default()] {
        assert_eq!(mesh.violations(), []);
        assert_eq!(mesh.validate(), Ok(()));
    }
}

#[test]
fn m1_a_column_of_the_wrong_length_is_found() {
    type Damage = fn(&mut Mesh);
    let columns: [(&str, Damage); 8] = [
        ("next", |m| m.next.push(0)),
        ("prev", |m| m.prev.truncate(1)),
        ("origin", |m| m.origin.push(0)),
        ("face", |m| m.face.truncate(1)),
        ("vertex_halfedge", |m| m.vertex_halfedge.push(0)),
        ("face_halfedge", |m| m.face_halfedge.truncate(1)),
        ("positions", |m| m.positions.push(DVec3::ZERO)),
        ("vertex data", |m| m.replace_normals(vec![])),
    ];
    for (name, damage) in columns {
        let mut mesh = strip();
        damage(&mut mesh);
        finds(&mesh, |v| *v == Violation::Storage { column: name });
    }
}

#[test]
fn m1_an_arena_whose_versions_disagree_with_its_slots_is_found() {
    let mut mesh = strip();
    mesh.vertices.set_version(3, 7);
    finds(&mesh, |v| *v == Violation::Storage { column: "vertices" });
    let mut mesh = strip();
    mesh.edges.set_version(1, 0);
    finds(&mesh, |v| *v == Violation::Storage { column: "edges" });
    let mut mesh = strip();
    mesh.faces.set_version(0, 1);
    finds(&mesh, |v| *v == Violation::Storage { column: "faces" });
}

#[test]
fn m2_links_that_lead_nowhere_are_found_in_every_column() {
    type Column = fn(&mut Mesh) -> &mut Vec<u32>;
    let columns: [(&str, Column); 6] = [
        ("next", |m| &mut m.next),
        ("prev", |m| &mut m.prev),
        ("origin", |m| &mut m.origin),
        ("face", |m| &mut m.face),
        ("vertex_halfedge", |m| &mut m.vertex_halfedge),
        ("face_halfedge", |m| &mut m.face_halfedge),
    ];
    for (name, column) in columns {
        for link in [0, 1 << 20, NONE - 1] {
            let mut mesh = strip();
            column(&mut mesh)[2] = link;
            finds(&mesh, |v| matches!(v, Violation::DanglingLink { column, slot: 2, .. } if *column == name));
        }
    }
}

#[test]
fn m2_a_link_to_a_removed_element_is_found() {
    let mut mesh = strip();
    mesh.faces.remove(3);
    finds(&mesh, |v| matches!(v, Violation::DanglingLink { column: "face", link: 3, .. }));
}

#[test]
fn m3_next_and_prev_that_are_not_inverse_are_found() {
    let mut mesh = strip();
    let (inner, _) = inner_and_outer(&mesh);
    mesh.prev[inner] = mesh.next[inner];
    finds(&mesh, |v| matches!(v, Violation::NextPrev(_)));
    let mut mesh = strip();
    mesh.next[inner] = inner as u32;
    finds(&mesh, |v| matches!(v, Violation::NextPrev(_)));
}

#[test]
fn m4_a_gap_between_half_edges_is_found() {
    let mut mesh = strip();
    let (inner, _) = inner_and_outer(&mesh);
    mesh.origin[inner] = if mesh.origin[inner] == 8 { 7 } else { 8 };
    finds(&mesh, |v| matches!(v, Violation::Gap(_)));
}

#[test]
fn m5_an_edge_from_a_vertex_to_itself_is_found() {
    let mut mesh = strip();
    let (inner, _) = inner_and_outer(&mesh);
    mesh.origin[inner] = mesh.origin[inner ^ 1];
    finds(&mesh, |v| matches!(v, Violation::LoopEdge(_)));
}

#[test]
fn m6_a_face_that_changes_along_its_loop_is_found() {
    let mut mesh = strip();
    let (inner, _) = inner_and_outer(&mesh);
    mesh.face[inner] = mesh.face[inner] % 3 + 1;
    finds(&mesh, |v| matches!(v, Violation::FaceChange(_)));
}

#[test]
fn m7_a_face_whose_half_edge_is_another_faces_is_found() {
    let mut mesh = strip();
    mesh.face_halfedge[1] = mesh.face_halfedge[2];
    finds(&mesh, |v| matches!(v, Violation::FaceHalfedge(_)));
}

#[test]
fn m8_a_face_of_two_corners_is_found() {
    let mut mesh = cube();
    // Take an edge out of the loops beside it: its two faces become one loop, and the edge a loop of two for itself.
    let a = mesh.face_halfedge[1] as usize;
    let b = a ^ 1;
    let (f, g) = (mesh.face[a], mesh.face[b]);
    for (h, k) in [(a, b), (b, a)] {
        let (before, after) = (mesh.prev[h] as usize, mesh.next[k] as usize);
        mesh.next[before] = after as u32;
        mesh.prev[after] = before as u32;
    }
    (mesh.next[a], mesh.prev[a], mesh.next[b], mesh.prev[b]) = (b as u32, b as u32, a as u32, a as u32);
    for h in 2..mesh.face.len() {
        if mesh.face[h] == f && h != a {
            mesh.face[h] = g;
            mesh.face_halfedge[g as usize] = h as u32;
        }
    }
    mesh.face[b] = f;
    finds(&mesh, |v| matches!(v, Violation::ShortFace(_)));
}

#[test]
fn m9_a_face_that_names_a_vertex_twice_is_found() {
    let mut mesh = strip();
    // Vertices 1 and 4 are opposite corners of the first quad.
    for v in &mut mesh.origin {
        if *v == 4 {
            *v = 1;
        }
    }
    mesh.vertex_halfedge[4] = NONE;
    finds(&mesh, |v| matches!(v, Violation::RepeatedCorner { .. }));
}

#[test]
fn m10_a_face_with_a_second_loop_is_found() {
    let mut mesh = cube();
    for f in &mut mesh.face {
        if *f == 2 {
            *f = 1;
        }
    }
    mesh.faces.remove(2);
    finds(&mesh, |v| matches!(v, Violation::SecondLoop(_)));
}

#[test]
fn m11_an_edge_without_a_face_is_found() {
    let mut mesh = strip();
    for f in &mut mesh.face {
        if *f == 3 {
            *f = NONE;
        }
    }
    mesh.faces.remove(3);
    finds(&mesh, |v| matches!(v, Violation::FacelessEdge(_)));
}

#[test]
fn m12_a_vertex_whose_half_edge_starts_elsewhere_is_found() {
    let mut mesh = cube();
    mesh.vertex_halfedge[1] = mesh.vertex_halfedge[2];
    finds(&mesh, |v| matches!(v, Violation::VertexHalfedge(_)));
}

#[test]
fn m13_a_boundary_vertex_whose_half_edge_is_inside_is_found() {
    let mut mesh = strip();
    let v = 3;
    let inside = mesh.outgoing_slots(v).find(|&h| mesh.face[h as usize] != NONE).unwrap();
    mesh.vertex_halfedge[v as usize] = inside;
    finds(&mesh, |v| matches!(v, Violation::BoundaryHalfedge(_)));
}

#[test]
fn m14_a_vertex_with_two_fans_is_found() {
    // Two triangles apart; then the second takes vertex 1 of the first.
    let points = (0..6).map(|i| dvec3(f64::from(i), f64::from(i * i), 0.0)).collect();
    let pool = IndexedMesh::from_triangles(points, &[[0, 1, 2], [3, 4, 5]]).unwrap();
    let mut mesh = Mesh::build(&pool).unwrap();
    for v in &mut mesh.origin {
        if *v == 4 {
            *v = 1;
        }
    }
    mesh.vertex_halfedge[4] = NONE;
    finds(&mesh, |v| matches!(v, Violation::Pinch(_)));

    // The same with the boundary strung through both fans, so that one walk sees them all.
    let own = mesh.vertex_halfedge[1] as usize;
    let other =
        mesh.boundary_slots().find(|&h| h as usize != own && mesh.origin[h as usize] == 1).unwrap() as usize;
    let (p, q) = (mesh.prev[own] as usize, mesh.prev[other] as usize);
    (mesh.next[p], mesh.next[q]) = (other as u32, own as u32);
    (mesh.prev[other], mesh.prev[own]) = (p as u32, q as u32);
    finds(&mesh, |v| matches!(v, Violation::Pinch(_)));
}

#[test]
fn m15_a_vertex_that_does_not_know_its_half_edges_is_found() {
    let mut mesh = cube();
    mesh.vertex_halfedge[5] = NONE;
    finds(&mesh, |v| matches!(v, Violation::FalselyIsolated(_)));
}

#[test]
fn m16_two_edges_between_the_same_vertices_are_found() {
    let points = (0..6).map(|i| dvec3(f64::from(i), f64::from(i * i), f64::from(i % 3))).collect();
    let faces = [[0, 2, 1], [0, 3, 2], [1, 2, 3], [0, 1, 4], [0, 4, 5], [1, 5, 4], [0, 5, 3], [1, 3, 5]];
    let pool = IndexedMesh::from_triangles(points, &faces).unwrap();
    let mut mesh = Mesh::build(&pool).unwrap();
    // One vertex takes the place of another that is joined to the same neighbours.
    for v in &mut mesh.origin {
        if *v == 6 {
            *v = 3;
        }
    }
    mesh.vertex_halfedge[6] = NONE;
    finds(&mesh, |v| matches!(v, Violation::ParallelEdges(..)));
}

#[test]
fn m17_two_faces_with_the_same_corners_are_found() {
    // A pillow cannot be built, so sew one from two triangles that lie on each other.
    let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ZERO, DVec3::X, DVec3::Y];
    let pool = IndexedMesh::from_triangles(points, &[[0, 1, 2], [3, 5, 4]]).unwrap();
    let mut mesh = Mesh::build(&pool).unwrap();
    let outline: Vec<u32> = mesh.loop_slots(mesh.face_halfedge[1]).collect();
    for &h in &outline {
        let (a, b) = (mesh.origin[h as usize], mesh.origin[h as usize ^ 1]);
        let across = (2..mesh.next.len())
            .find(|&k| mesh.face[k] == 2 && mesh.origin[k] == b + 3 && mesh.origin[k ^ 1] == a + 3)
            .unwrap();
        // The odd half-edge of each of the first triangle's edges takes the place of the second triangle's.
        mesh.origin[h as usize ^ 1] = b;
        mesh.face[h as usize ^ 1] = 2;
        if mesh.face_halfedge[2] == across as u32 {
            mesh.face_halfedge[2] = h ^ 1;
        }
    }
    for &h in &outline {
        let n = mesh.next[h as usize];
        mesh.next[n as usize ^ 1] = h ^ 1;
        mesh.prev[h as usize ^ 1] = n ^ 1;
        mesh.vertex_halfedge[mesh.origin[h as usize] as usize] = h;
    }
    let on_second = outline[0] ^ 1;
    mesh.face_halfedge[2] = on_second;
    for e in 2..=mesh.edges.slot_count() as u32 {
        if mesh.edges.is_live(e) && !outline.iter().any(|h| h >> 1 == e) {
            mesh.edges.remove(e);
        }
    }
    for v in 4..=6 {
        mesh.vertices.remove(v);
    }
    assert_eq!(mesh.violations().len(), 1);
    finds(&mesh, |v| matches!(v, Violation::DuplicateFaces(..)));
}

#[test]
fn m18_a_position_or_normal_that_is_not_finite_is_found() {
    let mut mesh = cube();
    mesh.positions[3].y = f64::NAN;
    finds(&mesh, |v| matches!(v, Violation::NonFinite(_)));
    let mut mesh = cube();
    mesh.compute_normals(crate::NormalWeight::Area);
    let column = mesh.carried.normals.unwrap().index;
    mesh.write_value(crate::column::Kind::Vertex, column, 2, DVec3::INFINITY);
    finds(&mesh, |v| matches!(v, Violation::NonFinite(_)));
}

#[test]
fn checks_are_safe_on_links_damaged_at_random() {
    let mut state = 1u64;
    let mut random = move |n: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % n
    };
    for round in 0..20_000 {
        let mut mesh = if round % 2 == 0 { strip() } else { cube() };
        let sound = mesh.clone();
        for _ in 0..1 + round % 3 {
            let columns: [&mut Vec<u32>; 6] = [
                &mut mesh.next,
                &mut mesh.prev,
                &mut mesh.origin,
                &mut mesh.face,
                &mut mesh.vertex_halfedge,
                &mut mesh.face_halfedge,
            ];
            let [a, b, c, d, e, f] = columns;
            let column = [a, b, c, d, e, f].into_iter().nth(random(6)).unwrap();
            let at = random(column.len());
            column[at] = [random(30) as u32, NONE, column[random(column.len())]][random(3)];
        }
        // The fast check and the complete one agree.
        assert_eq!(mesh.is_sound(), mesh.violations().is_empty());
        assert_eq!(mesh.validate().is_ok(), mesh.is_sound());
        // Damage outside live entries, or none at all, is none.
        if mesh.is_sound() {
            assert_eq!(mesh.to_indexed().positions(), sound.to_indexed().positions());
        }
    }
}

#[test]
fn ranks_keep_the_users_order_through_the_conversion_back() {
    let mut mesh = strip();
    let vertices = mesh.vertices.slot_count() as u32;
    // As a reordering at build time would leave it: the user's order is the reverse of the slots'.
    mesh.vertices.set_ranks((0..vertices).map(|s| vertices - s).collect());
    mesh.faces.set_ranks(vec![0, 3, 2, 1]);
    let (plain, ranked) = (strip().to_indexed(), mesh.to_indexed());
    let n = plain.vertex_count() as u32;
    let reversed: Vec<DVec3> = plain.positions().iter().rev().copied().collect();
    assert_eq!(ranked.positions(), reversed);
    let expected: Polygons =
        (0..3).rev().map(|f| plain.polygons()[f].iter().map(|v| n - 1 - v).collect::<Vec<_>>()).collect();
    assert_eq!(*ranked.polygons(), expected);
}
