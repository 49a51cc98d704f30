//! A mesh with user data, checkpoints and the record attached, and what is verified after each edit.

use super::apply::{Done, apply, check};
use super::twin::{After, Id, Plain, expect};
use super::{Edit, Graveyard, Op};
use meshwright::glam::{DVec2, DVec3};
use meshwright::{
    Change, Checkpoint, Column, EdgeKey, Event, FaceKey, HalfedgeKey, Lineage, Mesh, Numbering, Rule,
    VertexKey,
};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Debug;

/// User data of every kind.
#[derive(Clone, Copy)]
struct Data {
    heat: Column<VertexKey, f64>,
    events: Column<VertexKey, u64>,
    uv: Column<HalfedgeKey, DVec2>,
    mark: Column<EdgeKey, u32>,
    part: Column<FaceKey, u32>,
}

impl Data {
    fn on(mesh: &mut Mesh) -> Self {
        let counted = |event, sources: &[(&u64, f64)]| match event {
            Event::Merge => sources.iter().fold(0, |n: u64, s| n.wrapping_add(*s.0)),
            Event::Move => sources[0].0.wrapping_add(1),
            _ => *sources[0].0,
        };
        let data = Self {
            heat: mesh.add_vertex_column(0.5, Rule::interpolate()),
            events: mesh.add_vertex_column(1, Rule::custom(counted)),
            uv: mesh.add_corner_column(DVec2::NEG_ONE, Rule::interpolate()),
            mark: mesh.add_edge_column(7, Rule::keep()),
            part: mesh.add_face_column(9, Rule::keep()),
        };
        for (i, v) in mesh.vertices().enumerate().collect::<Vec<_>>() {
            mesh.set_value(data.heat, v, i as f64).expect("a live vertex");
        }
        for (i, e) in mesh.edges().enumerate().collect::<Vec<_>>() {
            mesh.set_value(data.mark, e, i as u32).expect("a live edge");
        }
        for (i, f) in mesh.faces().enumerate().collect::<Vec<_>>() {
            mesh.set_value(data.part, f, i as u32).expect("a live face");
            // Every third face is a chart of its own.
            let chart = if i % 3 == 0 { DVec2::splat(i as f64) } else { DVec2::ZERO };
            for h in mesh.face_halfedges(f).collect::<Vec<_>>() {
                let place = mesh.position(mesh.origin(h)).truncate();
                mesh.set_value(data.uv, h, place + chart).expect("a corner");
            }
        }
        data
    }
}

/// A state to come back to.
struct Mark {
    checkpoint: Checkpoint,
    mesh: Mesh,
    /// How many changes stood, if they were recorded.
    told: Option<usize>,
}

/// The record so far.
struct Record {
    lineage: Lineage,
    start: Numbering,
    edges: BTreeSet<EdgeKey>,
    /// Numberings on the way, with how many changes stood.
    stops: Vec<(usize, Numbering)>,
    /// Whether all changes were fetched.
    fetched: bool,
}

pub(crate) struct World {
    pub(crate) mesh: Mesh,
    /// How often each operator was tried and done.
    pub(crate) tally: BTreeMap<&'static str, [usize; 2]>,
    data: Data,
    seen: Graveyard,
    marks: Vec<Mark>,
    record: Option<Record>,
}

type Verdict = Result<(), String>;

fn equal<T: PartialEq + Debug>(what: &str, a: T, b: T) -> Verdict {
    if a == b { Ok(()) } else { Err(format!("{what}: {a:?} is not {b:?}")) }
}

fn set<K: Ord + Copy>(keys: impl IntoIterator<Item = K>) -> BTreeSet<K> {
    keys.into_iter().collect()
}

impl World {
    pub(crate) fn new(mut mesh: Mesh) -> Self {
        let data = Data::on(&mut mesh);
        let mut world = Self {
            mesh,
            tally: BTreeMap::new(),
            data,
            seen: Graveyard::default(),
            marks: Vec::new(),
            record: None,
        };
        world.remember(&Mesh::default());
        world
    }

