//! The command line of meshwright: inspect, clean and convert meshes.

mod account;
mod args;
mod commands;
mod import;
mod output;
mod progress;
mod session;
mod text;

use args::Cli;
use clap::Parser;
use session::Session;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let mut session = Session::new(cli.json);
    if let Some(threads) = cli.threads {
        // The pool is not running yet, so this cannot fail; and results do not depend on it.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build_global();
    }
    let result = commands::run(&cli.command, &mut session);
    session.finish(result)
}
