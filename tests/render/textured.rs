//! Pictures on bodies: the right texel at the right place, in the right colour, and no picture where none is shown.

use std::sync::Arc;

use gelatin::math::color::srgb_from_linear;
use gelatin::math::picture::{Filter, Picture, Sampling, Texture, Wrap};
use gelatin::view::{DrawList, Image, Skin, SkinInstance, SkinTextures, SkinVertex, TexturedRun};
use glam::{Vec2, Vec3};

use crate::gpu::Studio;
use crate::image_diff::difference;
use crate::scenes::{camera_above, cube};

const SIZE: [u32; 2] = [240, 240];

const RED: [u8; 3] = [255, 0, 0];
const GREEN: [u8; 3] = [0, 255, 0];
const BLUE: [u8; 3] = [0, 0, 255];
const WHITE: [u8; 3] = [255; 3];

/// Where the corners of a sheet lie in its picture: upper left, upper right, lower left, lower right.
type Places = [[f32; 2]; 4];
const UPRIGHT: Places = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];

/// Texels as squares.
const SHARP: Sampling =
    Sampling { wrap: [Wrap::Repeat; 2], magnified: Filter::Nearest, minified: Filter::Nearest, levels: None };

/// A picture of opaque texels.
fn picture(size: [u32; 2], texels: &[[u8; 3]]) -> Arc<Picture> {
    let rgba = texels.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
    Arc::new(Picture::new(size, rgba, 4096).expect("as many texels as the size says"))
}

fn four() -> Arc<Picture> {
    picture([2, 2], &[RED, GREEN, BLUE, WHITE])
}

