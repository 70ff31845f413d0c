//! The meaning of pointer and keyboard: window events in, camera moves and commands out. Pure, so that every gesture has a
//! test; knows nothing of panels, surfaces or threads.
//!
//! The gestures are Blender's, with a second scheme for pointers without a middle button:
//!
//! ```text
//! orbit   middle drag            left drag     two-finger scroll
//! pan     shift + middle drag    right drag    shift + left drag, shift + scroll
//! zoom    wheel, to the pointer  pinch         ctrl + middle drag, ctrl + scroll
//! choose  left click
//! hold    left drag on something that can be held
//! brush   left press or drag on what it paints, inverted with control
//! ```

mod action;
mod event;
mod from_winit;
mod keys;

use glam::Vec2;

use crate::view::Orbit;

pub use action::{Action, CameraMove, ChosenAction, Panel};
use event::Modifiers;
pub use event::{Button, Event, Key, Keyboard, Situation};
pub use from_winit::from_winit;

/// The turn of the eye per point of dragging, radians.
const ORBIT_RAD_PER_POINT: f32 = 0.007;
/// The factor on the distance for one notch of the wheel.
const ZOOM_PER_NOTCH: f32 = 0.86;
/// The change of the logarithm of the distance per point of scrolling or dragging.
const ZOOM_PER_POINT: f32 = 0.005;
/// A press is a click if it moves by less than this, points.
const CLICK_RADIUS: f32 = 4.0;

/// The view's rectangle in the window, pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewRect {
    /// Its upper left corner.
    pub origin: Vec2,
    /// Width and height.
    pub size: Vec2,
}

impl ViewRect {
    /// Width over height; 1 for an empty rectangle.
    pub fn aspect(&self) -> f32 {
        if self.size.min_element() > 0.0 { self.size.x / self.size.y } else { 1.0 }
    }

    /// Whether a pixel of the window lies in it.
    pub fn contains(&self, pixel: Vec2) -> bool {
        pixel.cmpge(self.origin).all() && pixel.cmplt(self.origin + self.size).all()
    }
}

/// Carries out a move that does not need the scene's bounds.
pub fn move_camera(orbit: &mut Orbit, camera_move: CameraMove, view: ViewRect) {
    match camera_move {
        CameraMove::Orbit { yaw_rad, pitch_rad } => orbit.orbit(yaw_rad, pitch_rad),
        CameraMove::Pan(pixels) => orbit.pan(pixels, view.size.y),
        CameraMove::Zoom { factor, at } if view.size.min_element() > 0.0 => {
            let ray = orbit.camera().ray_through(at - view.origin, view.size);
            orbit.zoom_along(factor, &ray);
        }
        CameraMove::Zoom { .. } | CameraMove::Frame | CameraMove::FrameAll => (),
    }
}

/// The state of the hand: the pointer, the modifier keys and the drag.
#[derive(Debug, Default)]
pub struct Input {
    pointer: Vec2,
    press: Option<Press>,
    held: Modifiers,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Drag {
    Camera(CameraDrag),
    Hold,
    Brush { inverted: bool },
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum CameraDrag {
    Orbit,
    Pan,
    Zoom { at: Vec2 },
}

/// A button pressed in the view and still down.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Press {
    button: Button,
    drag: Drag,
    from: Vec2,
    /// Whether the pointer has moved too far for a click.
    moved: bool,
}

impl Input {
    /// The pixel the pointer was last seen at.
    pub fn pointer(&self) -> Vec2 {
        self.pointer
    }

    /// Whether a drag that began in the view is in progress.
    pub fn dragging(&self) -> bool {
        self.press.is_some()
    }

