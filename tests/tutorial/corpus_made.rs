//! Rows about meshes that are made of others, on the corpus: weld, unweld, subdivide.

use crate::shapes::{self, Noise};
use crate::{assert_met, few, reach, solids, somewhere};
use meshwright::cleanup::{Weld, index};
use meshwright::glam::DVec3;
use meshwright::{Element, Mesh, Scheme, SubdivideOptions, UnweldOptions, VertexKey, WeldOptions};
use std::collections::BTreeSet;

/// The least distance between two vertices that are not at one place.
fn least_distance(points: &[DVec3]) -> f64 {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x));
    let mut least = f64::INFINITY;
    for (i, p) in sorted.iter().enumerate() {
        for q in &sorted[i + 1..] {
            if q.x - p.x >= least {
                break;
            }
            let apart = p.distance(*q);
            if apart > 0.0 {
                least = least.min(apart);
            }
        }
    }
    least
}

#[test]
fn corners_of_models_a_hair_apart_are_merged_and_signs_of_zero_say_nothing() {
    let mut noise = Noise(71);
    let mut met = 0;
    for (name, mesh) in few() {
        let pool = mesh.to_indexed();
        let (size, far) = reach(mesh);
        let mut soup = shapes::unwelded(&pool);
        let exact = index(&soup, Weld::Exact).expect("always answers").value;
        for p in soup.positions.iter_mut().step_by(2) {
            for axis in 0..3 {
                if p[axis] == 0.0 {
                    p[axis] = -p[axis];
                }
            }
        }
        let again = index(&soup, Weld::Exact).expect("always answers").value;
        assert!(again.polygons() == exact.polygons() && again.positions() == exact.positions(), "{name}");
        let tolerance = 0.2 * least_distance(exact.positions());
        if tolerance < 1e-10 * (size + far) {
            continue;
        }
        // A cell of any grid is straddled somewhere.
        for p in &mut soup.positions {
            *p += somewhere(&mut noise, 0.02 * tolerance);
        }
        let near = index(&soup, Weld::Within(tolerance)).expect("always answers").value;
        assert!(near.polygons() == exact.polygons(), "{name}: the same corners are one vertex");
        let apart = index(&soup, Weld::Exact).expect("always answers").value;
        assert!(apart.vertex_count() > exact.vertex_count() || mesh.face_count() < 3, "{name}");
        met += 1;
    }
    assert_met(met, 100);
}

#[test]
fn what_a_coarse_weld_of_models_folds_is_dropped_on_record() {
    let mut dropped = 0;
    for (name, mesh) in few() {
        for share in [0.01, 0.1, 0.4] {
            let tolerance = share * reach(mesh).0;
            let outcome = mesh.weld(WeldOptions { tolerance, ..Default::default() }).expect("welded");
            assert_eq!(outcome.value.validate(), Ok(()), "{name}");
            let mut told = BTreeSet::new();
            for record in &outcome.report.records {
                match record.element {
                    Element::Face(f) | Element::Corner([f, _]) => _ = told.insert(f),
                    Element::Faces(pair) => told.extend(pair),
                    _ => {}
                }
            }
            for f in 0..mesh.face_count() {
                if outcome.maps.faces.new_of(f).is_empty() {
                    assert!(told.contains(&(f as u32)), "{name}, {share}: face {f} went without a word");
                    dropped += 1;
                }
            }
        }
    }
    assert_met(dropped, 2000);
}

#[test]
fn unwelding_models_parts_them_along_what_is_sharp() {
    let mut parted = 0;
    for (name, mesh) in few() {
        let options = UnweldOptions { degrees: 30.0, ..Default::default() };
        let outcome = mesh.unweld(options).expect("parted");
        let sharp: BTreeSet<[u32; 2]> = {
            let vertices: Vec<VertexKey> = mesh.vertices().collect();
            let number = |v| vertices.binary_search(&v).expect("a vertex") as u32;
            let ends = |e| {
                let h = mesh.edge_halfedge(e);
                let [a, b] = [mesh.origin(h), mesh.target(h)].map(number);
                [a.min(b), a.max(b)]
            };
            mesh.sharp_edges(30.0).expect("an angle").into_iter().map(ends).collect()
        };
        for record in &outcome.report.records {
            let Element::Edge([a, b]) = record.element else { panic!("{name}: {record:?}") };
            assert!(sharp.contains(&[a.min(b), a.max(b)]), "{name}");
        }
        parted += outcome.report.records.len();
    }
    assert_met(parted, 2000);
}

fn fine(mesh: &Mesh, scheme: Scheme) -> meshwright::Outcome<Mesh> {
    mesh.subdivide(SubdivideOptions { scheme, ..Default::default() }).expect("subdivided")
}

