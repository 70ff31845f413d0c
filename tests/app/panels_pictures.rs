//! Pictures of the panels: controls that exist by name are visible, too, in both themes.

use egui::Rect;
use gelatin::app::theme::Theme;
use image::RgbaImage;

use crate::live::Window;

/// A picture of the panels with the jelly chosen.
fn picture(theme: Theme) -> (Window, RgbaImage) {
    let mut window = Window::sized("cube-on-plane", [1280.0, 800.0], theme);
    window.click("Jelly");
    let picture = window.harness.render().expect("the panels can be drawn");
    (window, picture)
}

/// The pixels of a part, as red, green and blue.
fn pixels(picture: &RgbaImage, part: Rect) -> Vec<[u8; 3]> {
    let inside = |x: u32, y: u32| part.contains(egui::pos2(x as f32 + 0.5, y as f32 + 0.5));
    let pixels = picture.enumerate_pixels().filter(|(x, y, _)| inside(*x, *y));
    pixels.map(|(_, _, pixel)| [pixel[0], pixel[1], pixel[2]]).collect()
}

fn lightness([red, green, blue]: [u8; 3]) -> f32 {
    (f32::from(red) + f32::from(green) + f32::from(blue)) / 765.0
}

/// The difference in lightness between the lightest and the darkest pixel.
fn contrast(pixels: &[[u8; 3]]) -> f32 {
    let all = || pixels.iter().copied().map(lightness);
    all().fold(0.0, f32::max) - all().fold(1.0, f32::min)
}

fn is_accent([red, green, blue]: [u8; 3]) -> bool {
    i32::from(blue) > i32::from(red) + 40 && blue > green
}

#[test]
fn every_value_can_be_read_and_every_track_shows_how_full_it_is() {
    for theme in [Theme::Dark, Theme::Light] {
        let (window, picture) = picture(theme);
        for name in ["Structural stiffness", "Shear damping", "Particle mass"] {
            let track = pixels(&picture, window.rect(&format!("{name} slider")));
            let filled = track.iter().filter(|pixel| is_accent(**pixel)).count();
            assert!(filled > 60, "{theme:?}: the track of {name} has {filled} pixels in the accent");
            let number = pixels(&picture, window.rect(name));
            assert!(contrast(&number) > 0.4, "{theme:?}: {name} stands out by {}", contrast(&number));
        }
    }
}

#[test]
fn the_themes_are_dark_and_light_and_what_is_chosen_is_marked() {
    let mean = |pixels: Vec<[u8; 3]>| pixels.iter().copied().map(lightness).sum::<f32>() / pixels.len() as f32;
    for (theme, range) in [(Theme::Dark, 0.05..0.3), (Theme::Light, 0.75..1.0)] {
        let (window, picture) = picture(theme);
        let panel = mean(pixels(&picture, Rect::from_min_max(egui::pos2(960.0, 60.0), egui::pos2(1270.0, 740.0))));
        assert!(range.contains(&panel), "{theme:?}: the panel's lightness is {panel}");
        let row = |name: &str| pixels(&picture, window.rect(name)).into_iter().filter(|p| is_accent(*p)).count();
        assert!(row("Jelly") > 500, "{theme:?}: the row of what is chosen has {} pixels in the accent", row("Jelly"));
        assert!(row("Ground") < 50, "{theme:?}: another row has {}", row("Ground"));
    }
}

#[test]
fn an_empty_place_is_not_taken_for_a_text_or_a_track() {
    let (_, picture) = picture(Theme::Dark);
    let empty = pixels(&picture, Rect::from_min_max(egui::pos2(20.0, 300.0), egui::pos2(120.0, 330.0)));
    assert!(contrast(&empty) < 0.05, "nothing stands out where nothing is: {}", contrast(&empty));
    assert!(!empty.into_iter().any(is_accent), "and nothing is in the accent");
}
