//! Runs the built program, and makes the files that it is given.

#![allow(dead_code, reason = "each test file uses its own part of this")]

use std::ffi::OsStr;
use std::fmt;
use std::fs;
use std::io::{Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Far beyond what any call takes on a busy machine: what is still running then hangs.
const LIMIT: Duration = Duration::from_secs(300);

/// What the program did.
pub(crate) struct Outcome {
    /// The exit code; `None` when a signal ended it.
    pub(crate) code: Option<i32>,
    /// Standard output.
    pub(crate) out: String,
    /// Standard error, without what drivers write there.
    pub(crate) err: String,
}

impl fmt::Debug for Outcome {
    /// Of long texts the beginning: they stand in the message of a failed test.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [out, err] = [&self.out, &self.err].map(|text| text.chars().take(3000).collect::<String>());
        write!(formatter, "exit code {:?}\nstandard error: {err}\nstandard output: {out}", self.code)
    }
}

impl Outcome {
    /// Demands that it succeeded.
    #[track_caller]
    pub(crate) fn success(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:?}");
        self
    }

    /// Demands that it failed with this code and one line on standard error, and nothing on standard output.
    #[track_caller]
    pub(crate) fn failure(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{self:?}");
        assert_eq!(self.err.lines().count(), 1, "{self:?}");
        assert!(self.err.starts_with("ropewalk: ") && !self.err.contains("internal error"), "{self:?}");
        assert_eq!(self.out, "", "{self:?}");
        self
    }

    /// Demands that standard error mentions this.
    #[track_caller]
    pub(crate) fn mentions(self, what: &str) -> Self {
        assert!(self.err.contains(what), "'{what}' is not mentioned: {self:?}");
        self
    }

    /// Standard output as one JSON document.
    #[track_caller]
    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }
}

/// Runs the program to its end, within a time limit.
#[track_caller]
pub(crate) fn ropewalk<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Outcome {
    let (mut out, mut err) = (tempfile::tempfile().unwrap(), tempfile::tempfile().unwrap());
    let mut child = Command::new(env!("CARGO_BIN_EXE_ropewalk"))
        .args(arguments)
        // Mesa complains where it is missing.
        .env("XDG_RUNTIME_DIR", std::env::temp_dir())
        .stdin(Stdio::null())
        .stdout(out.try_clone().unwrap())
        .stderr(err.try_clone().unwrap())
        .spawn()
        .unwrap();
    let start = Instant::now();
    let code = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status.code();
        }
        if start.elapsed() > LIMIT {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("it was still running after {LIMIT:?}");
        }
        std::thread::sleep(Duration::from_millis(3));
    };
    let text = |file: &mut fs::File| {
        let mut text = String::new();
        file.rewind().unwrap();
        file.read_to_string(&mut text).unwrap();
        text
    };
    let err = text(&mut err);
    let ours = err.lines().filter(|line| !line.contains("XDG_RUNTIME_DIR"));
    Outcome { code, out: text(&mut out), err: ours.map(|line| format!("{line}\n")).collect() }
}

/// A line of words as arguments; blanks part them.
#[track_caller]
pub(crate) fn run(line: &str) -> Outcome {
    ropewalk(line.split_whitespace())
}

/// A folder that is removed in the end.
pub(crate) struct Folder(tempfile::TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The path as text, for a command line. Temporary folders have no blanks in their names.
    pub(crate) fn text(&self, name: &str) -> String {
        self.path(name).to_str().unwrap().to_owned()
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        fs::write(self.path(name), content).unwrap();
        self.text(name)
    }

    /// A triangle across the z axis at z = 0, and one behind it at z = -1.
    pub(crate) fn two_triangles(&self) -> String {
        let text = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nv -1 -1 -1\nv 1 -1 -1\nv 0 1 -1\nf 1 2 3\nf 4 5 6\n";
        self.write("two.obj", text)
    }

    /// Rays as float32, of so many columns.
    pub(crate) fn rays(&self, name: &str, columns: usize, numbers: &[f32]) -> String {
        let shape = [numbers.len() / columns, columns];
        let body: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        self.npy(name, "<f4", &shape, &body)
    }

    /// An array with this type, shape and content, whether they fit or not.
    pub(crate) fn npy(&self, name: &str, descr: &str, shape: &[usize], body: &[u8]) -> String {
        let shape: String = shape.iter().map(|length| format!("{length}, ")).collect();
        let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({shape})}}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(body);
        self.write(name, bytes)
    }

    /// The names of all files in it.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().to_str().unwrap().to_owned()).collect();
        names.sort();
        names
    }
}

/// An array of an `.npz` file, read by another reader than ours could be.
#[track_caller]
pub(crate) fn array<T: npyz::Deserialize>(path: &Path, name: &str) -> (Vec<u64>, Vec<T>) {
    let mut archive = zip::ZipArchive::new(fs::File::open(path).unwrap()).unwrap();
    let file = npyz::NpyFile::new(archive.by_name(&format!("{name}.npy")).unwrap()).unwrap();
    (file.shape().to_vec(), file.into_vec().unwrap())
}

/// The scenes that are kept beside the repository, or `None` where they are not; the test then says so.
pub(crate) fn scenes() -> Option<PathBuf> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes"));
    if path.is_dir() {
        return Some(path.into());
    }
    println!("skipped: there are no scenes at {}", path.display());
    None
}

/// Whether there is an adapter; where CI is set, one is demanded.
pub(crate) fn has_adapter() -> bool {
    let there = !run("list --json").success().json()["adapters"].as_array().unwrap().is_empty();
    assert!(there || std::env::var_os("CI").is_none(), "CI is set and there is no graphics adapter");
    if !there {
        println!("skipped: there is no graphics adapter");
    }
    there
}
