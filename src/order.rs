//! The order of elements in memory: what is near in space comes near in the columns.

use crate::arena::Arena;
use crate::build::lay_out;
use crate::column::{Columns, Kind};
use crate::geometry::measure::Aabb;
use crate::matching::{Chains, NONE};
use crate::{IndexedMesh, Mesh, Polygons};
use glam::DVec3;

impl Mesh {
    /// The same mesh with its elements laid out anew: vertices along Morton's curve, faces by their first vertex on it,
    /// edges by faces. Walks and sweeps over a mesh whose order has nothing to do with space then take a tenth of
    /// the time, as what they read lies close together.
    ///
    /// [`vertices`](Self::vertices) and the other iterators follow the new order. The order of the input is kept beside
    /// it (4 bytes a vertex and a face): [`to_indexed`](Self::to_indexed), [`numbering`](Self::numbering) and
    /// [`export_column`](Self::export_column) answer as before, and all maps and reports number elements by it. User
    /// data and attributes come along under their keys. Keys of elements are new: `numbering` before and after
    /// translates them. Checkpoints and the record of changes stay with the old mesh. O(slots), in
    /// the time of one to three builds.
    ///
    /// Source of the order: Morton, "A Computer Oriented Geodetic Data Base and a New Technique in File Sequencing", 1966.
    ///
    /// # Examples
    /// ```
    /// use meshwright::{IndexedMesh, Mesh, glam::DVec3};
    /// // Along a line, but every second point first.
    /// let points: Vec<DVec3> = [0.0, 2.0, 1.0, 3.0].map(|x| DVec3::new(x, x * x, 0.0)).to_vec();
    /// let pool = IndexedMesh::from_triangles(points, &[[0, 2, 1], [1, 2, 3]])?;
    /// let mesh = Mesh::build(&pool)?;
    /// let near = mesh.reorder();
    /// let along: Vec<f64> = near.vertices().map(|v| near.position(v).x).collect();
    /// assert_eq!(along, [0.0, 1.0, 2.0, 3.0]);
    /// assert_eq!(near.to_indexed(), pool);
    /// // A key of the old mesh, and the same vertex in the new.
    /// let (old, new) = (mesh.numbering().vertices, near.numbering().vertices);
    /// assert!(old.iter().zip(&new).all(|(&a, &b)| mesh.position(a) == near.position(b)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn reorder(&self) -> Self {
        // Numbers below are those of the indexed form.
        let order = self.vertices.in_user_order();
        let along = along_a_curve((0..).zip(&order).map(|(i, &v)| (self.positions[v as usize], i)));
        let vertex_rank = inverse(&along);
        let mut place = vec![NONE; self.vertices.slot_count()];
        order.iter().zip(&vertex_rank).for_each(|(&v, &rank)| place[v as usize] = rank);
        let faces = self.faces.in_user_order();
        // The links are walked once: what they lead to is scattered.
        let mut corners = Polygons::with_capacity(faces.len(), 3 * faces.len());
        for &f in &faces {
            let around = self.loop_slots(self.face_halfedge[f as usize]);
            corners.push(around.map(|h| place[self.origin[h as usize] as usize]));
        }
        let lowest = corners.iter().map(|c| c.iter().copied().min().unwrap_or_default());
        let by_vertex = sorted_by(lowest.collect(), order.len());
        let mut polygons = Polygons::with_capacity(faces.len(), corners.corners().len());
        by_vertex.iter().for_each(|&i| polygons.push(corners[i as usize].iter().copied()));
        drop(corners);
        let positions: Vec<DVec3> =
            along.iter().map(|&i| self.positions[order[i as usize] as usize]).collect();
        let pool = IndexedMesh::trusted(positions, polygons, None);
        let pairing = Chains::new(pool.vertex_count(), pool.polygons()).into_pairing();
        // A mesh is a manifold in any order; if it were not, it would stay as it is.
        let Some(mut new) = lay_out(&pool, &pairing) else { return self.clone() };
        drop((pool, pairing));
        rank(&mut new.vertices, &vertex_rank);
        rank(&mut new.faces, &inverse(&by_vertex));
        new.columns = Columns::in_order(self, |_, _| true);
        new.carried = self.carried.clone();
        for kind in Kind::ALL.into_iter().filter(|&kind| !self.columns.none_on(kind)) {
            let (slots, placed) = (new.slots_of(kind), new.ordered_slots(kind));
            new.columns.place(kind, slots, placed.into_iter());
        }
        new
    }
}

/// Lets element `i` of the user's order live in slot `rank[i] + 1`.
fn rank<K: slotmap::Key>(arena: &mut Arena<K>, rank: &[u32]) {
    let mut ranks = vec![0; rank.len() + 1];
    (0..).zip(rank).for_each(|(i, &at)| ranks[at as usize + 1] = i);
    arena.set_ranks(ranks);
}

fn inverse(order: &[u32]) -> Vec<u32> {
    let mut rank = vec![0; order.len()];
    (0..).zip(order).for_each(|(i, &at)| rank[at as usize] = i);
    rank
}

/// The numbers `0..keys.len()` by their keys, which are below `bound`; equal ones as they come.
fn sorted_by(keys: Vec<u32>, bound: usize) -> Vec<u32> {
    let mut starts = vec![0u32; bound + 1];
    keys.iter().for_each(|&k| starts[k as usize + 1] += 1);
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut sorted = vec![0; keys.len()];
    for (i, &k) in (0..).zip(&keys) {
        let start = &mut starts[k as usize];
        sorted[*start as usize] = i;
        *start += 1;
    }
    sorted
}

/// Numbers in the order in which their points lie along Morton's curve: what is near in space is near in the order.
pub(crate) fn along_a_curve(points: impl Iterator<Item = (DVec3, u32)> + Clone) -> Vec<u32> {
    let bounds =
        Aabb::around(points.clone().map(|p| p.0)).unwrap_or(Aabb { min: DVec3::ZERO, max: DVec3::ZERO });
    let per_unit = 1023.0 / (bounds.max - bounds.min).max_element().max(f64::MIN_POSITIVE);
    let spread = |x: f64| {
        let mut bits = (x as u32).min(1023);
        for (shift, mask) in [(16, 0x0300_00FF), (8, 0x0300_F00F), (4, 0x030C_30C3), (2, 0x0924_9249)] {
            bits = (bits | bits << shift) & mask;
        }
        bits
    };
    let code = |(p, number): (DVec3, u32)| {
        let cell = (p - bounds.min) * per_unit;
        (spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2, number)
    };
    let mut from: Vec<(u32, u32)> = points.map(code).collect();
    let mut to = vec![(0, 0); from.len()];
    // A radix sort, ten bits at a time.
    for shift in [0, 10, 20] {
        let digit = |code: u32| (code >> shift & 1023) as usize;
        let mut starts = [0usize; 1025];
        from.iter().for_each(|p| starts[digit(p.0) + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        for &p in &from {
            let start = &mut starts[digit(p.0)];
            to[*start] = p;
            *start += 1;
        }
        std::mem::swap(&mut from, &mut to);
    }
    from.into_iter().map(|p| p.1).collect()
}
