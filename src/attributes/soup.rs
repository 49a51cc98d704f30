//! Attributes to and from the soup's form: pools with indices, runs of faces.

use super::{Attributes, FaceGroups, GroupName, face_and_corner};
use crate::matching::NONE;
use crate::report::Attribute;
use crate::{CornerData, Group, IndexedDefect, PolygonSoup, Polygons};
use glam::DVec3;
use std::collections::BTreeMap;

/// A soup's attributes, as they are, and the indices and groups that name nothing. What was moved out of the soup is
/// missing there.
pub(crate) fn from_soup(soup: &mut PolygonSoup) -> (Attributes, Vec<IndexedDefect>) {
    let mut defects = Vec::new();
    let corner_normals = soup.corner_normals.take();
    let corner_uvs = soup.corner_uvs.take();
    let polygons = &soup.polygons;
    let attributes = Attributes {
        vertex_normals: Some(std::mem::take(&mut soup.vertex_normals)).filter(|n| !n.is_empty()),
        vertex_colors: Some(std::mem::take(&mut soup.vertex_colors)).filter(|c| !c.is_empty()),
        corner_normals: corner_normals
            .and_then(|data| expand(&data, Attribute::CornerNormals, polygons, &mut defects)),
        corner_uvs: corner_uvs
            .and_then(|data| expand(&data, Attribute::TextureCoordinates, polygons, &mut defects))
            .map(|uvs| uvs.into_iter().map(|uv| uv.map(Into::into)).collect()),
        face_groups: FaceGroups::from_runs(&soup.groups, polygons.len()),
        material_files: std::mem::take(&mut soup.material_files),
    };
    for (group, run) in soup.groups.iter().enumerate() {
        if run.faces.start < run.faces.end && run.faces.end > polygons.len() {
            defects.push(IndexedDefect::GroupPastFaces { group, end: run.faces.end });
        }
    }
    let doubly = faces_in_two(&soup.groups, polygons.len());
    defects.extend(doubly.map(|face| IndexedDefect::FaceInTwoGroups { face }));
    (attributes, defects)
}

/// The value of each corner; `None` if none has one.
fn expand<T: Copy>(
    data: &CornerData<T>,
    attribute: Attribute,
    polygons: &Polygons,
    defects: &mut Vec<IndexedDefect>,
) -> Option<Vec<Option<T>>> {
    let mut values = Vec::with_capacity(data.indices.len());
    for (i, &index) in data.indices.iter().enumerate() {
        let value = data.values.get(index as usize).copied();
        if value.is_none() && index != CornerData::<T>::NONE && i < polygons.corners().len() {
            let [face, corner] = face_and_corner(polygons, i);
            defects.push(IndexedDefect::NoSuchValue { attribute, face, corner, index });
        }
        values.push(value);
    }
    values.iter().any(Option::is_some).then_some(values)
}

impl Attributes {
    /// Gives a soup of these faces the attributes.
    pub(crate) fn into_soup(self, soup: &mut PolygonSoup) {
        let polygons = &soup.polygons;
        let vertices = soup.positions.len();
        soup.corner_normals = self
            .corner_normals
            .map(|values| pooled(&values, polygons, vertices, |n: &DVec3| n.to_array().map(f64::to_bits)));
        soup.corner_uvs = self.corner_uvs.map(|uvs| {
            let values: Vec<Option<[f64; 2]>> = uvs.into_iter().map(|uv| uv.map(Into::into)).collect();
            pooled(&values, polygons, vertices, |uv: &[f64; 2]| uv.map(f64::to_bits))
        });
        soup.groups = self.face_groups.map(|groups| groups.runs()).unwrap_or_default();
        soup.vertex_normals = self.vertex_normals.unwrap_or_default();
        soup.vertex_colors = self.vertex_colors.unwrap_or_default();
        soup.material_files = self.material_files;
    }
}

