//! What a solid must be, looked at with nothing but positions and faces; and whether the account is true.

use crate::igl::Igl;
use crate::truth::{Truth, triangulated};
use meshwright::cleanup::{Account, CleanOptions, Profile, Weld, clean_indexed};
use meshwright::glam::DVec3;
use meshwright::{ClosestOptions, Element, IndexedMesh, Kind, Maps, Mesh, Outcome, PolygonSoup, Report};
use std::collections::{BTreeMap, BTreeSet};

/// What went wrong in a case, one line each.
pub(crate) type Faults = Vec<String>;

macro_rules! check {
    ($faults:expr, $is:expr, $($text:tt)+) => {
        let is_fine: bool = $is;
        if !is_fine {
            $faults.push(format!($($text)+));
        }
    };
}

/// A cleaned soup with its account.
pub(crate) struct Result {
    pub(crate) pool: IndexedMesh,
    pub(crate) report: Report,
    pub(crate) maps: Maps,
    pub(crate) account: Account,
}

pub(crate) fn solid(soup: &PolygonSoup, weld: Weld) -> Result {
    let outcome = clean_indexed(soup, CleanOptions { weld, ..CleanOptions::solid() });
    let Outcome { value: pool, report, maps } = outcome.expect("a soup is never refused");
    let account =
        Account::new(soup, (Profile::Solid, weld), &pool, report.clone(), &maps).expect("as before");
    Result { pool, report, maps, account }
}

/// What holds of every result, solid or not.
pub(crate) fn honest(soup: &PolygonSoup, result: &Result) -> Faults {
    let mut faults = Faults::new();
    let Result { pool, report, maps, account } = result;
    let mesh = Mesh::build(pool).expect("a manifold");
    check!(faults, mesh.violations().is_empty(), "{:?}", mesh.violations());
    check!(faults, account.solid == mesh.is_closed(), "the account says solid: {}", account.solid);

    // The account adds up, and says of every face that is gone why.
    let tally = account.face_tally;
    check!(faults, tally.input == soup.polygons.len(), "{tally:?}");
    check!(faults, tally.kept + tally.changed + tally.dropped == tally.input, "{tally:?}");
    check!(
        faults,
        maps.faces.old_len() == soup.polygons.len(),
        "faces of the input: {}",
        maps.faces.old_len()
    );
    check!(
        faults,
        maps.faces.new_len() == pool.face_count(),
        "faces of the result: {}",
        maps.faces.new_len()
    );
    check!(faults, maps.vertices.old_len() == soup.positions.len(), "vertices of the input");
    check!(faults, maps.vertices.new_len() == pool.vertex_count(), "vertices of the result");
    let named: BTreeSet<Element> = report.records.iter().map(|r| r.element).collect();
    let gone = (0..soup.polygons.len()).filter(|&f| maps.faces.new_of(f).is_empty());
    let unnamed: Vec<usize> = gone.filter(|&f| !named.contains(&Element::Face(f as u32))).collect();
    check!(faults, unnamed.is_empty(), "no record says why faces {unnamed:?} are gone");
    let added = (0..pool.face_count()).filter(|&f| maps.faces.old_of(f).is_empty()).count();
    check!(faults, added == tally.added, "{added} faces come from nothing, {tally:?}");
    let filled = report.count(Kind::FilledHole);
    check!(faults, (filled == 0) == (added == 0), "{filled} holes filled with {added} faces");
    let lost = (0..soup.positions.len()).filter(|&v| maps.vertices.new_of(v).is_empty());
    let why: BTreeSet<Element> = report.records.iter().map(|r| r.element).collect();
    let unnamed: Vec<usize> = lost.filter(|&v| !why.contains(&Element::Vertex(v as u32))).collect();
    // Vertices of dropped faces go with them.
    let with_faces: BTreeSet<u32> = (0..soup.polygons.len())
        .filter(|&f| maps.faces.new_of(f).is_empty())
        .flat_map(|f| soup.polygons[f].iter().copied())
        .collect();
    let unnamed: Vec<usize> = unnamed.into_iter().filter(|&v| !with_faces.contains(&(v as u32))).collect();
    check!(faults, unnamed.is_empty(), "no record says why vertices {unnamed:?} are gone");

    // Every record names something that is there, and lies near it.
    for record in &report.records {
        let exists = match record.element {
            Element::Vertex(v) => (v as usize) < soup.positions.len(),
            Element::Face(f) | Element::Corner([f, _]) => (f as usize) < soup.polygons.len(),
            Element::Edge(ends) => ends.iter().all(|&v| (v as usize) < soup.positions.len()),
            Element::Faces(pair) => pair.iter().all(|&f| (f as usize) < soup.polygons.len()),
            Element::VertexOnEdge(all) => all.iter().all(|&v| (v as usize) < soup.positions.len()),
        };
        check!(faults, exists, "{record:?} is not of the input");
    }
    let counted: usize = account.counts.values().sum();
    check!(faults, counted == report.records.len(), "{counted} counted, {} records", report.records.len());

    // A second pass changes nothing.
    let again = solid(&pool.clone().into(), Weld::None);
    let left = [
        Kind::CrossingShell,
        Kind::OpenPart,
        Kind::OpenSheet,
        Kind::NotOrientable,
        Kind::SelfIntersection,
        Kind::LeftSliver,
        Kind::HoleWithIslands,
        Kind::HemmedInHole,
        Kind::OutsideOfSheet,
    ];
    let news: Vec<_> = again.report.records.iter().filter(|r| !left.contains(&r.kind)).collect();
    check!(faults, news.is_empty(), "a second pass finds {news:?}");
    check!(faults, again.pool == *pool, "a second pass changes the mesh");
    faults
}

