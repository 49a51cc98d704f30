//! Bad input, operation by operation: a typed error, and nothing changed.

use crate::shapes;
use meshwright::cleanup::{CleanOptions, Weld, clean, inspect};
use meshwright::glam::{DAffine3, DMat3, DMat4, DVec3};
use meshwright::{
    ClosestOptions, DeformOptions, EdgeKey, FaceKey, HalfedgeKey, IndexedMesh, Mesh, OutwardOptions, Ray,
    ReduceOptions, ReduceTarget, Scheme, SmoothMethod, SmoothOptions, SubdivideOptions, UnweldOptions,
    VertexKey, WeldOptions, orient_outward,
};
use std::fmt::Debug;

/// An error by its name, without what it carries.
type Answer = Result<(), String>;

fn told<T, E: std::error::Error + Debug>(result: Result<T, E>) -> Answer {
    result.map(drop).map_err(|e| format!("{e:?}").split([' ', '(']).next().unwrap_or_default().to_owned())
}

fn reduce(mesh: &mut Mesh, target: ReduceTarget) -> Answer {
    told(mesh.reduce(ReduceOptions { target, ..Default::default() }))
}

fn smooth(mesh: &mut Mesh, options: SmoothOptions<'_>) -> Answer {
    told(mesh.smooth(options))
}

fn subdivide(mesh: &mut Mesh, options: SubdivideOptions<'_>) -> Answer {
    told(mesh.subdivide(options))
}

fn closest(mesh: &Mesh, p: DVec3, max_distance: f64) -> [Answer; 5] {
    let (index, options) = (mesh.index(), ClosestOptions { max_distance, ..Default::default() });
    [
        told(index.closest_vertex(p, options)),
        told(index.closest_edge(p, options)),
        told(index.closest_face(p, options)),
        told(index.closest_face_center(p, options)),
        told(index.closest_point_batch(&[DVec3::ZERO, p], options)),
    ]
}

/// The same answer from all of them.
fn all(answers: impl IntoIterator<Item = Answer>) -> Answer {
    let mut answers = answers.into_iter();
    let first = answers.next().expect("an answer");
    assert!(answers.all(|a| a == first));
    first
}

/// A half-edge of a mesh with many more.
fn stranger() -> HalfedgeKey {
    shapes::mesh(&shapes::icosphere(1)).halfedges().last().expect("many")
}

const NAN: f64 = f64::NAN;
const INF: f64 = f64::INFINITY;

