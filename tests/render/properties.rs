//! Pictures whose content follows from geometry and light.

use std::sync::Arc;

use gelatin::math::color::{linear_from_srgb, srgb_from_linear};
use gelatin::render::Quality;
use gelatin::render::layout::DeformedVertex;
use gelatin::view::{Camera, DrawList, Image, Light, Skin, Solid};
use glam::{Vec2, Vec3};

use crate::gpu::Studio;
use crate::image_diff::difference;
use crate::scenes::{camera, camera_above, cube, cube_at};

const SIZE: [u32; 2] = [240, 240];

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place within the picture")]
fn pixel(image: &Image, at: Vec2) -> [u8; 3] {
    let [r, g, b, _] = image.pixel([at.x.round() as u32, at.y.round() as u32]).unwrap();
    [r, g, b]
}

fn seen(camera: &Camera, point: Vec3) -> Vec2 {
    camera.pixel_of(point, Vec2::new(SIZE[0] as f32, SIZE[1] as f32)).unwrap()
}

fn near(a: [u8; 3], b: [u8; 3], tolerance: u8) -> bool {
    a.iter().zip(b).all(|(&a, b)| a.abs_diff(b) <= tolerance)
}

fn brightness(color: [u8; 3]) -> u32 {
    color.iter().map(|&channel| u32::from(channel)).sum()
}

#[test]
fn an_empty_scene_is_its_background() {
    // The camera looks up, so that the ground is out of sight.
    let up = Camera { target: Vec3::Y * 2.0, eye: Vec3::new(0.0, 1.0, 1.0), ..camera() };
    let scene = DrawList { camera: up, ..DrawList::default() };
    let image = Studio::new().picture(&scene, SIZE);
    for (row, color) in [(0, scene.style.background_top), (SIZE[1] - 1, scene.style.background_bottom)] {
        for column in [0, 100, SIZE[0] - 1] {
            let [r, g, b, a] = image.pixel([column, row]).unwrap();
            assert!(near([r, g, b], srgb_from_linear(color), 2), "row {row} shows {:?}", [r, g, b]);
            assert_eq!(a, 255, "the picture is opaque");
        }
    }
}

#[test]
fn a_sphere_is_where_geometry_puts_it() {
    let (center, radius) = (Vec3::new(0.4, 0.9, -0.5), 0.5_f32);
    let mut scene = DrawList { camera: camera(), ..DrawList::default() };
    let empty = Studio::new().picture(&scene, SIZE);
    scene.solids = vec![Solid::Sphere { center, radius }];
    let image = Studio::new().picture(&scene, SIZE);
    let away = center - scene.camera.eye;
    // The silhouette is where lines of sight touch the sphere.
    let inward = (radius / away.length()).asin();
    for (step, turn) in (0..12).map(|step| (step, step as f32 * std::f32::consts::TAU / 12.0)) {
        let side = away.any_orthonormal_vector_of(turn);
        let at =
            |angle: f32| seen(&scene.camera, scene.camera.eye + away.normalize() * angle.cos() + side * angle.sin());
        let (inside, outside) = (at(inward * 0.94), at(inward * 1.06));
        assert_ne!(pixel(&image, inside), pixel(&empty, inside), "just inside the silhouette, step {step}");
        // The sphere's shadow may reach the ground beside it, so only upper steps see the background.
        if outside.y < seen(&scene.camera, center).y {
            assert!(near(pixel(&image, outside), pixel(&empty, outside), 2), "just outside, step {step}");
        }
    }
}

trait AnyOrthonormal {
    fn any_orthonormal_vector_of(self, turn: f32) -> Vec3;
}

impl AnyOrthonormal for Vec3 {
    fn any_orthonormal_vector_of(self, turn: f32) -> Vec3 {
        let (a, b) = self.normalize().any_orthonormal_pair();
        a * turn.cos() + b * turn.sin()
    }
}

#[test]
fn a_face_turned_to_the_light_is_brighter() {
    let mut studio = Studio::new();
    let mut front = |direction: Vec3| {
        let scene = DrawList { light: Light { direction, ..Light::default() }, ..cube() };
        brightness(pixel(&studio.picture(&scene, SIZE), seen(&camera(), Vec3::new(0.1, 0.4, 0.5))))
    };
    let (facing, grazing, behind) =
        (front(Vec3::new(0.3, 0.2, 1.0)), front(Vec3::new(1.0, 1.0, 0.2)), front(Vec3::new(0.0, 0.2, -1.0)));
    assert!(facing > grazing + 20 && grazing > behind + 20, "{facing} facing, {grazing} grazing, {behind} behind");
}

#[test]
fn scalars_have_exactly_the_colours_of_the_map() {
    let mut studio = Studio::new();
    for value in [-5.0, 2.0, 4.5, 7.25, 12.0, 99.0] {
        let mut scene = cube();
        scene.camera = camera_above();
        // Only white light from everywhere: the visible colour is the colour itself.
        scene.style.ambient = 1.0;
        scene.light.color = [0.0; 3];
        scene.scalars = Some(Arc::new(vec![value; scene.particles.len()]));
        scene.color_range = [2.0, 12.0];
        let wanted = scene.colormap.srgb((value - 2.0) / 10.0);
        let shown = pixel(&studio.picture(&scene, SIZE), seen(&scene.camera, Vec3::new(0.1, 1.0, 0.1)));
        assert!(near(shown, wanted, 2), "{value} shows {shown:?}, the map has {wanted:?}");
    }
}

