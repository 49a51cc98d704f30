//! The whole account of a clean-up, as the program prints it.

use super::facts::{Facts, inspect};
use super::{CleanError, Profile, Weld};
use crate::report::{
    Attribute, Element, Kind, LossReason, Maps, Record, Relation, Report, Step, StepSummary,
};
use crate::{IndexedMesh, PolygonSoup};
use std::collections::BTreeMap;

/// The version of [`Account`] in JSON: it goes up when a field changes its meaning or goes.
pub const SCHEMA: u32 = 1;

/// Everything a clean-up did, found and left, in one value: with the feature `serde`, the JSON that the program
/// `meshwright clean` prints. The page on [accounts](crate::accounts) describes each field.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Account {
    /// [`SCHEMA`].
    pub schema: u32,
    /// What the clean-up was for.
    pub profile: Profile,
    /// Whether the result is closed, manifold and oriented; of the profile `solid`, whether it reached its goal.
    pub solid: bool,
    /// The tolerance of the weld, in the input's units; `None` if nothing was welded.
    pub tolerance: Option<f64>,
    /// How far the surface was moved, at most, in the input's units: the sum over all steps. What was dropped or made new
    /// is told by records.
    pub moved: f64,
    /// What became of the input's faces.
    pub face_tally: FaceTally,
    /// How many records there are of each kind; empty when nothing was done.
    pub counts: BTreeMap<Kind, usize>,
    /// The steps that ran, in order.
    pub steps: Vec<StepSummary>,
    /// Data of the input that the result does not have.
    pub not_carried: Vec<Attribute>,
    /// Single values that the result does not have.
    pub lost_values: Vec<LostSummary>,
    /// The state of the input, after the weld.
    pub before: Facts,
    /// The state of the result, vertices at one place kept apart.
    pub after: Facts,
    /// Every change, located in the input's numbering.
    pub defects: Vec<Record>,
}

/// What became of the input's faces: `kept`, `changed` and `dropped` add up to `input`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FaceTally {
    /// The faces of the input.
    pub input: usize,
    /// Those that are there with the same corners, whichever way round.
    pub kept: usize,
    /// Those of which something else came: another cycle of corners, several faces, or one made of several.
    pub changed: usize,
    /// Those of which nothing is left. A record names each.
    pub dropped: usize,
    /// Faces of the result that come from none of the input's: the filling of holes.
    pub added: usize,
}

/// Values of one attribute that were not carried for one reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LostSummary {
    /// Of which attribute.
    pub attribute: Attribute,
    /// Why.
    pub reason: LossReason,
    /// How many.
    pub count: usize,
    /// Whose was the first, in the input's numbering.
    pub first: Element,
}

impl Account {
    /// The account of a clean-up, given what went in and came out. Looks at both states: O(corners).
    ///
    /// # Errors
    /// [`CleanError`], as [`inspect`].
    ///
    /// # Examples
    /// ```
    /// use meshwright::{PolygonSoup, Polygons, cleanup::{Account, CleanOptions, Profile, Weld, clean_indexed}, glam::DVec3};
    /// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 1, 3]];
    /// let soup = PolygonSoup::new(points, Polygons::from_triangles(&faces));
    /// let cleaned = clean_indexed(&soup, CleanOptions::solid())?;
    /// let account =
    ///     Account::new(&soup, (Profile::Solid, Weld::Auto), &cleaned.value, cleaned.report, &cleaned.maps)?;
    /// assert!(account.solid);
    /// assert_eq!((account.face_tally.input, account.face_tally.kept, account.face_tally.dropped), (5, 4, 1));
    /// # Ok::<(), meshwright::cleanup::CleanError>(())
    /// ```
    pub fn new(
        soup: &PolygonSoup,
        (profile, weld): (Profile, Weld),
        result: &IndexedMesh,
        report: Report,
        maps: &Maps,
    ) -> Result<Self, CleanError> {
        let before = inspect(soup, weld)?;
        // Splits leave vertices at one place, so the result is looked at as it is.
        let after = inspect(&result.clone().into(), Weld::None)?;
        let weld = report.steps.iter().find(|s| s.step == Step::Weld);
        Ok(Self {
            schema: SCHEMA,
            profile,
            solid: after.closed && after.manifold && after.oriented,
            tolerance: weld.and_then(|s| s.tolerance),
            moved: report.steps.iter().map(|s| s.moved).sum(),
            face_tally: FaceTally::new(soup, result, maps),
            counts: report.counts(),
            lost_values: lost(&report),
            steps: report.steps,
            not_carried: report.not_carried,
            before,
            after,
            defects: report.records,
        })
    }
}

/// Losses of one attribute for one reason together: there may be one at each vertex.
fn lost(report: &Report) -> Vec<LostSummary> {
    let alike = report.lost_values.chunk_by(|a, b| (a.attribute, a.reason) == (b.attribute, b.reason));
    let summary = |lost: &[crate::LostValue]| LostSummary {
        attribute: lost[0].attribute,
        reason: lost[0].reason,
        count: lost.len(),
        first: lost[0].element,
    };
    alike.map(summary).collect()
}

impl FaceTally {
    fn new(soup: &PolygonSoup, result: &IndexedMesh, maps: &Maps) -> Self {
        let mut tally = Self { input: soup.polygons.len(), ..Self::default() };
        for (f, face) in soup.polygons.iter().enumerate() {
            match maps.faces.new_of(f) {
                [] => tally.dropped += 1,
                &[g] if maps.faces.old_of(g as usize).len() == 1
                    && is_same(face, &result.polygons()[g as usize], &maps.vertices) =>
                {
                    tally.kept += 1;
                }
                _ => tally.changed += 1,
            }
        }
        tally.added = (0..maps.faces.new_len()).filter(|&g| maps.faces.old_of(g).is_empty()).count();
        tally
    }
}

/// Whether a new face has the corners of an old one, in the same cycle, either way round.
fn is_same(old: &[u32], new: &[u32], vertices: &Relation) -> bool {
    let n = old.len();
    let became = |o: usize, v: usize| vertices.new_of(old[o] as usize).contains(&new[v]);
    // A vertex may have become several, but a face has one of them at most.
    new.len() == n
        && (0..n)
            .filter(|&v| became(0, v))
            .any(|v| (1..n).all(|o| became(o, (v + o) % n)) || (1..n).all(|o| became(o, (v + n - o) % n)))
}
