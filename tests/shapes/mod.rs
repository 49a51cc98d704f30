//! Named shapes, made here: closed ones are wound outward.

#![allow(dead_code, reason = "each test and bench takes the shapes it needs")]

use meshwright::glam::{DVec3, dvec3};
use meshwright::{IndexedMesh, Mesh, PolygonSoup, Polygons};
use std::collections::HashMap;

pub(crate) fn pool(positions: Vec<DVec3>, faces: Vec<Vec<u32>>) -> IndexedMesh {
    IndexedMesh::new(positions, faces.into()).expect("a valid vertex pool")
}

pub(crate) fn mesh(pool: &IndexedMesh) -> Mesh {
    Mesh::build(pool).expect("a manifold")
}

pub(crate) fn soup(pool: &IndexedMesh) -> PolygonSoup {
    pool.clone().into()
}

/// The unit cube at `corner`, six quads.
pub(crate) fn cube_at(corner: DVec3) -> IndexedMesh {
    let at = |i: u32| corner + dvec3(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        .map(|f| f.to_vec());
    pool((0..8).map(at).collect(), faces.to_vec())
}

pub(crate) fn cube() -> IndexedMesh {
    cube_at(DVec3::ZERO)
}

/// The same shape in triangles, every polygon cut as a fan.
pub(crate) fn fanned(of: &IndexedMesh) -> IndexedMesh {
    let fan = |f: &[u32]| (2..f.len()).map(|i| vec![f[0], f[i - 1], f[i]]).collect::<Vec<_>>();
    pool(of.positions().to_vec(), of.polygons().iter().flat_map(fan).collect())
}

/// Both, side by side in one pool; vertices are not shared.
pub(crate) fn both(a: &IndexedMesh, b: &IndexedMesh) -> IndexedMesh {
    let offset = a.vertex_count() as u32;
    let positions = a.positions().iter().chain(b.positions()).copied().collect();
    let moved = b.polygons().iter().map(|f| f.iter().map(|v| v + offset).collect());
    pool(positions, a.polygons().iter().map(<[u32]>::to_vec).chain(moved).collect())
}

/// Two unit cubes that share one edge.
pub(crate) fn cubes_at_an_edge() -> IndexedMesh {
    both(&cube(), &cube_at(dvec3(1., 1., 0.)))
}

/// Two unit cubes that share one vertex.
pub(crate) fn cubes_at_a_vertex() -> IndexedMesh {
    both(&cube(), &cube_at(DVec3::ONE))
}

pub(crate) fn tetrahedron() -> IndexedMesh {
    let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    pool(points, vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![2, 0, 3]])
}

/// Three triangles on one edge.
pub(crate) fn fins() -> IndexedMesh {
    let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_Y];
    pool(points, vec![vec![0, 1, 2], vec![0, 1, 3], vec![1, 0, 4]])
}

/// Two triangles that share one vertex.
pub(crate) fn bow_tie() -> IndexedMesh {
    let points =
        vec![DVec3::ZERO, dvec3(1., -1., 0.), dvec3(1., 1., 0.), dvec3(-1., 1., 0.), dvec3(-1., -1., 0.)];
    pool(points, vec![vec![0, 1, 2], vec![0, 3, 4]])
}

/// A band of `n` quads with half a twist.
pub(crate) fn moebius(n: u32) -> IndexedMesh {
    let point = |i: u32, side: f64| {
        let turn = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
        let (s, c) = (turn / 2.0).sin_cos();
        let r = 2.0 + side * c;
        dvec3(r * turn.cos(), r * turn.sin(), side * s)
    };
    let points = (0..n).flat_map(|i| [point(i, -0.5), point(i, 0.5)]).collect();
    let quad = |i: u32| {
        let (a, b) = (2 * i, 2 * i + 1);
        if i + 1 < n { vec![a, a + 2, b + 2, b] } else { vec![a, 1, 0, b] }
    };
    pool(points, (0..n).map(quad).collect())
}

