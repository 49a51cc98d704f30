//! Edit scripts over all operators, with user data, checkpoints and the record attached: the body of the property tests,
//! the fuzz target and the regressions.

#[path = "apply.rs"]
mod apply;
#[path = "merged.rs"]
mod merged;
#[path = "plain.rs"]
mod plain;
#[path = "../shapes/mod.rs"]
pub(crate) mod shapes;
#[path = "start.rs"]
mod start;
#[path = "twin.rs"]
mod twin;
#[path = "verify.rs"]
mod verify;

use arbitrary::{Arbitrary, Result, Unstructured};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{EdgeKey, FaceKey, HalfedgeKey, Mesh, VertexKey};
pub(crate) use start::Start;
use std::collections::BTreeMap;
pub(crate) use verify::World;

/// Where a vertex is put, from the points around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Place {
    Mean,
    /// The first point itself.
    First,
    /// A quarter of the way from the first to the second.
    Quarter,
    /// Off the mean by quarters.
    Near([i8; 3]),
    NotANumber,
    Huge,
}
use Place::*;

/// One edit. Elements are numbers, taken modulo those alive; from 65,000 on, modulo those that are dead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Edit {
    AddVertex(Place),
    /// A boundary half-edge, how the face goes on from there, and vertices to choose from.
    AddFace(u16, u8, [u16; 3]),
    RemoveVertex(u16),
    RemoveEdge(u16),
    RemoveFace(u16),
    SplitEdge(u16, Place),
    SplitEdgeAndFaces(u16, Place),
    /// A half-edge, and how many corners on, mostly past the next; from 250 on, any half-edge.
    SplitFace(u16, u8),
    PokeFace(u16, Place),
    /// A half-edge, and how many clockwise; from 250 on, any half-edge.
    SplitVertex(u16, u8, Place),
    Collapse(u16, Place),
    CollapseToMidpoint(u16),
    CollapseIntoTarget(u16),
    FlipEdge(u16),
    JoinFaces(u16),
    DissolveVertex(u16),
    TriangulateFace(u16),
    /// A boundary half-edge; every fourth time any half-edge.
    FillHole(u16),
    /// A boundary half-edge, and another: the next, the one before, or any.
    Stitch(u16, u16),
    ReverseComponent(u16),
    /// Moves a vertex by hand.
    Move(u16, Place),
    /// Sets values by hand.
    Paint(u16, u8),
    Checkpoint,
    Restore(u8),
    ForgetBefore(u8),
    Forget,
    Record,
    StopRecording,
}

/// An operator with its arguments.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Op {
    AddVertex(DVec3),
    AddFace(Vec<VertexKey>),
    RemoveVertex(VertexKey),
    RemoveEdge(EdgeKey),
    RemoveFace(FaceKey),
    SplitEdge(EdgeKey, DVec3),
    SplitEdgeAndFaces(EdgeKey, DVec3),
    SplitFace(HalfedgeKey, HalfedgeKey),
    PokeFace(FaceKey, DVec3),
    SplitVertex(HalfedgeKey, HalfedgeKey, DVec3),
    Collapse(HalfedgeKey, DVec3),
    FlipEdge(EdgeKey),
    JoinFaces(EdgeKey),
    DissolveVertex(VertexKey),
    TriangulateFace(FaceKey),
    FillHole(HalfedgeKey),
    Stitch(HalfedgeKey, HalfedgeKey),
    ReverseComponent(FaceKey),
}

impl Op {
    /// The operator's name.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Op::AddVertex(..) => "add_vertex",
            Op::AddFace(..) => "add_face",
            Op::RemoveVertex(..) => "remove_vertex",
            Op::RemoveEdge(..) => "remove_edge",
            Op::RemoveFace(..) => "remove_face",
            Op::SplitEdge(..) => "split_edge",
            Op::SplitEdgeAndFaces(..) => "split_edge_and_faces",
            Op::SplitFace(..) => "split_face",
            Op::PokeFace(..) => "poke_face",
            Op::SplitVertex(..) => "split_vertex",
            Op::Collapse(..) => "collapse",
            Op::FlipEdge(..) => "flip_edge",
            Op::JoinFaces(..) => "join_faces",
            Op::DissolveVertex(..) => "dissolve_vertex",
            Op::TriangulateFace(..) => "triangulate_face",
            Op::FillHole(..) => "fill_hole",
            Op::Stitch(..) => "stitch",
            Op::ReverseComponent(..) => "reverse_component",
        }
    }
}

