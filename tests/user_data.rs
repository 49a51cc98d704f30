//! User data: rules through every operator, seams, and what becomes of columns otherwise.

mod corpus;
mod shapes;

use meshwright::glam::{DVec2, DVec3, dvec2, dvec3};
use meshwright::{
    Column, ColumnError, ColumnValues, CornerData, EdgeKey, Event, FaceKey, HalfedgeKey, IndexedMesh, Mesh,
    NormalWeight, PolygonSoup, Rule, VertexKey,
};
use shapes::{Noise, cube, fanned, grid, icosphere, mesh, pool, tetrahedron};
use std::sync::{Arc, Mutex};

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

// Rules.

/// A vertex column that holds x, under a rule.
fn with_x(rule: Rule<f64>) -> (Mesh, Column<VertexKey, f64>) {
    let mut mesh = two_squares();
    let column = mesh.add_vertex_column(-1.0, rule);
    for v in mesh.vertices().collect::<Vec<_>>() {
        mesh.set_value(column, v, mesh.position(v).x).expect("live");
    }
    (mesh, column)
}

#[test]
fn an_interpolated_value_goes_by_weight_when_an_edge_splits_and_collapses() {
    let (mut mesh, x) = with_x(Rule::interpolate());
    let h = halfedge(&mesh, DVec3::ZERO, DVec3::X);
    let new = mesh.split_edge(mesh.edge(h), DVec3::X * 0.25).expect("always");
    assert_eq!(*mesh.value(x, new.vertex), 0.25);
    let h = mesh.find_halfedge(new.vertex, vertex(&mesh, DVec3::X)).expect("the new half");
    let done = mesh.collapse(h, DVec3::X * 0.625).expect("a boundary edge");
    assert_eq!(*mesh.value(x, done.vertex), 0.625);
}

#[test]
fn an_averaged_value_is_the_mean_whatever_the_weights() {
    let (mut mesh, x) = with_x(Rule::average());
    let h = halfedge(&mesh, DVec3::ZERO, DVec3::X);
    let new = mesh.split_edge(mesh.edge(h), DVec3::X * 0.25).expect("always");
    assert_eq!(*mesh.value(x, new.vertex), 0.5);
    let f = mesh.face(middle(&mesh)).expect("the left square");
    let poked = mesh.poke_face(f, dvec3(0.1, 0.1, 0.0)).expect("finite");
    assert_eq!(*mesh.value(x, poked.vertex), (0.0 + 0.5 + 1.0 + 1.0 + 0.0) / 5.0);
}

#[test]
fn a_kept_value_is_that_of_the_nearer_end() {
    let (mut mesh, x) = with_x(Rule::keep());
    for (at, expected) in [(0.25, 0.0), (0.75, 1.0)] {
        let h = halfedge(&mesh, dvec3(0., 1., 0.), dvec3(1., 1., 0.));
        let mut other = mesh.clone();
        let new = other.split_edge(mesh.edge(h), dvec3(at, 1., 0.)).expect("always");
        assert_eq!(*other.value(x, new.vertex), expected);
    }
    let h = halfedge(&mesh, DVec3::ZERO, DVec3::X);
    let done = mesh.collapse(h, DVec3::X * 0.25).expect("a boundary edge");
    assert_eq!(*mesh.value(x, done.vertex), 0.0, "the position lies nearer to the vertex that is gone");
}

#[test]
fn a_reset_value_is_the_default_again() {
    let (mut mesh, x) = with_x(Rule::reset());
    let h = halfedge(&mesh, DVec3::ZERO, DVec3::X);
    let new = mesh.split_edge(mesh.edge(h), DVec3::X * 0.25).expect("always");
    assert_eq!(*mesh.value(x, new.vertex), -1.0);
    assert_eq!(*mesh.value(x, vertex(&mesh, DVec3::X)), 1.0, "nothing else");
}

#[test]
fn a_custom_rule_sees_splits_merges_and_moves() {
    type Seen = Arc<Mutex<Vec<(Event, Vec<f64>)>>>;
    let seen: Seen = Arc::default();
    let log = Arc::clone(&seen);
    let rule = Rule::custom(move |event, sources: &[(&f64, f64)]| {
        log.lock().expect("one thread").push((event, sources.iter().map(|s| s.1).collect()));
        *sources[0].0
    });
    let (mut mesh, _) = with_x(rule);
    let h = halfedge(&mesh, DVec3::ZERO, DVec3::X);
    let new = mesh.split_edge(mesh.edge(h), DVec3::X * 0.25).expect("always");
    assert_eq!(*seen.lock().expect("one thread"), [(Event::Split, vec![0.75, 0.25])]);
    mesh.set_position(new.vertex, DVec3::X * 0.5).expect("finite");
    assert_eq!(seen.lock().expect("one thread").last(), Some(&(Event::Move, vec![1.0])));
    let h = mesh.find_halfedge(new.vertex, vertex(&mesh, DVec3::X)).expect("the new half");
    mesh.collapse(h, DVec3::X * 0.625).expect("a boundary edge");
    // The survivor's own value comes first; then it moves.
    let all = seen.lock().expect("one thread");
    assert_eq!(all[2..], [(Event::Merge, vec![0.25, 0.75]), (Event::Move, vec![1.0])]);
}

