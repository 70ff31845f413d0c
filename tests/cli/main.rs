//! The built program, run as a person runs it: what it prints, what it refuses, with which exit code.

mod bad_input;
mod errors;
mod exploding;
mod figures;
mod formats;
mod killed;
#[cfg(target_os = "linux")]
mod limits;
mod modes;
mod peers;
mod program;
mod readme;
mod report;
mod shards;
mod speed;
mod stability;
mod sweep;
