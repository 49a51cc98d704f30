//! Attributes from file to file: seams, hard edges, colours, groups; and what is said where they cannot go along.

mod corpus;
mod shapes;

use meshwright::cleanup::{CleanOptions, Weld, clean, clean_indexed, index};
use meshwright::glam::{DVec2, DVec3, dvec2, dvec3};
use meshwright::io::{self, Encoding, Format, Limits, Lost};
use meshwright::{
    Attribute, Attributes, CornerData, Element, FaceGroups, Group, GroupName, IndexedDefect, IndexedMesh,
    Kind, LossReason, LostValue, Mesh, Outcome, PolygonSoup, unify_winding,
};
use shapes::{cube, unwelded};

fn cleaned(soup: &PolygonSoup) -> Outcome<IndexedMesh> {
    clean_indexed(soup, CleanOptions::default()).expect("a soup is never refused")
}

fn written(soup: &PolygonSoup, format: Format) -> (Vec<u8>, Vec<Lost>) {
    let mut file = Vec::new();
    let lost = io::write(soup, format, Encoding::Binary, &mut file).expect("writable");
    (file, lost)
}

fn read(file: &[u8], format: Format) -> PolygonSoup {
    io::read(file, format, &Limits::default()).expect("readable").soup
}

fn uvs(pool: &IndexedMesh) -> Vec<Option<DVec2>> {
    pool.attributes().corner_uvs.clone().expect("texture coordinates")
}

fn lost(attribute: Attribute, reason: LossReason, element: Element) -> LostValue {
    LostValue { attribute, reason, element }
}

/// OBJ text of the unit cube: 8 vertices; 24 texture coordinates, a sixth of the texture for each face; 6 normals.
fn textured_cube() -> String {
    let cube = cube();
    let mut text = "mtllib crate.mtl\n".to_owned();
    for p in cube.positions() {
        text += &format!("v {} {} {}\n", p.x, p.y, p.z);
    }
    for face in 0..6 {
        for [u, v] in [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] {
            text += &format!("vt {} {v}\n", (f64::from(face) + u) / 6.0);
        }
    }
    text += "vn 0 0 -1\nvn 0 0 1\nvn 0 -1 0\nvn 0 1 0\nvn -1 0 0\nvn 1 0 0\n";
    for (f, face) in cube.polygons().iter().enumerate() {
        match f {
            0 => text += "g floor\nusemtl wood\n",
            2 => text += "g sides\nusemtl steel sheet\n",
            _ => {}
        }
        text += "f";
        for (i, v) in face.iter().enumerate() {
            text += &format!(" {}/{}/{}", v + 1, 4 * f + i + 1, f + 1);
        }
        text += "\n";
    }
    text
}

#[test]
fn a_textured_cube_stays_welded_and_comes_back_from_obj_as_it_was() {
    let soup = read(textured_cube().as_bytes(), Format::Obj);
    let outcome = cleaned(&soup);
    let pool = &outcome.value;
    assert_eq!((pool.vertex_count(), pool.face_count()), (8, 6));
    assert!(outcome.report.is_empty() && outcome.report.not_carried.is_empty());
    let at_vertex_0: Vec<f64> = (0..24)
        .filter(|&c| pool.polygons().corners()[c] == 0)
        .map(|c| uvs(pool)[c].expect("a value").x)
        .collect();
    assert_eq!(at_vertex_0, [0.0, 2.0 / 6.0, 4.0 / 6.0], "three places in the texture at one vertex");
    let back = PolygonSoup::from(pool.clone());
    assert_eq!(back, soup, "24 texture coordinates, 6 normals, 2 groups, 1 material file");
    let (file, lost) = written(&back, Format::Obj);
    assert_eq!((read(&file, Format::Obj), lost), (soup, vec![]));
}

