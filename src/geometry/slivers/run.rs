//! The loop: needles by length, then larger faces, then caps with the longest first, until nothing can be done.

use super::shape::Gauge;
use super::{LeftSliver, ResolvedSliver, Sliver, SliverAccount, SliverAction, SliverKind, SliverObstacle};
use crate::matching::NONE;
use crate::{Cancelled, Control, FaceKey, Mesh};
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

/// What a change did.
pub(super) struct Done {
    pub(super) action: SliverAction,
    /// Scaled.
    pub(super) moved: f64,
    /// The faces that were there before and changed.
    pub(super) changed: Vec<FaceKey>,
    /// Faces that are new, or have something new beside them.
    pub(super) born: Vec<FaceKey>,
    /// The vertex around which it happened.
    pub(super) vertex: Option<u32>,
}

/// A sweep over slivers under way.
pub(super) struct Run {
    pub(super) mesh: Mesh,
    pub(super) gauge: Gauge,
    /// What is allowed: 0 what is local; 1 splits that clear the way, and collapses of longer edges within the surface;
    /// 2 drawing in of spikes without width.
    pub(super) stage: u8,
    pub(super) splits_left: usize,
    pub(super) account: SliverAccount,
    queue: BinaryHeap<Reverse<(u8, u64, FaceKey)>>,
    /// The slivers, as they were found.
    open: BTreeMap<FaceKey, Sliver>,
    /// Why one was not resolved when it was last tried.
    refused: BTreeMap<FaceKey, SliverObstacle>,
    limit: u64,
    is_spent: bool,
}

impl Run {
    pub(super) fn new(mesh: Mesh, tolerance: f64, found: Vec<Sliver>) -> Self {
        let gauge = Gauge::new(&mesh, tolerance);
        let account = SliverAccount { tolerance, found: found.len(), ..SliverAccount::default() };
        // Some tens of times what meshes from life take.
        let limit = 64 * (mesh.edge_count() as u64) + 128 * (found.len() as u64) + (1 << 20);
        let mut run = Self {
            mesh,
            gauge,
            stage: 0,
            splits_left: 4 * found.len() + 16,
            account,
            queue: BinaryHeap::new(),
            open: found.into_iter().map(|s| (s.face, s)).collect(),
            refused: BTreeMap::new(),
            limit,
            is_spent: false,
        };
        run.put_all();
        run
    }

    pub(super) fn at(&self, v: u32) -> DVec3 {
        self.gauge.at(&self.mesh, v)
    }

    pub(super) fn resolve(&mut self, control: &mut Control<'_>) -> Result<(), Cancelled> {
        let mut share = 0.0f64;
        loop {
            let (mut is_better, mut taken) = (false, 0u32);
            while let Some(Reverse((_, _, key))) = self.queue.pop() {
                if taken.is_multiple_of(1 << 10) {
                    let done = self.account.resolved.len() as f64;
                    share = share.max(done / (done + self.open.len() as f64 + 1.0));
                    control.report("slivers", share)?;
                }
                taken += 1;
                if self.gauge.work > self.limit {
                    self.is_spent = true;
                    return Ok(());
                }
                let Some(f) = self.mesh.face_slot(key).filter(|_| self.open.contains_key(&key)) else {
                    continue;
                };
                let corners = self.gauge.corners(&self.mesh, f);
                let Some((kind, corner)) = self.gauge.look(&corners).fault else { continue };
                match self.attempt(f, kind, corner) {
                    Ok(done) => {
                        is_better = true;
                        self.settle(done);
                    }
                    Err(obstacle) => _ = self.refused.insert(key, obstacle),
                }
            }
            match self.stage {
                _ if self.open.is_empty() => return Ok(()),
                // What was refused may have become legal through changes further away.
                _ if is_better => self.stage = 0,
                2 => return Ok(()),
                _ => self.stage += 1,
            }
            self.put_all();
        }
    }