/// Closed, manifold, oriented, without faces of no area, outward.
pub(crate) fn sound(pool: &IndexedMesh, diagonal: f64, igl: &mut Igl) -> Faults {
    let mut faults = Faults::new();
    let pool = triangulated(pool);
    let topology = pool.topology();
    check!(faults, topology.is_closed(), "{} edges are open", topology.boundary_edges().count());
    check!(faults, topology.is_edge_manifold(), "edges of three faces");
    check!(faults, topology.conflicting_edges().next().is_none(), "edges are not oriented");
    check!(faults, topology.isolated_vertices().is_empty(), "vertices without a face");
    if pool.face_count() > 0 {
        let theirs = igl.ask(&pool);
        check!(faults, theirs.is("edge_manifold"), "libigl: not edge-manifold");
        check!(faults, theirs.flags("vertex_manifold").iter().all(|&m| m), "libigl: not vertex-manifold");
        check!(faults, theirs.integers("boundary").is_empty(), "libigl: has a boundary");
    }
    for (f, face) in pool.polygons().iter().enumerate() {
        let [a, b, c] = [0, 1, 2].map(|i| pool.positions()[face[i] as usize]);
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let height = (b - a).cross(c - a).length() / longest;
        check!(faults, height > 1e-11 * diagonal, "face {f} has a height of {height}");
    }
    if faults.is_empty() {
        faults.extend(outward(&pool));
    }
    faults.truncate(8);
    faults
}

/// Shells in an even number of others have a positive volume, others a negative one; by solid angles, one by one.
fn outward(pool: &IndexedMesh) -> Faults {
    let mut faults = Faults::new();
    let (label, count) = pool.topology().components();
    let mut shells = vec![Vec::new(); count];
    for (face, &shell) in pool.polygons().iter().zip(&label) {
        shells[shell as usize].push([0, 1, 2].map(|i| pool.positions()[face[i] as usize]));
    }
    let volume = |shell: &[[DVec3; 3]]| {
        let origin = shell[0][0];
        shell.iter().map(|t| (t[0] - origin).dot((t[1] - origin).cross(t[2] - origin))).sum::<f64>()
    };
    let winding = |shell: &[[DVec3; 3]], at: DVec3| {
        let angle = |t: &[DVec3; 3]| {
            let [a, b, c] = t.map(|p| p - at);
            let (x, y, z) = (a.length(), b.length(), c.length());
            2.0 * a.dot(b.cross(c)).atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
        };
        (shell.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)).round().abs()
    };
    for (i, shell) in shells.iter().enumerate() {
        let at = shell[0].iter().sum::<DVec3>() / 3.0;
        let depth: f64 = shells.iter().enumerate().filter(|s| s.0 != i).map(|s| winding(s.1, at)).sum();
        let is_cavity = depth % 2.0 == 1.0;
        check!(faults, (volume(shell) < 0.0) == is_cavity, "shell {i} at depth {depth} faces the wrong way");
    }
    faults
}

