//! libigl as an oracle, in a child process: it crashes on bad input, and a process per question would take a second.
//!
//! The tests make their own virtual environment under the target directory, from pinned requirements with hashes. Without
//! Python they fail and say so.

#![allow(dead_code, reason = "each test asks what it needs")]

use meshwright::IndexedMesh;
use meshwright::glam::DVec3;
use serde_json::Value;
use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

const REQUIREMENTS: &str = include_str!("requirements.txt");
const SERVER: &str = include_str!("server.py");

/// The child process.
pub(crate) struct Igl {
    child: Child,
    to: Option<ChildStdin>,
    from: BufReader<ChildStdout>,
}

/// What libigl says about a triangle mesh.
pub(crate) struct Opinion {
    facts: Value,
    arrays: HashMap<String, Vec<u8>>,
}

impl Igl {
    /// Starts the child, after making its environment if need be.
    pub(crate) fn start() -> Self {
        let python = environment();
        let mut child = Command::new(&python)
            .args(["-c", SERVER])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap_or_else(|e| panic!("cannot start {}: {e}", python.display()));
        let to = child.stdin.take();
        let from = BufReader::new(child.stdout.take().expect("a pipe"));
        Self { child, to, from }
    }

    /// Asks about a mesh; its polygons must be triangles.
    pub(crate) fn ask(&mut self, mesh: &IndexedMesh) -> Opinion {
        self.ask_about(mesh, &[])
    }

    /// Asks about a mesh and points near it.
    pub(crate) fn ask_about(&mut self, mesh: &IndexedMesh, points: &[DVec3]) -> Opinion {
        self.send(mesh, points, "facts")
    }

    /// Asks for another mesh: `loop1` is one level of `igl.loop`, `upsample2` two of `igl.upsample`, `qslim:100` what
    /// `igl.qslim` makes of it with 100 faces.
    pub(crate) fn ask_for(&mut self, mesh: &IndexedMesh, call: &str) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let opinion = self.call(mesh, call);
        let triangles = opinion.integers("faces");
        let index = |v: i64| u32::try_from(v).expect("an index");
        (
            opinion.points("vertices"),
            triangles.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(index)).collect(),
        )
    }

    /// Asks with a call that the server knows.
    pub(crate) fn call(&mut self, mesh: &IndexedMesh, call: &str) -> Opinion {
        self.send(mesh, &[], call)
    }

    fn send(&mut self, mesh: &IndexedMesh, points: &[DVec3], call: &str) -> Opinion {
        assert!(mesh.polygons().iter().all(|f| f.len() == 3), "libigl takes triangles");
        let sizes = serde_json::json!({
            "vertices": mesh.vertex_count(), "faces": mesh.face_count(), "points": points.len(), "call": call,
        });
        let mut request = format!("{sizes}\n").into_bytes();
        request.extend(mesh.positions().iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes));
        request.extend(mesh.polygons().corners().iter().flat_map(|&c| i64::from(c).to_le_bytes()));
        request.extend(points.iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes));
        let to = self.to.as_mut().expect("a pipe");
        // The child reads a whole request before it answers, so this cannot block both.
        to.write_all(&request).and_then(|()| to.flush()).expect("libigl's process is gone");
        let mut line = String::new();
        self.from.read_line(&mut line).expect("an answer");
        assert!(!line.is_empty(), "libigl's process died on this mesh");
        let facts: Value = serde_json::from_str(&line).expect("an answer in JSON");
        assert!(facts["error"].is_null(), "{facts}");
        let mut arrays = HashMap::new();
        for entry in facts["arrays"].as_array().expect("a list of arrays") {
            let item = entry[1].as_str().and_then(|d| d[2..].parse::<u64>().ok()).expect("a size");
            let count: u64 = entry[2].as_array().expect("a shape").iter().filter_map(Value::as_u64).product();
            let mut bytes = vec![0; (item * count) as usize];
            self.from.read_exact(&mut bytes).expect("an array");
            arrays.insert(entry[0].as_str().expect("a name").to_owned(), bytes);
        }
        Opinion { facts, arrays }
    }
}

impl Drop for Igl {
    fn drop(&mut self) {
        // Closing the pipe ends the child's loop.
        self.to = None;
        let _ = self.child.wait();
    }
}

impl Opinion {
    pub(crate) fn number(&self, name: &str) -> f64 {
        self.facts[name].as_f64().unwrap_or_else(|| panic!("{name}: {}", self.facts))
    }

    pub(crate) fn is(&self, name: &str) -> bool {
        self.facts[name].as_bool().unwrap_or_else(|| panic!("{name}: {}", self.facts))
    }

    pub(crate) fn vector(&self, name: &str) -> [f64; 3] {
        std::array::from_fn(|i| self.facts[name][i].as_f64().expect("a coordinate"))
    }

    pub(crate) fn integers(&self, name: &str) -> Vec<i64> {
        self.arrays[name]
            .chunks_exact(8)
            .map(|b| i64::from_le_bytes(b.try_into().expect("eight bytes")))
            .collect()
    }

    pub(crate) fn numbers(&self, name: &str) -> Vec<f64> {
        self.arrays[name]
            .chunks_exact(8)
            .map(|b| f64::from_le_bytes(b.try_into().expect("eight bytes")))
            .collect()
    }

    pub(crate) fn points(&self, name: &str) -> Vec<DVec3> {
        self.numbers(name).chunks_exact(3).map(DVec3::from_slice).collect()
    }

    pub(crate) fn flags(&self, name: &str) -> Vec<bool> {
        self.arrays[name].iter().map(|&b| b != 0).collect()
    }
}

/// The interpreter of the virtual environment, which is made on first use. Several tests may come at once: a lock lets
/// one make it, and a stamp written last tells that it is whole.
fn environment() -> PathBuf {
    let hash = REQUIREMENTS
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325u64, |h, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
    let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("igl-{hash:016x}"));
    fs::create_dir_all(&root).expect("a directory under target/");
    let lock = File::create(root.join("lock")).expect("a lock file");
    lock.lock().expect("a lock");
    let venv = root.join("venv");
    let python = if cfg!(windows) { venv.join("Scripts/python.exe") } else { venv.join("bin/python") };
    let stamp = root.join("complete");
    if !stamp.exists() {
        let _ = fs::remove_dir_all(&venv);
        let system = std::env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
        run(Command::new(&system).args(["-m", "venv"]).arg(&venv), "Python 3 with its venv module");
        let requirements = root.join("requirements.txt");
        fs::write(&requirements, REQUIREMENTS).expect("a file under target/");
        let pip = [
            "-m",
            "pip",
            "install",
            "--quiet",
            "--no-deps",
            "--only-binary",
            ":all:",
            "--require-hashes",
            "-r",
        ];
        run(
            Command::new(&python).args(pip).arg(&requirements),
            "libigl from the package index (Python 3.10 to 3.13)",
        );
        fs::write(&stamp, "").expect("a file under target/");
    }
    python
}

fn run(command: &mut Command, needs: &str) {
    match command.output() {
        Ok(output) if output.status.success() => {}
        Ok(output) => panic!(
            "the comparison with libigl needs {needs}; {command:?} failed:\n{}{}",
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr)
        ),
        Err(error) => panic!("the comparison with libigl needs {needs}; {command:?}: {error}"),
    }
}
