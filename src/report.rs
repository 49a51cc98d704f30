//! The one vocabulary for accounts of what an operation changed: [`Outcome`], [`Report`], [`Maps`].

use glam::DVec3;
use std::collections::BTreeMap;
use std::fmt;

/// What a lossy operation returns: the result, the account of what was changed, and the old <-> new relations.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Outcome<T> {
    /// The result.
    pub value: T,
    /// What was changed, element by element.
    pub report: Report,
    /// Which input vertices and faces became which output vertices and faces.
    pub maps: Maps,
}

/// An element of the input, in the input's own numbering.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Element {
    /// A vertex by its index.
    Vertex(u32),
    /// A face by its index.
    Face(u32),
    /// An edge by the two vertices it joins, the lower index first.
    Edge([u32; 2]),
    /// A corner by its face and its number in it, from 0.
    Corner([u32; 2]),
    /// Two faces by their indices, the lower first.
    Faces([u32; 2]),
    /// A vertex that lies on an edge: the vertex, then the two vertices that the edge joins, the lower index first.
    VertexOnEdge([u32; 3]),
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Vertex(v) => write!(f, "vertex {v}"),
            Self::Face(face) => write!(f, "face {face}"),
            Self::Edge([a, b]) => write!(f, "edge {a}-{b}"),
            Self::Corner([face, corner]) => write!(f, "corner {corner} of face {face}"),
            Self::VertexOnEdge([v, a, b]) => write!(f, "vertex {v} on edge {a}-{b}"),
            Self::Faces([a, b]) => write!(f, "faces {a} and {b}"),
        }
    }
}