    /// Keeps keys that were not there before, for when they are dead.
    fn remember(&mut self, before: &Mesh) {
        let (mesh, seen) = (&self.mesh, &mut self.seen);
        seen.vertices.extend(mesh.vertices().filter(|&v| !before.contains_vertex(v)));
        seen.edges.extend(mesh.edges().filter(|&e| !before.contains_edge(e)));
        seen.halfedges.extend(mesh.halfedges().filter(|&h| !before.contains_halfedge(h)));
        seen.faces.extend(mesh.faces().filter(|&f| !before.contains_face(f)));
    }

    fn dead(&self) -> Graveyard {
        let (mesh, seen) = (&self.mesh, &self.seen);
        Graveyard {
            vertices: seen.vertices.iter().copied().filter(|&v| !mesh.contains_vertex(v)).collect(),
            edges: seen.edges.iter().copied().filter(|&e| !mesh.contains_edge(e)).collect(),
            halfedges: seen.halfedges.iter().copied().filter(|&h| !mesh.contains_halfedge(h)).collect(),
            faces: seen.faces.iter().copied().filter(|&f| !mesh.contains_face(f)).collect(),
        }
    }

    /// Does one edit; with the naive twin beside it, or just so.
    pub(crate) fn step(&mut self, i: usize, edit: &Edit, twin: bool) {
        let verdict = if twin {
            match edit.op(&self.mesh, &self.dead()) {
                Some(op) => self.verified(i, *edit, &op),
                None => self.other(*edit),
            }
        } else {
            match edit.op(&self.mesh, &Graveyard::default()) {
                Some(op) => {
                    let done = apply(&mut self.mesh, *edit, &op).is_ok();
                    self.count(&op, done);
                    Ok(())
                }
                None => self.other(*edit),
            }
        };
        if let Err(what) = verdict {
            panic!("edit {i}, {edit:?}: {what}");
        }
    }

    /// Verifies one operator on a copy.
    pub(crate) fn try_out(&self, op: &Op) {
        let mut copy = Self {
            mesh: self.mesh.clone(),
            tally: BTreeMap::new(),
            data: self.data,
            seen: Graveyard::default(),
            marks: Vec::new(),
            record: None,
        };
        if let Err(what) = copy.verified(0, Edit::Forget, op) {
            panic!("{what}");
        }
    }

    fn count(&mut self, op: &Op, done: bool) {
        let tally = self.tally.entry(op.name()).or_default();
        tally[0] += 1;
        tally[1] += usize::from(done);
    }

    fn verified(&mut self, i: usize, edit: Edit, op: &Op) -> Verdict {
        let before = self.mesh.clone();
        let expected = expect(&before, op);
        let checked = check(&before, op);
        if checked.is_ok() != expected.is_ok() {
            let lists = Plain::of(&before);
            return Err(format!(
                "{op:?}: check says {checked:?}, the twin {:?} on {lists:?}",
                expected.err()
            ));
        }
        let noted = self.mesh.checkpoint_bytes();
        let done = apply(&mut self.mesh, edit, op);
        self.count(op, done.is_ok());
        equal("check and edit", checked, done.as_ref().map(|_| ()).map_err(Clone::clone))?;
        let verdict = match done {
            Ok(done) => self.is_as_expected(&before, &expected?, &done),
            Err(_) => equal("bytes noted", noted, self.mesh.checkpoint_bytes())
                .and_then(|()| same(&self.mesh, &before, self.data))
                .and_then(|()| same_free(&self.mesh, &before)),
        };
        verdict.map_err(|what| format!("{op:?}: {what} on {:?}", Plain::of(&before)))?;
        self.follow(i, &before)?;
        self.remember(&before);
        Ok(())
    }

