//! The error curve of a scene, computed on a thread of its own that leaves the processors to the sandbox: after every
//! stretch of work it rests for twice as long.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::ui::error_panel::{ErrorPanel, Wish, Work};
use super::worker::sentence;
use crate::scene::Scene;
use crate::session::error_curve::{ErrorCurve, ErrorCurveError, error_curve};
use crate::session::jellify::Progress;

/// Work between two rests.
const STRETCH: Duration = Duration::from_millis(4);
/// A rest over the stretch of work before it.
const REST: u32 = 2;

/// The work that goes on, if any.
#[derive(Debug, Default)]
pub(super) struct ErrorJob {
    running: Option<Running>,
}

#[derive(Debug)]
struct Running {
    progress: Arc<Progress>,
    outcome: Receiver<Result<ErrorCurve, ErrorCurveError>>,
}

impl Drop for Running {
    fn drop(&mut self) {
        self.progress.cancel();
    }
}

impl ErrorJob {
    /// Does what the panel wishes on the scene that is open. `wake` is called when the work ends.
    pub(super) fn grant(
        &mut self,
        panel: &mut ErrorPanel,
        open: Option<(&Scene, &Path)>,
        wake: impl FnOnce() + Send + 'static,
    ) {
        match (panel.wish.take(), open) {
            (Some(Wish::Begin), Some((scene, base_dir))) => {
                let running = start(scene.clone(), base_dir.to_owned(), wake);
                panel.work = Work::Running(Arc::clone(&running.progress));
                self.running = Some(running);
            }
            (Some(_), _) => {
                (self.running, panel.work) = (None, Work::Idle);
            }
            (None, _) => {}
        }
    }

    /// Tells the panel what has become of the work.
    pub(super) fn answer(&mut self, panel: &mut ErrorPanel) {
        let Some(running) = &self.running else { return };
        panel.work = match running.outcome.try_recv() {
            Err(TryRecvError::Empty) => return,
            Ok(Ok(curve)) => Work::Ready(Box::new(curve)),
            Ok(Err(ErrorCurveError::Cancelled)) => Work::Idle,
            Ok(Err(error)) => Work::Failed(sentence(&error)),
            Err(TryRecvError::Disconnected) => Work::Failed("an error in the program ended the work".to_owned()),
        };
        self.running = None;
    }
}

fn start(scene: Scene, base_dir: PathBuf, wake: impl FnOnce() + Send + 'static) -> Running {
    let (send, outcome) = channel();
    let progress = Arc::new(Progress::default());
    let watched = Arc::clone(&progress);
    std::thread::spawn(move || {
        let rests = Rests::new();
        if send.send(error_curve(&scene, &base_dir, &watched, &|| rests.rest())).is_err() {
            log::debug!("nobody waits for the error curve any more");
        }
        wake();
    });
    Running { progress, outcome }
}

/// Makes work rest.
struct Rests {
    /// The end of the last one.
    since: Mutex<Instant>,
}

impl Rests {
    fn new() -> Self {
        Self { since: Mutex::new(Instant::now()) }
    }

    /// Rests where that is due.
    fn rest(&self) {
        let mut since = self.since.lock().unwrap_or_else(PoisonError::into_inner);
        let worked = since.elapsed();
        if worked >= STRETCH {
            std::thread::sleep(worked * REST);
            *since = Instant::now();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;
    use crate::scene::Shape;
    use crate::scene::body::CubeShape;
    use crate::scene::presets;

    fn scene(cells: u32) -> Scene {
        let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
        scene.bodies[0].shape = Shape::Cube(CubeShape { cells, size: 1.0 });
        scene
    }

    #[test]
    fn what_is_wished_for_is_computed_and_answered() {
        let (mut job, mut panel) =
            (ErrorJob::default(), ErrorPanel { wish: Some(Wish::Begin), ..ErrorPanel::default() });
        let (send, woken) = channel();
        let scene = scene(1);
        job.grant(&mut panel, Some((&scene, Path::new(""))), move || send.send(()).expect("the test waits"));
        assert!(matches!(panel.work, Work::Running(_)), "{:?}", panel.work);
        woken.recv_timeout(Duration::from_mins(2)).expect("it ends");
        job.answer(&mut panel);
        let Work::Ready(curve) = &panel.work else { panic!("{:?}", panel.work) };
        assert!(curve.is_of(&scene), "of that scene");
    }

    #[test]
    fn what_is_stopped_ends_soon() {
        let (mut job, mut panel) =
            (ErrorJob::default(), ErrorPanel { wish: Some(Wish::Begin), ..ErrorPanel::default() });
        let (send, woken) = channel();
        job.grant(&mut panel, Some((&scene(12), Path::new(""))), move || send.send(()).expect("the test waits"));
        panel.wish = Some(Wish::Stop);
        job.grant(&mut panel, None, || ());
        assert!(matches!(panel.work, Work::Idle), "{:?}", panel.work);
        woken.recv_timeout(Duration::from_secs(10)).expect("the thread ends at its next step");
    }

    #[test]
    fn work_rests_twice_as_long_as_it_lasts() {
        let rests = Rests::new();
        let begin = Instant::now();
        let mut worked = Duration::ZERO;
        while begin.elapsed() < Duration::from_millis(300) {
            let piece = Instant::now();
            while piece.elapsed() < Duration::from_millis(1) {
                std::hint::spin_loop();
            }
            worked += piece.elapsed();
            rests.rest();
        }
        let share = worked.as_secs_f64() / begin.elapsed().as_secs_f64();
        assert!(share < 0.45, "it works {share} of the time");
    }
}