#[test]
fn a_refused_edit_asks_no_rule() {
    let rule = Rule::custom(|_, _: &[(&f64, f64)]| panic!("asked"));
    let (mut mesh, x) = with_x(rule);
    assert!(mesh.collapse(middle(&mesh), DVec3::X).is_err());
    assert!(mesh.split_edge(mesh.edge(middle(&mesh)), DVec3::NAN).is_err());
    assert_eq!(*mesh.value(x, vertex(&mesh, DVec3::X)), 1.0);
}

#[test]
fn an_edges_halves_keep_its_value_and_edges_that_become_one_are_merged() {
    let mut mesh = mesh(&grid(4));
    let mark = mesh.add_edge_column(false, Rule::custom(|_, s: &[(&bool, f64)]| s.iter().any(|s| *s.0)));
    let e = mesh.edges().find(|&e| !mesh.is_boundary_edge(e)).expect("inner");
    mesh.set_value(mark, e, true).expect("live");
    let new =
        mesh.split_edge_and_faces(e, mesh.position(mesh.origin(mesh.edge_halfedge(e))) + DVec3::X * 0.1);
    let new = new.expect("finite");
    assert!(*mesh.value(mark, new.edge) && *mesh.value(mark, e));
    assert!(new.cuts.iter().all(|c| !*mesh.value(mark, c.edge)), "a cut is made from nothing");
    // Collapse an edge beside the marked one, so that one of a triangle's sides is it.
    let before = mesh.edges().filter(|&e| *mesh.value(mark, e)).count();
    let h = mesh.find_halfedge(new.vertex, mesh.target(mesh.edge_halfedge(new.cuts[0].edge))).expect("a cut");
    mesh.collapse_into_target(h).expect("inside");
    let after = mesh.edges().filter(|&e| *mesh.value(mark, e)).count();
    assert_eq!((before, after), (2, 2), "both halves live on as the other sides of the triangles that went");
}

#[test]
fn faces_hand_their_value_to_their_parts_and_are_merged_by_area() {
    let mut mesh = two_squares();
    let area = mesh.add_face_column(0.0f64, Rule::interpolate());
    let [left, right] = [0, 1].map(|i| mesh.numbering().faces[i]);
    mesh.set_value(area, left, 10.0).expect("live");
    mesh.set_value(area, right, 40.0).expect("live");
    let poked = mesh.poke_face(left, dvec3(0.5, 0.5, 0.0)).expect("finite");
    assert!(poked.faces.iter().all(|&f| *mesh.value(area, f) == 10.0));
    // The triangle beside the right square has a quarter of its area.
    let joined = mesh.join_faces(mesh.edge(middle(&mesh))).expect("a triangle and a square");
    assert!((*mesh.value(area, joined.face) - (10.0 * 0.2 + 40.0 * 0.8)).abs() < 1e-12);
    let dissolved = mesh.dissolve_vertex(poked.vertex).expect("inside");
    assert!((*mesh.value(area, dissolved.faces[0]) - 25.0).abs() < 1e-12);
}

#[test]
fn what_is_made_from_nothing_holds_the_default() {
    let mut mesh = mesh(&tetrahedron());
    let (on_vertices, on_faces) =
        (mesh.add_vertex_column(1, Rule::keep()), mesh.add_face_column(2, Rule::keep()));
    let (on_corners, on_edges) =
        (mesh.add_corner_column(3, Rule::keep()), mesh.add_edge_column(4, Rule::keep()));
    let all = |mesh: &Mesh| {
        assert!(mesh.vertices().all(|v| *mesh.value(on_vertices, v) == 1));
        assert!(mesh.faces().all(|f| *mesh.value(on_faces, f) == 2));
        assert!(mesh.halfedges().all(|h| *mesh.value(on_corners, h) == 3));
        assert!(mesh.edges().all(|e| *mesh.value(on_edges, e) == 4));
    };
    all(&mesh);
    let f = mesh.faces().next().expect("four");
    mesh.set_value(on_faces, f, 20).expect("live");
    let corner = mesh.face_halfedge(f);
    mesh.set_value(on_corners, corner, 30).expect("live");
    mesh.remove_face(f).expect("closed");
    assert_eq!(*mesh.value(on_corners, corner), 3, "the half-edge lost its corner");
    mesh.fill_hole(corner).expect("a hole");
    let v = mesh.add_vertex(DVec3::ONE).expect("finite");
    let w = mesh.add_vertex(DVec3::X * 9.0).expect("finite");
    let u = mesh.add_vertex(DVec3::Y * 9.0).expect("finite");
    mesh.add_face(&[v, w, u]).expect("a component of its own");
    all(&mesh);
}