/// A start and what is done to it. Prints as Rust, to be pasted as a regression.
#[derive(Clone, Debug)]
pub(crate) struct Script {
    pub(crate) start: Start,
    pub(crate) edits: Vec<Edit>,
}

// By hand, in a byte for each choice: derived, a fuzzer would have to get four right.
impl<'a> Arbitrary<'a> for Place {
    fn arbitrary(u: &mut Unstructured<'a>) -> Result<Self> {
        Ok(match u.arbitrary::<u8>()? % 10 {
            0..=3 => Mean,
            4 => First,
            5 => Quarter,
            8 => NotANumber,
            9 => Huge,
            _ => Near(u.arbitrary()?),
        })
    }
}

impl<'a> Arbitrary<'a> for Edit {
    fn arbitrary(u: &mut Unstructured<'a>) -> Result<Self> {
        Ok(match u.arbitrary::<u8>()? % 28 {
            0 => Self::AddVertex(u.arbitrary()?),
            1 => Self::AddFace(u.arbitrary()?, u.arbitrary()?, u.arbitrary()?),
            2 => Self::RemoveVertex(u.arbitrary()?),
            3 => Self::RemoveEdge(u.arbitrary()?),
            4 => Self::RemoveFace(u.arbitrary()?),
            5 => Self::SplitEdge(u.arbitrary()?, u.arbitrary()?),
            6 => Self::SplitEdgeAndFaces(u.arbitrary()?, u.arbitrary()?),
            7 => Self::SplitFace(u.arbitrary()?, u.arbitrary()?),
            8 => Self::PokeFace(u.arbitrary()?, u.arbitrary()?),
            9 => Self::SplitVertex(u.arbitrary()?, u.arbitrary()?, u.arbitrary()?),
            10 => Self::Collapse(u.arbitrary()?, u.arbitrary()?),
            11 => Self::CollapseToMidpoint(u.arbitrary()?),
            12 => Self::CollapseIntoTarget(u.arbitrary()?),
            13 => Self::FlipEdge(u.arbitrary()?),
            14 => Self::JoinFaces(u.arbitrary()?),
            15 => Self::DissolveVertex(u.arbitrary()?),
            16 => Self::TriangulateFace(u.arbitrary()?),
            17 => Self::FillHole(u.arbitrary()?),
            18 => Self::Stitch(u.arbitrary()?, u.arbitrary()?),
            19 => Self::ReverseComponent(u.arbitrary()?),
            20 => Self::Move(u.arbitrary()?, u.arbitrary()?),
            21 => Self::Paint(u.arbitrary()?, u.arbitrary()?),
            22 => Self::Checkpoint,
            23 => Self::Restore(u.arbitrary()?),
            24 => Self::ForgetBefore(u.arbitrary()?),
            25 => Self::Forget,
            26 => Self::Record,
            _ => Self::StopRecording,
        })
    }
}

/// One run from raw bytes, the naive twin beside it.
pub(crate) fn drive(bytes: &[u8]) {
    if let Ok(script) = script(bytes) {
        run(&script);
    }
}

pub(crate) fn script(bytes: &[u8]) -> Result<Script> {
    let mut u = Unstructured::new(bytes);
    let start = Start::ALL[usize::from(u.arbitrary::<u8>()?) % Start::ALL.len()];
    let mut edits = Vec::new();
    while !u.is_empty() && edits.len() < 60 {
        edits.push(u.arbitrary()?);
    }
    Ok(Script { start, edits })
}

/// Runs a script with the naive twin at every step.
pub(crate) fn run(script: &Script) -> BTreeMap<&'static str, [usize; 2]> {
    let mut world = World::new(script.start.build());
    for (i, edit) in script.edits.iter().enumerate() {
        world.step(i, edit, true);
    }
    world.finish();
    world.tally
}

