//! Many questions at once: on several threads where the feature `rayon` allows it, in the order of the questions.

use crate::{Cancelled, Control};

/// Questions between two calls of the hook.
const ROUND: usize = 1 << 14;

/// The answer to every question, or cancelled.
pub(crate) fn each_with<T: Sync, R: Send>(
    questions: &[T],
    stage: &'static str,
    mut control: Control<'_>,
    answer: impl Fn(&T) -> R + Sync + Send,
) -> Result<Vec<R>, Cancelled> {
    let mut answers = Vec::with_capacity(questions.len());
    for round in questions.chunks(ROUND) {
        control.report(stage, answers.len() as f64 / questions.len() as f64)?;
        answers.append(&mut each(round, &answer));
    }
    Ok(answers)
}

/// The answer to every question.
#[cfg(feature = "rayon")]
fn each<T: Sync, R: Send>(questions: &[T], answer: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
    use rayon::prelude::*;
    questions.par_iter().with_min_len(64).map(answer).collect()
}

/// The answer to every question.
#[cfg(not(feature = "rayon"))]
fn each<T: Sync, R: Send>(questions: &[T], answer: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
    questions.iter().map(answer).collect()
}

/// The result of every piece of work, of which each is worth a thread.
#[cfg(feature = "rayon")]
pub(crate) fn each_piece<T: Sync, R: Send>(pieces: &[T], work: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
    use rayon::prelude::*;
    pieces.par_iter().map(work).collect()
}

/// The result of every piece of work.
#[cfg(not(feature = "rayon"))]
pub(crate) fn each_piece<T: Sync, R: Send>(pieces: &[T], work: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
    pieces.iter().map(work).collect()
}