#[test]
fn slots_that_are_reused_forget_what_they_held() {
    let mut mesh = two_squares();
    let column = mesh.add_face_column(0, Rule::keep());
    let f = mesh.numbering().faces[1];
    mesh.set_value(column, f, 9).expect("live");
    mesh.remove_face(f).expect("an end");
    let corners = [DVec3::X, DVec3::X * 2.0, dvec3(2., 1., 0.), dvec3(1., 1., 0.)].map(|p| vertex(&mesh, p));
    let new = mesh.add_face(&corners).expect("where it was").face;
    assert_eq!((mesh.get_value(column, f), *mesh.value(column, new)), (None, 0));
}

#[test]
fn a_corner_keeps_its_value_when_its_face_is_cut() {
    let mut mesh = mesh(&cube());
    let column = mesh.add_corner_column(String::new(), Rule::keep());
    let name = |mesh: &Mesh, h| format!("{:?} {:?}", mesh.position(mesh.origin(h)), 0);
    for h in mesh.halfedges().collect::<Vec<_>>() {
        mesh.set_value(column, h, name(&mesh, h)).expect("closed");
    }
    for f in mesh.faces().collect::<Vec<_>>() {
        mesh.triangulate_face(f).expect("a square");
    }
    for e in mesh.edges().collect::<Vec<_>>() {
        let _ = mesh.flip_edge(e);
    }
    for h in mesh.halfedges() {
        assert_eq!(*mesh.value(column, h), name(&mesh, h));
    }
}

#[test]
fn reversing_moves_corner_data_with_the_corners() {
    let mut mesh = mesh(&grid(3));
    let column = mesh.add_corner_column(DVec3::ZERO, Rule::keep());
    let inner: Vec<_> = mesh.halfedges().filter(|&h| !mesh.is_boundary(h)).collect();
    for &h in &inner {
        mesh.set_value(column, h, mesh.position(mesh.origin(h))).expect("inner");
    }
    mesh.reverse();
    assert!(inner.iter().all(|&h| *mesh.value(column, h) == mesh.position(mesh.origin(h))));
}

// Linear functions.

/// A linear function of position.
fn linear(p: DVec3) -> f64 {
    p.dot(dvec3(3., -2., 0.5)) + 7.0
}

/// Splits, pokes, flips and cuts faces of a plane mesh at random, with a linear function on vertices and corners.
fn stays_linear(of: &IndexedMesh, seed: u64) {
    let mut mesh = mesh(of);
    let on_vertices = mesh.add_vertex_column(0.0, Rule::interpolate());
    let on_corners = mesh.add_corner_column(0.0, Rule::interpolate());
    for v in mesh.vertices().collect::<Vec<_>>() {
        mesh.set_value(on_vertices, v, linear(mesh.position(v))).expect("live");
    }
    for h in mesh.halfedges().filter(|&h| !mesh.is_boundary(h)).collect::<Vec<_>>() {
        mesh.set_value(on_corners, h, linear(mesh.position(mesh.origin(h)))).expect("inner");
    }
    let mut noise = Noise(seed);
    let mut done = [0; 4];
    for round in 0..400 {
        let edges: Vec<_> = mesh.edges().collect();
        let faces: Vec<_> = mesh.faces().collect();
        let e = edges[noise.below(edges.len() as u32) as usize];
        let f = faces[noise.below(faces.len() as u32) as usize];
        let h = mesh.edge_halfedge(e);
        let (a, b) = (mesh.position(mesh.origin(h)), mesh.position(mesh.target(h)));
        let ok = match round % 4 {
            0 => mesh.split_edge(e, a.lerp(b, 0.1 + 0.8 * noise.unit())).is_ok(),
            1 => {
                // A point of the face's plane near its middle: inside where the face is convex.
                let corners: Vec<_> = mesh.face_vertices(f).map(|v| mesh.position(v)).collect();
                mesh.poke_face(f, corners.iter().sum::<DVec3>() / corners.len() as f64).is_ok()
            }
            2 => mesh.flip_edge(e).is_ok(),
            _ => mesh.split_edge_and_faces(e, a.lerp(b, 0.1 + 0.8 * noise.unit())).is_ok(),
        };
        done[round % 4] += u32::from(ok);
    }
    assert!(done.iter().all(|&n| n > 20), "{done:?}");
    mesh.validate().expect("valid");
    for h in mesh.halfedges() {
        let expected = linear(mesh.position(mesh.origin(h)));
        assert!((mesh.value(on_vertices, mesh.origin(h)) - expected).abs() < 1e-12 * expected.abs().max(1.0));
        if !mesh.is_boundary(h) {
            let off = (mesh.value(on_corners, h) - expected).abs();
            assert!(off < 1e-12 * expected.abs().max(1.0), "off by {off}");
        }
    }
}

