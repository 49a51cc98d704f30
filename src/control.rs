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
pub struct Control<'a> {
    hook: Option<&'a mut dyn FnMut(Progress) -> ControlFlow<()>>,
    /// Where in the whole call its fractions lie.
    from: f64,
    to: f64,
}

impl Default for Control<'_> {
    fn default() -> Self {
        Self { hook: None, from: 0.0, to: 1.0 }
    }
}

impl<'a> Control<'a> {
    /// Reports to `hook`, which answers `Break` to cancel.
    pub fn new(hook: &'a mut dyn FnMut(Progress) -> ControlFlow<()>) -> Self {
        Self { hook: Some(hook), ..Self::default() }
    }

    /// Watches nothing and never cancels.
    pub fn none() -> Self {
        Self::default()
    }

    /// The hook for a call that is a part of this one: what that tells as 0 to 1 is told as `from` to `to` of the whole.
    /// `from` should not exceed `to`, nor lie below what was told before. Parts may have parts.
    ///
    /// # Examples
    /// ```
    /// use meshwright::{Control, IndexedMesh, Mesh, SmoothOptions, SubdivideOptions, glam::DVec3};
    /// /// Subdivides and smooths, as one call with one hook.
    /// fn refine(mesh: &Mesh, mut control: Control<'_>) -> Result<Mesh, Box<dyn std::error::Error>> {
    ///     let options = SubdivideOptions { control: control.part(0.0, 0.7), ..Default::default() };
    ///     let mut fine = mesh.subdivide(options)?.value;
    ///     fine.smooth(SmoothOptions { control: control.part(0.7, 1.0), ..Default::default() })?;
    ///     Ok(fine)
    /// }
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// # let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// # let mesh = Mesh::build(&IndexedMesh::from_triangles(points, &faces)?)?;
    /// let mut fractions = Vec::new();
    /// let mut hook = |p: meshwright::Progress| {
    ///     fractions.push(p.fraction);
    ///     std::ops::ControlFlow::Continue(())
    /// };
    /// assert_eq!(refine(&mesh, Control::new(&mut hook))?.face_count(), 16);
    /// assert!(fractions.is_sorted() && fractions.contains(&0.7));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn part(&mut self, from: f64, to: f64) -> Control<'_> {
        let at = |fraction: f64| self.from + (self.to - self.from) * fraction;
        let (from, to) = (at(from), at(to));
        let hook: Option<&mut dyn FnMut(Progress) -> ControlFlow<()>> = match &mut self.hook {
            Some(hook) => Some(&mut **hook),
            None => None,
        };
        Control { hook, from, to }
    }

    /// Reports that `stage` has come to `fraction` of the whole call.
    ///
    /// # Errors
    /// [`Cancelled`] when the hook says so.
    pub fn report(&mut self, stage: &'static str, fraction: f64) -> Result<(), Cancelled> {
        let fraction = share(self.from + (self.to - self.from) * share(fraction));
        let progress = Progress { stage, fraction };
        let answer = self.hook.as_mut().map_or(ControlFlow::Continue(()), |hook| hook(progress));
        if answer.is_break() { Err(Cancelled) } else { Ok(()) }
    }
}

/// Within 0 to 1, whatever was given.
fn share(fraction: f64) -> f64 {
    if fraction > 0.0 { fraction.min(1.0) } else { 0.0 }
}

impl fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Control").field("watched", &self.hook.is_some()).finish()
    }
}
