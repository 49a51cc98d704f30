//! The names of what is found, of the steps that act, and of data.

use std::fmt;

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
        /// Boundary edges around which not all was looked at for what they might be stitched to, as so much lies there; one
        /// stands for all.
        UnsearchedEdges = "unsearched_edges",
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
        /// Holes that were not looked through for islands to the end, as there were so many; one stands for all.
        UnsearchedHoles = "unsearched_holes",
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
