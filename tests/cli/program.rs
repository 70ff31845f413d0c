//! Runs the program in a folder of its own.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// A folder to run the program in.
pub(crate) struct Folder(TempDir);

/// The results of a run.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) code: Option<i32>,
    pub(crate) figures: String,
    pub(crate) notes: String,
}

/// The limits of a run.
#[cfg(target_os = "linux")]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Address space, MiB.
    pub(crate) mebibytes: u64,
    /// Processor time, s.
    pub(crate) secs: u64,
}

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> &Self {
        fs::write(self.path(name), bytes).expect("a file");
        self
    }

    /// Runs the program there, with the words of `line` as arguments and without a display.
    pub(crate) fn run(&self, line: &str) -> Ran {
        self.run_with(line, &[])
    }

    /// As [`Folder::run`], with more variables in its environment.
    pub(crate) fn run_with(&self, line: &str, environment: &[(&str, &str)]) -> Ran {
        self.ran(Command::new(env!("CARGO_BIN_EXE_gelatin")).envs(environment.iter().copied()), line)
    }

    /// As [`Folder::run`], within limits of memory and processor time. A run that exceeds them dies and has no exit code.
    #[cfg(target_os = "linux")]
    pub(crate) fn run_within(&self, limits: Limits, line: &str) -> Ran {
        let limited = format!("ulimit -v {}; ulimit -t {}; exec \"$@\"", limits.mebibytes << 10, limits.secs);
        self.ran(Command::new("sh").args(["-c", &limited, "sh", env!("CARGO_BIN_EXE_gelatin")]), line)
    }

    fn ran(&self, command: &mut Command, line: &str) -> Ran {
        let output = command
            .args(line.split_whitespace())
            .current_dir(self.0.path())
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("XDG_RUNTIME_DIR")
            .stdin(Stdio::null())
            .output()
            .expect("the program starts");
        Ran {
            code: output.status.code(),
            figures: String::from_utf8_lossy(&output.stdout).into_owned(),
            notes: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    /// Interrupts the program as soon as it has kept a number of pieces in a file, and returns that file.
    pub(crate) fn interrupted(&self, line: &str, kept: &str, pieces: usize) -> String {
        let mut program = Command::new(env!("CARGO_BIN_EXE_gelatin"))
            .args(line.split_whitespace())
            .current_dir(self.0.path())
            .stdout(Stdio::null())
            .spawn()
            .expect("the program starts");
        let kept = || fs::read_to_string(self.path(kept)).unwrap_or_default();
        let until = Instant::now() + Duration::from_mins(2);
        // The first line names the measurement. A line without its end is still being written.
        while kept().matches('\n').count() < 1 + pieces {
            assert!(program.try_wait().expect("it can be asked").is_none(), "it ended before it was interrupted");
            assert!(Instant::now() < until, "the first pieces take too long");
            std::thread::sleep(Duration::from_millis(2));
        }
        program.kill().expect("it is interrupted");
        program.wait().expect("it ends");
        kept()
    }

    /// Runs the program, which must succeed with one JSON object.
    pub(crate) fn json(&self, line: &str) -> serde_json::Value {
        let ran = self.run(line);
        assert_eq!(ran.code, Some(0), "gelatin {line}: {ran:?}");
        serde_json::from_str(&ran.figures).unwrap_or_else(|error| panic!("gelatin {line}: {error}: {}", ran.figures))
    }
}

/// A square of two triangles, with a scale and a place for its corners.
pub(crate) fn square(scale: f64, offset: f64) -> String {
    let at = |x: f64| offset + scale * x;
    let vertex = |x: f64, z: f64| format!("v {:e} {:e} {:e}", at(x), at(0.0), at(z));
    let corners = [vertex(0.0, 0.0), vertex(1.0, 0.0), vertex(1.0, 1.0), vertex(0.0, 1.0)];
    corners.join("\n") + "\nf 1 2 3 4\n"
}