/// The keys that edits choose from, dead ones included.
#[derive(Clone, Default)]
pub(crate) struct Graveyard {
    pub(crate) vertices: Vec<VertexKey>,
    pub(crate) edges: Vec<EdgeKey>,
    pub(crate) halfedges: Vec<HalfedgeKey>,
    pub(crate) faces: Vec<FaceKey>,
}

/// One of the living, or of the dead.
fn pick<K: Copy>(n: u16, live: impl Iterator<Item = K>, dead: &[K]) -> Option<K> {
    if n >= 65_000 && !dead.is_empty() {
        return Some(dead[n as usize % dead.len()]);
    }
    let live: Vec<K> = live.collect();
    live.get(n as usize % live.len().max(1)).or(dead.last()).copied()
}

impl Place {
    fn among(self, points: &[DVec3]) -> DVec3 {
        let mean = || points.iter().sum::<DVec3>() / points.len().max(1) as f64;
        let first = points.first().copied().unwrap_or_default();
        match self {
            Mean => mean(),
            First => first,
            Quarter => first.lerp(points.get(1).copied().unwrap_or_default(), 0.25),
            Near(off) => mean() + DVec3::from(off.map(|c| f64::from(c) * 0.25)),
            NotANumber => dvec3(0.0, f64::NAN, 0.0),
            Huge => DVec3::splat(f64::INFINITY),
        }
    }
}

impl Edit {
    /// The operator on a mesh, if this is one and there is something to do it to.
    pub(crate) fn op(self, mesh: &Mesh, dead: &Graveyard) -> Option<Op> {
        let vertex = |n| pick(n, mesh.vertices(), &dead.vertices);
        let edge = |n| pick(n, mesh.edges(), &dead.edges);
        let halfedge = |n| pick(n, mesh.halfedges(), &dead.halfedges);
        let face = |n| pick(n, mesh.faces(), &dead.faces);
        let boundary = |n| pick(n, mesh.boundary_halfedges(), &dead.halfedges);
        let of_edge = |e| match mesh.get_edge_halfedge(e) {
            Some(h) => vec![mesh.position(mesh.origin(h)), mesh.position(mesh.target(h))],
            None => Vec::new(),
        };
        let of_halfedge = |h| match mesh.get_origin(h) {
            Some(v) => vec![mesh.position(v), mesh.position(mesh.target(h))],
            None => Vec::new(),
        };
        let of_face = |f| match mesh.get_face_vertices(f) {
            Some(corners) => corners.map(|v| mesh.position(v)).collect(),
            None => Vec::new(),
        };
        Some(match self {
            Edit::AddVertex(place) => Op::AddVertex(place.among(&[DVec3::ZERO, DVec3::X])),
            Edit::AddFace(n, how, others) => Op::AddFace(new_face(mesh, dead, n, how, others)?),
            Edit::RemoveVertex(n) => Op::RemoveVertex(vertex(n)?),
            Edit::RemoveEdge(n) => Op::RemoveEdge(edge(n)?),
            Edit::RemoveFace(n) => Op::RemoveFace(face(n)?),
            Edit::SplitEdge(n, place) => Op::SplitEdge(edge(n)?, place.among(&of_edge(edge(n)?))),
            Edit::SplitEdgeAndFaces(n, place) => {
                Op::SplitEdgeAndFaces(edge(n)?, place.among(&of_edge(edge(n)?)))
            }
            Edit::SplitFace(n, steps) => {
                let from = halfedge(n)?;
                let to = match mesh.get_loop_of(from) {
                    Some(mut corners) if steps < 250 => {
                        let degree = corners.clone().count();
                        let on = if steps < 200 { 2 + steps as usize % (degree - 2) } else { steps as usize };
                        corners.nth(on % degree)?
                    }
                    _ => halfedge(n / 3 + u16::from(steps))?,
                };
                Op::SplitFace(from, to)
            }
            Edit::PokeFace(n, place) => Op::PokeFace(face(n)?, place.among(&of_face(face(n)?))),
            Edit::SplitVertex(n, steps, place) => {
                let first = halfedge(n)?;
                let mut last = first;
                match mesh.get_origin(first) {
                    Some(v) if steps < 250 => {
                        for _ in 0..steps as usize % mesh.valence(v) {
                            last = mesh.rotate_cw(last);
                        }
                    }
                    _ => last = halfedge(n / 3 + u16::from(steps))?,
                }
                Op::SplitVertex(first, last, place.among(&of_halfedge(first)))
            }
            Edit::Collapse(n, place) => Op::Collapse(halfedge(n)?, place.among(&of_halfedge(halfedge(n)?))),
            // Where these two put the vertex is theirs to say; told apart by the driver.
            Edit::CollapseToMidpoint(n) => {
                let points = of_halfedge(halfedge(n)?);
                Op::Collapse(halfedge(n)?, points.iter().map(|p| p * 0.5).sum())
            }
            Edit::CollapseIntoTarget(n) => {
                Op::Collapse(halfedge(n)?, of_halfedge(halfedge(n)?).last().copied().unwrap_or_default())
            }
            Edit::FlipEdge(n) => Op::FlipEdge(edge(n)?),
            Edit::JoinFaces(n) => Op::JoinFaces(edge(n)?),
            Edit::DissolveVertex(n) => Op::DissolveVertex(vertex(n)?),
            Edit::TriangulateFace(n) => Op::TriangulateFace(face(n)?),
            Edit::FillHole(n) if n % 4 == 3 => Op::FillHole(halfedge(n)?),
            Edit::FillHole(n) => Op::FillHole(boundary(n)?),
            Edit::Stitch(n, other) => {
                let first = boundary(n)?;
                let second = match (other % 4, mesh.get_next(first)) {
                    (0, Some(next)) => next,
                    (1, Some(_)) => mesh.prev(first),
                    (2, _) => boundary(other)?,
                    _ if other % 64 == 63 => halfedge(other)?,
                    _ => boundary(other)?,
                };
                Op::Stitch(first, second)
            }
            Edit::ReverseComponent(n) => Op::ReverseComponent(face(n)?),
            _ => return None,
        })
    }
}

