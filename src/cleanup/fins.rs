//! Sheets that hang on a surface: what splitting left of edges with three or more faces.

use super::CleanError;
use super::drop::drop_parts;
use super::open::hopeless;
use super::step::{Areas, Parts, unchanged};
use super::weld::weld;
use crate::matching::NONE;
use crate::report::{Kind, Outcome, Step};
use crate::topology::UnionFind;
use crate::{Control, Mesh};
use std::collections::BTreeSet;

/// Drops fins; how many. A fin is an open part, faces joined across edges, with these two properties:
/// - it hangs on another part, its host: an edge of its boundary lies at an inner edge of the host, both ends closer than
///   `tolerance` (0 for equal coordinates). That is how clean-up leaves what it does not pair at an edge with three or
///   more faces; a wall within a solid is a fin too.
/// - its area is at most half of that of the bodies among its hosts, and those they hang on in turn. No flat wall within a
///   solid has more, and a body with holes is no fin of something small that touches it. Sheets, and what
///   cannot be oriented, are no bodies: on them nothing is dropped. What is no body itself is held against the bodies as
///   well that its hosts touch along edges: a flag on a small solid that stands on a large one is a fin.
///
/// A record for each face, in the numbers of the mesh before. O(n log n), linear without open parts.
///
/// # Errors
/// [`CleanError::BadTolerance`]; nothing has changed then.
///
/// # Examples
/// ```
/// use meshwright::{PolygonSoup, Polygons, cleanup::{CleanOptions, clean, drop_fins}, glam::DVec3};
/// // A tetrahedron with a fin on one edge.
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.5, -0.2, -0.1)];
/// let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 1, 4]];
/// let mut mesh = clean(&PolygonSoup::new(points, Polygons::from_triangles(&faces)), CleanOptions::default())?.value;
/// assert!(!mesh.is_closed());
/// assert_eq!(drop_fins(&mut mesh, 0.0)?.value, 1);
/// assert!(mesh.is_closed());
/// # Ok::<(), meshwright::cleanup::CleanError>(())
/// ```
pub fn drop_fins(mesh: &mut Mesh, tolerance: f64) -> Result<Outcome<usize>, CleanError> {
    if tolerance.is_nan() || tolerance < 0.0 || tolerance.is_infinite() {
        return Err(CleanError::BadTolerance(tolerance));
    }
    if mesh.is_closed() {
        return Ok(unchanged(mesh, 0, Step::DropFins));
    }
    let parts = Parts::of(mesh);
    if parts.len() == 1 {
        return Ok(unchanged(mesh, 0, Step::DropFins));
    }
    let place = places(mesh, tolerance)?;
    let hosts = hosts(mesh, &parts, &place);
    let areas = Areas::of(mesh);
    let area: Vec<f64> = parts.faces.iter().map(|faces| areas.scaled(faces)).collect();
    let is_body: Vec<bool> = hopeless(mesh, &parts)?.iter().map(Option::is_none).collect();
    let mut touching = None;
    let mut fins = Vec::new();
    for part in parts.open() {
        let bodies: Vec<usize> = held_by(part, &hosts).into_iter().filter(|&host| is_body[host]).collect();
        let is_held = |held: f64| held > 0.0 && area[part] <= 0.5 * held;
        if is_held(bodies.iter().map(|&host| area[host]).sum()) {
            fins.push(part);
        } else if !bodies.is_empty() && !is_body[part] {
            let (of, sums) =
                touching.get_or_insert_with(|| touching_bodies(mesh, &parts, &place, &area, &is_body));
            let groups: BTreeSet<u32> = bodies.iter().map(|&host| of[host]).collect();
            if is_held(groups.iter().map(|&group| sums[group as usize]).sum()) {
                fins.push(part);
            }
        }
    }
    Ok(drop_parts(mesh, &parts, &fins, (Step::DropFins, Kind::Fin)))
}

