//! Sheets that hang on a surface: what splitting left of edges with three or more faces.

use super::CleanError;
use super::drop::drop_parts;
use super::open::hopeless;
use super::step::{Areas, Parts, unchanged};
use super::weld::weld;
use crate::matching::NONE;
use crate::report::{Kind, Outcome, Step};
use crate::{Control, Mesh};
use std::collections::BTreeSet;

/// Drops fins; how many. A fin is an open part, faces joined across edges, with these two properties:
/// - it hangs on another part, its host: an edge of its boundary lies at an inner edge of the host, both ends closer than
///   `tolerance` (0 for equal coordinates). That is how clean-up leaves what it does not pair at an edge with three or
///   more faces; a wall within a solid is a fin too.
/// - its area is at most half of that of the bodies among its hosts, and those they hang on in turn. No flat wall within a
///   solid has more, and a body with holes is no fin of something small that touches it. Sheets, and what
///   cannot be oriented, are no bodies: on them nothing is dropped.
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
    let hosts = hosts(mesh, &parts, tolerance)?;
    let areas = Areas::of(mesh);
    let area: Vec<f64> = parts.faces.iter().map(|faces| areas.scaled(faces)).collect();
    let is_body: Vec<bool> = hopeless(mesh, &parts)?.iter().map(Option::is_none).collect();
    let fins: Vec<usize> = parts
        .open()
        .filter(|&part| {
            let held: f64 =
                held_by(part, &hosts).iter().filter(|&&host| is_body[host]).map(|&host| area[host]).sum();
            held > 0.0 && area[part] <= 0.5 * held
        })
        .collect();
    Ok(drop_parts(mesh, &parts, &fins, (Step::DropFins, Kind::Fin)))
}

/// For each part the parts at whose inner edges its boundary lies, ascending.
fn hosts(mesh: &Mesh, parts: &Parts, tolerance: f64) -> Result<Vec<Vec<usize>>, CleanError> {
    // Vertices at one place, by slot.
    let slots: Vec<u32> = mesh.vertices.live().collect();
    let positions: Vec<_> = slots.iter().map(|&v| mesh.positions[v as usize]).collect();
    let merged = weld(&positions, Some(tolerance), &mut Control::none())?;
    let mut place = vec![NONE; mesh.vertices.slot_count()];
    slots.iter().zip(merged).for_each(|(&v, to)| place[v as usize] = to);
    let ends = |h: u32| {
        let [a, b] = [h, h ^ 1].map(|h| place[mesh.origin[h as usize] as usize]);
        [a.min(b), a.max(b)]
    };

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
    Ok(hosts)
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
