//! What a pointer and a keyboard mean: window events in, camera moves and commands out. Pure, so that every habit of
//! the hand is a test; knows nothing of panels, surfaces or threads.
//!
//! The habits are Blender's, with a second scheme for hands without a middle button:
//!
//! ```text
//! orbit   middle drag            left drag     two-finger scroll
//! pan     shift + middle drag    right drag    shift + left drag, shift + scroll
//! zoom    wheel, to the pointer  pinch         ctrl + middle drag, ctrl + scroll
//! choose  left click
//! hold    left drag on something that can be held
//! ```

use glam::Vec2;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::keyboard::{Key as WinitKey, NamedKey};

use super::ui::files::FileAction;
use crate::scene::ColorBy;
use crate::session::Command;
use crate::view::Orbit;

/// Turn of the eye for a pixel of dragging (at scale 1), radians.
const ORBIT_RAD_PER_POINT: f32 = 0.007;
/// What one notch of the wheel does to the distance.
const ZOOM_PER_NOTCH: f32 = 0.86;
/// What a point of scrolling or dragging does to the logarithm of the distance.
const ZOOM_PER_POINT: f32 = 0.005;
/// A press that moves less than this (points) before it ends is a click.
const CLICK_RADIUS: f32 = 4.0;

/// A window event, as far as it concerns the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The pointer is at this pixel, from the window's upper left corner.
    PointerMoved(Vec2),
    /// A button went down or up.
    Button {
        /// Which one.
        button: Button,
        /// Down, not up.
        pressed: bool,
    },
    /// A wheel turned by this many notches; up is positive.
    Wheel(f32),
    /// Two fingers moved over a trackpad by this many pixels; right and down are positive.
    Scroll(Vec2),
    /// Two fingers spread by this share of their distance; together is negative.
    Pinch(f32),
    /// A key went down.
    Key {
        /// Which one.
        key: Key,
        /// It was down already and repeats.
        repeat: bool,
    },
    /// The keys held beside others changed.
    Modifiers {
        /// Shift is down.
        shift: bool,
        /// Control (or command) is down.
        control: bool,
        /// Alt or the system key is down.
        other: bool,
    },
    /// The window lost the keyboard: nothing is held any more.
    FocusLost,
}

/// A pointer button that means something to the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    /// Usually the left one.
    Primary,
    /// The wheel, pressed.
    Middle,
    /// Usually the right one.
    Secondary,
}

/// A key that means something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// The space bar.
    Space,
    /// The arrow to the right.
    Right,
    /// The first function key.
    F1,
    /// The escape key.
    Escape,
    /// The key that deletes.
    Delete,
    /// The second function key.
    F2,
    /// The key for the beginning.
    Home,
    /// A letter (lower case), digit or sign.
    Char(char),
}

/// What the window must know to answer an event.
#[derive(Clone, Copy, Debug, Default)]
#[expect(clippy::struct_excessive_bools, reason = "four independent facts, each true or not")]
pub struct Situation {
    /// The pointer is over the view, not over a panel.
    pub over_view: bool,
    /// A widget has the keyboard.
    pub typing: bool,
    /// What lies under the pointer can be held. Asked when a button goes down.
    pub holdable: bool,
    /// Time runs.
    pub playing: bool,
    /// Pixels a point of the interface.
    pub scale: f32,
}

/// What an event asks for.
#[derive(Clone, Debug)]
pub enum Action {
    /// Move the camera.
    Camera(CameraMove),
    /// Tell the session.
    Send(Command),
    /// Colour the jelly by this.
    ColorBy(ColorBy),
    /// Show or hide the list of keys.
    ToggleKeys,
    /// Show or hide a panel beside the view.
    TogglePanel(Panel),
    /// Close what lies over the view, let go, choose nothing.
    Close,
    /// Choose what lies under this pixel.
    Choose(Vec2),
    /// Take hold of what lies under this pixel.
    Take(Vec2),
    /// Move what is held to under this pixel.
    Drag(Vec2),
    /// Let go of what is held.
    Release,
    /// Do something with what is chosen.
    Chosen(ChosenAction),
    /// Something with files.
    Files(FileAction),
}

/// A panel beside the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    /// The list of bodies and obstacles.
    Tree,
    /// The values of what is chosen.
    Inspector,
    /// What a step costs.
    Cost,
}

/// Something to do with the body or obstacle that is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChosenAction {
    /// Take it out of the scene.
    Delete,
    /// Put another one like it beside it.
    Duplicate,
    /// Hide it, or show it again.
    Hide,
    /// Give it another name.
    Rename,
}