/// Corners for a new face, such that it often fits.
fn new_face(mesh: &Mesh, dead: &Graveyard, n: u16, how: u8, others: [u16; 3]) -> Option<Vec<VertexKey>> {
    let lone = mesh.vertices().filter(|&v| mesh.is_isolated(v));
    let any = |n| pick(n, mesh.vertices(), &dead.vertices);
    let isolated = |n| pick(n, lone.clone(), &dead.vertices);
    let start = mesh.boundary_halfedges().nth(n as usize % mesh.boundary_halfedges().count().max(1));
    let [a, b, c] = others;
    Some(match (how % 8, start) {
        (0, Some(h)) => vec![mesh.origin(h), mesh.target(h), isolated(a)?],
        (1, Some(h)) => vec![mesh.origin(h), mesh.target(h), mesh.target(mesh.next(h))],
        (2, Some(h)) => {
            let next = mesh.next(mesh.next(h));
            vec![mesh.origin(h), mesh.target(h), mesh.origin(next), mesh.target(next)]
        }
        (3, Some(h)) => vec![mesh.origin(h), mesh.target(h), any(a)?],
        (4, Some(h)) => vec![mesh.origin(h), mesh.target(h), any(a)?, isolated(b)?],
        (5, _) => {
            (0..n % 6).map(|i| any(others[i as usize % 3].wrapping_add(i / 3))).collect::<Option<_>>()?
        }
        // A face of its own.
        (6, _) => {
            vec![isolated(a)?, isolated(a.wrapping_add(1))?, isolated(a.wrapping_add(2))?, isolated(b)?]
        }
        (_, Some(h)) => {
            let other = mesh.boundary_halfedges().nth(b as usize % mesh.boundary_halfedges().count())?;
            vec![mesh.origin(h), mesh.target(h), mesh.origin(other), mesh.target(other), any(c)?][..4]
                .to_vec()
        }
        _ => vec![any(a)?, any(b)?, any(c)?],
    })
}
