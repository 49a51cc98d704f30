//! Data beside positions and faces: one entry for each vertex, corner or face.

mod mesh;
mod soup;

use crate::geometry::normals::double_area_vector;
use crate::geometry::unit_scale;
use crate::report::Attribute;
use crate::{IndexedDefect, Polygons};
use glam::{DVec2, DVec3};
use std::ops::Range;

pub(crate) use mesh::Carried;
pub use mesh::SetAttributeError;
pub(crate) use soup::{faces_in_two, from_soup};

/// What a vertex pool carries beside positions and faces.
///
/// Corner data has one entry for each corner in the order of [`Polygons::corners`], `None` where a corner has no value:
/// two corners of one vertex may differ (a seam, a hard edge), and the vertex is still one.
///
/// # Examples
/// ```
/// use meshwright::{Attributes, IndexedMesh, glam::{DVec3, dvec2}};
/// let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y];
/// let pool = IndexedMesh::from_triangles(points, &[[0, 1, 2], [1, 3, 2]])?;
/// let uvs = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5], [0.6, 0.5], [0.5, 0.6]];
/// let corner_uvs = Some(uvs.map(|uv| Some(uv.into())).to_vec());
/// let pool = pool.with_attributes(Attributes { corner_uvs, ..Attributes::default() })?;
/// // Vertex 1 has two places in the texture.
/// assert_eq!(pool.attributes().corner_uvs.as_ref().map(|c| (c[1], c[3])), Some((Some(dvec2(1.0, 0.0)), Some(dvec2(0.5, 0.5)))));
/// # Ok::<(), meshwright::IndexedError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Attributes {
    /// Given normals of vertices; zero where a vertex has none.
    pub vertex_normals: Option<Vec<DVec3>>,
    /// Colours of vertices as RGBA in 0..=1.
    pub vertex_colors: Option<Vec<[f32; 4]>>,
    /// Normals of corners.
    pub corner_normals: Option<Vec<Option<DVec3>>>,
    /// Texture coordinates of corners.
    pub corner_uvs: Option<Vec<Option<DVec2>>>,
    /// The group of each face.
    pub face_groups: Option<FaceGroups>,
    /// The names of files that describe the groups' materials.
    pub material_files: Vec<String>,
}

/// Which group each face is in.
///
/// # Examples
/// ```
/// use meshwright::{FaceGroups, GroupName};
/// let lid = GroupName { name: "lid".to_owned(), material: Some("steel".to_owned()) };
/// let groups = FaceGroups { names: vec![GroupName::default(), lid], of: vec![1, 0] };
/// assert_eq!(groups.group(0).and_then(|g| g.material.as_deref()), Some("steel"));
/// assert_eq!(groups.group(1), None);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FaceGroups {
    /// The groups.
    pub names: Vec<GroupName>,
    /// For each face its group, an index into `names`.
    pub of: Vec<u32>,
}

/// What a group of faces is called. One without name and material is no group: its faces are in none.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GroupName {
    /// The group's or object's name; may be empty.
    pub name: String,
    /// The name of its material, if it has one.
    pub material: Option<String>,
}

impl GroupName {
    fn says_nothing(&self) -> bool {
        self.name.is_empty() && self.material.is_none()
    }
}

impl FaceGroups {
    /// The group of a face, if it is in one.
    pub fn group(&self, face: usize) -> Option<&GroupName> {
        self.names.get(*self.of.get(face)? as usize).filter(|name| !name.says_nothing())
    }
}