#[test]
fn seams_come_back_exactly_from_ply_and_what_it_cannot_hold_is_said() {
    let soup: PolygonSoup = cleaned(&read(textured_cube().as_bytes(), Format::Obj)).value.into();
    for encoding in [Encoding::Ascii, Encoding::Binary, Encoding::BigEndian] {
        let mut file = Vec::new();
        let lost = io::write(&soup, Format::Ply, encoding, &mut file).expect("writable");
        assert_eq!(lost, [Lost::Normals, Lost::Groups, Lost::MaterialFiles]);
        let back = read(&file, Format::Ply);
        assert_eq!(back.positions.len(), 8);
        assert_eq!(uvs(&cleaned(&back).value), uvs(&cleaned(&soup).value), "{encoding:?}");
    }
    let (_, lost) = written(&soup, Format::Off);
    assert_eq!(lost, [Lost::Normals, Lost::TextureCoordinates, Lost::Groups, Lost::MaterialFiles]);
}

#[test]
fn values_that_agree_at_each_vertex_stand_at_vertices_in_ply_and_off() {
    let mut soup = shapes::soup(&shapes::torus(6, 5));
    let corners = soup.polygons.corners().to_vec();
    let value = |v: &u32| soup.positions[*v as usize];
    // Scattered over the corners, and pooled anew by the way through the pool.
    soup.corner_normals =
        Some(CornerData { values: corners.iter().map(value).collect(), indices: (0..120).collect() });
    soup.corner_uvs = Some(CornerData {
        values: corners.iter().map(|v| value(v).truncate().into()).collect(),
        indices: (0..120).collect(),
    });
    let pooled: PolygonSoup = cleaned(&soup).value.into();
    assert_eq!(pooled.corner_normals.as_ref().map(|d| d.values.len()), Some(30));
    for format in [Format::Ply, Format::Off] {
        for soup in [&soup, &pooled] {
            let (file, lost) = written(soup, format);
            assert_eq!(lost, [], "{format:?}");
            let back = read(&file, format);
            assert_eq!(back.vertex_normals, back.positions, "{format:?}");
            assert_eq!(uvs(&cleaned(&back).value), uvs(&cleaned(soup).value));
        }
    }
}

#[test]
fn faces_without_texture_coordinates_beside_some_with_stay_so_in_ply() {
    let mut soup = read(textured_cube().as_bytes(), Format::Obj);
    let data = soup.corner_uvs.as_mut().expect("given");
    data.indices[8..12].fill(CornerData::<f64>::NONE);
    let (file, lost) = written(&soup, Format::Ply);
    assert!(!lost.contains(&Lost::TextureCoordinates));
    assert_eq!(uvs(&cleaned(&read(&file, Format::Ply)).value), uvs(&cleaned(&soup).value));
    // A face with some cannot say so.
    soup.corner_uvs.as_mut().expect("given").indices[0] = CornerData::<f64>::NONE;
    assert!(written(&soup, Format::Ply).1.contains(&Lost::TextureCoordinates));
}

#[test]
fn normals_of_vertices_that_merge_become_normals_of_corners() {
    let mut soup = unwelded(&cube());
    let normals = [DVec3::NEG_Z, DVec3::Z, DVec3::NEG_Y, DVec3::Y, DVec3::NEG_X, DVec3::X];
    soup.vertex_normals = (0..24).map(|i| normals[i / 4]).collect();
    soup.vertex_normals[5] = DVec3::NAN;
    let outcome = cleaned(&soup);
    assert_eq!(outcome.value.vertex_count(), 8);
    assert!(outcome.report.not_carried.is_empty() && outcome.value.normals().is_none());
    let expected: Vec<Option<DVec3>> = (0..24).map(|i| Some(normals[i / 4]).filter(|_| i != 5)).collect();
    assert_eq!(outcome.value.attributes().corner_normals, Some(expected));
    let nan = lost(Attribute::VertexNormals, LossReason::NonFinite, Element::Vertex(5));
    assert_eq!(outcome.report.lost_values, [nan]);
    let mesh = clean(&soup, CleanOptions::default()).expect("a soup is never refused");
    assert_eq!((mesh.value.to_indexed(), mesh.report), (outcome.value, outcome.report));
}

