//! The modes of a body to look at: found beside the sandbox, and swung in its picture while time stands still.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use super::background::{BackgroundError, Paced};
use super::document::Opened;
use super::progress::Progress;
use super::{Session, SessionError};
use crate::geometry::Watch;
use crate::geometry::watch::CancelOnly;
use crate::machine::free_memory;
use crate::math::rotation;
use crate::modal::{self, ModalError, Modes, Wanted};
use crate::physics::Simulation;
use crate::scene::edit::BodyId;
use crate::scene::{Body, Scene};

/// Modes that a person looks at.
pub const COUNT: usize = 20;

/// The most swings in a second of a picture: an eye does not follow more.
const MOST_HZ: f64 = 2.0;

/// The modes of a body of a scene.
#[derive(Clone, Debug)]
pub struct BodyModes {
    /// The body.
    pub body: BodyId,
    /// The lowest of its modes.
    pub modes: Modes,
    /// What they are of.
    described: Body,
}

/// What is shown of a body's modes.
#[derive(Clone, Debug)]
pub struct Swing {
    /// The modes.
    pub of: Arc<BodyModes>,
    /// Of every mode, how far it moves the particle that it moves farthest, as a share of the body's size.
    pub amplitudes: Vec<f64>,
    /// The mode that swings; the others stay as they are.
    pub played: Option<usize>,
}

impl PartialEq for Swing {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.of, &other.of) && (&self.amplitudes, self.played) == (&other.amplitudes, other.played)
    }
}

/// A swing and how long it has been going on.
#[derive(Clone, Debug)]
pub(super) struct Swinging {
    pub(super) swing: Swing,
    secs: f64,
}

/// Finds the modes of a body of a scene. Relative model paths start at `base_dir`; `pause` is called now and then.
pub fn body_modes(
    scene: &Scene,
    base_dir: &Path,
    body: BodyId,
    progress: &Progress,
    pause: &(dyn Fn() + Sync),
) -> Result<BodyModes, BackgroundError> {
    let Some(described) = scene.bodies.get(body.0) else {
        return Err(BackgroundError::Nothing("there is no such body"));
    };
    let alone = Scene { bodies: vec![described.clone()], obstacles: Vec::new(), ..scene.clone() };
    let opened = Opened::without_file(alone, String::new(), base_dir.to_owned());
    let lattices = opened.lattices(&CancelOnly(progress))?;
    if progress.is_cancelled() {
        return Err(BackgroundError::Cancelled);
    }
    let simulation = Simulation::<f32>::new(&opened.scene, &lattices);
    let modes = find(&simulation, 0, COUNT, &Paced { progress, pause }).map_err(|error| match error {
        ModalError::Cancelled => BackgroundError::Cancelled,
        error => BackgroundError::Modal(error),
    })?;
    Ok(BodyModes { body, modes, described: described.clone() })
}

fn find(simulation: &Simulation<f32>, body: usize, count: usize, watch: &dyn Watch) -> Result<Modes, ModalError> {
    let most_bytes = free_memory().map_or(u64::MAX, |free| free.bytes);
    modal::modes(&simulation.model().bodies[body], Wanted { count, most_bytes }, watch)
}

impl BodyModes {
    /// Whether they are of the body as the scene has it now; where it stands does not matter.
    pub fn is_of(&self, scene: &Scene) -> bool {
        scene.bodies.get(self.body.0).is_some_and(|body| {
            let Body { shape, material, inlays, pins, .. } = body;
            let own = &self.described;
            (shape, material, inlays, pins) == (&own.shape, &own.material, &own.inlays, &own.pins)
        })
    }
}

impl Swing {
    /// A body bent by one of its modes, by this share of its size.
    pub fn bent(of: &Arc<BodyModes>, mode: usize, share: f64) -> Self {
        let amplitudes = (0..of.modes.modes.len()).map(|number| if number == mode { share } else { 0.0 }).collect();
        Self { of: Arc::clone(of), amplitudes, played: None }
    }

    /// How often the picture of the played mode swings in a second, Hz, and how many times slower that is than the mode.
    pub fn shown_hz(&self) -> Option<(f64, f64)> {
        let hertz = self.of.modes.modes.get(self.played?)?.frequency_hz;
        let shown = hertz.min(MOST_HZ);
        (shown > 0.0).then(|| (shown, hertz / shown))
    }
}