/// A number for each vertex slot, which those at one place share.
fn places(mesh: &Mesh, tolerance: f64) -> Result<Vec<u32>, CleanError> {
    let slots: Vec<u32> = mesh.vertices.live().collect();
    let positions: Vec<_> = slots.iter().map(|&v| mesh.positions[v as usize]).collect();
    let merged = weld(&positions, Some(tolerance), &mut Control::none())?;
    let mut place = vec![NONE; mesh.vertices.slot_count()];
    slots.iter().zip(merged).for_each(|(&v, to)| place[v as usize] = to);
    Ok(place)
}

/// The places of a half-edge's ends, the lower first.
fn ends(mesh: &Mesh, place: &[u32], h: u32) -> [u32; 2] {
    let [a, b] = [h, h ^ 1].map(|h| place[mesh.origin[h as usize] as usize]);
    [a.min(b), a.max(b)]
}

/// Bodies in groups that touch along edges: the group of each part, and the area of each group.
fn touching_bodies(
    mesh: &Mesh,
    parts: &Parts,
    place: &[u32],
    area: &[f64],
    is_body: &[bool],
) -> (Vec<u32>, Vec<f64>) {
    let mut count = vec![0u32; place.len()];
    mesh.vertices.live().for_each(|v| count[place[v as usize] as usize] += 1);
    let part_of = |h: u32| mesh.face[[h, h ^ 1][usize::from(mesh.face[h as usize] == NONE)] as usize];
    let edges = mesh.edges.live().map(|e| (ends(mesh, place, 2 * e), parts.of[part_of(2 * e) as usize]));
    let is_shared = |(ends, part): &([u32; 2], u32)| {
        is_body[*part as usize] && ends.iter().all(|&p| count[p as usize] > 1)
    };
    let mut shared: Vec<([u32; 2], u32)> = edges.filter(is_shared).collect();
    shared.sort_unstable();
    let mut groups = UnionFind::new(area.len());
    for at_one_place in shared.chunk_by(|a, b| a.0 == b.0) {
        at_one_place.windows(2).for_each(|pair| groups.join(pair[0].1, pair[1].1));
    }
    let of: Vec<u32> = (0..area.len() as u32).map(|part| groups.root(part)).collect();
    let mut sums = vec![0.0; area.len()];
    (0..area.len()).filter(|&part| is_body[part]).for_each(|part| sums[of[part] as usize] += area[part]);
    (of, sums)
}

/// For each part the parts at whose inner edges its boundary lies, ascending.
fn hosts(mesh: &Mesh, parts: &Parts, place: &[u32]) -> Vec<Vec<usize>> {
    let ends = |h: u32| ends(mesh, place, h);
    let mut rim: Vec<([u32; 2], u32)> =
        mesh.boundary_slots().map(|h| (ends(h), parts.of[mesh.face[h as usize ^ 1] as usize])).collect();
    rim.sort_unstable();
    let mut is_rim = vec![false; mesh.vertices.slot_count()];
    rim.iter().flat_map(|r| r.0).for_each(|p| is_rim[p as usize] = true);
    let mut hosts = vec![Vec::new(); parts.len()];
    for h in mesh.edges.live().map(|e| 2 * e) {
        let [f, g] = [h, h ^ 1].map(|h| mesh.face[h as usize]);
        let at = ends(h);
        if f == NONE || g == NONE || !at.iter().all(|&p| is_rim[p as usize]) {
            continue;
        }
        let host = parts.of[f as usize];
        let first = rim.partition_point(|r| r.0 < at);
        for &(_, part) in rim[first..].iter().take_while(|r| r.0 == at).filter(|r| r.1 != host) {
            hosts[part as usize].push(host as usize);
        }
    }
    for of in &mut hosts {
        of.sort_unstable();
        of.dedup();
    }
    hosts
}

/// All that a part hangs on, directly and in turn, without the part itself.
fn held_by(part: usize, hosts: &[Vec<usize>]) -> BTreeSet<usize> {
    let mut held = BTreeSet::new();
    let mut todo = hosts[part].clone();
    while let Some(host) = todo.pop() {
        if host != part && held.insert(host) {
            todo.extend(&hosts[host]);
        }
    }
    held
}
