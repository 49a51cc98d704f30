//! The second rung: a valid vertex pool.

use crate::geometry::normals::{self, NormalWeight};
use crate::{MAX_ELEMENTS, PolygonSoup, Polygons};
use glam::DVec3;
use std::fmt;

/// A valid vertex pool: finite positions, and faces of three or more distinct vertices that all exist.
///
/// Says nothing about how faces meet; [`topology`](Self::topology) tells, and [`Mesh::build`](crate::Mesh::build)
/// demands. Vertices that no face names are legal.
///
/// # Examples
/// ```
/// use meshwright::{IndexedMesh, Polygons, glam::dvec3};
/// let positions = vec![dvec3(0., 0., 0.), dvec3(1., 0., 0.), dvec3(1., 1., 0.), dvec3(0., 1., 0.)];
/// let square = IndexedMesh::new(positions, Polygons::from(vec![vec![0, 1, 2, 3]]))?;
/// assert_eq!(square.topology().boundary_edges().count(), 4);
/// # Ok::<(), meshwright::IndexedError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct IndexedMesh {
    positions: Vec<DVec3>,
    polygons: Polygons,
    /// Given vertex normals, one per position.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    normals: Option<Vec<DVec3>>,
}

/// Why positions and faces are not a valid vertex pool: every reason, in the order of vertices, then faces.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct IndexedError {
    /// What is wrong and where; never empty.
    pub defects: Vec<IndexedDefect>,
}

impl fmt::Display for IndexedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        list(f, "not a valid vertex pool", &self.defects)
    }
}

/// Writes `title: first, second, third and 7 more`.
pub(crate) fn list<T: fmt::Display>(f: &mut fmt::Formatter<'_>, title: &str, items: &[T]) -> fmt::Result {
    const SHOWN: usize = 3;
    write!(f, "{title}")?;
    for (i, item) in items.iter().take(SHOWN).enumerate() {
        write!(f, "{} {item}", if i == 0 { ":" } else { "," })?;
    }
    match items.len().saturating_sub(SHOWN) {
        0 => Ok(()),
        more => write!(f, " and {more} more"),
    }
}

/// One reason why something is not a valid vertex pool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum IndexedDefect {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} is not finite")]
    NonFinitePosition {
        /// The vertex.
        vertex: u32,
    },
    /// A face has fewer than three corners.
    #[error("face {face} has {corners} corners")]
    TooFewCorners {
        /// The face.
        face: u32,
        /// How many it has.
        corners: u32,
    },
    /// A corner names a vertex that does not exist.
    #[error("corner {corner} of face {face} names vertex {index}, which does not exist")]
    IndexOutOfRange {
        /// The face.
        face: u32,
        /// The corner, counted from the face's first.
        corner: u32,
        /// The index it holds.
        index: u32,
    },
    /// A face names a vertex twice.
    #[error("face {face} names vertex {vertex} again at corner {corner}")]
    RepeatedCorner {
        /// The face.
        face: u32,
        /// The later corner.
        corner: u32,
        /// The vertex it repeats.
        vertex: u32,
    },
    /// Given normals are not one per vertex.
    #[error("{normals} normals for {vertices} vertices")]
    NormalCount {
        /// The number of normals given.
        normals: usize,
        /// The number of vertices.
        vertices: usize,
    },
    /// A given normal is NaN or infinite.
    #[error("the normal of vertex {vertex} is not finite")]
    NonFiniteNormal {
        /// The vertex.
        vertex: u32,
    },
    /// More than [`MAX_ELEMENTS`] vertices, faces or corners.
    #[error("{elements} elements are more than a mesh can number")]
    TooLarge {
        /// The number of vertices, faces or corners.
        elements: usize,
    },
}

impl IndexedMesh {
    /// Checks positions and faces.
    ///
    /// # Errors
    /// [`IndexedError`] with every defect. O(corners).
    pub fn new(positions: Vec<DVec3>, polygons: Polygons) -> Result<Self, IndexedError> {
        match defects(&positions, &polygons) {
            defects if defects.is_empty() => Ok(Self { positions, polygons, normals: None }),
            defects => Err(IndexedError { defects }),
        }
    }