    fn put_all(&mut self) {
        let all: Vec<FaceKey> = self.open.keys().copied().collect();
        for key in all {
            self.look_at(key);
        }
    }

    /// Puts a face where it belongs, if it is a sliver.
    fn put(&mut self, f: u32) {
        let corners = self.gauge.corners(&self.mesh, f);
        let look = self.gauge.look(&corners);
        let Some((kind, i)) = look.fault else { return };
        let place = match kind {
            SliverKind::Needle => (0, corners[i].1.distance(corners[(i + 1) % corners.len()].1).to_bits()),
            SliverKind::Flat => (1, u64::from(look.size.0)),
            SliverKind::Cap => (2, !look.size.1),
        };
        let key = self.mesh.faces.key(f);
        if !self.open.contains_key(&key)
            && let Some(sliver) = self.gauge.sliver(&self.mesh, f)
        {
            self.account.arose += 1;
            self.open.insert(key, sliver);
        }
        self.queue.push(Reverse((place.0, place.1, key)));
    }

    /// Looks at a face that is new.
    pub(super) fn look_at(&mut self, key: FaceKey) {
        if let Some(f) = self.mesh.face_slot(key) {
            self.put(f);
        }
    }

    fn put_faces_at(&mut self, v: u32) {
        for h in self.mesh.spokes(v) {
            let f = self.mesh.face[h as usize];
            if f != NONE {
                self.put(f);
            }
        }
    }

    /// Writes down what a change did, and puts what may be done next in the queue.
    fn settle(&mut self, done: Done) {
        let moved = done.moved / self.gauge.scale;
        self.account.moved = self.account.moved.max(moved);
        for key in done.changed {
            let slot = self.mesh.face_slot(key);
            let is_left = slot.is_some_and(|f| self.gauge.sliver(&self.mesh, f).is_some());
            if let Some(f) = slot {
                self.put(f);
            }
            if !is_left && let Some(sliver) = self.open.remove(&key) {
                self.refused.remove(&key);
                self.account.resolved.push(ResolvedSliver { sliver, action: done.action, moved });
            }
        }
        for key in done.born {
            self.look_at(key);
        }
        // Those around may be legal now; around a heavy vertex they wait for the next sweep.
        if let Some(v) = done.vertex
            && self.mesh.vertices.is_live(v)
            && self.mesh.outgoing_slots(v).take(65).count() <= 64
        {
            self.put_faces_at(v);
        }
    }

    pub(super) fn finish(mut self) -> (Mesh, SliverAccount) {
        let bare = self.bare_faces();
        for (key, found) in std::mem::take(&mut self.open) {
            let now = self.mesh.face_slot(key).and_then(|f| self.gauge.sliver(&self.mesh, f));
            let obstacle = match self.refused.get(&key) {
                _ if self.is_spent => SliverObstacle::Limit,
                _ if bare.contains(&key) => SliverObstacle::WholeComponent,
                Some(&obstacle) => obstacle,
                None => SliverObstacle::Topology,
            };
            self.account.left.push(LeftSliver { sliver: now.unwrap_or(found), obstacle });
        }
        (self.mesh, self.account)
    }

    /// The slivers of components that have nothing else.
    fn bare_faces(&self) -> BTreeSet<FaceKey> {
        let (mut seen, mut bare) = (BTreeSet::new(), BTreeSet::new());
        for &key in self.open.keys() {
            if seen.contains(&key) {
                continue;
            }
            let (mut part, mut is_bare) = (Vec::new(), true);
            let mut waits = vec![key];
            seen.insert(key);
            while let Some(key) = waits.pop() {
                part.push(key);
                for near in self.mesh.get_face_neighbors(key).into_iter().flatten() {
                    if !self.open.contains_key(&near) {
                        is_bare = false;
                    } else if seen.insert(near) {
                        waits.push(near);
                    }
                }
            }
            if is_bare {
                bare.extend(part);
            }
        }
        bare
    }
}
