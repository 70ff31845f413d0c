//! The panels by the names a screen reader says.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gelatin::app::frame_meter::DrawingCost;
use gelatin::app::theme;
use gelatin::app::ui::{Running, Shown, UiState, panels_ui};
use gelatin::geometry::Watch;
use gelatin::scene::edit::Edit;
use gelatin::scene::{ColorBy, Scene, presets};
use gelatin::session::progress::Progress;
use gelatin::session::{Command, Status};
use gelatin::view::Colormap;

/// The state that the panels show, and the commands they gave.
struct Stage {
    status: Status,
    scene: Scene,
    failure: String,
    opening: Option<Progress>,
    making: Option<Progress>,
    ui: UiState,
    commands: Vec<Command>,
}

fn stage() -> Stage {
    let status = Status {
        title: "cube-on-plane".into(),
        playing: true,
        time_secs: 1.5,
        speed: 1.0,
        real_time_factor: 0.25,
        limited_by: "4 times slower than real time: limited by shear stiffness".into(),
        dt_secs: 0.001,
        dt_safe_secs: 0.003_4,
        dt_limited_by: "shear stiffness".into(),
        substeps: 1,
        particles: 1000,
        links: 12_876,
        ..Status::default()
    };
    let ui = UiState::new(presets::presets());
    Stage {
        status,
        scene: Scene::default(),
        failure: String::new(),
        opening: None,
        making: None,
        ui,
        commands: Vec::new(),
    }
}

fn show(stage: Stage) -> Harness<'static, Stage> {
    show_at(stage, [1280.0, 800.0])
}

fn show_at(stage: Stage, size: [f32; 2]) -> Harness<'static, Stage> {
    let mut harness = Harness::builder().with_size(size).build_ui_state(
        |ui, stage: &mut Stage| {
            theme::apply(ui.ctx());
            let color_key = Some((Colormap::default(), [0.0, 12.4]));
            let running = Running { status: &stage.status, scene: &stage.scene, color_key, is_painted: false };
            let shown = Shown {
                running: Some(running),
                failure: &stage.failure,
                value: "",
                opening: stage.opening.as_ref(),
                making: stage.making.as_ref(),
                drawing: DrawingCost::default(),
            };
            panels_ui(ui, &shown, &mut stage.ui, &mut stage.commands);
        },
        stage,
    );
    harness.run_steps(3);
    harness
}

/// The commands from a click on the control called `label`.
fn click(harness: &mut Harness<'_, Stage>, label: &str) -> Vec<Command> {
    harness.get_by_label(label).click();
    harness.run_steps(3);
    std::mem::take(&mut harness.state_mut().commands)
}

#[test]
fn a_scene_that_takes_long_to_open_can_be_stopped() {
    let mut window = show(stage());
    assert!(window.query_by_label("Stop").is_none(), "nothing is opened");
    window.state_mut().opening = Some(Progress::default());
    window.run_steps(3);
    window.get_by_label("Opening the scene");
    window.get_by_label("Stop").click();
    window.run_steps(2);
    assert!(window.state().opening.as_ref().is_some_and(Progress::is_cancelled), "it is no longer wanted");
}

#[test]
fn bodies_that_take_long_to_make_are_told_of_and_can_be_stopped() {
    let mut window = show(stage());
    let progress = Progress::default();
    window.state_mut().making = Some(Progress::default());
    window.run_steps(3);
    window.get_by_label("Changing the scene");
    progress.expect_particles(8_000_000);
    window.state_mut().making = Some(progress);
    window.run_steps(3);
    window.get_by_label("Making 8\u{2009}000\u{2009}000 particles");
    window.get_by_label("Stop").click();
    window.run_steps(2);
    assert!(window.state().making.as_ref().is_some_and(Progress::is_cancelled), "it is no longer wanted");
}

#[test]
fn the_buttons_of_time_send_their_commands() {
    let mut harness = show(stage());
    assert!(matches!(click(&mut harness, "Pause")[..], [Command::Pause]));
    assert!(matches!(click(&mut harness, "One step")[..], [Command::StepOnce]));
    assert!(matches!(click(&mut harness, "Restart")[..], [Command::Restart]));
    harness.state_mut().status.playing = false;
    harness.run_steps(2);
    assert!(matches!(click(&mut harness, "Play")[..], [Command::Play]));
}

#[test]
fn a_preset_is_chosen_from_the_list() {
    let mut harness = show(stage());
    click(&mut harness, "Scene");
    let commands = click(&mut harness, "incline-slide");
    let [Command::Replace { scene, title, .. }] = &commands[..] else { panic!("one new scene, not {commands:?}") };
    assert_eq!(title, "incline-slide");
    assert_eq!(**scene, (presets::preset("incline-slide").expect("a preset").build)());
}

