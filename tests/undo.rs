//! Checkpoints, what they cost, and the record of edits.

mod shapes;

use meshwright::glam::DVec3;
use meshwright::{
    Change, Column, EdgeKey, FaceKey, HalfedgeKey, Lineage, Maps, Mesh, NormalWeight, Rule,
    UnknownCheckpoint, VertexKey,
};
use shapes::{Noise, both, cube, cube_at, grid, icosphere, mesh, torus};

/// Everything that can be asked of a mesh.
fn state(mesh: &Mesh) -> impl PartialEq + use<> {
    let links: Vec<_> =
        mesh.halfedges().map(|h| (h, mesh.next(h), mesh.prev(h), mesh.origin(h), mesh.face(h))).collect();
    let vertices: Vec<_> = mesh
        .vertices()
        .map(|v| {
            (v, mesh.position(v).to_array(), mesh.vertex_halfedge(v), mesh.normal(v).map(|n| n.to_array()))
        })
        .collect();
    let edges: Vec<_> = mesh.edges().map(|e| (e, mesh.edge_halfedge(e))).collect();
    let firsts: Vec<_> = mesh.faces().map(|f| (f, mesh.face_halfedge(f))).collect();
    (links, vertices, edges, firsts, mesh.numbering())
}

/// One of every operator in turn, somewhere; whether it was done.
fn edit(mesh: &mut Mesh, noise: &mut Noise) -> bool {
    let edges: Vec<_> = mesh.edges().collect();
    let faces: Vec<_> = mesh.faces().collect();
    let vertices: Vec<_> = mesh.vertices().collect();
    if edges.is_empty() {
        return mesh.add_vertex(DVec3::ZERO).is_ok();
    }
    let e = edges[noise.below(edges.len() as u32) as usize];
    let f = faces[noise.below(faces.len() as u32) as usize];
    let v = vertices[noise.below(vertices.len() as u32) as usize];
    let p = DVec3::new(noise.unit(), noise.unit(), noise.unit());
    let h = mesh.edge_halfedge(e);
    match noise.below(20) {
        0 => mesh.add_vertex(p).is_ok(),
        1 => mesh.remove_face(f).is_ok(),
        2 => mesh.remove_edge(e).is_ok(),
        3 => mesh.remove_vertex(v).is_ok(),
        4 => mesh.split_edge(e, p).is_ok(),
        5 => mesh.split_edge_and_faces(e, p).is_ok(),
        6 => mesh.poke_face(f, p).is_ok(),
        7 | 8 => mesh.collapse(h, p).is_ok(),
        9 | 10 => mesh.flip_edge(e).is_ok(),
        11 => mesh.join_faces(e).is_ok(),
        12 => mesh.dissolve_vertex(v).is_ok(),
        13 => mesh.triangulate_face(f).is_ok(),
        14 => {
            let open = mesh.boundary_halfedges().next();
            open.is_some_and(|h| mesh.fill_hole(h).is_ok())
        }
        15 => {
            let open: Vec<_> = mesh.boundary_halfedges().take(2).collect();
            open.len() == 2 && mesh.stitch(open[0], open[1]).is_ok()
        }
        16 => mesh.reverse_component(f).is_ok(),
        17 => mesh.set_position(v, p).is_ok(),
        18 => {
            let around: Vec<_> = mesh.outgoing(mesh.origin(h)).collect();
            mesh.split_vertex(h, around[noise.below(around.len() as u32) as usize], p).is_ok()
        }
        _ => {
            let last = mesh.prev(h);
            mesh.split_face(h, last).is_ok()
        }
    }
}

fn edits(mesh: &mut Mesh, noise: &mut Noise, count: u32) {
    let mut done = 0;
    while done < count {
        done += u32::from(edit(mesh, noise));
    }
    mesh.validate().expect("valid");
}

fn starts() -> Vec<Mesh> {
    let two = both(&cube(), &cube_at(DVec3::X * 3.0));
    [icosphere(2), grid(5), torus(6, 5), two].iter().map(mesh).collect()
}