/// A square metre on the ground, seen from above, with a picture.
fn sheet(picture: Arc<Picture>, sampling: Sampling, places: Places, tint: [u8; 4]) -> DrawList {
    let vertex = |particle: u32| SkinVertex {
        particles: [particle, 0, 1, 2, 0, 0, 0, 0],
        position: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        tangent_u: [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        tangent_v: [0.0, -1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        tint,
    };
    let skin = Skin::new([0, 1, 2, 3].map(vertex).to_vec(), vec![[0, 2, 3], [0, 3, 1]]);
    let texture = Texture { picture, sampling };
    let skin = skin
        .with_textures(SkinTextures { places: places.to_vec(), runs: vec![TexturedRun { texture, triangles: 0..2 }] });
    let corners = [[-0.5, 0.5, -0.5], [0.5, 0.5, -0.5], [-0.5, 0.5, 0.5], [0.5, 0.5, 0.5]];
    lit_evenly(DrawList {
        camera: camera_above(),
        skins: vec![SkinInstance { skin: Arc::new(skin), color: [0.25, 0.5, 0.75] }],
        particles: Arc::new(corners.to_vec()),
        painted: true,
        ..DrawList::default()
    })
}

/// The scene in white light from everywhere only: the visible colour is the colour itself.
fn lit_evenly(mut scene: DrawList) -> DrawList {
    scene.style.ambient = 1.0;
    scene.light.color = [0.0; 3];
    scene
}

/// The colour at a place of the sheet; (0, 0) is its upper left corner and (1, 1) its lower right one.
fn seen(image: &Image, scene: &DrawList, [u, v]: [f32; 2]) -> [u8; 3] {
    let point = Vec3::new(u - 0.5, 0.5, v - 0.5);
    let at = scene.camera.pixel_of(point, Vec2::new(SIZE[0] as f32, SIZE[1] as f32)).unwrap();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place within the picture")]
    let [r, g, b, _] = image.pixel([at.x.round() as u32, at.y.round() as u32]).unwrap();
    [r, g, b]
}

fn near(a: [u8; 3], b: [u8; 3]) -> bool {
    a.iter().zip(b).all(|(&a, b)| a.abs_diff(b) <= 2)
}

/// The colours in the middles of the four quarters of the sheet, row by row.
fn quarters(studio: &mut Studio, scene: &DrawList) -> [[u8; 3]; 4] {
    let image = studio.picture(scene, SIZE);
    [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]].map(|place| seen(&image, scene, place))
}

fn check(studio: &mut Studio, scene: &DrawList, wanted: [[u8; 3]; 4], why: &str) {
    let found = quarters(studio, scene);
    assert!(found.iter().zip(wanted).all(|(&found, wanted)| near(found, wanted)), "{why}: {found:?}, not {wanted:?}");
}

#[test]
fn every_texel_is_where_the_places_put_it() {
    let mut studio = Studio::new();
    let plain = [255; 4];
    let moved = |change: &dyn Fn([f32; 2]) -> [f32; 2]| sheet(four(), SHARP, UPRIGHT.map(change), plain);
    check(&mut studio, &moved(&|place| place), [RED, GREEN, BLUE, WHITE], "upright");
    check(&mut studio, &moved(&|[u, v]| [1.0 - u, v]), [GREEN, RED, WHITE, BLUE], "u runs the other way");
    check(&mut studio, &moved(&|[u, v]| [u, 1.0 - v]), [BLUE, WHITE, RED, GREEN], "v runs the other way");
    check(&mut studio, &moved(&|[u, v]| [v, u]), [RED, BLUE, GREEN, WHITE], "u and v have changed places");
    let quick = &mut Studio::of(gelatin::render::Quality::Quick);
    check(quick, &moved(&|place| place), [RED, GREEN, BLUE, WHITE], "upright, quickly");
}

#[test]
fn what_lies_beyond_the_edges_is_wrapped() {
    let mut studio = Studio::new();
    // The texture coordinates reach twice the picture's width, so the right half of the sheet lies beyond its right edge.
    let beyond = UPRIGHT.map(|[u, v]| [2.0 * u, v]);
    for (wrap, right) in [(Wrap::Repeat, [RED, GREEN]), (Wrap::Mirror, [GREEN, RED]), (Wrap::Clamp, [GREEN, GREEN])] {
        let scene = sheet(four(), Sampling { wrap: [wrap; 2], ..SHARP }, beyond, [255; 4]);
        let image = studio.picture(&scene, SIZE);
        let along = [0.125, 0.375, 0.625, 0.875].map(|u| seen(&image, &scene, [u, 0.25]));
        let wanted = [RED, GREEN, right[0], right[1]];
        assert!(along.iter().zip(wanted).all(|(&found, wanted)| near(found, wanted)), "{wrap:?}: {along:?}");
    }
}

#[test]
fn light_is_filtered_and_not_the_bytes_that_stand_for_it() {
    let mut studio = Studio::new();
    let halves = sheet(picture([2, 1], &[[0; 3], WHITE]), Sampling::default(), UPRIGHT, [255; 4]);
    let image = studio.picture(&halves, SIZE);
    let half = srgb_from_linear([0.5; 3]);
    let middle = seen(&image, &halves, [0.5, 0.5]);
    assert!(middle.iter().zip(half).all(|(a, b)| a.abs_diff(b) <= 4), "{middle:?}: half the light is {half:?}");
    // A checkerboard of 512 squares a side over 60 pixels is grey.
    let fine: Vec<[u8; 3]> = (0..512 * 512).map(|at| if (at / 512 + at) % 2 == 0 { WHITE } else { [0; 3] }).collect();
    let fine = picture([512, 512], &fine);
    check(&mut studio, &sheet(fine.clone(), Sampling::default(), UPRIGHT, [255; 4]), [half; 4], "by coarser levels");
    let without = quarters(&mut studio, &sheet(fine, SHARP, UPRIGHT, [255; 4]));
    assert!(without.iter().any(|&found| !near(found, half)), "the finest level alone flickers: {without:?}");
}

#[test]
fn a_picture_is_multiplied_by_the_colour_and_lets_that_of_the_body_through() {
    let mut studio = Studio::new();
    let tinted = sheet(four(), SHARP, UPRIGHT, [255, 188, 0, 255]);
    check(&mut studio, &tinted, [RED, [0, 188, 0], [0; 3], [255, 188, 0]], "half the green, no blue");
    let rgba = [[255, 0, 0, 255], [0, 255, 0, 0], [255, 255, 255, 128], [0; 4]].concat();
    let sheer = Arc::new(Picture::new([2, 2], rgba, 16).unwrap());
    let body = srgb_from_linear([0.25, 0.5, 0.75]);
    let half = srgb_from_linear([0.25, 0.5, 0.75].map(|channel: f32| 0.5 * channel + 0.5));
    check(&mut studio, &sheet(sheer, SHARP, UPRIGHT, [255; 4]), [RED, body, half, body], "the body's own colour");
}

#[test]
fn pictures_are_hidden_where_other_colours_are_shown() {
    let mut studio = Studio::new();
    let scene = sheet(four(), SHARP, UPRIGHT, [255; 4]);
    let bare = DrawList { painted: false, ..scene.clone() };
    check(&mut studio, &bare, [srgb_from_linear([0.25, 0.5, 0.75]); 4], "one colour");
    let mut mapped = scene.clone();
    mapped.scalars = Some(Arc::new(vec![1.0; 4]));
    mapped.color_range = [0.0, 1.0];
    check(&mut studio, &mapped, [scene.colormap.srgb(1.0); 4], "the map");
    check(&mut studio, &scene, [RED, GREEN, BLUE, WHITE], "and back");
    let mut through = scene.clone();
    through.overlay.see_through = 0.5;
    let found = quarters(&mut studio, &through);
    assert!(found[0][0] > found[0][2] + 40 && found[2][2] > found[2][0] + 40, "seen through, too: {found:?}");
}

#[test]
fn triangles_without_a_picture_are_drawn_beside_those_with_one() {
    let mut studio = Studio::new();
    let whole = sheet(four(), SHARP, UPRIGHT, [255, 188, 255, 255]);
    let skin = &whole.skins[0].skin;
    let textures = skin.textures().unwrap();
    let first = textures.runs[0].texture.clone();
    let second = Texture { picture: picture([1, 1], &[BLUE]), sampling: SHARP };
    let with = |runs: Vec<(&Texture, std::ops::Range<usize>)>| {
        let run = |(texture, triangles): (&Texture, _)| TexturedRun { texture: texture.clone(), triangles };
        let runs = runs.into_iter().map(run).collect();
        let bare = Skin::new(skin.vertices().to_vec(), skin.triangles().to_vec());
        let skin = bare.with_textures(SkinTextures { places: textures.places.clone(), runs });
        DrawList { skins: vec![SkinInstance { skin: Arc::new(skin), ..whole.skins[0].clone() }], ..whole.clone() }
    };
    let half = quarters(&mut studio, &with(vec![(&first, 1..2)]));
    assert!(near(half[2], [255, 188, 255]) && near(half[1], [0, 188, 0]), "one plain, one with a picture: {half:?}");
    let both = quarters(&mut studio, &with(vec![(&second, 0..1), (&first, 1..2)]));
    assert!(near(both[2], BLUE) && near(both[1], [0, 188, 0]), "two pictures: {both:?}");
}

#[test]
fn what_is_drawn_without_pictures_does_not_change_beside_them() {
    let mut studio = Studio::new();
    let alone = studio.picture(&cube(), SIZE);
    studio.picture(&sheet(four(), SHARP, UPRIGHT, [255; 4]), SIZE);
    assert_eq!(studio.picture(&cube(), SIZE), alone, "byte for byte");
    assert!(difference(&alone, &studio.picture(&sheet(four(), SHARP, UPRIGHT, [255; 4]), SIZE)).is_some());
}
