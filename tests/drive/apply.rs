//! The operators, called by description; their results and errors in one form.

use super::{Edit, Op};
use meshwright::{EdgeKey, FaceKey, Mesh, VertexKey};
use std::fmt::Debug;

/// What an operator's result names.
#[derive(Default)]
pub(crate) struct Done {
    pub(crate) vertices: Vec<VertexKey>,
    pub(crate) edges: Vec<EdgeKey>,
    pub(crate) faces: Vec<FaceKey>,
    pub(crate) dead_vertices: Vec<VertexKey>,
    pub(crate) dead_edges: Vec<EdgeKey>,
    pub(crate) dead_faces: Vec<FaceKey>,
    /// What a result says is left.
    pub(crate) kept_vertex: Option<VertexKey>,
    pub(crate) kept_edge: Option<EdgeKey>,
    pub(crate) kept_faces: Option<Vec<FaceKey>>,
    pub(crate) isolated: Option<Vec<VertexKey>>,
}

fn words<T>(result: Result<T, impl Debug>) -> Result<T, String> {
    result.map_err(|e| format!("{e:?}"))
}

pub(crate) fn check(mesh: &Mesh, op: &Op) -> Result<(), String> {
    match *op {
        Op::AddVertex(p) => words(mesh.check_add_vertex(p)),
        Op::AddFace(ref corners) => words(mesh.check_add_face(corners)),
        Op::RemoveVertex(v) => words(mesh.check_remove_vertex(v)),
        Op::RemoveEdge(e) => words(mesh.check_remove_edge(e)),
        Op::RemoveFace(f) => words(mesh.check_remove_face(f)),
        Op::SplitEdge(e, p) | Op::SplitEdgeAndFaces(e, p) => words(mesh.check_split_edge(e, p)),
        Op::SplitFace(a, b) => words(mesh.check_split_face(a, b)),
        Op::PokeFace(f, p) => words(mesh.check_poke_face(f, p)),
        Op::SplitVertex(a, b, p) => words(mesh.check_split_vertex(a, b, p)),
        Op::Collapse(h, p) => words(mesh.check_collapse(h, p)),
        Op::FlipEdge(e) => words(mesh.check_flip_edge(e)),
        Op::JoinFaces(e) => words(mesh.check_join_faces(e)),
        Op::DissolveVertex(v) => words(mesh.check_dissolve_vertex(v)),
        Op::TriangulateFace(f) => words(mesh.check_triangulate_face(f)),
        Op::FillHole(h) => words(mesh.check_fill_hole(h)),
        Op::Stitch(a, b) => words(mesh.check_stitch(a, b)),
        Op::ReverseComponent(f) => words(mesh.check_reverse_component(f)),
    }
}

pub(crate) fn apply(mesh: &mut Mesh, edit: Edit, op: &Op) -> Result<Done, String> {
    let removed = |r: meshwright::Removed| Done {
        dead_edges: r.edges.to_vec(),
        dead_faces: r.faces.to_vec(),
        isolated: Some(r.isolated.to_vec()),
        ..Done::default()
    };
    Ok(match *op {
        Op::AddVertex(p) => Done { vertices: vec![words(mesh.add_vertex(p))?], ..Done::default() },
        Op::AddFace(ref corners) => {
            let new = words(mesh.add_face(corners))?;
            Done { edges: new.edges.to_vec(), faces: vec![new.face], ..Done::default() }
        }
        Op::RemoveVertex(v) => Done { dead_vertices: vec![v], ..removed(words(mesh.remove_vertex(v))?) },
        Op::RemoveEdge(e) => removed(words(mesh.remove_edge(e))?),
        Op::RemoveFace(f) => removed(words(mesh.remove_face(f))?),
        Op::SplitEdge(e, p) => {
            let new = words(mesh.split_edge(e, p))?;
            Done { vertices: vec![new.vertex], edges: vec![new.edge], ..Done::default() }
        }
        Op::SplitEdgeAndFaces(e, p) => {
            let new = words(mesh.split_edge_and_faces(e, p))?;
            let edges = [new.edge].into_iter().chain(new.cuts.iter().map(|c| c.edge)).collect();
            let faces = new.cuts.iter().map(|c| c.face).collect();
            Done { vertices: vec![new.vertex], edges, faces, ..Done::default() }
        }
        Op::SplitFace(a, b) => {
            let new = words(mesh.split_face(a, b))?;
            Done { edges: vec![new.edge], faces: vec![new.face], ..Done::default() }
        }
        Op::PokeFace(f, p) => {
            let new = words(mesh.poke_face(f, p))?;
            let (edges, faces) = (new.edges.to_vec(), new.faces.to_vec());
            Done { vertices: vec![new.vertex], edges, faces, ..Done::default() }
        }
        Op::SplitVertex(a, b, p) => {
            let new = words(mesh.split_vertex(a, b, p))?;
            Done { vertices: vec![new.vertex], edges: vec![new.edge], ..Done::default() }
        }
        Op::Collapse(h, p) => {
            let done = words(match edit {
                Edit::CollapseToMidpoint(_) => mesh.collapse_to_midpoint(h),
                Edit::CollapseIntoTarget(_) => mesh.collapse_into_target(h),
                _ => mesh.collapse(h, p),
            })?;
            Done {
                kept_vertex: Some(done.vertex),
                dead_vertices: vec![done.dead_vertex],
                dead_edges: done.dead_edges.to_vec(),
                dead_faces: done.dead_faces.to_vec(),
                ..Done::default()
            }
        }
        Op::FlipEdge(e) => words(mesh.flip_edge(e)).map(|()| Done::default())?,
        Op::JoinFaces(e) => {
            let done = words(mesh.join_faces(e))?;
            Done {
                kept_faces: Some(vec![done.face]),
                dead_faces: vec![done.dead_face],
                dead_edges: done.dead_edges.to_vec(),
                dead_vertices: done.dead_vertices.to_vec(),
                ..Done::default()
            }
        }
        Op::DissolveVertex(v) => {
            let done = words(mesh.dissolve_vertex(v))?;
            Done {
                kept_faces: Some(done.faces.to_vec()),
                kept_edge: done.edge,
                dead_vertices: vec![v],
                dead_faces: done.dead_faces.to_vec(),
                dead_edges: done.dead_edges.to_vec(),
                ..Done::default()
            }
        }
        Op::TriangulateFace(f) => {
            let cuts = words(mesh.triangulate_face(f))?.cuts;
            let (edges, faces) = cuts.iter().map(|c| (c.edge, c.face)).unzip();
            Done { edges, faces, ..Done::default() }
        }
        Op::FillHole(h) => Done { faces: vec![words(mesh.fill_hole(h))?], ..Done::default() },
        Op::Stitch(a, b) => {
            let done = words(mesh.stitch(a, b))?;
            let (dead_vertices, dead_edges) = (done.dead_vertices.to_vec(), vec![done.dead_edge]);
            Done { kept_edge: Some(done.edge), dead_vertices, dead_edges, ..Done::default() }
        }
        Op::ReverseComponent(f) => words(mesh.reverse_component(f)).map(|()| Done::default())?,
    })
}
