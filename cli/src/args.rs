//! What can be asked for.

use crate::session::Failure;
use clap::{Args, Parser, Subcommand, ValueEnum};
use meshwright::cleanup::Weld;
use meshwright::io::Format;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Inspect, clean and convert meshes (OBJ, STL, PLY, OFF).
///
/// Vertices and faces are numbered from 0, in the order of the file.
///
/// Exit codes: 0 done; 1 answered "no" or refused; 2 wrong usage; 3 the input cannot be read; 4 the output cannot be written.
#[derive(Debug, Parser)]
#[command(name = "meshwright", version, subcommand_required = true, arg_required_else_help = true)]
pub(crate) struct Cli {
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// How many threads may be used [default: all]; results do not depend on it
    #[arg(long, global = true, value_name = "N")]
    pub(crate) threads: Option<NonZeroUsize>,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Tell what state a file is in; nothing is repaired
    Inspect(Inspect),
    /// Make a valid manifold of any file and account for every change
    Clean(Clean),
    /// Write a file in another format
    Convert(Convert),
    /// Reverse the winding of all faces
    Flip(Convert),
    /// Reduce the number of faces by collapsing edges
    Reduce(Reduce),
    /// Merge the two ends of an edge at its middle
    Collapse(Collapse),
    /// Make the winding of neighbouring faces agree
    Unify(Unify),
    /// Ask whether every edge has exactly two faces, with witnesses
    IsClosed(Inspect),
    /// List the edges with only one face, as loops and chains
    NakedEdges(Inspect),
    /// Merge vertices closer than a tolerance
    Weld(WeldCommand),
    /// Part the surface along sharp edges
    Unweld(Unweld),
    /// Even out a surface
    Smooth(Smooth),
    /// Cut faces into smaller ones
    Subdivide(Subdivide),
    /// Scale, rotate and translate, in this order
    Transform(Transform),
    /// Move vertices by a function of their position
    Deform(Deform),
    /// Measure the enclosed volume, the area and the centroid
    Volume(Volume),
    /// Cast a ray, and list where it meets the surface
    Raycast(Raycast),
    /// Find what is nearest to a point
    Closest(Closest),
}

/// A file that is looked at as it is.
#[derive(Debug, Args)]
pub(crate) struct Inspect {
    /// The file
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) weld: ExactWeld,
}

/// Which vertices count as one.
#[derive(Debug, Args)]
pub(crate) struct ExactWeld {
    /// Merge vertices first: none, exact, or closer than a tolerance in the file's units
    #[arg(long, value_name = "none|exact|TOL", default_value = "exact", allow_hyphen_values = true, value_parser = weld)]
    pub(crate) weld: Weld,
}

/// Arguments of `clean`.
#[derive(Debug, Args)]
pub(crate) struct Clean {
    /// The file
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) output: Output,
    /// What the result is for
    #[arg(long, value_enum, default_value = "preserve")]
    pub(crate) profile: Profile,
    /// Merge vertices first: none, exact, auto (a tolerance proposed from the data), or closer than a tolerance
    /// [default: exact; of solid: auto]
    #[arg(long, value_name = "none|exact|auto|TOL", allow_hyphen_values = true, value_parser = weld_or_auto)]
    pub(crate) weld: Option<Weld>,
    /// Drop parts with fewer faces than this
    #[arg(long, value_name = "N")]
    pub(crate) debris: Option<usize>,
    /// Write the account to this file as JSON
    #[arg(long, value_name = "R.json")]
    pub(crate) report: Option<PathBuf>,
    /// Write which old vertices and faces became which new ones to this file as JSON
    #[arg(long, value_name = "M.json")]
    pub(crate) maps: Option<PathBuf>,
}

/// What a clean-up is for.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Profile {
    /// Touch only what forbids a manifold
    Preserve,
    /// Make closed, outward solids; exit code 1 if a part cannot become one
    Solid,
}

/// Arguments of `convert` and `flip`.
#[derive(Debug, Args)]
pub(crate) struct Convert {
    /// The file
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) output: Output,
    #[command(flatten)]
    pub(crate) strict: Strict,
}

/// Arguments of `reduce`.
#[derive(Debug, Args)]
pub(crate) struct Reduce {
    /// The file
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) output: Output,
    #[command(flatten)]
    pub(crate) goal: Goal,
    /// Keep edges at which the surface turns by more than this
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true)]
    pub(crate) sharp: Option<f64>,
    #[command(flatten)]
    pub(crate) strict: Strict,
}

/// How far to reduce.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
pub(crate) struct Goal {
    /// To this many faces
    #[arg(long, value_name = "N")]
    pub(crate) faces: Option<usize>,
    /// To this share of the faces, above 0 and at most 1
    #[arg(long, value_name = "R", allow_hyphen_values = true)]
    pub(crate) ratio: Option<f64>,
    /// As far as the error stays below this, in the file's units
    #[arg(long, value_name = "E", allow_hyphen_values = true)]
    pub(crate) max_error: Option<f64>,
}