#[test]
fn restore_brings_back_every_key_link_and_position() {
    for (seed, mut mesh) in (0..).zip(starts()) {
        let mut noise = Noise(seed);
        edits(&mut mesh, &mut noise, 50);
        let before = state(&mesh);
        let checkpoint = mesh.checkpoint();
        edits(&mut mesh, &mut noise, 300);
        mesh.restore(checkpoint).expect("known");
        mesh.validate().expect("valid");
        assert!(state(&mesh) == before);
    }
}

#[test]
fn keys_born_since_are_dead_after_restore_and_stay_so() {
    let mut mesh = mesh(&cube());
    let checkpoint = mesh.checkpoint();
    let poke = |m: &mut Mesh| {
        let f = m.faces().next().expect("six");
        m.poke_face(f, DVec3::ONE).expect("finite")
    };
    let first = poke(&mut mesh);
    mesh.restore(checkpoint).expect("known");
    assert!(!mesh.contains_vertex(first.vertex));
    assert!(first.edges.iter().all(|&e| !mesh.contains_edge(e)));
    assert!(first.faces.iter().all(|&f| !mesh.contains_face(f)));
    let second = poke(&mut mesh);
    assert_ne!(first.vertex, second.vertex);
    assert!(!mesh.contains_vertex(first.vertex) && first.edges.iter().all(|&e| !mesh.contains_edge(e)));
}

#[test]
fn checkpoints_nest_and_can_be_restored_again_and_again() {
    for (seed, mut mesh) in (10..).zip(starts()) {
        let mut noise = Noise(seed);
        let mut stack = Vec::new();
        for _ in 0..5 {
            stack.push((mesh.checkpoint(), state(&mesh)));
            edits(&mut mesh, &mut noise, 40);
        }
        for (checkpoint, before) in stack.iter().rev() {
            for _ in 0..3 {
                edits(&mut mesh, &mut noise, 10);
                mesh.restore(*checkpoint).expect("known");
                assert!(state(&mesh) == *before);
            }
        }
        mesh.validate().expect("valid");
    }
}

#[test]
fn restoring_an_earlier_checkpoint_makes_later_ones_unknown() {
    let mut mesh = mesh(&cube());
    let first = mesh.checkpoint();
    let second = mesh.checkpoint();
    mesh.restore(first).expect("known");
    assert_eq!(mesh.restore(second), Err(UnknownCheckpoint));
    assert_eq!(mesh.restore(first), Ok(()));
}

#[test]
fn a_checkpoint_of_another_mesh_is_unknown_and_changes_nothing() {
    let (mut a, mut b) = (mesh(&cube()), mesh(&cube()));
    let of_a = a.checkpoint();
    assert_eq!(b.restore(of_a), Err(UnknownCheckpoint));
    b.checkpoint();
    let f = b.faces().next().expect("six");
    b.poke_face(f, DVec3::ONE).expect("finite");
    let before = state(&b);
    assert_eq!(b.restore(of_a), Err(UnknownCheckpoint));
    assert_eq!(b.forget_checkpoints_before(of_a), Err(UnknownCheckpoint));
    assert!(state(&b) == before);
}

#[test]
fn a_clone_knows_the_checkpoints_of_its_original() {
    let mut a = mesh(&cube());
    let before = state(&a);
    let checkpoint = a.checkpoint();
    let f = a.faces().next().expect("six");
    a.poke_face(f, DVec3::ONE).expect("finite");
    let mut b = a.clone();
    b.restore(checkpoint).expect("cloned too");
    assert!(state(&b) == before && a.face_count() == 9);
}

#[test]
fn forgetting_ends_it() {
    let mut mesh = mesh(&cube());
    let checkpoint = mesh.checkpoint();
    let f = mesh.faces().next().expect("six");
    mesh.poke_face(f, DVec3::ONE).expect("finite");
    let after = state(&mesh);
    assert!(mesh.checkpoint_bytes() > 0);
    mesh.forget_checkpoints();
    assert_eq!((mesh.restore(checkpoint), mesh.checkpoint_bytes()), (Err(UnknownCheckpoint), 0));
    assert!(state(&mesh) == after);
    mesh.validate().expect("valid");
}

