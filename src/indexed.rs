//! The second rung: a valid vertex pool.

use crate::attributes::{Attributes, from_soup};
use crate::geometry::normals::{self, NormalWeight};
use crate::report::Attribute;
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
    /// Fit the positions and faces, and are finite; absent when there are none.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    attributes: Option<Box<Attributes>>,
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
    /// An attribute is not one per vertex, corner or face.
    #[error("{given} values of {attribute}, not {wanted}")]
    AttributeCount {
        /// Which.
        attribute: Attribute,
        /// The number of values given.
        given: usize,
        /// The number of vertices, corners or faces.
        wanted: usize,
    },
    /// A part of a colour is NaN or infinite.
    #[error("the colour of vertex {vertex} is not finite")]
    NonFiniteColor {
        /// The vertex.
        vertex: u32,
    },
    /// A value at a corner is NaN or infinite.
    #[error("{attribute} at corner {corner} of face {face} are not finite")]
    NonFiniteValue {
        /// Which.
        attribute: Attribute,
        /// The face.
        face: u32,
        /// The corner, counted from the face's first.
        corner: u32,
    },
    /// A corner refers to a value that does not exist.
    #[error("corner {corner} of face {face} refers to value {index} of {attribute}, which does not exist")]
    NoSuchValue {
        /// Which.
        attribute: Attribute,
        /// The face.
        face: u32,
        /// The corner, counted from the face's first.
        corner: u32,
        /// The index it holds.
        index: u32,
    },
    /// A face is in a group that does not exist.
    #[error("face {face} is in group {group}, which does not exist")]
    NoSuchGroup {
        /// The face.
        face: u32,
        /// The group.
        group: u32,
    },
    /// A soup's group runs past the last face.
    #[error("group {group} runs to face {end}, which does not exist")]
    GroupPastFaces {
        /// The group's place in the soup's list.
        group: usize,
        /// The end of its run.
        end: usize,
    },
    /// A face is in two of a soup's groups.
    #[error("face {face} is in two groups")]
    FaceInTwoGroups {
        /// The face.
        face: u32,
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
            defects if defects.is_empty() => Ok(Self { positions, polygons, attributes: None }),
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

    /// Checks quads; as in Rhino, one whose last corner is the third again is a triangle.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    ///
    /// # Examples
    /// ```
    /// use meshwright::{IndexedMesh, glam::DVec3};
    /// let points = vec![DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y, DVec3::NEG_Y];
    /// let pool = IndexedMesh::from_quads(points, &[[0, 1, 2, 3], [0, 4, 1, 1]])?;
    /// assert_eq!(pool.polygons()[1].len(), 3);
    /// # Ok::<(), meshwright::IndexedError>(())
    /// ```
    pub fn from_quads(positions: Vec<DVec3>, quads: &[[u32; 4]]) -> Result<Self, IndexedError> {
        Self::new(positions, Polygons::from_quads(quads))
    }

    /// The same mesh with these attributes in place of those it carried.
    ///
    /// # Errors
    /// [`IndexedError`] with every list that has not one entry per vertex, corner or face, every value that is not
    /// finite, and every face in a group that does not exist. O(corners).
    ///
    /// # Examples
    /// ```
    /// use meshwright::{Attributes, IndexedDefect, IndexedMesh, glam::DVec3};
    /// let pool = IndexedMesh::from_triangles(vec![DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]])?;
    /// let vertex_colors = Some(vec![[1.0; 4], [0.5; 4], [f32::NAN; 4]]);
    /// let refused = pool.with_attributes(Attributes { vertex_colors, ..Attributes::default() }).unwrap_err();
    /// assert_eq!(refused.defects, [IndexedDefect::NonFiniteColor { vertex: 2 }]);
    /// # Ok::<(), meshwright::IndexedError>(())
    /// ```
    pub fn with_attributes(self, attributes: Attributes) -> Result<Self, IndexedError> {
        match attributes.defects(self.positions.len(), &self.polygons) {
            defects if defects.is_empty() => Ok(self.carrying(attributes)),
            defects => Err(IndexedError { defects }),
        }
    }

    /// The same mesh with given vertex normals, kept as they are; other attributes stay.
    ///
    /// # Errors
    /// [`IndexedDefect::NormalCount`] or [`IndexedDefect::NonFiniteNormal`].
    pub fn with_normals(mut self, normals: Vec<DVec3>) -> Result<Self, IndexedError> {
        let attributes = Attributes { vertex_normals: Some(normals), ..self.take_attributes() };
        self.with_attributes(attributes)
    }

    /// A pool whose producer has already seen to every promise.
    pub(crate) fn trusted(positions: Vec<DVec3>, polygons: Polygons, normals: Option<Vec<DVec3>>) -> Self {
        debug_assert_eq!(defects(&positions, &polygons), []);
        let bare = Self { positions, polygons, attributes: None };
        match normals {
            None => bare,
            Some(_) => bare.carrying(Attributes { vertex_normals: normals, ..Attributes::NONE }),
        }
    }

    /// The pool with attributes whose producer has already seen to every promise.
    pub(crate) fn carrying(self, attributes: Attributes) -> Self {
        debug_assert_eq!(attributes.defects(self.positions.len(), &self.polygons), []);
        let attributes = (!attributes.is_empty()).then(|| Box::new(attributes));
        Self { attributes, ..self }
    }

    /// Vertex positions.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Faces, as indices into [`positions`](Self::positions).
    pub fn polygons(&self) -> &Polygons {
        &self.polygons
    }

    /// What it carries beside positions and faces.
    pub fn attributes(&self) -> &Attributes {
        static NONE: Attributes = Attributes::NONE;
        self.attributes.as_deref().unwrap_or(&NONE)
    }

    fn take_attributes(&mut self) -> Attributes {
        self.attributes.take().map_or(Attributes::NONE, |a| *a)
    }

    /// The vertex normals that were given, if any were.
    pub fn normals(&self) -> Option<&[DVec3]> {
        self.attributes().vertex_normals.as_deref()
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

    /// Applies `f` to every position, in order. Attributes stay as they are, normals included.
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

    /// The same mesh with the winding of every face reversed (each keeps its first corner), and given normals, of
    /// vertices and of corners, negated. Corner data moves with its corners.
    pub fn reversed(mut self) -> Self {
        for f in 0..self.polygons.len() {
            self.polygons.reverse(f);
        }
        if let Some(attributes) = &mut self.attributes {
            for face in self.polygons.starts().windows(2) {
                attributes.reverse_corners(face[0]..face[1]);
            }
            attributes.negate_normals();
        }
        self
    }

    /// Positions, faces and attributes.
    pub fn into_parts(mut self) -> (Vec<DVec3>, Polygons, Attributes) {
        let attributes = self.take_attributes();
        (self.positions, self.polygons, attributes)
    }
}

impl TryFrom<PolygonSoup> for IndexedMesh {
    type Error = IndexedError;

    /// Checks a soup, attributes included: a value that is not finite, an index that names none, groups that overlap or
    /// run past the faces are refused. Runs of one name and material become one group; a group without both is none.
    fn try_from(mut soup: PolygonSoup) -> Result<Self, IndexedError> {
        let (attributes, bad) = from_soup(&mut soup);
        let mut defects = defects(&soup.positions, &soup.polygons);
        defects.extend(attributes.defects(soup.positions.len(), &soup.polygons));
        defects.extend(bad);
        if !defects.is_empty() {
            return Err(IndexedError { defects });
        }
        let bare = Self { positions: soup.positions, polygons: soup.polygons, attributes: None };
        Ok(bare.carrying(attributes))
    }
}

impl From<IndexedMesh> for PolygonSoup {
    /// Corners of a vertex with equal values share one, and so do neighbouring corners of a face; values stand in the
    /// order of first use.
    fn from(mesh: IndexedMesh) -> Self {
        let (positions, polygons, attributes) = mesh.into_parts();
        let mut soup = Self::new(positions, polygons);
        attributes.into_soup(&mut soup);
        soup
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