#[test]
fn a_linear_function_stays_linear_on_triangles() {
    stays_linear(&fanned(&two_squares().to_indexed()), 1);
}

#[test]
fn a_linear_function_stays_linear_on_polygons() {
    stays_linear(&two_squares().to_indexed(), 2);
}

#[test]
fn a_linear_function_stays_linear_in_concave_faces_and_in_space() {
    let l = [(0., 0.), (3., 0.), (3., 1.), (1., 1.), (1., 3.), (0., 3.)];
    // In a plane that lies aslant.
    let at = |(x, y): (f64, f64)| dvec3(x, y, 0.3 * x - 0.7 * y + 2.0);
    stays_linear(&pool(l.map(at).to_vec(), vec![vec![0, 1, 2, 3, 4, 5]]), 3);
    let dart = [(0., 0.), (2., 1.), (0., 2.), (0.5, 1.)];
    stays_linear(&pool(dart.map(at).to_vec(), vec![vec![0, 1, 2, 3]]), 4);
}

#[test]
fn a_linear_function_stays_linear_through_collapse_along_the_edge() {
    let mut mesh = mesh(&icosphere(3));
    let column = mesh.add_vertex_column(0.0, Rule::interpolate());
    for v in mesh.vertices().collect::<Vec<_>>() {
        mesh.set_value(column, v, linear(mesh.position(v))).expect("live");
    }
    let mut noise = Noise(5);
    for _ in 0..300 {
        let edges: Vec<_> = mesh.edges().collect();
        let h = mesh.edge_halfedge(edges[noise.below(edges.len() as u32) as usize]);
        let (a, b) = (mesh.position(mesh.origin(h)), mesh.position(mesh.target(h)));
        let _ = mesh.collapse(h, a.lerp(b, noise.unit()));
    }
    for v in mesh.vertices() {
        assert!((mesh.value(column, v) - linear(mesh.position(v))).abs() < 1e-12 * 10.0);
    }
}

// Seams.

/// A mesh with texture coordinates on its corners and a mark on the edges that are seams.
struct Mapped {
    mesh: Mesh,
    uv: Column<HalfedgeKey, DVec2>,
    mark: Column<EdgeKey, bool>,
}

impl Mapped {
    fn new(mut mesh: Mesh, uv: Column<HalfedgeKey, DVec2>) -> Self {
        // A split edge's halves stay marked; merged edges are marked if either was.
        let either = Rule::custom(|_, sources: &[(&bool, f64)]| sources.iter().any(|s| *s.0));
        let mark = mesh.add_edge_column(false, either);
        for e in mesh.edges().collect::<Vec<_>>() {
            let is_seam = mesh.is_seam(uv, e);
            mesh.set_value(mark, e, is_seam).expect("live");
        }
        Self { mesh, uv, mark }
    }

    /// Marked. An edge of the boundary is no seam, whatever it was merged from.
    fn is_marked(&self, e: EdgeKey) -> bool {
        *self.mesh.value(self.mark, e) && !self.mesh.is_boundary_edge(e)
    }

    /// Edges whose mark is not what they are.
    fn wrong(&self) -> Vec<EdgeKey> {
        self.mesh.edges().filter(|&e| self.is_marked(e) != self.mesh.is_seam(self.uv, e)).collect()
    }

    /// Whether the corners of a vertex hold more than one value.
    fn is_split(&self, v: VertexKey) -> bool {
        let mut values = self.mesh.outgoing(v).filter(|&h| !self.mesh.is_boundary(h));
        let first = values.next().map(|h| *self.mesh.value(self.uv, h));
        values.any(|h| Some(*self.mesh.value(self.uv, h)) != first)
    }