#[test]
fn forgetting_older_ones_keeps_the_newer() {
    for (seed, mut mesh) in (20..).zip(starts()) {
        let mut noise = Noise(seed);
        let mut stack = Vec::new();
        for _ in 0..6 {
            stack.push((mesh.checkpoint(), state(&mesh)));
            edits(&mut mesh, &mut noise, 40);
        }
        mesh.forget_checkpoints_before(stack[3].0).expect("known");
        assert!(stack[..3].iter().all(|s| mesh.clone().restore(s.0) == Err(UnknownCheckpoint)));
        for (checkpoint, before) in stack[3..].iter().rev() {
            mesh.restore(*checkpoint).expect("known");
            assert!(state(&mesh) == *before);
            mesh.validate().expect("valid");
        }
    }
}

#[test]
fn slots_of_removed_elements_are_reused_only_after_forgetting() {
    let slots = |mesh: &Mesh| mesh.heap_bytes() - mesh.checkpoint_bytes();
    let mut mesh = mesh(&icosphere(2));
    let churn = |mesh: &mut Mesh| {
        for _ in 0..2000 {
            let f = mesh.faces().next().expect("many");
            let new = mesh.poke_face(f, DVec3::ONE).expect("finite");
            mesh.dissolve_vertex(new.vertex).expect("takes it back");
        }
    };
    let before = slots(&mesh);
    churn(&mut mesh);
    // An unedited mesh keeps no versions, and the first birth doubles the columns.
    assert!(slots(&mesh) < 4 * before, "reused at once without checkpoints");
    mesh.checkpoint();
    churn(&mut mesh);
    let grown = slots(&mesh);
    assert!(grown > 10 * before, "not reused while they can come back");
    mesh.forget_checkpoints();
    churn(&mut mesh);
    assert_eq!(slots(&mesh), grown, "reused again");
}

#[test]
fn user_data_comes_back_with_its_elements() {
    let mut mesh = mesh(&grid(5));
    let rule = || {
        Rule::custom(|_, s: &[(&String, f64)]| s.iter().map(|s| s.0.as_str()).collect::<Vec<_>>().join("+"))
    };
    let on_vertices: Column<VertexKey, String> = mesh.add_column("v".to_owned(), rule());
    let on_corners: Column<HalfedgeKey, String> = mesh.add_column("c".to_owned(), rule());
    let on_edges: Column<EdgeKey, String> = mesh.add_column("e".to_owned(), rule());
    let on_faces: Column<FaceKey, String> = mesh.add_column("f".to_owned(), rule());
    for (i, f) in mesh.faces().collect::<Vec<_>>().into_iter().enumerate() {
        mesh.set_value(on_faces, f, i.to_string()).expect("live");
        for h in mesh.face_halfedges(f).collect::<Vec<_>>() {
            mesh.set_value(on_corners, h, format!("{i}")).expect("inner");
        }
    }
    let data = |m: &Mesh| {
        let v: Vec<_> = m.vertices().map(|v| m.value(on_vertices, v).clone()).collect();
        let c: Vec<_> = m.halfedges().map(|h| m.value(on_corners, h).clone()).collect();
        let e: Vec<_> = m.edges().map(|e| m.value(on_edges, e).clone()).collect();
        let f: Vec<_> = m.faces().map(|f| m.value(on_faces, f).clone()).collect();
        (v, c, e, f)
    };
    let mut noise = Noise(30);
    let mut stack = Vec::new();
    for round in 0..4 {
        stack.push((mesh.checkpoint(), data(&mesh), state(&mesh)));
        edits(&mut mesh, &mut noise, 20);
        let v = mesh.vertices().next().expect("some");
        mesh.set_value(on_vertices, v, format!("set {round}")).expect("live");
    }
    mesh.forget_checkpoints_before(stack[1].0).expect("known");
    for (checkpoint, values, links) in stack[1..].iter().rev() {
        mesh.restore(*checkpoint).expect("known");
        assert!(data(&mesh) == *values && state(&mesh) == *links);
    }
}

#[test]
fn a_column_added_since_stays_and_one_removed_since_stays_gone() {
    let mut mesh = mesh(&cube());
    let old = mesh.add_face_column(1, Rule::keep());
    let f = mesh.faces().next().expect("six");
    let checkpoint = mesh.checkpoint();
    mesh.set_value(old, f, 2).expect("live");
    mesh.remove_face(f).expect("closed");
    let new = mesh.add_face_column(3, Rule::keep());
    mesh.remove_column(old);
    mesh.restore(checkpoint).expect("known");
    assert_eq!((mesh.get_value(old, f), *mesh.value(new, f)), (None, 3));
    mesh.validate().expect("valid");
}

