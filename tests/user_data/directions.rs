//! Columns of directions turn with the mesh.

use crate::shapes::{Noise, both, cube, cube_at, icosphere, mesh, torus};
use meshwright::glam::{DAffine3, DMat3, DMat4, DVec3, DVec4, Vec3, dvec3, dvec4};
use meshwright::{
    Column, Direction, EdgeKey, ElementKey, FaceKey, HalfedgeKey, Mesh, NormalWeight, Rule, Scheme,
    SubdivideOptions, UnweldOptions, VertexKey, WeldOptions,
};
use proptest::prelude::*;

/// Columns of directions on all kinds of elements, which hold what the mesh itself says.
struct Columns {
    /// Face normals at vertices' first faces.
    vertices: Column<VertexKey, DVec3>,
    /// The normals of corners' faces.
    corners: Column<HalfedgeKey, Option<DVec3>>,
    /// From each edge's first end to its second.
    edges: Column<EdgeKey, DVec3>,
    /// Face normals.
    faces: Column<FaceKey, DVec3>,
    /// From a corner to the next, and on which side of it its face lies, seen from outside.
    along: Column<HalfedgeKey, DVec4>,
}

fn corners(mesh: &Mesh) -> Vec<HalfedgeKey> {
    mesh.halfedges().filter(|&h| !mesh.is_boundary(h)).collect()
}

fn set_all<K: ElementKey, T: meshwright::Value>(
    mesh: &mut Mesh,
    column: Column<K, T>,
    keys: impl Fn(&Mesh) -> Vec<K>,
    of: impl Fn(&Mesh, K) -> T,
) {
    for key in keys(mesh) {
        let value = of(mesh, key);
        mesh.set_value(column, key, value).expect("live");
    }
}

fn step(mesh: &Mesh, h: HalfedgeKey) -> DVec3 {
    mesh.position(mesh.target(h)) - mesh.position(mesh.origin(h))
}

/// The normal of one of its faces that stays the same whichever way the surface is wound.
fn first_face_normal(mesh: &Mesh, v: VertexKey) -> DVec3 {
    mesh.face_normal(mesh.faces_around(v).min().expect("a face"))
}

fn corner_normal(mesh: &Mesh, h: HalfedgeKey) -> Option<DVec3> {
    mesh.face(h).map(|f| mesh.face_normal(f))
}

impl Columns {
    fn on(mesh: &mut Mesh) -> Self {
        let columns = Self {
            vertices: mesh.add_vertex_column(DVec3::ZERO, Rule::normals()),
            corners: mesh.add_corner_column(None, Rule::normals()),
            edges: mesh.add_edge_column(DVec3::ZERO, Rule::tangents()),
            faces: mesh.add_face_column(DVec3::ZERO, Rule::keep().turning(|n, by| by.normal(*n))),
            along: mesh.add_corner_column(DVec4::ZERO, Rule::tangents()),
        };
        set_all(mesh, columns.vertices, |m| m.vertices().collect(), first_face_normal);
        set_all(mesh, columns.corners, corners, corner_normal);
        set_all(mesh, columns.edges, |m| m.edges().collect(), |m, e| step(m, m.edge_halfedge(e)));
        set_all(mesh, columns.faces, |m| m.faces().collect(), |m, f| m.face_normal(f));
        // Towards the face's inside: the normal across the step, whose handedness is 1.
        set_all(mesh, columns.along, corners, |m, h| step(m, h).extend(1.0));
        columns
    }

    /// How far what they hold is from what the mesh says, by its own lengths. Flips turn half-edges around: what was
    /// the step from a corner to the next may be that from the one before.
    fn off(&self, mesh: &Mesh) -> f64 {
        let apart = |a: DVec3, b: DVec3| (a - b).length() / b.length().max(1e-300);
        let either = |a: DVec3, b: DVec3| apart(a, b).min(apart(-a, b));
        let on_vertices =
            mesh.vertices().map(|v| apart(*mesh.value(self.vertices, v), first_face_normal(mesh, v)));
        let of_corner =
            |h| apart(mesh.value(self.corners, h).expect("set"), corner_normal(mesh, h).expect("a corner"));
        let on_edges =
            mesh.edges().map(|e| either(*mesh.value(self.edges, e), step(mesh, mesh.edge_halfedge(e))));
        let on_faces = mesh.faces().map(|f| apart(*mesh.value(self.faces, f), mesh.face_normal(f)));
        let of_along = |h| {
            let held = *mesh.value(self.along, h);
            let [ahead, back] = [step(mesh, h), -step(mesh, mesh.prev(h))];
            // The bitangent points into the face on whichever side the tangent has it.
            let inward = mesh.face_normal(mesh.face(h).expect("a corner")).cross(held.truncate()) * held.w;
            let is_inward = inward.dot(ahead + back) > 0.0;
            apart(held.truncate(), ahead).min(apart(held.truncate(), back))
                + if is_inward { 0.0 } else { 9.0 }
        };
        let corners = corners(mesh);
        let on_corners = corners.iter().flat_map(|&h| [of_corner(h), of_along(h)]);
        on_vertices.chain(on_edges).chain(on_faces).chain(on_corners).fold(0.0, f64::max)
    }

