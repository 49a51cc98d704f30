//! Faults put into shapes of known truth, each alone and all at once: the profile `solid` gives back the shape.

#[path = "../igl/mod.rs"]
mod igl;
mod inject;
mod judge;
#[path = "../shapes/mod.rs"]
mod shapes;
mod truth;

use igl::Igl;
use inject::Faulty;
use judge::{Faults, faithful, honest, solid, sound};
use meshwright::cleanup::Weld;
use meshwright::{Kind, PolygonSoup};
use shapes::Noise;
use std::io::Write;
use truth::{Truth, truths};

/// The seeds, or others: `MESHWRIGHT_SEEDS=3..20`.
fn seeds() -> std::ops::Range<u64> {
    let given = std::env::var("MESHWRIGHT_SEEDS").ok();
    let range = given.as_deref().and_then(|given| given.split_once(".."));
    range.map_or(0..3, |(from, to)| from.parse().expect("a number")..to.parse().expect("a number"))
}

/// Puts a fault into every shape and judges what comes back.
fn every_shape(fault: fn(&mut Faulty)) {
    let mut igl = Igl::start();
    let mut failed = Vec::new();
    let mut passed = 0;
    for truth in truths() {
        for seed in seeds() {
            let mut faulty = Faulty::new(&truth, seed);
            fault(&mut faulty);
            let found = judged(&truth, &faulty.soup(), &faulty.intact, faulty.jitter, &mut igl);
            if found.is_empty() {
                passed += 1;
            } else {
                failed.push(format!("{}, seed {seed}: {}", truth.name, found.join("; ")));
            }
        }
    }
    finish(passed, &failed);
}

fn finish(passed: usize, failed: &[String]) {
    assert!(failed.is_empty(), "{} of {} passed\n{}", passed, passed + failed.len(), failed.join("\n"));
}

fn judged(truth: &Truth, soup: &PolygonSoup, intact: &[bool], jitter: f64, igl: &mut Igl) -> Faults {
    let result = solid(soup, Weld::Auto);
    let mut found = honest(soup, &result);
    found.extend(sound(&result.pool, truth.diagonal, igl));
    found.extend(faithful(truth, intact, jitter, &result));
    if !found.is_empty()
        && let Some(dir) = std::env::var_os("MESHWRIGHT_FAULTS")
    {
        // To look at.
        let path = std::path::Path::new(&dir).join(format!("{}.obj", truth.name.replace([' ', ','], "_")));
        let mut file = std::fs::File::create(path).expect("a file");
        meshwright::io::write(soup, meshwright::io::Format::Obj, meshwright::io::Encoding::Ascii, &mut file)
            .map_err(|e| writeln!(std::io::stderr(), "{e}"))
            .ok();
    }
    found
}

macro_rules! every_shape {
    ($($name:ident: $fault:expr;)*) => { $(
        #[test]
        fn $name() {
            every_shape($fault);
        }
    )* };
}

every_shape! {
    a_sound_shape_is_left_alone: |_| {};
    a_soup_is_welded: inject::unweld;
    a_jittered_soup_is_welded: inject::jitter;
    mixed_windings_are_unified: inject::flip;
    a_shape_inside_out_is_turned: inject::invert;
    holes_of_1_to_30_faces_are_filled: inject::holes;
    duplicates_are_dropped: inject::duplicate;
    reversed_duplicates_are_dropped: inject::duplicate_reversed;
    caps_without_area_are_resolved: inject::caps;
    needles_are_resolved: inject::needles;
    fins_are_dropped: inject::fins;
    t_junctions_are_stitched: inject::t_junctions;
    points_that_are_not_finite_are_dropped: inject::not_finite;
    bad_indices_are_dropped: inject::bad_indices;
    isolated_vertices_are_dropped: inject::isolated;
    everything_at_once_but_contact_is_repaired: inject::all_at_once;
    everything_at_once_but_contact_with_jitter_is_repaired: inject::all_at_once_jittered;
}

/// Puts faults into shapes that touch something: what is not of the truth touches it.
fn every_contact(touching: fn(&Truth, u64) -> Option<(Truth, PolygonSoup)>, fault: fn(&mut Faulty)) -> usize {
    let (mut igl, mut failed, mut passed) = (Igl::start(), Vec::new(), 0);
    for truth in truths() {
        for seed in seeds() {
            let Some((both, soup)) = touching(&truth, seed) else { continue };
            let mut faulty = Faulty::glued(&both, &soup, seed);
            fault(&mut faulty);
            let found = judged(&both, &faulty.soup(), &faulty.intact, faulty.jitter, &mut igl);
            if found.is_empty() {
                passed += 1;
            } else {
                failed.push(format!("{}, seed {seed}: {}", truth.name, found.join("; ")));
            }
        }
    }
    finish(passed, &failed);
    passed
}

fn touched(truth: &Truth, seed: u64) -> Option<(Truth, PolygonSoup)> {
    Some(inject::touched_at_an_edge(truth, &mut Noise(seed * 6271 + 5)))
}

#[test]
fn a_part_that_touches_at_an_edge_comes_apart() {
    every_contact(touched, |_| {});
}

#[test]
fn everything_at_once_is_repaired() {
    every_contact(touched, inject::all_at_once);
}

#[test]
fn everything_at_once_with_jitter_is_repaired() {
    every_contact(touched, inject::all_at_once_jittered);
}

