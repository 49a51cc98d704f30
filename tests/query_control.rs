//! Queries that can take long: the hook sees them progress, and stops them.

mod shapes;

use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    Cancelled, ClosestOptions, Control, Mesh, OutwardError, OutwardOptions, Progress, QueryError, Ray,
};
use shapes::Noise;
use std::fmt::Debug;
use std::ops::ControlFlow;

/// Runs a call three times: watched, stopped half-way and stopped at once.
fn watch<T: PartialEq + Debug, E: PartialEq + Debug>(
    cancelled: E,
    expected: T,
    mut call: impl FnMut(Control<'_>) -> Result<T, E>,
) {
    let mut seen: Vec<Progress> = Vec::new();
    let mut look = |p: Progress| {
        seen.push(p);
        ControlFlow::Continue(())
    };
    assert_eq!(call(Control::new(&mut look)).as_ref(), Ok(&expected));
    assert!(seen.len() > 2, "{seen:?}");
    assert!(seen.windows(2).all(|w| w[0].fraction <= w[1].fraction), "{seen:?}");
    let last = seen.last().map_or(0.0, |p| p.fraction);
    assert!(last > 0.3, "{seen:?}");
    for limit in [last / 2.0, 0.0] {
        let mut stop = |p: Progress| {
            if p.fraction >= limit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        assert_eq!(call(Control::new(&mut stop)).as_ref(), Err(&cancelled));
    }
}

fn places(count: usize) -> Vec<DVec3> {
    let mut noise = Noise(51);
    (0..count).map(|_| dvec3(noise.unit(), noise.unit(), noise.unit()) * 3.0 - 1.5).collect()
}

#[test]
fn batches_of_rays_are_watched_and_cancelled() {
    let mesh = shapes::mesh(&shapes::icosphere(1));
    let index = mesh.index();
    let rays: Vec<Ray> =
        places(50_000).into_iter().map(|p| Ray::new(p, DVec3::ONE - p).expect("a ray")).collect();
    watch(Cancelled, index.hits_batch(&rays), |control| index.hits_batch_with(&rays, control));
    watch(Cancelled, index.first_hit_batch(&rays), |control| index.first_hit_batch_with(&rays, control));
    watch(Cancelled, index.is_hit_batch(&rays), |control| index.is_hit_batch_with(&rays, control));
}

#[test]
fn batches_of_nearest_elements_and_sides_are_watched_and_cancelled() {
    let mesh = shapes::mesh(&shapes::icosphere(1));
    let solid = mesh.closed().expect("closed").index();
    let (index, points, all) = (solid.index(), places(50_000), ClosestOptions::default());
    let stopped = QueryError::Cancelled(Cancelled);
    macro_rules! watch_batch {
        ($($plain:ident $with:ident),*) => {$(
            let plain = index.$plain(&points, all).expect("asked well");
            watch(stopped, plain, |control| index.$with(&points, all, control));
        )*};
    }
    watch_batch!(
        closest_vertex_batch closest_vertex_batch_with,
        closest_edge_batch closest_edge_batch_with,
        closest_face_batch closest_face_batch_with,
        closest_face_center_batch closest_face_center_batch_with,
        closest_point_batch closest_point_batch_with
    );
    let sides = solid.contains_batch(&points).expect("asked well");
    watch(stopped, sides, |control| solid.contains_batch_with(&points, control));
    // A bad point is told even if it stands at the end.
    let mut bad = points.clone();
    bad.push(DVec3::NAN);
    assert!(matches!(index.closest_point_batch(&bad, all), Err(QueryError::NonFinitePoint(_))));
}

#[test]
fn building_an_index_is_watched_and_cancelled_and_gives_the_same() {
    let mesh = shapes::mesh(&shapes::icosphere(7));
    let ray = Ray::new(dvec3(-3.0, 0.1, 0.2), DVec3::X).expect("a ray");
    let ask = |control: Control<'_>| {
        mesh.index_with(control).map(|index| (index.hits(&ray), index.heap_bytes(), index.triangle_count()))
    };
    let plain = mesh.index();
    watch(Cancelled, (plain.hits(&ray), plain.heap_bytes(), plain.triangle_count()), ask);
    let solid = mesh.closed().expect("closed");
    let mut stop = |_: Progress| ControlFlow::Break(());
    assert!(solid.index_with(Control::new(&mut stop)).is_err());
}

#[test]
fn turning_one_large_open_part_outward_is_watched_and_cancelled() {
    let pool = shapes::grid(60);
    let turn = |mesh: &mut Mesh, control: Control<'_>| {
        mesh.orient_outward(OutwardOptions { control, ..Default::default() })
    };
    let mut mesh = shapes::mesh(&pool);
    let plain = turn(&mut mesh, Control::none()).expect("nobody cancels");
    watch(OutwardError::Cancelled(Cancelled), plain, |control| turn(&mut mesh, control));
    assert_eq!(mesh.to_indexed(), pool);
}
