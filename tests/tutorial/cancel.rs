//! Long calls: each tells how far it has come, and cancelled at any moment leaves the mesh as it was.

use crate::shapes::{self, Noise};
use meshwright::cleanup::{CleanOptions, Profile, Weld, clean, clean_indexed, index_with, inspect_with};
use meshwright::glam::{DVec3, dvec3};
use meshwright::{
    ClosestOptions, Control, DeformOptions, FaceKey, FillHolesOptions, Mesh, OutwardOptions, Progress, Ray,
    ReduceOptions, ReduceTarget, Scheme, SelfIntersectionOptions, SliverOptions, SmoothMethod, SmoothOptions,
    SubdivideOptions, UnweldOptions, WeldOptions, orient_outward, unify_winding_with,
};
use std::error::Error;
use std::ops::ControlFlow;

type Call = fn(&mut Mesh, Control<'_>) -> Result<(), Box<dyn Error>>;

/// Whether a call came to its end.
fn ended<T, E: Error + 'static>(result: Result<T, E>) -> Result<(), Box<dyn Error>> {
    result.map(drop).map_err(Into::into)
}

fn subdivided(mesh: &Mesh, scheme: Scheme, control: Control<'_>) -> Result<(), Box<dyn Error>> {
    mesh.subdivide(SubdivideOptions { scheme, levels: 2, control, ..Default::default() })?;
    Ok(())
}

fn subdivided_in_part(mesh: &Mesh, mut control: Control<'_>) -> Result<(), Box<dyn Error>> {
    let some: Vec<FaceKey> = mesh.faces().step_by(3).collect();
    let mut hook = |p: Progress| match control.report(p.stage, p.fraction) {
        Ok(()) => ControlFlow::Continue(()),
        Err(_) => ControlFlow::Break(()),
    };
    let control = Control::new(&mut hook);
    mesh.subdivide(SubdivideOptions { only: Some(&some), levels: 2, control, ..Default::default() })?;
    Ok(())
}

fn smoothed(mesh: &mut Mesh, method: SmoothMethod, control: Control<'_>) -> Result<(), Box<dyn Error>> {
    ended(mesh.smooth(SmoothOptions { method, iterations: 6, control, ..Default::default() }))
}

fn reduced(mesh: &mut Mesh, target: ReduceTarget, control: Control<'_>) -> Result<(), Box<dyn Error>> {
    mesh.reduce(ReduceOptions { target, control, ..Default::default() })?;
    Ok(())
}

const CALLS: [(&str, Call); 31] = [
    ("weld", |m, control| ended(m.weld(WeldOptions { tolerance: 1e-3, control }))),
    ("weld exactly", |m, control| ended(m.weld(WeldOptions { tolerance: 0.0, control }))),
    ("unweld", |m, control| ended(m.unweld(UnweldOptions { degrees: 10.0, control }))),
    ("midpoint", |m, c| subdivided(m, Scheme::Midpoint, c)),
    ("midpoint of a selection", |m, c| subdivided_in_part(m, c)),
    ("loop", |m, c| subdivided(m, Scheme::Loop, c)),
    ("Catmull-Clark", |m, c| subdivided(m, Scheme::CatmullClark, c)),
    ("sqrt(3)", |m, c| subdivided(m, Scheme::Sqrt3, c)),
    ("Laplacian", |m, c| smoothed(m, SmoothMethod::Laplacian, c)),
    ("Taubin", |m, c| smoothed(m, SmoothMethod::Taubin { mu: -0.53 }, c)),
    ("cotangent", |m, c| smoothed(m, SmoothMethod::Cotangent, c)),
    ("implicit", |m, c| smoothed(m, SmoothMethod::Implicit, c)),
    ("reduce to faces", |m, c| reduced(m, ReduceTarget::Faces(40), c)),
    ("reduce by ratio", |m, c| reduced(m, ReduceTarget::Ratio(0.1), c)),
    ("reduce within an error", |m, c| reduced(m, ReduceTarget::MaxError(0.05), c)),
    ("deform", |m, control| ended(m.deform(|p| p * 2.0 + DVec3::X, DeformOptions { control }))),
    ("turn outward", |m, control| {
        m.orient_outward(OutwardOptions { control, ..Default::default() })?;
        Ok(())
    }),
    ("turn a pool outward", |m, control| {
        let pool = m.to_indexed();
        orient_outward(&pool.topology(), OutwardOptions { control, ..Default::default() })?;
        Ok(())
    }),
    ("clean", |m, control| {
        let weld = Weld::Within(1e-3);
        ended(clean(&m.to_indexed().into(), CleanOptions { weld, control, ..Default::default() }))
    }),
    ("clean to a pool", |m, control| {
        ended(clean_indexed(&m.to_indexed().into(), CleanOptions { control, ..Default::default() }))
    }),
    ("clean to a solid", |m, control| {
        let options = CleanOptions { profile: Profile::Solid, control, ..Default::default() };
        ended(clean(&m.to_indexed().into(), options))
    }),
    ("fill holes", |m, control| ended(m.fill_holes(FillHolesOptions { control, ..Default::default() }))),
    ("resolve slivers", |m, control| ended(m.resolve_slivers(SliverOptions { tolerance: 0.13, control }))),
    ("self-intersections", |m, control| {
        ended(m.self_intersections(SelfIntersectionOptions { control, ..Default::default() }))
    }),
    ("build", |m, control| ended(Mesh::build_with(&m.to_indexed(), control))),
    ("index", |m, control| ended(m.index_with(control))),
    ("cast rays", |m, control| {
        let rays: Vec<Ray> =
            points(m).into_iter().map(|p| Ray::new(p, DVec3::ONE)).collect::<Result<_, _>>()?;
        ended(m.index().hits_batch_with(&rays, control))
    }),
    ("nearest points", |m, control| {
        ended(m.index().closest_point_batch_with(&points(m), ClosestOptions::default(), control))
    }),
    ("unify", |m, control| ended(unify_winding_with(&m.to_indexed().topology(), control))),
    ("inspect", |m, control| ended(inspect_with(&m.to_indexed().into(), Weld::Exact, control))),
    ("weld a soup", |m, control| ended(index_with(&m.to_indexed().into(), Weld::Within(1e-3), control))),
];

