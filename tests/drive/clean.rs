//! From bytes to a soup, through the whole ladder: the body of the property test, the fuzz target and the regressions.

use arbitrary::{Arbitrary, Result, Unstructured};
use meshwright::cleanup::{Account, CleanOptions, Profile, Weld, clean, clean_indexed, index};
use meshwright::glam::DVec3;
use meshwright::{
    CornerData, Element, FaceKey, Group, IndexedMesh, Kind, Maps, Mesh, PolygonSoup, Polygons, Step,
};

/// A soup small enough for every way of going wrong to come up. Prints as Rust, to be pasted as a regression.
#[derive(Arbitrary, Clone, Debug)]
pub(crate) struct Soup {
    /// Coordinates on a small lattice, so that positions and planes coincide; some are not finite.
    pub(crate) points: Vec<[i8; 3]>,
    /// Indices, taken modulo a little more than the number of points.
    pub(crate) faces: Vec<Vec<u8>>,
    /// Of what kind the weld is, and from which number of faces on a part is no debris.
    pub(crate) weld: u8,
}

impl Soup {
    pub(crate) fn build(&self) -> (PolygonSoup, Weld) {
        let coordinate = |c: i8| match c {
            i8::MIN => f64::NAN,
            i8::MAX => f64::INFINITY,
            -64 => -0.0,
            c => f64::from(c % 4) * 0.5,
        };
        let points: Vec<DVec3> = self.points.iter().map(|p| DVec3::from(p.map(coordinate))).collect();
        let range = points.len() as u32 + 1;
        let index = |i: &u8| match u32::from(*i) {
            255 => PolygonSoup::NO_VERTEX,
            // Rarely out of range.
            i if i >= 250 => i % range,
            i => i % points.len().max(1) as u32,
        };
        let polygons: Polygons = self.faces.iter().map(|f| f.iter().map(index).collect::<Vec<_>>()).collect();
        let weld = [Weld::Exact, Weld::None, Weld::Within(0.6), Weld::Auto][usize::from(self.weld % 4)];
        (PolygonSoup::new(points, polygons), weld)
    }
}

/// One run from raw bytes.
pub(crate) fn drive(bytes: &[u8]) {
    if let Ok(soup) = soup(bytes) {
        check(&soup);
    }
}

fn soup(bytes: &[u8]) -> Result<Soup> {
    let mut u = Unstructured::new(bytes);
    let weld = u.arbitrary()?;
    let count = u.int_in_range(0..=12)?;
    let points = (0..count).map(|_| u.arbitrary()).collect::<Result<_>>()?;
    let mut faces = Vec::new();
    while !u.is_empty() && faces.len() < 24 {
        let degree = [3, 3, 3, 3, 4, 4, 5, 6, 7, 9, 2, 1, 0][usize::from(u.arbitrary::<u8>()? % 13)];
        faces.push((0..degree).map(|_| u.arbitrary()).collect::<Result<_>>()?);
    }
    Ok(Soup { points, faces, weld })
}