    /// Checks triangles, the common case.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn from_triangles(positions: Vec<DVec3>, triangles: &[[u32; 3]]) -> Result<Self, IndexedError> {
        Self::new(positions, Polygons::from_triangles(triangles))
    }

    /// The same mesh with given vertex normals, kept as they are.
    ///
    /// # Errors
    /// [`IndexedDefect::NormalCount`] or [`IndexedDefect::NonFiniteNormal`].
    pub fn with_normals(self, normals: Vec<DVec3>) -> Result<Self, IndexedError> {
        let defects: Vec<_> = if normals.len() != self.positions.len() {
            vec![IndexedDefect::NormalCount { normals: normals.len(), vertices: self.positions.len() }]
        } else {
            let bad = normals.iter().enumerate().filter(|(_, n)| !n.is_finite());
            bad.map(|(i, _)| IndexedDefect::NonFiniteNormal { vertex: i as u32 }).collect()
        };
        if defects.is_empty() {
            Ok(Self { normals: Some(normals), ..self })
        } else {
            Err(IndexedError { defects })
        }
    }

    /// A pool whose producer has already seen to every promise.
    pub(crate) fn trusted(positions: Vec<DVec3>, polygons: Polygons, normals: Option<Vec<DVec3>>) -> Self {
        debug_assert_eq!(defects(&positions, &polygons), []);
        Self { positions, polygons, normals }
    }

    /// Vertex positions.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Faces, as indices into [`positions`](Self::positions).
    pub fn polygons(&self) -> &Polygons {
        &self.polygons
    }

    /// The vertex normals that were given, if any were.
    pub fn normals(&self) -> Option<&[DVec3]> {
        self.normals.as_deref()
    }

    /// The number of vertices, isolated ones included.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// The number of faces.
    pub fn face_count(&self) -> usize {
        self.polygons.len()
    }

    /// Unit vertex normals computed from the faces, weighted by face area or by corner angle; zero where there is no
    /// face or where the faces cancel. O(corners).
    ///
    /// Angle weights do not depend on how a surface is cut into faces: Thürmer and Wüthrich, "Computing Vertex Normals
    /// from Polygonal Facets", Journal of Graphics Tools 3(1), 1998.
    pub fn vertex_normals(&self, weight: NormalWeight) -> Vec<DVec3> {
        normals::vertex_normals(&self.positions, &self.polygons, weight)
    }

    /// Applies `f` to every position, in order.
    ///
    /// # Errors
    /// [`IndexedDefect::NonFinitePosition`] for every result that is not finite; then nothing has changed.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, NormalWeight, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let pool = IndexedMesh::from_triangles(points, &[[0, 1, 2]])?;
    /// # let mut mesh = Mesh::build(&pool)?;
    /// let mut pool = pool;
    /// pool.map_positions(|p| p * 2.0)?;
    /// assert_eq!(pool.area(), 2.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn map_positions(&mut self, f: impl FnMut(DVec3) -> DVec3) -> Result<(), IndexedError> {
        let moved: Vec<DVec3> = self.positions.iter().copied().map(f).collect();
        let defects: Vec<_> = non_finite(&moved).collect();
        if !defects.is_empty() {
            return Err(IndexedError { defects });
        }
        self.positions = moved;
        Ok(())
    }

    /// The same mesh with the winding of every face reversed (each keeps its first corner) and given normals negated.
    pub fn reversed(mut self) -> Self {
        for f in 0..self.polygons.len() {
            self.polygons.reverse(f);
        }
        for n in self.normals.iter_mut().flatten() {
            *n = -*n;
        }
        self
    }

    /// Positions, faces and given normals.
    pub fn into_parts(self) -> (Vec<DVec3>, Polygons, Option<Vec<DVec3>>) {
        (self.positions, self.polygons, self.normals)
    }
}

impl TryFrom<PolygonSoup> for IndexedMesh {
    type Error = IndexedError;

    /// Checks a soup. Colours, corner data and groups are left behind.
    fn try_from(soup: PolygonSoup) -> Result<Self, IndexedError> {
        let mesh = Self::new(soup.positions, soup.polygons)?;
        if soup.vertex_normals.is_empty() { Ok(mesh) } else { mesh.with_normals(soup.vertex_normals) }
    }
}

impl From<IndexedMesh> for PolygonSoup {
    fn from(mesh: IndexedMesh) -> Self {
        let vertex_normals = mesh.normals.unwrap_or_default();
        Self { vertex_normals, ..Self::new(mesh.positions, mesh.polygons) }
    }
}

fn non_finite(positions: &[DVec3]) -> impl Iterator<Item = IndexedDefect> + '_ {
    let bad = positions.iter().enumerate().filter(|(_, p)| !p.is_finite());
    bad.map(|(i, _)| IndexedDefect::NonFinitePosition { vertex: i as u32 })
}

fn defects(positions: &[DVec3], polygons: &Polygons) -> Vec<IndexedDefect> {
    let largest = positions.len().max(polygons.len()).max(polygons.corners().len());
    if largest > MAX_ELEMENTS {
        return vec![IndexedDefect::TooLarge { elements: largest }];
    }
    let mut found: Vec<_> = non_finite(positions).collect();
    let count = positions.len();
    // The face that last named each vertex; only faces of more than three corners need it.
    let mut named_by: Vec<u32> = Vec::new();
    for (f, corners) in polygons.iter().enumerate() {
        let face = f as u32;
        if let &[a, b, c] = corners
            && (a.max(b).max(c) as usize) < count
            && a != b
            && b != c
            && c != a
        {
            continue;
        }
        if corners.len() < 3 {
            found.push(IndexedDefect::TooFewCorners { face, corners: corners.len() as u32 });
        }
        if named_by.is_empty() {
            named_by = vec![u32::MAX; count];
        }
        for (corner, &index) in corners.iter().enumerate() {
            let corner = corner as u32;
            match named_by.get_mut(index as usize) {
                None => found.push(IndexedDefect::IndexOutOfRange { face, corner, index }),
                Some(by) if *by == face => {
                    found.push(IndexedDefect::RepeatedCorner { face, corner, vertex: index })
                }
                Some(by) => *by = face,
            }
        }
    }
    found
}
