//! The threads that steps are taken by: chosen once in a process, and there while someone runs a simulation.

use std::num::NonZero;
use std::thread::available_parallelism;

use crate::physics::{choose_step_threads, step_threads};

/// Lets every simulation of the process from now on take its steps by so many threads, all of the machine's for 0. Says
/// whether they do: not after another choice or a simulation.
pub fn choose_threads(count: usize) -> bool {
    choose_step_threads(if count == 0 { available_parallelism().map_or(1, NonZero::get) } else { count })
}

/// Does some work that takes steps, where the chosen threads are there for them; one thread needs no others.
pub fn within_pool<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    if step_threads() == 1 {
        return work();
    }
    match rayon::ThreadPoolBuilder::new().num_threads(step_threads()).build() {
        Ok(pool) => pool.install(work),
        Err(error) => {
            log::warn!("steps are taken by one thread, as others cannot be started: {error}");
            work()
        }
    }
}
