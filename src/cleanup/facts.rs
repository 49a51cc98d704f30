//! The state a soup is in.

use super::pool::Pool;
use super::{CleanError, Weld};
use crate::attributes::Attributes;
use crate::geometry::measure::{Aabb, measures};
use crate::parallel::both;
use crate::report::Kind;
use crate::{Control, PolygonSoup};
use std::collections::BTreeMap;

/// What [`inspect`] finds: the facts of a soup after welding, nothing repaired.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Facts {
    /// Vertices as the soup states them.
    pub vertices: usize,
    /// Faces as the soup states them.
    pub faces: usize,
    /// Vertices that faces name, after the weld.
    pub used_vertices: usize,
    /// How many faces the soup states of each degree.
    pub face_degrees: BTreeMap<usize, usize>,
    /// Faces joined across edges.
    pub components: usize,
    /// Edges with one face.
    pub boundary_edges: usize,
    /// Connected pieces of the boundary.
    pub boundary_loops: usize,
    /// Edges with three or more faces.
    pub nonmanifold_edges: usize,
    /// Pinched vertices: their faces fall into several fans.
    pub nonmanifold_vertices: usize,
    /// Two-face edges whose faces run the same way along it.
    pub conflicting_edges: usize,
    /// Faces that name a vertex twice after the weld.
    pub degenerate_faces: usize,
    /// Faces with the same corner cycle, either way, as an earlier one.
    pub duplicate_faces: usize,
    /// Vertices that no face names, in the soup.
    pub isolated_vertices: usize,
    /// Faces that name a vertex that does not exist.
    pub out_of_range_faces: usize,
    /// Faces with fewer than three corners, in the soup.
    pub short_faces: usize,
    /// Vertices with a NaN or infinite coordinate.
    pub nonfinite_vertices: usize,
    /// Whether there is a face and every edge has exactly two.
    pub closed: bool,
    /// Whether no edge has three or more faces and no vertex is pinched.
    pub manifold: bool,
    /// Whether no edge conflicts.
    pub oriented: bool,
    /// Whether reversing faces could make all two-face edges agree.
    pub orientable: bool,
    /// Used vertices, less edges, plus faces.
    pub euler_characteristic: i64,
    /// The number of handles; `None` unless closed, manifold, orientable and of one component.
    pub genus: Option<u64>,
    /// The area of all faces, in square units.
    pub area: f64,
    /// The signed enclosed volume in cubic units; `None` unless closed and oriented.
    pub volume: Option<f64>,
    /// The smallest box around all finite vertices; `None` if there are none.
    pub bbox: Option<Aabb>,
}

/// Tells what state a soup is in, after a weld. Nothing is repaired: faces that name a vertex twice enter the topology
/// as clean-up would repair them and are counted, faces that cannot enter it are counted apart. O(corners), with a
/// sort of faces that share their lowest edge.
///
/// # Errors
/// [`CleanError`]: never because of what the soup holds.
///
/// # Examples
/// ```
/// use meshwright::{PolygonSoup, Polygons, cleanup::{Weld, inspect}, glam::DVec3};
/// let triangle = Polygons::from_triangles(&[[0, 1, 2]]);
/// let facts = inspect(&PolygonSoup::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], triangle), Weld::Exact)?;
/// assert_eq!((facts.boundary_edges, facts.closed, facts.area), (3, false, 0.5));
/// # Ok::<(), meshwright::cleanup::CleanError>(())
/// ```
pub fn inspect(soup: &PolygonSoup, weld: Weld) -> Result<Facts, CleanError> {
    inspect_with(soup, weld, Control::none())
}

/// As [`inspect`], with a progress-and-cancel hook.
///
/// # Errors
/// As [`inspect`]; when cancelled.
///
/// # Examples
/// ```
/// use meshwright::{Control, PolygonSoup, Progress, cleanup::{CleanError, Weld, inspect_with}};
/// use std::ops::ControlFlow;
/// let mut stop = |_: Progress| ControlFlow::Break(());
/// let refused = inspect_with(&PolygonSoup::default(), Weld::Exact, Control::new(&mut stop));
/// assert!(matches!(refused, Err(CleanError::Cancelled(_))));
/// ```
pub fn inspect_with(soup: &PolygonSoup, weld: Weld, mut control: Control<'_>) -> Result<Facts, CleanError> {
    control.report("weld", 0.0)?;
    let mut pool = Pool::new(soup, weld, &mut control)?;
    control.report("match edges", 0.4)?;
    let count = |kind| pool.report.count(kind);
    let mut facts = Facts {
        vertices: soup.positions.len(),
        faces: soup.polygons.len(),
        degenerate_faces: pool.degenerate_faces,
        out_of_range_faces: count(Kind::OutOfRangeFace),
        short_faces: count(Kind::ShortFace),
        nonfinite_vertices: count(Kind::NonFiniteVertex),
        bbox: Aabb::around(pool.positions.iter().copied()),
        ..Facts::default()
    };
    let mut named = vec![false; soup.positions.len()];
    for face in soup.polygons.iter() {
        *facts.face_degrees.entry(face.len()).or_insert(0) += 1;
        for &v in face {
            if let Some(named) = named.get_mut(v as usize) {
                *named = true;
            }
        }
    }
    facts.isolated_vertices = named.iter().filter(|n| !**n).count();

    let indexed = pool.lend(Attributes::NONE);
    let topology = indexed.topology();
    control.report("join components", 0.6)?;
    let ((components, pieces), pinched) =
        both(|| (topology.components().1, topology.boundary_pieces()), || topology.pinched_vertices().len());
    control.report("measure", 0.8)?;
    let ((duplicates, measures), orientable) = both(
        || (topology.duplicate_faces().len(), measures(indexed.positions(), indexed.polygons())),
        || topology.orientable().is_ok(),
    );
    facts.used_vertices = indexed.vertex_count() - topology.isolated_vertices().len();
    facts.components = components;
    facts.boundary_edges = topology.boundary_edges().count();
    facts.boundary_loops = pieces;
    facts.nonmanifold_edges = topology.nonmanifold_edges().count();
    facts.nonmanifold_vertices = pinched;
    facts.conflicting_edges = topology.conflicting_edges().count();
    facts.duplicate_faces = duplicates;
    facts.closed = topology.is_closed();
    facts.manifold = facts.nonmanifold_edges == 0 && pinched == 0;
    facts.oriented = facts.conflicting_edges == 0;
    facts.orientable = orientable;
    facts.euler_characteristic =
        facts.used_vertices as i64 - topology.edge_count() as i64 + indexed.face_count() as i64;
    let one_surface = facts.closed && facts.manifold && orientable && components == 1;
    facts.genus = one_surface.then(|| ((2 - facts.euler_characteristic) / 2).unsigned_abs());
    facts.area = measures.area;
    facts.volume = (facts.closed && facts.oriented).then_some(measures.volume);
    Ok(facts)
}