/// Points to ask about.
fn points(mesh: &Mesh) -> Vec<DVec3> {
    mesh.vertices().map(|v| mesh.position(v) * 1.1).collect()
}

/// What a mesh is, keys included.
fn state(mesh: &Mesh) -> impl PartialEq + use<> {
    let links: Vec<_> = mesh.halfedges().map(|h| (h, mesh.next(h), mesh.origin(h), mesh.face(h))).collect();
    let columns = mesh.carried_attributes();
    (mesh.to_indexed(), mesh.numbering(), links, columns)
}

/// An inverted bumpy sphere, a box that lacks a face, and a corner data column.
fn subject() -> Mesh {
    let mut noise = Noise(41);
    let mut pool =
        shapes::both(&shapes::icosphere(3).reversed(), &crate::lidless(&shapes::cube_at(DVec3::X * 4.0)));
    pool.map_positions(|p| p + dvec3(noise.unit(), noise.unit(), noise.unit()) * 0.02).expect("finite");
    let mut mesh = shapes::mesh(&pool);
    mesh.compute_normals(Default::default());
    mesh
}

#[test]
fn every_long_call_tells_how_far_it_has_come() {
    for (name, call) in CALLS {
        let mut seen: Vec<f64> = Vec::new();
        let mut hook = |p: Progress| {
            seen.push(p.fraction);
            assert!(!p.stage.is_empty());
            ControlFlow::Continue(())
        };
        call(&mut subject(), Control::new(&mut hook)).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(
            !seen.is_empty() && seen.is_sorted() && seen.iter().all(|f| (0.0..=1.0).contains(f)),
            "{name}: {seen:?}"
        );
    }
}

#[test]
fn a_long_call_cancelled_at_any_moment_leaves_the_mesh_as_it_was() {
    for (name, call) in CALLS {
        let mut mesh = subject();
        let before = state(&mesh);
        let mut moments = 0;
        loop {
            let mut count = 0;
            let mut hook = |_: Progress| {
                count += 1;
                if count > moments { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            match call(&mut mesh, Control::new(&mut hook)) {
                Ok(()) => break,
                Err(error) => assert_eq!(error.to_string(), "cancelled", "{name}"),
            }
            assert!(state(&mesh) == before, "{name}, cancelled after {moments}");
            assert_eq!(mesh.validate(), Ok(()), "{name}");
            moments += 1;
        }
        // Calls that walk elements once tell of every half million, batches of some thousand questions.
        assert!(moments >= 1, "{name}");
    }
}

#[test]
fn a_deformation_of_many_vertices_cancelled_half_way_leaves_them_where_they_were() {
    let pool = shapes::grid(760);
    let mut mesh = shapes::mesh(&pool);
    let mut told = Vec::new();
    let mut hook = |p: Progress| {
        told.push(p.fraction);
        if p.fraction > 0.5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let options = DeformOptions { control: Control::new(&mut hook) };
    let refused = mesh.deform(|p| p * 2.0, options).expect_err("cancelled");
    assert_eq!(refused.to_string(), "cancelled");
    assert!(told.len() == 2 && told[1] > 0.5 && told[1] < 1.0, "{told:?}");
    assert!(mesh.to_indexed() == pool);
}
