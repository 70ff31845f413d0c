//! Floors: their lines end with them, cover nothing else and appear smoothly; their tone, and the shadows of touching
//! things.

use std::sync::Arc;

use gelatin::math::color::{linear_from_srgb, srgb_from_linear};
use gelatin::render::Quality;
use gelatin::view::{Camera, DrawList, Image, Light, Solid};
use glam::{Vec2, Vec3};

use crate::gpu::Studio;
use crate::scenes::{camera, cube_at};

const SIZE: [u32; 2] = [240, 240];

fn floor(half: f32) -> Solid {
    Solid::Plane { center: Vec3::ZERO, axes: [Vec3::Z, Vec3::X], half_extents: [half, half] }
}

/// Looks down at the origin from a distance.
fn looking_down(distance: f32) -> Camera {
    Camera { target: Vec3::ZERO, eye: Vec3::new(0.1, 0.5, 0.8).normalize() * distance, ..camera() }
}

/// White light from everywhere and nothing else.
fn evenly_lit(mut scene: DrawList) -> DrawList {
    scene.style.ambient = 1.0;
    scene.light = Light { color: [0.0; 3], ..Light::default() };
    scene
}

fn whole(size: [u32; 2]) -> Vec2 {
    Vec2::new(size[0] as f32, size[1] as f32)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place within the picture")]
fn pixel(image: &Image, at: Vec2) -> [u8; 3] {
    let [r, g, b, _] = image.pixel([at.x as u32, at.y as u32]).unwrap();
    [r, g, b]
}

fn seen(camera: &Camera, image: &Image, point: Vec3) -> [u8; 3] {
    pixel(image, camera.pixel_of(point, whole(image.size)).unwrap())
}

/// Pixels whose middle shows a wanted place at height 0, as (before, after).
fn on_the_ground<'a>(
    camera: &'a Camera,
    pictures: [&'a Image; 2],
    wanted: impl Fn(Vec3) -> bool + 'a,
) -> impl Iterator<Item = [[u8; 3]; 2]> + 'a {
    let pixels = (0..SIZE[0] * SIZE[1]).map(|index| Vec2::new((index % SIZE[0]) as f32, (index / SIZE[0]) as f32));
    pixels.filter_map(move |corner| {
        let ray = camera.ray_through(corner + 0.5, whole(SIZE));
        let reach = -ray.origin.y / ray.direction.y;
        (reach > 0.0 && wanted(ray.at(reach))).then(|| pictures.map(|picture| pixel(picture, corner)))
    })
}

fn apart([a, b]: [[u8; 3]; 2]) -> u8 {
    a.iter().zip(b).map(|(a, b)| a.abs_diff(b)).max().unwrap()
}

/// Pictures of a scene with the ground that scenes without a floor have, and without that ground.
fn with_and_without_ground(scene: &DrawList) -> [Image; 2] {
    let mut bare = scene.clone();
    bare.style.grid_opacity = 0.0;
    bare.style.shadow_opacity = 0.0;
    let mut loud = scene.clone();
    loud.style.grid_opacity = 1.0;
    let mut studio = Studio::new();
    [studio.picture(&loud, SIZE), studio.picture(&bare, SIZE)]
}

#[test]
fn the_grid_ends_where_the_floor_ends() {
    let camera = looking_down(8.0);
    let on = |solids| DrawList { camera, solids, ..DrawList::default() };
    let [with, without] = with_and_without_ground(&on(vec![floor(1.0)]));
    assert!(with == without, "nothing is drawn beyond the floor");
    let [with, without] = with_and_without_ground(&on(Vec::new()));
    assert!(with != without, "a scene without a floor has a ground to judge by");
}

#[test]
fn the_grid_never_draws_over_bodies_or_obstacles() {
    let camera = looking_down(8.0);
    let ball = Solid::Sphere { center: Vec3::new(1.6, -0.5, 0.0), radius: 0.6 };
    // The ball lies below the ground or passes through it.
    for height in [-1.0, 0.2] {
        let scene = DrawList { camera, solids: vec![ball.clone()], ..cube_at(Vec3::Y * height) };
        let [with, without] = with_and_without_ground(&scene);
        for middle in [Vec3::new(0.2, height, 0.1), Vec3::new(1.6, -0.5, 0.0)] {
            let at = camera.pixel_of(middle, whole(SIZE)).unwrap();
            for step in 0..100_u8 {
                let off = Vec2::new(f32::from(step % 10) - 5.0, f32::from(step / 10) - 5.0);
                assert_eq!(pixel(&with, at + off), pixel(&without, at + off), "{off} from {middle}");
            }
        }
    }
}

#[test]
fn lines_come_and_go_without_a_jump_as_the_eye_draws_back() {
    for quality in [Quality::Fine, Quality::Quick] {
        let mut studio = Studio::of(quality);
        let mut last: Option<Image> = None;
        for step in 0..20_u8 {
            let camera = looking_down(29.7 + 0.03 * f32::from(step));
            let scene = evenly_lit(DrawList { camera, solids: vec![floor(500.0)], ..DrawList::default() });
            let picture = studio.picture(&scene, SIZE);
            if let Some(last) = last {
                let worst = on_the_ground(&camera, [&last, &picture], |_| true).map(apart).max().unwrap();
                assert!(worst <= 12, "{quality:?}: a pixel changes by {worst} at step {step}");
            }
            last = Some(picture);
        }
    }
}