impl Session {
    /// The lowest modes of a body.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn modes(&self, body: BodyId, count: usize, watch: &dyn Watch) -> Result<BodyModes, ModalError> {
        let modes = find(&self.simulation, body.0, count, watch)?;
        Ok(BodyModes { body, modes, described: self.scene.bodies[body.0].clone() })
    }

    /// Shows a body's modes while time stands still, or no longer.
    pub(super) fn show_modes(&mut self, swing: Option<Swing>) -> Result<(), SessionError> {
        if let Some(swing) = &swing {
            let body = self.simulation.model().bodies.get(swing.of.body.0);
            let fits = body
                .is_some_and(|body| swing.of.modes.modes.iter().all(|mode| mode.shape.len() == body.particles.len()));
            let is_sound = swing.amplitudes.iter().all(|amplitude| amplitude.is_finite());
            if !fits || !is_sound || swing.amplitudes.len() != swing.of.modes.modes.len() {
                return Err(SessionError::Modes);
            }
        }
        let secs = match (&self.swinging, &swing) {
            (Some(before), Some(now)) if before.swing.played == now.played => before.secs,
            _ => 0.0,
        };
        self.swinging = swing.map(|swing| Swinging { swing, secs });
        self.clock.forgive();
        self.picture.touch();
        Ok(())
    }

    /// Whether a mode swings, so that every picture differs from the last.
    pub fn is_swinging(&self) -> bool {
        self.swinging.as_ref().is_some_and(|swinging| swinging.swing.shown_hz().is_some())
    }

    /// What is shown of a body's modes.
    pub(super) fn swing(&self) -> Option<&Swing> {
        self.swinging.as_ref().map(|swinging| &swinging.swing)
    }

    /// Lets the mode that is played swing on. Whether modes are shown, so that time stands still.
    pub(super) fn swing_on(&mut self, wall: Duration) -> bool {
        if self.is_swinging()
            && let Some(swinging) = &mut self.swinging
        {
            swinging.secs += wall.as_secs_f64();
            self.picture.touch();
        }
        self.swinging.is_some()
    }

    /// No modes are shown of a body that is not the one they are of any more.
    pub(super) fn end_old_swing(&mut self) {
        if self.swinging.as_ref().is_some_and(|swinging| !swinging.swing.of.is_of(&self.scene)) {
            self.swinging = None;
        }
    }

    /// Puts the particles of a body whose modes are shown where these have them: about where it starts.
    pub(super) fn place_swing(&self, positions: &mut [[f32; 3]]) {
        let Some(Swinging { swing, secs }) = &self.swinging else { return };
        let body = &self.simulation.model().bodies[swing.of.body.0];
        let turn = rotation::from_euler_deg(self.scene.bodies[swing.of.body.0].pose.rotation_deg);
        let size = f64::from(body.size);
        let weights: Vec<f64> = swing
            .of
            .modes
            .modes
            .iter()
            .zip(&swing.amplitudes)
            .enumerate()
            .map(|(number, (mode, share))| {
                let phase = match swing.shown_hz() {
                    Some((hertz, _)) if swing.played == Some(number) => libm::cos(std::f64::consts::TAU * hertz * secs),
                    _ => 1.0,
                };
                share * size * phase / mode.reach().max(f64::MIN_POSITIVE)
            })
            .collect();
        for (local, (to, start)) in positions[body.particles.clone()].iter_mut().zip(&body.start).enumerate() {
            let modes = swing.of.modes.modes.iter().zip(&weights).filter(|(_, weight)| weight.abs() > 0.0);
            let way: glam::DVec3 = modes.map(|(mode, weight)| mode.shape[local] * *weight).sum();
            *to = (*start + (turn * way).as_vec3()).to_array();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::scene::body::CubeShape;
    use crate::scene::edit::Edit;
    use crate::scene::{Shape, presets};
    use crate::session::Command;

    fn session() -> Session {
        let mut scene = (presets::preset("cube-on-plane").expect("a preset").build)();
        scene.bodies[0].shape = Shape::Cube(CubeShape { cells: 3, size: 1.0 });
        scene.bodies[0].pose.rotation_deg = [0.0, 90.0, 0.0];
        Session::new(scene, PathBuf::new(), "cube".into()).expect("it resolves")
    }

    fn found(session: &Session) -> Arc<BodyModes> {
        let found = body_modes(session.scene(), Path::new(""), BodyId(0), &Progress::default(), &|| ());
        Arc::new(found.expect("modes"))
    }

    fn swing(of: &Arc<BodyModes>, played: Option<usize>) -> Swing {
        let mut amplitudes = vec![0.0; of.modes.modes.len()];
        amplitudes[2] = 0.1;
        Swing { of: Arc::clone(of), amplitudes, played }
    }

    fn farthest(session: &mut Session) -> f32 {
        let picture = session.draw_list();
        let start = &session.simulation().model().bodies[0].start;
        let far = picture.particles.iter().zip(start).map(|(at, start)| glam::Vec3::from(*at).distance(*start));
        far.fold(0.0, f32::max)
    }

    #[test]
    fn a_mode_is_shown_about_the_start_while_time_stands_still_and_leaves_no_trace() {
        let mut session = session();
        session.advance(Duration::from_millis(50), Duration::from_secs(5));
        let (before, of) = (session.simulation().hash(), found(&session));
        session.handle(Command::ShowModes(Some(swing(&of, None)))).expect("modes of this body");
        session.advance(Duration::from_millis(50), Duration::from_secs(5));
        assert_eq!(session.simulation().hash(), before, "time stands still");
        assert!((farthest(&mut session) - 0.1).abs() < 1e-5, "a tenth of the cube: {}", farthest(&mut session));
        assert!(!session.is_swinging() && session.status().swing.is_some(), "nothing is played");
        session.handle(Command::ShowModes(Some(swing(&of, Some(2))))).expect("modes of this body");
        let (hertz, slower) = swing(&of, Some(2)).shown_hz().expect("it swings");
        assert!(hertz <= MOST_HZ && slower >= 1.0, "{hertz} Hz, {slower} times slower");
        session.advance(Duration::from_secs_f64(0.25 / hertz), Duration::from_millis(1));
        assert!(session.is_swinging() && farthest(&mut session) < 1e-4, "a quarter of a swing later it passes rest");
        session.handle(Command::ShowModes(None)).expect("no modes any more");
        session.advance(Duration::from_millis(50), Duration::from_secs(5));
        assert_ne!(session.simulation().hash(), before, "time goes on");
    }

    #[test]
    fn a_body_that_changes_is_shown_as_it_is_and_modes_of_another_are_refused() {
        let mut session = session();
        let of = found(&session);
        session.handle(Command::ShowModes(Some(swing(&of, Some(2))))).expect("modes of this body");
        let mut body = session.scene().bodies[0].clone();
        body.shape = Shape::Cube(CubeShape { cells: 2, size: 1.0 });
        session.handle(Command::Edit(Edit::Body(BodyId(0), Box::new(body)))).expect("fewer cells");
        assert!(session.status().swing.is_none() && !of.is_of(session.scene()), "they are not of this body");
        session.draw_list();
        let refused = session.handle(Command::ShowModes(Some(swing(&of, None))));
        assert!(refused.is_err_and(|error| error.to_string().contains("another body")), "of other particles");
        session.handle(Command::Undo).expect("the cells are back");
        assert!(of.is_of(session.scene()), "and so are the modes");
        let wild = Swing { amplitudes: vec![f64::NAN; of.modes.modes.len()], ..swing(&of, None) };
        assert!(session.handle(Command::ShowModes(Some(wild))).is_err(), "no number");
    }

    #[test]
    fn what_has_no_modes_says_why_and_what_is_cancelled_stops() {
        let session = session();
        let none = body_modes(session.scene(), Path::new(""), BodyId(7), &Progress::default(), &|| ());
        assert!(matches!(none, Err(BackgroundError::Nothing(_))), "{none:?}");
        let progress = Progress::default();
        progress.cancel();
        let stopped = body_modes(session.scene(), Path::new(""), BodyId(0), &progress, &|| ());
        assert!(matches!(stopped, Err(BackgroundError::Cancelled)), "{stopped:?}");
    }
}
