//! The steps in their order: from a soup to a mesh, and from there to a solid.

use super::carry::{self, Carried};
use super::manifold::{drop_duplicates, make_manifold};
use super::pool::Pool;
use super::solid::{Names, Stage, solidify};
use super::stitch::stitch_pool;
use super::{CleanError, CleanOptions, Profile, Sources, split};
use crate::build::assemble;
use crate::matching::{Chains, Matching};
use crate::report::{Maps, Report, Step, StepSummary};
use crate::{Control, IndexedMesh, Mesh, PolygonSoup};

/// What a clean-up arrives at.
pub(super) struct Cleaned {
    /// The pool that the mesh was built of; of a solid, only where no step followed.
    pub(super) indexed: Option<IndexedMesh>,
    pub(super) mesh: Mesh,
    pub(super) report: Report,
    pub(super) maps: Maps,
    /// Of what is there before half-edges are.
    pub(super) sources: Sources,
}

/// What becomes of a soup before half-edges exist.
struct Built {
    indexed: IndexedMesh,
    mesh: Mesh,
    carried: Carried,
    report: Report,
    maps: Maps,
    names: Names,
    tolerance: Option<f64>,
    sources: Sources,
}

pub(super) fn run(soup: &PolygonSoup, options: CleanOptions<'_>) -> Result<Cleaned, CleanError> {
    let CleanOptions { profile, weld, debris, mut control } = options;
    let is_solid = profile == Profile::Solid;
    let pool = Pool::new(soup, weld, &mut control.part(0.0, if is_solid { 0.6 } else { 1.0 }))?;
    let built = build(pool, profile, &mut control.part(0.0, if is_solid { 0.6 } else { 1.0 }))?;
    let Built { indexed, mesh, carried, report, maps, names, tolerance, sources } = built;
    let report = Report { not_carried: carried.not_carried(), lost_values: carried.lost_values(), ..report };
    if !is_solid && debris.is_none() {
        return Ok(Cleaned { indexed: Some(indexed), mesh, report, maps, sources });
    }
    drop(indexed);
    let mut stage = Stage { mesh, report, maps, names, is_spent: false, has_slivers: false };
    if is_solid {
        solidify(&mut stage, tolerance.unwrap_or(0.0), debris, &mut control.part(0.6, 1.0))?;
    } else if let Some(fewer_than) = debris {
        stage.drop_debris(fewer_than);
    }
    Ok(Cleaned { indexed: None, mesh: stage.mesh, report: stage.report, maps: stage.maps, sources })
}

fn build(mut pool: Pool<'_>, profile: Profile, control: &mut Control<'_>) -> Result<Built, CleanError> {
    let tolerance = pool.tolerance;
    let names = |pool: &mut Pool<'_>| {
        Names::new(std::mem::take(&mut pool.vertex_source), std::mem::take(&mut pool.face_source))
    };
    control.report("match edges", 0.4)?;
    let chains = Chains::new(pool.positions.len(), &pool.polygons);
    if chains.is_paired() {
        // Most files need no more: try before working out what is wrong.
        control.report("build", 0.5)?;
        let mut carried = pool.carry_welded();
        let indexed = pool.lend(std::mem::take(&mut carried.attributes));
        if let Some(mesh) = assemble(&indexed, &chains.into_pairing())
            && (profile == Profile::Preserve || mesh.is_closed())
        {
            let sources = pool.sources();
            let (report, maps) = pool.account(indexed.positions());
            let names = names(&mut pool);
            return Ok(Built { indexed, mesh, carried, report, maps, names, tolerance, sources });
        }
        pool.take_back(indexed);
    }
    control.report("drop duplicates", 0.5)?;
    let mut matching = Matching::new(pool.positions.len(), &pool.polygons);
    if drop_duplicates(&mut pool, &matching) {
        matching = Matching::new(pool.positions.len(), &pool.polygons);
    }
    if profile == Profile::Solid
        && let Some(reach) = pool.reach()
        && stitch_pool(&mut pool, &matching, reach, control)?
    {
        matching = Matching::new(pool.positions.len(), &pool.polygons);
        // Faces may have come to lie on others.
        if drop_duplicates(&mut pool, &matching) {
            matching = Matching::new(pool.positions.len(), &pool.polygons);
        }
    }
    control.report("pair faces", 0.6)?;
    let mates = make_manifold(&mut pool, &matching);
    control.report("split vertices", 0.8)?;
    let (split, vertices) = split::split(&mut pool, &mates);
    pool.report.steps.push(StepSummary::new(Step::SplitVertices, split));
    let maps = Maps { vertices, faces: pool.face_relation() };
    let positions = std::mem::take(&mut pool.positions);
    pool.record_merges(|v| maps.vertices.new_of(v as usize).first().map(|&n| positions[n as usize]));
    pool.report.records.sort_by_key(|r| r.step);
    control.report("build", 0.9)?;
    pool.positions = positions;
    let mut carried = carry::carry(&pool, |v| maps.vertices.new_of(v));
    let indexed = pool.lend(std::mem::take(&mut carried.attributes));
    let mesh = Mesh::build(&indexed).map_err(CleanError::Bug)?;
    let sources = pool.sources();
    let names = names(&mut pool);
    Ok(Built { indexed, mesh, carried, report: pool.report, maps, names, tolerance, sources })
}
