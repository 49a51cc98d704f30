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
        Some(0.0) => Ok(exact(positions, control)?.unwrap_or_else(|| exact_by_sorting(positions))),
        Some(t) if t > 0.0 && t.is_finite() => Ok(within(positions, t, control)?),
        Some(t) => Err(CleanError::BadTolerance(t)),
    }
}

/// Coordinates as bits, with one zero.
fn bits(p: DVec3) -> [u64; 3] {
    (p + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// Open addressing in the order of vertices, so the first of equals is found by the rest. `None` if probes run long: a
/// file made to do so must not cost quadratic time.
fn exact(positions: &[DVec3], control: &mut Control<'_>) -> Result<Option<Vec<u32>>, Cancelled> {
    const LONGEST_PROBE: usize = 256;
    let size = (positions.len() * 2).next_power_of_two().max(2);
    let shift = 64 - size.trailing_zeros();
    let mut table = vec![NONE; size];
    let mut merged = Vec::with_capacity(positions.len());
    for (i, &p) in positions.iter().enumerate() {
        tick(control, i, positions.len())?;
        if !p.is_finite() {
            merged.push(NONE);
            continue;
        }
        let mut slot = (hash(bits(p)) >> shift) as usize;
        let mut probes = 0;
        let kept = loop {
            match table[slot] {
                NONE => {
                    table[slot] = i as u32;
                    break i as u32;
                }
                // Equality of floats takes -0 for 0.
                j if positions[j as usize] == p => break j,
                _ if probes == LONGEST_PROBE => return Ok(None),
                _ => {
                    probes += 1;
                    slot = (slot + 1) & (size - 1);
                }
            }
        };
        merged.push(kept);
    }
    Ok(Some(merged))
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
            prop_assert_eq!(exact(&points, &mut Control::none()).unwrap().unwrap(), naive(&points, 0.0));
            prop_assert_eq!(exact_by_sorting(&points), naive(&points, 0.0));
        }
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
