//! A plan carried out on the pool.

use super::{NewCorner, Plan};
use crate::MAX_ELEMENTS;
use crate::Polygons;
use crate::cleanup::CleanError;
use crate::cleanup::pool::{Blend, Pool};
use crate::matching::NONE;
use crate::report::{Element, Kind, Record, Step};
use crate::topology::{FaceOf, next_corner};
use glam::DVec3;

/// Carries a plan out; how many naked edges were joined and corners inserted, and how far anything moved.
pub(super) fn apply(pool: &mut Pool<'_>, plan: Plan) -> Result<(usize, f64), CleanError> {
    // A triangle that gains corners becomes three corners for each.
    let elements = pool.corner_source.len() + 3 * plan.cuts.len();
    if elements > MAX_ELEMENTS {
        return Err(CleanError::TooLarge { elements });
    }
    record(pool, &plan);
    let places: Vec<(u32, DVec3)> =
        plan.places.iter().map(|&(v, kept)| (v, pool.positions[kept as usize])).collect();
    note_merges(pool, &plan, &places);
    for (v, place) in places {
        pool.positions[v as usize] = place;
    }
    insert_corners(pool, &plan);
    merge_vertices(pool, &plan.into);
    Ok((plan.cracks.len() + plan.cuts.len(), plan.moved))
}

fn record(pool: &mut Pool<'_>, plan: &Plan) {
    let face_of = FaceOf::new(&pool.polygons);
    let ends = |pool: &Pool<'_>, c: u32| {
        let next = next_corner(&pool.polygons, face_of.face(c as usize), c as usize);
        [c as usize, next].map(|c| (pool.named_at(c), pool.positions[pool.polygons.corners()[c] as usize]))
    };
    let mut records = Vec::new();
    for &c in &plan.cracks {
        let [(a, p), (b, q)] = ends(pool, c);
        let element = Element::Edge([a.min(b), a.max(b)]);
        records.push(Record::new(Step::Stitch, Kind::StitchedEdge, element, Some(p * 0.5 + q * 0.5)));
    }
    for cut in &plan.cuts {
        let [(a, _), (b, _)] = ends(pool, cut.corner);
        let element = Element::VertexOnEdge([pool.named(cut.vertex), a.min(b), a.max(b)]);
        let place = pool.positions[cut.vertex as usize];
        records.push(Record::new(Step::Stitch, Kind::TJunction, element, Some(place)));
    }
    records.sort_by_key(|r| r.element);
    pool.report.records.extend(records);
}

/// Notes the soup's vertices that stand where they stood, and will not any more.
fn note_merges(pool: &mut Pool<'_>, plan: &Plan, places: &[(u32, DVec3)]) {
    let mut goes: Vec<bool> = (0..).zip(&plan.into).map(|(v, &into): (u32, _)| into != v).collect();
    places.iter().for_each(|&(v, _)| goes[v as usize] = true);
    for (v, &at) in (0u32..).zip(&pool.vertex_of) {
        if at != NONE && goes[at as usize] && pool.positions[at as usize] == pool.soup.positions[v as usize] {
            pool.stitched.push(v);
        }
    }
}

/// A corner of a face in the making.
#[derive(Clone, Copy, Debug)]
struct Corner {
    vertex: u32,
    source: u32,
}

fn insert_corners(pool: &mut Pool<'_>, plan: &Plan) {
    if plan.cuts.is_empty() {
        return;
    }
    let soup_corners = pool.soup.polygons.corners().len() as u32;
    let more = plan.cuts.len();
    let mut polygons =
        Polygons::with_capacity(pool.polygons.len() + more, pool.corner_source.len() + 3 * more);
    let mut sources = Vec::with_capacity(pool.corner_source.len() + 3 * more);
    let mut faces = Vec::with_capacity(pool.polygons.len() + more);
    let mut cuts = plan.cuts.iter().peekable();
    let mut sides: Vec<Vec<Corner>> = Vec::new();
    for (f, face) in pool.polygons.iter().enumerate() {
        let first = pool.polygons.starts()[f];
        let source = pool.face_source[f];
        let old = |i: usize| Corner { vertex: face[i], source: pool.corner_source[first + i] };
        if cuts.peek().is_none_or(|c| c.corner as usize >= first + face.len()) {
            polygons.push(face.iter().copied());
            sources.extend((0..face.len()).map(|i| old(i).source));
            faces.push(source);
            continue;
        }
        sides.clear();
        for i in 0..face.len() {
            let mut side = Vec::new();
            while let Some(&&NewCorner { at, vertex, .. }) =
                cuts.peek().filter(|c| c.corner as usize == first + i)
            {
                cuts.next();
                let ends = [old(i).source, old((i + 1) % face.len()).source];
                side.push(Corner { vertex, source: soup_corners + pool.blends.len() as u32 });
                pool.blends.push(Blend { vertex: pool.vertex_source[vertex as usize], ends, at });
            }
            sides.push(side);
        }
        let mut push = |corners: &[Corner]| {
            polygons.push(corners.iter().map(|c| c.vertex));
            sources.extend(corners.iter().map(|c| c.source));
            faces.push(source);
        };
        if let [a, b, c] = &sides[..] {
            let at = |c: &Corner| pool.positions[c.vertex as usize];
            cut_triangle([old(0), old(1), old(2)], [a, b, c], &at, &mut |t| push(&t));
        } else {
            let corners: Vec<Corner> = (0..face.len())
                .flat_map(|i| std::iter::once(old(i)).chain(sides[i].iter().copied()))
                .collect();
            push(&corners);
        }
    }
    pool.polygons = polygons;
    pool.corner_source = sources;
    pool.face_source = faces;
}