    /// Whether a collapse keeps every seam, by the page on columns: it moves no end of a seam, and merges no two seams.
    fn keeps_seams(&self, h: HalfedgeKey) -> bool {
        let sides = [h, self.mesh.twin(h)];
        let merges_two = sides.iter().any(|&h| {
            let others = [self.mesh.next(h), self.mesh.prev(h)].map(|h| self.mesh.edge(h));
            self.mesh.apex(h).is_some()
                && others.iter().all(|&e| self.is_marked(e) || self.mesh.is_boundary_edge(e))
        });
        // Whether both sides hold the same value at the end where a half-edge starts.
        let is_same = |h| self.mesh.value(self.uv, h) == self.mesh.value(self.uv, self.mesh.rotate_cw(h));
        let moves_end = self.is_marked(self.mesh.edge(h)) && sides.iter().any(|&h| is_same(h));
        !merges_two && !moves_end
    }

    /// One random operator; whether it was done.
    fn edit(&mut self, noise: &mut Noise, kind: u32) -> bool {
        let edges: Vec<_> = self.mesh.edges().collect();
        let e = edges[noise.below(edges.len() as u32) as usize];
        let h = self.mesh.edge_halfedge(e);
        let f = self.mesh.face(h);
        let (a, b) = (self.mesh.position(self.mesh.origin(h)), self.mesh.position(self.mesh.target(h)));
        let between = a.lerp(b, 0.25 + 0.5 * noise.unit());
        let corners = |m: &Mesh, f| m.face_halfedges(f).collect::<Vec<_>>();
        match kind {
            0 => self.mesh.split_edge(e, between).is_ok(),
            1 => self.mesh.split_edge_and_faces(e, between).is_ok(),
            2 => {
                let Some(f) = f else { return false };
                let all: Vec<_> = self.mesh.face_vertices(f).map(|v| self.mesh.position(v)).collect();
                self.mesh.poke_face(f, all.iter().sum::<DVec3>() / all.len() as f64).is_ok()
            }
            3..=5 => self.keeps_seams(h) && self.mesh.collapse(h, between).is_ok(),
            6 => {
                let Some(f) = f else { return false };
                let all = corners(&self.mesh, f);
                let [from, to] = [0, 1].map(|_| all[noise.below(all.len() as u32) as usize]);
                self.mesh.split_face(from, to).is_ok()
            }
            7 => f.is_some_and(|f| self.mesh.triangulate_face(f).is_ok()),
            8 => {
                let around: Vec<_> = self.mesh.outgoing(self.mesh.origin(h)).collect();
                let [first, last] = [0, 1].map(|_| around[noise.below(around.len() as u32) as usize]);
                let Ok(new) = self.mesh.split_vertex(first, last, between) else { return false };
                // An edge made from nothing: it is a seam if the vertex was split along one.
                let is_seam = self.mesh.is_seam(self.uv, new.edge);
                self.mesh.set_value(self.mark, new.edge, is_seam).expect("live");
                true
            }
            9 => !self.is_marked(e) && self.mesh.flip_edge(e).is_ok(),
            _ => {
                // A chain goes as a whole.
                let inner = |h| !self.is_marked(self.mesh.edge(h));
                let off_seams = [h, self.mesh.twin(h)]
                    .iter()
                    .all(|&h| inner(self.mesh.next(h)) && inner(self.mesh.prev(h)));
                !self.is_marked(e) && off_seams && self.mesh.join_faces(e).is_ok()
            }
        }
    }

    /// Random operators; after each, the mark tells the seams.
    fn survives(mut self, operators: u32, seed: u64) {
        let mut noise = Noise(seed);
        let mut done = [0u32; 11];
        let mut tries = 0;
        while done.iter().sum::<u32>() < operators {
            let kind = noise.below(11);
            let collapses = done[3] + done[4] + done[5];
            if self.edit(&mut noise, kind) {
                done[kind as usize] += 1;
                let wrong = self.wrong();
                assert!(
                    wrong.is_empty(),
                    "after {done:?}, {collapses} collapses: operator {kind} left {wrong:?}"
                );
            }
            tries += 1;
            assert!(tries < 100 * operators, "{done:?}");
        }
        self.mesh.validate().expect("valid");
        assert!(done[3..6].iter().sum::<u32>() > operators / 50, "collapses too: {done:?}");
        assert!(self.mesh.edges().any(|e| self.is_marked(e)), "some seams are left");
    }
}

/// A cube of which every face is a chart of its own.
fn mapped_cube(of: &IndexedMesh, per_face: usize) -> Mapped {
    let mut mesh = mesh(of);
    let uv = mesh.add_corner_column(DVec2::ZERO, Rule::interpolate());
    for (i, f) in mesh.numbering().faces.into_iter().enumerate() {
        let corner = dvec2((i / per_face) as f64 * 10.0, 1.0);
        for h in mesh.face_halfedges(f).collect::<Vec<_>>() {
            let p = mesh.position(mesh.origin(h));
            // Skew, so that no two vertices of a chart have one value.
            let at = dvec2(p.x + 0.3 * p.z, p.y + 0.6 * p.z + 0.1 * p.x);
            mesh.set_value(uv, h, corner + at).expect("closed");
        }
    }
    Mapped::new(mesh, uv)
}