/// A torus of `n` by `m` quads.
pub(crate) fn torus(n: u32, m: u32) -> IndexedMesh {
    let angle = |i: u32, n: u32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
    let point = |i: u32, j: u32| {
        let (r, z) = (2.0 + angle(j, m).cos(), angle(j, m).sin());
        dvec3(r * angle(i, n).cos(), r * angle(i, n).sin(), z)
    };
    let points = (0..n).flat_map(|i| (0..m).map(move |j| (i, j))).map(|(i, j)| point(i, j)).collect();
    let at = |i: u32, j: u32| i % n * m + j % m;
    let quad = |i, j| vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
    pool(points, (0..n).flat_map(|i| (0..m).map(move |j| (i, j))).map(|(i, j)| quad(i, j)).collect())
}

/// A plate of 100 by 60 by 4 with a round hole of `n` sides, in triangles: long and thin ones around the hole and along
/// its walls. `n` is a multiple of four.
pub(crate) fn bracket(n: u32) -> IndexedMesh {
    let circle = |i: u32| {
        let angle = (f64::from(i) + 0.5) / f64::from(n) * std::f64::consts::TAU;
        dvec3(12.0 * angle.cos(), 12.0 * angle.sin(), 0.0)
    };
    let corners = [(50., 30.), (-50., 30.), (-50., -30.), (50., -30.)].map(|(x, y)| dvec3(x, y, 0.));
    let flat: Vec<DVec3> = corners.into_iter().chain((0..n).map(circle)).collect();
    let m = flat.len() as u32;
    let ring = |i: u32| 4 + i % n;
    let mut top: Vec<[u32; 3]> = Vec::new();
    for i in 0..n {
        let corner = i / (n / 4);
        top.push([corner, ring(i + 1), ring(i)]);
        if (i + 1) % (n / 4) == 0 {
            top.push([corner, (corner + 1) % 4, ring(i + 1)]);
        }
    }
    let mut triangles: Vec<[u32; 3]> = top.iter().map(|t| t.map(|v| v + m)).collect();
    triangles.extend(top.iter().map(|&[a, b, c]| [a, c, b]));
    let outer = (0..4).map(|i| [i, (i + 1) % 4]);
    for [a, b] in outer.chain((0..n).map(|i| [ring(i + 1), ring(i)])) {
        triangles.extend([[a, b, b + m], [a, b + m, a + m]]);
    }
    let points = flat.iter().copied().chain(flat.iter().map(|p| *p + DVec3::Z * 4.0)).collect();
    IndexedMesh::from_triangles(points, &triangles).expect("a valid vertex pool")
}

/// A height field of `n` by `n` squares, each cut in two, with a little noise.
pub(crate) fn grid(n: u32) -> IndexedMesh {
    let mut noise = Noise(7);
    let point = |i: u32| {
        let (x, y) = (f64::from(i % (n + 1)), f64::from(i / (n + 1)));
        dvec3(x, y, (x * 0.05).sin() * (y * 0.03).cos() * 5.0)
    };
    let points = (0..(n + 1) * (n + 1)).map(|i| point(i) + DVec3::Z * (noise.unit() * 0.1)).collect();
    let cut = |i: u32| {
        let a = i / n * (n + 1) + i % n;
        let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
        [[a, b, c], [a, c, d]]
    };
    let triangles: Vec<[u32; 3]> = (0..n * n).flat_map(cut).collect();
    IndexedMesh::from_triangles(points, &triangles).expect("a valid vertex pool")
}

