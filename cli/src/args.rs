//! What can be asked for.

use crate::session::Failure;
use clap::{Args, Parser, Subcommand, ValueEnum};
use meshwright::cleanup::Weld;
use meshwright::io::Format;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Inspect, clean and convert meshes (OBJ, STL, PLY, OFF).
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
    /// Measure the enclosed volume, the area and the centroid
    Volume(Volume),
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
    /// What for
    #[arg(long, value_enum, default_value = "preserve")]
    pub(crate) profile: Profile,
    /// Merge vertices first: none, exact, auto (a tolerance proposed from the data), or closer than a tolerance
    #[arg(long, value_name = "none|exact|auto|TOL", default_value = "exact", allow_hyphen_values = true, value_parser = weld_or_auto)]
    pub(crate) weld: Weld,
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
    /// The edge, by its vertices in the imported mesh, counted from 0
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
}

/// Arguments of `volume`.
#[derive(Debug, Args)]
pub(crate) struct Volume {
    /// The file
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) strict: Strict,
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
