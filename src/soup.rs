//! The first rung: polygons as a file states them, with nothing promised.

use glam::DVec3;
use std::ops::Range;

/// The most vertices, faces or corners a mesh can have: half-edges are numbered in 32 bits.
pub const MAX_ELEMENTS: usize = (1 << 31) - 2;

/// Faces of any degree, stored as one flat index array.
///
/// Says nothing about the indices: they may be out of range or repeat. Indices are zero-based.
///
/// # Examples
/// ```
/// use meshwright::Polygons;
/// let mut faces = Polygons::new();
/// faces.push([0, 1, 2]);
/// faces.push([2, 1, 3, 4]);
/// assert_eq!(faces.len(), 2);
/// assert_eq!(&faces[1], &[2, 1, 3, 4]);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "Vec<Vec<u32>>", into = "Vec<Vec<u32>>"))]
pub struct Polygons {
    /// `starts[i]..starts[i + 1]` are the corners of polygon `i`; always begins with 0 and ends with `corners.len()`.
    starts: Vec<usize>,
    corners: Vec<u32>,
}

impl Default for Polygons {
    fn default() -> Self {
        Self::new()
    }
}

impl Polygons {
    /// No faces.
    pub fn new() -> Self {
        Self { starts: vec![0], corners: Vec::new() }
    }

    /// No faces, with room for `faces` of them and `corners` corners in all.
    pub fn with_capacity(faces: usize, corners: usize) -> Self {
        let mut starts = Vec::with_capacity(faces.saturating_add(1));
        starts.push(0);
        Self { starts, corners: Vec::with_capacity(corners) }
    }

    /// Triangles, in order.
    pub fn from_triangles(triangles: &[[u32; 3]]) -> Self {
        Self {
            starts: (0..=triangles.len()).map(|i| 3 * i).collect(),
            corners: triangles.as_flattened().to_vec(),
        }
    }

    /// From quads; as in Rhino, one whose last corner is the third again is a triangle.
    ///
    /// # Examples
    /// ```
    /// use meshwright::Polygons;
    /// let faces = Polygons::from_quads(&[[0, 1, 2, 3], [0, 4, 1, 1]]);
    /// assert_eq!((&faces[0], &faces[1]), (&[0, 1, 2, 3][..], &[0, 4, 1][..]));
    /// ```
    pub fn from_quads(quads: &[[u32; 4]]) -> Self {
        let mut faces = Self::with_capacity(quads.len(), 4 * quads.len());
        for q in quads {
            faces.push(q[..if q[2] == q[3] { 3 } else { 4 }].iter().copied());
        }
        faces
    }

    /// Removes all faces and keeps the room.
    pub fn clear(&mut self) {
        self.starts.truncate(1);
        self.corners.clear();
    }

    /// Appends a face of any degree, zero included.
    pub fn push(&mut self, corners: impl IntoIterator<Item = u32>) {
        self.corners.extend(corners);
        self.starts.push(self.corners.len());
    }

    /// Appends triangles.
    #[cfg(feature = "io")]
    pub(crate) fn push_triangles(&mut self, triangles: impl Iterator<Item = [u32; 3]>) {
        for corners in triangles {
            self.corners.extend_from_slice(&corners);
            self.starts.push(self.corners.len());
        }
    }

    /// The number of faces.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there is no face.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The corners of face `i`, or `None` past the end.
    pub fn get(&self, i: usize) -> Option<&[u32]> {
        let end = *self.starts.get(i.checked_add(1)?)?;
        Some(&self.corners[self.starts[i]..end])
    }

    /// Faces in order, each as its corners.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> + Clone + '_ {
        self.starts.windows(2).map(|w| &self.corners[w[0]..w[1]])
    }

    /// The corners of all faces, one after the other.
    pub fn corners(&self) -> &[u32] {
        &self.corners
    }

    /// Where the corners of face `i` stand in [`corners`](Self::corners), or `None` past the end.
    pub fn corner_range(&self, i: usize) -> Option<Range<usize>> {
        Some(self.starts[..].get(i).copied()?..*self.starts.get(i.checked_add(1)?)?)
    }

    /// Faces that all have `degree` corners, which stand one after the other.
    pub(crate) fn uniform(degree: usize, corners: Vec<u32>) -> Self {
        let starts = (0..=corners.len() / degree.max(1)).map(|i| degree * i).collect();
        Self { starts, corners }
    }

    /// Faces by where their corners begin; `starts` begins with 0 and ends with the number of corners.
    pub(crate) fn with_starts(starts: Vec<usize>, corners: Vec<u32>) -> Self {
        debug_assert!(starts.first() == Some(&0) && starts.last() == Some(&corners.len()));
        Self { starts, corners }
    }

    pub(crate) fn starts(&self) -> &[usize] {
        &self.starts
    }

    /// Reverses the winding of face `i`, which keeps its first corner. Does nothing past the end.
    pub fn reverse(&mut self, i: usize) {
        if let Some(range) = self.corner_range(i)
            && let Some((_, rest)) = self.corners[range].split_first_mut()
        {
            rest.reverse();
        }
    }

    /// Replaces every corner index by `f` of it.
    pub fn map_corners(&mut self, mut f: impl FnMut(u32) -> u32) {
        for c in &mut self.corners {
            *c = f(*c);
        }
    }
}

