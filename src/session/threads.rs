//! The threads that take the steps: their number is chosen once in a process, and they exist while a simulation runs.

use std::num::NonZero;
use std::thread::available_parallelism;
use std::time::Duration;

use cpu_time::ThreadTime;

use crate::physics::{choose_step_threads, step_threads};

/// Threads of a window that work beside the steps: its own and that of its driver.
const WINDOW_THREADS: usize = 2;

/// Makes every simulation of the process take its steps with this many threads, 0 for all of the machine's. Returns whether
/// they do: not after another choice or a simulation.
pub fn choose_threads(count: usize) -> bool {
    choose_step_threads(if count == 0 { available_parallelism().map_or(1, NonZero::get) } else { count })
}

/// The same for a window drawn beside the steps: for 0, two of the machine's threads are left to the window and its driver.
pub fn choose_threads_beside_window(count: usize) -> bool {
    let all = available_parallelism().map_or(1, NonZero::get);
    choose_step_threads(if count == 0 { all.saturating_sub(WINDOW_THREADS) } else { count })
}

/// Returns the processor time of all threads of the current pool, or of this thread where it is in none.
pub fn spent() -> Duration {
    let own = || ThreadTime::now().as_duration();
    if rayon::current_thread_index().is_none() { own() } else { rayon::broadcast(|_| own()).into_iter().sum() }
}

/// Does some work that takes steps, in a pool of the chosen threads; one thread needs no pool.
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