macro_rules! named {
    ($(#[$meta:meta])* $name:ident { $($(#[$doc:meta])* $variant:ident = $text:literal,)* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
        #[non_exhaustive]
        pub enum $name { $($(#[$doc])* $variant,)* }

        impl $name {
            /// The name used in JSON.
            pub fn as_str(self) -> &'static str {
                match self { $(Self::$variant => $text,)* }
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.as_str())
            }
        }
    };
}

named! {
    /// What was found at a place, and thereby what was done about it.
    Kind {
        /// A vertex with a NaN or infinite coordinate; dropped.
        NonFiniteVertex = "non_finite_vertex",
        /// A face with a non-finite vertex; dropped.
        NonFiniteFace = "non_finite_face",
        /// A face with an index outside the vertices; dropped.
        OutOfRangeFace = "out_of_range_face",
        /// A face the input states with fewer than three corners; dropped.
        ShortFace = "short_face",
        /// A vertex merged into another at a different position, within the tolerance.
        MergedVertex = "merged_vertex",
        /// A face that named one vertex several times in a row (or ran along an edge and back); the repeats were removed.
        RepeatedCorner = "repeated_corner",
        /// A face with fewer than three distinct corners left; dropped.
        DegenerateFace = "degenerate_face",
        /// A face that touched itself at a vertex or along an edge; replaced by simple faces that cover the same corners.
        PinchedFace = "pinched_face",
        /// A face with the same corner cycle as an earlier one, in either direction; dropped.
        DuplicateFace = "duplicate_face",
        /// A face whose winding was reversed.
        FlippedFace = "flipped_face",
        /// An edge with three or more faces; its faces were paired, or left with boundary.
        NonManifoldEdge = "non_manifold_edge",
        /// An edge cut open because the surface around it cannot be oriented.
        CutEdge = "cut_edge",
        /// A vertex whose faces fell into several fans; one vertex was made for each.
        PinchedVertex = "pinched_vertex",
        /// An edge that doubled another between the same two vertices; a vertex was put at its midpoint.
        ParallelEdge = "parallel_edge",
        /// An edge at which the surface turns by more than an angle; parted.
        SharpEdge = "sharp_edge",
        /// An edge of a crack: two boundary edges that lay at one place, within the tolerance, became one.
        StitchedEdge = "stitched_edge",
        /// A vertex that lay within another face's edge, within the tolerance; the edge was cut there.
        TJunction = "t_junction",
        /// A sheet that hung on a surface at edges with three or more faces; its faces were dropped.
        Fin = "fin",
        /// A face with an edge that has no length; collapsed.
        Needle = "needle",
        /// A triangle with a corner on the opposite edge; merged into its neighbour, so that no hole opens.
        Cap = "cap",
        /// A larger face without height, or that would be cut into triangles of which one has none; cut and resolved.
        FlatFace = "flat_face",
        /// A face with height that went with slivers beside it; its neighbours cover its place.
        AbsorbedFace = "absorbed_face",
        /// A face without height that could not be resolved; left.
        LeftSliver = "left_sliver",
        /// A part with fewer faces than the caller asked for; its faces were dropped.
        Debris = "debris",
        /// A hole that was filled.
        FilledHole = "filled_hole",
        /// Holes filled ear by ear, with little area but not the least, as there were so many; one stands for all.
        HastyFillers = "hasty_fillers",
        /// A hole with islands, or several loops around one hole; left.
        HoleWithIslands = "hole_with_islands",
        /// A hole whose every filler would double an edge; left.
        HemmedInHole = "hemmed_in_hole",
        /// A hole that is the outside of one face, or whose filler would have about the size of its part; left.
        OutsideOfSheet = "outside_of_sheet",
        /// A hole of more edges than were asked for; left.
        LongHole = "long_hole",
        /// A vertex without a face; dropped.
        IsolatedVertex = "isolated_vertex",
        /// A shell that was turned: outward, or inward around a cavity.
        TurnedShell = "turned_shell",
        /// A shell that crosses another; turned by its own volume.
        CrossingShell = "crossing_shell",
        /// An open part that is a sheet: to close it, a filler of about its own size would be needed. Left.
        OpenSheet = "open_sheet",
        /// An open part of which two boundary edges lie at one place and run the same way: so it is where a surface that
        /// cannot be oriented was cut. Left.
        NotOrientable = "not_orientable",
        /// An open part with holes that could not be filled. Left.
        OpenPart = "open_part",
        /// Two faces that pass through each other. Left.
        SelfIntersection = "self_intersection",
        /// Faces that were not held against all others, as so many pass through each other or lie in one place; one stands for
        /// all.
        UnsearchedFaces = "unsearched_faces",
    }
}

named! {
    /// A step of an operation, in the order in which steps run.
    Step {
        /// Dropping of non-finite vertices, and of faces that name them, are out of range or too short.
        DropInvalid = "drop_invalid",
        /// Merging of vertices at the same position, or within a tolerance.
        Weld = "weld",
        /// Repair of faces that name a vertex more than once.
        RepairPolygons = "repair_polygons",
        /// Dropping of faces that are there already.
        DropDuplicates = "drop_duplicates",
        /// Closing of cracks and T-junctions.
        Stitch = "stitch",
        /// Making windings agree across edges.
        Unify = "unify",
        /// Pairing of the faces at edges with three or more of them.
        PairFaces = "pair_faces",
        /// Cutting of surfaces that cannot be oriented.
        CutEdges = "cut_edges",
        /// Splitting of vertices so that each has one fan.
        SplitVertices = "split_vertices",
        /// Dropping of sheets that hang on a surface at edges with three or more faces.
        DropFins = "drop_fins",
        /// Resolving of zero-area faces, caps and needles.
        ResolveSlivers = "resolve_slivers",
        /// Dropping of parts with few faces.
        DropDebris = "drop_debris",
        /// Filling of holes.
        FillHoles = "fill_holes",
        /// Dropping of vertices without a face.
        DropIsolated = "drop_isolated",
        /// Turning of whole parts outward.
        TurnOutward = "turn_outward",
        /// Looking for faces that pass through each other.
        FindIntersections = "find_intersections",
        /// Looking for parts that are still open.
        FindOpenParts = "find_open_parts",
        /// Parting of sharp edges.
        Unweld = "unweld",
        /// Cutting of polygons into triangles by the shared rule.
        Triangulate = "triangulate",
        /// One or more levels of subdivision.
        Subdivide = "subdivide",
    }
}

named! {
    /// Data beside positions and faces.
    Attribute {
        /// Given normals of vertices.
        VertexNormals = "vertex_normals",
        /// Colours of vertices.
        VertexColors = "vertex_colors",
        /// Normals of corners.
        CornerNormals = "corner_normals",
        /// Texture coordinates of corners.
        TextureCoordinates = "texture_coordinates",
        /// Groups and materials.
        Groups = "groups",
        /// The names of material files.
        MaterialFiles = "material_files",
    }
}

named! {
    /// Why a value of an attribute was not carried.
    LossReason {
        /// It is NaN or infinite: a vertex normal becomes zero, a vertex colour white, a corner has none.
        NonFinite = "non_finite",
        /// The corner refers to a value that does not exist, and has none.
        NoSuchValue = "no_such_value",
        /// Vertices with different values became one, and the lowest vertex's was kept.
        Merged = "merged",
        /// Vertex normals became normals of corners, and no corner names the vertex.
        NoCorner = "no_corner",
        /// The face is in two groups, and stays in the one that begins first.
        TwoGroups = "two_groups",
    }
}

/// A value of an attribute that was not carried, while others of it were.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LostValue {
    /// Of which attribute.
    pub attribute: Attribute,
    /// Why.
    pub reason: LossReason,
    /// Whose, in the input's numbering.
    pub element: Element,
}

/// How large something is that a record stands for, where it is more than the element named.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Extent {
    /// The edges around a hole, or the faces of a part.
    pub elements: usize,
    /// The area of what fills the hole, or of the part, in square units.
    pub area: f64,
}

