//! OFF: what it takes, and how it refuses.

use super::*;

#[test]
fn off_takes_all_its_headers() {
    let triangle = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    for header in [
        "OFF\n3 1 0\n",
        "OFF 3 1 0\n",
        "OFF3 1 3\n",
        "  OFF\n# remark\n\n3 1\n",
        "3 1 0\n",
        "\u{feff}OFF\r3 1 0\r",
    ] {
        let loaded = read(format!("{header}{body}").as_bytes(), Format::Off);
        assert_eq!(
            (loaded.soup.positions, loaded.soup.polygons),
            (triangle.clone(), vec![vec![0, 1, 2]].into()),
            "{header:?}"
        );
    }
    let colored = read(b"CNOFF 1 0 0\n1 2 3 0 0 1 255 0 51 255\n", Format::Off).soup;
    assert_eq!((colored.vertex_normals, colored.vertex_colors), (vec![DVec3::Z], vec![[1.0, 0.0, 0.2, 1.0]]));
    let extra = read(b"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\nmore\n", Format::Off);
    assert_eq!(
        notes(&extra),
        [(NoteKind::FaceColor, Place::Line(5)), (NoteKind::TrailingData, Place::Line(6))]
    );
}

#[test]
fn off_refuses_with_the_line() {
    let refused = |text: &[u8]| refusal(read_off(text, &limits()));
    assert_eq!(
        refused(b"OFF 4 0 0\n0 0 0\n"),
        (Place::Line(1), Malformed::Promise { what: "vertices", wanted: 4, room: 2 })
    );
    assert_eq!(refused(b"OFF 2 0 0\n0.0 0.0 0.0\n"), (Place::Line(2), Malformed::Truncated("a vertex")));
    assert_eq!(refused(b"OFF 1 1 0\n0 0 0\n3 0 0 x\n"), (Place::Line(3), Malformed::Number("x".into())));
    assert_eq!(refused(b"PLY\n"), (Place::Line(1), Malformed::Beginning("an OFF file")));
    assert_eq!(refused(b"OFF x 1 0\n"), (Place::Line(1), Malformed::Expected("the number of vertices")));
    assert_eq!(refused(b""), (Place::Line(1), Malformed::Empty));
}

fn binary_off(read: fn(u32) -> [u8; 4], colors: bool) -> Vec<u8> {
    let mut file = b"OFF BINARY\n".to_vec();
    let one = 1f32.to_bits();
    let mut words = vec![3, 1, 0, 0, 0, 0, one, 0, 0, 0, one, 0, 3, 0, 1, 2];
    if colors {
        words.push(0);
    }
    file.extend(words.into_iter().flat_map(read));
    file
}

#[test]
fn off_binary_is_read_in_both_byte_orders_with_and_without_colours() {
    for colors in [false, true] {
        for order in [u32::to_le_bytes, u32::to_be_bytes] {
            let loaded = read(&binary_off(order, colors), Format::Off);
            assert_eq!(loaded.soup.positions, [DVec3::ZERO, DVec3::X, DVec3::Y]);
            assert_eq!(loaded.soup.polygons, vec![vec![0, 1, 2]].into());
        }
    }
    let cut = &binary_off(u32::to_le_bytes, false)[..70];
    assert_eq!(refusal(read_off(cut, &limits())).0, Place::Byte(59));
}

#[test]
fn off_texture_coordinates_are_those_of_the_vertices() {
    let text = b"STCNOFF 3 1 0\n0 0 0 0 0 1 255 0 0 0 0.5\n1 0 0 0 0 1 0 255 0 1 0\n0 1 0 0 0 1 0 0 255 0 1\n3 2 0 1\n";
    let soup = read(text, Format::Off).soup;
    assert_eq!(soup.vertex_colors[1], [0.0, 1.0, 0.0, 1.0]);
    let uvs = soup.corner_uvs.expect("texture coordinates");
    assert_eq!((uvs.values[0], uvs.indices), ([0.0, 0.5], vec![2, 0, 1]));
}

#[test]
fn an_off_face_that_runs_into_the_next_line_is_not_taken_for_two() {
    let points = "OFF 4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    let refused = refusal(read_off(format!("{points}4 0 1 2\n3 0 1 2\n3 0 2 3\n").as_bytes(), &limits()));
    assert_eq!(refused, (Place::Line(6), Malformed::Expected("as many indices as the face has corners")));
    let wrapped = read(format!("{points}4 0 1\n2 3\n3\n0 1 2\n").as_bytes(), Format::Off);
    assert_eq!(wrapped.soup.polygons, vec![vec![0, 1, 2, 3], vec![0, 1, 2]].into());
}

#[test]
fn off_of_other_dimensions_and_binary_off_with_colours_are_not_supported() {
    for text in ["4OFF 0 0 0\n", "nOFF\n3\n0 0 0\n", "COFF BINARY\n"] {
        let refused = read_off(text.as_bytes(), &limits());
        assert!(matches!(refused, Err(ReadError::Unsupported { place: Place::Line(1), .. })), "{text}");
    }
}
