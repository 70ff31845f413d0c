//! `.ci/setup` on machines without some programs, simulated by stand-ins: what it installs, what it says, and that it is
//! silent if nothing is missing.
#![cfg(target_os = "linux")]

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

/// Programs of the system that the script uses as they are.
const REAL: [&str; 10] = ["bash", "cat", "cut", "dirname", "env", "grep", "head", "mv", "sed", "sort"];
/// Stand-ins: every package is installed, the person is root, apt notes what it is asked for and brings rustup.
const SYSTEM: [(&str, &str); 4] = [
    ("dpkg-query", "echo ii"),
    ("id", "echo 0"),
    ("apt-cache", "echo '  Candidate: 1.27.1-1'"),
    ("apt-get", "echo \"apt-get $*\" >>log; case \"$*\" in *rustup*) mv bin/rustup-to-come bin/rustup;; esac"),
];
const RUSTUP: &str = "case \"$2\" in list) cat toolchains;; \
    install) echo \"rustup $*\" >>log; echo \"$3-x86_64-unknown-linux-gnu\" >>toolchains;; esac";

/// A checkout on a machine that has only these programs.
struct Machine(TempDir);

impl Machine {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        fs::create_dir_all(at(".ci")).and_then(|()| fs::create_dir(at("bin"))).expect("folders");
        for name in [".ci/setup", "rust-toolchain.toml"] {
            fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join(name), at(name)).expect("a file of the repository");
        }
        fs::write(at("toolchains"), "stable-x86_64-unknown-linux-gnu (default)\n").expect("a file");
        fs::write(at("log"), "").expect("a file");
        for name in REAL {
            let real = ["/usr/bin", "/bin"].map(|folder| Path::new(folder).join(name));
            let real = real.iter().find(|path| path.exists()).unwrap_or_else(|| panic!("there is no {name}"));
            symlink(real, at("bin").join(name)).expect("a link");
        }
        SYSTEM.into_iter().fold(Self(folder), |machine, (name, body)| machine.with(name, body))
    }

    /// The machine with one more program, or another one of that name.
    fn with(self, name: &str, body: &str) -> Self {
        let path = self.0.path().join("bin").join(name);
        fs::write(&path, format!("#!/usr/bin/env bash\n{body}\n")).expect("a program");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).expect("it may run");
        self
    }

    fn without(self, name: &str) -> Self {
        fs::remove_file(self.0.path().join("bin").join(name)).expect("it is there");
        self
    }

    /// Runs the script. Returns whether it succeeded, and its output.
    fn setup(&self) -> (bool, String) {
        let output = Command::new("/bin/bash")
            .arg(".ci/setup")
            .current_dir(self.0.path())
            .env_clear()
            .env("PATH", self.0.path().join("bin"))
            .env("HOME", self.0.path())
            .output()
            .expect("bash runs");
        let said = [output.stdout, output.stderr].concat();
        (output.status.success(), String::from_utf8_lossy(&said).into_owned())
    }

    /// The calls of apt and rustup.
    fn log(&self) -> String {
        fs::read_to_string(self.0.path().join("log")).expect("the log")
    }
}

/// The toolchain that the repository asks for.
fn toolchain() -> String {
    let text = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/rust-toolchain.toml")).expect("the file");
    text.split('"').nth(1).expect("a channel").to_owned()
}

#[test]
fn where_nothing_is_missing_it_does_and_says_nothing() {
    let machine = Machine::new().with("cargo", &format!("echo cargo {} x", toolchain()));
    assert_eq!(machine.setup(), (true, String::new()), "a recent Rust of another origin");
    assert_eq!(machine.log(), "", "nothing was asked for");
}

#[test]
fn without_rust_the_systems_rustup_brings_the_toolchain_once() {
    let machine = Machine::new().with("rustup-to-come", RUSTUP);
    let (done, said) = machine.setup();
    assert!(done, "{said}");
    assert!(said.contains("installing rustup") && said.contains(&toolchain()), "it says what it does: {said}");
    let log = machine.log();
    assert!(log.contains(&format!("rustup toolchain install {}", toolchain())), "{log}");
    assert_eq!(machine.setup(), (true, String::new()), "the second call has nothing to do");
    assert_eq!(machine.log(), log, "and asks for nothing");
}

#[test]
fn a_rustup_without_the_toolchain_fetches_it() {
    let machine = Machine::new().with("rustup", RUSTUP);
    let (done, said) = machine.setup();
    assert!(done && said.contains(&toolchain()), "{said}");
    assert!(!machine.log().contains("apt-get"), "the system is left alone: {}", machine.log());
    let offline = Machine::new().with("rustup", "[ \"$2\" = list ]");
    let (done, said) = offline.setup();
    assert!(!done && said.contains("could not install"), "{said}");
}

#[test]
fn a_system_without_a_package_of_rustup_ends_with_how_to_get_it() {
    let (done, said) = Machine::new().with("apt-cache", "echo '  Candidate: (none)'").setup();
    assert!(!done, "there is no Rust: {said}");
    let last = said.lines().last().expect("a sentence");
    assert!(last.contains("https://rustup.rs") && last.contains(&toolchain()), "{last}");
}

#[test]
fn a_rust_that_is_too_old_or_out_of_sight_is_named() {
    let (done, said) = Machine::new().with("cargo", "echo cargo 1.63.0 x").setup();
    assert!(!done && said.contains("1.63.0 is too old") && said.contains("https://rustup.rs"), "{said}");
    let hidden = Machine::new().with("cargo", "");
    fs::create_dir_all(hidden.0.path().join(".cargo/bin")).expect("a folder");
    fs::rename(hidden.0.path().join("bin/cargo"), hidden.0.path().join(".cargo/bin/cargo")).expect("moved");
    let (done, said) = hidden.setup();
    assert!(!done && said.contains("not on the PATH"), "{said}");
}

#[test]
fn other_systems_and_people_who_may_not_install_are_told_what_is_needed() {
    let (done, said) = Machine::new().without("dpkg-query").setup();
    assert!(!done && said.contains("https://rustup.rs") && said.contains("libvulkan1"), "{said}");
    let (done, said) = Machine::new().with("id", "echo 1000").setup();
    assert!(!done && said.contains("run as root, or install sudo"), "{said}");
}
