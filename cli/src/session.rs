//! One run: what was asked for, how long each part took, and how it ends.

use meshwright::io::{Place, ReadError};
use serde_json::{Map, Value, json};
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

/// What a command answers.
#[derive(Debug, Default)]
pub(crate) struct Answer {
    /// The fields of the JSON object.
    pub(crate) json: Map<String, Value>,
    /// A long list among them, already in JSON: half a million values would take a kilobyte each.
    pub(crate) list: Option<(&'static str, String)>,
    /// The same for people, on standard output.
    pub(crate) text: String,
    /// Whether the answer is "no" (exit code 1).
    pub(crate) is_no: bool,
}

/// Why there is no answer.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The request makes no sense (exit code 2).
    Usage(String),
    /// The input cannot be read (exit code 3).
    Input { message: String, place: Option<Place> },
    /// The output cannot be written (exit code 4).
    Output(String),
    /// The request was refused (exit code 1), with more fields for the JSON object.
    Refused { message: String, json: Map<String, Value> },
}

impl Failure {
    pub(crate) fn input(path: &Path, error: &ReadError) -> Self {
        Self::Input { message: format!("{}: {error}", path.display()), place: error.place() }
    }

    pub(crate) fn refused(message: impl ToString) -> Self {
        Self::Refused { message: message.to_string(), json: Map::new() }
    }
}

impl From<meshwright::cleanup::CleanError> for Failure {
    fn from(error: meshwright::cleanup::CleanError) -> Self {
        Self::refused(error)
    }
}

/// A part of the run that is timed.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Phase {
    Read,
    Build,
    Run,
    Write,
}

/// The run.
#[derive(Debug)]
pub(crate) struct Session {
    is_json: bool,
    /// Milliseconds by phase.
    spent: [f64; 4],
}

impl Session {
    pub(crate) fn new(is_json: bool) -> Self {
        Self { is_json, spent: [0.0; 4] }
    }

    /// Runs and times a part.
    pub(crate) fn timed<T>(&mut self, phase: Phase, part: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = part();
        self.spent[phase as usize] += start.elapsed().as_secs_f64() * 1e3;
        result
    }

    /// Tells people something on standard error.
    pub(crate) fn say(&self, message: &str) {
        // A closed standard error is no reason to stop.
        let _ = writeln!(std::io::stderr().lock(), "{message}");
    }

    fn common(&self) -> [(&'static str, Value); 2] {
        let [read, build, run, write] = self.spent;
        let timings = json!({ "read": read, "build": build, "run": run, "write": write });
        [("timings_ms", timings), ("peak_rss_bytes", json!(peak_rss()))]
    }

    /// The JSON object of an answer in one line, as `--report` writes it too.
    pub(crate) fn object(
        &self,
        mut json: Map<String, Value>,
        list: Option<&(&'static str, String)>,
    ) -> String {
        json.extend(self.common().map(|(k, v)| (k.to_owned(), v)));
        let fields = Value::Object(json).to_string();
        match list {
            // There are fields, so a comma follows.
            Some((name, items)) => format!("{{\"{name}\":{items},{}\n", &fields[1..]),
            None => fields + "\n",
        }
    }

    /// Prints the result and gives the exit code.
    pub(crate) fn finish(&self, result: Result<Answer, Failure>) -> ExitCode {
        let (code, json, list, text) = match result {
            Ok(answer) => (u8::from(answer.is_no), answer.json, answer.list, answer.text),
            Err(failure) => {
                let (code, kind, message, mut json, place) = match failure {
                    Failure::Refused { message, json } => (1, "refused", message, json, None),
                    Failure::Usage(message) => (2, "usage", message, Map::new(), None),
                    Failure::Input { message, place } => (3, "input", message, Map::new(), place),
                    Failure::Output(message) => (4, "output", message, Map::new(), None),
                };
                self.say(&format!("error: {message}"));
                let mut error = json!({ "kind": kind, "message": message });
                match place {
                    Some(Place::Line(n)) => error["line"] = json!(n),
                    Some(Place::Byte(n)) => error["byte"] = json!(n),
                    None => {}
                }
                json.insert("error".to_owned(), error);
                (code, json, None, String::new())
            }
        };
        let printed = if self.is_json { self.object(json, list.as_ref()) } else { text };
        let mut out = std::io::stdout().lock();
        match out.write_all(printed.as_bytes()).and_then(|()| out.flush()) {
            // Nobody reads on: `meshwright ... | head`.
            Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
                self.say(&format!("error: cannot print: {error}"));
                ExitCode::from(4)
            }
            _ => ExitCode::from(code),
        }
    }
}

/// The most memory this process has held, in bytes; 0 where the system does not tell.
fn peak_rss() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.and_then(|l| l.trim().trim_end_matches(" kB").parse::<u64>().ok()).map_or(0, |kib| kib * 1024)
}
