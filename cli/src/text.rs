//! How things read to people.

use meshwright::glam::DVec3;
use meshwright::{Kind, LostValue, Report, Step};

/// `1 face`, `2 faces`.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    let plural = match (count, noun) {
        (1, _) => noun.to_owned(),
        (_, "vertex") => "vertices".to_owned(),
        _ => format!("{noun}s"),
    };
    format!("{count} {plural}")
}

/// A number in as many digits as it takes to read it back, with an exponent where it would be long.
pub(crate) fn number(x: f64) -> String {
    if x == 0.0 || (1e-5..1e16).contains(&x.abs()) || !x.is_finite() {
        x.to_string()
    } else {
        format!("{x:e}")
    }
}

/// A point.
pub(crate) fn point(p: DVec3) -> String {
    format!("({}, {}, {})", number(p.x), number(p.y), number(p.z))
}

/// What was changed, a line per kind, with the first few elements.
pub(crate) fn changes(report: &Report) -> Vec<String> {
    const SHOWN: usize = 5;
    let mut lines = Vec::new();
    let weld = report.steps.iter().find(|s| s.step == Step::Weld && s.changed > 0);
    if let Some(weld) = weld {
        let how = match weld.tolerance {
            Some(t) if t > 0.0 => format!("closer than {}", number(t)),
            _ => "at equal coordinates".to_owned(),
        };
        lines.push(format!("merged {} {how}", counted(weld.changed, "vertex")));
    }
    for (kind, count) in report.counts() {
        let records = report.records.iter().filter(|r| r.kind == kind).take(SHOWN);
        let shown: Vec<String> = records.map(|r| r.element.to_string()).collect();
        let more = if count > SHOWN { format!(" and {} more", count - SHOWN) } else { String::new() };
        let (noun, what) = described(kind);
        lines.push(format!("{} {what}: {}{more}", counted(count, noun), shown.join(", ")));
    }
    lines
}

/// What the result does not have of the file, a line for all attributes, and one for each reason why single values are
/// missing.
pub(crate) fn not_carried(report: &Report) -> Vec<String> {
    let mut lines = Vec::new();
    if !report.not_carried.is_empty() {
        let names: Vec<String> = report.not_carried.iter().map(|a| a.as_str().replace('_', " ")).collect();
        lines.push(format!("not carried over: {}", names.join(", ")));
    }
    for lost in alike(report) {
        let [attribute, reason] =
            [lost[0].attribute.as_str(), lost[0].reason.as_str()].map(|n| n.replace('_', " "));
        let count = counted(lost.len(), "value");
        lines.push(format!("{count} of {attribute} not carried over ({reason}): {} first", lost[0].element));
    }
    lines
}

/// The values that were not carried, those of one attribute and reason together.
pub(crate) fn alike(report: &Report) -> impl Iterator<Item = &[LostValue]> {
    report.lost_values.chunk_by(|a, b| (a.attribute, a.reason) == (b.attribute, b.reason))
}

/// What a kind of record counts, and what was found and done.
pub(crate) fn described(kind: Kind) -> (&'static str, &'static str) {
    match kind {
        Kind::NonFiniteVertex => ("vertex", "not finite, dropped"),
        Kind::NonFiniteFace => ("face", "with a vertex that is not finite, dropped"),
        Kind::OutOfRangeFace => ("face", "naming vertices that do not exist, dropped"),
        Kind::ShortFace => ("face", "of fewer than three corners, dropped"),
        Kind::MergedVertex => ("vertex", "moved by the merging"),
        Kind::RepeatedCorner => ("face", "with corners repeated, repaired"),
        Kind::DegenerateFace => ("face", "with fewer than three distinct corners, dropped"),
        Kind::PinchedFace => ("face", "touching itself, cut into simple ones"),
        Kind::DuplicateFace => ("face", "already there, dropped"),
        Kind::FlippedFace => ("face", "reversed"),
        Kind::NonManifoldEdge => ("edge", "with three or more faces, taken apart"),
        Kind::CutEdge => ("edge", "cut open, as the surface cannot be oriented"),
        Kind::PinchedVertex => ("vertex", "where surfaces touch, split"),
        Kind::SharpEdge => ("edge", "sharp, parted"),
        Kind::ParallelEdge => ("edge", "doubling another, parted in the middle"),
        Kind::StitchedEdge => ("edge", "of a crack, closed"),
        Kind::TJunction => ("vertex", "within another face's edge, joined"),
        Kind::Fin => ("face", "of fins, dropped"),
        Kind::Needle => ("face", "with an edge of no length, collapsed"),
        Kind::Cap => ("face", "without height, merged into a neighbour"),
        Kind::FlatFace => ("face", "without height, cut and resolved"),
        Kind::AbsorbedFace => ("face", "taken over by its neighbours"),
        Kind::LeftSliver => ("face", "without height that could not be resolved, left"),
        Kind::Debris => ("face", "of small parts, dropped"),
        Kind::FilledHole => ("hole", "filled"),
        Kind::HastyFillers => ("filler", "of little area but not the least, as there were so many"),
        Kind::UnsearchedHoles => ("hole", "not looked through for islands to the end, as there were so many"),
        Kind::UnsearchedEdges => {
            ("edge", "around which not all was looked at: there may be more to be stitched")
        }
        Kind::HoleWithIslands => ("hole", "with islands, left"),
        Kind::HemmedInHole => ("hole", "that no filler fits, left"),
        Kind::OutsideOfSheet => ("hole", "as large as the part around it, left"),
        Kind::LongHole => ("hole", "too long, left"),
        Kind::IsolatedVertex => ("vertex", "without a face, dropped"),
        Kind::TurnedShell => ("shell", "inside out, turned"),
        Kind::CrossingShell => ("shell", "crossing another, judged by its own volume"),
        Kind::OpenSheet => ("sheet", "that cannot become a solid, left"),
        Kind::NotOrientable => ("part", "whose edges meet the wrong way round (not orientable), left"),
        Kind::OpenPart => ("part", "with holes that could not be filled, left"),
        Kind::SelfIntersection => ("pair", "of faces that pass through each other, left"),
        Kind::UnsearchedFaces => {
            ("face", "not held against all others: there may be more that pass through each other")
        }
        other => ("element", other.as_str()),
    }
}
