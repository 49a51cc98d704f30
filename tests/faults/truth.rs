//! Shapes of known truth: closed, manifold, wound outward, cavities inward.

use crate::shapes::{both, fanned, icosphere, pool, torus};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{IndexedMesh, Mesh};

pub(crate) struct Truth {
    pub(crate) name: &'static str,
    pub(crate) pool: IndexedMesh,
    pub(crate) volume: f64,
    pub(crate) diagonal: f64,
}

impl Truth {
    pub(crate) fn new(name: &'static str, pool: IndexedMesh) -> Self {
        let mesh = Mesh::build(&pool).expect("a manifold");
        let volume = mesh.closed().expect("closed").volume();
        assert!(volume > 0.0, "{name} is inside out");
        let bounds = mesh.bounds().expect("points");
        Self { name, volume, diagonal: bounds.min.distance(bounds.max), pool }
    }
}

pub(crate) fn truths() -> Vec<Truth> {
    let (cube, plate, torus) =
        (block([8; 3], DVec3::ONE), block([16, 10, 1], dvec3(100., 60., 0.5)), torus(36, 18));
    let bracket = bracket();
    vec![
        Truth::new("sphere", icosphere(3)),
        Truth::new("torus, quads", torus.clone()),
        Truth::new("torus", fanned(&torus)),
        Truth::new("bracket, polygons", bracket.clone()),
        Truth::new("bracket", triangulated(&bracket)),
        Truth::new("cube, quads", cube.clone()),
        Truth::new("cube", fanned(&cube)),
        Truth::new("plate, quads", plate.clone()),
        Truth::new("plate", fanned(&plate)),
        Truth::new("nested", nested()),
    ]
}

/// The same surface in triangles, by the crate's one rule; from the middle where that would double an edge.
pub(crate) fn triangulated(of: &IndexedMesh) -> IndexedMesh {
    let mut mesh = Mesh::build(of).expect("a manifold");
    for f in mesh.faces().collect::<Vec<_>>() {
        if mesh.triangulate_face(f).is_err() {
            let middle =
                mesh.face_vertices(f).map(|v| mesh.position(v)).sum::<DVec3>() / mesh.degree(f) as f64;
            mesh.poke_face(f, middle).expect("every face can be poked");
        }
    }
    mesh.to_indexed()
}

/// A sphere with a sphere-shaped cavity.
fn nested() -> IndexedMesh {
    let mut inner = icosphere(2);
    inner.map_positions(|p| p * 0.5 + dvec3(0.1, 0.05, 0.0)).expect("finite");
    both(&icosphere(3), &inner.reversed())
}

/// A box of `n` squares along each axis.
pub(crate) fn block(n: [u32; 3], size: DVec3) -> IndexedMesh {
    let mut points: Vec<DVec3> = Vec::new();
    let mut number = std::collections::HashMap::new();
    let mut vertex = |at: [u32; 3]| {
        *number.entry(at).or_insert_with(|| {
            let share = |i: usize| f64::from(at[i]) / f64::from(n[i]);
            points.push(dvec3(share(0), share(1), share(2)) * size);
            points.len() as u32 - 1
        })
    };
    let mut faces = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in [0, n[axis]] {
            for i in 0..n[u] {
                for j in 0..n[v] {
                    let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[a, b]| {
                        let mut at = [0; 3];
                        (at[axis], at[u], at[v]) = (side, i + a, j + b);
                        vertex(at)
                    });
                    let mut face = corners.to_vec();
                    if side == 0 {
                        face.reverse();
                    }
                    faces.push(face);
                }
            }
        }
    }
    pool(points, faces)
}

/// An L-shaped profile with a fillet and a bore, extruded in one piece: walls of long thin faces, caps of two large
/// polygons each.
pub(crate) fn bracket() -> IndexedMesh {
    let arc = |cx: f64, cy: f64, r: f64, from: f64, to: f64, n: u32| {
        (0..=n).map(move |i| {
            let angle = (from + (to - from) * f64::from(i) / f64::from(n)).to_radians();
            [cx + r * angle.cos(), cy + r * angle.sin()]
        })
    };
    let mut outer = vec![[0., 0.], [80., 0.], [80., 30.]];
    outer.extend(arc(40., 40., 10., 270., 180., 24));
    let right = outer.len();
    outer.push([30., 60.]);
    outer.extend(arc(22., 72., 8., 0., 90., 12));
    outer.extend(arc(8., 72., 8., 90., 180., 12));
    let left = outer.len();
    outer.push([0., 60.]);
    let n = outer.len() as u32;
    let bore: Vec<[f64; 2]> = arc(15., 60., 9., 0., 360., 64).take(64).collect();
    let m = bore.len() as u32;
    let height = 120.0;
    let layer = n + m;
    let rim: Vec<[f64; 2]> = outer.iter().chain(&bore).copied().collect();
    let points =
        [0.0, height].into_iter().flat_map(|z| rim.iter().map(move |p| dvec3(p[0], p[1], z))).collect();

    let mut faces: Vec<Vec<u32>> = Vec::new();
    for i in 0..n {
        let j = (i + 1) % n;
        faces.push(vec![i, j, layer + j, layer + i]);
    }
    for i in 0..m {
        let (i, j) = (n + i, n + (i + 1) % m);
        faces.push(vec![j, i, layer + i, layer + j]);
    }
    // Seen from above: the lower part around the legs, the upper one around the end, joined left and right of the bore.
    let (right, left) = (right as u32, left as u32);
    let under = (0..=m / 2).map(|i| n + m / 2 + i).map(|v| if v == n + m { n } else { v });
    let lower: Vec<u32> =
        (0..=right).chain(under.collect::<Vec<_>>().into_iter().rev()).chain([left]).collect();
    let over = (0..=m / 2).map(|i| n + i);
    let upper: Vec<u32> = (right..=left).chain(over.collect::<Vec<_>>().into_iter().rev()).collect();
    for cap in [lower, upper] {
        faces.push(cap.iter().map(|v| v + layer).collect());
        faces.push(cap.into_iter().rev().collect());
    }
    pool(points, faces)
}

/// A band with half a twist, with vertices of its own.
pub(crate) fn sheet_of_quads(n: u32) -> IndexedMesh {
    let points =
        (0..(n + 1) * (n + 1)).map(|i| dvec3(f64::from(i % (n + 1)), f64::from(i / (n + 1)), 0.0)).collect();
    let quad = |i: u32| {
        let a = i / n * (n + 1) + i % n;
        vec![a, a + 1, a + n + 2, a + n + 1]
    };
    pool(points, (0..n * n).map(quad).collect())
}

#[test]
fn the_shapes_are_what_they_are_said_to_be() {
    let all = truths();
    for truth in &all {
        println!("{}: {} faces, volume {}", truth.name, truth.pool.face_count(), truth.volume);
    }
    let volume = |name| all.iter().find(|t| t.name == name).map(|t| t.volume).expect("a shape");
    assert!((volume("cube") - 1.0).abs() < 1e-12 && (volume("plate") - 3000.0).abs() < 1e-9);
    assert!((volume("bracket") - volume("bracket, polygons")).abs() < 1e-6);
    // Two legs, a fillet, two rounded corners, a bore.
    let pi = std::f64::consts::PI;
    let plane = 80. * 30. + 50. * 30. + 100. * (1. - pi / 4.) - 2. * 64. * (1. - pi / 4.) - 81. * pi;
    assert!((volume("bracket") / 120.0 / plane - 1.0).abs() < 1e-3, "{}", volume("bracket") / 120.0 / plane);
}