/// An icosahedron subdivided `levels` times, its vertices scaled by a few sines: scattered in memory, as subdivision
/// leaves them.
pub(crate) fn icosphere(levels: u32) -> IndexedMesh {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut points: Vec<DVec3> = Vec::new();
    for (a, b) in [(-1., g), (1., g), (-1., -g), (1., -g)] {
        points.extend([dvec3(a, b, 0.), dvec3(0., a, b), dvec3(b, 0., a)]);
    }
    for p in &mut points {
        *p = p.normalize();
    }
    // The faces are the triples at edge length.
    let edge = 2.0 / (1.0 + g * g).sqrt();
    let joined = |a: usize, b: usize| (points[a].distance(points[b]) - edge).abs() < 1e-9;
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if joined(a, b) && joined(b, c) && joined(a, c) {
                    let outward = (points[b] - points[a]).cross(points[c] - points[a]).dot(points[a]) > 0.0;
                    let [a, b, c] = [a, b, c].map(|i| i as u32);
                    triangles.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]).normalize());
                points.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    for p in &mut points {
        *p *= 1.0 + 0.1 * ((3.0 * p.x).sin() + (5.0 * p.y).sin() * (4.0 * p.z).cos());
    }
    IndexedMesh::from_triangles(points, &triangles).expect("a valid vertex pool")
}

/// Every face with vertices of its own.
pub(crate) fn unwelded(of: &IndexedMesh) -> PolygonSoup {
    let positions = of.polygons().corners().iter().map(|&v| of.positions()[v as usize]).collect();
    let mut next = 0;
    let mut polygons = of.polygons().clone();
    polygons.map_corners(|_| {
        next += 1;
        next - 1
    });
    PolygonSoup::new(positions, polygons)
}

/// The same faces, some of them reversed: each with one chance in `one_in`.
pub(crate) fn some_reversed(of: &IndexedMesh, one_in: u32, seed: u64) -> IndexedMesh {
    let mut noise = Noise(seed);
    let mut polygons: Polygons = of.polygons().clone();
    for f in 0..polygons.len() {
        if noise.below(one_in) == 0 {
            polygons.reverse(f);
        }
    }
    IndexedMesh::new(of.positions().to_vec(), polygons).expect("a valid vertex pool")
}

/// The same surface with vertices and faces in random order: nothing lies near its neighbours in memory.
pub(crate) fn shuffled(of: &IndexedMesh, seed: u64) -> IndexedMesh {
    let mut noise = Noise(seed);
    let mut order = |n: usize| {
        let mut order: Vec<u32> = (0..n as u32).collect();
        (1..n).rev().for_each(|i| order.swap(i, noise.below(i as u32 + 1) as usize));
        order
    };
    let (vertices, faces) = (order(of.vertex_count()), order(of.face_count()));
    let mut number = vec![0; vertices.len()];
    (0..).zip(&vertices).for_each(|(new, &old)| number[old as usize] = new);
    let polygons = faces
        .iter()
        .map(|&f| of.polygons()[f as usize].iter().map(|&v| number[v as usize]).collect::<Vec<_>>());
    let positions = vertices.iter().map(|&v| of.positions()[v as usize]).collect();
    IndexedMesh::new(positions, polygons.collect()).expect("a valid vertex pool")
}

/// The shape in a file of raw numbers: see `benches/peers.rs`.
pub(crate) fn from_raw(raw: &[u8]) -> Result<IndexedMesh, Box<dyn std::error::Error>> {
    let word = |i: usize| raw[8 * i..8 * i + 8].try_into().map(u64::from_le_bytes);
    let (vertices, triangles) = (word(0)? as usize, word(1)? as usize);
    let (points, indices) = raw[16..].split_at(24 * vertices);
    let number = |b: &[u8]| f64::from_le_bytes(b.try_into().expect("eight bytes"));
    let points =
        points.chunks_exact(24).map(|p| DVec3::new(number(&p[..8]), number(&p[8..16]), number(&p[16..])));
    let index = |b: &[u8]| u32::from_le_bytes(b.try_into().expect("four bytes"));
    let corners = indices.chunks_exact(12).map(|t| [index(&t[..4]), index(&t[4..8]), index(&t[8..])]);
    let corners: Vec<[u32; 3]> = corners.take(triangles).collect();
    Ok(IndexedMesh::from_triangles(points.collect(), &corners)?)
}

/// Numbers that look random and are the same on every run (SplitMix64, Steele, Lea and Flood 2014).
#[derive(Clone)]
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }

    /// In `0.0..1.0`.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn below(&mut self, n: u32) -> u32 {
        (self.bits() % u64::from(n.max(1))) as u32
    }
}
