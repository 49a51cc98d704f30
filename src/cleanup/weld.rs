//! Which vertices become one: at equal coordinates, or within a tolerance.

use super::CleanError;
use crate::matching::NONE;
use crate::{Cancelled, Control};
use glam::DVec3;
use smallvec::SmallVec;
use std::collections::HashMap;

/// For each position the lowest index it is merged into (itself if it stays); [`NONE`] if it is not finite.
pub(super) fn weld(
    positions: &[DVec3],
    tolerance: Option<f64>,
    control: &mut Control<'_>,
) -> Result<Vec<u32>, CleanError> {
    match tolerance {
        None => {
            let own = positions.iter().zip(0..);
            Ok(own.map(|(p, i)| if p.is_finite() { i } else { NONE }).collect())
        }
        Some(0.0) => Ok(match exact(positions, control)? {
            Some(welded) => welded.merged(),
            None => exact_by_sorting(positions),
        }),
        Some(t) if t > 0.0 && t.is_finite() => Ok(within(positions, t, control)?),
        Some(t) => Err(CleanError::BadTolerance(t)),
    }
}

/// Vertices after a weld, numbered in the order of the lowest of those merged.
pub(super) struct Welded {
    /// For each vertex before, the one it is in; [`NONE`] if it is not finite.
    pub(super) of: Vec<u32>,
    pub(super) positions: Vec<DVec3>,
    /// For each vertex the lowest of those merged.
    pub(super) sources: Vec<u32>,
}

impl Welded {
    /// As [`weld`], numbered.
    pub(super) fn new(
        positions: &[DVec3],
        tolerance: Option<f64>,
        control: &mut Control<'_>,
    ) -> Result<Self, CleanError> {
        if tolerance != Some(0.0) {
            return Ok(Self::numbered(positions, weld(positions, tolerance, control)?));
        }
        let welded = exact(positions, control)?;
        Ok(welded.unwrap_or_else(|| Self::numbered(positions, exact_by_sorting(positions))))
    }

    /// From what each vertex is merged into.
    pub(super) fn numbered(positions: &[DVec3], merged_into: Vec<u32>) -> Self {
        let mut welded = Self { of: merged_into, positions: Vec::new(), sources: Vec::new() };
        for (v, &p) in positions.iter().enumerate() {
            match welded.of[v] {
                NONE => {}
                kept if kept as usize == v => {
                    welded.of[v] = welded.sources.len() as u32;
                    welded.positions.push(p);
                    welded.sources.push(v as u32);
                }
                // The kept vertex is lower, so it has its number.
                kept => welded.of[v] = welded.of[kept as usize],
            }
        }
        welded
    }

    /// What each vertex is merged into.
    fn merged(mut self) -> Vec<u32> {
        self.of.iter_mut().filter(|v| **v != NONE).for_each(|v| *v = self.sources[*v as usize]);
        self.of
    }
}