/// Cuts a triangle with further corners on its sides (side `i` runs from corner `i` to the next) into triangles of which
/// none has all its corners on one side.
fn cut_triangle<C: Copy>(
    [a, b, c]: [C; 3],
    sides: [&[C]; 3],
    at: &impl Fn(&C) -> DVec3,
    out: &mut impl FnMut([C; 3]),
) {
    let [ab, bc, ca] = sides;
    match (ab.is_empty(), bc.is_empty(), ca.is_empty()) {
        (_, true, _) => strip(a, ab, b, c, ca, at, out),
        (_, _, true) => strip(b, bc, c, a, ab, at, out),
        (true, _, _) => strip(c, ca, a, b, bc, at, out),
        _ => {
            // From the middle of one side to the corner opposite.
            let (before, rest) = ab.split_at(ab.len() / 2);
            let (m, behind) = (rest[0], &rest[1..]);
            strip(a, before, m, c, ca, at, out);
            strip(b, bc, c, m, behind, at, out);
        }
    }
}

/// The triangle from `apex` to `left` and `right`, with corners from the apex to the left and from the right to the apex,
/// in strips across from one side to the other; of the two ways on, the shorter.
fn strip<C: Copy>(
    apex: C,
    to_left: &[C],
    left: C,
    right: C,
    from_right: &[C],
    at: &impl Fn(&C) -> DVec3,
    out: &mut impl FnMut([C; 3]),
) {
    let lefts: Vec<C> = to_left.iter().copied().chain([left]).collect();
    let rights: Vec<C> = from_right.iter().rev().copied().chain([right]).collect();
    let (mut i, mut j) = (0, 0);
    out([apex, lefts[0], rights[0]]);
    loop {
        let across = |i: usize, j: usize| Some(at(lefts.get(i)?).distance(at(rights.get(j)?)));
        match (across(i + 1, j), across(i, j + 1)) {
            (None, None) => return,
            (Some(on_left), on_right) if on_right.is_none_or(|on_right| on_left <= on_right) => {
                out([lefts[i], lefts[i + 1], rights[j]]);
                i += 1;
            }
            _ => {
                out([lefts[i], rights[j + 1], rights[j]]);
                j += 1;
            }
        }
    }
}

/// Takes out vertices that become one with a lower one, and numbers the rest in order.
fn merge_vertices(pool: &mut Pool<'_>, into: &[u32]) {
    let mut number = vec![NONE; into.len()];
    let mut next = 0;
    for (v, &low) in into.iter().enumerate() {
        if low as usize == v {
            number[v] = next;
            next += 1;
        } else {
            number[v] = number[low as usize];
        }
    }
    let stays = |v: usize| into[v] as usize == v;
    let mut v = 0;
    pool.positions.retain(|_| (stays(v), v += 1).0);
    v = 0;
    pool.vertex_source.retain(|_| (stays(v), v += 1).0);
    pool.polygons.map_corners(|v| number[v as usize]);
    pool.vertex_of.iter_mut().filter(|v| **v != NONE).for_each(|v| *v = number[*v as usize]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_triangle_cut_has_no_triangle_without_area_and_covers_it(counts in [0usize..6, 0usize..6, 0usize..6]) {
            let corners = [dvec3(0., 0., 0.), dvec3(5., 1., 0.), dvec3(2., 4., 0.)];
            let side = |i: usize| -> Vec<DVec3> {
                let (a, b) = (corners[i], corners[(i + 1) % 3]);
                (1..=counts[i]).map(|k| a.lerp(b, k as f64 / (counts[i] + 1) as f64)).collect()
            };
            let sides = [side(0), side(1), side(2)];
            let mut total = 0.0;
            let mut count = 0;
            cut_triangle(corners, [&sides[0], &sides[1], &sides[2]], &|p| *p, &mut |[a, b, c]| {
                let area = (b - a).cross(c - a).z / 2.0;
                assert!(area > 1e-3, "{a} {b} {c}");
                total += area;
                count += 1;
            });
            prop_assert!((total - 9.0).abs() < 1e-9);
            prop_assert_eq!(count, 1 + counts.iter().sum::<usize>());
        }
    }
}
