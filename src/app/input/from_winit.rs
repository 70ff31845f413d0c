//! Turns the window library's events into the few that have a meaning here.

use glam::Vec2;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::keyboard::{Key as WinitKey, NamedKey};

use super::event::{Button, Event, Key};

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
        WinitKey::Named(NamedKey::F11) => Some(Key::F11),
        WinitKey::Named(NamedKey::Home) => Some(Key::Home),
        WinitKey::Character(text) => {
            let mut letters = text.chars().flat_map(char::to_lowercase);
            let letter = letters.next()?;
            letters.next().is_none().then_some(if letter == ' ' { Key::Space } else { Key::Char(letter) })
        }
        _ => None,
    }
}