#[test]
fn lines_do_not_shimmer_as_the_eye_moves_along() {
    let mut studio = Studio::of(Quality::Quick);
    let mut last: Option<Image> = None;
    for step in 0..24_u8 {
        // The step is an eighth of a pixel at the point looked at.
        let along = Vec3::X * (f32::from(step) * 4.0 / 240.0 / 8.0);
        let still = looking_down(4.0);
        let camera = Camera { target: still.target + along, eye: still.eye + along, ..still };
        let mut scene = evenly_lit(DrawList { camera, solids: vec![floor(500.0)], ..DrawList::default() });
        (scene.style.plane_line, scene.style.floor, scene.style.plane_line_opacity) = ([0.0; 3], [1.0; 3], 1.0);
        let picture = studio.picture(&scene, SIZE);
        if let Some(last) = last {
            let change =
                |[before, after]: [[u8; 3]; 2]| (linear_from_srgb(before)[1] - linear_from_srgb(after)[1]).abs();
            let farther = on_the_ground(&camera, [&last, &picture], |place| place.z < 0.0);
            let worst = farther.map(change).fold(0.0, f32::max);
            assert!((0.01..0.2).contains(&worst), "black on white, a pixel changes by {worst} at step {step}");
        }
        last = Some(picture);
    }
}

#[test]
fn floors_and_other_obstacles_have_tones_of_their_own() {
    let camera = looking_down(6.0);
    let ball = Solid::Sphere { center: Vec3::new(-1.0, 0.5, 0.0), radius: 0.5 };
    let slope = Solid::Plane {
        center: Vec3::new(1.5, 0.5, 0.0),
        axes: [Vec3::Z, Vec3::new(0.8, 0.6, 0.0)],
        half_extents: [0.5; 2],
    };
    let mut scene = evenly_lit(DrawList { camera, solids: vec![floor(3.0), ball, slope], ..DrawList::default() });
    scene.style.plane_line_opacity = 0.0;
    scene.style.contact_opacity = 0.0;
    let picture = Studio::new().picture(&scene, SIZE);
    let shown = |color: [f32; 3], sky: f32| srgb_from_linear(color.map(|channel| channel * sky));
    let near = |a: [u8; 3], b: [u8; 3]| apart([a, b]) <= 3;
    let on_floor = seen(&camera, &picture, Vec3::new(0.1, 0.0, 1.2));
    assert!(near(on_floor, shown(scene.style.floor, 1.0)), "the floor shows {on_floor:?}");
    let on_ball = seen(&camera, &picture, Vec3::new(-1.0, 1.0, 0.0));
    assert!(near(on_ball, shown(scene.style.obstacle, 1.0)), "the top of the ball shows {on_ball:?}");
    let on_slope = seen(&camera, &picture, Vec3::new(1.5, 0.5, 0.0));
    assert!(near(on_slope, shown(scene.style.obstacle, 0.55 + 0.45 * 0.9)), "the slope shows {on_slope:?}");
}

#[test]
fn a_contact_shadow_tells_how_high_a_body_is() {
    for quality in [Quality::Fine, Quality::Quick] {
        let mut studio = Studio::of(quality);
        let camera = looking_down(6.0);
        let mut beside = |height: f32| {
            let mut scene =
                evenly_lit(DrawList { camera, solids: vec![floor(5.0)], ..cube_at(Vec3::Y * (0.5 + height)) });
            scene.style.plane_line_opacity = 0.0;
            let picture = studio.picture(&scene, SIZE);
            let at = |x: f32| seen(&camera, &picture, Vec3::new(x, 0.0, 0.3))[1];
            [at(0.54), at(0.7), at(2.0)]
        };
        let [touching, low, high, far] = [0.0, 0.15, 0.5, 3.0].map(&mut beside);
        assert!(
            touching[0] + 6 < low[0] && low[0] + 3 < high[0],
            "{quality:?}: {touching:?}, {low:?}, {high:?} beside it"
        );
        assert!(touching[0] + 8 < touching[1], "{quality:?}: darkest where it touches: {touching:?}");
        let open = touching[2];
        assert!([touching, low, high, far].iter().all(|row| row[2] == open), "{quality:?}: none far away");
        assert!(far[0].abs_diff(open) <= 1, "{quality:?}: none under a body high up: {far:?}");
    }
}

#[test]
fn away_from_shadows_a_floor_looks_as_if_nothing_stood_on_it() {
    for quality in [Quality::Fine, Quality::Quick] {
        let mut studio = Studio::of(quality);
        let camera = looking_down(9.0);
        let scene = DrawList { camera, solids: vec![floor(20.0)], ..cube_at(Vec3::Y * 0.6) };
        let empty = DrawList { skins: Vec::new(), particles: Arc::default(), ..scene.clone() };
        let pictures = [studio.picture(&scene, SIZE), studio.picture(&empty, SIZE)];
        // Only places outside the shadow and not behind the cube are compared.
        let away = |place: Vec3| place.z > -6.0 && (place.x.abs() > 2.2 || place.z > 2.4);
        let worst = on_the_ground(&camera, [&pictures[0], &pictures[1]], away).map(apart).max().unwrap();
        assert!(worst <= 1, "{quality:?}: the parts that a floor is drawn in differ by {worst}");
        let under = |place: Vec3| place.length() < 1.0;
        let shaded = on_the_ground(&camera, [&pictures[0], &pictures[1]], under).map(apart).max().unwrap();
        assert!(shaded > 30, "{quality:?}: the check sees a shadow, {shaded}");
    }
}
