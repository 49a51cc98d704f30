//! A line of progress for people who wait at a terminal.

use meshwright::Progress;
use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// Runs something with a hook that shows progress on standard error, if that is a terminal and it takes a while.
pub(crate) fn shown<T>(run: impl FnOnce(&mut dyn FnMut(Progress) -> ControlFlow<()>) -> T) -> T {
    const PATIENCE: Duration = Duration::from_millis(300);
    let is_terminal = std::io::stderr().is_terminal();
    let start = Instant::now();
    let mut was_shown = false;
    let result = run(&mut |progress: Progress| {
        if is_terminal && start.elapsed() > PATIENCE {
            was_shown = true;
            let percent = (progress.fraction * 100.0) as u32;
            let _ = write!(std::io::stderr().lock(), "\r\x1b[K{percent:3} % {}", progress.stage);
            let _ = std::io::stderr().flush();
        }
        ControlFlow::Continue(())
    });
    if was_shown {
        let _ = write!(std::io::stderr().lock(), "\r\x1b[K");
    }
    result
}
