//! The meaning of pointer and keyboard events, without a window.

use gelatin::app::input::{
    Action, Button, CameraMove, ChosenAction, Event, Input, Key, Keyboard, Panel, Situation, ViewRect, move_camera,
};
use gelatin::scene::ColorBy;
use gelatin::session::Command;
use gelatin::view::Orbit;
use glam::Vec2;

const OVER_VIEW: Situation = Situation {
    over_view: true,
    dialog_open: false,
    keyboard: Keyboard::View,
    holdable: false,
    brushable: false,
    playing: false,
    scale: 1.0,
};
const OVER_PANEL: Situation = Situation { over_view: false, ..OVER_VIEW };
const SHIFT: Event = Event::Modifiers { shift: true, control: false, other: false };

/// The moves of the camera that a run of events asks for.
fn moves(events: &[Event], situation: Situation) -> Vec<CameraMove> {
    let mut input = Input::default();
    let actions = events.iter().filter_map(|&event| input.on_event(event, situation));
    actions.filter_map(|action| if let Action::Camera(camera) = action { Some(camera) } else { None }).collect()
}

fn drag(button: Button) -> [Event; 4] {
    [
        Event::PointerMoved(Vec2::new(100.0, 100.0)),
        Event::Button { button, pressed: true },
        Event::PointerMoved(Vec2::new(110.0, 100.0)),
        Event::Button { button, pressed: false },
    ]
}

fn key(key: Key, situation: Situation) -> Option<Action> {
    Input::default().on_event(Event::Key { key, repeat: false }, situation)
}

#[test]
fn dragging_turns_the_eye_with_the_middle_or_the_left_button() {
    for button in [Button::Middle, Button::Primary] {
        let moves = moves(&drag(button), OVER_VIEW);
        let turned = matches!(moves[..], [CameraMove::Orbit { yaw_rad, pitch_rad: 0.0 }] if yaw_rad < 0.0);
        assert!(turned, "{button:?}: {moves:?}");
    }
}

#[test]
fn dragging_pans_with_shift_or_the_right_button() {
    let shifted = |button| [&[SHIFT][..], &drag(button)].concat();
    for events in [shifted(Button::Middle), shifted(Button::Primary), drag(Button::Secondary).to_vec()] {
        assert_eq!(moves(&events, OVER_VIEW), [CameraMove::Pan(Vec2::new(10.0, 0.0))], "{events:?}");
    }
}

#[test]
fn a_pointer_over_a_panel_never_moves_the_camera() {
    for button in [Button::Middle, Button::Primary, Button::Secondary] {
        assert_eq!(moves(&drag(button), OVER_PANEL), [], "{button:?}");
    }
    for event in [Event::Wheel(1.0), Event::Scroll(Vec2::ONE), Event::Pinch(0.1)] {
        assert_eq!(moves(&[event], OVER_PANEL), [], "{event:?}");
    }
}

#[test]
fn a_drag_that_began_in_the_view_goes_on_over_a_panel() {
    let mut input = Input::default();
    for event in &drag(Button::Middle)[..3] {
        input.on_event(*event, OVER_VIEW);
    }
    let moved = input.on_event(Event::PointerMoved(Vec2::new(300.0, 10.0)), OVER_PANEL);
    assert!(matches!(moved, Some(Action::Camera(CameraMove::Orbit { .. }))), "{moved:?}");
}

#[test]
fn a_drag_ends_when_the_window_loses_the_keyboard() {
    let mut events = drag(Button::Middle).to_vec();
    events.insert(2, Event::FocusLost);
    assert_eq!(moves(&events, OVER_VIEW), []);
}

#[test]
fn the_wheel_keeps_what_is_under_the_pointer() {
    let view = ViewRect { origin: Vec2::new(0.0, 40.0), size: Vec2::new(900.0, 500.0) };
    let at = Vec2::new(600.0, 200.0);
    let mut orbit = Orbit::default();
    let ray = orbit.camera().ray_through(at - view.origin, view.size);
    let point = ray.at(ray.hit_plane(orbit.target, orbit.camera().forward()).expect("the plane lies ahead"));
    for camera in moves(&[Event::PointerMoved(at), Event::Wheel(3.0)], OVER_VIEW) {
        move_camera(&mut orbit, camera, view);
    }
    assert!(orbit.distance < Orbit::default().distance, "the wheel goes nearer");
    let seen = orbit.camera().pixel_of(point, view.size).expect("the point lies ahead") + view.origin;
    assert!(seen.distance(at) < 0.5, "the point under the pointer stays there: {seen} is not {at}");
}