#[test]
fn midpoints_of_models_lie_once_on_every_edge_and_parents_are_told() {
    let mut met = 0;
    for (name, mesh) in few() {
        let outcome = fine(mesh, Scheme::Midpoint);
        let (new, old) = (outcome.value.to_indexed(), mesh.to_indexed());
        let large = mesh.faces().filter(|&f| mesh.degree(f) > 3).count();
        assert_eq!(new.vertex_count(), old.vertex_count() + mesh.edge_count() + large, "{name}");
        let parts = |n: usize| if n == 3 { 4 } else { n };
        assert_eq!(new.face_count(), mesh.faces().map(|f| parts(mesh.degree(f))).sum::<usize>(), "{name}");
        let mut edges = BTreeSet::new();
        for (v, p) in new.positions().iter().enumerate() {
            let parents = outcome.maps.vertices.old_of(v);
            let at = |&i: &u32| old.positions()[i as usize];
            match parents {
                [own] => assert_eq!(*p, at(own), "{name}: what was there stays"),
                [a, b] => {
                    assert!(edges.insert([a, b]), "{name}: two on one edge");
                    assert!(
                        p.distance(at(a).midpoint(at(b))) <= 1e-15 * (at(a).length() + at(b).length()),
                        "{name}"
                    );
                }
                all => {
                    let mean = all.iter().map(at).sum::<DVec3>() / all.len() as f64;
                    assert!(p.distance(mean) <= 1e-14 * reach(mesh).1, "{name}");
                }
            }
        }
        assert_eq!(edges.len(), mesh.edge_count(), "{name}");
        for (f, face) in mesh.faces().enumerate() {
            assert_eq!(outcome.maps.faces.new_of(f).len(), parts(mesh.degree(face)), "{name}");
        }
        met += 1;
    }
    assert_met(met, 120);
}

/// Catmull and Clark's rules written down, for closed meshes: the places of old vertices, of edges, of faces, by the old
/// vertices that they come from.
fn catmull_clark(mesh: &Mesh) -> Vec<(Vec<VertexKey>, DVec3)> {
    let at = |v| mesh.position(v);
    let center = |f| mesh.face_vertices(f).map(at).sum::<DVec3>() / mesh.degree(f) as f64;
    let mut all = Vec::new();
    for v in mesh.vertices().filter(|&v| !mesh.is_isolated(v)) {
        let n = mesh.valence(v) as f64;
        let faces = mesh.faces_around(v).map(center).sum::<DVec3>() / n;
        let edges = mesh.neighbors(v).map(|w| at(v).midpoint(at(w))).sum::<DVec3>() / n;
        all.push((vec![v], (faces + edges * 2.0 + at(v) * (n - 3.0)) / n));
    }
    for e in mesh.edges() {
        let h = mesh.edge_halfedge(e);
        let (a, b) = (mesh.origin(h), mesh.target(h));
        let [f, g] = [h, mesh.twin(h)].map(|h| mesh.face(h).expect("closed"));
        all.push((vec![a, b], (at(a) + at(b) + center(f) + center(g)) / 4.0));
    }
    all.extend(mesh.faces().map(|f| (mesh.face_vertices(f).collect(), center(f))));
    all
}

/// Kobbelt's rules for closed meshes of triangles: old vertices, and faces.
fn sqrt3(mesh: &Mesh) -> Vec<(Vec<VertexKey>, DVec3)> {
    let at = |v| mesh.position(v);
    let relaxed = |v| {
        let n = mesh.valence(v) as f64;
        let share = (4.0 - 2.0 * (std::f64::consts::TAU / n).cos()) / 9.0;
        (vec![v], at(v) * (1.0 - share) + mesh.neighbors(v).map(at).sum::<DVec3>() * (share / n))
    };
    let old = mesh.vertices().filter(|&v| !mesh.is_isolated(v)).map(relaxed);
    old.chain(
        mesh.faces()
            .map(|f| (mesh.face_vertices(f).collect(), mesh.face_vertices(f).map(at).sum::<DVec3>() / 3.0)),
    )
    .collect()
}