#[test]
fn the_list_of_scenes_shows_all_of_them() {
    let mut harness = show(stage());
    click(&mut harness, "Scene");
    let last = presets::presets().last().expect("presets").name;
    // A click at its place reaches only a visible control.
    let commands = click(&mut harness, last);
    assert!(matches!(&commands[..], [Command::Replace { title, .. }] if title == last), "{commands:?}");
}

#[test]
fn a_list_closes_when_an_entry_is_chosen_by_key() {
    for (list, entry) in [("Scene", "incline-slide"), ("Speed", "0.5×"), ("Colour by", "strain, %")] {
        let mut harness = show(stage());
        click(&mut harness, list);
        harness.get_by_label(entry).focus();
        harness.run_steps(2);
        harness.key_press(egui::Key::Enter);
        harness.run_steps(3);
        let chosen = std::mem::take(&mut harness.state_mut().commands);
        assert_eq!(chosen.len(), 1, "{list}: {chosen:?}");
        assert!(harness.query_by_label(entry).is_none(), "{list} is closed");
    }
}

#[test]
fn an_entry_of_a_menu_chosen_by_key_closes_it() {
    let mut stage = stage();
    stage.status.undo = "structural stiffness".into();
    let mut harness = show(stage);
    click(&mut harness, "Edit");
    harness.get_by_label("Undo structural stiffness").focus();
    harness.run_steps(2);
    harness.key_press(egui::Key::Enter);
    harness.run_steps(3);
    assert!(matches!(harness.state().commands[..], [Command::Undo]), "{:?}", harness.state().commands);
    assert!(harness.query_by_label("Undo structural stiffness").is_none(), "the menu is closed");
}

#[test]
fn all_of_the_list_of_keys_can_be_read_in_a_window_of_any_size() {
    for size in [[760.0, 420.0], [900.0, 600.0], [1280.0, 800.0]] {
        let mut stage = stage();
        stage.ui.keys_open = true;
        let mut harness = show_at(stage, size);
        let window = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        for words in
            ["play, pause", "redo; also", "with a brush", "the model's own colours", "put back what", "this list"]
        {
            harness.get_by_label_contains(words).scroll_to_me();
            harness.run_steps(30);
            let place = harness.get_by_label_contains(words).rect();
            assert!(window.contains_rect(place), "{words} at {place} in {size:?}");
        }
    }
}

#[test]
fn a_speed_is_chosen_from_the_list() {
    let mut harness = show(stage());
    click(&mut harness, "Speed");
    let commands = click(&mut harness, "0.5×");
    assert!(matches!(commands[..], [Command::SetSpeed(speed)] if (speed - 0.5).abs() < 1e-12), "{commands:?}");
}

#[test]
fn a_scalar_is_chosen_and_gets_a_legend() {
    let mut harness = show(stage());
    click(&mut harness, "Colour by");
    let commands = click(&mut harness, "strain, %");
    let [Command::Edit(Edit::View(view))] = &commands[..] else { panic!("one edit, not {commands:?}") };
    assert_eq!(view.color, ColorBy::Strain);
    assert!(harness.query_by_label_contains("Legend").is_none(), "the jelly's own colour needs none");
    harness.state_mut().scene.view.color = ColorBy::Load;
    harness.run_steps(2);
    harness.get_by_label_contains("Legend: load, N from 0.000 to 12.400");
}

#[test]
fn the_models_own_colours_are_chosen_and_have_no_legend() {
    let mut harness = show(stage());
    click(&mut harness, "Colour by");
    let commands = click(&mut harness, "the model's own colours");
    let [Command::Edit(Edit::View(view))] = &commands[..] else { panic!("one edit, not {commands:?}") };
    assert_eq!(view.color, ColorBy::Model);
    let none = "No model here has colours in its file";
    assert!(harness.query_by_label(none).is_none(), "nobody has asked");
    harness.state_mut().scene.view.color = ColorBy::Model;
    harness.run_steps(2);
    harness.get_by_label(none);
    assert!(harness.query_by_label_contains("Legend").is_none(), "there is no scale");
}

#[test]
fn a_fixed_range_does_not_outlive_its_scalar() {
    let mut stage = stage();
    stage.scene.view.color = ColorBy::Load;
    stage.scene.view.color_range = Some([0.0, 3.0]);
    let mut harness = show(stage);
    click(&mut harness, "Colour by");
    let commands = click(&mut harness, "speed, m/s");
    let [Command::Edit(Edit::View(view))] = &commands[..] else { panic!("one edit, not {commands:?}") };
    assert_eq!(view.color_range, None, "3 N are not 3 m/s");
}

