//! Faces that name a vertex more than once after the weld.

use crate::Polygons;
use crate::geometry::normals::double_area_vector;
use crate::geometry::triangulate::Triangulator;
use crate::geometry::unit_scale;
use glam::DVec3;

/// What became of a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Repair {
    /// Nothing: its vertices are distinct.
    Intact,
    /// Repeats were taken out; one simple face is left.
    Shortened,
    /// It touched itself; several simple faces cover it.
    Divided,
    /// Fewer than three distinct corners are left.
    Gone,
}

/// Repairs one face after the other; scratch space is kept.
#[derive(Default)]
pub(super) struct PolygonRepair {
    /// Positions in the face, not vertices: a vertex may come from several corners.
    kept: Vec<u32>,
    sorted: Vec<u32>,
    triangulator: Triangulator,
}

impl PolygonRepair {
    /// Appends to `out` the simple faces that a face becomes, as positions in it (`0` for its first corner).
    pub(super) fn repair(&mut self, face: &[u32], at: impl Fn(u32) -> DVec3, out: &mut Polygons) -> Repair {
        let n = face.len() as u32;
        if self.is_simple(face.iter().copied()) {
            out.push(0..n);
            return Repair::Intact;
        }
        self.take_out_repeats(face);
        if self.kept.len() < 3 {
            return Repair::Gone;
        }
        let kept = std::mem::take(&mut self.kept);
        let repair = if self.is_simple(kept.iter().map(|&i| face[i as usize])) {
            out.push(kept.iter().copied());
            Repair::Shortened
        } else {
            self.divide(face, &kept, at, out)
        };
        self.kept = kept;
        repair
    }

    fn is_simple(&mut self, face: impl ExactSizeIterator<Item = u32> + Clone) -> bool {
        let corners = || face.clone();
        if face.len() <= 8 {
            return corners().enumerate().all(|(i, v)| corners().take(i).all(|u| u != v));
        }
        self.sorted.clear();
        self.sorted.extend(corners());
        self.sorted.sort_unstable();
        self.sorted.windows(2).all(|w| w[0] != w[1])
    }

    /// Takes out corners that repeat the one before, and spurs that run along an edge and back, until there are none.
    fn take_out_repeats(&mut self, face: &[u32]) {
        let vertex = |i: &u32| face[*i as usize];
        let kept = &mut self.kept;
        kept.clear();
        for i in 0..face.len() as u32 {
            kept.push(i);
            loop {
                let n = kept.len();
                if n >= 2 && vertex(&kept[n - 1]) == vertex(&kept[n - 2]) {
                    kept.pop();
                } else if n >= 3 && vertex(&kept[n - 1]) == vertex(&kept[n - 3]) {
                    kept.truncate(n - 2);
                } else {
                    break;
                }
            }
        }
        // The same where the end meets the beginning.
        let (mut first, mut last) = (0, kept.len());
        while last - first >= 2 {
            if vertex(&kept[last - 1]) == vertex(&kept[first]) {
                last -= 1;
            } else if last - first >= 3 && vertex(&kept[last - 1]) == vertex(&kept[first + 1]) {
                first += 1;
                last -= 1;
            } else if last - first >= 3 && vertex(&kept[last - 2]) == vertex(&kept[first]) {
                last -= 2;
            } else {
                break;
            }
        }
        kept.truncate(last);
        kept.drain(..first);
    }

    /// Divides a face that touches itself: at the vertices where it does if all parts then turn the same way (a figure
    /// of several lobes), into triangles if not (a keyhole around a hole).
    fn divide(
        &mut self,
        face: &[u32],
        kept: &[u32],
        at: impl Fn(u32) -> DVec3,
        out: &mut Polygons,
    ) -> Repair {
        let vertex = |i: u32| face[i as usize];
        let scale = unit_scale(kept.iter().map(|&i| at(vertex(i))));
        let area = |part: &[u32]| double_area_vector(part.iter().map(|&i| at(vertex(i)) * scale));
        let whole = area(kept);
        let lobes = lobes(kept, vertex);
        if lobes.iter().all(|l| l.len() >= 3 && area(l).dot(whole) > 0.0) {
            lobes.into_iter().for_each(|l| out.push(l));
            return Repair::Divided;
        }
        let before = out.len();
        // The rule reads from the lowest vertex; give it corners it can tell apart, in the order of vertices.
        for &[a, b, c] in self.triangulator.triangulate(kept, |i| at(vertex(i))) {
            let t = [a, b, c].map(vertex);
            if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
                out.push([a, b, c]);
            }
        }
        if out.len() == before { Repair::Gone } else { Repair::Divided }
    }
}

