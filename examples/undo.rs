//! An editor's undo and redo: one checkpoint for each step.

use meshwright::glam::DVec3;
use meshwright::{Checkpoint, IndexedMesh, Mesh};
use std::error::Error;

/// A step of an editor, which can be done again.
type Step = Box<dyn Fn(&mut Mesh) -> Result<(), Box<dyn Error>>>;

/// A mesh with a history.
pub(crate) struct Editor {
    pub(crate) mesh: Mesh,
    /// The steps done, each with the state before it.
    done: Vec<(Checkpoint, Step)>,
    /// The steps taken back, the next to do again on top.
    undone: Vec<Step>,
}

impl Editor {
    pub(crate) fn new(mesh: Mesh) -> Self {
        Self { mesh, done: Vec::new(), undone: Vec::new() }
    }

    /// Does a step, whole or not at all.
    pub(crate) fn apply(&mut self, step: Step) -> Result<(), Box<dyn Error>> {
        self.undone.clear();
        self.run(step)
    }

    pub(crate) fn undo(&mut self) -> Result<(), Box<dyn Error>> {
        let (before, step) = self.done.pop().ok_or("nothing to undo")?;
        self.mesh.restore(before)?;
        self.undone.push(step);
        Ok(())
    }

    pub(crate) fn redo(&mut self) -> Result<(), Box<dyn Error>> {
        let step = self.undone.pop().ok_or("nothing to redo")?;
        self.run(step)
    }

    fn run(&mut self, step: Step) -> Result<(), Box<dyn Error>> {
        let before = self.mesh.checkpoint();
        if let Err(why) = step(&mut self.mesh) {
            self.mesh.restore(before)?;
            return Err(why);
        }
        self.done.push((before, step));
        Ok(())
    }
}

/// Pokes the face that comes first.
pub(crate) fn poke(mesh: &mut Mesh) -> Result<(), Box<dyn Error>> {
    let f = mesh.faces().next().ok_or("no face")?;
    mesh.poke_face(f, DVec3::Z)?;
    Ok(())
}

pub(crate) fn triangle() -> Result<Mesh, Box<dyn Error>> {
    let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    Ok(Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?)
}

#[allow(dead_code, reason = "the tests call the parts")]
fn main() -> Result<(), Box<dyn Error>> {
    let mut editor = Editor::new(triangle()?);
    editor.apply(Box::new(poke))?;
    editor.apply(Box::new(poke))?;
    println!("{} faces after two steps", editor.mesh.face_count());
    editor.undo()?;
    println!("{} after one was taken back", editor.mesh.face_count());
    editor.redo()?;
    println!("{} after it was done again", editor.mesh.face_count());
    println!("{} bytes of history", editor.mesh.checkpoint_bytes());
    Ok(())
}
