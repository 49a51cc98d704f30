//! Triangles in blocks, coordinates apart: gathering, arithmetic and scattering each run over arrays that stay in the first
//! cache, and the arithmetic has no branch, so that the compiler does several at once.

use super::direction;
use super::normals::tame_triangle_normal;
use crate::Mesh;
use glam::DVec3;

/// How many faces or vertices go together.
const BLOCK: usize = 64;

/// One coordinate, or a flag, of each.
type Lane<T = f64> = [T; BLOCK];

/// Faces that go together.
pub(super) enum Faces<'b> {
    /// Triangles.
    Triangles(&'b mut Triangles),
    /// Slots of faces, of which some are no triangles.
    Mixed(&'b [u32]),
}

/// Up to [`BLOCK`] triangles of a mesh whose coordinates are tame.
pub(super) struct Triangles {
    count: usize,
    /// Slots of vertices.
    corners: Lane<[u32; 3]>,
    /// By corner, then by axis.
    points: [[Lane; 3]; 3],
    /// By axis.
    vectors: [Lane; 3],
    /// Whether only care finds the normal.
    odd: Lane<u64>,
}

impl Triangles {
    fn new() -> Self {
        Self {
            count: 0,
            corners: [[0; 3]; BLOCK],
            points: [[[0.0; BLOCK]; 3]; 3],
            vectors: [[0.0; BLOCK]; 3],
            odd: [0; BLOCK],
        }
    }

    /// Takes over faces of a mesh; says whether all were triangles.
    #[inline]
    fn gather(&mut self, mesh: &Mesh, slots: &[u32]) -> bool {
        self.count = slots.len();
        for (i, (&f, corners)) in slots.iter().zip(&mut self.corners).enumerate() {
            let h = mesh.face_halfedge[f as usize] as usize;
            let (next, prev) = (mesh.next[h], mesh.prev[h]);
            if mesh.next[next as usize] != prev {
                return false;
            }
            // The other half-edge starts where the next one does, and lies beside.
            *corners = [mesh.origin[h], mesh.origin[h ^ 1], mesh.origin[prev as usize]];
            for (&v, point) in corners.iter().zip(&mut self.points) {
                let p = mesh.positions[v as usize];
                (point[0][i], point[1][i], point[2][i]) = (p.x, p.y, p.z);
            }
        }
        true
    }

    /// Adds to the sum of each vertex twice the area vectors of its triangles.
    #[inline]
    pub(super) fn add_areas(&mut self, sums: &mut [DVec3]) {
        let [a, b, c] = &self.points;
        for axis in 0..3 {
            let (y, z) = ((axis + 1) % 3, (axis + 2) % 3);
            for i in 0..BLOCK {
                let (u, v) = (b[y][i] - a[y][i], c[z][i] - a[z][i]);
                let (w, t) = (c[y][i] - a[y][i], b[z][i] - a[z][i]);
                self.vectors[axis][i] = 0.0 + (u * v - w * t);
            }
        }
        for (i, corners) in self.corners[..self.count].iter().enumerate() {
            let area = self.vector(i);
            corners.iter().for_each(|&v| sums[v as usize] += area);
        }
    }

    #[inline]
    fn vector(&self, i: usize) -> DVec3 {
        DVec3::new(self.vectors[0][i], self.vectors[1][i], self.vectors[2][i])
    }

    /// Appends the unit normals, to the bit as [`tame_triangle_normal`] has them.
    #[inline]
    pub(super) fn push_normals(&mut self, normals: &mut Vec<DVec3>) {
        let Self { points: [a, b, c], vectors, odd, .. } = self;
        let mut any = 0;
        for i in 0..BLOCK {
            let side =
                |p: &[Lane; 3], q: &[Lane; 3]| [q[0][i] - p[0][i], q[1][i] - p[1][i], q[2][i] - p[2][i]];
            let square = |v: [f64; 3]| v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
            let sides = [side(a, b), side(b, c), side(c, a)];
            let across = [square(sides[1]), square(sides[2]), square(sides[0])];
            let longer = |x: f64, y: f64| if y > x { y } else { x };
            let longest = longer(longer(across[0], across[1]), across[2]);
            let is_vague = |x: f64| (x != longest) & (x * (1.0 + 1e-14) >= longest);
            let vague = is_vague(across[0]) | is_vague(across[1]) | is_vague(across[2]);
            let (first, second) = (across[0] == longest, across[1] == longest);
            let choose = |at: [f64; 3]| {
                if first {
                    at[0]
                } else if second {
                    at[1]
                } else {
                    at[2]
                }
            };
            let from = [0, 1, 2].map(|axis| choose([sides[2][axis], sides[0][axis], sides[1][axis]]));
            let to = [0, 1, 2].map(|axis| choose([sides[0][axis], sides[1][axis], sides[2][axis]]));
            let cross = |y: usize, z: usize| 0.0 + (from[y] * to[z] - to[y] * from[z]);
            let normal = [cross(1, 2), cross(2, 0), cross(0, 1)];
            let length = square(normal);
            odd[i] = u64::from(vague | !((length > 1e-240) & (length < 1e240)));
            any |= odd[i];
            let length = length.sqrt();
            (0..3).for_each(|axis| vectors[axis][i] = normal[axis] / length);
        }
        normals.extend((0..self.count).map(|i| self.vector(i)));
        if any != 0 {
            let first = normals.len() - self.count;
            for (i, normal) in normals[first..].iter_mut().enumerate().filter(|(i, _)| self.odd[*i] != 0) {
                let corner = |p: &[Lane; 3]| DVec3::new(p[0][i], p[1][i], p[2][i]);
                *normal = tame_triangle_normal([0, 1, 2].map(|k| corner(&self.points[k])));
            }
        }
    }
}

impl Mesh {
    /// Gives faces in blocks, in their order.
    #[inline]
    pub(super) fn in_blocks(&self, slots: impl Iterator<Item = u32>, mut take: impl FnMut(Faces<'_>)) {
        let mut triangles = Triangles::new();
        let (mut block, mut count) = ([0; BLOCK], 0);
        let mut flush = |slots: &[u32]| {
            if triangles.gather(self, slots) {
                take(Faces::Triangles(&mut triangles));
            } else {
                take(Faces::Mixed(slots));
            }
        };
        slots.for_each(|f| {
            block[count] = f;
            count += 1;
            if count == BLOCK {
                flush(&block);
                count = 0;
            }
        });
        flush(&block[..count]);
    }
}

/// Makes each vector its [`direction`], to the bit.
pub(super) fn normalize(vectors: &mut [DVec3]) {
    let (mut axes, mut lengths) = ([[0.0; BLOCK]; 3], [0.0; BLOCK]);
    let (blocks, rest) = vectors.as_chunks_mut::<BLOCK>();
    for block in blocks {
        for (i, v) in block.iter().enumerate() {
            (axes[0][i], axes[1][i], axes[2][i]) = (v.x, v.y, v.z);
        }
        let mut odd = 0;
        for i in 0..BLOCK {
            let square = axes[0][i] * axes[0][i] + axes[1][i] * axes[1][i] + axes[2][i] * axes[2][i];
            odd |= u64::from(!((square > 1e-240) & (square < 1e240)));
            lengths[i] = square.sqrt();
        }
        if odd != 0 {
            block.iter_mut().for_each(|v| *v = direction(*v));
            continue;
        }
        for axis in &mut axes {
            axis.iter_mut().zip(&lengths).for_each(|(x, length)| *x /= length);
        }
        for (i, v) in block.iter_mut().enumerate() {
            *v = DVec3::new(axes[0][i], axes[1][i], axes[2][i]);
        }
    }
    rest.iter_mut().for_each(|v| *v = direction(*v));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Attribute, IndexedMesh, NormalWeight, Polygons};
    use glam::dvec3;
    use proptest::prelude::*;

    /// A strip of triangles, with a quad in it if one is wanted, over points on a lattice: slivers, folds and faces without
    /// area are among them.
    fn strip(points: &[[i32; 3]], size: f64, quad_at: usize) -> Mesh {
        let positions: Vec<DVec3> =
            points.iter().map(|&[x, y, z]| dvec3(x.into(), y.into(), z.into()) * size).collect();
        let mut faces = Polygons::new();
        let mut i = 0u32;
        while (i as usize) + 3 < points.len() {
            if i as usize == quad_at & !1 {
                faces.push([i, i + 1, i + 3, i + 2]);
            } else {
                faces.push([i, i + 1, i + 2]);
                faces.push([i + 2, i + 1, i + 3]);
            }
            i += 2;
        }
        Mesh::build(&IndexedMesh::new(positions, faces).unwrap()).unwrap()
    }

    proptest! {
        #[test]
        fn normals_found_in_blocks_have_the_bits_of_each_alone(
            points in prop::collection::vec(prop::array::uniform3(-3i32..4), 4..300),
            size in prop_oneof![Just(1.0), Just(0.1), Just(1e-170), Just(1e200)],
            quad_at in 0usize..600,
        ) {
            let mut mesh = strip(&points, size, quad_at);
            let bits = |n: DVec3| n.to_array().map(f64::to_bits);
            let alone: Vec<_> = mesh.faces().map(|f| bits(mesh.face_normal(f))).collect();
            let all = |normals: Vec<DVec3>| normals.into_iter().map(bits).collect::<Vec<_>>();
            prop_assert_eq!(&all(mesh.face_normals()), &alone);
            let pool = mesh.to_indexed();
            for weight in [NormalWeight::Area, NormalWeight::Angle] {
                prop_assert_eq!(&all(mesh.compute_all_normals(weight)), &alone);
                let at_vertices: Vec<DVec3> = mesh.vertices().map(|v| mesh.normal(v).unwrap()).collect();
                prop_assert_eq!(all(at_vertices), all(pool.vertex_normals(weight)));
                mesh.drop_attribute(Attribute::VertexNormals);
            }
        }

        #[test]
        fn vectors_normalized_in_blocks_have_the_bits_of_each_alone(
            seeds in prop::collection::vec((prop::array::uniform3(-1.0f64..1.0), 0usize..40), 0..200),
        ) {
            let sizes = [0.0, 1e-200, 1e200, f64::MIN_POSITIVE, 1e-120, 1e120];
            let sized = |(v, size): ([f64; 3], usize)| DVec3::from(v) * sizes.get(size).copied().unwrap_or(1.0);
            let vectors: Vec<DVec3> = seeds.into_iter().map(sized).collect();
            let bits = |v: DVec3| v.to_array().map(f64::to_bits);
            let mut blocks = vectors.clone();
            normalize(&mut blocks);
            let alone: Vec<_> = vectors.into_iter().map(|v| bits(direction(v))).collect();
            prop_assert_eq!(blocks.into_iter().map(bits).collect::<Vec<_>>(), alone);
        }
    }
}
