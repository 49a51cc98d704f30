//! The table of `tests/README.md` holds: every test that it names is there.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// The rows that the specification has.
const ROWS: [&str; 27] = [
    "Mesh, vertex pool",
    "Translate",
    "Scale",
    "Rotate",
    "Deform",
    "Raycast",
    "Weld",
    "Subdivide",
    "Smooth",
    "Reduce",
    "EdgeCollapse",
    "Volume",
    "GetNakedEdges",
    "Flip",
    "IsClosed",
    "UnifyNormals",
    "ClosestVertex",
    "ClosestFace",
    "ClosestEdge",
    "ClosestPoint",
    "Contains, mass properties",
    "Cross-cutting",
    "Measured cases",
    "The tutorial's loops",
    "Properties",
    "Bad input, cancelled calls",
    "Command line",
];

/// Names of the functions in all files below a directory.
fn functions(directory: &Path, into: &mut BTreeSet<String>) {
    for entry in fs::read_dir(directory).expect("a directory") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            functions(&path, into);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let text = fs::read_to_string(&path).expect("text");
            let names = text.lines().filter_map(|l| l.trim().strip_prefix("fn ")?.split('(').next());
            into.extend(names.map(str::to_owned));
        }
    }
}

#[test]
fn every_row_of_the_table_names_tests_and_every_test_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut known = BTreeSet::new();
    ["tests", "cli/tests", "src"].iter().for_each(|d| functions(&root.join(d), &mut known));
    let table = fs::read_to_string(root.join("tests/README.md")).expect("the table");
    let sections: Vec<&str> = table.split("\n## ").skip(1).collect();
    let titles: Vec<&str> = sections.iter().filter_map(|s| s.lines().next()).collect();
    for row in ROWS {
        assert!(titles.contains(&row), "no section {row}: {titles:?}");
    }
    for section in sections {
        let title = section.lines().next().unwrap_or_default();
        let rows = section.lines().filter(|l| l.starts_with("| ") && !l.starts_with("| sentence"));
        let mut named = 0;
        for row in rows {
            let tests = row.trim_end_matches('|').rsplit('|').next().unwrap_or_default();
            let names: Vec<&str> = tests.split('`').skip(1).step_by(2).collect();
            assert!(!names.is_empty(), "{title}: no test for {row}");
            for name in names {
                assert!(known.contains(name), "{title}: there is no test {name}");
                named += 1;
            }
        }
        assert!(named > 0, "{title} names no test");
    }
}
