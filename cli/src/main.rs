//! The command line of meshwright: inspect, clean and convert meshes.

mod args;
mod commands;
mod import;
mod output;
mod progress;
mod session;

use args::Cli;
use clap::Parser;
use session::Session;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let mut session = Session::new(cli.json);
    let result = commands::run(&cli.command, &mut session);
    session.finish(result)
}