    /// All that they hold, to compare.
    fn all(&self, mesh: &Mesh) -> impl PartialEq + std::fmt::Debug + use<> {
        (
            mesh.export_column(self.vertices).expect("there"),
            mesh.export_column(self.corners).expect("there"),
            mesh.export_column(self.edges).expect("there"),
            mesh.export_column(self.faces).expect("there"),
            mesh.export_column(self.along).expect("there"),
        )
    }
}

fn maps() -> [DAffine3; 4] {
    let shear = DMat3::from_cols(dvec3(2.0, 0.1, 0.0), dvec3(0.5, 1.0, 0.2), dvec3(0.0, 0.3, 3.0));
    [
        shear,
        shear * -1.0,
        DMat3::from_diagonal(dvec3(1e-3, 1.0, 1e3)),
        DMat3::from_diagonal(dvec3(1.0, -2.0, 3.0)),
    ]
    .map(|m| DAffine3::from_mat3_translation(m, dvec3(1.0, 2.0, 3.0)))
}

#[test]
fn directions_on_vertices_corners_edges_and_faces_turn_with_the_mesh() {
    for pool in [cube(), icosphere(2), both(&cube_at(DVec3::splat(7.0)), &crate::shapes::grid(3))] {
        let mut start = mesh(&pool);
        let columns = Columns::on(&mut start);
        assert_eq!(columns.off(&start), 0.0);
        type Map = fn(&mut Mesh) -> Result<(), meshwright::TransformError>;
        let turns: [(&str, Map); 7] = [
            ("translate", |m| m.translate(dvec3(4.0, 5.0, 6.0))),
            ("scale", |m| m.scale(3.0, DVec3::ONE)),
            ("mirror at a point", |m| m.scale(-0.5, DVec3::ONE)),
            ("scale axes", |m| m.scale_axes(dvec3(1.0, 2.0, 30.0), DVec3::ONE)),
            ("mirror", |m| m.scale_axes(dvec3(-1.0, 1.0, 1.0), DVec3::ONE)),
            ("rotate", |m| m.rotate_degrees(dvec3(1.0, 2.0, 3.0), 77.0, DVec3::ONE)),
            ("matrix", |m| m.transform_matrix(&DMat4::from_euler(Default::default(), 1.0, 2.0, 3.0))),
        ];
        for (name, turn) in turns {
            let mut mesh = start.clone();
            turn(&mut mesh).expect("mapped");
            assert!(columns.off(&mesh) < 1e-12, "{name}: {}", columns.off(&mesh));
        }
        for map in maps() {
            let mut mesh = start.clone();
            mesh.transform(&map).expect("mapped");
            assert!(columns.off(&mesh) < 1e-9, "{map}: {}", columns.off(&mesh));
        }
        let mut flipped = start.clone();
        flipped.reverse();
        assert!(columns.off(&flipped) < 1e-12, "flip");
    }
}

