//! User data: rules through every operator, seams, and what becomes of columns otherwise.

#[path = "../corpus/mod.rs"]
mod corpus;
#[path = "../shapes/mod.rs"]
mod shapes;

mod columns;
mod directions;
mod linear;
mod rules;
mod seams;

use meshwright::glam::{DVec3, dvec3};
use meshwright::{Column, HalfedgeKey, Mesh, Rule, VertexKey};
use shapes::{mesh, pool};

/// Two unit squares side by side.
fn two_squares() -> Mesh {
    let points = (0..6).map(|i| dvec3(f64::from(i % 3), f64::from(i / 3), 0.0)).collect();
    mesh(&pool(points, vec![vec![0, 1, 4, 3], vec![1, 2, 5, 4]]))
}

fn vertex(mesh: &Mesh, p: DVec3) -> VertexKey {
    mesh.vertices().find(|&v| mesh.position(v) == p).expect("a vertex there")
}

fn halfedge(mesh: &Mesh, a: DVec3, b: DVec3) -> HalfedgeKey {
    mesh.find_halfedge(vertex(mesh, a), vertex(mesh, b)).expect("an edge there")
}

/// The middle edge of two squares, as a half-edge that runs upwards.
fn middle(mesh: &Mesh) -> HalfedgeKey {
    halfedge(mesh, DVec3::X, dvec3(1., 1., 0.))
}

/// A vertex column that holds x, under a rule.
fn with_x(rule: Rule<f64>) -> (Mesh, Column<VertexKey, f64>) {
    let mut mesh = two_squares();
    let column = mesh.add_vertex_column(-1.0, rule);
    for v in mesh.vertices().collect::<Vec<_>>() {
        mesh.set_value(column, v, mesh.position(v).x).expect("live");
    }
    (mesh, column)
}
