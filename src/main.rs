//! The `gelatin` program: the command line of [`gelatin::cli`], nothing more.

use std::process::ExitCode;

fn main() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("error")).init();
    gelatin::cli::run(std::env::args_os())
}