/// One change, with its element in the input's numbering and its place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Record {
    /// The step that acted.
    pub step: Step,
    /// What was found.
    pub kind: Kind,
    /// Where, in the input's numbering.
    pub element: Element,
    /// Where in space: the vertex, the edge's midpoint, the mean of the face's corners. `None` when not finite.
    pub place: Option<DVec3>,
    /// The size of a hole or a part. `None` for single elements.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub extent: Option<Extent>,
}

impl Record {
    /// A record of a single element.
    pub(crate) fn new(step: Step, kind: Kind, element: Element, place: Option<DVec3>) -> Self {
        Self { step, kind, element, place, extent: None }
    }

    /// A record of something larger than the element named.
    pub(crate) fn sized(self, elements: usize, area: f64) -> Self {
        Self { extent: Some(Extent { elements, area }), ..self }
    }
}

/// What one step did in all, recorded or not.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StepSummary {
    /// The step.
    pub step: Step,
    /// How many elements it changed; or found, if it only looks. An exact weld counts its merges here and keeps no record of them: it moves
    /// nothing, and [`Maps`] names every one.
    pub changed: usize,
    /// The tolerance it used, in the mesh's units, if it has one.
    pub tolerance: Option<f64>,
    /// How far it moved the surface, in the mesh's units: the farthest that one operation did. What was dropped or made new
    /// is told by records.
    #[cfg_attr(feature = "serde", serde(default))]
    pub moved: f64,
}

impl StepSummary {
    /// A step without a tolerance that moved nothing.
    pub(crate) fn new(step: Step, changed: usize) -> Self {
        Self { step, changed, tolerance: None, moved: 0.0 }
    }
}

/// A located, typed account. Empty means: nothing was changed but what [`Maps`] and exact welding tell. What happened to
/// attributes stands apart.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Report {
    /// The steps that ran, in order.
    pub steps: Vec<StepSummary>,
    /// The changes, in the order of the steps, and by element within a step.
    pub records: Vec<Record>,
    /// Data of the input that the result does not have.
    pub not_carried: Vec<Attribute>,
    /// Single values that the result does not have, by attribute, reason and element.
    #[cfg_attr(feature = "serde", serde(default))]
    pub lost_values: Vec<LostValue>,
}

impl Report {
    /// Whether there is no record.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// Adds what a step did to what the same step did before.
    pub(crate) fn add_step(&mut self, step: StepSummary) {
        match self.steps.iter_mut().find(|s| s.step == step.step) {
            Some(all) => {
                all.changed += step.changed;
                all.moved = all.moved.max(step.moved);
            }
            None => self.steps.push(step),
        }
    }

    /// The number of records of one kind. Linear in the records.
    pub fn count(&self, kind: Kind) -> usize {
        self.records.iter().filter(|r| r.kind == kind).count()
    }

    /// The number of records of each kind that occurs.
    pub fn counts(&self) -> BTreeMap<Kind, usize> {
        let mut counts = BTreeMap::new();
        for record in &self.records {
            *counts.entry(record.kind).or_insert(0) += 1;
        }
        counts
    }
}

/// Where old vertices and faces went, and where new ones come from.
///
/// # Examples
/// ```
/// use meshwright::{Maps, Relation};
/// let weld = Maps { vertices: Relation::from_map(&[Some(0), Some(1), Some(0)], 2), faces: Relation::identity(1) };
/// assert_eq!(weld.vertices.new_of(2), &[0]);
/// assert_eq!(weld.vertices.old_of(0), &[0, 2]);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Maps {
    /// Vertices.
    pub vertices: Relation,
    /// Faces.
    pub faces: Relation,
}

impl Maps {
    /// Nothing was renumbered.
    pub fn identity(vertices: usize, faces: usize) -> Self {
        Self { vertices: Relation::identity(vertices), faces: Relation::identity(faces) }
    }

    /// The relations of this operation followed by `next`.
    ///
    /// # Errors
    /// [`MapMismatch`] when `next` does not start where this one ends.
    pub fn then(&self, next: &Self) -> Result<Self, MapMismatch> {
        Ok(Self { vertices: self.vertices.then(&next.vertices)?, faces: self.faces.then(&next.faces)? })
    }

