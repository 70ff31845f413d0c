//! Runs long work for a panel on a thread of its own that leaves the processors to the sandbox: after every stretch of work
//! it rests twice as long.

use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::sentence::sentence;
use super::ui::work::{JobRequest, PanelJob, Work};
use crate::session::background::BackgroundError;
use crate::session::progress::Progress;

/// The shortest time of work between two rests.
const MIN_WORK_TIME: Duration = Duration::from_millis(4);
/// A rest is this many times as long as the stretch of work before it, and is taken in naps no longer than [`MAX_NAP`], so
/// that a cancelled job ends soon.
const REST_RATIO: u32 = 2;
const MAX_NAP: Duration = Duration::from_millis(50);

/// The work in progress, if any.
#[derive(Debug)]
pub(super) struct BackgroundJob<T> {
    running: Option<Running<T>>,
}

#[derive(Debug)]
struct Running<T> {
    progress: Arc<Progress>,
    outcome: Receiver<Result<T, BackgroundError>>,
}

impl<T> Drop for Running<T> {
    fn drop(&mut self) {
        self.progress.cancel();
    }
}

impl<T> Default for BackgroundJob<T> {
    fn default() -> Self {
        Self { running: None }
    }
}

/// What a job reports to while it works: its progress, and a pause that leaves the processors to others.
pub(super) struct JobControl<'a> {
    /// Takes the job's progress and says whether the job is still wanted.
    pub(super) progress: &'a Progress,
    /// Called by the job between two pieces of work; may rest.
    pub(super) pause: &'a (dyn Fn() + Sync),
}

impl<T: Send + 'static> BackgroundJob<T> {
    /// Handles the panel's request: begins `work`, if there is anything to work on, or stops it. `wake` is called when the
    /// work ends.
    pub(super) fn handle_request<W>(
        &mut self,
        panel_job: &mut PanelJob<T>,
        work: impl FnOnce() -> Option<W>,
        wake: impl FnOnce() + Send + 'static,
    ) where
        W: FnOnce(JobControl<'_>) -> Result<T, BackgroundError> + Send + 'static,
    {
        let Some(request) = panel_job.request.take() else { return };
        // Work begun earlier is no longer wanted.
        (self.running, panel_job.work) = (None, Work::Idle);
        if let Some(work) = (request == JobRequest::Begin).then(work).flatten() {
            let running = start(work, wake);
            panel_job.work = Work::Running(Arc::clone(&running.progress));
            self.running = Some(running);
        }
    }

    /// Tells the panel the outcome of the work, if it has ended.
    pub(super) fn answer(&mut self, panel_job: &mut PanelJob<T>) {
        let Some(running) = &self.running else { return };
        panel_job.work = match running.outcome.try_recv() {
            Err(TryRecvError::Empty) => return,
            Ok(Ok(result)) => Work::Ready(Box::new(result)),
            Ok(Err(BackgroundError::Cancelled)) => Work::Idle,
            Ok(Err(error)) => Work::Failed(sentence(&error)),
            Err(TryRecvError::Disconnected) => Work::Failed("an error in the program ended the work".to_owned()),
        };
        self.running = None;
    }
}

fn start<T: Send + 'static>(
    work: impl FnOnce(JobControl<'_>) -> Result<T, BackgroundError> + Send + 'static,
    wake: impl FnOnce() + Send + 'static,
) -> Running<T> {
    let (send, outcome) = channel();
    let progress = Arc::new(Progress::default());
    let watched = Arc::clone(&progress);
    std::thread::spawn(move || {
        let throttle = Throttle::new();
        let pause = || throttle.rest_if_due(&watched);
        if send.send(work(JobControl { progress: &watched, pause: &pause })).is_err() {
            log::debug!("nobody waits for the work any more");
        }
        wake();
    });
    Running { progress, outcome }
}

/// Decides when work rests.
struct Throttle {
    /// The end of the last rest.
    last_rest_end: Mutex<Instant>,
}

impl Throttle {
    fn new() -> Self {
        Self { last_rest_end: Mutex::new(Instant::now()) }
    }