/// The result beside the truth: every intact face is near the surface, and nearly all are there as they were.
pub(crate) fn faithful(truth: &Truth, intact: &[bool], jitter: f64, result: &Result) -> Faults {
    let mut faults = Faults::new();
    let near = 0.002 * truth.diagonal;
    let mesh = Mesh::build(&result.pool).expect("a manifold");
    let original = Mesh::build(&truth.pool).expect("a manifold");
    let (index, original) = (mesh.index(), original.index());
    let distance = |index: &meshwright::MeshIndex<'_>, p: DVec3| {
        let found = index.closest_point(p, ClosestOptions::default()).expect("finite");
        found.map_or(f64::INFINITY, |f| f.distance)
    };
    let mut worst = (0.0, 0);
    for (f, face) in truth.pool.polygons().iter().enumerate().filter(|f| intact[f.0]) {
        let corners: Vec<DVec3> = face.iter().map(|&v| truth.pool.positions()[v as usize]).collect();
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        // The mean of a large polygon may lie beside it.
        let inner = (corners.len() <= 4).then_some(middle);
        for &p in corners.iter().chain(&inner) {
            worst = if distance(&index, p) > worst.0 { (distance(&index, p), f) } else { worst };
        }
    }
    check!(
        faults,
        worst.0 <= near,
        "face {} of the truth is {} diagonals off",
        worst.1,
        worst.0 / truth.diagonal
    );
    for (v, &p) in result.pool.positions().iter().enumerate() {
        let off = distance(&original, p);
        check!(faults, off <= near, "vertex {v} of the result is {} diagonals off", off / truth.diagonal);
    }

    let slack = 4.0 * jitter + 1e-10 * truth.diagonal;
    let named = |p: DVec3| {
        let options = ClosestOptions { max_distance: slack, ..Default::default() };
        original.closest_vertex(p, options).expect("finite").map(|n| n.element)
    };
    let cycle = |corners: Vec<Option<meshwright::VertexKey>>| {
        let mut corners: Option<Vec<_>> = corners.into_iter().collect();
        if let Some(c) = &mut corners {
            c.sort_unstable();
        }
        corners
    };
    let names = |pool: &IndexedMesh| -> Vec<_> { pool.positions().iter().map(|&p| named(p)).collect() };
    let (ours, theirs) = (names(&result.pool), names(&truth.pool));
    let mut there: BTreeMap<_, usize> = BTreeMap::new();
    for face in result.pool.polygons().iter() {
        if let Some(cycle) = cycle(face.iter().map(|&v| ours[v as usize]).collect()) {
            *there.entry(cycle).or_default() += 1;
        }
    }
    let (mut kept, mut all) = (0, 0);
    for (_, face) in truth.pool.polygons().iter().enumerate().filter(|f| intact[f.0]) {
        let found = cycle(face.iter().map(|&v| theirs[v as usize]).collect()).and_then(|c| there.get_mut(&c));
        all += 1;
        if let Some(count) = found.filter(|count| **count > 0) {
            *count -= 1;
            kept += 1;
        }
    }
    check!(faults, kept as f64 >= 0.98 * f64::from(all), "{kept} of {all} intact faces kept");
    faults.truncate(8);
    faults
}