impl Attributes {
    /// No attributes.
    pub(crate) const NONE: Self = Self {
        vertex_normals: None,
        vertex_colors: None,
        corner_normals: None,
        corner_uvs: None,
        face_groups: None,
        material_files: Vec::new(),
    };

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.kinds().next().is_none()
    }

    /// Which there are.
    ///
    /// # Examples
    /// ```
    /// use meshwright::{Attribute, Attributes};
    /// let attributes = Attributes { vertex_colors: Some(vec![[1.0; 4]]), ..Attributes::default() };
    /// assert!(attributes.kinds().eq([Attribute::VertexColors]));
    /// ```
    pub fn kinds(&self) -> impl Iterator<Item = Attribute> + use<> {
        self.present().into_iter().filter(|(_, is)| *is).map(|(kind, _)| kind)
    }

    fn present(&self) -> [(Attribute, bool); 6] {
        [
            (Attribute::VertexNormals, self.vertex_normals.is_some()),
            (Attribute::VertexColors, self.vertex_colors.is_some()),
            (Attribute::CornerNormals, self.corner_normals.is_some()),
            (Attribute::TextureCoordinates, self.corner_uvs.is_some()),
            (Attribute::Groups, self.face_groups.is_some()),
            (Attribute::MaterialFiles, !self.material_files.is_empty()),
        ]
    }

    /// What keeps them from being those of a pool of so many vertices and these faces, in the order of the fields.
    pub(crate) fn defects(&self, vertices: usize, polygons: &Polygons) -> Vec<IndexedDefect> {
        let mut found = Vec::new();
        if let Some(normals) = &self.vertex_normals {
            if normals.len() != vertices {
                found.push(IndexedDefect::NormalCount { normals: normals.len(), vertices });
            }
            let bad = normals.iter().zip(0..).filter(|(n, _)| !n.is_finite());
            found.extend(bad.map(|(_, vertex)| IndexedDefect::NonFiniteNormal { vertex }));
        }
        if let Some(colors) = &self.vertex_colors {
            check_count(Attribute::VertexColors, colors.len(), vertices, &mut found);
            let bad = colors.iter().zip(0..).filter(|(c, _)| c.iter().any(|part| !part.is_finite()));
            found.extend(bad.map(|(_, vertex)| IndexedDefect::NonFiniteColor { vertex }));
        }
        if let Some(normals) = &self.corner_normals {
            check_corners(Attribute::CornerNormals, normals, DVec3::is_finite, polygons, &mut found);
        }
        if let Some(uvs) = &self.corner_uvs {
            check_corners(Attribute::TextureCoordinates, uvs, DVec2::is_finite, polygons, &mut found);
        }
        if let Some(groups) = &self.face_groups {
            check_count(Attribute::Groups, groups.of.len(), polygons.len(), &mut found);
            let bad = groups.of.iter().zip(0..).filter(|(g, _)| **g as usize >= groups.names.len());
            found.extend(bad.map(|(&group, face)| IndexedDefect::NoSuchGroup { face, group }));
        }
        found
    }

    /// Moves corner data along with the corners of a face that is reversed and keeps its first.
    pub(crate) fn reverse_corners(&mut self, face: Range<usize>) {
        reverse_behind_first(self.corner_normals.as_deref_mut(), face.clone());
        reverse_behind_first(self.corner_uvs.as_deref_mut(), face);
    }

    /// Turns all normals round.
    pub(crate) fn negate_normals(&mut self) {
        self.vertex_normals.iter_mut().flatten().for_each(|n| *n = -*n);
        self.corner_normals.iter_mut().flatten().flatten().for_each(|n| *n = -*n);
    }

    /// Turns the corner normals of faces that were reversed to the side where they now face, unless they lay there
    /// already: some programs take normals from the winding, so both were wrong, and others do not.
    pub(crate) fn turn_with(&mut self, reversed: &[bool], positions: &[DVec3], polygons: &Polygons) {
        let Some(normals) = &mut self.corner_normals else { return };
        for face in (0..reversed.len().min(polygons.len())).filter(|&f| reversed[f]) {
            let corners = &polygons[face];
            let scale = unit_scale(corners.iter().map(|&v| positions[v as usize]));
            let area = double_area_vector(corners.iter().map(|&v| positions[v as usize] * scale));
            let own = &mut normals[polygons.starts()[face]..polygons.starts()[face + 1]];
            let size = unit_scale(own.iter().flatten().copied());
            if own.iter().flatten().map(|n| (*n * size).dot(area)).sum::<f64>() < 0.0 {
                own.iter_mut().flatten().for_each(|n| *n = -*n);
            }
        }
    }
}

fn reverse_behind_first<T>(corners: Option<&mut [T]>, face: Range<usize>) {
    if let Some((_, behind)) = corners.and_then(|c| c.get_mut(face)?.split_first_mut()) {
        behind.reverse();
    }
}

fn check_count(attribute: Attribute, given: usize, wanted: usize, found: &mut Vec<IndexedDefect>) {
    if given != wanted {
        found.push(IndexedDefect::AttributeCount { attribute, given, wanted });
    }
}

fn check_corners<T: Copy>(
    attribute: Attribute,
    values: &[Option<T>],
    is_finite: impl Fn(T) -> bool,
    polygons: &Polygons,
    found: &mut Vec<IndexedDefect>,
) {
    check_count(attribute, values.len(), polygons.corners().len(), found);
    let bad = values.iter().enumerate().filter(|(_, v)| v.is_some_and(|v| !is_finite(v)));
    found.extend(bad.map(|(i, _)| {
        let [face, corner] = face_and_corner(polygons, i);
        IndexedDefect::NonFiniteValue { attribute, face, corner }
    }));
}

/// The face of a corner, and its number in it.
pub(crate) fn face_and_corner(polygons: &Polygons, corner: usize) -> [u32; 2] {
    let face = polygons.starts().partition_point(|&s| s <= corner).saturating_sub(1);
    [face as u32, (corner - polygons.starts()[face]) as u32]
}
