//! What the soup holds beside positions and faces, brought onto the pool as it stands.

use super::pool::Pool;
use crate::attributes::{Attributes, FaceGroups, face_and_corner, faces_in_two};
use crate::geometry::direction;
use crate::matching::NONE;
use crate::report::{Attribute, Element, LossReason, LostValue};
use crate::{CornerData, PolygonSoup};
use glam::{DVec2, DVec3};

/// The attributes of a pool, and what became of the soup's.
pub(super) struct Carried {
    pub(super) attributes: Attributes,
    /// For each attribute of the soup what it became.
    became: Vec<(Attribute, Option<Attribute>)>,
    lost: Vec<LostValue>,
}

impl Carried {
    /// The soup's attributes that are not there.
    pub(super) fn not_carried(&self) -> Vec<Attribute> {
        let gone = self.became.iter().filter(|(_, now)| now.is_none());
        gone.map(|(was, _)| *was).collect()
    }

    /// Single values that are not there, of attributes that are.
    pub(super) fn lost_values(&self) -> Vec<LostValue> {
        let gone = self.not_carried();
        self.lost.iter().filter(|l| !gone.contains(&l.attribute)).copied().collect()
    }

    fn lose(&mut self, attribute: Attribute, reason: LossReason, element: Element) {
        self.lost.push(LostValue { attribute, reason, element });
    }
}

/// Brings the soup's attributes onto the pool. `new_of` gives what became of the soup's vertices.
///
/// - Vertex normals stay, or become normals of corners (those of the vertices that the corners named in the soup) where
///   vertices with different ones became one; a corner's own normal goes before.
/// - Of different colours at one vertex, the lowest vertex's stays.
/// - Corner data goes with its corners. In the middle of a parted edge lies the mean of both ends.
pub(super) fn carry<'r>(pool: &Pool<'_>, new_of: impl Fn(usize) -> &'r [u32]) -> Carried {
    let mut carried = Carried { attributes: Attributes::NONE, became: Vec::new(), lost: Vec::new() };
    let soup = pool.soup;
    if !has_attributes(soup) {
        return carried;
    }
    carried.vertex_normals(pool, &new_of);
    carried.vertex_colors(pool, &new_of);
    let from_vertices = carried.attributes.corner_normals.take();
    let own =
        carried.corners(pool, &soup.corner_normals, Attribute::CornerNormals, DVec3::is_finite, between);
    carried.attributes.corner_normals = match (own, from_vertices) {
        (Some(own), Some(other)) => Some(own.into_iter().zip(other).map(|(a, b)| a.or(b)).collect()),
        (own, other) => own.or(other),
    };
    let is_finite = |uv: [f64; 2]| uv.iter().all(|x| x.is_finite());
    let mix =
        |[a, b]: [f64; 2], [c, d]: [f64; 2], at: f64| [a * (1.0 - at) + c * at, b * (1.0 - at) + d * at];
    let uvs = carried.corners(pool, &soup.corner_uvs, Attribute::TextureCoordinates, is_finite, mix);
    carried.attributes.corner_uvs = uvs.map(|uvs| uvs.into_iter().map(|uv| uv.map(DVec2::from)).collect());
    carried.groups(pool);
    if !soup.material_files.is_empty() {
        carried.attributes.material_files.clone_from(&soup.material_files);
        carried.became.push((Attribute::MaterialFiles, Some(Attribute::MaterialFiles)));
    }
    carried.attributes.turn_with(&pool.flipped, &pool.positions, &pool.polygons);
    carried.lost.sort_unstable();
    carried.lost.dedup();
    carried
}

pub(super) fn has_attributes(soup: &PolygonSoup) -> bool {
    !soup.vertex_normals.is_empty()
        || !soup.vertex_colors.is_empty()
        || soup.corner_normals.is_some()
        || soup.corner_uvs.is_some()
        || !soup.groups.is_empty()
        || !soup.material_files.is_empty()
}