#[test]
fn computed_normals_are_taken_back_if_the_mesh_carried_some() {
    let mut mesh = mesh(&icosphere(1));
    mesh.compute_normals(NormalWeight::Area);
    let before = state(&mesh);
    let checkpoint = mesh.checkpoint();
    let v = mesh.vertices().next().expect("many");
    mesh.set_position(v, DVec3::ONE * 3.0).expect("finite");
    mesh.compute_normals(NormalWeight::Angle);
    mesh.reverse();
    mesh.restore(checkpoint).expect("known");
    assert!(state(&mesh) == before);
}

// The record of edits.

/// What is live, followed through changes.
#[derive(Default, PartialEq, Debug)]
struct Live {
    vertices: std::collections::BTreeSet<VertexKey>,
    edges: std::collections::BTreeSet<EdgeKey>,
    faces: std::collections::BTreeSet<FaceKey>,
}

impl Live {
    fn of(mesh: &Mesh) -> Self {
        Self {
            vertices: mesh.vertices().collect(),
            edges: mesh.edges().collect(),
            faces: mesh.faces().collect(),
        }
    }

    fn follow(mut self, changes: &[Change]) -> Self {
        for change in changes {
            let ok = match change {
                Change::VertexBorn { vertex, .. } => self.vertices.insert(*vertex),
                Change::VertexDied { vertex, .. } => self.vertices.remove(vertex),
                Change::EdgeBorn { edge, .. } => self.edges.insert(*edge),
                Change::EdgeDied { edge, .. } => self.edges.remove(edge),
                Change::FaceBorn { face, .. } => self.faces.insert(*face),
                Change::FaceDied { face, .. } => self.faces.remove(face),
                Change::VertexMoved { vertex } => self.vertices.contains(vertex),
                other => panic!("{other:?}"),
            };
            assert!(ok, "{change:?} does not fit");
        }
        self
    }
}

#[test]
fn the_record_tells_every_birth_and_death_once() {
    for (seed, mut mesh) in (40..).zip(starts()) {
        let mut noise = Noise(seed);
        let before = Live::of(&mesh);
        mesh.record_changes();
        let mut all = Vec::new();
        for _ in 0..20 {
            edits(&mut mesh, &mut noise, 20);
            all.extend(mesh.take_changes());
        }
        assert_eq!(before.follow(&all), Live::of(&mesh));
        assert!(mesh.take_changes().is_empty());
    }
}

#[test]
fn recording_can_be_stopped() {
    let mut mesh = mesh(&cube());
    let poke = |m: &mut Mesh| {
        let f = m.faces().next().expect("six");
        m.poke_face(f, DVec3::ONE).expect("finite");
    };
    poke(&mut mesh);
    assert!(mesh.take_changes().is_empty(), "nothing is recorded unasked");
    mesh.record_changes();
    poke(&mut mesh);
    let told = mesh.stop_recording();
    assert!(!told.is_empty());
    poke(&mut mesh);
    assert!(mesh.take_changes().is_empty() && mesh.stop_recording().is_empty());
}

#[test]
fn what_is_restored_before_it_was_fetched_is_not_told() {
    let mut mesh = mesh(&cube());
    mesh.record_changes();
    let checkpoint = mesh.checkpoint();
    let f = mesh.faces().next().expect("six");
    mesh.poke_face(f, DVec3::ONE).expect("finite");
    mesh.restore(checkpoint).expect("known");
    assert!(mesh.take_changes().is_empty());
}

#[test]
fn what_is_restored_after_it_was_fetched_is_undone_by_count() {
    let mut mesh = mesh(&cube());
    mesh.record_changes();
    let checkpoint = mesh.checkpoint();
    let f = mesh.faces().next().expect("six");
    mesh.poke_face(f, DVec3::ONE).expect("finite");
    let told = mesh.take_changes().len();
    let v = mesh.vertices().next().expect("many");
    mesh.set_position(v, DVec3::ZERO).expect("finite");
    mesh.restore(checkpoint).expect("known");
    let back = mesh.take_changes();
    // What was not fetched yet may be told and taken back, or neither.
    let lineage = {
        let mut lineage =
            Lineage::of(vec![Change::VertexMoved { vertex: mesh.numbering().vertices[0] }; told]);
        lineage.extend(back.clone());
        lineage
    };
    assert!(lineage.changes().is_empty(), "{back:?}");
}

