//! Named meshes that edit scripts start from.

use super::shapes;
use meshwright::glam::dvec3;
use meshwright::{IndexedMesh, Mesh};

/// What a script starts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Start {
    Empty,
    Triangle,
    Quad,
    /// Two triangles.
    Pair,
    /// A row of triangles.
    Strip,
    /// Five triangles around a vertex, closed and open.
    Wheel,
    Fan,
    Tetrahedron,
    Octahedron,
    Cube,
    /// Closed, of quads, pentagons and triangles.
    Mixed,
    /// 4 by 4 quads.
    Grid,
    Annulus,
    Torus,
    Genus2,
    /// A box without lid, a triangle and a row of quads; a vertex alone.
    Parts,
    /// Two hexagons and six quads, one quad missing.
    OpenPrism,
}

impl Start {
    pub(crate) const ALL: [Self; 17] = [
        Self::Empty,
        Self::Triangle,
        Self::Quad,
        Self::Pair,
        Self::Strip,
        Self::Wheel,
        Self::Fan,
        Self::Tetrahedron,
        Self::Octahedron,
        Self::Cube,
        Self::Mixed,
        Self::Grid,
        Self::Annulus,
        Self::Torus,
        Self::Genus2,
        Self::Parts,
        Self::OpenPrism,
    ];

    pub(crate) fn build(self) -> Mesh {
        Mesh::build(&self.pool()).expect("a manifold")
    }

    fn pool(self) -> IndexedMesh {
        // On a circle, but for a little height.
        let ring = |n: u32, r: f64, z: f64| {
            (0..n).map(move |i| {
                let turn = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
                dvec3(r * turn.cos(), r * turn.sin(), z + 0.1 * f64::from(i))
            })
        };
        let wheel = |n: u32, faces: u32| {
            let points = [dvec3(0., 0., 0.)].into_iter().chain(ring(n, 1.0, 0.5)).collect();
            shapes::pool(points, (0..faces).map(|i| vec![0, 1 + i, 1 + (i + 1) % n]).collect())
        };
        match self {
            Self::Empty => shapes::pool(Vec::new(), Vec::new()),
            Self::Triangle => shapes::pool(ring(3, 1.0, 0.0).collect(), vec![vec![0, 1, 2]]),
            Self::Quad => shapes::pool(ring(4, 1.0, 0.0).collect(), vec![vec![0, 1, 2, 3]]),
            Self::Pair => shapes::pool(ring(4, 1.0, 0.0).collect(), vec![vec![0, 1, 2], vec![0, 2, 3]]),
            Self::Strip => {
                let points = (0..8).map(|i| dvec3(f64::from(i), f64::from(i % 2), 0.0)).collect();
                let cut =
                    |i: u32| if i.is_multiple_of(2) { vec![i, i + 2, i + 1] } else { vec![i, i + 1, i + 2] };
                shapes::pool(points, (0..6).map(cut).collect())
            }
            Self::Wheel => wheel(5, 5),
            Self::Fan => wheel(6, 5),
            Self::Tetrahedron => shapes::tetrahedron(),
            Self::Octahedron => {
                let points = [1., -1.]
                    .into_iter()
                    .flat_map(|s| [dvec3(s, 0., 0.), dvec3(0., s, 0.), dvec3(0., 0., s)]);
                let faces =
                    [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
                shapes::pool(points.collect(), faces.map(|f| f.to_vec()).to_vec())
            }
            Self::Cube => shapes::cube(),
            Self::Mixed => {
                // A pentagonal prism with a roof over one end, a corner cut off the other.
                let mut points: Vec<_> = ring(5, 1.0, 0.0).chain(ring(5, 1.0, 2.0)).collect();
                points.push(dvec3(0., 0., 3.));
                let mut faces = vec![vec![4, 3, 2, 1, 0]];
                for i in 0..5 {
                    let j = (i + 1) % 5;
                    faces.push(vec![i, j, 5 + j, 5 + i]);
                    faces.push(vec![5 + i, 5 + j, 10]);
                }
                shapes::pool(points, faces)
            }
            Self::Grid => lattice(4, 4, |_, _| true),
            Self::Annulus => lattice(3, 3, |x, y| (x, y) != (1, 1)),
            Self::Torus => shapes::torus(4, 3),
            Self::Genus2 => shells(),
            Self::Parts => {
                let cube = shapes::cube();
                let open = cube.polygons().iter().take(5).map(<[u32]>::to_vec).collect();
                let open = shapes::pool(cube.positions().to_vec(), open);
                let triangle = shapes::pool(ring(3, 1.0, 5.0).collect(), vec![vec![0, 1, 2]]);
                let lone = shapes::pool(vec![dvec3(9., 9., 9.)], Vec::new());
                let parts = [triangle, lattice(3, 1, |_, _| true), lone];
                parts.iter().fold(open, |all, part| shapes::both(&all, part))
            }
            Self::OpenPrism => {
                let points = ring(6, 1.0, 0.0).chain(ring(6, 1.0, 2.0)).collect();
                let side = |i: u32| vec![i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i];
                let mut faces: Vec<_> = (0..5).map(side).collect();
                faces.push((0..6).rev().collect());
                faces.push((6..12).collect());
                shapes::pool(points, faces)
            }
        }
    }
}

/// Quads on a lattice, where there is one.
fn lattice(n: u32, m: u32, has: impl Fn(u32, u32) -> bool) -> IndexedMesh {
    let at = |x: u32, y: u32| y * (n + 1) + x;
    let points = (0..=m)
        .flat_map(|y| (0..=n).map(move |x| dvec3(f64::from(x), f64::from(y), f64::from(x * y % 3) * 0.1)));
    let cells = (0..m).flat_map(|y| (0..n).map(move |x| (x, y))).filter(|&(x, y)| has(x, y));
    let faces = cells.map(|(x, y)| vec![at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]).collect();
    shapes::pool(points.collect(), faces)
}

/// A slab of 5 by 3 quads with two holes through it: genus 2.
fn shells() -> IndexedMesh {
    let has = |x: i32, y: i32| (0..5).contains(&x) && (0..3).contains(&y) && !(y == 1 && (x == 1 || x == 3));
    let at = |x: i32, y: i32, z: i32| (z * 24 + y * 6 + x) as u32;
    let points = (0..2).flat_map(|z| {
        (0..4).flat_map(move |y| (0..6).map(move |x| dvec3(f64::from(x), f64::from(y), f64::from(z))))
    });
    let mut faces = Vec::new();
    for (x, y) in (0..3).flat_map(|y| (0..5).map(move |x| (x, y))).filter(|&(x, y)| has(x, y)) {
        faces.push(vec![at(x, y, 1), at(x + 1, y, 1), at(x + 1, y + 1, 1), at(x, y + 1, 1)]);
        faces.push(vec![at(x, y, 0), at(x, y + 1, 0), at(x + 1, y + 1, 0), at(x + 1, y, 0)]);
        // Walls where the neighbour is missing: counter-clockwise around the square.
        let sides = [
            ((x, y), (x + 1, y), (0, -1)),
            ((x + 1, y), (x + 1, y + 1), (1, 0)),
            ((x + 1, y + 1), (x, y + 1), (0, 1)),
            ((x, y + 1), (x, y), (-1, 0)),
        ];
        for ((ax, ay), (bx, by), (dx, dy)) in sides {
            if !has(x + dx, y + dy) {
                faces.push(vec![at(ax, ay, 0), at(bx, by, 0), at(bx, by, 1), at(ax, ay, 1)]);
            }
        }
    }
    shapes::pool(points.collect(), faces)
}