    /// After an edit that was done.
    fn is_as_expected(&self, before: &Mesh, expected: &[After], done: &Done) -> Verdict {
        let mesh = &self.mesh;
        equal("validate", mesh.validate(), Ok(()))?;
        equal("violations", mesh.violations(), Vec::new())?;
        // Born and dead is what the result names, no more and no less.
        let (old, new) = (keys(before), keys(mesh));
        equal("dead vertices", &old.0 - &new.0, set(done.dead_vertices.iter().copied()))?;
        equal("dead edges", &old.1 - &new.1, set(done.dead_edges.iter().copied()))?;
        equal("dead faces", &old.2 - &new.2, set(done.dead_faces.iter().copied()))?;
        equal("born vertices", &new.0 - &old.0, set(done.vertices.iter().copied()))?;
        equal("born edges", &new.1 - &old.1, set(done.edges.iter().copied()))?;
        equal("born faces", &new.2 - &old.2, set(done.faces.iter().copied()))?;
        equal("edges named once", set(done.dead_edges.iter().copied()).len(), done.dead_edges.len())?;
        let verdicts: Vec<Verdict> = expected.iter().map(|a| self.matches(before, a, done)).collect();
        if !verdicts.iter().any(Result::is_ok) {
            return Err(verdicts.into_iter().filter_map(Result::err).collect::<Vec<_>>().join("; or "));
        }
        for h in mesh.boundary_halfedges() {
            equal("a half-edge without a corner", *mesh.value(self.data.uv, h), DVec2::NEG_ONE)?;
        }
        if let Some(isolated) = &done.isolated {
            let lost = |v: &VertexKey| mesh.is_isolated(*v) && before.get_is_isolated(*v) == Some(false);
            equal("isolated", set(isolated.iter().copied()), mesh.vertices().filter(lost).collect())?;
        }
        Ok(())
    }

    fn matches(&self, before: &Mesh, after: &After, done: &Done) -> Verdict {
        let (mesh, data) = (&self.mesh, self.data);
        let now = Plain::of(mesh);
        let vertex = |v: Id<VertexKey>| Id::Old(v.key(&done.vertices));
        let edge = |e: Id<EdgeKey>| Id::Old(e.key(&done.edges));
        let face = |f: Id<FaceKey>| Id::Old(f.key(&done.faces));
        let p = &after.plain;
        let at: BTreeMap<_, _> = p.at.iter().map(|(&v, &at)| (vertex(v), at)).collect();
        equal("positions", &now.at, &at)?;
        let edges: BTreeMap<_, _> = p.edges.iter().map(|(&e, ends)| (edge(e), ends.map(vertex))).collect();
        equal("edges", &now.edges, &edges)?;
        // A face begins where it began; anywhere if that corner is gone.
        let begins = |f: Id<FaceKey>, cycle: &Vec<Id<VertexKey>>| {
            let Id::Old(key) = f else { return cycle.clone() };
            let Some(mut was) = before.get_face_vertices(key) else { return cycle.clone() };
            let keeps = was.next().is_some_and(|v| cycle.contains(&Id::Old(v)));
            let at = if keeps { 0 } else { (0..cycle.len()).min_by_key(|&i| cycle[i]).unwrap_or(0) };
            cycle[at..].iter().chain(&cycle[..at]).copied().collect()
        };
        let faces: BTreeMap<_, _> = p
            .faces
            .iter()
            .map(|(&f, c)| (face(f), c.iter().map(|&v| vertex(v)).collect::<Vec<_>>()))
            .map(|(f, c)| (f, begins(f, &c)))
            .collect();
        equal("faces", now.faces.iter().map(|(&f, c)| (f, begins(f, c))).collect(), faces)?;
        if let Some(v) = done.kept_vertex {
            equal("the vertex left", mesh.contains_vertex(v) && before.contains_vertex(v), true)?;
            equal("mixed vertex", after.mixed_vertices.contains(&Id::Old(v)), true)?;
        }
        if let Some(e) = done.kept_edge {
            equal("the edge left", after.mixed_edges.iter().next(), Some(&Id::Old(e)))?;
        }
        if let Some(kept) = &done.kept_faces
            && !after.mixed_faces.is_empty()
        {
            equal("the face left", set(kept.iter().map(|&f| Id::Old(f))), after.mixed_faces.clone())?;
        }

        // Values stay where nothing was merged.
        for v in before.vertices().filter(|v| mesh.contains_vertex(*v)) {
            if !after.mixed_vertices.contains(&Id::Old(v)) {
                equal("heat", before.value(data.heat, v), mesh.value(data.heat, v))?;
                equal("events", before.value(data.events, v), mesh.value(data.events, v))?;
            }
        }
        for e in before.edges().filter(|e| mesh.contains_edge(*e)) {
            if !after.mixed_edges.contains(&Id::Old(e)) {
                equal("mark", before.value(data.mark, e), mesh.value(data.mark, e))?;
            }
        }
        for f in before.faces().filter(|f| mesh.contains_face(*f)) {
            if !after.mixed_faces.contains(&Id::Old(f)) {
                equal("part", before.value(data.part, f), mesh.value(data.part, f))?;
            }
        }
        let (old, new) = (corners(before), corners(mesh));
        for (&(f, v), &h) in &old {
            let is_mixed = after.mixed_corners.contains(&(Id::Old(f), Id::Old(v)));
            if let Some(&n) = new.get(&(f, v)).filter(|_| !is_mixed) {
                equal("uv", (f, v, before.value(data.uv, h)), (f, v, mesh.value(data.uv, n)))?;
            }
        }
        for &((f, v), from) in &after.corners {
            if !after.mixed_corners.contains(&(f, v)) {
                let to = (f.key(&done.faces), v.key(&done.vertices));
                let [is, was] = [mesh.value(data.uv, new[&to]), before.value(data.uv, old[&from])];
                equal("uv", (to, is), (to, was))?;
            }
        }
        for &((f, v), both) in &after.means {
            let v = v.key(&done.vertices);
            let mean: DVec2 = both.map(|f| *before.value(data.uv, old[&(f, v)])).iter().sum::<DVec2>() * 0.5;
            let is = *mesh.value(data.uv, new[&(f.key(&done.faces), v)]);
            equal("mean uv", (is - mean).length() <= 1e-12 * (1.0 + mean.length()), true)
                .map_err(|e| format!("{e}: {is} for {mean} at {v:?}"))?;
        }
        for h in mesh.halfedges().filter(|&h| !mesh.is_boundary(h)) {
            equal("finite uv", mesh.value(data.uv, h).is_finite(), true)?;
        }
        Ok(())
    }