    /// Rests if a rest is due, but not longer than the work is wanted.
    fn rest_if_due(&self, work: &Progress) {
        let mut last_rest_end = self.last_rest_end.lock().unwrap_or_else(PoisonError::into_inner);
        let worked = last_rest_end.elapsed();
        if worked >= MIN_WORK_TIME {
            let mut left = worked * REST_RATIO;
            while !left.is_zero() && !work.is_cancelled() {
                let nap = left.min(MAX_NAP);
                std::thread::sleep(nap);
                left -= nap;
            }
            *last_rest_end = Instant::now();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::mpsc::channel;

    use super::*;
    use crate::scene::body::CubeShape;
    use crate::scene::{Scene, Shape, presets};
    use crate::session::error_curve::{ErrorCurve, error_curve};

    /// The longest time that cancelled work may take to stop.
    const SOON: Duration = Duration::from_millis(200);

    fn scene(cells: u32) -> Scene {
        let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
        scene.bodies[0].shape = Shape::Cube(CubeShape { cells, size: 1.0 });
        scene
    }

    fn curve(scene: Scene) -> impl FnOnce(JobControl<'_>) -> Result<ErrorCurve, BackgroundError> + Send + 'static {
        move |beside| error_curve(&scene, Path::new(""), beside.progress, beside.pause)
    }

    fn wanted() -> PanelJob<ErrorCurve> {
        PanelJob { request: Some(JobRequest::Begin), ..PanelJob::default() }
    }

    #[test]
    fn what_is_wished_for_is_computed_and_answered() {
        let (mut job, mut panel) = (BackgroundJob::default(), wanted());
        let (send, woken) = channel();
        let scene = scene(1);
        job.handle_request(&mut panel, || Some(curve(scene.clone())), move || send.send(()).expect("the test waits"));
        assert!(matches!(panel.work, Work::Running(_)), "{:?}", panel.work);
        woken.recv_timeout(Duration::from_mins(2)).expect("it ends");
        job.answer(&mut panel);
        let Work::Ready(curve) = &panel.work else { panic!("{:?}", panel.work) };
        assert!(curve.is_of(&scene), "of that scene");
    }

    #[test]
    fn what_is_stopped_ends_within_a_fifth_of_a_second() {
        for cells in [1, 16] {
            let (mut job, mut panel) = (BackgroundJob::default(), wanted());
            let (send, woken) = channel();
            job.handle_request(
                &mut panel,
                || Some(curve(scene(cells))),
                move || send.send(()).expect("the test waits"),
            );
            std::thread::sleep(Duration::from_millis(300));
            panel.request = Some(JobRequest::Stop);
            let begin = Instant::now();
            job.handle_request(&mut panel, || Some(curve(scene(1))), || ());
            assert!(matches!(panel.work, Work::Idle), "{:?}", panel.work);
            woken.recv_timeout(Duration::from_secs(10)).expect("the thread ends");
            assert!(begin.elapsed() < SOON, "{cells} cells: after {:?}", begin.elapsed());
        }
    }

    #[test]
    fn work_rests_twice_as_long_as_it_lasts() {
        let (throttle, work) = (Throttle::new(), Progress::default());
        let begin = Instant::now();
        let mut worked = Duration::ZERO;
        while begin.elapsed() < Duration::from_millis(300) {
            let piece = Instant::now();
            while piece.elapsed() < Duration::from_millis(1) {
                std::hint::spin_loop();
            }
            worked += piece.elapsed();
            throttle.rest_if_due(&work);
        }
        let share = worked.as_secs_f64() / begin.elapsed().as_secs_f64();
        assert!(share < 0.45, "it works {share} of the time");
    }

    #[test]
    fn a_long_rest_ends_with_the_wish() {
        let (throttle, work) = (Throttle::new(), Progress::default());
        std::thread::sleep(Duration::from_millis(300));
        work.cancel();
        let begin = Instant::now();
        throttle.rest_if_due(&work);
        assert!(begin.elapsed() < SOON, "{:?}", begin.elapsed());
    }
}
