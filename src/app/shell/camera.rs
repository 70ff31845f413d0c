//! Everything that moves the eye: a person's hand, framing, and the thing that is followed.

use glam::{DVec3, Vec2, Vec3};

use super::Shell;
use crate::app::hand::{self, Target};
use crate::app::input::{self, CameraMove};
use crate::app::ui::Framing;
use crate::extract;
use crate::scene::placement::Look;

/// How many times farther away the eye may go to show a new thing beside what was seen. If that is not enough, the new thing
/// is shown alone.
const MAX_PULL_BACK: f32 = 3.0;

impl Shell {
    /// Carries out a move of the camera that a hand or a key asked for.
    pub(super) fn move_camera(&mut self, camera_move: CameraMove) {
        match camera_move {
            CameraMove::Frame => self.show(Framing::Chosen),
            CameraMove::FrameAll => self.show(Framing::Everything),
            _ => {
                let (view, before) = (self.view(), self.orbit);
                input::move_camera(&mut self.orbit, camera_move, view);
                if let Some(floor) = self.floor() {
                    self.orbit.stay_above(floor, &before);
                }
                self.changed = true;
            }
        }
    }

    /// Shows something whole, in the part of the view that no card covers.
    pub(super) fn show(&mut self, framing: Framing) {
        let Some(snapshot) = &self.snapshot else { return };
        let (picture, area, before) = (&snapshot.draw_list, self.ui.safe_area(), self.orbit);
        let chosen = self.ui.selection.and_then(|target| hand::bounds(&snapshot.scene, picture, target));
        let floor = picture.floor().filter(|floor| before.camera().eye.y >= *floor);
        match (framing, chosen) {
            (Framing::Everything, _) | (Framing::Chosen, None) => self.orbit.frame_above(floor, picture.bounds(), area),
            (Framing::Chosen, Some(chosen)) => self.orbit.frame_above(floor, chosen, area),
            (Framing::Opened, _) if snapshot.status.file.is_none() => self.orbit.pull_back(picture.bounds(), area),
            // The camera of a file is as its author left it, if the file has one.
            (Framing::Opened, _) => {
                self.orbit = extract::view::first_orbit(&snapshot.scene.view.camera, picture, area);
            }
            (Framing::Arrived, Some(chosen)) => {
                self.orbit.pull_back(chosen, area);
                if self.orbit.distance > MAX_PULL_BACK * before.distance {
                    self.orbit = before;
                    self.orbit.frame_above(floor, chosen, area);
                }
            }
            (Framing::Arrived, None) => (),
        }
        self.changed = true;
    }

    /// Moves with the selected thing, if that is wanted. A newly followed thing comes to the middle of the picture.
    pub(super) fn follow(&mut self) {
        let wanted = self.ui.selection.filter(|_| self.ui.follow_chosen);
        let was_followed = |target| self.followed.filter(|(followed, _)| *followed == target);
        self.followed = match wanted.map(|target| (target, self.center_of(target))) {
            Some((target, Some(center))) => {
                let moved = was_followed(target).map(|(_, from)| center - from);
                self.orbit.target = moved.map_or(center, |way| self.orbit.target + way);
                self.orbit = self.orbit.clamped();
                if let Some(floor) = self.floor() {
                    self.orbit.rise_above(floor);
                }
                self.changed = true;
                Some((target, center))
            }
            Some((target, None)) if was_followed(target).is_some() => {
                // The followed thing has fallen out of the scene.
                self.show(Framing::Everything);
                None
            }
            _ => None,
        };
    }

    fn floor(&self) -> Option<f32> {
        self.snapshot.as_ref()?.draw_list.floor()
    }

    fn center_of(&self, target: Target) -> Option<Vec3> {
        let snapshot = self.snapshot.as_ref()?;
        match target {
            Target::Body(id) => {
                let body = snapshot.status.bodies.get(id.0).filter(|body| !body.gone)?;
                Some(DVec3::from(body.center).as_vec3())
            }
            Target::Obstacle(_) => Some(hand::bounds(&snapshot.scene, &snapshot.draw_list, target)?.center()),
        }
    }

    /// The point where a person looks: in the middle of the free part of the view, as far away as the target.
    pub(super) fn look(&self) -> Look {
        let camera = self.orbit.camera();
        let area = self.ui.safe_area();
        let pixel = (area.center() * Vec2::new(0.5, -0.5) + 0.5) * Vec2::new(area.aspect, 1.0);
        let ray = camera.ray_through(pixel, Vec2::new(area.aspect, 1.0));
        let distance = ray.hit_plane(camera.target, camera.forward()).unwrap_or_default();
        Look { at: ray.at(distance).as_dvec3(), ahead: camera.forward().as_dvec3() }
    }
}
