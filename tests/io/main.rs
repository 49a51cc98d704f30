//! Readers and writers: what they keep, what they tolerate, and how they refuse.

#[path = "../drive/io.rs"]
mod drive;
mod obj;
mod off;
mod ply;
mod records;
#[path = "../shapes/mod.rs"]
mod shapes;
mod stl;

use drive::round_trip;
use meshwright::glam::{DVec3, dvec3};
use meshwright::io::{
    self, Encoding, Format, Limits, Loaded, Lost, Malformed, NoteKind, Place, ReadError, WriteError,
    read_obj, read_off, read_ply, read_stl,
};
use meshwright::{CornerData, Group, PolygonSoup, Polygons};
use shapes::Noise;

pub(crate) const ALL: [(Format, Encoding); 6] = [
    (Format::Obj, Encoding::Ascii),
    (Format::Off, Encoding::Ascii),
    (Format::Ply, Encoding::Ascii),
    (Format::Ply, Encoding::Binary),
    (Format::Ply, Encoding::BigEndian),
    (Format::Stl, Encoding::Ascii),
];

pub(crate) fn limits() -> Limits {
    Limits::default()
}

pub(crate) fn written(soup: &PolygonSoup, format: Format, encoding: Encoding) -> (Vec<u8>, Vec<Lost>) {
    let mut file = Vec::new();
    let lost = io::write(soup, format, encoding, &mut file).expect("writable");
    (file, lost)
}

pub(crate) fn read(file: &[u8], format: Format) -> Loaded {
    io::read(file, format, &limits()).unwrap_or_else(|e| panic!("{e}\n{}", String::from_utf8_lossy(file)))
}

/// Two quads and a pentagon with awkward coordinates.
pub(crate) fn awkward() -> PolygonSoup {
    let mut noise = Noise(4);
    let mut points: Vec<DVec3> =
        (0..9).map(|_| dvec3(noise.unit(), noise.unit() * 1e-300, noise.unit() * 1e300)).collect();
    points[3] = dvec3(-0.0, f64::MIN_POSITIVE / 8.0, f64::MAX);
    points[4] = dvec3(0.1 + 0.2, 1e17, 1e-5);
    PolygonSoup::new(points, vec![vec![0, 1, 2, 3], vec![3, 2, 4, 5], vec![5, 4, 6, 7, 8]].into())
}

#[test]
fn coordinates_and_polygons_come_back_exactly_from_obj_ply_and_off() {
    for (format, encoding) in ALL.into_iter().filter(|a| a.0 != Format::Stl) {
        let soup = awkward();
        let (file, lost) = written(&soup, format, encoding);
        assert_eq!(lost, [], "{format:?}");
        let back = read(&file, format).soup;
        let bits =
            |s: &PolygonSoup| s.positions.iter().map(|p| p.to_array().map(f64::to_bits)).collect::<Vec<_>>();
        assert_eq!(bits(&back), bits(&soup), "{format:?} {encoding:?}");
        assert_eq!(back.polygons, soup.polygons);
    }
}

#[test]
fn shapes_survive_every_format() {
    for pool in
        [shapes::cube(), shapes::torus(7, 5), shapes::grid(6), shapes::icosphere(2), shapes::moebius(8)]
    {
        for (format, encoding) in ALL.into_iter().chain([(Format::Stl, Encoding::Binary)]) {
            round_trip(&shapes::soup(&pool), format, encoding);
        }
    }
}

#[test]
fn every_format_is_known_by_its_content() {
    let soup = shapes::soup(&shapes::cube());
    for (format, encoding) in ALL.into_iter().chain([(Format::Stl, Encoding::Binary)]) {
        assert_eq!(Format::detect(&written(&soup, format, encoding).0), Some(format), "{encoding:?}");
    }
    assert_eq!(Format::detect(b"hello"), None);
    assert_eq!(Format::detect(b""), None);
    assert_eq!(Format::from_path("a/b.StL".as_ref()), Some(Format::Stl));
    assert_eq!(Format::from_path("obj".as_ref()), None);
}

