//! `inspect` against the measured facts of the corpus.

mod corpus;

use corpus::{Exceptions, rows};
use meshwright::cleanup::{Weld, inspect};

#[test]
fn inspect_agrees_with_the_manifest_on_every_readable_file() {
    let Some(rows) = rows() else { return };
    let mut exceptions = Exceptions::new(include_str!("corpus/facts.tsv"));
    let mut compared = 0;
    for row in rows.iter().filter(|r| r.is_readable()) {
        let soup = match row.load() {
            Ok(soup) => soup,
            Err(error) => {
                let may = row.may_be_refused() && error.place().is_some();
                exceptions.compare(&row.path, "read", if may { "ok" } else { "refused" }, "ok");
                eprintln!("{}: {error}", row.path);
                continue;
            }
        };
        let facts = inspect(&soup, Weld::Exact).expect("always answers");
        compared += 1;
        let degrees =
            facts.face_degrees.iter().map(|(d, n)| format!("{d}:{n}")).collect::<Vec<_>>().join(",");
        let yes = |b: bool| if b { "yes" } else { "no" }.to_owned();
        let has_faces = row.get("faces_in_topology") != "0";
        let fields = [
            ("vertices", facts.vertices.to_string()),
            ("faces", facts.faces.to_string()),
            ("polygon_degrees", degrees),
            ("used_vertices", facts.used_vertices.to_string()),
            ("boundary_edges", facts.boundary_edges.to_string()),
            ("boundary_loops", facts.boundary_loops.to_string()),
            ("edges_gt2", facts.nonmanifold_edges.to_string()),
            ("pinch_vertices", facts.nonmanifold_vertices.to_string()),
            ("conflict_edges", facts.conflicting_edges.to_string()),
            ("components_edge", facts.components.to_string()),
            ("euler", facts.euler_characteristic.to_string()),
            ("degenerate_faces", facts.degenerate_faces.to_string()),
            ("duplicate_faces", facts.duplicate_faces.to_string()),
            ("isolated_vertices", facts.isolated_vertices.to_string()),
            ("out_of_range_faces", facts.out_of_range_faces.to_string()),
            ("short_faces", facts.short_faces.to_string()),
            ("nonfinite_vertices", facts.nonfinite_vertices.to_string()),
            ("orientable", if has_faces { yes(facts.orientable) } else { "n/a".to_owned() }),
        ];
        for (field, ours) in fields {
            exceptions.compare(&row.path, field, &ours, row.get(field));
        }
        // The manifest tells "no boundary but edges with more faces" apart from "no".
        let theirs = if row.get("closed") == "yes" { "yes" } else { "no" };
        exceptions.compare(&row.path, "closed", &yes(facts.closed), theirs);
        let near = match (facts.volume, row.number("volume")) {
            (None, None) => true,
            (Some(ours), Some(theirs)) => {
                (ours - theirs).abs() <= 1e-6 * theirs.abs().max(ours.abs()) + 1e-300
            }
            _ => false,
        };
        let ours = facts.volume.map_or(String::new(), |v| format!("{v:.9}"));
        let theirs = row.get("volume").to_owned();
        exceptions.compare(&row.path, "volume", if near { &theirs } else { &ours }, &theirs);
    }
    assert!(compared > 200, "only {compared} files were compared");
    exceptions.finish();
}

#[test]
fn malformed_files_are_read_or_refused_with_their_place() {
    let Some(rows) = rows() else { return };
    for row in rows.iter().filter(|r| r.path.starts_with("malformed/") || r.get("read") == "reject") {
        if let Err(error) = row.load() {
            assert!(error.place().is_some(), "{}: {error}", row.path);
            eprintln!("{}: {error}", row.path);
        }
    }
}
