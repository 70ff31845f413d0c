//! The window's own use of the processors, beside the simulation. It is measured as processor time, not as wall time.

use std::time::Duration;

use cpu_time::ProcessTime;

/// Counts the window's processor time from frame to frame.
#[derive(Debug)]
pub(super) struct ProcessorMeter {
    count: u32,
    /// The processor time that the window had used at the last call.
    used_before: Duration,
}

impl ProcessorMeter {
    /// Counts from now on.
    pub(super) fn new() -> Self {
        let count = std::thread::available_parallelism().map_or(1, |count| u32::try_from(count.get()).unwrap_or(1));
        Self { count, used_before: ProcessTime::now().as_duration() }
    }

    /// Returns the time that the window has used since the last call, as time of all processors at once. `simulation` is the
    /// processor time that the simulation has used so far.
    pub(super) fn used_since_last_call(&mut self, simulation: Duration) -> Duration {
        let used = ProcessTime::now().as_duration().saturating_sub(simulation);
        let since = used.saturating_sub(self.used_before);
        self.used_before = used;
        since / self.count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keeps a processor busy.
    fn work(time: Duration) {
        let begin = cpu_time::ThreadTime::now();
        while begin.elapsed() < time {
            std::hint::black_box((0..1000_u32).map(f64::from).sum::<f64>());
        }
    }

    #[test]
    fn what_the_simulation_takes_is_not_the_windows() {
        let mut meter = ProcessorMeter::new();
        meter.used_since_last_call(Duration::ZERO);
        work(Duration::from_millis(60));
        let simulation = Duration::from_millis(40);
        let mine = meter.used_since_last_call(simulation) * meter.count;
        // Other tests of this process run beside this one, so there is no upper bound to check.
        assert!(mine >= Duration::from_millis(19), "{mine:?} of 60 ms, 40 of them the simulation's");
    }
}
