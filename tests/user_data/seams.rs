//! Seams of texture coordinates through every operator.

use crate::corpus;
use crate::shapes::{Noise, cube, fanned, grid, mesh, pool};
use meshwright::glam::{DVec2, DVec3, dvec2, dvec3};
use meshwright::{
    Column, ColumnValues, CornerData, EdgeKey, HalfedgeKey, IndexedMesh, Mesh, PolygonSoup, Rule, VertexKey,
};

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

/// A fan of six triangles around vertex 0, with a second one from behind around vertex 7 if it is to be closed. All its
/// triangles hold `left` or `right`, but the one at the edge 1-2, which holds something else.
fn wedge(closed: bool, left: u32, right: u32) -> (Mesh, Column<HalfedgeKey, u32>) {
    let rim = (0..6).map(|i| {
        let (y, x) = (f64::from(i) * std::f64::consts::FRAC_PI_3).sin_cos();
        dvec3(x, y, 0.0)
    });
    let points = [DVec3::Z].into_iter().chain(rim).chain([-DVec3::Z]).collect();
    let mut faces: Vec<Vec<u32>> = (0..6).map(|i| vec![0, 1 + i, 1 + (i + 1) % 6]).collect();
    if closed {
        faces.extend((0..6).map(|i| vec![7, 1 + (i + 1) % 6, 1 + i]));
    }
    let mut mesh = mesh(&pool(points, faces));
    let chart = mesh.add_corner_column(0, Rule::keep());
    for (i, f) in mesh.faces().collect::<Vec<_>>().into_iter().enumerate() {
        let value = [9, left, left, left, right, right][i % 6];
        for h in mesh.face_halfedges(f).collect::<Vec<_>>() {
            mesh.set_value(chart, h, value).expect("a corner");
        }
    }
    (mesh, chart)
}

#[test]
fn collapsing_the_last_triangle_between_two_seams_merges_them() {
    for closed in [false, true] {
        for right in [1, 2] {
            for forward in [false, true] {
                let (mut mesh, chart) = wedge(closed, 1, right);
                let v: Vec<_> = mesh.vertices().collect();
                let sides = [1, 2].map(|i| mesh.find_halfedge(v[0], v[i]).expect("a spoke"));
                assert!(sides.iter().all(|&h| mesh.is_seam(chart, mesh.edge(h))), "two seams");
                let (from, to) = if forward { (v[1], v[2]) } else { (v[2], v[1]) };
                let h = mesh.find_halfedge(from, to).expect("an edge of the rim");
                let done = mesh.collapse_to_midpoint(h).expect("legal");
                mesh.validate().expect("valid");
                let merged = mesh.find_halfedge(v[0], done.vertex).expect("the two spokes in one");
                // The right side of the fan lies before the wedge, the left side after it.
                let beyond = [merged, mesh.next(mesh.twin(merged))].map(|h| *mesh.value(chart, h));
                assert_eq!(beyond, [1, right], "both sides keep their values");
                assert_eq!(mesh.is_seam(chart, mesh.edge(merged)), right != 1, "a seam if they differ");
                // No corner holds what only the triangle between held.
                let inner = mesh.halfedges().filter(|&h| !mesh.is_boundary(h));
                assert!(inner.clone().all(|h| *mesh.value(chart, h) != 9));
            }
        }
    }
}
