//! Files that take the readers' short ways, beside the same read the long way, or decoded here.

use super::*;
use proptest::prelude::*;

/// What a reader said: all of it, or why not.
fn said(text: &[u8], format: Format) -> Result<Loaded, String> {
    io::read(text, format, &limits()).map_err(|e| e.to_string())
}

/// With a remark behind every line but those that go on: no line is plain any more.
fn remarked(text: &[u8]) -> Vec<u8> {
    let lines = text.split_inclusive(|&b| b == b'\n').flat_map(|line| match line.strip_suffix(b"\n") {
        Some(begun) if begun.ends_with(b"\\") => line.to_vec(),
        Some(line) => [line.strip_suffix(b"\r").unwrap_or(line), b" # so\n"].concat(),
        None => [line, b" # so"].concat(),
    });
    lines.collect()
}

/// Compared as text: a NaN equals nothing.
fn assert_alike(text: &[u8]) {
    let (short, long) = (said(text, Format::Obj), said(&remarked(text), Format::Obj));
    assert_eq!(format!("{short:?}"), format!("{long:?}"), "{}", String::from_utf8_lossy(text));
}

fn obj_line() -> impl Strategy<Value = String> {
    let number = prop_oneof![
        5 => (-9i32..9).prop_map(|n| n.to_string()),
        3 => any::<f64>().prop_map(|x| x.to_string()),
        3 => Just("1.5e-3".to_owned()),
        1 => prop::sample::select(vec!["nan", "1e400", "-1.#IND", "+.5", "5.", "1e", "--1", "x", "1_0"])
            .prop_map(str::to_owned),
    ];
    let index = prop_oneof![6 => 1..9i64, 2 => -4..1i64, 1 => Just(i64::MAX)];
    let part = prop_oneof![2 => Just(String::new()), 3 => index.clone().prop_map(|i| i.to_string())];
    let corner = (index, part.clone(), part, 0..5).prop_map(|(v, t, n, kind)| match kind {
        0 => format!("{v}/{t}"),
        1 => format!("{v}/{t}/{n}"),
        2 => format!("{v}//"),
        _ => v.to_string(),
    });
    let blank = prop::sample::select(vec![" ", " ", " ", "  ", "\t"]);
    let statement = |keyword: &'static str, words: BoxedStrategy<Vec<String>>| {
        (words, blank.clone(), prop::sample::select(vec!["", "", " ", "\t ", "\r"])).prop_map(
            move |(words, blank, end)| {
                let words = [vec![keyword.to_owned()], words].concat();
                format!("{}{end}\n", words.join(blank))
            },
        )
    };
    prop_oneof![
        20 => statement("v", prop::collection::vec((-9i32..9).prop_map(|n| n.to_string()), 3).boxed()),
        6 => statement("v", prop::collection::vec(number.clone(), 2..8).boxed()),
        2 => statement("vt", prop::collection::vec(number.clone(), 1..3).boxed()),
        2 => statement("vn", prop::collection::vec(number, 3).boxed()),
        20 => statement("f", prop::collection::vec(corner, 0..7).boxed()),
        1 => Just("g a\n".to_owned()),
        1 => Just("f 1 2 \\\n3\n".to_owned()),
    ]
}

proptest! {
    #[test]
    fn plain_obj_statements_say_what_they_say_with_a_remark_behind_them(lines in prop::collection::vec(obj_line(), 0..30)) {
        assert_alike(lines.concat().as_bytes());
    }
}

#[test]
fn more_vertices_than_tobj_is_given_at_once_keep_their_order() {
    for count in [1, 2, 3, 4095, 4096, 4097, 4098, 8192, 10_000] {
        let mut noise = Noise(count);
        let point = |_| dvec3(noise.unit(), -noise.unit() * 1e-9, noise.unit() * 1e9);
        let points: Vec<DVec3> = (0..count).map(point).collect();
        let faces: Vec<Vec<u32>> = (0..count as u32 / 3).map(|i| vec![3 * i + 2, 3 * i, 3 * i + 1]).collect();
        let soup = PolygonSoup::new(points, faces.into());
        assert_eq!(read(&written(&soup, Format::Obj, Encoding::Ascii).0, Format::Obj).soup, soup, "{count}");
    }
}

#[test]
fn a_bad_coordinate_names_its_line_however_far_in() {
    for bad in [1, 4095, 4096, 4097, 5000] {
        let line = |i: u64| if i == bad { "v 0 1-2 0\n" } else { "v 0 1 0\n" };
        let text: String = (1..=5000).map(line).collect();
        let error = read_obj(text.as_bytes(), &limits()).expect_err("a coordinate is no number");
        assert_eq!(error.place(), Some(Place::Line(bad)));
    }
}