#[test]
fn vertex_data_survive_where_the_format_has_room_for_them() {
    let mut soup = shapes::soup(&shapes::cube());
    soup.vertex_normals = soup.positions.iter().map(|p| (*p - 0.5).normalize()).collect();
    soup.vertex_colors = (0..8).map(|i| [i as f32 / 255.0, 0.2, 1.0, 1.0]).collect();
    for (format, encoding) in ALL {
        let (file, lost) = written(&soup, format, encoding);
        let back = read(&file, format).soup;
        match format {
            Format::Stl => assert!(lost.contains(&Lost::Normals) && lost.contains(&Lost::Colors)),
            Format::Obj => {
                assert_eq!(back.vertex_colors, soup.vertex_colors);
                let normals = back.corner_normals.expect("normals");
                assert_eq!(
                    (normals.values, normals.indices),
                    (soup.vertex_normals.clone(), soup.polygons.corners().to_vec())
                );
            }
            _ => {
                assert_eq!(back.vertex_normals, soup.vertex_normals, "{format:?} {encoding:?}");
                assert_eq!(back.vertex_colors, soup.vertex_colors, "{format:?} {encoding:?}");
            }
        }
    }
    // Colours that are no bytes stay what they are.
    soup.vertex_colors[0] = [0.123, 0.2, 0.3, 0.5];
    assert_eq!(
        read(&written(&soup, Format::Ply, Encoding::Binary).0, Format::Ply).soup.vertex_colors,
        soup.vertex_colors
    );
}

#[test]
fn seams_groups_and_materials_come_back_from_obj() {
    let mut soup = shapes::soup(&shapes::cube());
    let corners = soup.polygons.corners().len();
    let mut indices: Vec<u32> = (0..corners as u32).map(|c| c % 5).collect();
    indices[7] = CornerData::<f64>::NONE;
    soup.corner_uvs =
        Some(CornerData { values: (0..5).map(|i| [f64::from(i) * 0.1, 1.0]).collect(), indices });
    soup.corner_normals = Some(CornerData {
        values: vec![DVec3::Z, DVec3::X],
        indices: (0..corners as u32).map(|c| c / 12).collect(),
    });
    soup.groups = vec![
        Group { name: "top".into(), material: None, faces: 0..2 },
        Group { name: "the rest".into(), material: Some("blue steel".into()), faces: 2..6 },
    ];
    let (file, lost) = written(&soup, Format::Obj, Encoding::Ascii);
    assert_eq!(lost, []);
    assert_eq!(read(&file, Format::Obj).soup, soup);
    let (_, lost) = written(&soup, Format::Off, Encoding::Ascii);
    assert_eq!(lost, [Lost::Normals, Lost::TextureCoordinates, Lost::Groups]);
}