#[test]
fn columns_of_normals_hold_what_the_carried_ones_do() {
    let mut mesh = mesh(&torus(9, 7));
    mesh.compute_normals(NormalWeight::Angle);
    let own = mesh.add_vertex_column(DVec3::ZERO, Rule::normals());
    let narrow = mesh.add_vertex_column(Vec3::ZERO, Rule::normals());
    let on_corners = mesh.add_corner_column(None, Rule::normals());
    let carried = |m: &Mesh, v| m.normal(v).expect("carried");
    set_all(&mut mesh, own, |m| m.vertices().collect(), carried);
    set_all(&mut mesh, narrow, |m| m.vertices().collect(), |m, v| carried(m, v).as_vec3());
    for h in corners(&mesh) {
        let normal = mesh.face_normal(mesh.face(h).expect("closed"));
        mesh.set_corner_normal(h, Some(normal)).expect("a corner");
        mesh.set_value(on_corners, h, Some(normal)).expect("a corner");
    }
    let mut noise = Noise(5);
    for round in 0..12 {
        match round % 4 {
            0 => mesh.rotate_degrees(dvec3(1.0, -2.0, 0.5), 33.0, DVec3::ONE).expect("turned"),
            1 => mesh.scale_axes(dvec3(-1.5, 1.0, 0.7), DVec3::ONE).expect("scaled"),
            2 => mesh.reverse(),
            _ => mesh.transform(&maps()[1]).expect("mapped"),
        }
        // Splits and collapses mix both alike.
        for _ in 0..4 {
            let edges: Vec<_> = mesh.edges().collect();
            let e = edges[noise.below(edges.len() as u32) as usize];
            let h = mesh.edge_halfedge(e);
            let middle = (mesh.position(mesh.origin(h)) + mesh.position(mesh.target(h))) / 2.0;
            mesh.split_edge_and_faces(e, middle).expect("finite");
            let _ =
                mesh.collapse_to_midpoint(mesh.edge_halfedge(edges[noise.below(40) as usize % edges.len()]));
        }
        assert!(mesh.vertices().all(|v| mesh.normal(v) == Some(*mesh.value(own, v))), "{round}");
        assert!(
            corners(&mesh).iter().all(|&h| mesh.corner_normal(h) == *mesh.value(on_corners, h)),
            "{round}"
        );
        let near = |v| mesh.value(narrow, v).as_dvec3().distance(*mesh.value(own, v)) < 1e-5;
        assert!(mesh.vertices().all(near), "{round}");
    }
}

#[test]
fn only_what_is_flipped_is_negated_and_a_handedness_changes_with_it() {
    let mut mesh = mesh(&both(&cube(), &cube_at(DVec3::splat(5.0))));
    let columns = Columns::on(&mut mesh);
    let before = columns.all(&mesh);
    let [first, last] = [mesh.faces().next(), mesh.faces().last()].map(|f| f.expect("twelve"));
    let [n, m] = [first, last].map(|f| *mesh.value(columns.faces, f));
    mesh.reverse_component(first).expect("live");
    assert_eq!([first, last].map(|f| *mesh.value(columns.faces, f)), [-n, m]);
    let handed = |mesh: &Mesh, f| mesh.value(columns.along, mesh.face_halfedge(f)).w;
    assert_eq!([first, last].map(|f| handed(&mesh, f)), [-1.0, 1.0]);
    assert!(columns.off(&mesh) < 1e-12);
    mesh.reverse_component(first).expect("live");
    assert!(columns.all(&mesh) == before, "twice is the identity");
}

#[test]
fn columns_of_other_rules_and_defaults_are_not_turned() {
    let mut mesh = mesh(&cube());
    let plain = mesh.add_vertex_column(DVec3::X, Rule::interpolate());
    let normals = mesh.add_vertex_column(DVec3::X, Rule::normals());
    mesh.rotate_degrees(DVec3::Z, 90.0, DVec3::ZERO).expect("turned");
    assert!(
        mesh.vertices().all(|v| *mesh.value(plain, v) == DVec3::X && *mesh.value(normals, v) == DVec3::Y)
    );
    let new = mesh.add_vertex(DVec3::ONE).expect("finite");
    assert_eq!(*mesh.value(normals, new), DVec3::X, "a new element holds the default as it was stated");
}

#[test]
fn quarter_turns_of_directions_are_exact() {
    let mut mesh = mesh(&cube());
    let tangent = mesh.add_face_column(dvec4(0.1, 0.2, 0.3, -1.0), Rule::tangents());
    let f = mesh.faces().next().expect("six");
    mesh.rotate_degrees(DVec3::Z, 90.0, DVec3::ONE).expect("turned");
    assert_eq!(*mesh.value(tangent, f), dvec4(-0.2, 0.1, 0.3, -1.0));
}

#[test]
fn a_checkpoint_takes_turned_directions_back() {
    let mut mesh = mesh(&torus(6, 5));
    let columns = Columns::on(&mut mesh);
    let first = mesh.faces().next().expect("many");
    let before = (columns.all(&mesh), mesh.to_indexed());
    let outer = mesh.checkpoint();
    mesh.rotate_degrees(dvec3(1.0, 2.0, 3.0), 40.0, DVec3::ONE).expect("turned");
    let between = (columns.all(&mesh), mesh.to_indexed());
    let inner = mesh.checkpoint();
    mesh.scale_axes(dvec3(-1.0, 2.0, 1.0), DVec3::ZERO).expect("scaled");
    mesh.reverse_component(first).expect("live");
    mesh.set_value(columns.faces, first, DVec3::X).expect("live");
    mesh.transform(&maps()[0]).expect("mapped");
    mesh.reverse();
    assert!((columns.all(&mesh), mesh.to_indexed()) != between);
    mesh.restore(inner).expect("known");
    assert!((columns.all(&mesh), mesh.to_indexed()) == between);
    mesh.restore(outer).expect("known");
    assert!((columns.all(&mesh), mesh.to_indexed()) == before);
    assert_eq!(mesh.validate(), Ok(()));
    // Forgetting leaves nothing behind that a later restore could mix up.
    mesh.reverse();
    let reversed = columns.all(&mesh);
    mesh.forget_checkpoints();
    let again = mesh.checkpoint();
    mesh.rotate_degrees(DVec3::X, 90.0, DVec3::ZERO).expect("turned");
    mesh.restore(again).expect("known");
    assert!(columns.all(&mesh) == reversed);
}

