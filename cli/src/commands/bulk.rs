//! Commands that change the whole mesh: transforms, weld, subdivision, smoothing.

use super::change::import_edit_write;
use crate::args::{self, Deform, Origin, Smooth, Subdivide, Transform, Unweld, WeldCommand};
use crate::progress;
use crate::session::{Answer, Failure, Session};
use meshwright::glam::DVec3;
use meshwright::{
    Boundary, Control, DeformOptions, Mesh, Outcome, Report, Scheme, SmoothMethod, SmoothOptions,
    SubdivideOptions, UnweldOptions, WeldOptions,
};

/// Puts the result in the mesh's place.
fn taken(mesh: &mut Mesh, outcome: Outcome<Mesh>) -> Option<Report> {
    *mesh = outcome.value;
    Some(outcome.report)
}

pub(super) fn weld(session: &mut Session, args: &WeldCommand) -> Result<Answer, Failure> {
    import_edit_write(session, &args.change, |mesh| {
        let outcome = progress::shown(|hook| {
            mesh.weld(WeldOptions { tolerance: args.tolerance, control: Control::new(hook) })
        });
        Ok(taken(mesh, outcome.map_err(Failure::refused)?))
    })
}

pub(super) fn unweld(session: &mut Session, args: &Unweld) -> Result<Answer, Failure> {
    import_edit_write(session, &args.change, |mesh| {
        let outcome = progress::shown(|hook| {
            mesh.unweld(UnweldOptions { degrees: args.angle, control: Control::new(hook) })
        });
        Ok(taken(mesh, outcome.map_err(Failure::refused)?))
    })
}

pub(super) fn smooth(session: &mut Session, args: &Smooth) -> Result<Answer, Failure> {
    let lambda = args.lambda;
    let method = match (args.method, args.mu) {
        (None | Some(args::SmoothMethod::Taubin), Some(mu)) => SmoothMethod::Taubin { mu },
        // Taubin's pass band: 1 / lambda + 1 / mu = 0.1.
        (Some(args::SmoothMethod::Taubin), None) => SmoothMethod::Taubin { mu: 1.0 / (0.1 - 1.0 / lambda) },
        (Some(_), Some(_)) => return Err(Failure::Usage("--mu belongs to --method taubin".to_owned())),
        (None | Some(args::SmoothMethod::Laplacian), None) => SmoothMethod::Laplacian,
        (Some(args::SmoothMethod::Cotan), None) => SmoothMethod::Cotangent,
        (Some(args::SmoothMethod::Implicit), None) => SmoothMethod::Implicit,
    };
    let boundary = match args.boundary {
        args::Boundary::Fixed => Boundary::Fixed,
        args::Boundary::Slide => Boundary::Slide,
        args::Boundary::Free => Boundary::Free,
    };
    import_edit_write(session, &args.change, |mesh| {
        let smoothed = progress::shown(|hook| {
            let iterations = args.iterations;
            let control = Control::new(hook);
            mesh.smooth(SmoothOptions { method, lambda, iterations, boundary, locked: &[], control })
        });
        smoothed.map(|()| None).map_err(Failure::refused)
    })
}

pub(super) fn subdivide(session: &mut Session, args: &Subdivide) -> Result<Answer, Failure> {
    let scheme = match args.scheme {
        args::Scheme::Midpoint => Scheme::Midpoint,
        args::Scheme::Loop => Scheme::Loop,
        args::Scheme::CatmullClark => Scheme::CatmullClark,
        args::Scheme::Sqrt3 => Scheme::Sqrt3,
    };
    import_edit_write(session, &args.change, |mesh| {
        let outcome = progress::shown(|hook| {
            let control = Control::new(hook);
            mesh.subdivide(SubdivideOptions { scheme, levels: args.levels, control, ..Default::default() })
        });
        Ok(taken(mesh, outcome.map_err(Failure::refused)?))
    })
}

pub(super) fn transform(session: &mut Session, args: &Transform) -> Result<Answer, Failure> {
    import_edit_write(session, &args.change, |mesh| {
        let origin = match args.origin {
            Origin::Point(p) => DVec3::from(p),
            Origin::Center => mesh.bounds().map_or(DVec3::ZERO, |b| b.center()),
        };
        if let Some(factors) = args.scale {
            mesh.scale_axes(factors.into(), origin).map_err(Failure::refused)?;
        }
        if let Some([x, y, z, degrees]) = args.rotate {
            mesh.rotate_degrees(DVec3::new(x, y, z), degrees, origin).map_err(Failure::refused)?;
        }
        if let Some(by) = args.translate {
            mesh.translate(by.into()).map_err(Failure::refused)?;
        }
        Ok(None)
    })
}

pub(super) fn deform(session: &mut Session, args: &Deform) -> Result<Answer, Failure> {
    import_edit_write(session, &args.change, |mesh| {
        let wave = |p: DVec3| p + DVec3::Z * ((5.0 * p.x).sin() * (5.0 * p.y).cos() * args.wave);
        let deformed =
            progress::shown(|hook| mesh.deform(wave, DeformOptions { control: Control::new(hook) }));
        deformed.map(|()| None).map_err(Failure::refused)
    })
}
