//! One run: what was asked for, how long each part took, and how it ends.

use meshwright::io::{Place, ReadError};
use serde::Serialize;
use serde_json::json;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

/// What a command answers.
#[derive(Debug, Default)]
pub(crate) struct Answer {
    /// The fields of the JSON object.
    pub(crate) json: Fields,
    /// The same for people, on standard output.
    pub(crate) text: String,
    /// Whether the answer is "no" (exit code 1).
    pub(crate) is_no: bool,
}

/// The fields of a JSON object, in JSON already: in a tree of values, a million records would take gigabytes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fields {
    /// What stands between the braces.
    text: Vec<u8>,
    /// Nobody asked for JSON: keeps nothing.
    is_unwanted: bool,
}

impl Fields {
    /// The same with one more field.
    pub(crate) fn with(self, name: &str, value: &impl Serialize) -> Self {
        if self.is_unwanted { self } else { self.named(name, |text| put(text, value)) }
    }

    /// The same with an object as one more field.
    pub(crate) fn with_object(self, name: &str, object: &Self) -> Self {
        let braced = |text: &mut Vec<u8>| {
            text.push(b'{');
            text.extend_from_slice(&object.text);
            text.push(b'}');
        };
        if self.is_unwanted { self } else { self.named(name, braced) }
    }

    /// The same with all fields of something that is an object in JSON.
    pub(crate) fn with_all(mut self, value: &impl Serialize) -> Self {
        if !self.is_unwanted {
            self.separate();
            let from = self.text.len();
            put(&mut self.text, value);
            if self.text.get(from) == Some(&b'{') {
                self.text.remove(from);
                self.text.pop();
            }
        }
        self
    }

    fn named(mut self, name: &str, write: impl FnOnce(&mut Vec<u8>)) -> Self {
        self.separate();
        self.text.extend_from_slice(format!("\"{name}\":").as_bytes());
        write(&mut self.text);
        self
    }

    fn separate(&mut self) {
        if !self.text.is_empty() {
            self.text.push(b',');
        }
    }
}

fn put(text: &mut Vec<u8>, value: &impl Serialize) {
    let from = text.len();
    if serde_json::to_writer(&mut *text, value).is_err() {
        // Fails for maps whose keys are no text, and there are none.
        text.truncate(from);
        text.extend_from_slice(b"null");
    }
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
    Refused { message: String, json: Fields },
}

impl Failure {
    pub(crate) fn input(path: &Path, error: &ReadError) -> Self {
        Self::Input { message: format!("{}: {error}", path.display()), place: error.place() }
    }

    pub(crate) fn refused(message: impl ToString) -> Self {
        Self::Refused { message: message.to_string(), json: Fields::default() }
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

    /// No fields yet; what is added is kept if it is to be printed or, as `also` says, wanted for something else.
    pub(crate) fn fields(&self, also: bool) -> Fields {
        Fields { text: Vec::new(), is_unwanted: !self.is_json && !also }
    }

    /// Writes the JSON object of an answer in one line, as `--report` has it too.
    pub(crate) fn write_object(&self, json: &Fields, sink: &mut impl Write) -> std::io::Result<()> {
        let [read, build, run, write] = self.spent;
        let timings = json!({ "read": read, "build": build, "run": run, "write": write });
        let last = Fields::default().with("timings_ms", &timings).with("peak_rss_bytes", &peak_rss());
        sink.write_all(b"{")?;
        // Written as it is: a million records are not copied.
        sink.write_all(&json.text)?;
        sink.write_all(if json.text.is_empty() { b"" } else { b"," })?;
        sink.write_all(&last.text)?;
        sink.write_all(b"}\n")
    }

    /// Prints the result and gives the exit code.
    pub(crate) fn finish(&self, result: Result<Answer, Failure>) -> ExitCode {
        let (code, json, text) = match result {
            Ok(answer) => (u8::from(answer.is_no), answer.json, answer.text),
            Err(failure) => {
                let (code, kind, message, json, place) = match failure {
                    Failure::Refused { message, json } => (1, "refused", message, json, None),
                    Failure::Usage(message) => (2, "usage", message, Fields::default(), None),
                    Failure::Input { message, place } => (3, "input", message, Fields::default(), place),
                    Failure::Output(message) => (4, "output", message, Fields::default(), None),
                };
                self.say(&format!("error: {message}"));
                let mut error = json!({ "kind": kind, "message": message });
                match place {
                    Some(Place::Line(n)) => error["line"] = json!(n),
                    Some(Place::Byte(n)) => error["byte"] = json!(n),
                    None => {}
                }
                (code, json.with("error", &error), String::new())
            }
        };
        let mut out = std::io::stdout().lock();
        let printed =
            if self.is_json { self.write_object(&json, &mut out) } else { out.write_all(text.as_bytes()) };
        match printed.and_then(|()| out.flush()) {
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