/// Coordinates as bits, with one zero.
fn bits(p: DVec3) -> [u64; 3] {
    (p + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// A hash table of kept vertices, open addressing: the vertex's number plus one, or 0 where there is none.
struct Table {
    slots: Vec<u32>,
    shift: u32,
}

impl Table {
    /// With at least so many slots.
    fn new(slots: usize) -> Self {
        let size = slots.next_power_of_two().max(2);
        Self { slots: vec![0; size], shift: 64 - size.trailing_zeros() }
    }

    /// Where the search for a place of this hash begins.
    #[inline(always)]
    fn home(&self, hash: u64) -> usize {
        (hash >> self.shift) as usize
    }

    /// The kept vertex at this place, or the slot for a new one, from where the search begins. `None` if it takes long.
    fn find(&self, p: DVec3, home: usize, kept: &[DVec3]) -> Option<Result<u32, usize>> {
        const LONGEST_PROBE: usize = 256;
        let mask = self.slots.len() - 1;
        let mut slot = home;
        for _ in 0..LONGEST_PROBE {
            match self.slots[slot & mask] {
                0 => return Some(Err(slot & mask)),
                // Equality of floats takes -0 for 0.
                j if kept[j as usize - 1] == p => return Some(Ok(j - 1)),
                _ => slot += 1,
            }
        }
        None
    }

    /// Twice the size.
    fn grow(&mut self, kept: &[DVec3]) -> Option<()> {
        *self = Self::new(self.slots.len() * 2);
        for (&p, number) in kept.iter().zip(1..) {
            let slot = self.find(p, self.home(hash(bits(p))), kept)?.err()?;
            self.slots[slot] = number;
        }
        Some(())
    }
}

/// The vertices that were there last, at a place that the hash gives: half of the hash above the vertex's index.
struct Recent(Vec<u64>);

impl Recent {
    /// So many that a row of a grid still finds the row before, and that the second cache holds them.
    const COUNT: usize = 1 << 14;
    const TAG: u64 = !0 << 32;

    fn new(vertices: usize) -> Self {
        Self(vec![0; Self::COUNT.min(vertices.next_power_of_two())])
    }

    /// A vertex before this one that may be equal, or the vertex itself.
    #[inline(always)]
    fn replace(&mut self, hash: u64, own: u32) -> u32 {
        let mask = self.0.len() - 1;
        let tag = hash & Self::TAG;
        let before = std::mem::replace(&mut self.0[hash as usize & mask], tag | u64::from(own));
        // Only where the hash agrees, so that no memory is touched that went out of the caches.
        if before & Self::TAG == tag { before as u32 } else { own }
    }
}

/// In the order of vertices, so the first of equals is found by the rest. `None` if probes run long: a file made to do so
/// must not cost quadratic time.
///
/// Faces that share a vertex mostly lie close in a file, so that most vertices have an equal among the recent ones. The
/// others go to a table. What is compared there are the kept positions, side by side: where many share a vertex, they and
/// the table are small enough for the caches. Vertices go in batches, so that the memory that all of a batch need is
/// fetched at once; nearly all are found where their search begins.
fn exact(positions: &[DVec3], control: &mut Control<'_>) -> Result<Option<Welded>, Cancelled> {
    const BATCH: usize = 64;
    let mut table = Table::new((positions.len() / 2).max(4 * BATCH));
    let mut recent = Recent::new(positions.len());
    let mut of = Vec::with_capacity(positions.len());
    // A closed surface has half as many vertices as triangles: room for a soup of those, of which no more is touched than
    // is used.
    let mut kept: Vec<DVec3> = Vec::with_capacity(positions.len() / 5);
    let mut sources = Vec::with_capacity(positions.len() / 5);
    let (mut hashes, mut equals) = ([0; BATCH], [0; BATCH]);
    // Those without a recent equal: where in the batch, where in the table, the number of what is there.
    let mut alone = [(0, 0, NONE); BATCH];
    for batch in positions.chunks(BATCH) {
        let done = of.len();
        tick(control, done, positions.len())?;
        if 2 * (kept.len() + BATCH) > table.slots.len() && table.grow(&kept).is_none() {
            return Ok(None);
        }
        batch.iter().zip(&mut hashes).for_each(|(&p, h)| *h = hash(bits(p)));
        let mut count = 0;
        for (i, ((p, &hash), equal)) in batch.iter().zip(&hashes).zip(&mut equals).enumerate() {
            let own = (done + i) as u32;
            let before = recent.replace(hash, own);
            let q = &positions[before as usize];
            let is_equal = (before != own) & (q.x == p.x) & (q.y == p.y) & (q.z == p.z);
            *equal = if is_equal { before } else { own };
            alone[count].0 = i;
            count += usize::from(!is_equal);
        }
        for (i, home, number) in &mut alone[..count] {
            *home = table.home(hashes[*i]);
            *number = table.slots[*home];
        }
        let last = kept.len().saturating_sub(1);
        for (i, _, number) in &mut alone[..count] {
            // Where nothing is in the slot, the last kept vertex is as good as any.
            let j = (*number as usize).wrapping_sub(1).min(last);
            let p = batch[*i];
            let same = kept.get(j).is_some_and(|q| (q.x == p.x) & (q.y == p.y) & (q.z == p.z));
            *number = if same { j as u32 } else { NONE };
        }
        of.resize(done + batch.len(), NONE);
        for &(i, home, number) in &alone[..count] {
            let p = batch[i];
            of[done + i] = match number {
                NONE if !p.is_finite() => NONE,
                NONE => match table.find(p, home, &kept) {
                    Some(Ok(number)) => number,
                    Some(Err(slot)) => {
                        kept.push(p);
                        sources.push((done + i) as u32);
                        table.slots[slot] = kept.len() as u32;
                        kept.len() as u32 - 1
                    }
                    None => return Ok(None),
                },
                number => number,
            };
        }
        // Of equals the earlier one has its number.
        for (v, &equal) in (done..).zip(&equals[..batch.len()]) {
            of[v] = of[equal as usize];
        }
    }
    kept.shrink_to_fit();
    sources.shrink_to_fit();
    Ok(Some(Welded { of, positions: kept, sources }))
}

/// Reports now and then; the weld is the first three tenths of a clean-up.
fn tick(control: &mut Control<'_>, done: usize, of: usize) -> Result<(), Cancelled> {
    if done.is_multiple_of(1 << 19) { control.report("weld", 0.3 * done as f64 / of as f64) } else { Ok(()) }
}

/// Folded multiplication: all bits of the coordinates reach the high bits, from which the slot is taken.
fn hash([x, y, z]: [u64; 3]) -> u64 {
    let fold = |a: u64, b: u64| {
        let wide = u128::from(a) * u128::from(b);
        (wide >> 64) as u64 ^ wide as u64
    };
    let h = fold(x ^ 0x9E37_79B9_7F4A_7C15, y ^ 0xD1B5_4A32_D192_ED03);
    fold(h ^ z, 0xA24B_AED4_963E_E407).wrapping_mul(0x9FB2_1C65_1E98_DF25)
}

fn exact_by_sorting(positions: &[DVec3]) -> Vec<u32> {
    let mut merged = vec![NONE; positions.len()];
    let finite = positions.iter().zip(0u32..).filter(|(p, _)| p.is_finite());
    let mut order: Vec<([u64; 3], u32)> = finite.map(|(&p, i)| (bits(p), i)).collect();
    order.sort_unstable();
    for equal in order.chunk_by(|a, b| a.0 == b.0) {
        for (_, i) in equal {
            merged[*i as usize] = equal[0].1;
        }
    }
    merged
}

/// Whether two points are closer than the tolerance, safe for the smallest and largest numbers.
pub(super) fn is_near(p: DVec3, q: DVec3, tolerance: f64) -> bool {
    let apart = p - q;
    apart.abs().max_element() < tolerance && (apart / tolerance).length_squared() < 1.0
}

/// The tutorial's greedy rule (each vertex joins the lowest kept vertex nearer than the tolerance, and is kept if there
/// is none) in linear time: kept vertices are at least a tolerance apart, so a grid cell four times that wide holds few,
/// and all that are near a point lie in the cells of its corners `x - t`, `x` and `x + t`: eight at most, but for
/// rounding, and fewer than four on the average.
fn within(positions: &[DVec3], tolerance: f64, control: &mut Control<'_>) -> Result<Vec<u32>, Cancelled> {
    let cell = |x: f64| {
        let cell = (x / tolerance * 0.25).floor();
        // So far out that the tolerance is less than a bit of the coordinate: equal coordinates only.
        if cell.is_finite() { cell.to_bits() } else { x.to_bits() }
    };
    let along = |x: f64| {
        // Rounding is monotone, so every coordinate within the tolerance has its cell from the first to the last.
        let mut cells: SmallVec<[u64; 3]> = [x - tolerance, x, x + tolerance].map(cell).into();
        cells.dedup();
        cells
    };
    let mut first: HashMap<[u64; 3], u32> = HashMap::new();
    let mut next_in_cell = vec![NONE; positions.len()];
    let mut merged = Vec::with_capacity(positions.len());
    for (i, &p) in positions.iter().enumerate() {
        if !p.is_finite() {
            merged.push(NONE);
            continue;
        }
        tick(control, i, positions.len())?;
        let p = p + DVec3::ZERO;
        let [xs, ys, zs] = p.to_array().map(along);
        let mut kept = NONE;
        for x in &xs {
            for y in &ys {
                for z in &zs {
                    let mut j = first.get(&[*x, *y, *z]).copied().unwrap_or(NONE);
                    while j != NONE {
                        if j < kept && is_near(p, positions[j as usize], tolerance) {
                            kept = j;
                        }
                        j = next_in_cell[j as usize];
                    }
                }
            }
        }
        if kept == NONE {
            kept = i as u32;
            let head = first.entry(p.to_array().map(cell)).or_insert(NONE);
            next_in_cell[i] = std::mem::replace(head, kept);
        }
        merged.push(kept);
    }
    Ok(merged)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The tutorial's loop.
    fn naive(positions: &[DVec3], tolerance: f64) -> Vec<u32> {
        let mut kept: Vec<usize> = Vec::new();
        let mut merged = Vec::new();
        for (i, &p) in positions.iter().enumerate() {
            let near = |&&j: &&usize| {
                if tolerance == 0.0 { positions[j] == p } else { is_near(p, positions[j], tolerance) }
            };
            match kept.iter().find(near) {
                Some(&j) => merged.push(j as u32),
                None => {
                    kept.push(i);
                    merged.push(i as u32);
                }
            }
        }
        merged
    }

    fn lattice() -> impl Strategy<Value = Vec<DVec3>> {
        let coordinate = prop_oneof![
            (-6i32..6).prop_map(|i| f64::from(i) * 0.1),
            -0.6f64..0.6,
            (-3i32..3).prop_map(|i| 1e17 + f64::from(i) * 16.0),
            Just(-0.0),
        ];
        prop::collection::vec(
            [coordinate.clone(), coordinate.clone(), coordinate].prop_map(DVec3::from),
            0..120,
        )
    }

    proptest! {
        #[test]
        fn welding_within_a_tolerance_equals_the_quadratic_loop(points in lattice(), t in prop_oneof![Just(0.1), Just(0.05), 1e-3f64..0.7, Just(1e-300), Just(20.0)]) {
            prop_assert_eq!(weld(&points, Some(t), &mut Control::none()).unwrap(), naive(&points, t));
        }

        #[test]
        fn exact_welding_equals_the_quadratic_loop(points in lattice()) {
            let welded = exact(&points, &mut Control::none()).unwrap().unwrap();
            let again = Welded::numbered(&points, naive(&points, 0.0));
            prop_assert_eq!((&welded.of, &welded.sources), (&again.of, &again.sources));
            prop_assert_eq!(&welded.positions, &again.positions);
            prop_assert_eq!(welded.merged(), naive(&points, 0.0));
            prop_assert_eq!(exact_by_sorting(&points), naive(&points, 0.0));
        }
    }

    #[test]
    fn exact_welding_of_vertices_that_are_all_apart_keeps_them_all() {
        let points: Vec<DVec3> = (0..5000).map(|i| DVec3::splat(f64::from(i))).collect();
        let welded = exact(&points, &mut Control::none()).unwrap().unwrap();
        assert_eq!(welded.positions, points);
        assert_eq!(welded.merged(), (0..5000).collect::<Vec<u32>>());
    }

    #[test]
    fn a_tolerance_that_is_negative_or_not_a_number_is_refused() {
        for t in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                weld(&[DVec3::ZERO], Some(t), &mut Control::none()),
                Err(CleanError::BadTolerance(_))
            ));
        }
    }

    #[test]
    fn a_chain_of_near_points_is_not_pulled_together() {
        let chain: Vec<DVec3> = (0..5).map(|i| DVec3::X * f64::from(i) * 0.75).collect();
        assert_eq!(weld(&chain, Some(1.0), &mut Control::none()).unwrap(), [0, 0, 2, 2, 4]);
    }
}