#[test]
fn what_was_done_before_anybody_listened_is_told_when_it_is_taken_back() {
    let mut mesh = mesh(&cube());
    let before = Live::of(&mesh);
    let checkpoint = mesh.checkpoint();
    let f = mesh.faces().next().expect("six");
    mesh.poke_face(f, DVec3::ONE).expect("finite");
    let e = mesh.edges().next().expect("many");
    let poked = Live::of(&mesh);
    mesh.record_changes();
    mesh.split_edge(e, DVec3::X).expect("finite");
    mesh.restore(checkpoint).expect("known");
    let lineage = Lineage::of(mesh.take_changes());
    assert_eq!(poked.follow(lineage.changes()), before);
}

#[test]
fn the_record_follows_checkpoints_and_fetches_in_any_order() {
    for (seed, mut mesh) in (50..).zip(starts()) {
        let mut noise = Noise(seed);
        let before = Live::of(&mesh);
        mesh.record_changes();
        let mut lineage = Lineage::default();
        let mut stack = Vec::new();
        for _ in 0..200 {
            match noise.below(6) {
                0 => stack.push(mesh.checkpoint()),
                1 if !stack.is_empty() => {
                    stack.truncate(1 + noise.below(stack.len() as u32) as usize);
                    mesh.restore(stack[stack.len() - 1]).expect("known");
                }
                2 | 3 => lineage.extend(mesh.take_changes()),
                _ => edits(&mut mesh, &mut noise, 3),
            }
        }
        lineage.extend(mesh.take_changes());
        assert_eq!(before.follow(lineage.changes()), Live::of(&mesh));
    }
}

fn maps_of(mesh: &mut Mesh, edit: impl FnOnce(&mut Mesh)) -> Maps {
    let before = mesh.numbering();
    mesh.record_changes();
    edit(mesh);
    Lineage::of(mesh.take_changes()).maps(&before, &mesh.numbering())
}

#[test]
fn lineage_names_where_faces_and_vertices_come_from() {
    let mut mesh = mesh(&cube());
    let maps = maps_of(&mut mesh, |m| {
        let n = m.numbering();
        m.poke_face(n.faces[1], DVec3::Z).expect("finite");
        let h = m.find_halfedge(n.vertices[0], n.vertices[1]).expect("an edge");
        m.collapse_into_target(h).expect("a cube's edge");
        m.join_faces(m.edge(m.find_halfedge(n.vertices[2], n.vertices[3]).expect("an edge"))).expect("fits");
    });
    // Vertex 0 went into 1; the poke's vertex comes from the corners of the face on top, 4, 5, 7 and 6.
    assert_eq!(maps.vertices.new_of(0), maps.vertices.new_of(1));
    assert_eq!(maps.vertices.old_of(maps.vertices.new_len() - 1), [4, 5, 6, 7]);
    assert_eq!(maps.faces.new_of(1).len(), 4);
    assert_eq!(maps.faces.new_of(0), maps.faces.new_of(3), "joined");
}

#[test]
fn maps_of_parts_compose_to_the_map_of_the_whole() {
    for (seed, mut mesh) in (60..).zip(starts()) {
        let mut noise = Noise(seed);
        let first = mesh.numbering();
        mesh.record_changes();
        edits(&mut mesh, &mut noise, 60);
        let one = mesh.take_changes();
        let second = mesh.numbering();
        edits(&mut mesh, &mut noise, 60);
        let two = mesh.take_changes();
        let third = mesh.numbering();
        let composed = Lineage::of(one.clone()).maps(&first, &second);
        let composed = composed.then(&Lineage::of(two.clone()).maps(&second, &third)).expect("they meet");
        let mut whole = Lineage::of(one);
        whole.extend(two);
        assert_eq!(composed, whole.maps(&first, &third));
    }
}