/// What lies between two normals, `at` from one to the other, as long as they are there on the average.
fn between(a: DVec3, b: DVec3, at: f64) -> DVec3 {
    let mean = a * (1.0 - at) + b * at;
    let turned = direction(mean) * (a.length() * (1.0 - at) + b.length() * at);
    if turned.is_finite() { turned } else { mean }
}

impl Carried {
    fn vertex_normals<'r>(&mut self, pool: &Pool<'_>, new_of: impl Fn(usize) -> &'r [u32]) {
        let (given, kind) = (&pool.soup.vertex_normals, Attribute::VertexNormals);
        if given.is_empty() {
            return;
        }
        if given.len() != pool.soup.positions.len() {
            return self.became.push((kind, None));
        }
        for v in (0..given.len()).filter(|&v| pool.vertex_of[v] != NONE && !given[v].is_finite()) {
            self.lose(kind, LossReason::NonFinite, Element::Vertex(v as u32));
        }
        let finite = |v: usize| if given[v].is_finite() { given[v] } else { DVec3::ZERO };
        let kept = at_vertices(pool, finite, between);
        let agrees = |v: usize| new_of(v).iter().all(|&n| kept[n as usize] == finite(v));
        if (0..given.len()).all(agrees) {
            self.attributes.vertex_normals = Some(kept).filter(|k| !k.is_empty());
            return self.became.push((kind, Some(kind)));
        }
        let vertex_of_corner = pool.soup.polygons.corners();
        let own = |c: usize| Some(given[vertex_of_corner[c] as usize]).filter(|n| n.is_finite());
        let values = at_corners(pool, own, between);
        self.attributes.corner_normals = Some(values).filter(|v| v.iter().any(Option::is_some));
        self.became.push((kind, Some(Attribute::CornerNormals)));
        let mut named = vec![false; given.len()];
        for c in soup_corners(pool) {
            named[vertex_of_corner[c] as usize] = true;
        }
        for v in (0..given.len()).filter(|&v| pool.vertex_of[v] != NONE && !named[v]) {
            self.lose(kind, LossReason::NoCorner, Element::Vertex(v as u32));
        }
    }

    fn vertex_colors<'r>(&mut self, pool: &Pool<'_>, new_of: impl Fn(usize) -> &'r [u32]) {
        let (given, kind) = (&pool.soup.vertex_colors, Attribute::VertexColors);
        if given.is_empty() {
            return;
        }
        if given.len() != pool.soup.positions.len() {
            return self.became.push((kind, None));
        }
        let is_finite = |v: usize| given[v].iter().all(|part| part.is_finite());
        let finite = |v: usize| if is_finite(v) { given[v] } else { [1.0; 4] };
        let mean = |a: [f32; 4], b: [f32; 4], _| std::array::from_fn(|i| a[i] * 0.5 + b[i] * 0.5);
        let kept = at_vertices(pool, finite, mean);
        for v in (0..given.len()).filter(|&v| pool.vertex_of[v] != NONE) {
            if !is_finite(v) {
                self.lose(kind, LossReason::NonFinite, Element::Vertex(v as u32));
            } else if new_of(v).iter().any(|&n| kept[n as usize] != given[v]) {
                self.lose(kind, LossReason::Merged, Element::Vertex(v as u32));
            }
        }
        self.attributes.vertex_colors = Some(kept).filter(|k| !k.is_empty());
        self.became.push((kind, Some(kind)));
    }

    fn corners<T: Copy>(
        &mut self,
        pool: &Pool<'_>,
        data: &Option<CornerData<T>>,
        kind: Attribute,
        is_finite: impl Fn(T) -> bool,
        mix: impl Fn(T, T, f64) -> T,
    ) -> Option<Vec<Option<T>>> {
        let data = data.as_ref()?;
        let none = CornerData::<T>::NONE;
        if data.indices.iter().all(|&i| i == none) {
            return None;
        }
        if data.indices.len() != pool.soup.polygons.corners().len() {
            self.became.push((kind, None));
            return None;
        }
        for c in soup_corners(pool) {
            let index = data.indices[c];
            let reason = match data.values.get(index as usize) {
                None if index != none => LossReason::NoSuchValue,
                Some(value) if !is_finite(*value) => LossReason::NonFinite,
                _ => continue,
            };
            self.lose(kind, reason, Element::Corner(face_and_corner(&pool.soup.polygons, c)));
        }
        let value = |c: usize| data.values.get(data.indices[c] as usize).copied().filter(|v| is_finite(*v));
        let values = at_corners(pool, value, mix);
        // Nothing is lost with a corner whose face is gone.
        let is_lost = values.iter().all(Option::is_none);
        let had = soup_corners(pool).any(|c| data.indices[c] != none);
        if had {
            self.became.push((kind, Some(kind).filter(|_| !is_lost)));
        }
        (!is_lost).then_some(values)
    }

    fn groups(&mut self, pool: &Pool<'_>) {
        let (soup, kind) = (pool.soup, Attribute::Groups);
        let faces = soup.polygons.len();
        let Some(groups) = FaceGroups::from_runs(&soup.groups, faces) else { return };
        // A group whose faces are all gone is not missed.
        let Some(kept) = groups.of_faces(&pool.face_source) else { return };
        let stays = |f: u32| pool.face_source.binary_search(&f).is_ok();
        for face in faces_in_two(&soup.groups, faces).filter(|&f| stays(f)) {
            self.lose(kind, LossReason::TwoGroups, Element::Face(face));
        }
        self.attributes.face_groups = Some(kept);
        self.became.push((kind, Some(kind)));
    }
}