impl std::ops::Index<usize> for Polygons {
    type Output = [u32];
    /// The corners of face `i`. Panics past the end, as slices do; [`get`](Polygons::get) does not.
    fn index(&self, i: usize) -> &[u32] {
        &self.corners[self.starts[i]..self.starts[i + 1]]
    }
}

impl<P: IntoIterator<Item = u32>> FromIterator<P> for Polygons {
    fn from_iter<I: IntoIterator<Item = P>>(faces: I) -> Self {
        let mut all = Self::new();
        all.extend(faces);
        all
    }
}

impl<P: IntoIterator<Item = u32>> Extend<P> for Polygons {
    fn extend<I: IntoIterator<Item = P>>(&mut self, faces: I) {
        for face in faces {
            self.push(face);
        }
    }
}

impl From<Vec<Vec<u32>>> for Polygons {
    fn from(faces: Vec<Vec<u32>>) -> Self {
        faces.into_iter().collect()
    }
}

impl From<Polygons> for Vec<Vec<u32>> {
    fn from(faces: Polygons) -> Self {
        faces.iter().map(<[u32]>::to_vec).collect()
    }
}

/// Values that corners refer to by index, as OBJ does with `vt` and `vn`: two corners of one vertex may differ (a seam).
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CornerData<T> {
    /// The pool of values.
    pub values: Vec<T>,
    /// One entry per corner of the soup, in the order of [`Polygons::corners`]; [`CornerData::NONE`] where a corner has no value.
    pub indices: Vec<u32>,
}

impl<T> CornerData<T> {
    /// The index of a corner without a value.
    pub const NONE: u32 = u32::MAX;
}

/// A named run of faces: an OBJ group or object with its material.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Group {
    /// The group's or object's name as the file states it; may be empty.
    pub name: String,
    /// The material in use, if one was named.
    pub material: Option<String>,
    /// The faces of the group, in file order.
    pub faces: Range<usize>,
}

/// Whatever a file said: indices may be out of range, positions NaN, faces degenerate.
///
/// [`clean`](crate::cleanup::clean) turns any soup into a valid [`Mesh`](crate::Mesh) with an account of what it changed;
/// [`IndexedMesh::try_from`](crate::IndexedMesh) refuses what is not a valid vertex pool, and lists why.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PolygonSoup {
    /// Vertex positions, in the file's units.
    pub positions: Vec<DVec3>,
    /// Faces of any degree, as indices into `positions`. [`PolygonSoup::NO_VERTEX`] stands for an index the file could
    /// not have meant (zero in OBJ, negative, or beyond `u32`).
    pub polygons: Polygons,
    /// Given vertex normals: none, or one per position.
    pub vertex_normals: Vec<DVec3>,
    /// Vertex colours as RGBA in 0..=1: none, or one per position.
    pub vertex_colors: Vec<[f32; 4]>,
    /// Normals given per corner, if any.
    pub corner_normals: Option<CornerData<DVec3>>,
    /// Texture coordinates given per corner, if any.
    pub corner_uvs: Option<CornerData<[f64; 2]>>,
    /// Named runs of faces, in file order.
    pub groups: Vec<Group>,
    /// The names of files that describe the materials (`mtllib`), as the file states them; not opened.
    #[cfg_attr(feature = "serde", serde(default))]
    pub material_files: Vec<String>,
}

impl PolygonSoup {
    /// An index that names no vertex, whatever the number of positions.
    pub const NO_VERTEX: u32 = u32::MAX;

    /// A soup of positions and polygons, with no further data.
    pub fn new(positions: Vec<DVec3>, polygons: Polygons) -> Self {
        Self { positions, polygons, ..Self::default() }
    }
}