/// Arguments of `collapse`.
#[derive(Debug, Args)]
pub(crate) struct Collapse {
    /// The file
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) output: Output,
    /// The edge, by its vertices in the file, counted from 0
    #[arg(long, value_name = "I,J", value_parser = edge)]
    pub(crate) edge: [usize; 2],
    #[command(flatten)]
    pub(crate) strict: Strict,
}

/// Arguments of `unify`.
#[derive(Debug, Args)]
pub(crate) struct Unify {
    /// The file
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) output: Output,
    #[command(flatten)]
    pub(crate) weld: ExactWeld,
    /// Then turn each part outward: closed parts by how deep they lie in others, so that cavities stay cavities; open
    /// parts if their direction is sure enough
    #[arg(long)]
    pub(crate) outward: bool,
}

/// Arguments of `weld`.
#[derive(Debug, Args)]
pub(crate) struct WeldCommand {
    #[command(flatten)]
    pub(crate) change: Convert,
    /// Vertices closer than this become one, in the file's units; 0 merges equal coordinates
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    pub(crate) tolerance: f64,
}

/// Arguments of `unweld`.
#[derive(Debug, Args)]
pub(crate) struct Unweld {
    #[command(flatten)]
    pub(crate) change: Convert,
    /// Edges at which the surface turns by more than this are parted
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true)]
    pub(crate) angle: f64,
}

/// Arguments of `smooth`.
#[derive(Debug, Args)]
pub(crate) struct Smooth {
    #[command(flatten)]
    pub(crate) change: Convert,
    /// How often
    #[arg(long, value_name = "N")]
    pub(crate) iterations: u32,
    /// How far a step goes, above 0 and at most 1; at most 10000 for `implicit`
    #[arg(long, value_name = "L", allow_hyphen_values = true)]
    pub(crate) lambda: f64,
    /// The second step of `taubin`, below -L [default: for a pass band of 0.1]
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(crate) mu: Option<f64>,
    /// What pulls a vertex [default: laplacian, or taubin if there is a mu]
    #[arg(long, value_enum)]
    pub(crate) method: Option<SmoothMethod>,
    /// What boundary vertices do
    #[arg(long, value_enum, default_value = "fixed")]
    pub(crate) boundary: Boundary,
}

/// What pulls a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SmoothMethod {
    /// The mean of its neighbours; shrinks
    Laplacian,
    /// The same, and back by mu: does not shrink
    Taubin,
    /// The mean of its neighbours, weighted by cotangents
    Cotan,
    /// The same in one backward step of any length up to 10000
    Implicit,
}

/// What boundary vertices do.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Boundary {
    /// They stay
    Fixed,
    /// They move along the boundary
    Slide,
    /// They move as all others
    Free,
}

/// Arguments of `subdivide`.
#[derive(Debug, Args)]
pub(crate) struct Subdivide {
    #[command(flatten)]
    pub(crate) change: Convert,
    /// How faces are cut and vertices placed
    #[arg(long, value_enum)]
    pub(crate) scheme: Scheme,
    /// How often
    #[arg(long, value_name = "N")]
    pub(crate) levels: u32,
}

/// How faces are cut and vertices placed.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Scheme {
    /// No vertex moves
    Midpoint,
    /// Smooth, for triangles
    Loop,
    /// Smooth, for any faces
    CatmullClark,
    /// Smooth, three triangles for one
    Sqrt3,
}

/// Arguments of `transform`.
#[derive(Debug, Args)]
pub(crate) struct Transform {
    #[command(flatten)]
    pub(crate) change: Convert,
    /// Scale by one factor or by one for each axis; a negative product mirrors and reverses the winding
    #[arg(long, value_name = "s|x,y,z", allow_hyphen_values = true, value_parser = factors)]
    pub(crate) scale: Option<[f64; 3]>,
    /// Rotate about an axis by an angle in degrees
    #[arg(long, value_name = "ax,ay,az,degrees", allow_hyphen_values = true, value_parser = numbers::<4>)]
    pub(crate) rotate: Option<[f64; 4]>,
    /// Add a vector
    #[arg(long, value_name = "x,y,z", allow_hyphen_values = true, value_parser = numbers::<3>)]
    pub(crate) translate: Option<[f64; 3]>,
    /// What stays in place under --scale and --rotate: a point, or the middle of the bounding box
    #[arg(long, value_name = "x,y,z|center", default_value = "0,0,0", allow_hyphen_values = true, value_parser = origin)]
    pub(crate) origin: Origin,
}

/// What stays in place.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Origin {
    Point([f64; 3]),
    Center,
}

/// Arguments of `deform`.
#[derive(Debug, Args)]
pub(crate) struct Deform {
    #[command(flatten)]
    pub(crate) change: Convert,
    /// Add sin(5 x) cos(5 y) times this to z
    #[arg(long, value_name = "AMPLITUDE", allow_hyphen_values = true)]
    pub(crate) wave: f64,
}

