//! What the presets promise, run for eight simulated seconds. The three expensive ones (coupler-20, coupler-40, spot) are
//! left out for time; `gelatin run NAME --seconds 8` shows the same figures for them.

use std::path::PathBuf;

use gelatin::scene::presets::{preset, presets};
use gelatin::session::Session;
use gelatin::session::run::{RunFigures, run};

/// Speed below which a body counts as at rest, m/s.
const AT_REST: f64 = 5e-3;

fn after_eight_seconds(name: &str) -> RunFigures {
    let preset = preset(name).expect("a preset of this name");
    let mut session = Session::new((preset.build)(), PathBuf::new(), name.to_owned()).expect("presets resolve");
    run(&mut session, 8.0, &())
}

fn is_sound(figures: &RunFigures) {
    let name = &figures.scene;
    assert!(figures.finite, "{name} is finite");
    assert_eq!(figures.inverted_cells, 0, "{name} has no inverted cells");
    let size = 1.0;
    assert!(figures.max_penetration_m <= 0.02 * size, "{name} is {} m deep", figures.max_penetration_m);
}

#[test]
fn what_should_rest_rests() {
    for name in ["cube-on-plane", "incline", "tree", "coupler-7", "coupler-8"] {
        let figures = after_eight_seconds(name);
        is_sound(&figures);
        assert!(figures.max_speed < AT_REST, "{name} moves at {} m/s", figures.max_speed);
    }
}

#[test]
fn the_cube_turns_and_falls_off_the_sphere() {
    for name in ["cube-on-sphere", "u-on-sphere"] {
        let figures = after_eight_seconds(name);
        is_sound(&figures);
        let [x, y, z] = figures.center;
        assert!(x.hypot(z) > 0.5 && y < 0.7, "{name} lies beside the sphere: {:?}", figures.center);
    }
}

#[test]
fn the_steep_incline_slides() {
    let figures = after_eight_seconds("incline-slide");
    is_sound(&figures);
    assert!(figures.start.energy_joule.gravity - figures.energy_joule.gravity > 10.0, "it came down");
}

#[test]
fn every_preset_is_there() {
    let names: Vec<&str> = presets().iter().map(|preset| preset.name).collect();
    let wanted = "cube-on-plane cube-on-sphere incline incline-slide u-on-sphere tree coupler-7 coupler-8 coupler-20 \
                  coupler-40 spot exploding broken";
    assert_eq!(names, wanted.split_whitespace().collect::<Vec<_>>(), "in the order of the list");
}