#[test]
fn two_fingers_turn_pan_with_shift_and_zoom_with_control() {
    let scroll = Event::Scroll(Vec2::new(0.0, 10.0));
    let control = Event::Modifiers { shift: false, control: true, other: false };
    assert!(matches!(moves(&[scroll], OVER_VIEW)[..], [CameraMove::Orbit { .. }]));
    assert!(matches!(moves(&[SHIFT, scroll], OVER_VIEW)[..], [CameraMove::Pan(_)]));
    assert!(matches!(moves(&[control, scroll], OVER_VIEW)[..], [CameraMove::Zoom { .. }]));
    assert!(matches!(moves(&[Event::Pinch(0.2)], OVER_VIEW)[..], [CameraMove::Zoom { factor, .. }] if factor < 1.0));
}

#[test]
fn a_view_of_no_size_swallows_every_move() {
    let mut orbit = Orbit::default();
    for camera in [CameraMove::Zoom { factor: 0.5, at: Vec2::ZERO }, CameraMove::Pan(Vec2::ONE), CameraMove::Frame] {
        move_camera(&mut orbit, camera, ViewRect::default());
    }
    assert!(orbit.camera().eye.is_finite(), "{orbit:?}");
}

#[test]
fn space_plays_and_pauses() {
    let playing = Situation { playing: true, ..OVER_VIEW };
    assert!(matches!(key(Key::Space, OVER_VIEW), Some(Action::Send(Command::Play))));
    assert!(matches!(key(Key::Space, playing), Some(Action::Send(Command::Pause))));
}

#[test]
fn every_key_does_what_the_list_of_keys_says() {
    assert!(matches!(key(Key::Right, OVER_VIEW), Some(Action::Send(Command::StepOnce))));
    assert!(matches!(key(Key::Char('.'), OVER_VIEW), Some(Action::Send(Command::StepOnce))));
    assert!(matches!(key(Key::Char('r'), OVER_VIEW), Some(Action::Send(Command::Restart))));
    assert!(matches!(key(Key::Char('f'), OVER_VIEW), Some(Action::Camera(CameraMove::Frame))));
    assert!(matches!(key(Key::Char('1'), OVER_VIEW), Some(Action::ColorBy(ColorBy::Plain))));
    assert!(matches!(key(Key::Char('7'), OVER_VIEW), Some(Action::ColorBy(ColorBy::Contact))));
    assert!(matches!(key(Key::Char('8'), OVER_VIEW), Some(Action::ColorBy(ColorBy::Model))));
    assert!(matches!(key(Key::Char('9'), OVER_VIEW), Some(Action::ColorBy(ColorBy::Stiffness))));
    assert!(matches!(key(Key::F1, OVER_VIEW), Some(Action::ToggleKeys)));
    for (letter, action) in [('x', ChosenAction::Delete), ('h', ChosenAction::Hide)] {
        let asked = key(Key::Char(letter), OVER_VIEW);
        assert!(matches!(asked, Some(Action::Chosen(chosen)) if chosen == action), "{letter}: {asked:?}");
    }
    assert!(matches!(key(Key::Delete, OVER_VIEW), Some(Action::Chosen(ChosenAction::Delete))));
    assert!(matches!(key(Key::F2, OVER_VIEW), Some(Action::Chosen(ChosenAction::Rename))));
    assert!(matches!(key(Key::Home, OVER_VIEW), Some(Action::Camera(CameraMove::FrameAll))));
    assert!(matches!(key(Key::Char('t'), OVER_VIEW), Some(Action::TogglePanel(Panel::Tree))));
    assert!(matches!(key(Key::Char('n'), OVER_VIEW), Some(Action::TogglePanel(Panel::Inspector))));
    assert!(matches!(key(Key::Char('e'), OVER_VIEW), Some(Action::TogglePanel(Panel::Error))));
    assert!(matches!(key(Key::Char('m'), OVER_VIEW), Some(Action::TogglePanel(Panel::Stability))));
    assert!(matches!(key(Key::Char('v'), OVER_VIEW), Some(Action::TogglePanel(Panel::Modes))));
    for unused in ['0', 'q'] {
        assert!(key(Key::Char(unused), OVER_VIEW).is_none(), "{unused}");
    }
}

