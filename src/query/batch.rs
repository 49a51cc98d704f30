//! Many questions at once: on several threads where the feature `rayon` allows it, in the order of the questions.

use super::bvh::Tree;
use crate::{Cancelled, Control};

/// Questions between two calls of the hook.
const ROUND: usize = 1 << 14;
/// Questions answered at once.
const CHUNK: usize = 1 << 10;

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

/// [`each_with`] by an answer to many questions at once.
pub(crate) fn each_chunk_with<T: Sync, R: Send>(
    questions: &[T],
    stage: &'static str,
    mut control: Control<'_>,
    answer: impl Fn(&[T]) -> Vec<R> + Sync + Send,
) -> Result<Vec<R>, Cancelled> {
    let mut answers = Vec::with_capacity(questions.len());
    for round in questions.chunks(ROUND) {
        control.report(stage, answers.len() as f64 / questions.len() as f64)?;
        let chunks: Vec<&[T]> = round.chunks(CHUNK).collect();
        each_piece(&chunks, |&chunk| answer(chunk)).into_iter().for_each(|of| answers.extend(of));
    }
    Ok(answers)
}

/// [`each_with`], but if they are about a large tree in the order of their keys, so that one finds in the caches what the
/// last has fetched. Answers are in the order of the questions all the same.
pub(crate) fn each_near_with<T: Sync, R: Send>(
    tree: &Tree,
    questions: &[T],
    stage: &'static str,
    mut control: Control<'_>,
    key: impl Fn(&T) -> u64,
    answer: impl Fn(&T) -> R + Sync + Send,
) -> Result<Vec<R>, Cancelled> {
    let count = questions.len();
    if tree.bytes() < LARGE || count < WORTH || u32::try_from(count).is_err() {
        return each_with(questions, stage, control, answer);
    }
    let mut order: Vec<(u64, u32)> = (0..).zip(questions).map(|(i, q)| (key(q), i)).collect();
    order.sort_unstable();
    let mut answers: Vec<Option<R>> = Vec::new();
    answers.resize_with(count, || None);
    for (at, round) in order.chunks(ROUND).enumerate() {
        control.report(stage, (at * ROUND) as f64 / count as f64)?;
        let found = each(round, |&(_, i)| answer(&questions[i as usize]));
        round.iter().zip(found).for_each(|(&(_, i), found)| answers[i as usize] = Some(found));
    }
    // There are no others than these.
    Ok(answers.into_iter().map_while(|answer| answer).collect())
}

/// The bytes of a tree that does not fit the caches near a processor.
const LARGE: usize = 1 << 22;
/// From so many questions on an order is worth its cost.
const WORTH: usize = 1 << 10;

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