#[test]
fn of_colours_at_one_vertex_the_lowest_stays_and_the_others_are_named() {
    let mut soup = unwelded(&cube());
    soup.vertex_colors = vec![[0.5, 0.5, 0.5, 1.0]; 24];
    let outcome = cleaned(&soup);
    assert!(outcome.report.lost_values.is_empty());
    let v = outcome.maps.vertices.old_of(3).to_vec();
    soup.vertex_colors[v[1] as usize] = [1.0, 0.0, 0.0, 1.0];
    soup.vertex_colors[v[2] as usize] = [f32::NAN; 4];
    let outcome = cleaned(&soup);
    assert_eq!(outcome.value.attributes().vertex_colors, Some(vec![[0.5, 0.5, 0.5, 1.0]; 8]));
    let kind = Attribute::VertexColors;
    let mut expected = [
        lost(kind, LossReason::Merged, Element::Vertex(v[1])),
        lost(kind, LossReason::NonFinite, Element::Vertex(v[2])),
    ];
    expected.sort();
    assert_eq!(outcome.report.lost_values, expected);
}

#[test]
fn a_flipped_face_keeps_its_texture_and_its_normals_face_where_it_does() {
    for winding_made_normals in [false, true] {
        let mut soup = read(textured_cube().as_bytes(), Format::Obj);
        let whole = cleaned(&soup).value;
        soup.polygons.reverse(3);
        soup.corner_uvs.as_mut().expect("given").indices[13..16].reverse();
        let normals = soup.corner_normals.as_mut().expect("given");
        if winding_made_normals {
            normals.values[3] = DVec3::NEG_Y;
        }
        let outcome = cleaned(&soup);
        assert_eq!(outcome.report.count(Kind::FlippedFace), 1);
        assert!(outcome.value == whole, "each corner has its own values again");
        // The same by unifying alone.
        let indexed = index(&soup, Weld::Exact).expect("a soup is never refused").value;
        assert!(unify_winding(&indexed.topology()).expect("orientable").value == whole);
    }
}

#[test]
fn a_face_that_touches_itself_keeps_the_two_values_at_the_vertex_it_names_twice() {
    // Two squares at vertex 5, as one face.
    let points = (0..16).map(|i| dvec3(f64::from(i % 4), f64::from(i / 4), 0.0)).collect();
    let mut soup = PolygonSoup::new(points, vec![vec![0, 1, 5, 6, 10, 9, 5, 4]].into());
    let values = (0..8).map(|c| [f64::from(c), 0.0]).collect();
    soup.corner_uvs = Some(CornerData { values, indices: (0..8).collect() });
    let outcome = cleaned(&soup);
    assert_eq!(outcome.report.count(Kind::PinchedFace), 1);
    let given: Vec<f64> = uvs(&outcome.value).iter().map(|uv| uv.expect("a value").x).collect();
    assert_eq!(given, [2.0, 3.0, 4.0, 5.0, 0.0, 1.0, 6.0, 7.0]);
}

#[test]
fn in_the_middle_of_a_parted_edge_lies_the_mean_of_its_ends() {
    let mut noise = shapes::Noise(0);
    let mut met = 0;
    for _ in 0..4000 {
        let points = (0..7).map(|_| dvec3(noise.unit(), noise.unit(), noise.unit())).collect();
        let faces = (0..12).map(|_| [(); 3].map(|()| noise.below(7))).collect();
        let mut soup = PolygonSoup::new(points, faces);
        let values = soup.positions.iter().map(|p| p.truncate().into()).collect();
        soup.corner_uvs = Some(CornerData { values, indices: soup.polygons.corners().to_vec() });
        soup.vertex_normals = vec![DVec3::Z; 7];
        let outcome = cleaned(&soup);
        met += outcome.report.count(Kind::ParallelEdge);
        let pool = &outcome.value;
        for (&v, uv) in pool.polygons().corners().iter().zip(uvs(pool)) {
            assert_eq!(uv, Some(pool.positions()[v as usize].truncate()), "linear as it was");
        }
        assert!(pool.normals().expect("carried").iter().all(|n| *n == DVec3::Z));
    }
    assert!(met > 2, "only {met} came up");
}