/// A move of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraMove {
    /// Turn about the target, radians.
    Orbit {
        /// About the vertical.
        yaw_rad: f32,
        /// Above the horizon.
        pitch_rad: f32,
    },
    /// Drag the scene by pixels.
    Pan(Vec2),
    /// Multiply the distance, keeping what is under the pointer.
    Zoom {
        /// Below 1 goes nearer.
        factor: f32,
        /// The pixel kept in place, from the window's upper left corner.
        at: Vec2,
    },
    /// Show what is chosen, or everything.
    Frame,
    /// Show everything.
    FrameAll,
}

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

/// What the hand is doing: the pointer, what is held and what is being dragged.
#[derive(Debug, Default)]
pub struct Input {
    pointer: Vec2,
    press: Option<Press>,
    shift: bool,
    control: bool,
    other: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Drag {
    Camera(CameraDrag),
    Hold,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum CameraDrag {
    Orbit,
    Pan,
    Zoom { at: Vec2 },
}

/// A button that is down since it was pressed in the view.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Press {
    button: Button,
    drag: Drag,
    from: Vec2,
    /// It has moved too far for a click.
    moved: bool,
}

impl Input {
    /// The pixel the pointer was last seen at.
    pub fn pointer(&self) -> Vec2 {
        self.pointer
    }

    /// Whether a drag that began in the view goes on.
    pub fn dragging(&self) -> bool {
        self.press.is_some()
    }