/// One value for all corners of a vertex that agree, and for corners of a face in a row that do; in the order of first
/// use.
fn pooled<T: Copy, B: PartialEq>(
    of: &[Option<T>],
    polygons: &Polygons,
    vertices: usize,
    bits: impl Fn(&T) -> B,
) -> CornerData<T> {
    // How far back to look at one vertex: thousands of corners that all differ must not cost their square.
    const LOOK_BACK: usize = 64;
    let mut data = CornerData { values: Vec::new(), indices: Vec::with_capacity(of.len()) };
    // For each vertex its last entry in `seen`, which holds a value and the entry before.
    let mut last = vec![NONE; vertices];
    let mut seen: Vec<(u32, u32)> = Vec::new();
    let mut corners = of.iter().zip(polygons.corners());
    for face in polygons.iter() {
        let mut before = NONE;
        for (value, &v) in corners.by_ref().take(face.len()) {
            let Some(value) = value else {
                data.indices.push(CornerData::<T>::NONE);
                continue;
            };
            let is_same =
                |i: u32| data.values.get(i as usize).is_some_and(|other| bits(other) == bits(value));
            let mut at = last[v as usize];
            let mut steps = 0;
            while at != NONE && steps < LOOK_BACK && !is_same(seen[at as usize].0) {
                at = seen[at as usize].1;
                steps += 1;
            }
            let index = match seen.get(at as usize) {
                Some(&(index, _)) if steps < LOOK_BACK => index,
                _ => {
                    let index = if is_same(before) { before } else { data.values.len() as u32 };
                    seen.push((index, last[v as usize]));
                    last[v as usize] = seen.len() as u32 - 1;
                    index
                }
            };
            if index as usize == data.values.len() {
                data.values.push(*value);
            }
            data.indices.push(index);
            before = index;
        }
    }
    data
}

/// The numbers of groups by name and material.
type Numbers<'r> = BTreeMap<(&'r str, Option<&'r str>), u32>;

impl FaceGroups {
    /// The groups of faces in runs, the first where runs overlap; `None` if no run says anything. Runs of one name and
    /// material are one group.
    pub(crate) fn from_runs(runs: &[Group], faces: usize) -> Option<Self> {
        let mut order: Vec<&Group> = runs.iter().filter(|r| says_something(r)).collect();
        if order.is_empty() {
            return None;
        }
        order.sort_by_key(|r| r.faces.start);
        let no_group = Group::default();
        let mut groups = Self::default();
        let mut numbers = Numbers::new();
        for run in order {
            let (start, end) = (run.faces.start.min(faces), run.faces.end.min(faces));
            groups.fill(start, &no_group, &mut numbers);
            groups.fill(end, run, &mut numbers);
        }
        groups.fill(faces, &no_group, &mut numbers);
        Some(groups)
    }

    /// Puts the faces up to `end` that are in no group yet into one.
    fn fill<'r>(&mut self, end: usize, run: &'r Group, numbers: &mut Numbers<'r>) {
        if self.of.len() >= end {
            return;
        }
        let number = *numbers.entry((&run.name, run.material.as_deref())).or_insert_with(|| {
            self.names.push(GroupName { name: run.name.clone(), material: run.material.clone() });
            self.names.len() as u32 - 1
        });
        self.of.resize(end, number);
    }

    /// The groups of the faces chosen, numbered by first use; `None` if no face is in one.
    pub(crate) fn of_faces(mut self, chosen: &[u32]) -> Option<Self> {
        let mut number = vec![NONE; self.names.len()];
        let mut names = Vec::new();
        let of = chosen.iter().map(|&face| {
            let old = self.of[face as usize] as usize;
            if number[old] == NONE {
                number[old] = names.len() as u32;
                names.push(std::mem::take(&mut self.names[old]));
            }
            number[old]
        });
        let of = of.collect();
        names.iter().any(|name| !name.says_nothing()).then_some(Self { names, of })
    }

    /// The runs of faces of one group, in the order of faces.
    pub(crate) fn runs(&self) -> Vec<Group> {
        let mut runs: Vec<Group> = Vec::new();
        let mut first = 0;
        for same in self.of.chunk_by(|a, b| a == b) {
            if let Some(GroupName { name, material }) = self.group(first) {
                let faces = first..first + same.len();
                runs.push(Group { name: name.clone(), material: material.clone(), faces });
            }
            first += same.len();
        }
        runs
    }
}

fn says_something(run: &Group) -> bool {
    !(run.faces.is_empty() || run.name.is_empty() && run.material.is_none())
}

/// The faces that several runs claim.
pub(crate) fn faces_in_two(runs: &[Group], faces: usize) -> impl Iterator<Item = u32> {
    let says = || runs.iter().filter(|r| says_something(r));
    let is_apart = says().zip(says().skip(1)).all(|(a, b)| a.faces.end <= b.faces.start);
    let mut change = vec![0i64; if is_apart { 0 } else { faces + 1 }];
    for run in says().filter(|_| !is_apart) {
        change[run.faces.start.min(faces)] += 1;
        change[run.faces.end.min(faces)] -= 1;
    }
    let mut count = 0;
    let claimed = change.into_iter().zip(0u32..).map(move |(by, face)| {
        count += by;
        (count, face)
    });
    claimed.filter(|(count, _)| *count > 1).map(|(_, face)| face)
}