/// Cleaning any soup gives a valid mesh and an honest account.
pub(crate) fn check(case: &Soup) {
    let (soup, weld) = case.build();
    let cleaned = clean(&soup, CleanOptions { weld, ..Default::default() }).expect("a soup is never refused");
    let mesh = &cleaned.value;
    assert_eq!(mesh.violations(), []);
    assert_eq!(mesh.validate(), Ok(()));

    // The ladder holds both ways.
    let pool = mesh.to_indexed();
    assert_eq!(Mesh::build(&pool).expect("a mesh has a pool that builds").to_indexed(), pool);

    // Maps fit both ends, and every old face that is gone has a record that says why.
    let (old, new) = (soup.polygons.len(), mesh.face_count());
    assert_eq!((cleaned.maps.faces.old_len(), cleaned.maps.faces.new_len()), (old, new));
    let vertices = &cleaned.maps.vertices;
    assert_eq!((vertices.old_len(), vertices.new_len()), (soup.positions.len(), mesh.vertex_count()));
    hold_both_ways(&cleaned.maps);
    let report = &cleaned.report;
    let dropped = [
        Kind::NonFiniteFace,
        Kind::OutOfRangeFace,
        Kind::ShortFace,
        Kind::DegenerateFace,
        Kind::DuplicateFace,
    ];
    for f in 0..old {
        let element = meshwright::Element::Face(f as u32);
        let gone = report.records.iter().any(|r| r.element == element && dropped.contains(&r.kind));
        assert!(gone || !cleaned.maps.faces.new_of(f).is_empty(), "face {f} vanished");
    }
    for f in 0..new {
        assert_eq!(cleaned.maps.faces.old_of(f).len(), 1, "face {f} comes from one face");
    }
    let tolerance = report.steps.iter().find(|s| s.step == Step::Weld).and_then(|s| s.tolerance);
    let farthest = tolerance.unwrap_or(0.0);
    assert!(farthest == 0.0 || !matches!(weld, Weld::None | Weld::Exact));
    for v in 0..soup.positions.len() {
        assert_eq!(vertices.new_of(v).is_empty(), !soup.positions[v].is_finite(), "vertex {v}");
        for &n in vertices.new_of(v) {
            let moved = pool.positions()[n as usize].distance(soup.positions[v]);
            assert!(moved <= farthest, "vertex {v} moved by {moved}");
        }
    }
    // Records come in the order of steps.
    assert!(report.records.is_sorted_by_key(|r| r.step));

    // New boundary only at recorded edges.
    let indexed = index(&soup, weld).expect("a soup is never refused").value;
    if report.count(Kind::NonManifoldEdge) + report.count(Kind::CutEdge) + report.count(Kind::DuplicateFace)
        == 0
        && indexed.topology().nonmanifold_edges().next().is_none()
    {
        assert_eq!(mesh.boundary_halfedges().count(), indexed.topology().boundary_edges().count());
    }
    // What is a manifold already comes out as it is, with nothing to tell.
    if let Ok(direct) = Mesh::build(&indexed) {
        assert_eq!(direct.to_indexed(), pool);
        let later = |k: &Kind| *k > Kind::PinchedFace;
        assert!(report.records.iter().all(|r| !later(&r.kind)), "{report:?}");
    }

    // A second pass changes nothing.
    let again = PolygonSoup::from(pool.clone());
    let again =
        clean(&again, CleanOptions { weld: Weld::None, ..Default::default() }).expect("never refused");
    assert_eq!(again.report.records, []);
    assert_eq!(again.value.to_indexed(), pool);
    assert!(again.maps.vertices.is_identity() && again.maps.faces.is_identity());

    ladder(&soup);
    let debris = [None, Some(2), Some(4), Some(usize::MAX)][usize::from(case.weld / 4 % 4)];
    without_debris(&soup, weld, debris, mesh);
    solid(&soup, weld, debris);
    attributes(soup, weld, &pool);
}

/// The profile `solid` gives a valid mesh too, and an account that holds; what it leaves open, it names.
fn solid(soup: &PolygonSoup, weld: Weld, debris: Option<usize>) {
    let options = |weld| CleanOptions { weld, debris, ..CleanOptions::solid() };
    let cleaned = clean(soup, options(weld)).expect("a soup is never refused");
    let mesh = &cleaned.value;
    assert_eq!(mesh.violations(), []);
    let pool = mesh.to_indexed();
    hold_both_ways(&cleaned.maps);
    let account = Account::new(soup, (Profile::Solid, weld), &pool, cleaned.report.clone(), &cleaned.maps);
    let account = account.expect("a soup is never refused");
    let tally = account.face_tally;
    assert_eq!(tally.kept + tally.changed + tally.dropped, soup.polygons.len());
    assert_eq!(account.solid, mesh.is_closed());
    let records = &cleaned.report.records;
    for f in 0..soup.polygons.len() {
        let is_named = || records.iter().any(|r| r.element == Element::Face(f as u32));
        assert!(!cleaned.maps.faces.new_of(f).is_empty() || is_named(), "face {f} vanished");
    }
    assert!(records.is_sorted_by_key(|r| r.step));
    let open = mesh.components().iter().filter(|part| part.iter().any(|&f| on_boundary(mesh, f))).count();
    let named = [Kind::OpenPart, Kind::OpenSheet, Kind::NotOrientable].map(|k| cleaned.report.count(k));
    assert_eq!(named.iter().sum::<usize>(), open);
    assert_eq!(mesh.vertices().filter(|&v| mesh.valence(v) == 0).count(), 0);

    let again = clean(&pool.clone().into(), options(Weld::None)).expect("never refused");
    assert_eq!(again.value.to_indexed(), pool, "a second pass changes something: {:?}", again.report.records);
}

/// Debris is dropped by its number of faces, and nothing else changes.
fn without_debris(soup: &PolygonSoup, weld: Weld, debris: Option<usize>, whole: &Mesh) {
    let cleaned = clean(soup, CleanOptions { weld, debris, ..Default::default() }).expect("never refused");
    let mesh = &cleaned.value;
    assert_eq!(mesh.violations(), []);
    hold_both_ways(&cleaned.maps);
    let is_left = |part: &&Vec<FaceKey>| debris.is_none_or(|fewer_than| part.len() >= fewer_than);
    let left: usize = whole.components().iter().filter(is_left).map(Vec::len).sum();
    assert_eq!(mesh.face_count(), left);
    assert_eq!(cleaned.report.count(Kind::Debris), whole.face_count() - left);
}