#[test]
fn the_nearer_thing_hides_the_farther() {
    let mut studio = Studio::new();
    let ball = |z: f32| Solid::Sphere { center: Vec3::new(0.0, 0.5, z), radius: 0.2 };
    let middle = |scene: &DrawList, studio: &mut Studio| pixel(&studio.picture(scene, SIZE), Vec2::splat(120.0));
    let alone = middle(&cube(), &mut studio);
    let [r, g, b] = alone;
    assert!(r > g.saturating_add(40) && r > b.saturating_add(40), "the jelly is red: {alone:?}");
    let hidden = middle(&DrawList { solids: vec![ball(-2.0)], ..cube() }, &mut studio);
    assert!(near(alone, hidden, 12), "a ball behind the cube is not seen: {hidden:?}");
    let [r, g, b] = middle(&DrawList { solids: vec![ball(1.2)], ..cube() }, &mut studio);
    assert!(r < g && g < b && b - r < 40, "a ball before the cube has the tone of obstacles: {:?}", [r, g, b]);
}

#[test]
fn bodies_cast_shadows_on_planes_and_on_the_bare_ground() {
    let plane = Solid::Plane { center: Vec3::ZERO, axes: [Vec3::Z, Vec3::X], half_extents: [3.0, 3.0] };
    for solids in [vec![plane], Vec::new()] {
        let mut scene = cube_at(Vec3::Y * 1.5);
        scene.light.direction = Vec3::new(1.0, 1.0, 0.0);
        scene.camera = Camera { target: Vec3::ZERO, eye: Vec3::new(0.0, 3.0, 6.0), ..camera() };
        scene.solids = solids;
        let image = Studio::new().picture(&scene, SIZE);
        // The shadow of the middle falls 1.5 m to the left; its mirror image on the right is lit.
        let at = |x: f32| brightness(pixel(&image, seen(&scene.camera, Vec3::new(x, 0.0, 0.13))));
        assert!(at(-1.53) + 20 < at(1.53), "{} in the shadow, {} in the light", at(-1.53), at(1.53));
    }
}

#[test]
fn the_device_carries_a_skin_where_the_program_does() {
    let mut studio = Studio::new();
    let mut scene = cube();
    let bend = |[x, y, z]: [f32; 3]| [x + 0.3 * y * y, y * 0.7 + 0.1 * z, z * (1.0 + 0.2 * x)];
    scene.particles = Arc::new(scene.particles.iter().map(|&particle| bend(particle)).collect());
    studio.picture(&scene, [16, 16]);
    let bytes = studio.renderer.read_skin(&studio.gpu, 0).unwrap().unwrap();
    let carried: &[DeformedVertex] = &bytes;
    let expected = scene.skins[0].skin.evaluate(&scene.particles);
    assert_eq!(carried.len(), expected.len(), "as many vertices");
    for (vertex, (position, normal)) in carried.iter().zip(expected) {
        assert!(position.distance(vertex.position.into()) < 1e-6, "{:?} and {position}", vertex.position);
        assert!(normal.distance(vertex.normal.into()) < 1e-5, "{:?} and {normal}", vertex.normal);
    }
}

#[test]
fn bodies_keep_their_own_colours() {
    let scene = cube();
    let [r, g, b] = linear_from_srgb(pixel(&Studio::new().picture(&scene, SIZE), Vec2::new(110.0, 130.0)));
    let [own_r, own_g, own_b] = scene.skins[0].color;
    assert!(own_r > own_b && own_b > own_g && r > b && b > g, "the order of channels is the body's");
}

#[test]
fn without_antialiasing_only_edges_differ() {
    let [smooth, rough] = [Quality::Fine, Quality::Quick].map(|quality| Studio::of(quality).picture(&cube(), SIZE));
    let pixels = smooth.rgba.chunks(4).zip(rough.rgba.chunks(4));
    let differing = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 8)).count();
    assert!((1..smooth.rgba.len() / 4 / 20).contains(&differing), "{differing} pixels differ");
}

/// The cube with another colour on each half of its front, and none on its other sides.
fn painted_cube() -> DrawList {
    let mut scene = cube();
    let skin = &scene.skins[0].skin;
    let places = skin.evaluate(&scene.particles);
    let mut vertices = skin.vertices().to_vec();
    for (vertex, (place, normal)) in vertices.iter_mut().zip(places) {
        if normal.z > 0.5 {
            vertex.tint = if place.x < -0.1 { [0, 0, 255, 255] } else { [0, 255, 0, 255] };
        }
    }
    scene.skins[0].skin = Arc::new(Skin::new(vertices, skin.triangles().to_vec()));
    scene
}

#[test]
fn a_painted_skin_shows_its_colours_only_where_they_are_asked_for() {
    let mut studio = Studio::new();
    let plain = studio.picture(&cube(), SIZE);
    let mut scene = painted_cube();
    assert_eq!(difference(&plain, &studio.picture(&scene, SIZE)), None, "nobody has asked for them");
    scene.painted = true;
    let picture = studio.picture(&scene, SIZE);
    let at = |x: f32| linear_from_srgb(pixel(&picture, Vec2::new(x, 130.0)));
    let [left, right] = [at(100.0), at(140.0)];
    assert!(left[2] > 2.0 * left[1] && left[2] > 2.0 * left[0], "blue on the left: {left:?}");
    assert!(right[1] > 2.0 * right[2] && right[1] > 2.0 * right[0], "green on the right: {right:?}");
    scene.scalars = Some(Arc::new(vec![0.0; scene.particles.len()]));
    let mapped = studio.picture(&scene, SIZE);
    scene.painted = false;
    assert_eq!(difference(&mapped, &studio.picture(&scene, SIZE)), None, "a map of scalars is shown alone");
    let bare = DrawList { painted: true, ..cube() };
    assert_eq!(difference(&plain, &studio.picture(&bare, SIZE)), None, "without colours a body keeps its own");
}