/// The soup's corners that are left.
fn soup_corners<'p>(pool: &'p Pool<'_>) -> impl Iterator<Item = usize> + 'p {
    let corners = pool.soup.polygons.corners().len();
    pool.corner_source.iter().map(|&c| c as usize).filter(move |&c| c < corners)
}

/// The values of the pool's vertices, given those of the soup's.
fn at_vertices<T: Copy>(pool: &Pool<'_>, value: impl Fn(usize) -> T, mix: impl Fn(T, T, f64) -> T) -> Vec<T> {
    let mut values: Vec<T> = pool.vertex_source.iter().map(|&v| value(v as usize)).collect();
    let first = values.len() - pool.parted.len();
    for (i, ends) in pool.parted.iter().enumerate() {
        let [a, b] = ends.map(|v| values[v as usize]);
        values[first + i] = mix(a, b, 0.5);
    }
    values
}

/// The values of the pool's corners, given those of the soup's.
fn at_corners<T: Copy>(
    pool: &Pool<'_>,
    value: impl Fn(usize) -> Option<T>,
    mix: impl Fn(T, T, f64) -> T,
) -> Vec<Option<T>> {
    let corners = pool.soup.polygons.corners().len();
    // Their ends are the soup's corners, or come before them.
    let mut blended: Vec<Option<T>> = Vec::with_capacity(pool.blends.len());
    let of = |blended: &[Option<T>], source: u32| match (source as usize).checked_sub(corners) {
        None => value(source as usize),
        Some(blend) => blended[blend],
    };
    for blend in &pool.blends {
        let [a, b] = blend.ends.map(|source| of(&blended, source));
        blended.push(a.zip(b).map(|(a, b)| mix(a, b, blend.at)));
    }
    let mut values: Vec<Option<T>> = pool.corner_source.iter().map(|&c| of(&blended, c)).collect();
    for &c in &pool.middles {
        let face = face_and_corner(&pool.polygons, c as usize)[0];
        // A middle stands behind the corner it was made at, and before the one that followed it.
        let next = crate::topology::next_corner(&pool.polygons, face, c as usize);
        let ends = values[c as usize - 1].zip(values[next]);
        values[c as usize] = ends.map(|(a, b)| mix(a, b, 0.5));
    }
    values
}
