//! The meaning of keys.

use super::action::{Action, CameraMove, ChosenAction, Panel};
use super::event::{Key, Keyboard, Modifiers, Situation};
use crate::app::ui::files::FileAction;
use crate::scene::ColorBy;
use crate::session::Command;

/// The action of a key when nothing lies over the view. `repeat`: the key was down already.
pub(super) fn action(key: Key, repeat: bool, held: Modifiers, situation: Situation) -> Option<Action> {
    // A key held down repeats single steps; every other action happens once.
    let stepping = matches!(key, Key::Right | Key::Char('.'));
    if held.control && !held.other {
        let history = if situation.keyboard == Keyboard::Text { None } else { history_key(key, held.shift) };
        let files = || file_action(key, held.shift).filter(|_| !repeat).map(Action::Files);
        return history.or_else(files);
    }
    if held.control || held.other || (repeat && !stepping) {
        return None;
    }
    match key {
        Key::F1 => Some(Action::ToggleKeys),
        Key::F11 => Some(Action::ToggleFullScreen),
        _ if is_taken(key, situation.keyboard) => None,
        Key::Escape => Some(Action::Close),
        Key::Space if situation.playing => Some(Action::Send(Command::Pause)),
        Key::Space => Some(Action::Send(Command::Play)),
        Key::Right | Key::Char('.') => Some(Action::Send(Command::StepOnce)),
        Key::Char('r') => Some(Action::Send(Command::Restart)),
        Key::Home => Some(Action::Camera(CameraMove::FrameAll)),
        Key::Char('t') => Some(Action::TogglePanel(Panel::Tree)),
        Key::Char('n') => Some(Action::TogglePanel(Panel::Inspector)),
        Key::Char('c') => Some(Action::TogglePanel(Panel::Cost)),
        Key::Char('e') => Some(Action::TogglePanel(Panel::Error)),
        Key::Char('m') => Some(Action::TogglePanel(Panel::Stability)),
        Key::Char('v') => Some(Action::TogglePanel(Panel::Modes)),
        Key::Char('f') if held.shift => Some(Action::FollowChosen),
        Key::Char('f') => Some(Action::Camera(CameraMove::Frame)),
        Key::Char('x') | Key::Delete => Some(Action::Chosen(ChosenAction::Delete)),
        Key::Char('d') if held.shift => Some(Action::Chosen(ChosenAction::Duplicate)),
        Key::Char('h') => Some(Action::Chosen(ChosenAction::Hide)),
        Key::F2 => Some(Action::Chosen(ChosenAction::Rename)),
        Key::Char(digit) => {
            let index = usize::try_from(digit.to_digit(10)?).ok()?.checked_sub(1)?;
            ColorBy::ALL.get(index).copied().map(Action::ColorBy)
        }
    }
}

/// Whether a key is for the part with the keyboard: every key for a text field, a few keys for a button or a slider.
fn is_taken(key: Key, keyboard: Keyboard) -> bool {
    match keyboard {
        Keyboard::View => false,
        // Escape takes the keyboard from the widget; the next Escape is for the view.
        Keyboard::Widget => matches!(key, Key::Space | Key::Right | Key::Escape),
        Keyboard::Text => true,
    }
}

fn history_key(key: Key, shift: bool) -> Option<Action> {
    match (key, shift) {
        (Key::Char('z'), false) => Some(Action::Send(Command::Undo)),
        (Key::Char('z'), true) | (Key::Char('y'), false) => Some(Action::Send(Command::Redo)),
        _ => None,
    }
}

/// The action of a key with control.
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