    /// The record tells what happened since `before`.
    fn follow(&mut self, i: usize, before: &Mesh) -> Verdict {
        let Some(record) = &mut self.record else { return Ok(()) };
        if i % 3 == 2 {
            record.fetched = false;
            return Ok(());
        }
        let changes = self.mesh.take_changes();
        if std::mem::replace(&mut record.fetched, true) {
            let (mut born, mut died) =
                (<(Vec<_>, Vec<_>, Vec<_>)>::default(), <(Vec<_>, Vec<_>, Vec<_>)>::default());
            for change in &changes {
                match change {
                    Change::VertexBorn { vertex, .. } => born.0.push(*vertex),
                    Change::VertexDied { vertex, .. } => died.0.push(*vertex),
                    Change::EdgeBorn { edge, .. } => born.1.push(*edge),
                    Change::EdgeDied { edge, .. } => died.1.push(*edge),
                    Change::FaceBorn { face, .. } => born.2.push(*face),
                    Change::FaceDied { face, .. } => died.2.push(*face),
                    _ => {}
                }
            }
            let (old, new) = (keys(before), keys(&self.mesh));
            for list in [&born.0, &died.0] {
                equal("told once", set(list.iter().copied()).len(), list.len())?;
            }
            equal("vertices told", (&new.0 - &old.0, &old.0 - &new.0), (set(born.0), set(died.0)))?;
            equal("edges told", (&new.1 - &old.1, &old.1 - &new.1), (set(born.1), set(died.1)))?;
            equal("faces told", (&new.2 - &old.2, &old.2 - &new.2), (set(born.2), set(died.2)))?;
        }
        record.lineage.extend(changes);
        if i.is_multiple_of(5) {
            record.stops.push((record.lineage.changes().len(), self.mesh.numbering()));
        }
        Ok(())
    }

