//! Area, volume and centroid, summed so that neither the distance from the origin nor the number of faces costs digits.

use super::triangulate::for_each_triangle;
use super::unit_scale;
use crate::{IndexedMesh, Polygons};
use glam::DVec3;

/// A sum that keeps what rounding drops (Neumaier, "Rundungsfehleranalyse einiger Verfahren zur Summation endlicher
/// Summen", ZAMM 54, 1974).
#[derive(Clone, Copy, Default)]
pub(crate) struct Sum {
    sum: f64,
    lost: f64,
}

impl Sum {
    pub(crate) fn add(&mut self, x: f64) {
        let sum = self.sum + x;
        self.lost += if self.sum.abs() >= x.abs() { (self.sum - sum) + x } else { (x - sum) + self.sum };
        self.sum = sum;
    }

    pub(crate) fn value(self) -> f64 {
        self.sum + self.lost
    }
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Aabb {
    /// The lowest coordinates.
    pub min: DVec3,
    /// The highest coordinates.
    pub max: DVec3,
}

impl Aabb {
    /// The smallest box around all points, or `None` if there are none.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Option<Self> {
        points.into_iter().fold(None, |all: Option<Self>, p| {
            Some(all.map_or(Self { min: p, max: p }, |b| Self { min: b.min.min(p), max: b.max.max(p) }))
        })
    }

    /// The middle of the box.
    pub fn center(&self) -> DVec3 {
        // Halved first: the sum may overflow.
        self.min * 0.5 + self.max * 0.5
    }
}

/// What summing over the triangles of all faces gives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measures {
    pub(crate) area: f64,
    pub(crate) volume: f64,
    /// `None` when the volume is zero or too large.
    pub(crate) centroid: Option<DVec3>,
}

/// The power of two that brings the used points to about one, and the middle of their box on that scale.
fn frame(positions: &[DVec3], polygons: &Polygons) -> (f64, DVec3) {
    let used = polygons.corners().iter().map(|&v| positions[v as usize]);
    let Some(bounds) = Aabb::around(used) else { return (1.0, DVec3::ZERO) };
    let scale = unit_scale([bounds.min, bounds.max].into_iter());
    (scale, bounds.center() * scale)
}

/// The volume alone, to the bit that of [`measures`].
pub(crate) fn volume(positions: &[DVec3], polygons: &Polygons) -> f64 {
    let (scale, center) = frame(positions, polygons);
    let mut volume = Sum::default();
    for_each_triangle(polygons, positions, |t| {
        let [a, b, c] = t.map(|v| positions[v as usize] * scale - center);
        volume.add(a.dot((b - a).cross(c - a)));
    });
    let back = 1.0 / scale;
    volume.value() / 6.0 * back * back * back
}

/// Area, and volume and centroid by the divergence theorem about the middle of the used points' box. O(corners).
pub(crate) fn measures(positions: &[DVec3], polygons: &Polygons) -> Measures {
    let (scale, center) = frame(positions, polygons);
    let (mut area, mut volume) = (Sum::default(), Sum::default());
    let mut moments = [Sum::default(); 3];
    for_each_triangle(polygons, positions, |t| {
        let [a, b, c] = t.map(|v| positions[v as usize] * scale - center);
        let cross = (b - a).cross(c - a);
        let six = a.dot(cross);
        area.add(cross.length());
        volume.add(six);
        let moment = (a + b + c) * six;
        moments[0].add(moment.x);
        moments[1].add(moment.y);
        moments[2].add(moment.z);
    });
    let six = volume.value();
    let back = 1.0 / scale;
    let moment = DVec3::from(moments.map(Sum::value));
    let centroid = (moment / (4.0 * six) + center) * back;
    Measures {
        area: area.value() / 2.0 * back * back,
        volume: six / 6.0 * back * back * back,
        centroid: (six != 0.0 && centroid.is_finite()).then_some(centroid),
    }
}

impl IndexedMesh {
    /// The total area of the faces, in square units; polygons that are not flat count by the shared triangulation
    /// rule. Needs no proof: the area of any set of faces is well defined. O(corners).
    pub fn area(&self) -> f64 {
        measures(self.positions(), self.polygons()).area
    }

    /// The smallest box around all vertices, isolated ones included; `None` if there are none. O(vertices).
    pub fn bounds(&self) -> Option<Aabb> {
        Aabb::around(self.positions().iter().copied())
    }
}

impl crate::Topology<'_> {
    /// The signed enclosed volume in cubic units, if the faces enclose one: every edge has two faces, wound alike.
    /// Pinches do no harm. Negative if the surface is inside out. O(corners).
    pub fn volume(&self) -> Option<f64> {
        (self.is_closed() && self.is_oriented()).then(|| volume(self.mesh.positions(), self.mesh.polygons()))
    }
}