type Type = (&'static str, fn(u8) -> Vec<u8>);

/// The types of PLY, by name, with a number of each as bytes.
const TYPES: [Type; 8] = [
    ("char", |n| vec![n]),
    ("uchar", |n| vec![n]),
    ("short", |n| i16::from(n).to_le_bytes().to_vec()),
    ("ushort", |n| u16::from(n).to_le_bytes().to_vec()),
    ("int", |n| i32::from(n).to_le_bytes().to_vec()),
    ("uint", |n| u32::from(n).to_le_bytes().to_vec()),
    ("float", |n| f32::from(n).to_le_bytes().to_vec()),
    ("double", |n| f64::from(n).to_le_bytes().to_vec()),
];

proptest! {
    #[test]
    fn binary_ply_says_what_the_same_numbers_say_as_text(
        properties in Just(vec!["x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "alpha", "s", "t", "w"])
            .prop_shuffle(),
        kept in 0..1usize << 13,
        types in prop::collection::vec(0..8usize, 13),
        list in (0..6usize, 0..6usize),
        vertices in prop::collection::vec(prop::array::uniform13(0..100u8), 0..9),
        faces in prop::collection::vec(prop::collection::vec(0..9u8, 0..5).prop_map(|mut f| {
            // Triangles in runs, and others between.
            if f.len() == 4 && f[0] < 6 { f.pop(); }
            f
        }), 0..12),
        is_big in any::<bool>(),
    ) {
        let is_kept = |i: &usize| kept >> i & 1 == 1 || ["x", "y", "z"].contains(&properties[*i]);
        let columns: Vec<usize> = (0..13).filter(is_kept).collect();
        let mut text = String::new();
        let mut bytes = Vec::new();
        let mut put = |kind: usize, n: u8, end: &str, text: &mut String| {
            let mut number = TYPES[kind].1(n);
            if is_big {
                number.reverse();
            }
            bytes.extend(number);
            text.push_str(&format!("{n}{end}"));
        };
        for vertex in &vertices {
            columns.iter().for_each(|&i| put(types[i], vertex[i], " ", &mut text));
            text.push('\n');
        }
        for face in &faces {
            put(list.0, face.len() as u8, " ", &mut text);
            face.iter().for_each(|&v| put(list.1, v, " ", &mut text));
            text.push('\n');
        }
        let header = |format: &str| {
            let mut header = format!("ply\nformat {format} 1.0\nelement vertex {}\n", vertices.len());
            for &i in &columns {
                header += &format!("property {} {}\n", TYPES[types[i]].0, properties[i]);
            }
            let (count, index) = (TYPES[list.0].0, TYPES[list.1].0);
            header + &format!("element face {}\nproperty list {count} {index} vertex_indices\nend_header\n", faces.len())
        };
        let format = if is_big { "binary_big_endian" } else { "binary_little_endian" };
        let binary = [header(format).into_bytes(), bytes].concat();
        let (binary, text) = (read(&binary, Format::Ply), read((header("ascii") + &text).as_bytes(), Format::Ply));
        prop_assert_eq!(&binary.soup, &text.soup);
        let notes = |loaded: &Loaded| {
            let mut notes: Vec<_> = loaded.notes.iter().map(|n| (n.kind, n.count)).collect();
            notes.sort_unstable();
            notes
        };
        prop_assert_eq!(notes(&binary), notes(&text));
    }
}

#[test]
fn limits_and_truncation_are_told_within_a_run_of_triangles() {
    let soup = shapes::soup(&shapes::fanned(&shapes::torus(50, 40)));
    let (file, _) = written(&soup, Format::Ply, Encoding::Binary);
    let faces = soup.polygons.len() as u64;
    for limits in [Limits { corners: 3 * faces - 1, ..limits() }, Limits { corners: 7, ..limits() }] {
        let refused = read_ply(&file, &limits);
        let Err(ReadError::Limit { what: "corners", wanted, allowed }) = refused else {
            panic!("{refused:?}");
        };
        assert_eq!((wanted, allowed), ((limits.corners / 3 + 1) * 3, limits.corners));
    }
    assert!(read_ply(&file, &Limits { corners: 3 * faces, faces, ..limits() }).is_ok());
    let cut = read_ply(&file[..file.len() - 1], &limits()).expect_err("a byte is missing");
    assert_eq!(cut.place(), Some(Place::Byte(file.len() as u64 - 13)));
    // An index beyond the vertices in the second last face.
    let mut odd = file.clone();
    let byte = file.len() - 26;
    odd[byte + 4] = 255;
    let loaded = read(&odd, Format::Ply);
    let place = Place::Byte(byte as u64);
    assert_eq!(loaded.notes, [io::Note { kind: NoteKind::IndexOutOfRange, place, count: 1 }]);
}

#[test]
fn coordinates_that_are_not_finite_are_noted_where_they_stand() {
    let soup = shapes::soup(&shapes::fanned(&shapes::torus(50, 40)));
    let (mut ply, _) = written(&soup, Format::Ply, Encoding::Binary);
    let (mut stl, _) = written(&soup, Format::Stl, Encoding::Binary);
    let data = ply.windows(11).position(|w| w == b"end_header\n").expect("a header ends") + 11;
    for i in [1500, 1700] {
        ply[data + 24 * i + 16..][..8].copy_from_slice(&f64::NAN.to_le_bytes());
        stl[84 + 50 * i + 44..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    }
    let kind = NoteKind::NonFiniteCoordinate;
    let note = |byte: usize| [io::Note { kind, place: Place::Byte(byte as u64), count: 2 }];
    assert_eq!(read(&ply, Format::Ply).notes, note(data + 24 * 1500));
    assert_eq!(read(&stl, Format::Stl).notes, note(84 + 50 * 1500));
}