#[test]
fn typing_into_a_field_does_not_drive_the_sandbox() {
    let typing = Situation { keyboard: Keyboard::Text, ..OVER_VIEW };
    for typed in [Key::Space, Key::Right, Key::Char('r'), Key::Char('3')] {
        assert!(key(typed, typing).is_none(), "{typed:?}");
    }
    assert!(matches!(key(Key::F1, typing), Some(Action::ToggleKeys)), "help is always there");
}

#[test]
fn a_button_that_has_the_keyboard_leaves_letters_and_digits_to_the_view() {
    let button = Situation { keyboard: Keyboard::Widget, ..OVER_VIEW };
    assert!(matches!(key(Key::Char('m'), button), Some(Action::TogglePanel(Panel::Stability))));
    assert!(matches!(key(Key::Char('2'), button), Some(Action::ColorBy(ColorBy::Load))));
    assert!(matches!(key(Key::Char('.'), button), Some(Action::Send(Command::StepOnce))));
    assert!(matches!(key(Key::Delete, button), Some(Action::Chosen(ChosenAction::Delete))));
    for own in [Key::Space, Key::Right, Key::Escape] {
        assert!(key(own, button).is_none(), "{own:?} presses, steps or leaves it");
    }
}

#[test]
fn holding_a_key_repeats_steps_and_nothing_else() {
    let held = |key| Input::default().on_event(Event::Key { key, repeat: true }, OVER_VIEW);
    assert!(matches!(held(Key::Char('.')), Some(Action::Send(Command::StepOnce))));
    assert!(held(Key::Space).is_none(), "play and pause do not flicker");
    assert!(held(Key::Char('r')).is_none());
}

/// Everything that a run of events asks for, in short.
fn asked(events: &[Event], situation: Situation) -> Vec<String> {
    let mut input = Input::default();
    let actions = events.iter().filter_map(|&event| input.on_event(event, situation));
    actions
        .map(|action| match action {
            Action::Choose(at) => format!("choose at {}", at.x),
            Action::Take(at) => format!("take at {}", at.x),
            Action::Drag(at) => format!("drag to {}", at.x),
            Action::Release => "release".to_owned(),
            Action::Brush { pixel, inverted } => {
                format!("{} at {}", if inverted { "brush back" } else { "brush" }, pixel.x)
            }
            Action::LiftBrush => "lift".to_owned(),
            Action::Camera(_) => "camera".to_owned(),
            other => format!("{other:?}"),
        })
        .collect()
}

fn at(x: f32) -> Event {
    Event::PointerMoved(Vec2::new(x, 0.0))
}

const DOWN: Event = Event::Button { button: Button::Primary, pressed: true };
const UP: Event = Event::Button { button: Button::Primary, pressed: false };
const OVER_JELLY: Situation = Situation { holdable: true, ..OVER_VIEW };

#[test]
fn a_click_chooses_and_a_trembling_one_too() {
    assert_eq!(asked(&[at(50.0), DOWN, UP], OVER_JELLY), ["choose at 50"]);
    assert_eq!(asked(&[at(50.0), DOWN, at(52.0), UP], OVER_JELLY), ["choose at 50"]);
    assert_eq!(
        asked(&[at(50.0), DOWN, UP], OVER_VIEW),
        ["choose at 50"],
        "empty ground chooses nothing, by a click too"
    );
    assert_eq!(asked(&[at(50.0), DOWN, UP], OVER_PANEL), [""; 0], "a click on a panel is the panel's");
}

#[test]
fn a_drag_holds_what_can_be_held_and_turns_the_eye_elsewhere() {
    let drag = [at(50.0), DOWN, at(60.0), at(70.0), UP];
    assert_eq!(asked(&drag, OVER_JELLY), ["take at 50", "drag to 70", "release"]);
    assert_eq!(asked(&drag, OVER_VIEW), ["camera", "camera"]);
    let shifted = [&[SHIFT][..], &drag].concat();
    assert_eq!(asked(&shifted, OVER_JELLY), ["camera", "camera"], "shift pans, whatever lies there");
}

