//! What cuts across the operations: one triangulation rule, the same result every time, files that come back.

use crate::naive::Plain;
use crate::shapes::{self, Noise, cube, cube_at, mesh};
use crate::{by_place, cut, manifolds, models, somewhere};
use meshwright::cleanup::{CleanOptions, Weld, clean, index, propose_tolerance};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    ClosestOptions, IndexedMesh, Mesh, OutwardOptions, Ray, ReduceOptions, ReduceTarget, Scheme,
    SmoothOptions, SubdivideOptions, UnweldOptions, WeldOptions,
};

/// A closed shape of quads that are far from flat.
fn crumpled(seed: u64) -> IndexedMesh {
    let mut noise = Noise(seed);
    let mut pool = shapes::torus(6, 5);
    pool.map_positions(|p| p + dvec3(noise.unit(), noise.unit(), noise.unit()) * 0.5).expect("finite");
    pool
}

#[test]
fn volume_rays_nearest_points_and_files_cut_a_polygon_by_one_rule() {
    for seed in 0..6 {
        let quads = mesh(&crumpled(seed));
        let triangles = mesh(&cut(&crumpled(seed)));
        let volume = |m: &Mesh| m.closed().expect("closed").volume();
        assert!((volume(&quads) - volume(&triangles)).abs() < 1e-12);
        let (a, b) = (quads.index(), triangles.index());
        assert_eq!((a.triangle_count(), b.triangle_count()), (60, 60));
        let mut noise = Noise(seed);
        for _ in 0..100 {
            let p = somewhere(&mut noise, 8.0);
            let ray = Ray::new(p, somewhere(&mut noise, 3.0) - p).expect("a ray");
            let ts = |i: &meshwright::MeshIndex<'_>| i.hits(&ray).iter().map(|h| h.t).collect::<Vec<_>>();
            let (ours, theirs) = (ts(&a), ts(&b));
            assert_eq!(ours.len(), theirs.len());
            assert!(ours.iter().zip(&theirs).all(|(t, u)| (t - u).abs() < 1e-12));
            let near = |i: &meshwright::MeshIndex<'_>| {
                i.closest_point(p, ClosestOptions::default()).expect("asked well").expect("a point").distance
            };
            assert!((near(&a) - near(&b)).abs() < 1e-12);
        }
        // Reversed it is the same, reversed.
        let back = cut(&crumpled(seed).reversed());
        assert_eq!(by_place(&Plain::from(&back)), by_place(&Plain::from(&triangles.to_indexed().reversed())));
        assert!((volume(&mesh(&back)) + volume(&triangles)).abs() < 1e-12);
    }
}

#[cfg(feature = "io")]
#[test]
fn a_file_of_triangles_holds_those_of_the_one_rule() {
    use meshwright::io::{Encoding, Format, Limits, read, write};
    let mut quads = crumpled(3);
    // In what STL can hold.
    quads.map_positions(|p| p.as_vec3().as_dvec3()).expect("finite");
    let mut file = Vec::new();
    write(&quads.clone().into(), Format::Stl, Encoding::Binary, &mut file).expect("written");
    let back = read(&file, Format::Stl, &Limits::default()).expect("read").soup;
    let back = index(&back, Weld::Exact).expect("always answers").value;
    assert_eq!(by_place(&Plain::from(&back)), by_place(&Plain::from(&cut(&quads))));
}

#[cfg(feature = "io")]
#[test]
fn saving_to_obj_and_ply_keeps_every_bit_and_what_was_split_and_stl_says_that_it_does_not() {
    use meshwright::io::{Encoding, Format, Limits, Lost, read, write};
    let mut pool = shapes::both(&cube(), &cube_at(dvec3(1., 1., 0.)));
    let third = 1.0 / 3.0;
    pool.map_positions(|p| p * third + 1e-7).expect("finite");
    let soup = shapes::soup(&pool);
    for format in [Format::Obj, Format::Ply] {
        for encoding in [Encoding::Ascii, Encoding::Binary] {
            let mut file = Vec::new();
            let lost = match write(&soup, format, encoding, &mut file) {
                Ok(lost) => lost,
                Err(error) => panic!("{format:?}: {error}"),
            };
            assert!(lost.is_empty(), "{format:?}: {lost:?}");
            let back = read(&file, format, &Limits::default()).expect("read").soup;
            assert_eq!(IndexedMesh::try_from(back).expect("a pool"), pool, "{format:?} {encoding:?}");
        }
    }
    let mut file = Vec::new();
    let lost = write(&soup, Format::Stl, Encoding::Binary, &mut file).expect("written");
    assert!(lost.contains(&Lost::SharedVertices), "vertices that are split would be merged on reading");
}