#[test]
fn everything_at_once_is_repaired_at_solids_that_touch_at_an_edge() {
    let passed = every_contact(|truth, _| inject::touching_at_an_edge(truth), inject::all_at_once);
    assert!(passed >= 6, "only {passed} cases");
}

#[test]
fn everything_at_once_with_jitter_is_repaired_at_solids_that_touch_at_an_edge() {
    every_contact(|truth, _| inject::touching_at_an_edge(truth), inject::all_at_once_jittered);
}

#[test]
fn a_sound_shape_has_an_empty_account() {
    for truth in truths() {
        let result = solid(&shapes::soup(&truth.pool), Weld::Auto);
        assert_eq!(result.report.records, [], "{}", truth.name);
        assert!(result.pool == truth.pool && result.account.face_tally.kept == truth.pool.face_count());
    }
}

#[test]
fn solids_that_touch_at_a_vertex_come_apart() {
    let (mut igl, mut failed) = (Igl::start(), Vec::new());
    for truth in truths() {
        let (both, soup) = inject::touching_at_a_vertex(&truth);
        let found = judged(&both, &soup, &vec![true; both.pool.face_count()], 0.0, &mut igl);
        if !found.is_empty() {
            failed.push(format!("{}: {}", truth.name, found.join("; ")));
        }
    }
    finish(truths().len() - failed.len(), &failed);
}

#[test]
fn everything_at_once_with_jitter_is_repaired_at_solids_that_touch_at_a_vertex() {
    let (mut igl, mut failed) = (Igl::start(), Vec::new());
    for truth in truths() {
        let (both, soup) = inject::touching_at_a_vertex(&truth);
        let mut faulty = Faulty::glued(&both, &soup, 1);
        inject::all_at_once_jittered(&mut faulty);
        let found = judged(&both, &faulty.soup(), &faulty.intact, faulty.jitter, &mut igl);
        if !found.is_empty() {
            failed.push(format!("{}: {}", truth.name, found.join("; ")));
        }
    }
    finish(truths().len() - failed.len(), &failed);
}

#[test]
fn solids_that_touch_at_an_edge_come_apart() {
    let (mut igl, mut failed, mut met) = (Igl::start(), Vec::new(), 0);
    for truth in truths() {
        let Some((both, soup)) = inject::touching_at_an_edge(&truth) else { continue };
        met += 1;
        let found = judged(&both, &soup, &vec![true; both.pool.face_count()], 0.0, &mut igl);
        if !found.is_empty() {
            failed.push(format!("{}: {}", truth.name, found.join("; ")));
        }
    }
    assert!(met >= 6, "only {met} shapes have such an edge");
    finish(met - failed.len(), &failed);
}

#[test]
fn cavities_whose_shells_are_wound_outward_are_turned() {
    let mut igl = Igl::start();
    let truth = truths().pop().expect("nested shells");
    for flip in 0..4 {
        let mut soup = shapes::soup(&truth.pool);
        let (label, _) = truth.pool.topology().components();
        for (f, &shell) in label.iter().enumerate() {
            if flip >> shell & 1 == 1 {
                soup.polygons.reverse(f);
            }
        }
        let found = judged(&truth, &soup, &vec![true; truth.pool.face_count()], 0.0, &mut igl);
        assert_eq!(found, Faults::new(), "{flip}");
        let result = solid(&soup, Weld::Auto);
        assert_eq!(result.report.count(Kind::TurnedShell), (flip as u32).count_ones() as usize);
        assert!((result.account.after.volume.expect("closed") - truth.volume).abs() < 1e-9);
    }
}

#[test]
fn shells_that_cross_keep_their_own_volume_and_are_reported() {
    for truth in truths() {
        let soup = inject::overlapping(&truth);
        let result = solid(&soup, Weld::Auto);
        assert_eq!(honest(&soup, &result), Faults::new(), "{}", truth.name);
        assert!(result.account.solid);
        if truth.name != "nested" {
            assert_eq!(result.report.count(Kind::CrossingShell), 2, "{}", truth.name);
            assert!(result.report.count(Kind::SelfIntersection) > 0, "{}", truth.name);
            let volume = result.account.after.volume.expect("closed");
            assert!((volume / truth.volume - 2.0).abs() < 1e-9, "{}", truth.name);
        }
    }
}

#[test]
fn what_cannot_become_a_solid_is_kept_and_named_and_the_rest_is_a_solid() {
    for (name, other) in inject::hopeless() {
        let alone = shapes::soup(&other);
        let result = solid(&alone, Weld::Auto);
        assert_eq!(honest(&alone, &result), Faults::new(), "{name}");
        let kinds = [Kind::NotOrientable, Kind::OpenSheet].map(|k| result.report.count(k));
        assert_eq!(kinds.iter().sum::<usize>(), 1, "{name}: {:?}", result.report.counts());
        assert!(!result.account.solid && result.account.face_tally.kept == other.face_count(), "{name}");
        for truth in truths() {
            let mut faulty = Faulty::new(&truth, 1);
            inject::holes(&mut faulty);
            let soup = inject::beside(&Truth::new(truth.name, truth.pool.clone()), &other);
            let result = solid(&soup, Weld::Auto);
            assert_eq!(honest(&soup, &result), Faults::new(), "{name} beside {}", truth.name);
            assert!(!result.account.solid);
            assert_eq!(result.account.face_tally.kept, soup.polygons.len(), "{name} beside {}", truth.name);
        }
    }
}