#[test]
fn a_refused_transform_turns_nothing() {
    let mut mesh = mesh(&cube());
    let columns = Columns::on(&mut mesh);
    let before = columns.all(&mesh);
    assert!(mesh.scale(0.0, DVec3::ZERO).is_err());
    assert!(mesh.rotate_degrees(DVec3::ZERO, 9.0, DVec3::ZERO).is_err());
    assert!(mesh.scale_axes(dvec3(-1e308, 1.0, 1.0), DVec3::splat(1e300)).is_err());
    assert!(columns.all(&mesh) == before);
}

#[test]
fn columns_that_come_along_still_turn() {
    let mut mesh = mesh(&cube());
    let normals = mesh.add_face_column(DVec3::ZERO, Rule::normals());
    set_all(&mut mesh, normals, |m| m.faces().collect(), |m, f| m.face_normal(f));
    let saved = mesh.export_column(normals).expect("there");
    let mut again = Mesh::build(&mesh.to_indexed()).expect("valid");
    let imported = again.import_column::<FaceKey, _>(saved, Rule::normals()).expect("as many");
    assert_eq!(imported, normals);
    let fine = mesh.subdivide(SubdivideOptions { scheme: Scheme::Midpoint, ..Default::default() });
    let parted = mesh.unweld(UnweldOptions { degrees: 30.0, ..Default::default() }).expect("parted").value;
    let welded = parted.weld(WeldOptions::default()).expect("welded").value;
    for mut copy in [mesh.clone(), mesh.reorder(), again, fine.expect("cut").value, parted, welded] {
        copy.rotate_degrees(dvec3(1.0, 2.0, 3.0), 50.0, DVec3::ZERO).expect("turned");
        copy.scale_axes(dvec3(1.0, -2.0, 1.0), DVec3::ZERO).expect("scaled");
        assert!(copy.faces().all(|f| copy.value(normals, f).distance(copy.face_normal(f)) < 1e-12));
    }
}

#[test]
fn tangents_are_mixed_linearly_and_normals_to_unit_length() {
    let mut mesh = crate::two_squares();
    let tangents = mesh.add_vertex_column(dvec4(3.0, 0.0, 0.0, 1.0), Rule::tangents());
    let normals = mesh.add_vertex_column(Some(DVec3::Z * 2.0), Rule::normals());
    let h = crate::halfedge(&mesh, DVec3::ZERO, DVec3::X);
    let (a, b) = (mesh.origin(h), mesh.target(h));
    mesh.set_value(tangents, b, dvec4(0.0, 7.0, 0.0, -1.0)).expect("live");
    mesh.set_value(normals, b, Some(DVec3::Y)).expect("live");
    let new = mesh.split_edge(mesh.edge(h), DVec3::X * 0.25).expect("always").vertex;
    assert_eq!(*mesh.value(tangents, new), dvec4(2.25, 1.75, 0.0, 1.0), "the handedness of the nearer end");
    let normal = mesh.value(normals, new).expect("both have one");
    assert!(normal.distance(dvec3(0.0, 1.0, 3.0).normalize()) < 1e-15);
    mesh.set_value(normals, a, None).expect("live");
    let h = mesh.find_halfedge(a, new).expect("the nearer half");
    let middle = mesh.split_edge(mesh.edge(h), DVec3::X * 0.125).expect("always").vertex;
    assert_eq!(*mesh.value(normals, middle), None);
    assert_eq!(format!("{:?}", Rule::<DVec3>::normals()), "Rule::normals()");
}

