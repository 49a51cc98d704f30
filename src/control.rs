//! Progress and cancellation: the one hook that long calls take in their options.

use std::fmt;
use std::ops::ControlFlow;

/// How far a long call has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// What is being done, in a word or two: `"weld"`, `"unify"`.
    pub stage: &'static str,
    /// The finished share of the whole call, in `0.0..=1.0`; never decreases within a call.
    pub fraction: f64,
}

/// A long call was told to stop by its hook; nothing was changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// The progress-and-cancel hook of a long call. The default watches nothing and never cancels.
///
/// The hook is called from the calling thread: at the beginning of every stage, and within stages that walk all elements
/// about every half million of them.
///
/// # Examples
/// ```
/// use meshwright::{Control, Progress};
/// use std::ops::ControlFlow;
/// let mut seen = Vec::new();
/// let mut hook = |p: Progress| {
///     seen.push(p.stage);
///     if p.fraction > 0.5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
/// };
/// let control = Control::new(&mut hook);
/// # drop(control);
/// ```
#[derive(Default)]
pub struct Control<'a> {
    hook: Option<&'a mut dyn FnMut(Progress) -> ControlFlow<()>>,
}

impl<'a> Control<'a> {
    /// Reports to `hook`, which answers `Break` to cancel.
    pub fn new(hook: &'a mut dyn FnMut(Progress) -> ControlFlow<()>) -> Self {
        Self { hook: Some(hook) }
    }

    /// Watches nothing and never cancels.
    pub fn none() -> Self {
        Self::default()
    }

    /// Reports that `stage` has come to `fraction` of the whole call.
    ///
    /// # Errors
    /// [`Cancelled`] when the hook says so.
    pub fn report(&mut self, stage: &'static str, fraction: f64) -> Result<(), Cancelled> {
        let progress = Progress { stage, fraction: fraction.clamp(0.0, 1.0) };
        let answer = self.hook.as_mut().map_or(ControlFlow::Continue(()), |hook| hook(progress));
        if answer.is_break() { Err(Cancelled) } else { Ok(()) }
    }

    /// Runs a call that is a part of the whole: from the first fraction to the second.
    pub(crate) fn part<T>(&mut self, from: f64, to: f64, call: impl FnOnce(Control<'_>) -> T) -> T {
        let mut hook = |p: Progress| match self.report(p.stage, from + (to - from) * p.fraction) {
            Ok(()) => ControlFlow::Continue(()),
            Err(Cancelled) => ControlFlow::Break(()),
        };
        call(Control::new(&mut hook))
    }
}

impl fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Control").field("watched", &self.hook.is_some()).finish()
    }
}
