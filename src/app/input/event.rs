//! The events that reach the view: the pointer, keys, and what the window knows when they come.

use glam::Vec2;

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
    /// Two fingers moved apart by this fraction of their distance; together is negative.
    Pinch(f32),
    /// A key went down.
    Key {
        /// Which one.
        key: Key,
        /// It was down already and repeats.
        repeat: bool,
    },
    /// The modifier keys held have changed.
    Modifiers {
        /// Shift is down.
        shift: bool,
        /// Control (or command) is down.
        control: bool,
        /// Alt or the system key is down.
        other: bool,
    },
    /// The window lost the keyboard: no key counts as held any more.
    FocusLost,
}

/// A pointer button that the view uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    /// Usually the left one.
    Primary,
    /// The wheel, pressed.
    Middle,
    /// Usually the right one.
    Secondary,
}

/// The facts that the window needs to answer an event.
#[derive(Clone, Copy, Debug, Default)]
#[expect(clippy::struct_excessive_bools, reason = "four independent facts, each true or not")]
pub struct Situation {
    /// The pointer is over the view, not over a panel.
    pub over_view: bool,
    /// A dialog or a menu is open: keys and clicks are for it alone.
    pub dialog_open: bool,
    /// The part of the interface that has the keyboard.
    pub keyboard: Keyboard,
    /// The thing under the pointer can be held. Determined only when a button goes down.
    pub holdable: bool,
    /// The brush can paint the thing under the pointer. Determined only when a button goes down.
    pub brushable: bool,
    /// Time runs.
    pub playing: bool,
    /// Pixels per point of the interface.
    pub scale: f32,
}

/// The part of the interface that has the keyboard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keyboard {
    /// None: keys are for the view.
    #[default]
    View,
    /// A button or a slider, which uses space, arrows and Escape; other keys are for the view.
    Widget,
    /// A text field, which has an undo of its own.
    Text,
}

/// A key with a meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// The space bar.
    Space,
    /// The arrow to the right.
    Right,
    /// The first function key.
    F1,
    /// The second function key.
    F2,
    /// The eleventh function key.
    F11,
    /// The escape key.
    Escape,
    /// The key that deletes.
    Delete,
    /// The key for the beginning.
    Home,
    /// A letter (lower case), digit or sign.
    Char(char),
}

/// The modifier keys held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Modifiers {
    pub(super) shift: bool,
    /// Control, or command on macOS.
    pub(super) control: bool,
    /// Alt or the system key.
    pub(super) other: bool,
}
