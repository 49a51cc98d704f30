//! The account of a clean-up as people read it: what was wrong and where, what was done, what remains, what it came to.

use crate::text::{self, counted};
use meshwright::cleanup::{Account, Facts, Profile};
use meshwright::glam::DVec3;
use meshwright::{Kind, Record, Step};
use std::fmt::Write as _;

/// Of each kind, how many elements are shown.
const SHOWN: usize = 3;

/// What is said of things that were found and left.
const LEFT: [Kind; 14] = [
    Kind::HoleWithIslands,
    Kind::HemmedInHole,
    Kind::OutsideOfSheet,
    Kind::LongHole,
    Kind::LeftSliver,
    Kind::OpenSheet,
    Kind::NotOrientable,
    Kind::OpenPart,
    Kind::CrossingShell,
    Kind::SelfIntersection,
    Kind::UnsearchedFaces,
    Kind::UnsearchedEdges,
    Kind::UnsearchedHoles,
    Kind::SharpEdge,
];

/// The account in lines.
pub(crate) fn told(account: &Account) -> String {
    let mut text = String::new();
    let mut section = |title: &str, lines: Vec<String>| {
        if !lines.is_empty() {
            // Writing to a string does not fail.
            let _ = writeln!(text, "{title}");
            lines.iter().for_each(|line| text.push_str(&format!("  {line}\n")));
            text.push('\n');
        }
    };
    let is_left = |kind: &Kind| LEFT.contains(kind);
    let mut done = Vec::from_iter(merged(account));
    done.extend(account.counts.keys().filter(|k| !is_left(k)).flat_map(|&k| kind(account, k)));
    section("Found and repaired", done);
    section(
        "Left as it is",
        account.counts.keys().filter(|k| is_left(k)).flat_map(|&k| kind(account, k)).collect(),
    );
    section("Result", vec![verdict(account), faces(account), surface(account)]);
    let _ = write!(text, "{}", table(&account.before, &account.after));
    text
}

fn merged(account: &Account) -> Option<String> {
    let weld = account.steps.iter().find(|s| s.step == Step::Weld && s.changed > 0)?;
    let how = match weld.tolerance {
        Some(t) if t > 0.0 => format!("closer than {}", short(t)),
        _ => "at equal coordinates".to_owned(),
    };
    Some(format!("{} {how}, merged", counted(weld.changed, "vertex")))
}

/// How many of a kind, and where the first few are.
fn kind(account: &Account, kind: Kind) -> Vec<String> {
    let count = account.counts.get(&kind).copied().unwrap_or(0);
    if kind == Kind::MergedVertex {
        // Told with the weld.
        return Vec::new();
    }
    let (noun, what) = text::described(kind);
    let what = what.strip_suffix(", left").unwrap_or(what);
    let of_kind = || account.defects.iter().filter(|r| r.kind == kind);
    // Of what is listed in part, the step knows how many there are.
    let all = match kind {
        Kind::SelfIntersection => {
            account.steps.iter().find(|s| s.step == Step::FindIntersections).map_or(count, |s| s.changed)
        }
        // One stands for all.
        Kind::UnsearchedFaces | Kind::UnsearchedEdges | Kind::UnsearchedHoles | Kind::HastyFillers => {
            return of_kind()
                .map(|r| format!("{} {what}", counted(r.extent.map_or(1, |e| e.elements), noun)))
                .collect();
        }
        _ => count,
    };
    let mut lines = vec![format!("{} {what}", counted(all, noun))];
    lines.extend(of_kind().take(SHOWN).map(|r| format!("    {}", place(r))));
    if all > SHOWN {
        lines.push(format!("    and {} more", all - SHOWN));
    }
    lines
}

fn place(record: &Record) -> String {
    let mut text = record.element.to_string();
    if let Some(p) = record.place {
        let _ = write!(text, " at {}", rounded(p));
    }
    if let Some(extent) = record.extent {
        let noun = match record.step {
            Step::FillHoles => "edge",
            _ => "face",
        };
        let _ = write!(text, ", {}", counted(extent.elements, noun));
        if extent.area > 0.0 {
            let _ = write!(text, ", area {}", short(extent.area));
        }
    }
    text
}

