//! Clean-up of every readable corpus file.

mod corpus;

use corpus::rows;
use meshwright::cleanup::{CleanOptions, Weld, clean, clean_indexed, index};
use meshwright::glam::DVec3;
use meshwright::{Element, Kind, Mesh, Outcome, PolygonSoup};
use std::collections::{BTreeSet, HashSet};

fn cleaned(soup: &PolygonSoup, weld: Weld) -> Outcome<Mesh> {
    clean(soup, CleanOptions { weld, ..Default::default() }).expect("a soup is never refused")
}

fn bits(p: DVec3) -> [u64; 3] {
    (p + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// An edge by the places of its ends.
fn place(a: DVec3, b: DVec3) -> [[u64; 3]; 2] {
    let (a, b) = (bits(a), bits(b));
    [a.min(b), a.max(b)]
}

#[test]
fn cleaning_every_readable_file_gives_a_valid_mesh_with_an_honest_account() {
    let Some(rows) = rows() else { return };
    let mut untouched = 0;
    for row in rows.iter().filter(|r| r.is_readable()) {
        let Ok(soup) = row.load() else { continue };
        let outcome = cleaned(&soup, Weld::Exact);
        let mesh = &outcome.value;
        assert_eq!(mesh.validate(), Ok(()), "{}", row.path);

        // Without defects it comes out identical, with an empty record.
        let indexed = index(&soup, Weld::Exact).expect("a soup is never refused").value;
        let defects = [
            "edges_gt2",
            "pinch_vertices",
            "conflict_edges",
            "degenerate_faces",
            "duplicate_faces",
            "out_of_range_faces",
            "short_faces",
            "nonfinite_vertices",
        ];
        if row.get("read") == "ok" && defects.iter().all(|d| row.count(d) == 0) {
            untouched += 1;
            assert_eq!(outcome.report.records, [], "{}", row.path);
            let pool = clean_indexed(&soup, CleanOptions::default()).expect("a soup is never refused");
            assert!(pool.value == indexed, "{}", row.path);
            assert_eq!(
                (mesh.to_indexed().positions(), mesh.to_indexed().polygons()),
                (indexed.positions(), indexed.polygons())
            );
        }

        // No face is dropped that need not be.
        let dropped = (0..soup.polygons.len()).filter(|&f| outcome.maps.faces.new_of(f).is_empty()).count();
        let may: i64 = ["degenerate_faces", "duplicate_faces", "short_faces", "out_of_range_faces"]
            .iter()
            .map(|d| row.count(d))
            .sum();
        let non_finite = outcome.report.count(Kind::NonFiniteFace) as i64;
        assert!(dropped as i64 <= may + non_finite, "{}: {dropped} faces dropped, {may} may be", row.path);

        no_new_boundary(&soup, &outcome, &row.path);

        // A second pass changes nothing.
        let again = cleaned(&mesh.to_indexed().into(), Weld::None);
        assert_eq!(again.report.records, [], "{}", row.path);
        assert_eq!(again.value.to_indexed(), mesh.to_indexed(), "{}", row.path);
    }
    assert!(untouched > 100, "only {untouched} files were without defects");
}

/// New boundary lies at edges with three or more faces, at recorded cuts, and where a duplicate was dropped.
fn no_new_boundary(soup: &PolygonSoup, outcome: &Outcome<Mesh>, path: &str) {
    let indexed = index(soup, Weld::Exact).expect("a soup is never refused").value;
    let topology = indexed.topology();
    let at = |[a, b]: [u32; 2]| place(indexed.positions()[a as usize], indexed.positions()[b as usize]);
    let mut allowed: HashSet<_> = topology.boundary_edges().map(|e| at(e.vertices())).collect();
    allowed.extend(topology.nonmanifold_edges().map(|e| at(e.vertices())));
    for record in &outcome.report.records {
        match record.element {
            Element::Edge([a, b]) => {
                allowed.insert(place(soup.positions[a as usize], soup.positions[b as usize]));
            }
            Element::Face(f) if record.kind == Kind::DuplicateFace => {
                let face = &soup.polygons[f as usize];
                for (i, &a) in face.iter().enumerate() {
                    let b = face[(i + 1) % face.len()];
                    allowed.insert(place(soup.positions[a as usize], soup.positions[b as usize]));
                }
            }
            _ => {}
        }
    }
    // A boundary edge that was parted in the middle has one end that came from nothing.
    let pool = outcome.value.to_indexed();
    let from_nothing: BTreeSet<u32> = (0..pool.vertex_count() as u32)
        .filter(|&v| outcome.maps.vertices.old_of(v as usize).is_empty())
        .collect();
    for edge in pool.topology().boundary_edges() {
        let [a, b] = edge.vertices();
        if from_nothing.contains(&a) || from_nothing.contains(&b) {
            continue;
        }
        let [p, q] = [a, b].map(|v| pool.positions()[v as usize]);
        assert!(allowed.contains(&place(p, q)), "{path}: new boundary at {p} - {q}");
    }
}