#[test]
fn every_edge_of_a_mapped_cube_is_a_seam_and_no_diagonal() {
    let quads = mapped_cube(&cube(), 1);
    assert_eq!(quads.mesh.edges().filter(|&e| quads.is_marked(e)).count(), 12);
    let triangles = mapped_cube(&fanned(&cube()), 2);
    assert_eq!(triangles.mesh.edges().filter(|&e| triangles.is_marked(e)).count(), 12);
}

#[test]
fn a_mapped_cube_survives_a_thousand_random_operators() {
    for seed in 0..4 {
        mapped_cube(&cube(), 1).survives(1000, seed);
        mapped_cube(&fanned(&cube()), 2).survives(1000, 10 + seed);
    }
}

/// A plane grid, cut along a line that ends inside; the upper side is shifted by something that fades out.
fn cut_grid() -> Mapped {
    let mut mesh = mesh(&grid(8));
    let uv = mesh.add_corner_column(DVec2::ZERO, Rule::interpolate());
    for f in mesh.faces().collect::<Vec<_>>() {
        let middle: f64 = mesh.face_vertices(f).map(|v| mesh.position(v).y).sum::<f64>() / 3.0;
        for h in mesh.face_halfedges(f).collect::<Vec<_>>() {
            let p = mesh.position(mesh.origin(h));
            let on_cut = p.y == 4.0 && p.x < 5.0 && middle > 4.0;
            let shift = if on_cut { 0.1 * (5.0 - p.x) } else { 0.0 };
            mesh.set_value(uv, h, dvec2(p.x, p.y + shift)).expect("inner");
        }
    }
    Mapped::new(mesh, uv)
}

#[test]
fn a_seam_that_ends_inside_survives_a_thousand_random_operators() {
    let cut = cut_grid();
    assert_eq!(cut.mesh.edges().filter(|&e| cut.is_marked(e)).count(), 5);
    for seed in 0..4 {
        cut_grid().survives(1000, seed);
    }
}

#[test]
fn collapsing_the_last_edge_of_a_seam_moves_its_end() {
    for forward in [true, false] {
        let mut cut = cut_grid();
        // The last edge runs from (4, 4) to (5, 4), where both sides hold the same value.
        let at = |m: &Mesh, x: f64| {
            m.vertices().find(|&v| m.position(v).truncate() == dvec2(x, 4.0)).expect("there")
        };
        let (split, end) = (at(&cut.mesh, 4.0), at(&cut.mesh, 5.0));
        assert!(cut.is_split(split) && !cut.is_split(end));
        let h = if forward { (split, end) } else { (end, split) };
        let h = cut.mesh.find_halfedge(h.0, h.1).expect("the last edge");
        let middle = cut.mesh.position(split).midpoint(cut.mesh.position(end));
        let done = cut.mesh.collapse(h, middle).expect("inside");
        assert!(!cut.is_split(done.vertex));
        assert_eq!((cut.wrong(), cut.mesh.edges().filter(|&e| cut.is_marked(e)).count()), (vec![], 4));
        // The mean of both sides at (4, 4), half way to (5, 4).
        let h = cut.mesh.vertex_halfedge(done.vertex).expect("not isolated");
        assert!(cut.mesh.value(cut.uv, h).distance(dvec2(4.5, 4.025)) < 1e-12);
    }
}

#[test]
fn splitting_and_collapsing_along_a_seam_keeps_both_sides() {
    let mut cut = cut_grid();
    let at =
        |m: &Mesh, x: f64| m.vertices().find(|&v| m.position(v).truncate() == dvec2(x, 4.0)).expect("there");
    let (a, b) = (at(&cut.mesh, 2.0), at(&cut.mesh, 3.0));
    let h = cut.mesh.find_halfedge(a, b).expect("an edge of the seam");
    let middle = cut.mesh.position(a).midpoint(cut.mesh.position(b));
    let new = cut.mesh.split_edge_and_faces(cut.mesh.edge(h), middle).expect("finite");
    let values = |cut: &Mapped, v| {
        let mut all: Vec<_> = cut.mesh.outgoing(v).map(|h| cut.mesh.value(cut.uv, h).to_array()).collect();
        all.sort_by(|a, b| a.partial_cmp(b).expect("finite"));
        all.dedup();
        all
    };
    assert_eq!(values(&cut, new.vertex), [[2.5, 4.0], [2.5, 4.25]]);
    let h = cut.mesh.find_halfedge(new.vertex, b).expect("a half");
    cut.mesh.collapse_into_target(h).expect("inside");
    assert_eq!(values(&cut, b), [[3.0, 4.0], [3.0, 4.2]]);
    assert!(cut.wrong().is_empty());
}

