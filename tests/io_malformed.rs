//! The readers alone against the corpus's manifest: raw counts of every file, and which files they refuse.

mod corpus;

use corpus::{Exceptions, Row, rows};
use meshwright::PolygonSoup;
use meshwright::io::{Limits, Loaded, NoteKind, ReadError, read_file};
use std::collections::BTreeMap;

/// Where a reader differs from the manifest, and why. Everything else that the manifest reads is read, with its counts;
/// everything else that it rejects is refused.
const EXCEPTIONS: &str = "\
malformed/assimp__OutOfMemory.off\tread\trefused\tissues\tpromises more vertices than it has bytes
malformed/assimp__invalid.off\tread\trefused\tissues\tends within a face
malformed/assimp__number_formats.obj\tread\trefused\tissues\ta coordinate is no number
malformed/derived__obj_decimal_comma.obj\tread\trefused\tissues\ta coordinate is no number
malformed/derived__off_face_count_too_big.off\tread\trefused\tissues\tends before the last face
malformed/derived__ply_ascii_vertex_count_2000000000.ply\tread\trefused\tissues\tpromises more vertices than it has bytes
malformed/derived__ply_be_truncated_in_vertices.ply\tread\trefused\tissues\tends within the vertices
malformed/derived__ply_le_list_count_255.ply\tread\trefused\tissues\tends within a list
malformed/derived__stl_ascii_decimal_comma.stl\tread\trefused\tissues\ta coordinate is no number
malformed/derived__stl_binary_count_4294967295.stl\tread\trefused\tissues\tpromises more facets than it has bytes
malformed/derived__stl_binary_truncated_mid_facet.stl\tread\trefused\tissues\tends within a facet
malformed/magnum__invalid-number-count.obj\tread\trefused\tissues\ta vertex without coordinates
malformed/magnum__invalid-numbers.obj\tread\trefused\tissues\ta coordinate is no number
malformed/magnum__positions-missing.ply\tread\trefused\tissues\tvertices without x, y and z
malformed/magnum__unsupported-face-size.ply\tread\trefused\tissues\tends within a face
malformed/openscad__invalidvertex.stl\tread\trefused\tissues\ta coordinate is no number
malformed/openscad__unparseable.stl\tread\trefused\tissues\ta coordinate is no number
malformed/pymesh__quad.obj\tread\trefused\tissues\ta vertex of two coordinates
malformed/sofa__raptorTemperature.obj\tread\trefused\tissues\ta vertex of one coordinate
malformed/trimesh__whitespace.off\tread\tok\treject\tbegins with its counts, without the word OFF
";

/// Faces by degree, in the manifest's words.
fn degrees(soup: &PolygonSoup) -> String {
    let mut count = BTreeMap::new();
    for face in soup.polygons.iter() {
        *count.entry(face.len()).or_insert(0) += 1;
    }
    count.iter().map(|(degree, n)| format!("{degree}:{n}")).collect::<Vec<_>>().join(",")
}

fn compare(exceptions: &mut Exceptions, row: &Row, loaded: &Loaded) {
    let soup = &loaded.soup;
    let out_of_range =
        soup.polygons.iter().filter(|f| f.iter().any(|&v| v as usize >= soup.positions.len())).count();
    let short = soup.polygons.iter().filter(|f| f.len() < 3).count();
    let nonfinite = soup.positions.iter().filter(|p| !p.is_finite()).count();
    for (field, ours) in [
        ("vertices", soup.positions.len().to_string()),
        ("faces", soup.polygons.len().to_string()),
        ("polygon_degrees", degrees(soup)),
        ("out_of_range_faces", out_of_range.to_string()),
        ("short_faces", short.to_string()),
        ("nonfinite_vertices", nonfinite.to_string()),
    ] {
        exceptions.compare(&row.path, field, &ours, row.get(field));
    }
    for (kind, count) in [
        (NoteKind::IndexOutOfRange, out_of_range),
        (NoteKind::ShortFace, short),
        (NoteKind::NonFiniteCoordinate, nonfinite),
    ] {
        let is_noted = loaded.notes.iter().any(|n| n.kind == kind);
        assert_eq!(is_noted, count > 0, "{}: {kind:?} is noted exactly when there is one", row.path);
    }
}

#[test]
fn the_readers_agree_with_the_manifest_on_raw_counts_and_on_what_is_refused() {
    let Some(rows) = rows() else { return };
    let mut exceptions = Exceptions::new(EXCEPTIONS);
    let mut compared = 0;
    for row in &rows {
        let theirs = row.get("read");
        match read_file(&row.file, &Limits::default()) {
            Ok(loaded) if row.is_readable() => {
                compared += 1;
                // So that a row of what is no longer refused is stale.
                exceptions.compare(&row.path, "read", theirs, theirs);
                compare(&mut exceptions, row, &loaded);
            }
            Ok(_) => exceptions.compare(&row.path, "read", "ok", theirs),
            Err(error) => {
                assert!(error.place().is_some(), "{}: {error}", row.path);
                assert!(matches!(error, ReadError::Malformed { .. } | ReadError::Unsupported { .. }));
                let ours = if row.is_readable() { "refused" } else { "reject" };
                exceptions.compare(&row.path, "read", ours, theirs);
            }
        }
    }
    assert!(compared > 200, "only {compared} files were compared");
    exceptions.finish();
}