/// Arguments of `volume`.
#[derive(Debug, Args)]
pub(crate) struct Volume {
    /// The file
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) strict: Strict,
}

/// Arguments of `raycast`.
#[derive(Debug, Args)]
pub(crate) struct Raycast {
    /// The file
    pub(crate) file: PathBuf,
    /// Where the ray begins
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = triple, required_unless_present = "queries", requires = "direction")]
    pub(crate) origin: Option<Triple>,
    /// Where it goes; its length is the unit of t
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = triple, required_unless_present = "queries", requires = "origin")]
    pub(crate) direction: Option<Triple>,
    /// Only the first hit
    #[arg(long)]
    pub(crate) first: bool,
    /// Many rays: a file of lines of six numbers, origin and direction, separated by commas
    #[arg(long, value_name = "FILE", conflicts_with_all = ["origin", "direction"])]
    pub(crate) queries: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) strict: Strict,
}

/// Arguments of `closest`.
#[derive(Debug, Args)]
pub(crate) struct Closest {
    /// The file
    pub(crate) file: PathBuf,
    /// The point
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = triple, required_unless_present = "queries")]
    pub(crate) point: Option<Triple>,
    /// What to look for
    #[arg(long, value_enum)]
    pub(crate) to: Target,
    /// Nothing farther than this; if nothing is left the answer is "no"
    #[arg(long, value_name = "D", allow_hyphen_values = true)]
    pub(crate) max_distance: Option<f64>,
    /// Many points: a file of lines of three numbers separated by commas
    #[arg(long, value_name = "FILE", conflicts_with = "point")]
    pub(crate) queries: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) strict: Strict,
}

/// What can be nearest.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Target {
    /// A vertex, whether a face names it or not
    Vertex,
    /// A point on an edge
    Edge,
    /// A face by its nearest point
    Face,
    /// A face by the mean of its corners
    FaceCenter,
    /// A point of the surface
    Surface,
}

/// Three numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triple(pub(crate) [f64; 3]);

fn triple(word: &str) -> Result<Triple, String> {
    let numbers: Result<Vec<f64>, _> = word.split(',').map(|n| n.trim().parse()).collect();
    let triple = numbers.ok().and_then(|n| n.try_into().ok());
    triple.map(Triple).ok_or_else(|| "three numbers separated by commas".to_owned())
}

/// What is done about a file that is no manifold.
#[derive(Debug, Args)]
pub(crate) struct Strict {
    /// Refuse a file that is no oriented manifold, instead of cleaning it
    #[arg(long)]
    pub(crate) strict: bool,
}

/// Where the result goes.
#[derive(Debug, Args)]
pub(crate) struct Output {
    /// Write the result here, whole or not at all; the extension names the format
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Write text where the format offers a choice (PLY, STL)
    #[arg(long)]
    pub(crate) ascii: bool,
}

impl Output {
    /// The format that the extension names.
    pub(crate) fn format(&self) -> Result<Format, Failure> {
        let message = || format!("{}: the extension must be .obj, .stl, .ply or .off", self.output.display());
        Format::from_path(&self.output).ok_or_else(|| Failure::Usage(message()))
    }
}

fn edge(word: &str) -> Result<[usize; 2], String> {
    let number = |part: &str| part.trim().parse().ok();
    let ends = word.split_once(',').and_then(|(i, j)| Some([number(i)?, number(j)?]));
    ends.ok_or_else(|| "two vertex numbers with a comma between".to_owned())
}

fn weld(word: &str) -> Result<Weld, String> {
    match word {
        "none" => Ok(Weld::None),
        "exact" => Ok(Weld::Exact),
        _ => word.parse().map(Weld::Within).map_err(|_| "none, exact or a number".to_owned()),
    }
}

fn weld_or_auto(word: &str) -> Result<Weld, String> {
    if word == "auto" {
        Ok(Weld::Auto)
    } else {
        weld(word).map_err(|_| "none, exact, auto or a number".to_owned())
    }
}

/// Numbers separated by commas.
fn numbers<const N: usize>(word: &str) -> Result<[f64; N], String> {
    let all: Result<Vec<f64>, _> = word.split(',').map(|x| x.trim().parse()).collect();
    all.ok().and_then(|all| all.try_into().ok()).ok_or_else(|| format!("{N} numbers separated by commas"))
}

fn factors(word: &str) -> Result<[f64; 3], String> {
    match word.trim().parse() {
        Ok(factor) => Ok([factor; 3]),
        Err(_) => numbers(word).map_err(|_| "one number or three separated by commas".to_owned()),
    }
}

fn origin(word: &str) -> Result<Origin, String> {
    if word == "center" {
        Ok(Origin::Center)
    } else {
        numbers(word).map(Origin::Point).map_err(|_| "center or three numbers separated by commas".to_owned())
    }
}