    /// The relations read backwards.
    pub fn inverse(&self) -> Self {
        Self { vertices: self.vertices.inverse(), faces: self.faces.inverse() }
    }
}

/// Two relations cannot be composed: the first ends with another number of elements than the second begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the first relation ends with {first} elements, the second begins with {second}")]
pub struct MapMismatch {
    /// The new elements of the first relation.
    pub first: usize,
    /// The old elements of the second.
    pub second: usize,
}

/// A many-to-many relation between old and new indices, readable both ways.
///
/// An old element that was dropped has no new one; one that was split has several; a new element made from nothing
/// has no old one. Lists are ascending. Memory: 4 bytes per pair and direction, and 4 per element where lists differ
/// in length.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(into = "RelationLists"))]
pub struct Relation {
    forward: Lists,
    backward: Lists,
}

/// What a relation looks like in JSON: for each old index its new ones, for each new index its old ones.
#[cfg(feature = "serde")]
#[derive(serde::Serialize)]
struct RelationLists {
    new_of: Vec<Vec<u32>>,
    old_of: Vec<Vec<u32>>,
}

#[cfg(feature = "serde")]
impl From<Relation> for RelationLists {
    fn from(r: Relation) -> Self {
        let lists = |l: &Lists| (0..l.len()).map(|i| l.get(i).to_vec()).collect();
        Self { new_of: lists(&r.forward), old_of: lists(&r.backward) }
    }
}

/// Lists of indices, one after the other. `starts` is empty when every list holds exactly one index.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Lists {
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    fn len(&self) -> usize {
        if self.starts.is_empty() { self.items.len() } else { self.starts.len() - 1 }
    }

    fn get(&self, i: usize) -> &[u32] {
        if self.starts.is_empty() {
            self.items.get(i..i + 1).unwrap_or(&[])
        } else if i + 1 < self.starts.len() {
            &self.items[self.starts[i] as usize..self.starts[i + 1] as usize]
        } else {
            &[]
        }
    }

    /// Groups pairs `(list, item)` that come in ascending order of item; a counting sort.
    fn group(count: usize, pairs: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let mut starts = vec![0u32; count + 1];
        for (list, _) in pairs.clone() {
            starts[list as usize + 1] += 1;
        }
        let single = starts[1..].iter().all(|&n| n == 1);
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let mut items = vec![0u32; starts[count] as usize];
        let mut at = starts.clone();
        for (list, item) in pairs {
            let slot = &mut at[list as usize];
            items[*slot as usize] = item;
            *slot += 1;
        }
        Self { starts: if single { Vec::new() } else { starts }, items }
    }

    fn pairs(&self) -> impl Iterator<Item = (u32, u32)> + Clone + '_ {
        (0..self.len()).flat_map(move |i| self.get(i).iter().map(move |&item| (i as u32, item)))
    }
}

impl Relation {
    /// Every element stays what it is.
    pub fn identity(count: usize) -> Self {
        let lists = Lists { starts: Vec::new(), items: (0..count as u32).collect() };
        Self { forward: lists.clone(), backward: lists }
    }

    /// Every old element has one new one or none. Entries at or past `new_count` count as none.
    pub fn from_map(new_of_old: &[Option<u32>], new_count: usize) -> Self {
        let pairs = new_of_old
            .iter()
            .enumerate()
            .filter_map(|(old, new)| new.filter(|&n| (n as usize) < new_count).map(|n| (old as u32, n)));
        Self {
            forward: Lists::group(new_of_old.len(), pairs.clone()),
            backward: Lists::group(new_count, pairs.map(|(old, new)| (new, old))),
        }
    }

    /// Any pairs `(old, new)`, in any order; repeats count once, pairs out of range not at all. O(n log n).
    pub fn from_pairs(
        old_count: usize,
        new_count: usize,
        pairs: impl IntoIterator<Item = (u32, u32)>,
    ) -> Self {
        let mut pairs: Vec<_> = pairs
            .into_iter()
            .filter(|&(old, new)| (old as usize) < old_count && (new as usize) < new_count)
            .collect();
        if !pairs.is_sorted() {
            pairs.sort_unstable();
        }
        pairs.dedup();
        Self {
            forward: Lists::group(old_count, pairs.iter().copied()),
            backward: Lists::group(new_count, pairs.iter().map(|&(old, new)| (new, old))),
        }
    }

    /// Every new element is a part of one old one, below `old_count`. O(elements).
    pub(crate) fn from_parents(old_count: usize, parents: Vec<u32>) -> Self {
        let forward = Lists::group(old_count, parents.iter().copied().zip(0..));
        Self { forward, backward: Lists { starts: Vec::new(), items: parents } }
    }