#[test]
fn the_numbers_have_units_and_the_words_say_what_limits() {
    let harness = show(stage());
    for label in ["1.500 s", "0.25×", "1.00 ms", "3.40 ms", "12\u{2009}876"] {
        harness.get_by_label(label);
    }
    harness.get_by_label("4 times slower than real time: limited by shear stiffness");
}

#[test]
fn the_list_of_keys_opens_and_closes() {
    let mut harness = show(stage());
    assert!(harness.query_by_label("play, pause").is_none(), "closed at first");
    click(&mut harness, "Keys");
    harness.get_by_label("play, pause");
    harness.state_mut().ui.keys_open = false;
    harness.run_steps(2);
    assert!(harness.query_by_label("play, pause").is_none(), "closed again");
}

#[test]
fn a_message_is_shown_until_it_is_put_away_and_a_new_one_comes_back() {
    let mut stage = stage();
    stage.status.message = "the model cannot be read".into();
    let mut harness = show(stage);
    harness.get_by_label("The model cannot be read");
    click(&mut harness, "Close message");
    assert!(harness.query_by_label("The model cannot be read").is_none(), "put away");
    harness.state_mut().status.message = "something else".into();
    harness.run_steps(2);
    harness.get_by_label("Something else");
}

#[test]
fn escape_closes_one_thing_at_a_time() {
    let mut stage = stage();
    stage.status.message = "the model cannot be read".into();
    stage.ui.keys_open = true;
    let mut harness = show(stage);
    for (gone, left) in [("play, pause", Some("The model cannot be read")), ("The model cannot be read", None)] {
        harness.get_by_label(gone);
        assert!(harness.state_mut().ui.close_uppermost("the model cannot be read"), "there is something to close");
        harness.run_steps(3);
        assert!(harness.query_by_label(gone).is_none(), "{gone} is closed");
        assert!(left.is_none_or(|left| harness.query_by_label(left).is_some()), "{left:?} is not");
    }
    let ui = &mut harness.state_mut().ui;
    assert!(!ui.close_uppermost("the model cannot be read"), "then Escape is for the view");
    assert!(!ui.close_uppermost(""), "also where there is no message");
}

#[test]
fn a_failure_of_the_program_offers_a_new_start() {
    let mut stage = stage();
    stage.failure = "the simulation stopped because of an error in the program: x".into();
    let mut harness = show(stage);
    click(&mut harness, "Start the scene anew");
    assert!(harness.state().ui.revive, "a new start was asked for");
}

#[test]
fn nothing_moves_while_digits_change() {
    let place = |time_secs: f64, factor: f64| {
        let mut stage = stage();
        (stage.status.time_secs, stage.status.real_time_factor) = (time_secs, factor);
        let harness = show(stage);
        let left = |label: &str| harness.get_by_label(label).rect().left();
        (left("real time"), left("4 times slower than real time: limited by shear stiffness"))
    };
    assert_eq!(place(1.111, 0.11), place(188.888, 8.88));
}

#[test]
fn the_panels_keep_inside_the_window_and_leave_the_view_free() {
    for size in [[760.0, 420.0], [900.0, 600.0], [1280.0, 800.0], [1920.0, 1080.0]] {
        let mut stage = stage();
        stage.status.title = "a scene file with a rather long name indeed.ron".into();
        (stage.status.time_secs, stage.status.links) = (999.999, 999_999);
        let harness = show_at(stage, size);
        let view = harness.state().ui.view_rect;
        assert!(view.width() >= 0.5 * size[0] && view.height() >= size[1] - 110.0, "{size:?}: the view is {view}");
        let labels = ["File", "Scene", "Speed", "real time", "Restart", "999.999 s", "Colour by"];
        let rects: Vec<_> = labels.map(|label| (label, first_rect(&harness, label))).into();
        for (label, rect) in &rects {
            let inside = rect.left() >= 0.0 && rect.right() <= size[0] && rect.top() >= 0.0 && rect.bottom() <= size[1];
            assert!(inside, "{label} at {rect} leaves a window of {size:?}");
        }
        for (index, (label, rect)) in rects.iter().enumerate() {
            for (other, over) in &rects[index + 1..] {
                assert!(!rect.shrink(0.5).intersects(over.shrink(0.5)), "{label} lies over {other} at {size:?}");
            }
        }
    }
}

fn first_rect(harness: &Harness<'_, Stage>, label: &str) -> egui::Rect {
    harness.query_all_by_label(label).next().unwrap_or_else(|| panic!("{label} is there")).rect()
}