/// Cuts a closed walk into walks that name no vertex twice.
fn lobes(kept: &[u32], vertex: impl Fn(u32) -> u32) -> Vec<Vec<u32>> {
    let mut lobes = Vec::new();
    let mut walk: Vec<u32> = Vec::new();
    // Where in `walk` each vertex stands; looked up only.
    let mut stands: std::collections::HashMap<u32, usize> = std::collections::HashMap::new();
    for &i in kept {
        if let Some(&start) = stands.get(&vertex(i)) {
            let lobe = walk.split_off(start);
            lobe.iter().for_each(|&j| {
                stands.remove(&vertex(j));
            });
            lobes.push(lobe);
        }
        stands.insert(vertex(i), walk.len());
        walk.push(i);
    }
    lobes.push(walk);
    lobes
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    fn repaired(face: &[u32], points: &[DVec3]) -> (Repair, Vec<Vec<u32>>) {
        let mut out = Polygons::new();
        let repair = PolygonRepair::default().repair(face, |v| points[v as usize], &mut out);
        (repair, out.iter().map(|f| f.iter().map(|&i| face[i as usize]).collect()).collect())
    }

    fn grid() -> Vec<DVec3> {
        (0..16).map(|i| dvec3(f64::from(i % 4), f64::from(i / 4), 0.0)).collect()
    }

    #[test]
    fn repeats_in_a_row_are_taken_out_around_the_end_too() {
        assert_eq!(repaired(&[0, 0, 1, 5, 5, 4, 0], &grid()), (Repair::Shortened, vec![vec![0, 1, 5, 4]]));
    }

    #[test]
    fn a_spur_is_taken_out_wherever_the_face_begins() {
        for face in [[0, 1, 2, 1, 5, 4], [2, 1, 5, 4, 0, 1], [1, 2, 1, 5, 4, 0], [1, 5, 4, 0, 1, 2]] {
            let (repair, faces) = repaired(&face, &grid());
            assert_eq!((repair, faces.len(), faces[0].len()), (Repair::Shortened, 1, 4), "{face:?}");
        }
    }

    #[test]
    fn a_face_that_runs_to_and_fro_is_gone() {
        assert_eq!(repaired(&[0, 1, 2, 1], &grid()).0, Repair::Gone);
        assert_eq!(repaired(&[3, 3, 3], &grid()).0, Repair::Gone);
        assert_eq!(repaired(&[0, 1, 0, 1, 0, 1], &grid()).0, Repair::Gone);
    }

    #[test]
    fn two_squares_at_a_corner_become_two_faces() {
        let (repair, faces) = repaired(&[0, 1, 5, 6, 10, 9, 5, 4], &grid());
        assert_eq!(repair, Repair::Divided);
        assert_eq!(faces, [vec![5, 6, 10, 9], vec![0, 1, 5, 4]]);
    }

    #[test]
    fn a_keyhole_around_a_hole_becomes_triangles_that_leave_the_hole_open() {
        // A 3 x 3 square with the middle square cut out.
        let face = [0, 3, 15, 12, 0, 5, 9, 10, 6, 5];
        let (repair, faces) = repaired(&face, &grid());
        assert_eq!(repair, Repair::Divided);
        let points = grid();
        let area: f64 =
            faces.iter().map(|f| double_area_vector(f.iter().map(|&v| points[v as usize])).z / 2.0).sum();
        assert_eq!((faces.len(), area), (8, 8.0));
    }
}
