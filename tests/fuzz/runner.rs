//! Runs cases in child processes under limits. If a child dies, its last case is run again alone.

use std::fs::{self, File};
use std::ops::Range;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use cpu_time::ProcessTime;

use crate::targets::Target;

/// Address space of a child, MiB.
const MEBIBYTES: u64 = 1500;
/// How often the processor time of a child's case is checked.
const LOOK: Duration = Duration::from_millis(100);
/// The longest wait, in wall time, for a child that is waiting itself. A child at work has no such limit: on a busy machine
/// it may get next to no processor time.
const WALL: Duration = Duration::from_mins(5);

/// Environment variables: the task of a child, and the file in which it notes its present case.
const TASK: &str = "GELATIN_FUZZ_TASK";
const PLACE: &str = "GELATIN_FUZZ_PLACE";

/// A case that failed.
#[derive(Clone, Debug)]
#[expect(dead_code, reason = "read in the message of a failed test")]
pub(crate) struct Fault {
    pub(crate) target: Target,
    pub(crate) seed: u64,
    pub(crate) case: u64,
    /// The child's last words, and how it ended.
    pub(crate) how: String,
    /// The file that holds the input.
    pub(crate) input: PathBuf,
}

/// Runs cases of a target and returns those that fail.
pub(crate) fn run(target: Target, seed: u64, cases: Range<u64>) -> Vec<Fault> {
    let folder = tempfile::tempdir().unwrap();
    let mut faults = Vec::new();
    let mut next = cases.start;
    while next < cases.end {
        let (place, ended) = spawn(folder.path(), target, seed, next..cases.end);
        if ended.is_ok() {
            break;
        }
        // The child may have died of earlier cases, so this case is run alone.
        let (_, alone) = spawn(folder.path(), target, seed, place..place + 1);
        if let Err(how) = alone {
            let input = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{target:?}-{seed}-{place}"));
            fs::write(&input, target.input(seed, place)).unwrap();
            faults.push(Fault { target, seed, case: place, how, input });
        }
        next = place + 1;
    }
    faults
}

/// Runs cases in one child. Returns the last case that it began, and how it ended if it failed.
fn spawn(folder: &Path, target: Target, seed: u64, cases: Range<u64>) -> (u64, Result<(), String>) {
    let (place, said) = (folder.join("place"), folder.join("said"));
    fs::write(&place, cases.start.to_le_bytes()).unwrap();
    let limited = format!("ulimit -v {}; ulimit -c 0; exec \"$@\"", MEBIBYTES << 10);
    let child = Command::new("sh")
        .args(["-c", &limited, "sh"])
        .arg(std::env::current_exe().unwrap())
        .args(["child", "--exact", "--ignored", "--nocapture", "--test-threads=1"])
        .env(TASK, format!("{target:?} {seed} {} {}", cases.start, cases.end))
        .env(PLACE, &place)
        // These keep threads from reserving memory that they do not use.
        .env("MALLOC_ARENA_MAX", "2")
        .env("RAYON_NUM_THREADS", "1")
        .env("RUST_BACKTRACE", "0")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(File::create(&said).unwrap())
        .spawn()
        .unwrap();
    let ended = wait(child);
    let at = fs::read(&place).unwrap().try_into().map_or(cases.start, u64::from_le_bytes);
    let said = String::from_utf8_lossy(&fs::read(&said).unwrap()).into_owned();
    let how = match ended {
        Some(status) if status.success() => return (at, Ok(())),
        Some(status) => format!("{status}: {}", said.trim()),
        None => format!("it did not end in {WALL:?}"),
    };
    (at, Err(how))
}

fn wait(mut child: Child) -> Option<ExitStatus> {
    let begin = Instant::now();
    while begin.elapsed() < WALL || is_at_work(child.id()) {
        if let Some(status) = child.try_wait().unwrap() {
            return Some(status);
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    None
}

/// Whether a thread of a process runs or could run: the third field of its `stat`, after its name in brackets.
fn is_at_work(process: u32) -> bool {
    let Ok(threads) = fs::read_dir(format!("/proc/{process}/task")) else { return false };
    threads.flatten().filter_map(|thread| fs::read_to_string(thread.path().join("stat")).ok()).any(|stat| {
        let after_name = stat.rsplit(") ").next().unwrap_or_default();
        after_name.starts_with('R') || after_name.starts_with('D')
    })
}

#[test]
fn a_child_that_waits_is_not_at_work_and_one_that_counts_is() {
    let sleeps = Command::new("sleep").arg("60").spawn().unwrap();
    let counts = Command::new("sh").args(["-c", "while :; do :; done"]).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(200));
    let seen = [&sleeps, &counts].map(|child| is_at_work(child.id()));
    for mut child in [sleeps, counts] {
        child.kill().unwrap();
        child.wait().unwrap();
    }
    assert_eq!(seen, [false, true]);
}

/// The work of a child.
pub(crate) fn child() {
    let task = std::env::var(TASK).expect("it is run by the other tests");
    let words: Vec<&str> = task.split(' ').collect();
    let target = Target::ALL.into_iter().find(|target| format!("{target:?}") == words[0]).expect("a target");
    let [seed, start, end] = [1, 2, 3].map(|word| words[word].parse::<u64>().expect("a number"));
    let place = File::options().write(true).open(std::env::var(PLACE).expect("a place")).expect("it is there");
    let begin = Arc::new(Mutex::new(ProcessTime::now()));
    let (watched, most) = (Arc::clone(&begin), target.processor_time());
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(LOOK);
            let taken = watched.lock().expect("nobody panics with it").elapsed();
            if taken > most {
                eprintln!("a case takes more than {most:?} of processor time");
                std::process::abort();
            }
        }
    });
    for case in start..end {
        place.write_all_at(&case.to_le_bytes(), 0).expect("a few bytes");
        *begin.lock().expect("nobody panics with it") = ProcessTime::now();
        target.try_input(&target.input(seed, case));
        target.try_case(case);
    }
}