    /// The action that an event asks for, if any.
    pub fn on_event(&mut self, event: Event, situation: Situation) -> Option<Action> {
        if situation.dialog_open {
            return self.behind_dialog(event);
        }
        let scale = situation.scale.max(f32::EPSILON);
        match event {
            Event::PointerMoved(pixel) => {
                let moved = pixel - self.pointer;
                self.pointer = pixel;
                if moved == Vec2::ZERO { None } else { self.dragged_by(moved, scale) }
            }
            Event::Button { button, pressed: true } => {
                if situation.over_view && self.press.is_none() {
                    let drag = self.drag_of(button, situation);
                    self.press = Some(Press { button, drag, from: self.pointer, moved: false });
                    if let Drag::Brush { inverted } = drag {
                        return Some(Action::Brush { pixel: self.pointer, inverted });
                    }
                }
                None
            }
            Event::Button { button, pressed: false } => {
                let press = self.press.take_if(|press| press.button == button)?;
                match (press.drag, press.moved) {
                    (Drag::Hold, true) => Some(Action::Release),
                    (Drag::Brush { .. }, _) => Some(Action::LiftBrush),
                    (Drag::Hold | Drag::Camera(CameraDrag::Orbit), false) if button == Button::Primary => {
                        Some(Action::Choose(press.from))
                    }
                    _ => None,
                }
            }
            Event::Wheel(notches) => {
                let factor = ZOOM_PER_NOTCH.powf(notches);
                self.over(situation, CameraMove::Zoom { factor, at: self.pointer })
            }
            Event::Scroll(pixels) if self.held.control => {
                let factor = (-pixels.y / scale * ZOOM_PER_POINT).exp();
                self.over(situation, CameraMove::Zoom { factor, at: self.pointer })
            }
            Event::Scroll(pixels) if self.held.shift => self.over(situation, CameraMove::Pan(pixels)),
            Event::Scroll(pixels) => self.over(situation, dragged(CameraDrag::Orbit, pixels, scale)),
            Event::Pinch(spread) => {
                let factor = (-spread).exp();
                self.over(situation, CameraMove::Zoom { factor, at: self.pointer })
            }
            Event::Modifiers { shift, control, other } => {
                self.held = Modifiers { shift, control, other };
                None
            }
            Event::FocusLost => {
                self.held = Modifiers::default();
                self.let_go()
            }
            Event::Key { key, repeat } => keys::action(key, repeat, self.held, situation),
        }
    }

    /// Handles an event while a dialog or a menu is open: nothing behind it receives the event, and a held thing is let go.
    fn behind_dialog(&mut self, event: Event) -> Option<Action> {
        match event {
            Event::PointerMoved(pixel) => self.pointer = pixel,
            Event::Modifiers { shift, control, other } => self.held = Modifiers { shift, control, other },
            Event::FocusLost => self.held = Modifiers::default(),
            // The key for full screen works for the dialog too.
            Event::Key { key: Key::F11, repeat: false } => return Some(Action::ToggleFullScreen),
            _ => (),
        }
        self.let_go()
    }

    fn let_go(&mut self) -> Option<Action> {
        let press = self.press.take()?;
        match press.drag {
            Drag::Hold if press.moved => Some(Action::Release),
            Drag::Brush { .. } => Some(Action::LiftBrush),
            _ => None,
        }
    }

    fn dragged_by(&mut self, moved: Vec2, scale: f32) -> Option<Action> {
        let pointer = self.pointer;
        let press = self.press.as_mut()?;
        let began = !press.moved && (pointer - press.from).length() > CLICK_RADIUS * scale;
        press.moved |= began;
        match press.drag {
            Drag::Hold if began => Some(Action::Take(press.from)),
            Drag::Hold if press.moved => Some(Action::Drag(pointer)),
            Drag::Hold => None,
            Drag::Brush { inverted } => Some(Action::Brush { pixel: pointer, inverted }),
            Drag::Camera(drag) => Some(Action::Camera(dragged(drag, moved, scale))),
        }
    }

    fn drag_of(&self, button: Button, situation: Situation) -> Drag {
        match button {
            Button::Secondary => Drag::Camera(CameraDrag::Pan),
            Button::Primary | Button::Middle if self.held.shift => Drag::Camera(CameraDrag::Pan),
            Button::Middle if self.held.control => Drag::Camera(CameraDrag::Zoom { at: self.pointer }),
            Button::Primary if situation.brushable => Drag::Brush { inverted: self.held.control },
            Button::Primary if situation.holdable => Drag::Hold,
            Button::Primary | Button::Middle => Drag::Camera(CameraDrag::Orbit),
        }
    }

    fn over(&self, situation: Situation, camera_move: CameraMove) -> Option<Action> {
        (situation.over_view || self.press.is_some()).then_some(Action::Camera(camera_move))
    }
}

fn dragged(drag: CameraDrag, pixels: Vec2, scale: f32) -> CameraMove {
    let points = pixels / scale;
    match drag {
        CameraDrag::Orbit => {
            CameraMove::Orbit { yaw_rad: -points.x * ORBIT_RAD_PER_POINT, pitch_rad: points.y * ORBIT_RAD_PER_POINT }
        }
        CameraDrag::Pan => CameraMove::Pan(pixels),
        CameraDrag::Zoom { at } => CameraMove::Zoom { factor: (points.y * ZOOM_PER_POINT).exp(), at },
    }
}