#[test]
fn values_that_are_not_finite_or_do_not_exist_are_left_out_and_named() {
    let mut soup = read(textured_cube().as_bytes(), Format::Obj);
    let data = soup.corner_uvs.as_mut().expect("given");
    data.values[6][1] = f64::INFINITY;
    data.indices[9] = 99;
    soup.groups[1].faces.start = 1;
    let outcome = cleaned(&soup);
    assert_eq!((uvs(&outcome.value)[6], uvs(&outcome.value)[9]), (None, None));
    let kind = Attribute::TextureCoordinates;
    let expected = [
        lost(kind, LossReason::NonFinite, Element::Corner([1, 2])),
        lost(kind, LossReason::NoSuchValue, Element::Corner([2, 1])),
        lost(Attribute::Groups, LossReason::TwoGroups, Element::Face(1)),
    ];
    assert_eq!(outcome.report.lost_values, expected);
    soup.groups[1].faces.end = 7;
    let refused = IndexedMesh::try_from(soup).expect_err("three defects");
    assert_eq!(
        refused.defects,
        [
            IndexedDefect::NonFiniteValue { attribute: kind, face: 1, corner: 2 },
            IndexedDefect::NoSuchValue { attribute: kind, face: 2, corner: 1, index: 99 },
            IndexedDefect::GroupPastFaces { group: 1, end: 7 },
            IndexedDefect::FaceInTwoGroups { face: 1 },
        ]
    );
}

#[test]
fn attributes_must_fit_the_pool() {
    let refused = |attributes: Attributes| cube().with_attributes(attributes).expect_err("unfit").defects;
    let none = Attributes::default;
    assert_eq!(
        refused(Attributes { vertex_colors: Some(vec![[0.0; 4]; 7]), ..none() }),
        [IndexedDefect::AttributeCount { attribute: Attribute::VertexColors, given: 7, wanted: 8 }]
    );
    assert_eq!(
        refused(Attributes { corner_normals: Some(vec![None; 25]), ..none() }),
        [IndexedDefect::AttributeCount { attribute: Attribute::CornerNormals, given: 25, wanted: 24 }]
    );
    let groups = FaceGroups { names: vec![GroupName::default()], of: vec![0, 0, 0, 1, 0, 0] };
    assert_eq!(
        refused(Attributes { face_groups: Some(groups), ..none() }),
        [IndexedDefect::NoSuchGroup { face: 3, group: 1 }]
    );
    let normals = vec![Some(DVec3::NAN); 1];
    assert_eq!(
        refused(Attributes { corner_normals: Some(normals), ..none() }),
        [
            IndexedDefect::AttributeCount { attribute: Attribute::CornerNormals, given: 1, wanted: 24 },
            IndexedDefect::NonFiniteValue { attribute: Attribute::CornerNormals, face: 0, corner: 0 },
        ]
    );
    assert_eq!(cube().with_attributes(none()), Ok(cube()));
}

#[test]
fn reversing_moves_corner_data_with_its_corners_and_turns_all_normals() {
    let pool = cleaned(&read(textured_cube().as_bytes(), Format::Obj)).value;
    let reversed = pool.clone().reversed();
    assert_eq!(reversed.polygons()[1], [4, 6, 7, 5]);
    let order = [4, 7, 6, 5];
    assert_eq!(uvs(&reversed)[4..8], order.map(|c| uvs(&pool)[c]));
    let normals = reversed.attributes().corner_normals.as_ref().expect("carried");
    assert_eq!(normals[4], Some(DVec3::NEG_Z));
    assert_eq!(reversed.reversed(), pool);
}

