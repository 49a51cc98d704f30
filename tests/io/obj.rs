//! OBJ: what it takes, and how it refuses.

use super::*;

#[test]
fn obj_takes_what_occurs_in_files() {
    let text = b"\xEF\xBB\xBF# remark\r\no caf\xE9\r\nv 0 0 0 # first\rv\t1  0 0\nv 1 1 0 0.5\nv 0 1 \\\n 0\nvt 0 0\nvn 0 0 1\n\
                 usemtl\tsteel\nf 1/1/1 2//1 \\\n3/1 4\nf -4 -3 -2\ns off\nl 1 2 3\np 1\ncurv 0 1\nf 1 2 3 4";
    let loaded = read(text, Format::Obj);
    assert_eq!(loaded.soup.positions, [DVec3::ZERO, DVec3::X, dvec3(1., 1., 0.), DVec3::Y]);
    assert_eq!(loaded.soup.polygons, vec![vec![0, 1, 2, 3], vec![0, 1, 2], vec![0, 1, 2, 3]].into());
    let group = Group { name: "caf\u{fffd}".into(), material: Some("steel".into()), faces: 0..3 };
    assert_eq!(loaded.soup.groups, [group]);
    assert_eq!(
        notes(&loaded),
        [
            (NoteKind::NotText, Place::Line(2)),
            (NoteKind::PointOrLine, Place::Line(15)),
            (NoteKind::Ignored, Place::Line(17))
        ]
    );
}

#[test]
fn obj_keeps_bad_faces_in_their_place_and_notes_them() {
    let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 0 1 2\nf 1 2\nf 3 2 1\nf -9 1 2\nf 1 2 99999999999999999999\nf\nf 2 3 1\nf 1 2 7\n";
    let loaded = read(text, Format::Obj);
    let none = PolygonSoup::NO_VERTEX;
    let expected = vec![
        vec![0, 1, 2],
        vec![none, 0, 1],
        vec![0, 1],
        vec![2, 1, 0],
        vec![none, 0, 1],
        vec![0, 1, none],
        vec![],
        vec![1, 2, 0],
        vec![0, 1, 6],
    ];
    assert_eq!(loaded.soup.polygons, expected.into());
    assert_eq!(
        notes(&loaded),
        [(NoteKind::IndexOutOfRange, Place::Line(5)), (NoteKind::ShortFace, Place::Line(6))]
    );
    assert_eq!(loaded.notes[0].count, 4);
    assert_eq!(loaded.notes[0].to_string(), "line 5: face indices that name no vertex, kept (4 in all)");
}

#[test]
fn obj_notes_vertices_without_a_colour_beside_some_that_have_one() {
    for (text, line) in [("v 0 0 0\nv 1 0 0 1 0 0\n", 1), ("v 0 0 0 1 0 0\nv 1 0 0\n", 2)] {
        let loaded = read(text.as_bytes(), Format::Obj);
        assert!(loaded.soup.vertex_colors.contains(&[1.0; 4]));
        assert_eq!(notes(&loaded), [(NoteKind::MissingColor, Place::Line(line))]);
    }
}

#[test]
fn obj_keeps_coordinates_that_are_not_finite_and_notes_them() {
    let loaded = read(b"v nan -inf 1.#IND\nv 1e400 0 0\nv -1.#INF 0 0\nv 0 0 0\n", Format::Obj);
    let p = &loaded.soup.positions;
    assert!(p[0].x.is_nan() && p[0].y == f64::NEG_INFINITY && p[0].z.is_nan());
    assert!(p[1].x == f64::INFINITY && p[2].x == f64::NEG_INFINITY && p[3] == DVec3::ZERO);
    assert_eq!(loaded.notes[0].kind, NoteKind::NonFiniteCoordinate);
    assert_eq!((loaded.notes[0].place, loaded.notes[0].count), (Place::Line(1), 3));
}

#[test]
fn obj_numbers_that_upset_its_parser_are_seen_to() {
    // Each of these once made the parser behind the filter panic, or return Ok with nonsense.
    for text in [
        &b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//6148914691236517206 2//1 3//1\n"[..],
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/6148914691236517205 2/1 3/-9223372036854775808\n",
    ] {
        let loaded = read(text, Format::Obj);
        assert_eq!(loaded.soup.polygons, vec![vec![0, 1, 2]].into());
        assert_eq!(loaded.notes[0].kind, NoteKind::AttributeOutOfRange);
    }
    // A corner without an attribute beside some that have one, found by fuzzing the writer.
    round_trip(
        &read(b"v 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nf 1//1 2 3\n", Format::Obj).soup,
        Format::Obj,
        Encoding::Ascii,
    );
}

#[test]
fn obj_refuses_with_the_line() {
    let refused = |text: &[u8]| refusal(read_obj(text, &limits()));
    assert_eq!(refused(b"v 0 0 0\nv 0,5 1 2\n"), (Place::Line(2), Malformed::Number("0,5".into())));
    assert_eq!(refused(b"v 0 0 0\n\nv 3.1+e2 1 2\n"), (Place::Line(3), Malformed::Number("3.1+e2".into())));
    assert_eq!(refused(b"v 0 0\n"), (Place::Line(1), Malformed::Expected("three coordinates")));
    assert_eq!(refused(b"v 0 0 0\nf 1 a 2\n"), (Place::Line(2), Malformed::Number("a".into())));
    assert_eq!(refused(b"vn 0 x 0\n"), (Place::Line(1), Malformed::Number("x".into())));
    assert_eq!(refused(b""), (Place::Line(1), Malformed::Empty));
    assert_eq!(refused(b"hello world\n"), (Place::Line(1), Malformed::Beginning("an OBJ file")));
    assert_eq!(refused(b"\xFE\xFF\0v"), (Place::Line(1), Malformed::Utf16));
}