    /// Fetches what was told; the lineage then leads from the start of the recording to the mesh as it is.
    fn agree(&mut self) -> Verdict {
        let Some(record) = &mut self.record else { return Ok(()) };
        record.lineage.extend(self.mesh.take_changes());
        record.fetched = true;
        let mut live =
            (set(record.start.vertices.clone()), record.edges.clone(), set(record.start.faces.clone()));
        for change in record.lineage.changes() {
            let fits = match change {
                Change::VertexBorn { vertex, .. } => live.0.insert(*vertex),
                Change::VertexDied { vertex, .. } => live.0.remove(vertex),
                Change::EdgeBorn { edge, .. } => live.1.insert(*edge),
                Change::EdgeDied { edge, .. } => live.1.remove(edge),
                Change::FaceBorn { face, .. } => live.2.insert(*face),
                Change::FaceDied { face, .. } => live.2.remove(face),
                _ => true,
            };
            equal("a change that fits", (fits, change), (true, change))?;
        }
        equal("the record's elements", live, keys(&self.mesh))?;
        let now = self.mesh.numbering();
        let told = record.lineage.changes();
        if let Some((at, stop)) = record.stops.get(record.stops.len() / 2) {
            let part = |changes: &[Change]| Lineage::of(changes.iter().cloned());
            let [first, second] = [part(&told[..*at]), part(&told[*at..])];
            let composed = first.maps(&record.start, stop).then(&second.maps(stop, &now));
            equal("composed maps", composed, Ok(record.lineage.maps(&record.start, &now)))?;
        }
        Ok(())
    }

    /// Edits that are no operators.
    fn other(&mut self, edit: Edit) -> Verdict {
        let before = self.mesh.clone();
        match edit {
            Edit::Move(n, place) => {
                let count = self.mesh.vertex_count().max(1);
                let v = self.mesh.vertices().nth(n as usize % count);
                if let Some(v) = v {
                    let at = place.among(&[self.mesh.position(v), DVec3::ZERO]);
                    equal("moved", self.mesh.set_position(v, at).is_ok(), at.is_finite())?;
                }
            }
            Edit::Paint(n, value) => {
                let mesh = &mut self.mesh;
                let at = |count: usize| n as usize % count.max(1);
                let v = mesh.vertices().nth(at(mesh.vertex_count()));
                let e = mesh.edges().nth(at(mesh.edge_count()));
                let f = mesh.faces().nth(at(mesh.face_count()));
                let painted = [
                    v.map(|v| mesh.set_value(self.data.heat, v, f64::from(value)).map(drop)),
                    e.map(|e| mesh.set_value(self.data.mark, e, u32::from(value)).map(drop)),
                    f.map(|f| mesh.set_value(self.data.part, f, u32::from(value)).map(drop)),
                    f.map(|f| mesh.face_halfedge(f))
                        .map(|h| mesh.set_value(self.data.uv, h, DVec2::splat(f64::from(value))).map(drop)),
                ];
                equal("painted", painted.into_iter().flatten().all(|p| p.is_ok()), true)?;
            }
            Edit::Checkpoint => {
                self.agree()?;
                let told = self.record.as_ref().map(|r| r.lineage.changes().len());
                let checkpoint = self.mesh.checkpoint();
                let mut mesh = self.mesh.clone();
                mesh.forget_checkpoints();
                self.marks.push(Mark { checkpoint, mesh, told });
            }
            Edit::Restore(n) if !self.marks.is_empty() => {
                let at = n as usize % self.marks.len();
                let later = self.marks.split_off(at + 1);
                let mark = &self.marks[at];
                equal("restored", self.mesh.restore(mark.checkpoint), Ok(()))?;
                same(&self.mesh, &mark.mesh, self.data)?;
                let told = mark.told;
                for mark in later {
                    equal("a later checkpoint", self.mesh.restore(mark.checkpoint).is_err(), true)?;
                }
                if let Some(record) = &mut self.record {
                    // From before the recording: what follows is told anew, from the oldest state told of.
                    let most = told.unwrap_or(0);
                    record.stops.retain(|s| s.0 <= most);
                }
                self.agree()?;
                if let (Some(record), Some(told)) = (&self.record, told) {
                    equal("changes that stand", record.lineage.changes().len(), told)?;
                }
                equal("violations", self.mesh.violations(), Vec::new())?;
            }
            Edit::ForgetBefore(n) if !self.marks.is_empty() => {
                let at = n as usize % self.marks.len();
                let checkpoint = self.marks[at].checkpoint;
                equal("forgotten", self.mesh.forget_checkpoints_before(checkpoint), Ok(()))?;
                for mark in self.marks.drain(..at) {
                    equal("an older checkpoint", self.mesh.restore(mark.checkpoint).is_err(), true)?;
                }
                same(&self.mesh, &before, self.data)?;
            }
            Edit::Forget => {
                self.mesh.forget_checkpoints();
                self.marks.clear();
                same(&self.mesh, &before, self.data)?;
                equal("bytes noted", self.mesh.checkpoint_bytes(), 0)?;
            }
            Edit::Record if self.record.is_none() => {
                self.mesh.record_changes();
                let (start, edges) = (self.mesh.numbering(), self.mesh.edges().collect());
                self.marks.iter_mut().for_each(|m| m.told = None);
                let (lineage, stops) = (Lineage::default(), Vec::new());
                self.record = Some(Record { lineage, start, edges, stops, fetched: true });
            }
            Edit::StopRecording => {
                self.agree()?;
                self.record = None;
                self.marks.iter_mut().for_each(|m| m.told = None);
                equal("nothing left to tell", self.mesh.stop_recording(), Vec::new())?;
            }
            _ => {}
        }
        self.remember(&before);
        Ok(())
    }

