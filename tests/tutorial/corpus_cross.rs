//! What cuts across the operations, on the corpus: one triangulation rule, tolerances, files that come back.

use crate::naive::Plain;
use crate::shapes;
use crate::{assert_met, by_place, cut, few, reach, soups, volume};
use meshwright::cleanup::{Weld, index, propose_tolerance};
use meshwright::{ClosestOptions, IndexedMesh, Mesh, Ray};

#[test]
fn polygons_of_models_are_cut_alike_by_all_and_in_either_direction() {
    let mut met = 0;
    for (name, mesh) in few().iter().filter(|(_, mesh)| mesh.faces().any(|f| mesh.degree(f) > 3)) {
        let pool = mesh.to_indexed();
        let triangles = cut(&pool);
        let back = cut(&pool.reversed());
        assert_eq!(
            by_place(&Plain::from(&back)),
            by_place(&Plain::from(&triangles.clone().reversed())),
            "{name}"
        );
        assert_eq!(mesh.index().triangle_count(), triangles.face_count(), "{name}");
        let Ok(apart) = Mesh::build(&triangles) else { continue };
        let (size, far) = reach(mesh);
        if let (Ok(solid), true) = (mesh.closed(), apart.is_closed()) {
            assert!((solid.volume() - volume(&apart)).abs() <= 1e-13 * (size + far) * solid.area(), "{name}");
        }
        let mut noise = shapes::Noise(met);
        let (ours, theirs) = (mesh.index(), apart.index());
        for _ in 0..20 {
            let p = mesh.bounds().expect("vertices").center() + crate::somewhere(&mut noise, size);
            let near = |i: &meshwright::MeshIndex<'_>| {
                i.closest_point(p, ClosestOptions::default()).expect("asked well").expect("a point").distance
            };
            assert!((near(&ours) - near(&theirs)).abs() <= 1e-12 * (size + far), "{name}");
            let ray = Ray::new(p, crate::somewhere(&mut noise, 1.0)).expect("a ray");
            let ts = |i: &meshwright::MeshIndex<'_>| i.hits(&ray).iter().map(|h| h.t).collect::<Vec<_>>();
            let (ours, theirs) = (ts(&ours), ts(&theirs));
            assert_eq!(ours.len(), theirs.len(), "{name}");
            assert!(ours.iter().zip(&theirs).all(|(t, u)| (t - u).abs() <= 1e-11 * t.max(1.0)), "{name}");
        }
        met += 1;
    }
    assert_met(met as usize, 20);
}

#[test]
fn clean_files_of_the_corpus_are_welded_exactly_when_nothing_is_said() {
    let mut met = 0;
    for (name, soup) in soups(1000) {
        if name.starts_with("clean/") {
            let [auto, exact] =
                [Weld::Auto, Weld::Exact].map(|w| index(&soup, w).expect("always answers").value);
            assert!(
                auto.vertex_count() == exact.vertex_count(),
                "{name}: {} proposed",
                propose_tolerance(&soup)
            );
            met += 1;
        }
    }
    assert_met(met, 20);
}

#[cfg(feature = "io")]
#[test]
fn models_come_back_from_obj_and_ply_to_the_bit_and_stl_says_what_it_loses() {
    use meshwright::io::{Encoding, Format, Limits, Lost, read, write};
    for (name, mesh) in few() {
        let pool = mesh.to_indexed();
        let bare = IndexedMesh::new(pool.positions().to_vec(), pool.polygons().clone()).expect("a pool");
        let soup = shapes::soup(&bare);
        for (format, encoding) in
            [(Format::Obj, Encoding::Ascii), (Format::Ply, Encoding::Ascii), (Format::Ply, Encoding::Binary)]
        {
            let mut file = Vec::new();
            let lost = write(&soup, format, encoding, &mut file).expect("written");
            assert!(lost.is_empty(), "{name}, {format:?}: {lost:?}");
            let back = read(&file, format, &Limits::default()).expect("read").soup;
            let back = IndexedMesh::try_from(back).expect("a pool");
            let bits = |p: &IndexedMesh| -> Vec<[u64; 3]> {
                p.positions().iter().map(|p| p.to_array().map(f64::to_bits)).collect()
            };
            assert!(bits(&back) == bits(&bare) && back.polygons() == bare.polygons(), "{name}, {format:?}");
            assert!(
                Mesh::build(&back).is_ok_and(|m| m.boundary_loops().len() == mesh.boundary_loops().len())
            );
        }
        let mut file = Vec::new();
        let lost = write(&soup, Format::Stl, Encoding::Binary, &mut file).expect("written");
        let mut merged = index(&soup, Weld::Exact).expect("always answers").value.vertex_count();
        merged += bare.topology().isolated_vertices().len();
        assert!(merged >= bare.vertex_count() || lost.contains(&Lost::SharedVertices), "{name}: {lost:?}");
    }
}