/// What became of an element knows it came from it, and the other way round.
fn hold_both_ways(maps: &Maps) {
    for relation in [&maps.vertices, &maps.faces] {
        let [old, new] = [relation.old_len(), relation.new_len()].map(|n| n as u32);
        for o in 0..old {
            let became = relation.new_of(o as usize);
            assert!(became.iter().all(|&n| relation.old_of(n as usize).contains(&o)));
        }
        for n in 0..new {
            let was = relation.old_of(n as usize);
            assert!(was.iter().all(|&o| relation.new_of(o as usize).contains(&n)));
        }
    }
}

fn on_boundary(mesh: &Mesh, f: FaceKey) -> bool {
    mesh.face_halfedges(f).any(|h| mesh.is_boundary(mesh.twin(h)))
}

/// Attributes that say where they come from are found there after clean-up, and on the mesh's own corners.
fn attributes(mut soup: PolygonSoup, weld: Weld, pool: &IndexedMesh) {
    let at = |v: u32| soup.positions.get(v as usize).copied().unwrap_or_default();
    let place = |p: DVec3| p.x + 8.0 * p.y + 64.0 * p.z;
    let faces = soup.polygons.iter().zip(0u32..);
    let values: Vec<[f64; 2]> =
        faces.flat_map(|(face, f)| face.iter().map(move |&v| [f64::from(f), place(at(v))])).collect();
    let group = |f: usize| Group { name: format!("{f}"), material: None, faces: f..f + 1 };
    let groups: Vec<Group> = (0..soup.polygons.len()).map(group).collect();
    soup.corner_uvs = Some(CornerData { indices: (0..values.len() as u32).collect(), values });
    soup.groups = groups;
    soup.vertex_normals = (0..soup.positions.len()).map(|v| DVec3::X * (v + 1) as f64).collect();
    soup.vertex_colors = soup.positions.iter().map(|p| [p.x as f32, p.y as f32, p.z as f32, 1.0]).collect();

    let options = CleanOptions { weld, ..Default::default() };
    let cleaned = clean_indexed(&soup, options).expect("a soup is never refused");
    let clean = &cleaned.value;
    assert_eq!((clean.positions(), clean.polygons()), (pool.positions(), pool.polygons()));
    assert_eq!(cleaned.report.not_carried, []);
    let (carried, maps) = (clean.attributes(), &cleaned.maps);
    let is_middle = |v: u32| maps.vertices.old_of(v as usize).is_empty();
    let mut corner = 0;
    for (f, face) in clean.polygons().iter().enumerate() {
        let old = maps.faces.old_of(f)[0];
        let groups = carried.face_groups.as_ref().expect("as many as faces");
        assert_eq!(groups.group(f).map(|g| &g.name), Some(&old.to_string()));
        for &v in face {
            let uv = carried.corner_uvs.as_ref().and_then(|uvs| uvs[corner]).expect("each corner has one");
            assert_eq!(uv.x, f64::from(old));
            if matches!(weld, Weld::None | Weld::Exact) {
                assert_eq!(uv.y, place(clean.positions()[v as usize]), "face {f}, vertex {v}");
            }
            if let Some(normal) = carried.corner_normals.as_ref().and_then(|normals| normals[corner])
                && !is_middle(v)
            {
                let source = normal.x.abs() as usize - 1;
                assert!(maps.vertices.new_of(source).contains(&v), "the normal of {source} at {v}");
            }
            corner += 1;
        }
    }
    for (v, p) in clean.positions().iter().enumerate() {
        let normal = carried.vertex_normals.as_ref().map(|n| n[v].x);
        assert!(normal.is_none_or(|n| is_middle(v as u32) || [n as u32 - 1] == maps.vertices.old_of(v)));
        let [x, y, z, _] = carried.vertex_colors.as_ref().expect("one per vertex")[v].map(f64::from);
        assert!(!matches!(weld, Weld::None | Weld::Exact) || DVec3::new(x, y, z) == *p);
    }
    // To a soup and back.
    let again = PolygonSoup::from(clean.clone());
    assert_eq!(IndexedMesh::try_from(again.clone()).as_ref(), Ok(clean));
    assert_eq!(index(&again, Weld::None).expect("never refused").value, *clean);
    assert_eq!(clean.clone().reversed().reversed(), *clean);
}

/// The rungs without clean-up: refusals are exact.
fn ladder(soup: &PolygonSoup) {
    let Ok(pool) = IndexedMesh::try_from(soup.clone()) else { return };
    let Ok(mut mesh) = Mesh::build(&pool) else { return };
    assert_eq!(mesh.violations(), []);
    assert_eq!(mesh.to_indexed(), pool);
    mesh.reverse();
    assert_eq!(mesh.violations(), []);
    assert_eq!(mesh.to_indexed(), pool.clone().reversed());
    mesh.reverse();
    assert_eq!(mesh.to_indexed(), pool);
}