/// The operation, what is wrong with its input, the error.
type Row = (&'static str, &'static str, &'static str, fn(&mut Mesh) -> Answer);

const ROWS: [Row; 73] = [
    ("mesh", "a position that is not finite", "IndexedError", |m| {
        let (mut points, faces, _) = m.to_indexed().into_parts();
        points[3].y = INF;
        told(IndexedMesh::new(points, faces))
    }),
    ("mesh", "an index out of range", "IndexedError", |m| {
        told(IndexedMesh::from_triangles(m.to_indexed().positions().to_vec(), &[[0, 1, 99]]))
    }),
    ("mesh", "a vertex moved to nowhere", "NonFinite", |m| {
        told(m.set_position(m.vertices().last().expect("one"), DVec3::NAN))
    }),
    ("translate", "not finite", "NonFinite", |m| {
        all([DVec3::NAN, DVec3::INFINITY].map(|by| told(m.translate(by))))
    }),
    ("translate", "beyond the range of numbers", "OutOfRange", |m| told(m.translate(DVec3::X * f64::MAX))),
    ("scale", "factor not finite", "NonFinite", |m| {
        all([NAN, INF, -INF].map(|s| told(m.scale(s, DVec3::ZERO))))
    }),
    ("scale", "origin not finite", "NonFinite", |m| told(m.scale(2.0, DVec3::NAN))),
    ("scale", "factor of zero", "ZeroFactor", |m| all([0.0, -0.0].map(|s| told(m.scale(s, DVec3::ZERO))))),
    ("scale per axis", "not finite", "NonFinite", |m| {
        told(m.scale_axes(DVec3::new(1.0, NAN, 1.0), DVec3::ZERO))
    }),
    ("scale per axis", "one factor of zero", "ZeroFactor", |m| {
        told(m.scale_axes(DVec3::new(1.0, 0.0, 1.0), DVec3::ZERO))
    }),
    ("rotate", "axis of zero", "ZeroAxis", |m| told(m.rotate_degrees(DVec3::ZERO, 90.0, DVec3::ZERO))),
    ("rotate", "axis not finite", "NonFinite", |m| {
        told(m.rotate_degrees(DVec3::INFINITY, 90.0, DVec3::ZERO))
    }),
    ("rotate", "angle not finite", "NonFinite", |m| told(m.rotate_degrees(DVec3::X, NAN, DVec3::ZERO))),
    ("rotate", "origin not finite", "NonFinite", |m| told(m.rotate_degrees(DVec3::X, 90.0, DVec3::NAN))),
    ("affine map", "not finite", "NonFinite", |m| told(m.transform(&DAffine3::from_translation(DVec3::NAN)))),
    ("affine map", "singular", "Singular", |m| told(m.transform(&DAffine3::from_mat3(DMat3::ZERO)))),
    ("matrix", "projective", "NotAffine", |m| told(m.transform_matrix(&(DMat4::IDENTITY * 2.0)))),
    ("matrix", "not finite", "NonFinite", |m| told(m.transform_matrix(&DMat4::NAN))),
    ("deform", "a result that is not finite", "NonFinite", |m| {
        told(m.deform(|p| if p.x > 0.5 { p / 0.0 } else { p * 2.0 }, DeformOptions::default()))
    }),
    ("raycast", "direction of zero", "ZeroDirection", |_| told(Ray::new(DVec3::ONE, DVec3::ZERO))),
    ("raycast", "direction not finite", "NonFiniteDirection", |_| told(Ray::new(DVec3::ONE, DVec3::NAN))),
    ("raycast", "origin not finite", "NonFiniteOrigin", |_| told(Ray::new(DVec3::NAN, DVec3::X))),
    ("weld", "tolerance below zero or no number", "BadTolerance", |m| {
        all([-1.0, NAN, INF].map(|tolerance| told(m.weld(WeldOptions { tolerance, ..Default::default() }))))
    }),
    ("unweld", "no angle", "BadAngle", |m| {
        all([-1.0, 181.0, NAN].map(|degrees| told(m.unweld(UnweldOptions { degrees, ..Default::default() }))))
    }),
    ("sharp edges", "no angle", "BadAngle", |m| {
        all([-1.0, 181.0, NAN].map(|degrees| told(m.sharp_edges(degrees))))
    }),
    ("clean", "tolerance below zero or no number", "BadTolerance", |m| {
        let soup = m.to_indexed().into();
        all([-1.0, NAN, INF]
            .map(|t| told(clean(&soup, CleanOptions { weld: Weld::Within(t), ..Default::default() }))))
    }),
    ("inspect", "tolerance no number", "BadTolerance", |m| {
        told(inspect(&m.to_indexed().into(), Weld::Within(NAN)))
    }),
    ("subdivide", "too many levels", "TooLarge", |m| {
        subdivide(m, SubdivideOptions { levels: 99, ..Default::default() })
    }),
    ("subdivide", "a crease angle that is none", "BadAngle", |m| {
        let scheme = Scheme::Loop;
        all([-1.0, NAN].map(|a| {
            subdivide(m, SubdivideOptions { scheme, crease_degrees: Some(a), ..Default::default() })
        }))
    }),
    ("subdivide", "a dead face", "MissingFace", |m| {
        subdivide(m, SubdivideOptions { only: Some(&[FaceKey::default()]), ..Default::default() })
    }),
    ("subdivide", "a dead edge", "MissingEdge", |m| {
        let creases = &[EdgeKey::default()];
        subdivide(m, SubdivideOptions { scheme: Scheme::Loop, creases, ..Default::default() })
    }),
    ("subdivide", "a dead vertex", "MissingVertex", |m| {
        let corners = &[VertexKey::default()];
        subdivide(m, SubdivideOptions { scheme: Scheme::Loop, corners, ..Default::default() })
    }),
    ("subdivide", "a selection where there is no rule", "NoSelection", |m| {
        subdivide(m, SubdivideOptions { scheme: Scheme::Sqrt3, only: Some(&[]), ..Default::default() })
    }),
    ("subdivide", "creases where there is no rule", "NoCreases", |m| {
        let creases = &[m.edges().next().expect("one")];
        subdivide(m, SubdivideOptions { scheme: Scheme::Midpoint, creases, ..Default::default() })
    }),
    ("smooth", "lambda out of range", "BadLambda", |m| {
        all([0.0, -0.5, 1.01, NAN, INF]
            .map(|lambda| smooth(m, SmoothOptions { lambda, ..Default::default() })))
    }),
    ("smooth", "lambda of an implicit step out of range", "BadLambda", |m| {
        let method = SmoothMethod::Implicit;
        all([0.0, -0.5, 10001.0, NAN, INF]
            .map(|lambda| smooth(m, SmoothOptions { method, lambda, ..Default::default() })))
    }),
    ("smooth", "mu not below -lambda", "BadMu", |m| {
        all([-0.5, 0.3, NAN, -INF].map(|mu| {
            smooth(
                m,
                SmoothOptions { method: SmoothMethod::Taubin { mu }, lambda: 0.5, ..Default::default() },
            )
        }))
    }),
    ("smooth", "a dead vertex locked", "Missing", |m| {
        smooth(m, SmoothOptions { locked: &[VertexKey::default()], ..Default::default() })
    }),
    ("smooth", "beyond the range of numbers", "OutOfRange", |m| {
        let method = SmoothMethod::Taubin { mu: -1e300 };
        smooth(m, SmoothOptions { method, iterations: 9, ..Default::default() })
    }),
    ("reduce", "target of no faces", "NoFaces", |m| reduce(m, ReduceTarget::Faces(0))),
    ("reduce", "ratio out of range", "BadRatio", |m| {
        all([0.0, -1.0, 1.5, NAN, INF].map(|r| reduce(m, ReduceTarget::Ratio(r))))
    }),
    ("reduce", "error bound below zero or no number", "BadErrorBound", |m| {
        all([-1.0, NAN].map(|e| reduce(m, ReduceTarget::MaxError(e))))
    }),
    ("reduce", "an angle that is none", "BadOption", |m| {
        told(m.reduce(ReduceOptions { sharp_degrees: Some(NAN), ..Default::default() }))
    }),
    ("reduce", "a dead vertex locked", "MissingVertex", |m| {
        let locked_vertices = &[VertexKey::default()];
        told(m.reduce(ReduceOptions { locked_vertices, ..Default::default() }))
    }),
    ("reduce", "a dead edge locked", "MissingEdge", |m| {
        let locked_edges = &[EdgeKey::default()];
        told(m.reduce(ReduceOptions { locked_edges, ..Default::default() }))
    }),
    ("reduce", "guards that are none", "BadOption", |m| {
        all([
            told(m.reduce(ReduceOptions { max_turn_degrees: NAN, ..Default::default() })),
            told(m.reduce(ReduceOptions { min_shape: NAN, ..Default::default() })),
            told(m.reduce(ReduceOptions { line_weight: INF, ..Default::default() })),
        ])
    }),
    ("collapse", "a dead half-edge", "Missing", |m| {
        let dead = stranger();
        all([
            told(m.collapse(dead, DVec3::ZERO)),
            told(m.collapse_to_midpoint(dead)),
            told(m.collapse_into_target(dead)),
        ])
    }),
    ("collapse", "a place that is not finite", "NonFinite", |m| {
        let h = m.boundary_halfedges().chain(m.halfedges()).next().expect("one");
        told(m.collapse(h, DVec3::NAN))
    }),
    ("volume", "an open mesh", "Open", |m| {
        let f = m.faces().next().expect("one");
        let mut open = m.clone();
        open.remove_face(f).expect("closed before");
        told(open.closed())
    }),
    ("contains", "not finite", "NonFinitePoint", |m| {
        let solid = m.closed().expect("closed");
        let index = solid.index();
        all([
            told(solid.contains(DVec3::NAN)),
            told(solid.contains_batch(&[DVec3::ONE, DVec3::INFINITY])),
            told(index.contains(DVec3::NAN)),
            told(index.winding_number(DVec3::NAN)),
        ])
    }),
    ("flip", "a dead face", "MissingFace", |m| told(m.reverse_component(FaceKey::default()))),
    ("outward", "no confidence", "BadConfidence", |m| {
        let pool = m.to_indexed();
        all([-0.1, 1.1, NAN].into_iter().flat_map(|min_confidence| {
            let options = || OutwardOptions { min_confidence, ..Default::default() };
            [told(m.orient_outward(options())), told(orient_outward(&pool.topology(), options()))]
        }))
    }),
    ("unify", "a Moebius strip", "NotOrientable", |_| {
        told(meshwright::unify_winding(&shapes::moebius(5).topology()))
    }),
    ("closest", "a point that is not finite", "NonFinitePoint", |m| {
        all([DVec3::NAN, DVec3::INFINITY].into_iter().flat_map(|p| closest(m, p, INF)))
    }),
    ("closest", "a maximum distance that is no number", "MaxDistance", |m| all(closest(m, DVec3::ZERO, NAN))),
    // What changes a mesh is refused where there is none.
    ("transform", "no mesh", "Empty", |_| {
        let mesh = &mut Mesh::default();
        all([
            told(mesh.translate(DVec3::X)),
            told(mesh.scale(-2.0, DVec3::ZERO)),
            told(mesh.scale_axes(DVec3::ONE, DVec3::ZERO)),
            told(mesh.scale_axes(DVec3::new(1.0, 2.0, 3.0), DVec3::ZERO)),
            told(mesh.rotate_degrees(DVec3::X, 30.0, DVec3::ZERO)),
            told(mesh.transform(&DAffine3::IDENTITY)),
            told(mesh.transform_matrix(&DMat4::IDENTITY)),
        ])
    }),
    ("deform", "no mesh", "Empty", |_| told(Mesh::default().deform(|p| p, DeformOptions::default()))),
    ("smooth", "no mesh", "Empty", |_| smooth(&mut Mesh::default(), SmoothOptions::default())),
    ("weld", "no mesh", "Empty", |_| told(Mesh::default().weld(WeldOptions::default()))),
    ("unweld", "no mesh", "Empty", |_| told(Mesh::default().unweld(UnweldOptions::default()))),
    ("subdivide", "no mesh, or no faces", "Empty", |_| {
        let schemes = [Scheme::Midpoint, Scheme::Loop, Scheme::CatmullClark, Scheme::Sqrt3];
        let mut points = Mesh::default();
        points.add_vertex(DVec3::ONE).expect("finite");
        all([Mesh::default(), points].into_iter().flat_map(|mut mesh| {
            schemes.map(|scheme| subdivide(&mut mesh, SubdivideOptions { scheme, ..Default::default() }))
        }))
    }),
    ("volume", "no mesh", "Empty", |_| told(Mesh::default().closed())),
    ("reduce", "no mesh", "Empty", |_| reduce(&mut Mesh::default(), ReduceTarget::Faces(4))),
    ("reduce", "no mesh", "Empty", |_| reduce(&mut Mesh::default(), ReduceTarget::MaxError(1.0))),
    ("collapse", "no mesh", "Missing", |_| told(Mesh::default().collapse_to_midpoint(stranger()))),
    ("flip", "no mesh", "MissingFace", |_| told(Mesh::default().reverse_component(FaceKey::default()))),
    // Bad input is refused there as well.
    ("translate", "no mesh, and not finite", "NonFinite", |_| told(Mesh::default().translate(DVec3::NAN))),
    ("rotate", "no mesh, and an axis of zero", "ZeroAxis", |_| {
        told(Mesh::default().rotate_degrees(DVec3::ZERO, 1.0, DVec3::ZERO))
    }),
    ("smooth", "no mesh, and lambda out of range", "BadLambda", |_| {
        smooth(&mut Mesh::default(), SmoothOptions { lambda: 2.0, ..Default::default() })
    }),
    ("weld", "no mesh, and a tolerance that is no number", "BadTolerance", |_| {
        told(Mesh::default().weld(WeldOptions { tolerance: NAN, ..Default::default() }))
    }),
    ("unweld", "no mesh, and no angle", "BadAngle", |_| {
        told(Mesh::default().unweld(UnweldOptions { degrees: NAN, ..Default::default() }))
    }),
    ("reduce", "no mesh, and a target of no faces", "NoFaces", |_| {
        reduce(&mut Mesh::default(), ReduceTarget::Faces(0))
    }),
    ("closest", "no mesh, and a point that is not finite", "NonFinitePoint", |_| {
        all(closest(&Mesh::default(), DVec3::NAN, INF))
    }),
];

#[test]
fn bad_input_gets_a_typed_error_and_changes_nothing() {
    let mut pool = shapes::cube();
    // Where a little more is too much.
    pool.map_positions(|p| p * 1e300).expect("finite");
    for scale in [1e-300, f64::MAX / 1e300] {
        let mut pool = pool.clone();
        pool.map_positions(|p| p * scale).expect("finite");
        for (operation, what, error, call) in ROWS {
            let mut mesh = shapes::mesh(&pool);
            mesh.compute_normals(Default::default());
            let links =
                |m: &Mesh| m.halfedges().map(|h| (h, m.next(h), m.origin(h), m.face(h))).collect::<Vec<_>>();
            let before = (mesh.to_indexed(), mesh.numbering(), links(&mesh));
            let answer = call(&mut mesh);
            // At size 1 nothing leaves the range by moving a little.
            if scale < 1.0 && error == "OutOfRange" && answer.is_ok() {
                continue;
            }
            assert_eq!(answer, Err(error.to_owned()), "{operation}: {what}");
            assert!((mesh.to_indexed(), mesh.numbering(), links(&mesh)) == before, "{operation}: {what}");
        }
    }
}

#[test]
fn the_empty_mesh_is_asked_and_turned_like_any_other() {
    let mut mesh = Mesh::default();
    mesh.reverse();
    mesh.compute_normals(Default::default());
    assert_eq!(mesh.orient_outward(OutwardOptions::default()).expect("nothing to turn"), []);
    assert!(mesh.index().hits(&Ray::new(DVec3::ZERO, DVec3::X).expect("a ray")).is_empty());
    assert_eq!(mesh.index().closest_point(DVec3::ZERO, ClosestOptions::default()), Ok(None));
    assert!(!mesh.is_closed() && mesh.boundary_loops().is_empty() && mesh.validate().is_ok());
    let pool = mesh.to_indexed();
    assert!(meshwright::unify_winding(&pool.topology()).expect("nothing to unify").report.is_empty());
    assert!(clean(&pool.into(), CleanOptions::default()).expect("always answers").report.is_empty());
}
