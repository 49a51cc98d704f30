//! From bytes through a reader, and what it read through every writer and back: the body of tests and fuzz targets.

#![allow(dead_code, reason = "each target takes one")]

use meshwright::cleanup::{Weld, index};
use meshwright::glam::DVec3;
use meshwright::io::{self, Encoding, Format, Limits, Lost};
use meshwright::{CornerData, IndexedMesh, PolygonSoup};

/// Small enough that a fuzzer finds whatever breaks them.
const LIMITS: Limits = Limits { bytes: 1 << 20, vertices: 4096, faces: 4096, corners: 16384 };

pub(crate) fn obj(bytes: &[u8]) {
    drive(bytes, Format::Obj);
}

pub(crate) fn stl(bytes: &[u8]) {
    drive(bytes, Format::Stl);
}

pub(crate) fn ply(bytes: &[u8]) {
    drive(bytes, Format::Ply);
}

pub(crate) fn off(bytes: &[u8]) {
    drive(bytes, Format::Off);
}

fn drive(bytes: &[u8], format: Format) {
    let _ = Format::detect(bytes);
    let Ok(loaded) = io::read(bytes, format, &LIMITS) else { return };
    let soup = loaded.soup;
    let corners = soup.polygons.corners().len();
    assert!(soup.positions.len() as u64 <= LIMITS.vertices && soup.polygons.len() as u64 <= LIMITS.faces);
    assert!(soup.vertex_normals.is_empty() || soup.vertex_normals.len() == soup.positions.len());
    assert!(soup.vertex_colors.is_empty() || soup.vertex_colors.len() == soup.positions.len());
    assert!(soup.corner_uvs.as_ref().is_none_or(|d| d.indices.len() == corners));
    assert!(soup.corner_normals.as_ref().is_none_or(|d| d.indices.len() == corners));
    assert!(soup.groups.iter().all(|g| g.faces.end <= soup.polygons.len()));
    through_the_pool(&soup);
    for format in [Format::Obj, Format::Ply, Format::Off, Format::Stl] {
        for encoding in [Encoding::Binary, Encoding::BigEndian, Encoding::Ascii] {
            round_trip(&soup, format, encoding);
        }
    }
}

/// A valid vertex pool carries all that was read, and gives it back.
fn through_the_pool(soup: &PolygonSoup) {
    let indexed = index(soup, Weld::None).expect("a soup is never refused");
    let Ok(pool) = IndexedMesh::try_from(soup.clone()) else { return };
    assert!(pool == indexed.value, "what needs no repair is carried as it is");
    let back = PolygonSoup::from(pool.clone());
    assert_eq!(values_at_corners(&back.corner_uvs), values_at_corners(&soup.corner_uvs));
    assert_eq!(values_at_corners(&back.corner_normals), values_at_corners(&soup.corner_normals));
    assert_eq!(
        (&back.vertex_normals, &back.vertex_colors, &back.material_files),
        (&soup.vertex_normals, &soup.vertex_colors, &soup.material_files)
    );
    assert_eq!(IndexedMesh::try_from(back), Ok(pool));
}

/// What is written reads back equal, but for what the writer says is lost.
pub(crate) fn round_trip(soup: &PolygonSoup, format: Format, encoding: Encoding) {
    let mut file = Vec::new();
    let Ok(lost) = io::write(soup, format, encoding, &mut file) else { return };
    let mut again = Vec::new();
    io::write(soup, format, encoding, &mut again).expect("what was written once is written again");
    assert_eq!(file, again, "the same soup gives the same bytes");
    let back = match io::read(&file, format, &Limits::default()) {
        Ok(back) => back.soup,
        Err(error) => panic!("{format:?} {encoding:?}: {error}\n{}", String::from_utf8_lossy(&file)),
    };
    if lost.contains(&Lost::SharedVertices) {
        let triangles: usize = soup.polygons.iter().map(|f| f.len() - 2).sum();
        assert_eq!(back.polygons.len(), triangles);
        return;
    }
    let bits =
        |s: &PolygonSoup| s.positions.iter().flat_map(|p| p.to_array()).map(f64::to_bits).collect::<Vec<_>>();
    if !lost.contains(&Lost::IsolatedVertices) {
        assert_eq!(bits(&back), bits(soup), "{format:?} {encoding:?} keeps coordinates exactly");
        assert_eq!(back.polygons, soup.polygons, "{format:?} {encoding:?} keeps faces");
    }
    if !lost.contains(&Lost::Groups) && !soup.groups.is_empty() {
        assert_eq!(back.groups, soup.groups, "{format:?} {encoding:?} keeps groups");
    }
    // As text, so that NaN equals NaN.
    let same = |a: &dyn std::fmt::Debug, b: &dyn std::fmt::Debug| {
        assert_eq!(format!("{a:?}"), format!("{b:?}"), "{format:?} {encoding:?}");
    };
    if !lost.contains(&Lost::TextureCoordinates) {
        same(&values_at_corners(&soup.corner_uvs), &values_at_corners(&back.corner_uvs));
    }
    if !lost.contains(&Lost::Normals) {
        same(&normals_at_corners(soup), &normals_at_corners(&back));
    }
    if !lost.contains(&Lost::MaterialFiles) {
        assert_eq!(back.material_files, soup.material_files, "{format:?} {encoding:?} keeps material files");
    }
    if !lost.contains(&Lost::Colors) && !soup.vertex_colors.is_empty() {
        let opaque = lost.contains(&Lost::Transparency);
        let colors = |s: &PolygonSoup| -> Vec<[f32; 4]> {
            s.vertex_colors.iter().map(|&[r, g, b, a]| [r, g, b, if opaque { 1.0 } else { a }]).collect()
        };
        same(&colors(soup), &colors(&back));
    }
}

/// Empty if no corner has a value.
fn values_at_corners<T: Copy>(data: &Option<CornerData<T>>) -> Vec<Option<T>> {
    let values = data.iter().flat_map(|d| d.indices.iter().map(|&i| d.values.get(i as usize).copied()));
    let values: Vec<Option<T>> = values.collect();
    if values.iter().all(Option::is_none) { Vec::new() } else { values }
}

/// A format may say normals of vertices as those of corners, and the other way round.
fn normals_at_corners(soup: &PolygonSoup) -> Vec<Option<DVec3>> {
    let of_corners = values_at_corners(&soup.corner_normals);
    if of_corners.is_empty() && !soup.vertex_normals.is_empty() {
        return soup.polygons.corners().iter().map(|&v| Some(soup.vertex_normals[v as usize])).collect();
    }
    of_corners
}