#[test]
fn a_flip_off_seams_keeps_the_seams_around_it() {
    let mut mapped = mapped_cube(&fanned(&cube()), 2);
    for e in mapped.mesh.edges().collect::<Vec<_>>() {
        if !mapped.is_marked(e) {
            mapped.mesh.flip_edge(e).expect("a diagonal");
            assert!(mapped.wrong().is_empty());
        }
    }
}

/// Puts the texture coordinates of a soup that is a mesh already on its corners, if it is one.
fn mapped(soup: PolygonSoup) -> Option<Mapped> {
    let uvs: CornerData<[f64; 2]> = soup.corner_uvs.clone()?;
    let pool = IndexedMesh::new(soup.positions, soup.polygons).ok()?;
    let mut mesh = Mesh::build(&pool).ok()?;
    let values = uvs.indices.iter().map(|&i| uvs.values.get(i as usize).map(|&uv| DVec2::from(uv)));
    let values: Vec<DVec2> = values.collect::<Option<_>>()?;
    // Corners stand in the order of the pool, which is the file's.
    let values = ColumnValues { default: DVec2::ZERO, values };
    let uv = mesh.import_column::<HalfedgeKey, _>(values, Rule::interpolate()).ok()?;
    Some(Mapped::new(mesh, uv))
}

#[test]
fn mapped_corpus_models_survive_a_thousand_random_operators() {
    let Some(rows) = corpus::rows() else { return };
    let (mut survived, mut seed) = (Vec::new(), 0);
    for row in rows.iter().filter(|r| r.get("features").split(',').any(|f| f == "uv")) {
        let Ok(soup) = row.load() else { continue };
        let Some(mapped) = mapped(soup) else { continue };
        // A seam of which every vertex but the ends holds two values; and not so large that checking takes long.
        if mapped.mesh.face_count() < 100
            || mapped.mesh.face_count() > 6000
            || !mapped.mesh.edges().any(|e| mapped.is_marked(e))
        {
            continue;
        }
        seed += 1;
        eprintln!("{} with {} seams", row.path, mapped.mesh.edges().filter(|&e| mapped.is_marked(e)).count());
        mapped.survives(1000, seed);
        survived.push(&row.path);
    }
    assert!(survived.len() >= 3, "{survived:?}");
}

// Columns.

#[test]
fn a_boundary_half_edge_has_no_corner() {
    let mut mesh = two_squares();
    let column = mesh.add_corner_column(5, Rule::keep());
    let outer = mesh.boundary_halfedges().next().expect("open");
    assert_eq!(mesh.set_value(column, outer, 1), Err(ColumnError::NoCorner(outer)));
    assert_eq!(*mesh.value(column, outer), 5);
    assert!(!mesh.is_seam(column, mesh.edge(outer)));
}

#[test]
fn a_removed_column_is_gone_and_its_place_is_not_taken() {
    let mut mesh = two_squares();
    let first = mesh.add_vertex_column(1, Rule::keep());
    let v = mesh.vertices().next().expect("six");
    assert!(mesh.remove_column(first));
    let second = mesh.add_vertex_column(2, Rule::keep());
    assert!(!mesh.remove_column(first) && !mesh.has_column(first) && mesh.has_column(second));
    assert_eq!(mesh.get_value(first, v), None);
    assert_eq!(mesh.set_value(first, v, 3), Err(ColumnError::NoColumn));
    assert_eq!(mesh.export_column(first), Err(ColumnError::NoColumn));
    let e = mesh.edges().next().expect("seven");
    mesh.split_edge(e, DVec3::ONE).expect("always");
    assert_eq!(*mesh.value(second, v), 2);
}

#[test]
#[should_panic(expected = "Column(0) names no live")]
fn reading_a_removed_column_panics() {
    let mut mesh = two_squares();
    let column = mesh.add_vertex_column(1, Rule::keep());
    let v = mesh.vertices().next().expect("six");
    mesh.remove_column(column);
    let _ = mesh.value(column, v);
}

#[test]
fn a_dead_key_has_no_value() {
    let mut mesh = two_squares();
    let column = mesh.add_face_column(1, Rule::keep());
    let f = mesh.faces().next().expect("two");
    mesh.remove_face(f).expect("an end");
    assert_eq!(mesh.get_value(column, f), None);
    assert_eq!(mesh.set_value(column, f, 2), Err(ColumnError::Missing));
}

