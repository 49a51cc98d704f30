//! Collapses every edge that is shorter than a length, and says why others stayed: how to edit while walking.

use meshwright::glam::dvec3;
use meshwright::{CollapseError, HalfedgeKey, IndexedMesh, Mesh};
use std::collections::BTreeMap;
use std::error::Error;

/// How many edges were collapsed, and how many of the short ones were refused for which reason.
#[derive(Debug, Default)]
pub(crate) struct Account {
    pub(crate) collapsed: usize,
    pub(crate) refused: BTreeMap<&'static str, usize>,
}

pub(crate) fn collapse_shorter_than(mesh: &mut Mesh, length: f64) -> Account {
    let mut account = Account::default();
    loop {
        // Collect the keys first: nothing can be edited while the mesh is walked.
        let is_short = |mesh: &Mesh, h: HalfedgeKey| {
            mesh.position(mesh.origin(h)).distance(mesh.position(mesh.target(h))) < length
        };
        let short: Vec<HalfedgeKey> =
            mesh.edges().map(|e| mesh.edge_halfedge(e)).filter(|&h| is_short(mesh, h)).collect();
        let before = account.collapsed;
        account.refused.clear();
        for h in short {
            // An earlier collapse may have taken the edge, or made it longer.
            if !mesh.contains_halfedge(h) || !is_short(mesh, h) {
                continue;
            }
            match mesh.collapse_to_midpoint(h) {
                Ok(_) => account.collapsed += 1,
                Err(why) => *account.refused.entry(reason(why)).or_default() += 1,
            }
        }
        if account.collapsed == before {
            return account;
        }
    }
}

fn reason(why: CollapseError) -> &'static str {
    match why {
        CollapseError::BetweenBoundaries(_) => "from boundary to boundary",
        CollapseError::CommonNeighbor(_) | CollapseError::CommonFace(_) => "would close a tunnel or a hole",
        CollapseError::Duplicate(..) | CollapseError::LastFace(_) => "would leave no volume",
        _ => "something else",
    }
}

/// A tube of three sides, open at both ends, in twenty short rings.
pub(crate) fn tube() -> Result<Mesh, Box<dyn Error>> {
    let corner = |i: u32| {
        let (y, x) = (f64::from(i % 3) * 120f64.to_radians()).sin_cos();
        dvec3(x, y, 0.1 * f64::from(i / 3))
    };
    let quad = |i: u32| {
        let (ring, side) = (3 * (i / 3), i % 3);
        let next = (side + 1) % 3;
        vec![ring + side, ring + next, ring + next + 3, ring + side + 3]
    };
    let faces: Vec<Vec<u32>> = (0..60).map(quad).collect();
    Ok(Mesh::build(&IndexedMesh::new((0..63).map(corner).collect(), faces.into())?)?)
}

#[allow(dead_code, reason = "the tests call the parts")]
fn main() -> Result<(), Box<dyn Error>> {
    let mut mesh = tube()?;
    let account = collapse_shorter_than(&mut mesh, 0.5);
    println!("{} edges collapsed, {} left", account.collapsed, mesh.edge_count());
    for (reason, count) in account.refused {
        println!("{count} short edges stayed: {reason}");
    }
    Ok(())
}