#[test]
fn a_helper_proposes_a_tolerance_from_the_data_and_none_is_hidden() {
    let mut soup = shapes::unwelded(&shapes::icosphere(2));
    let mut noise = Noise(61);
    for p in &mut soup.positions {
        *p += somewhere(&mut noise, 1e-7);
    }
    let tolerance = propose_tolerance(&soup);
    assert!(tolerance > 2e-7 && tolerance < 1e-5, "{tolerance}");
    let count = |weld| index(&soup, weld).expect("always answers").value.vertex_count();
    assert_eq!(count(Weld::Exact), soup.positions.len(), "without an argument nothing near is equal");
    assert_eq!(count(Weld::Within(tolerance)), 162);
    assert_eq!(count(Weld::Auto), 162);
}

#[test]
fn what_was_merged_dropped_split_or_flipped_is_told_with_element_and_place() {
    let mut soup =
        shapes::unwelded(&shapes::some_reversed(&shapes::both(&cube(), &cube_at(DVec3::ONE)), 5, 3));
    soup.polygons.push([0, 1, 99]);
    soup.polygons.push([0, 1, 0]);
    soup.positions[5].x += 1e-4;
    let cleaned =
        clean(&soup, CleanOptions { weld: Weld::Within(1e-3), ..Default::default() }).expect("always");
    let report = &cleaned.report;
    assert!(report.records.len() >= 4, "{report:?}");
    for record in &report.records {
        assert!(record.place.is_some_and(|p| p.is_finite()), "{record:?}");
        assert!(!record.kind.as_str().is_empty() && !record.step.as_str().is_empty());
    }
    let counts = report.counts();
    assert_eq!(counts.values().sum::<usize>(), report.records.len());
    assert_eq!(cleaned.maps.faces.old_len(), soup.polygons.len());
}

/// Everything that the operations make of a mesh, in one list of numbers and indices.
fn everything(mesh: &Mesh) -> Vec<(IndexedMesh, String)> {
    let mut all = Vec::new();
    let mut add = |m: &Mesh, account: String| all.push((m.to_indexed(), account));
    let told = |o: &meshwright::Outcome<Mesh>| format!("{:?} {:?}", o.report, o.maps);
    let welded = mesh.weld(WeldOptions { tolerance: 0.01, ..Default::default() }).expect("welded");
    add(&welded.value, told(&welded));
    let parted = mesh.unweld(UnweldOptions { degrees: 20.0, ..Default::default() }).expect("parted");
    add(&parted.value, told(&parted));
    for scheme in [Scheme::Midpoint, Scheme::Loop, Scheme::CatmullClark, Scheme::Sqrt3] {
        match mesh.subdivide(SubdivideOptions { scheme, ..Default::default() }) {
            Ok(fine) => add(&fine.value, told(&fine)),
            Err(error) => add(mesh, error.to_string()),
        }
    }
    let mut smooth = mesh.clone();
    smooth.smooth(SmoothOptions { iterations: 3, ..Default::default() }).expect("smoothed");
    add(&smooth, String::new());
    let mut turned = mesh.clone();
    let parts = turned.orient_outward(OutwardOptions::default()).expect("turned");
    add(&turned, format!("{parts:?}"));
    let mut small = mesh.clone();
    let account = small.reduce(ReduceOptions { target: ReduceTarget::Ratio(0.5), ..Default::default() });
    add(&small, format!("{account:?}"));
    let index = mesh.index();
    let bounds = mesh.bounds().expect("vertices");
    let (size, mut noise) = ((bounds.max - bounds.min).length(), Noise(62));
    let points: Vec<DVec3> = (0..40).map(|_| bounds.center() + somewhere(&mut noise, size)).collect();
    let rays: Vec<Ray> =
        points.iter().map(|&p| Ray::new(p, bounds.center() - p + DVec3::X).expect("a ray")).collect();
    let near = index.closest_point_batch(&points, ClosestOptions::default());
    let measured = mesh.closed().map(|c| (c.volume(), c.mass_properties()));
    add(mesh, format!("{:?} {near:?} {measured:?}", index.hits_batch(&rays)));
    let cleaned = clean(&mesh.to_indexed().into(), CleanOptions::default()).expect("always answers");
    add(&cleaned.value, told(&cleaned));
    all
}

#[test]
fn the_same_input_gives_the_same_output_whatever_the_threads() {
    let named = manifolds().into_iter().map(|(name, pool)| (name, mesh(&pool)));
    let models = models(1000).into_iter().filter(|m| m.1.face_count() > 100).take(12);
    for (name, mesh) in named.chain(models) {
        let first = everything(&mesh);
        assert!(everything(&mesh.clone()) == first, "{name}");
        assert!(
            everything(&Mesh::build(&mesh.to_indexed()).expect("a manifold")) == first,
            "{name}, built anew"
        );
        #[cfg(feature = "rayon")]
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            assert!(pool.install(|| everything(&mesh)) == first, "{name}, {threads} threads");
        }
    }
}