#[test]
fn numbers_at_the_ends_of_the_range_keep_their_direction_and_what_is_no_number_stays() {
    let mut mesh = mesh(&cube());
    let tangent = mesh.add_face_column(DVec3::ZERO, Rule::tangents());
    let normal = mesh.add_face_column(DVec3::ZERO, Rule::normals());
    let narrow = mesh.add_face_column(Vec3::X * 1e30, Rule::tangents());
    let f: Vec<_> = mesh.faces().collect();
    let values = [
        DVec3::X * f64::MAX,
        dvec3(0.0, f64::MAX, f64::MAX),
        DVec3::ZERO,
        DVec3::INFINITY,
        DVec3::Y * 5e-324,
    ];
    for (&f, v) in f.iter().zip(values) {
        mesh.set_value(tangent, f, v).expect("live");
        mesh.set_value(normal, f, v).expect("live");
    }
    mesh.scale_axes(dvec3(1e200, 1e200, -1e200), DVec3::ZERO).expect("scaled");
    for (&f, v) in f.iter().zip(values) {
        for held in [mesh.value(tangent, f), mesh.value(normal, f)] {
            if v.is_finite() {
                let expected = v * dvec3(1e-300, 1e-300, -1e-300);
                assert!(held.is_finite() && (*held == DVec3::ZERO) == (v == DVec3::ZERO), "{v} {held}");
                assert!((*held * 1e-300).cross(expected).length() <= 1e-12 * held.length(), "{v} {held}");
            } else {
                assert_eq!(*held, v);
            }
        }
        assert_eq!(*mesh.value(narrow, f), Vec3::X);
    }
}

/// A frame of a caller's own turns by whatever it says.
#[derive(Clone, Debug, PartialEq)]
struct Frame {
    tangent: Option<DVec3>,
    name: &'static str,
}

impl Direction for Frame {
    fn vector(&self) -> Option<DVec3> {
        self.tangent
    }

    fn with_vector(&self, vector: DVec3, _: bool) -> Self {
        Self { tangent: Some(vector), ..self.clone() }
    }
}

#[test]
fn values_of_the_callers_own_turn_too() {
    let mut mesh = mesh(&cube());
    let frame = mesh.add_vertex_column(Frame { tangent: Some(DVec3::X), name: "east" }, Rule::tangents());
    let stress = mesh.add_face_column(
        DMat3::from_diagonal(dvec3(1.0, 0.0, 0.0)),
        Rule::keep().turning(|t: &DMat3, by| by.linear() * *t * by.linear().transpose()),
    );
    let flips = mesh.add_face_column(0, Rule::keep().turning(|n, by| n + i32::from(by.flips())));
    mesh.rotate_degrees(DVec3::Z, 90.0, DVec3::ZERO).expect("turned");
    mesh.scale(-1.0, DVec3::ZERO).expect("mirrored");
    mesh.reverse();
    let v = mesh.vertices().next().expect("eight");
    assert_eq!(*mesh.value(frame, v), Frame { tangent: Some(DVec3::NEG_Y), name: "east" });
    let f = mesh.faces().next().expect("six");
    assert_eq!(*mesh.value(stress, f), DMat3::from_diagonal(dvec3(0.0, 1.0, 0.0)));
    assert_eq!(*mesh.value(flips, f), 2);
}

fn vector() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-10.0f64..10.0).prop_map(DVec3::from)
}

proptest! {
    #[test]
    fn directions_turned_there_and_back_are_what_they_were(
        axis in vector(), origin in vector(), degrees in -400.0f64..400.0, factors in prop::array::uniform3(prop_oneof![-5.0f64..-0.2, 0.2f64..5.0]),
    ) {
        prop_assume!(axis.length() > 1e-3);
        let mut mesh = mesh(&icosphere(1));
        let columns = Columns::on(&mut mesh);
        let held = |m: &Mesh| -> Vec<DVec3> {
            let faces = m.faces().map(|f| *m.value(columns.faces, f));
            let edges = m.edges().map(|e| *m.value(columns.edges, e));
            let corners = m.halfedges().map(|h| m.value(columns.corners, h).expect("closed"));
            faces.chain(edges).chain(corners).chain(m.vertices().map(|v| *m.value(columns.vertices, v))).collect()
        };
        let before = held(&mesh);
        mesh.rotate_degrees(axis, degrees, origin).expect("turned");
        prop_assert!(columns.off(&mesh) < 1e-11);
        mesh.rotate_degrees(axis, -degrees, origin).expect("turned");
        let near = |m: &Mesh| held(m).iter().zip(&before).all(|(a, b)| a.distance(*b) < 1e-12);
        prop_assert!(near(&mesh));
        let factors = DVec3::from(factors);
        mesh.scale_axes(factors, origin).expect("scaled");
        prop_assert!(columns.off(&mesh) < 1e-11);
        mesh.scale_axes(factors.recip(), origin).expect("scaled");
        prop_assert!(near(&mesh));
        prop_assert!(mesh.halfedges().all(|h| mesh.value(columns.along, h).w == 1.0), "mirrored twice or not at all");
    }
}
