//! The commands, each from its arguments to its answer.

mod ask;
mod bulk;
mod change;
mod clean;
mod look;
mod shrink;

use crate::args::Command;
use crate::session::{Answer, Failure, Session};
use meshwright::Relation;

/// Runs one command.
pub(crate) fn run(command: &Command, session: &mut Session) -> Result<Answer, Failure> {
    match command {
        Command::Inspect(args) => look::inspect(session, args),
        Command::IsClosed(args) => look::is_closed(session, args),
        Command::NakedEdges(args) => look::naked_edges(session, args),
        Command::Volume(args) => look::volume(session, args),
        Command::Raycast(args) => ask::raycast(session, args),
        Command::Closest(args) => ask::closest(session, args),
        Command::Clean(args) => clean::clean(session, args),
        Command::Convert(args) => change::convert(session, args),
        Command::Flip(args) => change::flip(session, args),
        Command::Reduce(args) => shrink::reduce(session, args),
        Command::Collapse(args) => shrink::collapse(session, args),
        Command::Unify(args) => change::unify(session, args),
        Command::Weld(args) => bulk::weld(session, args),
        Command::Unweld(args) => bulk::unweld(session, args),
        Command::Smooth(args) => bulk::smooth(session, args),
        Command::Subdivide(args) => bulk::subdivide(session, args),
        Command::Transform(args) => bulk::transform(session, args),
        Command::Deform(args) => bulk::deform(session, args),
    }
}

/// The file's number of an element: the lowest of those it was made from.
fn in_file(relation: &Relation, new: u32) -> u32 {
    relation.old_of(new as usize).first().copied().unwrap_or(new)
}
