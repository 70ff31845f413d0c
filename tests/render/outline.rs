//! The outline of the selected thing surrounds its silhouette and covers none of it.

use gelatin::math::color::srgb_from_linear;
use gelatin::render::Quality;
use gelatin::view::{Camera, DrawList, Image, Selected, Solid};
use glam::{Vec2, Vec3};

use crate::gpu::Studio;
use crate::scenes::{camera, cube};

const SIZE: [u32; 2] = [240, 240];

fn studios() -> [Studio; 2] {
    [Quality::Fine, Quality::Quick].map(Studio::of)
}

fn seen(camera: &Camera, point: Vec3) -> Vec2 {
    camera.pixel_of(point, Vec2::new(SIZE[0] as f32, SIZE[1] as f32)).unwrap()
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place within the picture")]
fn pixel(image: &Image, at: Vec2) -> [u8; 3] {
    let [r, g, b, _] = image.pixel([at.x as u32, at.y as u32]).unwrap();
    [r, g, b]
}

fn is_accent(scene: &DrawList, color: [u8; 3]) -> bool {
    let accent = srgb_from_linear(scene.style.overlay.accent);
    accent.iter().zip(color).all(|(a, b)| a.abs_diff(b) <= 12)
}

/// Checks pixels across a silhouette: `edge` is a point of it, `outward` points away from it, both in pixels.
fn check(before: &Image, after: &Image, scene: &DrawList, edge: Vec2, outward: Vec2, what: &str) {
    let at = |off: f32| edge + outward * off;
    assert!(is_accent(scene, pixel(after, at(1.4))), "{what}: just outside {:?}", pixel(after, at(1.4)));
    for off in [-9.0, -2.0, 5.0, 12.0] {
        assert_eq!(pixel(after, at(off)), pixel(before, at(off)), "{what}: {off} pixels outward nothing changes");
    }
}

#[test]
fn the_outline_of_a_body_runs_around_it() {
    for mut studio in studios() {
        let mut scene = cube();
        let before = studio.picture(&scene, SIZE);
        scene.selected = Some(Selected::Skin(0));
        let after = studio.picture(&scene, SIZE);
        // The front face is the silhouette of a cube seen from straight ahead.
        for (middle, outward) in
            [(Vec3::NEG_X, Vec2::NEG_X), (Vec3::X, Vec2::X), (Vec3::Y, Vec2::NEG_Y), (Vec3::NEG_Y, Vec2::Y)]
        {
            let edge = seen(&scene.camera, Vec3::new(0.0, 0.5, 0.5) + middle * 0.5);
            check(&before, &after, &scene, edge, outward, "a side of a cube");
        }
        let corner = seen(&scene.camera, Vec3::new(0.5, 1.0, 0.5));
        let around = corner + Vec2::new(1.2, -1.2);
        assert!(is_accent(&scene, pixel(&after, around)), "around the corner: {:?}", pixel(&after, around));
    }
}

#[test]
fn the_outline_of_a_sphere_runs_around_it_at_any_distance() {
    for mut studio in studios() {
        for (distance, radius) in [(0.9, 0.25), (4.0, 0.7), (90.0, 10.0)] {
            let center = Vec3::new(0.2, 3.0, -0.4);
            let eye = center + Vec3::new(0.3, 0.2, 1.0).normalize() * distance;
            let mut scene = DrawList {
                camera: Camera { eye, target: center, ..camera() },
                solids: vec![Solid::Sphere { center, radius }],
                ..DrawList::default()
            };
            let before = studio.picture(&scene, SIZE);
            scene.selected = Some(Selected::Solid(0));
            let after = studio.picture(&scene, SIZE);
            let (u, v) = (scene.camera.right(), scene.camera.upward());
            let inward = (radius / distance).asin();
            for step in 0..16_u8 {
                let (sin, cos) = (f32::from(step) * std::f32::consts::TAU / 16.0).sin_cos();
                let side = u * cos + v * sin;
                let touch = eye + scene.camera.forward() * inward.cos() + side * inward.sin();
                let edge = seen(&scene.camera, touch);
                check(&before, &after, &scene, edge, Vec2::new(cos, -sin), &format!("{radius} m, step {step}"));
            }
        }
    }
}

#[test]
fn the_outline_of_a_plane_follows_its_edge() {
    for mut studio in studios() {
        let plane = Solid::Plane { center: Vec3::Y * 0.5, axes: [Vec3::X, Vec3::Y], half_extents: [0.6, 0.4] };
        let mut scene = DrawList { camera: camera(), solids: vec![plane], ..DrawList::default() };
        scene.style.shadow_opacity = 0.0;
        let before = studio.picture(&scene, SIZE);
        scene.selected = Some(Selected::Solid(0));
        let after = studio.picture(&scene, SIZE);
        for (edge, outward) in [(Vec3::new(0.6, 0.55, 0.0), Vec2::X), (Vec3::new(0.1, 0.9, 0.0), Vec2::NEG_Y)] {
            check(&before, &after, &scene, seen(&scene.camera, edge), outward, "a plane");
        }
    }
}

#[test]
fn an_outline_behind_another_thing_fades() {
    let mut studio = Studio::new();
    let mut scene = cube();
    let screen = Solid::Plane { center: Vec3::new(-1.0, 0.5, 2.0), axes: [Vec3::X, Vec3::Y], half_extents: [1.0, 1.0] };
    scene.solids = vec![screen];
    let before = studio.picture(&scene, SIZE);
    scene.selected = Some(Selected::Skin(0));
    let after = studio.picture(&scene, SIZE);
    let at = seen(&scene.camera, Vec3::new(-0.5, 0.6, 0.5)) - Vec2::X * 1.5;
    let (faded, gone) = (pixel(&after, at), pixel(&before, at));
    assert!(faded != gone && !is_accent(&scene, faded), "behind a screen, faded: {faded:?} where {gone:?} was");
}

#[test]
fn what_is_not_there_has_no_outline() {
    let mut studio = Studio::new();
    let mut scene = cube();
    let before = studio.picture(&scene, SIZE);
    for selected in [Selected::Skin(1), Selected::Solid(0)] {
        scene.selected = Some(selected);
        assert!(studio.picture(&scene, SIZE) == before, "{selected:?} is not in the picture");
    }
}

#[test]
#[should_panic(expected = "just outside")]
fn the_check_sees_a_missing_outline() {
    let mut studio = Studio::new();
    let scene = cube();
    let picture = studio.picture(&scene, SIZE);
    check(&picture, &picture, &scene, seen(&scene.camera, Vec3::new(0.5, 0.5, 0.5)), Vec2::X, "no outline");
}