fn verdict(account: &Account) -> String {
    let is = |yes: bool, name: &str| if yes { name.to_owned() } else { format!("not {name}") };
    let after = &account.after;
    let state = [is(after.closed, "closed"), is(after.manifold, "manifold"), is(after.oriented, "oriented")]
        .join(", ");
    match (account.profile, account.solid) {
        _ if after.faces == 0 => "no face is left".to_owned(),
        (Profile::Solid, true) if account.counts.contains_key(&Kind::SelfIntersection) => {
            format!("a solid ({state}, outward), but its faces pass through each other")
        }
        (Profile::Solid, true) => format!("a solid: {state}, outward"),
        (Profile::Solid, false) => format!("no solid: {state}"),
        _ => state,
    }
}

fn faces(account: &Account) -> String {
    let f = &account.face_tally;
    let mut parts = vec![format!("{} kept", f.kept)];
    let more = [(f.changed, "changed"), (f.dropped, "dropped"), (f.added, "new")];
    parts.extend(more.iter().filter(|m| m.0 > 0).map(|(count, what)| format!("{count} {what}")));
    format!("of {}: {}", counted(f.input, "face"), parts.join(", "))
}

fn surface(account: &Account) -> String {
    if account.moved > 0.0 {
        format!("the surface moved by {} at most", short(account.moved))
    } else {
        "nothing was moved".to_owned()
    }
}

fn table(before: &Facts, after: &Facts) -> String {
    let count =
        |name: &'static str, of: fn(&Facts) -> usize| (name, of(before).to_string(), of(after).to_string());
    let always = [
        count("vertices", |f| f.vertices),
        count("faces", |f| f.faces),
        count("components", |f| f.components),
    ];
    let defects = [
        count("boundary edges", |f| f.boundary_edges),
        count("edges with 3 or more faces", |f| f.nonmanifold_edges),
        count("vertices where surfaces touch", |f| f.nonmanifold_vertices),
        count("edges with mixed winding", |f| f.conflicting_edges),
        count("duplicate faces", |f| f.duplicate_faces),
        count("vertices without a face", |f| f.isolated_vertices),
    ];
    let volume = |f: &Facts| f.volume.map_or_else(|| "-".to_owned(), short);
    let mut rows = vec![(String::new(), "before".to_owned(), "after".to_owned())];
    let shown = defects.into_iter().filter(|(_, b, a)| b != "0" || a != "0");
    rows.extend(always.into_iter().chain(shown).map(|(name, b, a)| (name.to_owned(), b, a)));
    rows.push(("volume".to_owned(), volume(before), volume(after)));
    let width = |of: fn(&(String, String, String)) -> usize| rows.iter().map(of).max().unwrap_or(0);
    let (names, befores, afters) = (width(|r| r.0.len()), width(|r| r.1.len()), width(|r| r.2.len()));
    rows.iter().map(|(n, b, a)| format!("  {n:names$}  {b:>befores$}  {a:>afters$}\n")).collect()
}

/// A number in four digits: enough to find a place, or to compare.
fn short(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let digits = 3 - x.abs().log10().floor() as i32;
    if (-2..=6).contains(&digits) {
        let text = format!("{x:.*}", digits.max(0) as usize);
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{x:.2e}")
    }
}

fn rounded(p: DVec3) -> String {
    let [x, y, z] = p.to_array().map(short);
    format!("({x}, {y}, {z})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_cut_to_what_a_reader_needs() {
        let texts = [0.0, 1.0, -2.5, 1234.5678, 123456.7, 0.00123456, 1e-9, 1e20].map(short);
        assert_eq!(texts, ["0", "1", "-2.5", "1235", "123457", "0.001235", "1.00e-9", "1.00e20"]);
    }
}