#[test]
fn a_column_of_another_type_is_not_read_as_this_one() {
    let mut a = two_squares();
    let mut b = two_squares();
    let numbers = a.add_vertex_column(1u32, Rule::keep());
    b.add_vertex_column("one".to_owned(), Rule::keep());
    let v = b.vertices().next().expect("six");
    assert_eq!((b.get_value(numbers, v), b.has_column(numbers)), (None, false));
    assert_eq!(b.set_value(numbers, v, 7), Err(ColumnError::NoColumn));
    assert!(!b.remove_column(numbers));
}

#[test]
fn a_clone_has_columns_of_its_own() {
    let (mut mesh, x) = with_x(Rule::interpolate());
    let mut clone = mesh.clone();
    let v = mesh.vertices().next().expect("six");
    let before = *mesh.value(x, v);
    clone.set_value(x, v, 99.0).expect("live");
    assert_eq!(*mesh.value(x, v), before);
    mesh.remove_column(x);
    let e = clone.edges().next().expect("seven");
    let new = clone.split_edge(e, DVec3::ONE).expect("always");
    assert!(clone.get_value(x, new.vertex).is_some());
}

#[test]
fn columns_go_out_and_come_back_in_the_order_of_the_indexed_form() {
    let mut a = mesh(&grid(3));
    let e = a.edges().nth(7).expect("many");
    let new = a.split_edge_and_faces(e, DVec3::ONE).expect("finite");
    a.collapse_into_target(a.edge_halfedge(new.cuts[0].edge)).expect("a cut");
    fn round<K: meshwright::ElementKey>(a: &mut Mesh, keys: impl Fn(&Mesh) -> Vec<K>) {
        let column: Column<K, String> = a.add_column(String::new(), Rule::keep());
        for (i, k) in keys(a).into_iter().enumerate() {
            // Boundary half-edges have no corner.
            let _ = a.set_value(column, k, format!("value {i}"));
        }
        let out = a.export_column(column).expect("there");
        let mut b = Mesh::build(&a.to_indexed()).expect("valid");
        let text = serde_json_round(&out);
        let column = b.import_column::<K, _>(text, Rule::keep()).expect("as many");
        assert_eq!(b.export_column(column), Ok(out.clone()));
        let short = ColumnValues { default: String::new(), values: out.values[1..].to_vec() };
        let (values, elements) = (short.values.len(), out.values.len());
        assert_eq!(
            b.import_column::<K, _>(short, Rule::keep()),
            Err(ColumnError::Count { values, elements })
        );
    }
    round::<VertexKey>(&mut a, |m| m.vertices().collect());
    round::<HalfedgeKey>(&mut a, |m| m.halfedges().collect());
    round::<EdgeKey>(&mut a, |m| m.edges().collect());
    round::<FaceKey>(&mut a, |m| m.faces().collect());
}

#[cfg(feature = "serde")]
fn serde_json_round(values: &ColumnValues<String>) -> ColumnValues<String> {
    let text = serde_json::to_string(values).expect("serialises");
    serde_json::from_str(&text).expect("comes back")
}

#[cfg(not(feature = "serde"))]
fn serde_json_round(values: &ColumnValues<String>) -> ColumnValues<String> {
    values.clone()
}

#[test]
fn corners_go_out_in_the_order_of_the_pools_corners() {
    let mut mesh = mesh(&grid(3));
    let column = mesh.add_corner_column(DVec3::ZERO, Rule::keep());
    for h in mesh.halfedges().filter(|&h| !mesh.is_boundary(h)).collect::<Vec<_>>() {
        mesh.set_value(column, h, mesh.position(mesh.origin(h))).expect("inner");
    }
    let out = mesh.export_column(column).expect("there");
    let pool = mesh.to_indexed();
    let expected = pool.polygons().corners().iter().map(|&v| pool.positions()[v as usize]);
    assert!(out.values.iter().copied().eq(expected));
}

#[test]
fn carried_normals_are_mixed_and_stay_of_unit_length() {
    let mut mesh = mesh(&icosphere(2));
    mesh.compute_normals(NormalWeight::default());
    let e = mesh.edges().next().expect("many");
    let h = mesh.edge_halfedge(e);
    let ends = [mesh.origin(h), mesh.target(h)].map(|v| (mesh.position(v), mesh.normal(v).expect("carried")));
    let new = mesh.split_edge_and_faces(e, ends[0].0.midpoint(ends[1].0)).expect("finite");
    let normal = mesh.normal(new.vertex).expect("carried");
    assert!((normal.length() - 1.0).abs() < 1e-12);
    assert!(normal.distance((ends[0].1 + ends[1].1).normalize()) < 1e-9);
    let moved = mesh.normal(new.vertex);
    mesh.set_position(new.vertex, DVec3::ONE).expect("finite");
    assert_eq!(mesh.normal(new.vertex), moved);
}
