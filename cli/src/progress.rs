//! A line of progress for people who wait at a terminal.

use meshwright::Progress;
use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// How long people wait before they are told something.
const PATIENCE: Duration = Duration::from_millis(300);

/// To the beginning of the line, and nothing on it.
const CLEAR: &str = "\r\x1b[K";

/// Runs something with a hook that shows progress on standard error, if that is a terminal and it takes a while.
pub(crate) fn shown<T>(run: impl FnOnce(&mut dyn FnMut(Progress) -> ControlFlow<()>) -> T) -> T {
    let err = std::io::stderr();
    let patience = err.is_terminal().then_some(PATIENCE);
    shown_on(err, patience, run)
}

/// As [`shown`], on any sink; never, if there is no patience.
fn shown_on<T>(
    mut sink: impl Write,
    patience: Option<Duration>,
    run: impl FnOnce(&mut dyn FnMut(Progress) -> ControlFlow<()>) -> T,
) -> T {
    let start = Instant::now();
    let mut was_shown = false;
    let result = run(&mut |progress: Progress| {
        if patience.is_some_and(|p| start.elapsed() >= p) {
            was_shown = true;
            let percent = (progress.fraction * 100.0) as u32;
            let _ = write!(sink, "{CLEAR}{percent:3} % {}", progress.stage);
            let _ = sink.flush();
        }
        ControlFlow::Continue(())
    });
    if was_shown {
        let _ = write!(sink, "{CLEAR}");
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown_with(patience: Option<Duration>) -> String {
        let mut sink = Vec::new();
        let answer = shown_on(&mut sink, patience, |hook| {
            for (stage, fraction) in [("weld", 0.1), ("build", 0.9)] {
                assert!(hook(Progress { stage, fraction }).is_continue());
            }
            7
        });
        assert_eq!(answer, 7);
        String::from_utf8(sink).expect("text")
    }

    #[test]
    fn a_line_of_progress_is_overwritten_and_wiped_away() {
        assert_eq!(shown_with(Some(Duration::ZERO)), "\r\u{1b}[K 10 % weld\r\u{1b}[K 90 % build\r\u{1b}[K");
    }

    #[test]
    fn what_is_quick_or_seen_by_nobody_shows_nothing() {
        assert_eq!(shown_with(Some(Duration::from_secs(3600))), "");
        assert_eq!(shown_with(None), "");
    }
}