    /// What an event asks for, if anything.
    pub fn on_event(&mut self, event: Event, situation: Situation) -> Option<Action> {
        let scale = situation.scale.max(f32::EPSILON);
        match event {
            Event::PointerMoved(pixel) => {
                let moved = pixel - self.pointer;
                self.pointer = pixel;
                if moved == Vec2::ZERO { None } else { self.dragged_by(moved, scale) }
            }
            Event::Button { button, pressed: true } => {
                if situation.over_view && self.press.is_none() {
                    let drag = self.drag_of(button, situation.holdable);
                    self.press = Some(Press { button, drag, from: self.pointer, moved: false });
                }
                None
            }
            Event::Button { button, pressed: false } => {
                let press = self.press.take_if(|press| press.button == button)?;
                match (press.drag, press.moved) {
                    (Drag::Hold, true) => Some(Action::Release),
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
            Event::Scroll(pixels) if self.control => {
                let factor = (-pixels.y / scale * ZOOM_PER_POINT).exp();
                self.over(situation, CameraMove::Zoom { factor, at: self.pointer })
            }
            Event::Scroll(pixels) if self.shift => self.over(situation, CameraMove::Pan(pixels)),
            Event::Scroll(pixels) => self.over(situation, dragged(CameraDrag::Orbit, pixels, scale)),
            Event::Pinch(spread) => {
                let factor = (-spread).exp();
                self.over(situation, CameraMove::Zoom { factor, at: self.pointer })
            }
            Event::Modifiers { shift, control, other } => {
                (self.shift, self.control, self.other) = (shift, control, other);
                None
            }
            Event::FocusLost => {
                (self.shift, self.control, self.other) = (false, false, false);
                let press = self.press.take()?;
                (press.drag == Drag::Hold && press.moved).then_some(Action::Release)
            }
            Event::Key { key, repeat } => self.on_key(key, repeat, situation),
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
            Drag::Camera(drag) => Some(Action::Camera(dragged(drag, moved, scale))),
        }
    }

    fn on_key(&self, key: Key, repeat: bool, situation: Situation) -> Option<Action> {
        // Holding a key down steps on and on; everything else happens once.
        let stepping = matches!(key, Key::Right | Key::Char('.'));
        if self.control && !self.other {
            let history = if situation.typing { None } else { self.history_key(key) };
            let files = || file_action(key, self.shift).filter(|_| !repeat).map(Action::Files);
            return history.or_else(files);
        }
        if self.control || self.other || (repeat && !stepping) {
            return None;
        }
        match key {
            Key::F1 => Some(Action::ToggleKeys),
            Key::Escape => Some(Action::Close),
            _ if situation.typing => None,
            Key::Space if situation.playing => Some(Action::Send(Command::Pause)),
            Key::Space => Some(Action::Send(Command::Play)),
            Key::Right | Key::Char('.') => Some(Action::Send(Command::StepOnce)),
            Key::Char('r') => Some(Action::Send(Command::Restart)),
            Key::Home => Some(Action::Camera(CameraMove::FrameAll)),
            Key::Char('t') => Some(Action::TogglePanel(Panel::Tree)),
            Key::Char('n') => Some(Action::TogglePanel(Panel::Inspector)),
            Key::Char('c') => Some(Action::TogglePanel(Panel::Cost)),
            Key::Char('f') => Some(Action::Camera(CameraMove::Frame)),
            Key::Char('x') | Key::Delete => Some(Action::Chosen(ChosenAction::Delete)),
            Key::Char('d') if self.shift => Some(Action::Chosen(ChosenAction::Duplicate)),
            Key::Char('h') => Some(Action::Chosen(ChosenAction::Hide)),
            Key::F2 => Some(Action::Chosen(ChosenAction::Rename)),
            Key::Char(digit) => {
                let index = usize::try_from(digit.to_digit(10)?).ok()?.checked_sub(1)?;
                ColorBy::ALL.get(index).copied().map(Action::ColorBy)
            }
        }
    }

    fn history_key(&self, key: Key) -> Option<Action> {
        match (key, self.shift) {
            (Key::Char('z'), false) => Some(Action::Send(Command::Undo)),
            (Key::Char('z'), true) | (Key::Char('y'), false) => Some(Action::Send(Command::Redo)),
            _ => None,
        }
    }

    fn drag_of(&self, button: Button, holdable: bool) -> Drag {
        match button {
            Button::Secondary => Drag::Camera(CameraDrag::Pan),
            Button::Primary | Button::Middle if self.shift => Drag::Camera(CameraDrag::Pan),
            Button::Middle if self.control => Drag::Camera(CameraDrag::Zoom { at: self.pointer }),
            Button::Primary if holdable => Drag::Hold,
            Button::Primary | Button::Middle => Drag::Camera(CameraDrag::Orbit),
        }
    }

    fn over(&self, situation: Situation, camera_move: CameraMove) -> Option<Action> {
        (situation.over_view || self.press.is_some()).then_some(Action::Camera(camera_move))
    }
}

/// What a key means with control.
fn file_action(key: Key, shift: bool) -> Option<FileAction> {
    match (key, shift) {
        (Key::Char('n'), false) => Some(FileAction::New),
        (Key::Char('o'), false) => Some(FileAction::Open),
        (Key::Char('s'), false) => Some(FileAction::Save),
        (Key::Char('s'), true) => Some(FileAction::SaveAs),
        (Key::Char('q'), false) => Some(FileAction::Quit),
        _ => None,
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

/// The part of a window event that concerns the view.
#[expect(clippy::cast_possible_truncation, reason = "pixels and gestures need no double precision")]
pub fn from_winit(event: &WindowEvent) -> Option<Event> {
    match event {
        WindowEvent::CursorMoved { position, .. } => {
            Some(Event::PointerMoved(Vec2::new(position.x as f32, position.y as f32)))
        }
        WindowEvent::MouseInput { state, button, .. } => {
            let button = match button {
                MouseButton::Left => Button::Primary,
                MouseButton::Middle => Button::Middle,
                MouseButton::Right => Button::Secondary,
                _ => return None,
            };
            Some(Event::Button { button, pressed: *state == ElementState::Pressed })
        }
        WindowEvent::MouseWheel { delta: MouseScrollDelta::LineDelta(_, lines), .. } => Some(Event::Wheel(*lines)),
        WindowEvent::MouseWheel { delta: MouseScrollDelta::PixelDelta(pixels), .. } => {
            Some(Event::Scroll(Vec2::new(pixels.x as f32, pixels.y as f32)))
        }
        WindowEvent::PinchGesture { delta, .. } if delta.is_finite() => Some(Event::Pinch(*delta as f32)),
        WindowEvent::PanGesture { delta, .. } => Some(Event::Scroll(Vec2::new(delta.x, delta.y))),
        WindowEvent::ModifiersChanged(modifiers) => {
            let state = modifiers.state();
            let command = if cfg!(target_os = "macos") { state.super_key() } else { state.control_key() };
            let other = if cfg!(target_os = "macos") { state.control_key() } else { state.super_key() };
            Some(Event::Modifiers { shift: state.shift_key(), control: command, other: other || state.alt_key() })
        }
        WindowEvent::Focused(false) => Some(Event::FocusLost),
        WindowEvent::KeyboardInput { event, is_synthetic: false, .. } if event.state == ElementState::Pressed => {
            Some(Event::Key { key: key_of(&event.logical_key)?, repeat: event.repeat })
        }
        _ => None,
    }
}

fn key_of(key: &WinitKey) -> Option<Key> {
    match key {
        WinitKey::Named(NamedKey::Space) => Some(Key::Space),
        WinitKey::Named(NamedKey::ArrowRight) => Some(Key::Right),
        WinitKey::Named(NamedKey::F1) => Some(Key::F1),
        WinitKey::Named(NamedKey::Escape) => Some(Key::Escape),
        WinitKey::Named(NamedKey::Delete) => Some(Key::Delete),
        WinitKey::Named(NamedKey::F2) => Some(Key::F2),
        WinitKey::Named(NamedKey::Home) => Some(Key::Home),
        WinitKey::Character(text) => {
            let mut letters = text.chars().flat_map(char::to_lowercase);
            let letter = letters.next()?;
            letters.next().is_none().then_some(if letter == ' ' { Key::Space } else { Key::Char(letter) })
        }
        _ => None,
    }
}