#[test]
fn what_could_not_be_read_back_is_not_written() {
    let triangle = |face: Vec<u32>, x: f64| {
        PolygonSoup::new(vec![dvec3(x, 0., 0.), DVec3::X, DVec3::Y], vec![face].into())
    };
    for (format, encoding) in ALL {
        let refused =
            |soup: &PolygonSoup| io::write(soup, format, encoding, &mut Vec::new()).expect_err("refused");
        assert!(matches!(
            refused(&triangle(vec![0, 1, 3], 0.0)),
            WriteError::IndexOutOfRange { face: 0, corner: 2 }
        ));
        assert!(matches!(refused(&triangle(vec![0, 1], 0.0)), WriteError::ShortFace { face: 0 }));
        assert!(matches!(refused(&triangle(vec![0, 1, 2], f64::NAN)), WriteError::NonFinite { vertex: 0 }));
    }
    let far = triangle(vec![0, 1, 2], 1e300);
    assert!(
        matches!(io::write_stl(&far, &mut Vec::new()), Err(WriteError::BeyondSingle { vertex: 0 })),
        "beyond f32"
    );
    struct Full;
    impl std::io::Write for Full {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            Err(std::io::ErrorKind::StorageFull.into())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    assert!(matches!(io::write_ply(&triangle(vec![0, 1, 2], 0.0), &mut Full), Err(WriteError::Io(_))));
}

/// The place and reason of a refusal.
pub(crate) fn refusal(result: Result<Loaded, ReadError>) -> (Place, Malformed) {
    match result {
        Err(ReadError::Malformed { place, reason }) => (place, reason),
        other => panic!("not refused as malformed: {other:?}"),
    }
}

pub(crate) fn notes(loaded: &Loaded) -> Vec<(NoteKind, Place)> {
    loaded.notes.iter().map(|n| (n.kind, n.place)).collect()
}

#[test]
fn limits_are_kept_in_every_format() {
    let soup = shapes::soup(&shapes::cube());
    for (format, encoding) in ALL.into_iter().chain([(Format::Stl, Encoding::Binary)]) {
        let (file, _) = written(&soup, format, encoding);
        for limits in [
            Limits { vertices: 7, ..limits() },
            Limits { faces: 5, ..limits() },
            Limits { corners: 23, ..limits() },
        ] {
            let refused = io::read(&file, format, &limits);
            assert!(matches!(refused, Err(ReadError::Limit { .. })), "{format:?} {encoding:?} {limits:?}");
        }
    }
}

#[test]
fn a_missing_file_and_an_unknown_format_are_told_apart() {
    assert!(matches!(io::read_file("no such file.obj", &limits()), Err(ReadError::Io(_))));
    let few = Limits { bytes: 100, ..limits() };
    let sample = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/broken_bracket.obj");
    assert!(matches!(io::read_file(sample, &few), Err(ReadError::Limit { what: "bytes", allowed: 100, .. })));
    if cfg!(unix) {
        assert!(matches!(io::read_file("/dev/zero", &few), Err(ReadError::Limit { what: "bytes", .. })));
    }
    assert!(matches!(
        io::read_file(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml"), &limits()),
        Err(ReadError::UnknownFormat)
    ));
}

#[test]
fn the_fuzz_corpora_pass() {
    let root = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/fuzz/corpus"));
    type Target = (&'static str, fn(&[u8]));
    let targets: [Target; 4] =
        [("obj", drive::obj), ("off", drive::off), ("ply", drive::ply), ("stl", drive::stl)];
    for (target, run) in targets {
        let mut count = 0;
        for entry in std::fs::read_dir(root.join(target)).expect("a corpus") {
            run(&std::fs::read(entry.expect("an entry").path()).expect("a file"));
            count += 1;
        }
        assert!(count > 1, "{target}");
    }
}

#[test]
fn mutated_files_never_panic() {
    let mut noise = Noise(1);
    let mut soup = shapes::soup(&shapes::cube());
    soup.vertex_colors = vec![[0.5; 4]; 8];
    let values = (0..24).map(|c| [f64::from(c) / 8.0, 0.0]).collect();
    soup.corner_uvs = Some(CornerData { values, indices: (0..24).collect() });
    soup.corner_normals = Some(CornerData { values: vec![DVec3::Z], indices: vec![0; 24] });
    soup.groups = vec![Group { name: "a".into(), material: Some("b".into()), faces: 1..5 }];
    soup.material_files = vec!["c.mtl".into()];
    let targets = [drive::obj as fn(&[u8]), drive::off, drive::ply, drive::stl];
    for (format, encoding) in ALL.into_iter().chain([(Format::Stl, Encoding::Binary)]) {
        let (file, _) = written(&soup, format, encoding);
        for _ in 0..1500 {
            let mut damaged = file.clone();
            for _ in 0..=noise.below(4) {
                let at = noise.below(damaged.len() as u32) as usize;
                match noise.below(4) {
                    0 => damaged[at] = noise.bits() as u8,
                    1 => damaged[at] ^= 1 << noise.below(8),
                    2 => damaged.truncate(at.max(1)),
                    _ => damaged.insert(at, b"0123456789 -.\n/e#"[noise.below(17) as usize]),
                }
            }
            targets[noise.below(4) as usize](&damaged);
            let own = [drive::obj as fn(&[u8]), drive::stl, drive::ply, drive::off];
            own[format as usize](&damaged);
        }
    }
}

/// The pool of a soup of no faces.
#[test]
fn point_clouds_are_read_and_written() {
    let cloud = PolygonSoup::new(vec![DVec3::ONE, DVec3::X], Polygons::new());
    for (format, encoding) in ALL.into_iter().filter(|a| a.0 != Format::Stl) {
        assert_eq!(read(&written(&cloud, format, encoding).0, format).soup, cloud);
    }
    assert!(read(&written(&cloud, Format::Stl, Encoding::Binary).0, Format::Stl).soup.positions.is_empty());
}

#[test]
fn extensions_are_known_in_any_case() {
    assert_eq!(Format::from_extension("PLY"), Some(Format::Ply));
    assert_eq!(Format::from_extension(".ply"), None);
}

/// Found by mutating files: the sign of a zero was lost when colours were written as bytes.
#[test]
fn a_negative_zero_in_a_colour_keeps_its_sign() {
    let loaded = read(b"v 0 0 0 -0.0 1 0\n", Format::Obj);
    round_trip(&loaded.soup, Format::Ply, Encoding::Binary);
}