#[test]
fn groups_keep_their_ends_and_a_missing_material() {
    let mut soup = shapes::soup(&shapes::cube());
    let group = |name: &str, material: Option<&str>, faces| Group {
        name: name.into(),
        material: material.map(Into::into),
        faces,
    };
    soup.groups = vec![group("a", Some("red"), 0..1), group("a", None, 1..2), group("", Some("blue"), 4..5)];
    let (file, lost) = written(&soup, Format::Obj, Encoding::Ascii);
    assert_eq!(lost, []);
    assert_eq!(read(&file, Format::Obj).soup, soup);
    for odd in [
        vec![group("two\nlines", None, 0..6)],
        vec![group("a # remark", None, 0..6)],
        vec![group("a", None, 0..7)],
        vec![group("a", None, 0..4), group("b", None, 3..6)],
        vec![group("a", None, 2..2)],
        vec![group("", None, 0..6)],
        vec![group(" a", Some(""), 0..6)],
    ] {
        soup.groups = odd;
        let (file, lost) = written(&soup, Format::Obj, Encoding::Ascii);
        assert_eq!(lost, [Lost::Groups], "{:?}", soup.groups);
        assert_eq!(read(&file, Format::Obj).soup.polygons, soup.polygons);
    }
}

#[test]
fn obj_faces_may_come_before_what_they_name() {
    let text = b"f 1/1/1 2/2/1 3/3/9\nf 3 2 9\nv 0 0 0\nv 1 0 0\nvt 0 0\nf 1 2 3\nv 0 1 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nf -1 -2 -3\n";
    let loaded = read(text, Format::Obj);
    assert_eq!(loaded.soup.polygons, vec![vec![0, 1, 2], vec![2, 1, 8], vec![0, 1, 2], vec![2, 1, 0]].into());
    let none = CornerData::<f64>::NONE;
    let uvs = loaded.soup.corner_uvs.expect("texture coordinates");
    assert_eq!(uvs.indices, [vec![0, 1, 2], vec![none; 9]].concat());
    let normals = loaded.soup.corner_normals.expect("normals");
    assert_eq!(normals.indices, [vec![0, 0], vec![none; 10]].concat());
    assert_eq!(
        loaded.notes.iter().map(|n| (n.kind, n.place)).collect::<Vec<_>>(),
        [(NoteKind::AttributeOutOfRange, Place::Line(1)), (NoteKind::IndexOutOfRange, Place::Line(2))]
    );
}

#[test]
fn obj_notes_and_refusals_name_the_first_line_that_is_to_blame() {
    let late = read(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1/7 2/7 3/7\n", Format::Obj);
    assert_eq!(notes(&late), [(NoteKind::AttributeOutOfRange, Place::Line(5))]);
    assert_eq!(late.notes[0].count, 3);
    // The parser behind the filter finds the first fault, the filter the second.
    let refused = refusal(read_obj(b"v 0 0 0\nv 1e 0 0\nv 0 1 0\nf 1 2 x\n", &limits()));
    assert_eq!(refused, (Place::Line(2), Malformed::Number("1e".into())));
}

#[test]
fn an_obj_of_remarks_alone_is_an_empty_soup() {
    assert_eq!(read(b"# nothing\n\n", Format::Obj).soup, PolygonSoup::default());
    let (file, _) = written(&PolygonSoup::default(), Format::Obj, Encoding::Ascii);
    assert_eq!(read(&file, Format::Obj).soup, PolygonSoup::default());
}

/// Found by measuring memory: each group took over a long material name, until memory was gone.
#[test]
fn long_names_are_not_copied_without_end() {
    let text = format!("v 0 0 0\nusemtl {}\n{}", "m".repeat(10_000), "g\nf\n".repeat(10_000));
    assert!(matches!(read_obj(text.as_bytes(), &limits()), Err(ReadError::Limit { .. })));
}

#[test]
fn obj_keeps_the_names_of_material_files() {
    let mut soup = shapes::soup(&shapes::cube());
    soup.material_files = vec!["all materials.mtl".into(), "more.mtl".into()];
    let (file, lost) = written(&soup, Format::Obj, Encoding::Ascii);
    assert_eq!((read(&file, Format::Obj).soup, lost), (soup.clone(), vec![]));
    soup.material_files = vec!["two\nlines".into()];
    assert_eq!(written(&soup, Format::Obj, Encoding::Ascii).1, [Lost::MaterialFiles]);
}

#[test]
fn vertex_normals_that_no_corner_has_are_lost_in_obj_and_that_is_said() {
    let mut soup = shapes::soup(&shapes::cube());
    soup.vertex_normals = vec![DVec3::Z; 8];
    assert_eq!(written(&soup, Format::Obj, Encoding::Ascii).1, []);
    soup.corner_normals = Some(CornerData { values: vec![DVec3::X], indices: vec![0; 24] });
    assert_eq!(written(&soup, Format::Obj, Encoding::Ascii).1, [Lost::VertexNormals]);
    soup.corner_normals = None;
    soup.positions.push(DVec3::ONE * 2.0);
    soup.vertex_normals.push(DVec3::X);
    assert_eq!(written(&soup, Format::Obj, Encoding::Ascii).1, [Lost::VertexNormals]);
}
