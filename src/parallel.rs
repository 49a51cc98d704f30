//! Independent questions at once, where the feature `rayon` allows it; the answers do not depend on it.

/// Answers both.
#[cfg(feature = "rayon")]
pub(crate) fn both<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(a, b)
}

/// Answers both.
#[cfg(not(feature = "rayon"))]
pub(crate) fn both<A, B>(a: impl FnOnce() -> A, b: impl FnOnce() -> B) -> (A, B) {
    (a(), b())
}

/// Two answers for each, in the order of the questions.
#[cfg(feature = "rayon")]
pub(crate) fn pairs<T: Sync, A: Send, B: Send>(
    questions: &[T],
    answer: impl Fn(&T) -> (A, B) + Sync + Send,
) -> (Vec<A>, Vec<B>) {
    use rayon::prelude::*;
    let (mut a, mut b) = (Vec::new(), Vec::new());
    questions.par_iter().with_min_len(1 << 12).map(answer).unzip_into_vecs(&mut a, &mut b);
    (a, b)
}

/// Two answers for each, in the order of the questions.
#[cfg(not(feature = "rayon"))]
pub(crate) fn pairs<T, A, B>(questions: &[T], answer: impl Fn(&T) -> (A, B)) -> (Vec<A>, Vec<B>) {
    questions.iter().map(answer).unzip()
}
