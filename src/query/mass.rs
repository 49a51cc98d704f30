//! Mass properties of the enclosed solid.

use crate::Closed;
use crate::geometry::measure::{Aabb, Sum};
use crate::geometry::triangulate::for_each_triangle;
use crate::geometry::unit_scale;
use glam::{DMat3, DVec3};

/// Volume, area, centre of mass and inertia of a solid of density one. Made by [`Closed::mass_properties`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct MassProperties {
    /// The volume in cubic units, which is the mass; negative if the surface is inside out.
    pub volume: f64,
    /// The area of the surface in square units.
    pub area: f64,
    /// The centre of mass.
    pub centroid: DVec3,
    /// The inertia tensor about the centroid, in units of length to the fifth: moments on the diagonal, negated products
    /// beside it. Symmetric. Its eigenvectors are the principal axes. Infinite if beyond f64.
    pub inertia: DMat3,
}

impl Closed<'_> {
    /// Volume, area, centroid and inertia tensor at density one; cavities subtract. `None` if the volume is zero or beyond
    /// f64: there is no centroid then. For another density multiply the inertia by it.
    ///
    /// The integrals of the products of coordinates over the tetrahedra between the triangles and the middle of the bounding
    /// box (Tonon, "Explicit Exact Formulas for the 3-D Tetrahedron Inertia Tensor in Terms of its Vertex Coordinates",
    /// Journal of Mathematics and Statistics 1, 2005; compare Mirtich, "Fast and Accurate Computation of Polyhedral Mass
    /// Properties", Journal of Graphics Tools 1(2), 1996), each summed with compensation and moved to the centroid, so a
    /// mesh far from the origin loses no digits. O(corners).
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::{DVec3, dvec3}};
    /// # let at = |i: u32| dvec3(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
    /// # let quads = vec![vec![0, 2, 3, 1], vec![4, 5, 7, 6], vec![0, 1, 5, 4], vec![2, 6, 7, 3], vec![0, 4, 6, 2], vec![1, 3, 7, 5]];
    /// # let cube = Mesh::build(&IndexedMesh::new((0..8).map(at).collect(), quads.into())?)?;
    /// let mass = cube.closed()?.mass_properties().expect("a volume");
    /// assert_eq!((mass.volume, mass.centroid), (1.0, DVec3::splat(0.5)));
    /// assert!((mass.inertia.x_axis - dvec3(1.0 / 6.0, 0.0, 0.0)).length() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn mass_properties(&self) -> Option<MassProperties> {
        let (volume, area, centroid) = (self.volume(), self.area(), self.centroid()?);
        let pool = self.mesh().to_indexed();
        let (positions, polygons) = (pool.positions(), pool.polygons());
        let used = || polygons.corners().iter().map(|&v| positions[v as usize]);
        let scale = unit_scale(used());
        let center = Aabb::around(used())?.center() * scale;
        let mut six = Sum::default();
        let mut first = [Sum::default(); 3];
        // xx, yy, zz, yz, zx, xy: 120 times the integrals of the products.
        let mut second = [Sum::default(); 6];
        for_each_triangle(polygons, positions, |t| {
            let [a, b, c] = t.map(|v| positions[v as usize] * scale - center);
            let volume = a.dot((b - a).cross(c - a));
            let sum = a + b + c;
            let products = |i: usize, j: usize| a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + sum[i] * sum[j];
            six.add(volume);
            for i in 0..3 {
                first[i].add(volume * sum[i]);
                second[i].add(volume * products(i, i));
                second[i + 3].add(volume * products((i + 1) % 3, (i + 2) % 3));
            }
        });
        let mean = DVec3::from(first.map(Sum::value)) / (4.0 * six.value());
        // Steiner: about the centroid.
        let about = |i: usize, sum: Sum| {
            let (j, k) = if i < 3 { (i, i) } else { ((i + 1) % 3, (i + 2) % 3) };
            sum.value() / 120.0 - six.value() / 6.0 * mean[j] * mean[k]
        };
        let back = 1.0 / scale;
        let mut moments = [0.0; 6];
        for (i, &sum) in second.iter().enumerate() {
            moments[i] = about(i, sum) * back * back * back * back * back;
        }
        let [xx, yy, zz, yz, zx, xy] = moments;
        let inertia = DMat3::from_cols_array(&[yy + zz, -xy, -zx, -xy, zz + xx, -yz, -zx, -yz, xx + yy]);
        Some(MassProperties { volume, area, centroid, inertia })
    }
}