#[test]
fn runs_of_one_name_are_one_group_and_faces_between_are_in_none() {
    let mut soup = shapes::soup(&cube());
    let run = |name: &str, faces| Group { name: name.into(), material: None, faces };
    soup.groups = vec![run("a", 0..1), run("b", 2..3), run("a", 3..5)];
    let pool = IndexedMesh::try_from(soup.clone()).expect("valid");
    let groups = pool.attributes().face_groups.as_ref().expect("carried");
    assert_eq!(groups.of, [0, 1, 2, 0, 0, 1]);
    assert_eq!(groups.group(1), None);
    assert_eq!(groups.group(4).map(|g| g.name.as_str()), Some("a"));
    assert_eq!(PolygonSoup::from(pool).groups, soup.groups);
}

#[test]
fn a_thousand_values_at_one_vertex_take_no_quadratic_time() {
    // A fan around vertex 0, each corner there with a value of its own.
    let n = 200_000;
    let at = |i: u32| {
        let turn = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
        dvec3(turn.cos(), turn.sin(), 0.0)
    };
    let points = std::iter::once(DVec3::ZERO).chain((0..n).map(at)).collect();
    let triangles: Vec<[u32; 3]> = (0..n).map(|i| [0, i + 1, (i + 1) % n + 1]).collect();
    let pool = IndexedMesh::from_triangles(points, &triangles).expect("valid");
    let corner_uvs = Some((0..3 * n).map(|c| Some(dvec2(f64::from(c), 0.0))).collect());
    let pool = pool.with_attributes(Attributes { corner_uvs, ..Attributes::default() }).expect("fit");
    let soup = PolygonSoup::from(pool.clone());
    assert_eq!(IndexedMesh::try_from(soup), Ok(pool));
}

#[test]
fn textured_files_of_the_corpus_come_through_with_their_seams() {
    let Some(rows) = corpus::rows() else { return };
    let (mut files, mut seams) = (0, 0);
    for row in rows.iter().filter(|r| r.is_readable() && r.get("features").contains("uv")) {
        let Ok(soup) = row.load() else { continue };
        let Some(data) = &soup.corner_uvs else { continue };
        let outcome = cleaned(&soup);
        assert_eq!(outcome.report.not_carried, [], "{}", row.path);
        let pool = &outcome.value;
        let values = uvs(pool);
        // Each corner has what a corner of its face had at that place.
        let starts = |f: usize| soup.polygons.corner_range(f).expect("a face");
        for f in 0..pool.face_count() {
            let old = starts(outcome.maps.faces.old_of(f)[0] as usize);
            for c in pool.polygons().corner_range(f).expect("a face") {
                let p = pool.positions()[pool.polygons().corners()[c] as usize];
                let mut same = old
                    .clone()
                    .filter(|&o| soup.positions[soup.polygons.corners()[o] as usize] == p)
                    .map(|o| data.values.get(data.indices[o] as usize).map(|uv| DVec2::from(*uv)))
                    .peekable();
                // None in the middle of a parted edge.
                assert!(same.peek().is_none() || same.any(|uv| uv == values[c]), "{}: face {f}", row.path);
            }
        }
        let mut first = vec![None; pool.vertex_count()];
        let mut differs = |(v, uv): (&u32, &Option<DVec2>)| *first[*v as usize].get_or_insert(*uv) != *uv;
        seams += pool.polygons().corners().iter().zip(&values).filter(|c| differs(*c)).count();
        for format in [Format::Obj, Format::Ply] {
            let (file, lost) = written(&pool.clone().into(), format);
            if !lost.contains(&Lost::TextureCoordinates) {
                let back = read(&file, format);
                assert_eq!(back.positions.len(), pool.vertex_count());
                let back = IndexedMesh::try_from(back).expect("what was valid");
                assert!(uvs(&back) == values, "{} {format:?}", row.path);
            }
        }
        files += 1;
    }
    assert!(files >= 25 && seams > 1000, "{files} files with {seams} corners on seams");
}

