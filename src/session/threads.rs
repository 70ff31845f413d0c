//! The threads that steps are taken by: chosen once in a process, and there while someone runs a simulation.

use std::num::NonZero;
use std::thread::available_parallelism;
use std::time::Duration;

use cpu_time::ThreadTime;

use crate::physics::{choose_step_threads, step_threads};

/// Threads of a window that work beside the steps: its own and that of its driver.
const BESIDE_STEPS: usize = 2;

/// Lets every simulation of the process from now on take its steps by so many threads, all of the machine's for 0. Says
/// whether they do: not after another choice or a simulation.
pub fn choose_threads(count: usize) -> bool {
    choose_step_threads(if count == 0 { available_parallelism().map_or(1, NonZero::get) } else { count })
}

/// The same where a window is drawn beside the steps: of all of the machine's, for 0, two are left to it and its driver.
pub fn choose_threads_beside_window(count: usize) -> bool {
    let all = available_parallelism().map_or(1, NonZero::get);
    choose_step_threads(if count == 0 { all.saturating_sub(BESIDE_STEPS) } else { count })
}

/// Processor time that the threads of the pool this is asked in have taken, or this thread where it is of none.
pub fn spent() -> Duration {
    let own = || ThreadTime::now().as_duration();
    if rayon::current_thread_index().is_none() { own() } else { rayon::broadcast(|_| own()).into_iter().sum() }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Keeps a processor busy.
    fn work(time: Duration) {
        let begin = ThreadTime::now();
        while begin.elapsed() < time {
            std::hint::spin_loop();
        }
    }

    #[test]
    fn the_time_of_all_threads_of_a_pool_counts() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("a pool");
        let busy = Duration::from_millis(20);
        let [before, after] = pool.install(|| {
            let before = spent();
            rayon::join(|| work(busy), || work(busy));
            [before, spent()]
        });
        assert!(after >= before + 2 * busy, "{before:?} and then {after:?} of two threads");
        let before = spent();
        work(busy);
        assert!(spent() >= before + busy, "of this thread alone");
    }
}