#[test]
fn catmull_clark_and_sqrt3_of_models_follow_their_rules() {
    let mut met = [0, 0];
    for (name, mesh) in few().iter().filter(|(_, mesh)| mesh.is_closed()) {
        let vertices: Vec<VertexKey> = mesh.vertices().collect();
        let is_triangles = mesh.faces().all(|f| mesh.degree(f) == 3);
        let far = reach(mesh).1;
        for (i, scheme) in [Scheme::CatmullClark, Scheme::Sqrt3].into_iter().enumerate() {
            if i == 1 && !is_triangles {
                continue;
            }
            let outcome = fine(mesh, scheme);
            let rules = if i == 0 { catmull_clark(mesh) } else { sqrt3(mesh) };
            let key = |parents: &mut Vec<u32>| {
                parents.sort_unstable();
                std::mem::take(parents)
            };
            let number = |v: &VertexKey| vertices.binary_search(v).expect("a vertex") as u32;
            let mut expected: Vec<(Vec<u32>, DVec3)> =
                rules.iter().map(|(of, p)| (key(&mut of.iter().map(number).collect()), *p)).collect();
            let mut found: Vec<(Vec<u32>, DVec3)> = outcome
                .value
                .vertices()
                .enumerate()
                .filter(|(_, v)| !outcome.value.is_isolated(*v))
                .map(|(i, v)| (key(&mut outcome.maps.vertices.old_of(i).to_vec()), outcome.value.position(v)))
                .collect();
            let order = |a: &(Vec<u32>, DVec3), b: &(Vec<u32>, DVec3)| a.0.cmp(&b.0);
            expected.sort_by(order);
            found.sort_by(order);
            assert_eq!(found.len(), expected.len(), "{name}, {scheme:?}");
            for (f, e) in found.iter().zip(&expected) {
                assert!(f.0 == e.0 && f.1.distance(e.1) <= 1e-13 * far, "{name}, {scheme:?}: {f:?} {e:?}");
            }
            met[i] += 1;
        }
    }
    assert_met(met[0], 70);
    assert_met(met[1], 45);
}

#[test]
fn rims_creases_and_corners_of_models_follow_the_curve_rules() {
    let (mut rims, mut creased) = (0, 0);
    for (name, mesh) in few() {
        let vertices: Vec<VertexKey> = mesh.vertices().collect();
        let far = reach(mesh).1;
        // By Catmull and Clark every polygon will do.
        let smooth = fine(mesh, Scheme::CatmullClark).value.to_indexed();
        for h in mesh.boundary_halfedges() {
            let at = |h| mesh.position(mesh.origin(h));
            let v = vertices.binary_search(&mesh.origin(h)).expect("a vertex");
            let expected = at(h) * 0.75 + (at(mesh.prev(h)) + at(mesh.next(h))) * 0.125;
            assert!(smooth.positions()[v].distance(expected) <= 1e-14 * far, "{name}");
            rims += 1;
        }
        let corners: Vec<VertexKey> = vertices.iter().copied().step_by(9).collect();
        let options = SubdivideOptions {
            scheme: Scheme::CatmullClark,
            crease_degrees: Some(20.0),
            corners: &corners,
            ..Default::default()
        };
        let sharp = mesh.subdivide(options).expect("subdivided").value.to_indexed();
        let creases: BTreeSet<_> = mesh.sharp_edges(20.0).expect("an angle").into_iter().collect();
        for (i, &v) in vertices.iter().enumerate() {
            let is_curve = |h| creases.contains(&mesh.edge(h)) || mesh.is_boundary_edge(mesh.edge(h));
            let along: Vec<DVec3> =
                mesh.outgoing(v).filter(|&h| is_curve(h)).map(|h| mesh.position(mesh.target(h))).collect();
            let p = mesh.position(v);
            let expected = match along[..] {
                _ if corners.contains(&v) => p,
                [a, b] => p * 0.75 + (a + b) * 0.125,
                [] | [_] => continue,
                _ => p,
            };
            assert!(sharp.positions()[i].distance(expected) <= 1e-14 * far, "{name}: {v:?}");
            creased += 1;
        }
    }
    eprintln!("{rims} {creased}");
    assert_met(rims, 500);
    assert_met(creased, 2000);
}

#[test]
fn selections_of_models_are_cut_without_t_junctions() {
    let mut noise = Noise(72);
    let mut met = 0;
    for (name, mesh) in few() {
        let only: Vec<_> = mesh.faces().filter(|_| noise.below(3) == 0).collect();
        let options = SubdivideOptions { only: Some(&only), ..Default::default() };
        let outcome = mesh.subdivide(options).expect("subdivided");
        let facts = |m: &Mesh| (m.euler_characteristic(), m.boundary_loops().len(), m.components().len());
        assert_eq!(outcome.value.validate(), Ok(()), "{name}");
        // A T-junction would leave an open edge.
        assert_eq!(facts(&outcome.value), facts(mesh), "{name}");
        assert_eq!(outcome.value.is_closed(), mesh.is_closed(), "{name}");
        let (new, old) = (outcome.value.to_indexed(), mesh.to_indexed());
        assert!(new.positions()[..old.vertex_count()] == *old.positions(), "{name}: nothing moves");
        if mesh.faces().all(|f| mesh.degree(f) == 3) {
            assert!((new.area() - old.area()).abs() <= 1e-9 * old.area(), "{name}");
        }
        met += usize::from(!only.is_empty());
    }
    assert_met(met, 90);
    assert_met(solids().count(), 45);
}
