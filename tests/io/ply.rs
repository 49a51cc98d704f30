//! PLY: what it takes, and how it refuses.

use super::*;

#[test]
fn texture_coordinates_of_vertices_come_back_from_ply() {
    let mut soup = shapes::soup(&shapes::cube());
    let values = soup.positions.iter().map(|p| [p.x, p.y]).collect();
    soup.corner_uvs = Some(CornerData { values, indices: soup.polygons.corners().to_vec() });
    for encoding in [Encoding::Ascii, Encoding::Binary, Encoding::BigEndian] {
        assert_eq!(read(&written(&soup, Format::Ply, encoding).0, Format::Ply).soup, soup);
    }
}

const HEADER: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
                      property list uchar int vertex_indices\nend_header\n";

#[test]
fn ply_takes_what_occurs_in_files() {
    let plain = format!("{HEADER}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    let spaced = plain.replace("element", "  element\t").replace("end_header", " end_header ");
    let remarks = plain
        .replace("1 0 0\n", "comment here\n\n1 0 0 { too }\n")
        .replace("format", "comment c\nobj_info i\nformat");
    for text in [plain.clone(), spaced, remarks, plain.replace('\n', "\r\n"), plain.replace('\n', "\r")] {
        let soup = read(text.as_bytes(), Format::Ply).soup;
        assert_eq!(soup.positions, [DVec3::ZERO, DVec3::X, DVec3::Y], "{text:?}");
        assert_eq!(soup.polygons, vec![vec![0, 1, 2]].into());
    }
    for kind in [
        "char", "uchar", "short", "ushort", "int", "uint", "int8", "uint8", "int16", "uint16", "int32",
        "uint32",
    ] {
        let text = plain.replace("uchar int", &format!("{kind} {kind}"));
        assert_eq!(read(text.as_bytes(), Format::Ply).soup.polygons, vec![vec![0, 1, 2]].into(), "{kind}");
    }
    for bad in ["3 0 1.5 2", "3 0 nan 2", "2.5 0 1 2"] {
        let text = plain.replace("3 0 1 2", bad);
        assert_eq!(refusal(read_ply(text.as_bytes(), &limits())).0, Place::Line(13), "{bad}");
    }
    let negative = read(plain.replace("3 0 1 2", "3 0 -1 9").as_bytes(), Format::Ply);
    assert_eq!(negative.soup.polygons, vec![vec![0, PolygonSoup::NO_VERTEX, 9]].into());
    assert_eq!(notes(&negative), [(NoteKind::IndexOutOfRange, Place::Line(13))]);
    let extra = read(format!("{plain}9 9 9\n").as_bytes(), Format::Ply);
    assert_eq!(notes(&extra), [(NoteKind::TrailingData, Place::Line(14))]);
}

#[test]
fn binary_ply_data_may_begin_with_a_newline() {
    for end in ["\n", "\r\n", "\r"] {
        let header = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar x\nproperty uchar y\nproperty uchar z\nend_header\n";
        let mut file = header.replace('\n', end).into_bytes();
        file.extend([10, 13, 10]);
        assert_eq!(read(&file, Format::Ply).soup.positions, [dvec3(10., 13., 10.)], "{end:?}");
    }
}

#[test]
fn ply_refuses_with_line_or_byte() {
    let refused = |text: &str| refusal(read_ply(text.as_bytes(), &limits()));
    let body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    assert_eq!(
        refused(&format!("{HEADER}0 0 0\n1 0 0\n0 1 0\n")),
        (Place::Line(12), Malformed::Truncated("the elements"))
    );
    assert_eq!(refused(&format!("{HEADER}{}", body.replace("3 0 1 2", "4 0 1 2"))).0, Place::Line(13));
    assert_eq!(
        refused(&format!("{HEADER}{}", body.replace("1 0 0", "1 a 0"))),
        (Place::Line(11), Malformed::Number("a".into()))
    );
    assert_eq!(refused(&HEADER.replace("format ascii 1.0\n", "")).1, Malformed::Header("has no format"));
    assert_eq!(
        refused(&HEADER.replace("float x", "float w")).1,
        Malformed::Header("gives vertices no x, y and z")
    );
    assert_eq!(
        refused(&HEADER.replace("vertex_indices", "stuff")).1,
        Malformed::Header("gives faces no list of vertex indices")
    );
    assert_eq!(
        refused("ply\nformat ascii 1.0\nelement face 0\nend_header\n").1,
        Malformed::Header("has no vertices")
    );
    assert_eq!(refused("ply\nformat ascii 1.0\n"), (Place::Line(3), Malformed::Truncated("the header")));
    assert_eq!(refused("plz\n"), (Place::Line(1), Malformed::Beginning("a PLY file")));
    assert_eq!(refused("ply\nformat middle_endian 1.0\n").0, Place::Line(2));
    assert_eq!(
        refused("ply\nproperty int x\n"),
        (Place::Line(2), Malformed::Header("has a property before any element"))
    );
    // A short header that promises gigabytes.
    let bomb = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nend_header\n";
    assert_eq!(refused(bomb).0, Place::Line(4));
    let (mut file, _) = written(&shapes::soup(&shapes::cube()), Format::Ply, Encoding::Binary);
    file.pop();
    let Place::Byte(byte) = refusal(read_ply(&file, &limits())).0 else { panic!("a byte") };
    assert_eq!(byte as usize, file.len() + 1 - 17, "the last face");
}

#[test]
fn a_second_vertex_element_of_a_ply_is_left_out() {
    let text = format!("{HEADER}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n7 7 7\n").replace(
        "end_header",
        "element vertex 1\nproperty int x\nproperty int y\nproperty int z\nend_header",
    );
    let none_first = text.replacen("vertex 3", "vertex 0", 1).replace("0 0 0\n1 0 0\n0 1 0\n", "");
    for (text, count) in [(text, 3), (none_first, 0)] {
        let loaded = read(text.as_bytes(), Format::Ply);
        assert_eq!((loaded.soup.positions.len(), loaded.soup.polygons.len()), (count, 1));
        assert!(loaded.notes.iter().any(|n| n.kind == NoteKind::Ignored));
    }
}

#[test]
fn binary_ply_is_read_with_every_type_and_lists_among_the_vertices() {
    let mut file = b"ply\nformat binary_big_endian 1.0\nelement face 1\nproperty uchar flag\nproperty list short short \
        vertex_index\nelement extra 2\nproperty int a\nelement vertex 3\nproperty list uchar uchar tags\nproperty short x\n\
        property uchar y\nproperty double z\nproperty ushort red\nproperty ushort green\nproperty ushort blue\nend_header\n"
        .to_vec();
    file.extend([9, 0, 3, 0, 2, 0, 1, 255, 255, 0, 0, 0, 1, 0, 0, 0, 2]);
    for i in 0..3u8 {
        file.extend([1, 77, 255, i]);
        file.push(200);
        file.extend((f64::from(i) * 0.1).to_be_bytes());
        file.extend([255, 255, 0, 0, 128, 0]);
    }
    let soup = read(&file, Format::Ply).soup;
    assert_eq!(soup.polygons, vec![vec![2, 1, PolygonSoup::NO_VERTEX]].into());
    assert_eq!(soup.positions[2], dvec3(-254.0, 200.0, 0.2));
    assert_eq!(soup.vertex_colors[0], [1.0, 0.0, 32768.0 / 65535.0, 1.0]);
}

#[test]
fn ply_faces_may_have_texture_coordinates_colours_and_more() {
    let header = HEADER.replace(
        "end_header",
        "property list uchar float texcoord\nproperty int texnumber\nproperty uchar red\nproperty uchar green\n\
         property uchar blue\nend_header",
    );
    let header = header.replace("face 1", "face 4");
    let vertices = "0 0 0\n1 0 0\n0 1 0\n";
    let faces = "3 0 1 2 0 0 9 9 9\n3 2 1 0 6 0 0.25 1 0.5 0 1 0 9 9 9\n3 0 1 2 4 0 0 0 0 0 9 9 9\n3 1 2 0 0 0 9 9 9\n";
    let loaded = read(format!("{header}{vertices}{faces}").as_bytes(), Format::Ply);
    let none = CornerData::<f64>::NONE;
    let expected = CornerData {
        values: vec![[0.0, 0.25], [1.0, 0.5], [0.0, 1.0]],
        indices: [vec![none; 3], vec![0, 1, 2], vec![none; 6]].concat(),
    };
    assert_eq!(loaded.soup.corner_uvs, Some(expected));
    let end = Place::Line(14);
    assert_eq!(
        notes(&loaded),
        [
            (NoteKind::Ignored, end),
            (NoteKind::FaceColor, end),
            (NoteKind::TextureCoordinateCount, Place::Line(20))
        ]
    );
}

#[test]
fn texture_coordinates_of_faces_go_before_those_of_vertices_in_ply() {
    let header = HEADER
        .replace("float z\n", "float z\nproperty float s\nproperty float t\n")
        .replace("end_header", "property list uchar double texcoord\nend_header");
    let body = "0 0 0 9 9\n1 0 0 9 9\n0 1 0 9 9\n3 0 1 2 6 0 0.1 1 0.5 0 1\n";
    let loaded = read(format!("{header}{body}").as_bytes(), Format::Ply);
    assert_eq!(loaded.soup.corner_uvs.as_ref().expect("given").values, [[0.0, 0.1], [1.0, 0.5], [0.0, 1.0]]);
    assert_eq!(notes(&loaded), [(NoteKind::Ignored, Place::Line(12))]);
}

#[test]
fn large_polygons_keep_their_texture_coordinates_in_ply() {
    // 130 corners have 260 numbers: more than a byte counts.
    let points: Vec<DVec3> = (0..130).map(|i| dvec3(f64::from(i), f64::from(i * i), 0.0)).collect();
    let faces = vec![(0..130).collect(), vec![0, 1, 2]];
    let mut soup = PolygonSoup::new(points, faces.into());
    let single = |x: f64| f64::from(x as f32);
    for (round, header) in [((|x| x) as fn(f64) -> f64, "double texcoord"), (single, "float texcoord")] {
        let values = (0..133).map(|c| [round(f64::from(c) / 7.0), -0.0]).collect();
        soup.corner_uvs = Some(CornerData { values, indices: (0..133).collect() });
        for encoding in [Encoding::Ascii, Encoding::Binary, Encoding::BigEndian] {
            let (file, lost) = written(&soup, Format::Ply, encoding);
            assert!(String::from_utf8_lossy(&file).contains(header) && lost.is_empty());
            let back = read(&file, Format::Ply).soup;
            assert_eq!(format!("{back:?}"), format!("{soup:?}"), "the sign of zero included");
        }
    }
}
