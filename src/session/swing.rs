//! Shows the modes of a body in the picture of the sandbox, while time stands still.

use std::time::Duration;

use super::Session;
use super::error::SessionError;
use super::modes::{BodyModes, Swing, Swinging, compute_modes};
use crate::geometry::Watch;
use crate::math::rotation;
use crate::modal::ModalError;
use crate::scene::edit::BodyId;

impl Session {
    /// The lowest modes of a body.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn modes(&self, body: BodyId, count: usize, watch: &dyn Watch) -> Result<BodyModes, ModalError> {
        let modes = compute_modes(&self.simulation, body.0, count, watch)?;
        Ok(BodyModes { body, modes, source_body: self.scene.bodies[body.0].clone() })
    }

    /// Shows a body's modes while time stands still, or ends that.
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
        self.clock.reset();
        self.picture.invalidate();
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

    /// Lets the played mode swing on. Returns whether modes are shown, so that time stands still.
    pub(super) fn advance_swing(&mut self, wall: Duration) -> bool {
        if self.is_swinging()
            && let Some(swinging) = &mut self.swinging
        {
            swinging.secs += wall.as_secs_f64();
            self.picture.invalidate();
        }
        self.swinging.is_some()
    }

    /// Ends the display of modes that no longer belong to their body.
    pub(super) fn end_outdated_swing(&mut self) {
        if self.swinging.as_ref().is_some_and(|swinging| !swinging.swing.of.is_of(&self.scene)) {
            self.swinging = None;
        }
    }

    /// Moves the particles of the body whose modes are shown to where the modes put them, about its start.
    pub(super) fn displace_by_modes(&self, positions: &mut [[f32; 3]]) {
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
            let displacement: glam::DVec3 = modes.map(|(mode, weight)| mode.shape[local] * *weight).sum();
            *to = (*start + (turn * displacement).as_vec3()).to_array();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};
    use std::sync::Arc;

    use super::*;
    use crate::scene::body::CubeShape;
    use crate::scene::edit::Edit;
    use crate::scene::{Shape, presets};
    use crate::session::Command;
    use crate::session::background::BackgroundError;
    use crate::session::modes::{MAX_SHOWN_HZ, body_modes};
    use crate::session::progress::Progress;

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
        assert!(hertz <= MAX_SHOWN_HZ && slower >= 1.0, "{hertz} Hz, {slower} times slower");
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
        assert!(matches!(none, Err(BackgroundError::NotPossible(_))), "{none:?}");
        let progress = Progress::default();
        progress.cancel();
        let stopped = body_modes(session.scene(), Path::new(""), BodyId(0), &progress, &|| ());
        assert!(matches!(stopped, Err(BackgroundError::Cancelled)), "{stopped:?}");
    }
}
