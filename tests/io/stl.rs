//! STL: what it takes, and how it refuses.

use super::*;

#[test]
fn stl_says_what_it_loses() {
    let mut soup = awkward();
    soup.positions.iter_mut().for_each(|p| *p = p.clamp(DVec3::splat(-1e3), DVec3::splat(1e3)));
    soup.positions.push(DVec3::ONE);
    let (file, lost) = written(&soup, Format::Stl, Encoding::Binary);
    assert_eq!(lost, [Lost::SharedVertices, Lost::Precision, Lost::Polygons, Lost::IsolatedVertices]);
    assert_eq!(read(&file, Format::Stl).soup.polygons.len(), 2 + 2 + 3);
}

#[test]
fn a_concave_polygon_is_cut_rightly_for_stl() {
    let dart = vec![dvec3(0., 0., 0.), dvec3(4., 0., 0.), dvec3(4., 4., 0.), dvec3(3., 1., 0.)];
    let soup = PolygonSoup::new(dart, vec![vec![0, 1, 2, 3]].into());
    let back = read(&written(&soup, Format::Stl, Encoding::Ascii).0, Format::Stl).soup;
    let area: f64 = back
        .polygons
        .iter()
        .map(|t| {
            (back.positions[t[1] as usize] - back.positions[t[0] as usize])
                .cross(back.positions[t[2] as usize] - back.positions[t[0] as usize])
                .z
                / 2.0
        })
        .sum();
    assert_eq!(area, 4.0);
}

const FACET: &str =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0.1\nendloop\nendfacet\n";

#[test]
fn ascii_stl_is_read_in_all_its_spellings_and_digits() {
    for text in [
        format!("solid\n{FACET}endsolid\n"),
        format!("solid a name\nover lines\n{FACET}end solid\n"),
        format!("SOLID X\r\n{}ENDSOLID\r\n", FACET.to_uppercase().replace('\n', "\r\n")),
        format!("# remark\nsolid\n{FACET}").replace('\n', "\r"),
        format!("solid caf\u{e9}\n{}endsolid", FACET.replace("0 0 1\n", "nan inf weird\n")),
    ] {
        let loaded = read(text.as_bytes(), Format::Stl);
        assert_eq!(
            loaded.soup.positions[2],
            dvec3(0., 1., 0.1),
            "no detour through single precision: {text}"
        );
        assert_eq!(loaded.soup.polygons, vec![vec![0, 1, 2]].into());
    }
    let two = read(format!("solid\n{FACET}endsolid\nsolid\n{FACET}endsolid\n").as_bytes(), Format::Stl);
    assert_eq!(two.soup.polygons.len(), 2);
    let open = read(format!("solid\n{FACET}").as_bytes(), Format::Stl);
    assert_eq!(notes(&open), [(NoteKind::MissingEnd, Place::Line(8))]);
}

#[test]
fn a_binary_stl_that_begins_with_solid_is_binary() {
    let soup = shapes::soup(&shapes::fanned(&shapes::cube()));
    let (mut file, _) = written(&soup, Format::Stl, Encoding::Binary);
    file[..5].copy_from_slice(b"solid");
    assert_eq!(read(&file, Format::Stl).soup.polygons.len(), 12);
    file.extend([0; 49]);
    assert_eq!(notes(&read(&file, Format::Stl)), [(NoteKind::TrailingData, Place::Byte(684))]);
    file.truncate(84 + 50 * 12 - 1);
    file[..5].copy_from_slice(b"cubic");
    let expected = Malformed::Promise { what: "facets", wanted: 12, room: 11 };
    assert_eq!(refusal(read_stl(&file, &limits())), (Place::Byte(80), expected));
}

#[test]
fn ascii_stl_refuses_with_the_line() {
    let refused = |text: &str| refusal(read_stl(text.as_bytes(), &limits()));
    let bad = format!("solid\n{}", FACET.replace("vertex 1 0 0", "vertex 1 0 blah"));
    assert_eq!(refused(&bad), (Place::Line(5), Malformed::Number("blah".into())));
    assert_eq!(
        refused("solid\nvertex 0 0 0\n"),
        (Place::Line(2), Malformed::Expected("a facet before its vertices"))
    );
    assert_eq!(refused("solid\nfacet normal 0 0 1\nvertex 0 0\n").0, Place::Line(3));
    assert_eq!(refused("solid\nfacet\nfacet\n").0, Place::Line(3));
    assert_eq!(refused("solid\nfacet\nouter loop\n"), (Place::Line(3), Malformed::Truncated("a facet")));
    assert_eq!(refused(""), (Place::Byte(0), Malformed::Empty));
    assert_eq!(refused("hello"), (Place::Byte(5), Malformed::Truncated("the header")));
}

#[test]
fn a_binary_stl_cut_short_is_not_taken_for_text() {
    let (mut file, _) = written(&shapes::soup(&shapes::cube()), Format::Stl, Encoding::Binary);
    file[..6].copy_from_slice(b"solid ");
    file.truncate(400);
    let expected = Malformed::Promise { what: "facets", wanted: 12, room: 6 };
    assert_eq!(refusal(read_stl(&file, &limits())), (Place::Byte(80), expected));
}