#[test]
fn a_mesh_carries_every_attribute_and_gives_it_back() {
    let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    let pool = IndexedMesh::from_triangles(points, &[[0, 1, 2], [2, 1, 3]]).expect("a pool");
    let attributes = Attributes {
        vertex_normals: Some(vec![DVec3::Z, DVec3::X, DVec3::Y, DVec3::ZERO]),
        vertex_colors: Some(vec![[0.25; 4], [0.5; 4], [0.75; 4], [1.0; 4]]),
        corner_normals: Some(vec![Some(DVec3::X), None, Some(DVec3::Z), None, None, Some(DVec3::Y)]),
        corner_uvs: Some((0..6).map(|i| (i != 4).then(|| dvec2(f64::from(i), 0.5))).collect()),
        face_groups: Some(FaceGroups {
            names: vec![
                GroupName { name: "lid".into(), material: Some("steel".into()) },
                GroupName { name: "base".into(), material: None },
            ],
            of: vec![1, 0],
        }),
        material_files: vec!["parts.mtl".into()],
    };
    let pool = pool.with_attributes(attributes).expect("they fit");
    let mesh = Mesh::build(&pool).expect("a manifold");
    assert_eq!(mesh.to_indexed(), pool);
    assert_eq!(mesh.carried_attributes().len(), 6);
    let f = mesh.faces().next().expect("a face");
    assert_eq!(mesh.group(f).map(|g| g.name.as_str()), Some("base"));
    let mut reversed = mesh.clone();
    reversed.reverse();
    assert_eq!(reversed.to_indexed(), pool.reversed());
}

#[test]
fn textures_groups_and_colours_go_from_file_to_file_through_edits() {
    // Two quads with a seam between them, in two groups, colours at the vertices.
    let text = "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 2 0 0 0 0 1\nv 0 1 0 1 0 0\nv 1 1 0 0 1 0\nv 2 1 0 0 0 1\n\
        vt 0 0\nvt 0.25 0\nvt 0.25 0.25\nvt 0 0.25\nvt 0.5 0.5\nvt 1 0.5\nvt 1 1\nvt 0.5 1\n\
        g left\nusemtl red\nf 1/1 2/2 5/3 4/4\ng right\nusemtl blue\nf 2/5 3/6 6/7 5/8\n";
    let loaded = io::read_obj(text.as_bytes(), &Limits::default()).expect("readable");
    let mut mesh = clean(&loaded.soup, CleanOptions::default()).expect("never refused").value;
    let seam = mesh.edges().find(|&e| mesh.is_uv_seam(e)).expect("a seam");
    let split = mesh.split_edge(seam, dvec3(1.0, 0.5, 0.0)).expect("always");
    let right = mesh.faces().nth(1).expect("two faces");
    let middle = mesh.poke_face(right, dvec3(1.5, 0.5, 0.0)).expect("always").vertex;
    let mut file = Vec::new();
    io::write(&mesh.to_indexed().into(), Format::Obj, Encoding::Binary, &mut file).expect("writable");
    let again = io::read_obj(file.as_slice(), &Limits::default()).expect("readable");
    let again = clean(&again.soup, CleanOptions::default()).expect("never refused").value;
    assert_eq!(again.to_indexed(), mesh.to_indexed());
    // A new vertex on the seam has a place on either side, that in the middle of the right quad one; all are linear.
    let number = |v| mesh.vertices().position(|w| w == v).expect("a vertex");
    let uvs = |v| {
        let v = again.vertices().nth(number(v)).expect("a vertex");
        let mut uvs: Vec<[f64; 2]> =
            again.outgoing(v).filter_map(|h| again.uv(h)).map(|uv| uv.to_array()).collect();
        uvs.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        uvs.dedup();
        uvs
    };
    assert_eq!(uvs(split.vertex), [[0.25, 0.125], [0.5, 0.75]]);
    let [[u, v]] = uvs(middle)[..] else { panic!("one place") };
    assert!((u - 0.75).abs() < 1e-14 && (v - 0.75).abs() < 1e-14);
    let groups: Vec<&str> = again.faces().filter_map(|f| Some(again.group(f)?.name.as_str())).collect();
    assert_eq!(groups, [&["left"][..], &["right"; 5]].concat());
    assert!(again.carried_attributes().contains(&Attribute::VertexColors));
}
