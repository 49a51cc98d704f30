//! Every readable corpus file through both profiles: a valid mesh, an account that holds, in bounded time and memory.
//!
//! With `MESHWRIGHT_CORPUS_TABLE` set to a path, what came of each file is written there as a table: `docs/corpus.md`.

mod corpus;

use corpus::{Row, rows};
use meshwright::cleanup::{Account, CleanOptions, Profile, Weld, clean_indexed};
use meshwright::{Element, Kind, Mesh, Outcome, PolygonSoup, Step};
use std::collections::HashSet;
use std::fmt::Write as _;
use std::io::Write as _;
use std::time::Instant;

/// What came of a file.
struct Came {
    account: Account,
    seconds: f64,
}

fn cleaned(soup: &PolygonSoup, profile: Profile, path: &str) -> Came {
    let options = match profile {
        Profile::Solid => CleanOptions::solid(),
        _ => CleanOptions::default(),
    };
    let weld = options.weld;
    let start = Instant::now();
    let outcome = clean_indexed(soup, options).expect("a soup is never refused");
    let seconds = start.elapsed().as_secs_f64();
    let Outcome { value: pool, report, maps } = outcome;
    let mesh = Mesh::build(&pool).unwrap_or_else(|e| panic!("{path}: {e}"));
    assert_eq!(mesh.validate(), Ok(()), "{path}");

    // Every face of the input is kept, changed, or dropped for a reason.
    let account = Account::new(soup, (profile, weld), &pool, report.clone(), &maps).expect("as before");
    let tally = account.face_tally;
    assert_eq!(tally.kept + tally.changed + tally.dropped, soup.polygons.len(), "{path}: {tally:?}");
    let named: HashSet<Element> = report.records.iter().map(|r| r.element).collect();
    for f in (0..soup.polygons.len()).filter(|&f| maps.faces.new_of(f).is_empty()) {
        assert!(named.contains(&Element::Face(f as u32)), "{path}: face {f} vanished");
    }
    assert_eq!(account.solid, mesh.is_closed(), "{path}");
    if profile == Profile::Solid {
        let open = [Kind::OpenPart, Kind::OpenSheet, Kind::NotOrientable].map(|k| report.count(k));
        let parts = mesh.components().len();
        let closed = parts - open.iter().sum::<usize>();
        assert!(account.solid || closed < parts || parts == 0, "{path}: what is open is not named");
        // A second pass changes nothing.
        if soup.polygons.len() < 200_000 {
            let options = CleanOptions { weld: Weld::None, ..CleanOptions::solid() };
            let again = clean_indexed(&pool.clone().into(), options).expect("a soup is never refused");
            let is_same =
                again.value.positions() == pool.positions() && again.value.polygons() == pool.polygons();
            assert!(is_same, "{path}: a second pass finds {:?}", again.report.counts());
        }
    }
    Came { account, seconds }
}

fn line(table: &mut String, row: &Row, soup: &PolygonSoup, preserve: &Came, solid: &Came) {
    let count = |kind| solid.account.counts.get(&kind).copied().unwrap_or(0);
    let found = |step| solid.account.steps.iter().find(|s| s.step == step).map_or(0, |s| s.changed);
    let f = solid.account.face_tally;
    let is = |yes: bool| if yes { "yes" } else { "no" };
    let open = count(Kind::OpenPart) + count(Kind::OpenSheet) + count(Kind::NotOrientable);
    writeln!(
        table,
        "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
        row.path.replace('|', "/"),
        soup.polygons.len(),
        is(preserve.account.solid),
        is(solid.account.solid),
        f.kept,
        f.changed,
        f.dropped,
        f.added,
        count(Kind::FilledHole),
        open,
        found(Step::FindIntersections),
        if soup.polygons.is_empty() { "no faces" } else { "" },
    )
    .expect("a string takes everything");
}

/// The most memory this process has held, in MiB.
fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let kib = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    Some(kib.trim().trim_end_matches(" kB").parse::<u64>().ok()? >> 10)
}

#[test]
fn every_readable_file_becomes_a_solid_or_is_told_why_not() {
    let Some(rows) = rows() else { return };
    let mut table = String::new();
    let (mut files, mut closed_before, mut solids, mut slowest) = (0, 0, 0, (0.0, String::new()));
    let mut failed = Vec::new();
    for row in rows.iter().filter(|r| r.is_readable()) {
        let Ok(soup) = row.load() else { continue };
        let both = std::panic::catch_unwind(|| {
            let preserve = cleaned(&soup, Profile::Preserve, &row.path);
            (preserve, cleaned(&soup, Profile::Solid, &row.path))
        });
        let Ok((preserve, solid)) = both else {
            failed.push(row.path.clone());
            continue;
        };
        for came in [&preserve, &solid] {
            if came.seconds > slowest.0 {
                slowest = (came.seconds, row.path.clone());
            }
        }
        files += 1;
        closed_before += usize::from(preserve.account.solid);
        solids += usize::from(solid.account.solid);
        line(&mut table, row, &soup, &preserve, &solid);
    }
    let peak = peak();
    let _ = writeln!(
        std::io::stderr(),
        "{files} files, {closed_before} closed by preserve, {solids} by solid; slowest {slowest:?}, peak {peak:?} MiB"
    );
    assert!(failed.is_empty(), "{failed:#?}");
    assert!(files > 100, "only {files} files");
    // With other tests at work beside this one, a machine may take several times as long.
    assert!(slowest.0 < 10.0, "{slowest:?}");
    assert!(peak.is_none_or(|p| p < 1024), "{peak:?} MiB");
    if let Some(path) = std::env::var_os("MESHWRIGHT_CORPUS_TABLE") {
        let head = format!(
            "# The corpus, cleaned\n\n\
             What both profiles make of {files} files of real and broken meshes, by `tests/corpus_solid.rs`. *Preserve* closes \
             {closed_before} of them, *solid* {solids}; what is no solid is left open on record: sheets, terrain, strips that \
             cannot be oriented. Each result validates, each account covers every face of its file, and a second pass changes \
             nothing.\n\n\
             | file | faces | closed by preserve | solid | kept | changed | dropped | new | holes filled | parts left open | \
             intersecting pairs | |\n|---|--:|---|---|--:|--:|--:|--:|--:|--:|--:|---|\n"
        );
        std::fs::write(path, head + &table).expect("written");
    }
}