    /// The last words of a script.
    pub(crate) fn finish(&mut self) {
        let verdict = self.agree().and_then(|()| self.other(Edit::Restore(0)));
        assert_eq!(verdict, Ok(()), "at the end");
        assert_eq!(self.mesh.violations(), []);
        assert_eq!(self.mesh.validate(), Ok(()));
        let pool = self.mesh.to_indexed();
        let again = Mesh::build(&pool).expect("a mesh has a pool that builds");
        assert_eq!(again.to_indexed(), pool);
    }
}

fn keys(mesh: &Mesh) -> (BTreeSet<VertexKey>, BTreeSet<EdgeKey>, BTreeSet<FaceKey>) {
    (mesh.vertices().collect(), mesh.edges().collect(), mesh.faces().collect())
}

/// The half-edge of each corner.
fn corners(mesh: &Mesh) -> BTreeMap<(FaceKey, VertexKey), HalfedgeKey> {
    let inner = mesh.halfedges().filter_map(|h| Some((mesh.face(h)?, h)));
    inner.map(|(f, h)| ((f, mesh.origin(h)), h)).collect()
}

/// Whether two states have the same elements, links, positions and values.
fn same(a: &Mesh, b: &Mesh, data: Data) -> Verdict {
    let order = |m: &Mesh| {
        (m.vertices().collect::<Vec<_>>(), m.edges().collect::<Vec<_>>(), m.faces().collect::<Vec<_>>())
    };
    equal("elements", order(a), order(b))?;
    for h in a.halfedges() {
        let links = |m: &Mesh| (m.next(h), m.prev(h), m.twin(h), m.origin(h), m.face(h), m.edge(h));
        equal("links", (h, links(a)), (h, links(b)))?;
        equal("uv", (h, a.value(data.uv, h)), (h, b.value(data.uv, h)))?;
    }
    for v in a.vertices() {
        let all = |m: &Mesh| {
            (m.vertex_halfedge(v), m.position(v), *m.value(data.heat, v), *m.value(data.events, v))
        };
        equal("vertex", (v, all(a)), (v, all(b)))?;
    }
    for f in a.faces() {
        let all = |m: &Mesh| (m.face_halfedge(f), *m.value(data.part, f));
        equal("face", (f, all(a)), (f, all(b)))?;
    }
    for e in a.edges() {
        equal("mark", (e, a.value(data.mark, e)), (e, b.value(data.mark, e)))?;
    }
    Ok(())
}

/// Whether two meshes make the same keys from now on, and have the same to tell.
fn same_free(a: &Mesh, b: &Mesh) -> Verdict {
    let grown = |m: &Mesh| {
        let mut m = m.clone();
        let told = m.take_changes();
        let vertices: Vec<_> = (0..5).filter_map(|_| m.add_vertex(DVec3::ONE).ok()).collect();
        let faces = [m.add_face(&vertices[..3]), m.add_face(&vertices[1..4])];
        (told, vertices, faces, m.edges().collect::<Vec<_>>())
    };
    equal("new keys", grown(a), grown(b))
}