#[test]
fn a_brush_draws_from_the_press_on_and_control_turns_it_round() {
    let over = Situation { brushable: true, ..OVER_JELLY };
    assert_eq!(asked(&[at(50.0), DOWN, UP], over), ["brush at 50", "lift"], "a click is a stroke, and chooses nothing");
    assert_eq!(
        asked(&[at(50.0), DOWN, at(52.0), at(70.0), UP], over),
        ["brush at 50", "brush at 52", "brush at 70", "lift"]
    );
    let control = Event::Modifiers { shift: false, control: true, other: false };
    assert_eq!(asked(&[at(50.0), control, DOWN, at(60.0), UP], over), ["brush back at 50", "brush back at 60", "lift"]);
    let shifted = [SHIFT, at(50.0), DOWN, at(60.0), UP];
    assert_eq!(asked(&shifted, over), ["camera"], "shift pans, whatever is in the hand");
    assert_eq!(asked(&[at(50.0), DOWN, Event::FocusLost, UP], over), ["brush at 50", "lift"]);
}

#[test]
fn a_window_that_loses_the_keyboard_lets_go() {
    let lost = [at(50.0), DOWN, at(60.0), Event::FocusLost, at(70.0), UP];
    assert_eq!(asked(&lost, OVER_JELLY), ["take at 50", "release"]);
}

#[test]
fn control_and_z_take_back_but_not_while_typing() {
    let control = |shift| Event::Modifiers { shift, control: true, other: false };
    let press = |key| Event::Key { key: Key::Char(key), repeat: false };
    assert_eq!(asked(&[control(false), press('z')], OVER_VIEW), ["Send(Undo)"]);
    assert_eq!(asked(&[control(true), press('z')], OVER_VIEW), ["Send(Redo)"]);
    assert_eq!(asked(&[control(false), press('y')], OVER_VIEW), ["Send(Redo)"]);
    let typing = Situation { keyboard: Keyboard::Text, ..OVER_VIEW };
    assert_eq!(asked(&[control(false), press('z')], typing), [""; 0], "a text field has its own");
    let slider = Situation { keyboard: Keyboard::Widget, ..OVER_VIEW };
    assert_eq!(asked(&[control(false), press('z')], slider), ["Send(Undo)"], "a slider has none");
}

const DIALOG: Situation = Situation { dialog_open: true, ..OVER_VIEW };

#[test]
fn behind_a_dialog_nothing_hears_keys_or_clicks() {
    let named = [Key::Space, Key::Right, Key::Home, Key::Delete, Key::F1, Key::F2, Key::Escape].map(|key| (key, false));
    let letters = ('0'..='9').chain('a'..='z').chain(['.']).map(Key::Char);
    let keys: Vec<_> = named.into_iter().chain(letters.flat_map(|key| [(key, false), (key, true)])).collect();
    for (key, control) in keys {
        let events = [Event::Modifiers { shift: false, control, other: false }, Event::Key { key, repeat: false }];
        assert_eq!(asked(&events, DIALOG), [""; 0], "{key:?}, control {control}");
    }
    for button in [Button::Primary, Button::Middle, Button::Secondary] {
        assert_eq!(asked(&drag(button), DIALOG), [""; 0], "{button:?}");
    }
    for event in [Event::Wheel(1.0), Event::Scroll(Vec2::ONE), Event::Pinch(0.1)] {
        assert_eq!(asked(&[at(50.0), event], DIALOG), [""; 0], "{event:?}");
    }
    assert!(matches!(key(Key::F11, DIALOG), Some(Action::ToggleFullScreen)), "the dialog fills the screen too");
}

#[test]
fn a_click_that_closes_a_menu_is_no_click_in_the_view() {
    let mut input = Input::default();
    input.on_event(at(50.0), DIALOG);
    assert!(input.on_event(DOWN, DIALOG).is_none(), "the menu is open when the button goes down");
    assert!(input.on_event(UP, OVER_JELLY).is_none(), "and closed when it goes up");
}

#[test]
fn what_is_held_is_let_go_when_a_dialog_opens() {
    let mut input = Input::default();
    for event in [at(50.0), DOWN, at(60.0)] {
        input.on_event(event, OVER_JELLY);
    }
    assert!(matches!(input.on_event(at(70.0), DIALOG), Some(Action::Release)), "let go");
    assert!(input.on_event(at(80.0), OVER_JELLY).is_none() && !input.dragging(), "and not taken again");
}

#[test]
fn escape_ends_typing_before_it_closes_anything_else() {
    let typing = Situation { keyboard: Keyboard::Text, ..OVER_VIEW };
    assert!(key(Key::Escape, typing).is_none(), "the field hears it");
    assert!(matches!(key(Key::Escape, OVER_VIEW), Some(Action::Close)));
    assert!(matches!(key(Key::F11, typing), Some(Action::ToggleFullScreen)), "no field takes this key");
}