    /// For each new element, in order, its old ones: ascending, without repeats, below `old_count`. O(pairs).
    pub(crate) fn from_old_of(old_count: usize, starts: Vec<u32>, items: Vec<u32>) -> Self {
        let count = starts.len().saturating_sub(1);
        let single = items.len() == count && starts.iter().zip(0u32..).all(|(&s, i)| s == i);
        let mut forward = vec![0u32; old_count + 1];
        items.iter().for_each(|&old| forward[old as usize + 1] += 1);
        let is_single = forward[1..].iter().all(|&n| n == 1);
        (0..old_count).for_each(|i| forward[i + 1] += forward[i]);
        let mut list = vec![0u32; items.len()];
        let mut at = forward.clone();
        for (range, new) in starts.windows(2).zip(0..) {
            for &old in &items[range[0] as usize..range[1] as usize] {
                let slot = &mut at[old as usize];
                list[*slot as usize] = new;
                *slot += 1;
            }
        }
        Self {
            forward: Lists { starts: if is_single { Vec::new() } else { forward }, items: list },
            backward: Lists { starts: if single { Vec::new() } else { starts }, items },
        }
    }

    /// The number of old elements.
    pub fn old_len(&self) -> usize {
        self.forward.len()
    }

    /// The number of new elements.
    pub fn new_len(&self) -> usize {
        self.backward.len()
    }

    /// The new elements that old element `i` became, ascending; none if it was dropped or never was.
    pub fn new_of(&self, i: usize) -> &[u32] {
        self.forward.get(i)
    }

    /// The old elements that new element `i` was made from, ascending.
    pub fn old_of(&self, i: usize) -> &[u32] {
        self.backward.get(i)
    }

    /// Whether every element stays what it is.
    pub fn is_identity(&self) -> bool {
        self.forward.starts.is_empty()
            && self.backward.starts.is_empty()
            && self.forward.items.iter().enumerate().all(|(i, &n)| n as usize == i)
    }

    /// This relation followed by `next`.
    ///
    /// # Errors
    /// [`MapMismatch`] when `next` does not start where this one ends.
    pub fn then(&self, next: &Self) -> Result<Self, MapMismatch> {
        if self.new_len() != next.old_len() {
            return Err(MapMismatch { first: self.new_len(), second: next.old_len() });
        }
        let pairs = self
            .forward
            .pairs()
            .flat_map(|(old, mid)| next.new_of(mid as usize).iter().map(move |&new| (old, new)));
        Ok(Self::from_pairs(self.old_len(), next.new_len(), pairs))
    }

    /// The same with new elements added at the end that come from nothing.
    pub(crate) fn widened(mut self, new_len: usize) -> Self {
        if new_len > self.new_len() {
            let pairs: Vec<_> = self.backward.pairs().collect();
            self.backward = Lists::group(new_len, pairs.into_iter());
        }
        self
    }

    /// The relation read backwards.
    pub fn inverse(&self) -> Self {
        Self { forward: self.backward.clone(), backward: self.forward.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_relation_followed_by_its_inverse_relates_the_merged_elements() {
        let weld = Relation::from_map(&[Some(0), Some(0), None, Some(1)], 2);
        let around = weld.then(&weld.inverse()).unwrap();
        assert_eq!(around.new_of(0), &[0, 1]);
        assert_eq!(around.new_of(2), &[] as &[u32]);
        assert_eq!(around.new_of(3), &[3]);
    }

    #[test]
    fn a_split_reads_both_ways() {
        let split = Relation::from_pairs(2, 3, [(1, 2), (0, 0), (1, 1), (1, 2)]);
        assert_eq!(split.new_of(1), &[1, 2]);
        assert_eq!(split.old_of(2), &[1]);
        assert_eq!(split.new_of(9), &[] as &[u32]);
    }

    #[test]
    fn composing_relations_of_different_sizes_is_refused() {
        let refused = Relation::identity(2).then(&Relation::identity(3));
        assert_eq!(refused, Err(MapMismatch { first: 2, second: 3 }));
    }

    #[test]
    fn identity_is_recognised_however_it_was_made() {
        assert!(Relation::from_map(&[Some(0), Some(1)], 2).is_identity());
        assert!(Relation::identity(2).then(&Relation::identity(2)).unwrap().is_identity());
        assert!(!Relation::from_map(&[Some(1), Some(0)], 2).is_identity());
        assert!(!Relation::from_map(&[Some(0)], 2).is_identity());
    }
}
