//! Every main operation on 10 thousand, 100 thousand, 1.3 and 2 million triangles, in memory order and scattered.
//!
//! `cargo bench --bench every [-- FILTER...]`: names are `every::SHAPE_FACES_OPERATION`, filters regular expressions, such as
//! `torus_2000000_reduce` or `scattered.*loop`; `-- --list` lists them. Without a filter, the two smaller sizes only.
//! `-- --help` tells what [divan](https://docs.rs/divan) has to offer beside. For how time grows, see `growth`.

mod operations;

use divan::Bencher;
use operations::{Operation, Subject, operations, shapes};
use std::cell::RefCell;
use std::fmt;
use std::rc::Rc;

fn main() {
    divan::main();
}

/// An operation on a shape.
struct Case {
    shape: &'static str,
    faces: usize,
    operation: Operation,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}_{:07}_{}", self.shape, self.faces, self.operation.0)
    }
}

fn cases() -> impl Iterator<Item = Case> {
    let is_asked = std::env::args().skip(1).any(|a| !a.starts_with("--") || a == "--list");
    let most = if is_asked { usize::MAX } else { 100_000 };
    let sizes = [10_000, 100_000, 1_300_000, 2_000_000].into_iter().filter(move |n| *n <= most);
    let shapes = ["torus", "scattered"].into_iter();
    let subjects = shapes.flat_map(move |shape| sizes.clone().map(move |faces| (shape, faces)));
    subjects.flat_map(|(shape, faces)| operations().map(move |operation| Case { shape, faces, operation }))
}

/// The torus of about so many triangles, kept until another is asked for.
fn subject(case: &Case) -> Rc<Subject> {
    type Kept = Option<(&'static str, usize, Rc<Subject>)>;
    thread_local!(static LAST: RefCell<Kept> = const { RefCell::new(None) });
    LAST.with_borrow_mut(|last| {
        if let Some((shape, faces, subject)) = last
            && (*shape, *faces) == (case.shape, case.faces)
        {
            return Rc::clone(subject);
        }
        *last = None;
        let side = (case.faces as f64 / 2.0).sqrt().round() as u32;
        let torus = shapes::fanned(&shapes::torus(side, side));
        let is_scattered = case.shape == "scattered";
        let pool = if is_scattered { shapes::shuffled(&torus, 3) } else { torus };
        let subject = Rc::new(Subject::new(pool));
        *last = Some((case.shape, case.faces, Rc::clone(&subject)));
        subject
    })
}

#[divan::bench(args = cases(), sample_count = 3, sample_size = 1)]
fn every(bencher: Bencher<'_, '_>, case: &Case) {
    let subject = subject(case);
    let prepare = case.operation.1;
    // A torus is closed: there is no operation that makes no sense.
    bencher.with_inputs(|| prepare(&subject)).bench_local_values(|run| run.map(|run| run()));
}
