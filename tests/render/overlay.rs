//! Overlays lie where geometry puts them, have the stated width, fade behind things, and cost nothing if there are none.

use std::sync::Arc;

use gelatin::render::Quality;
use gelatin::view::overlay::{CellFrames, Fill, LineEnds, Lines, PointPlaces, Points, Segment};
use gelatin::view::style::Tint;
use gelatin::view::{DrawList, Image, Selected, Solid, Style};
use glam::{Vec2, Vec3};

use crate::gpu::Studio;
use crate::scenes::{camera, cube};

const SIZE: [u32; 2] = [240, 240];
const WHITE: [f32; 4] = [1.0; 4];

fn line(from: Vec3, to: Vec3, width: f32, hidden: f32) -> Lines {
    let ends = LineEnds::Placed(Arc::new(vec![Segment::new(from, to, WHITE, width)]));
    Lines { ends, tint: Tint::Own, opacity: 1.0, width: 1.0, hidden }
}

fn with_lines(scene: DrawList, lines: Vec<Lines>) -> DrawList {
    let mut scene = scene;
    scene.overlay.lines = lines;
    scene
}

fn seen(point: Vec3) -> Vec2 {
    camera().pixel_of(point, Vec2::new(SIZE[0] as f32, SIZE[1] as f32)).unwrap()
}

/// The rise in brightness of a pixel, as a share of the difference from white.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place within the picture")]
fn whiter(before: &Image, after: &Image, at: Vec2) -> f32 {
    let level = |image: &Image| f32::from(image.pixel([at.x as u32, at.y as u32]).unwrap()[1]);
    (level(after) - level(before)) / (255.0 - level(before))
}

#[test]
fn a_line_runs_from_end_to_end_and_is_as_wide_as_it_says() {
    let empty = DrawList { camera: camera(), ..DrawList::default() };
    let (from, to) = (Vec3::new(-0.7, 0.3, 0.2), Vec3::new(0.8, 1.1, -0.4));
    for mut studio in [Quality::Fine, Quality::Quick].map(Studio::of) {
        let before = studio.picture(&empty, SIZE);
        for width in [4.0, 9.0] {
            let after = studio.picture(&with_lines(empty.clone(), vec![line(from, to, width, 0.0)]), SIZE);
            let (a, b) = (seen(from), seen(to));
            let along = (b - a).normalize();
            let across = along.perp();
            for share in [0.0, 0.3, 0.9, 1.0] {
                let at = |off: f32| whiter(&before, &after, a.lerp(b, share) + across * off);
                assert!(at(0.0) > 0.95 && at(0.5 * width - 1.5) > 0.95, "{share} along a line of {width}: {}", at(0.0));
                assert!(at(0.5 * width + 1.5) < 0.02, "beside a line of {width}: {}", at(0.5 * width + 1.5));
            }
            for beyond in [a - along * (0.5 * width + 2.0), b + along * (0.5 * width + 2.0)] {
                assert!(whiter(&before, &after, beyond) < 0.02, "beyond the ends of a line of {width}");
            }
        }
    }
}

#[test]
fn a_line_through_the_eye_is_drawn_as_far_as_it_lies_ahead() {
    let mut studio = Studio::new();
    let empty = DrawList { camera: camera(), ..DrawList::default() };
    let before = studio.picture(&empty, SIZE);
    let (ahead, behind) = (Vec3::new(0.5, 0.5, 1.0), Vec3::new(0.5, 0.5, 9.0));
    let after = studio.picture(&with_lines(empty, vec![line(ahead, behind, 5.0, 0.0)]), SIZE);
    let edge = Vec2::new(239.0, 120.0);
    assert!(whiter(&before, &after, edge) > 0.9, "to the edge of the picture: {}", whiter(&before, &after, edge));
    let before_it = seen(ahead) - Vec2::X * 5.0;
    assert!(whiter(&before, &after, before_it) < 0.02, "not where it is not");
}

#[test]
fn a_line_behind_a_body_fades_by_as_much_as_it_says() {
    let mut studio = Studio::new();
    let before = studio.picture(&cube(), SIZE);
    let shown = |studio: &mut Studio, z: f32, hidden: f32| {
        let (from, to) = (Vec3::new(-0.4, 0.5, z), Vec3::new(0.4, 0.5, z));
        let after = studio.picture(&with_lines(cube(), vec![line(from, to, 6.0, hidden)]), SIZE);
        whiter(&before, &after, seen(Vec3::new(0.1, 0.5, z)))
    };
    assert!(shown(&mut studio, 0.7, 0.0) > 0.95, "before the cube");
    assert!(shown(&mut studio, 0.0, 0.0).abs() < 0.01, "inside, not to be seen");
    let faded = shown(&mut studio, 0.0, 0.3);
    assert!((0.1..0.7).contains(&faded), "inside, faded: {faded}");
    assert!(shown(&mut studio, 0.0, 1.0) > 0.95, "inside, over everything");
}

#[test]
fn lines_hang_on_particles_and_on_skins() {
    let mut studio = Studio::new();
    let mut scene = cube();
    let plain = studio.picture(&scene, SIZE);
    // Particles 0 to 4 are the cube's lowest edge at the back; the line joins those of numbers 100 higher, at the front.
    let ends = LineEnds::Particles { ends: Arc::new(vec![[0, 4]]), first: 100 };
    scene.overlay.lines = vec![Lines { ends, tint: Tint::Own, opacity: 1.0, width: 4.0, hidden: 0.0 }];
    let image = studio.picture(&scene, SIZE);
    let middle = (Vec3::from(scene.particles[100]) + Vec3::from(scene.particles[104])) * 0.5;
    assert!(whiter(&plain, &image, seen(middle)) > 0.9, "between its two particles");

    scene.overlay.lines =
        vec![Lines { ends: LineEnds::Skin(0), tint: Tint::Own, opacity: 1.0, width: 3.0, hidden: 0.0 }];
    let image = studio.picture(&scene, SIZE);
    let edge = seen(Vec3::new(0.125, 0.5, 0.5));
    let face = seen(Vec3::new(0.1875, 0.58, 0.5));
    assert!(whiter(&plain, &image, edge) > 0.9, "on the edge of a triangle");
    assert!(whiter(&plain, &image, face) < 0.1, "not within it");
    scene.overlay.lines[0].ends = LineEnds::Skin(7);
    assert!(studio.picture(&scene, SIZE) == plain, "the edges of no skin are nothing");
}

#[test]
fn points_are_discs_on_their_places() {
    let mut studio = Studio::new();
    let mut scene = cube();
    let before = studio.picture(&scene, SIZE);
    let corner = 124;
    let place = Vec3::from(scene.particles[corner]);
    for places in
        [PointPlaces::Particles { first: 124, count: 1 }, PointPlaces::Placed(Arc::new(vec![place.to_array()]))]
    {
        scene.overlay.points = vec![Points { places, tint: Tint::Own, size: 12.0, hidden: 0.0 }];
        let after = studio.picture(&scene, SIZE);
        let at = |off: Vec2| whiter(&before, &after, seen(place) + off);
        assert!(at(Vec2::ZERO) > 0.95 && at(Vec2::new(3.0, -2.0)) > 0.95, "in the disc");
        assert!(at(Vec2::new(6.0, -6.0)).abs() < 0.02, "a disc has no corners");
    }
}

#[test]
fn bodies_can_be_seen_through() {
    let mut studio = Studio::new();
    let ball = Solid::Sphere { center: Vec3::new(0.0, 0.5, -2.0), radius: 0.3 };
    let mut picture = |solids: Vec<Solid>, see_through: f32| {
        let mut scene = DrawList { solids, ..cube() };
        scene.overlay.see_through = see_through;
        studio.picture(&scene, SIZE)
    };
    let middle = |image: &Image| i32::from(image.pixel([120, 120]).unwrap()[0]);
    let mut change = |see_through| {
        (middle(&picture(vec![ball.clone()], see_through)) - middle(&picture(Vec::new(), see_through))).abs()
    };
    assert!(change(0.0) < 10, "a solid body hides what is behind it: {}", change(0.0));
    assert!(change(0.9) > 20, "one seen through does not: {}", change(0.9));
}

#[test]
fn only_cells_turned_inside_out_are_crossed() {
    let mut studio = Studio::new();
    let cells = Arc::new(vec![[0, 1, 2, 3, 4, 5, 6, 7]]);
    let marked = |studio: &mut Studio, moved: &dyn Fn(u8, [f32; 3]) -> [f32; 3]| {
        let corner = |place: u8| {
            let [x, y, z] = moved(place, [0, 1, 2].map(|bit| f32::from(place >> bit & 1) - 0.5));
            [x, y + 0.5, z]
        };
        let mut scene = DrawList { camera: camera(), particles: Arc::new((0..8).map(corner).collect()), ..cube() };
        scene.skins.clear();
        scene.overlay.cells = vec![CellFrames { cells: Arc::clone(&cells), first: 0, width: 2.0 }];
        let [r, _, b, _] = studio.picture(&scene, SIZE).pixel([120, 120]).unwrap();
        r > b + 60
    };
    assert!(!marked(&mut studio, &|_, at| at), "a sound cell is empty in the middle");
    assert!(marked(&mut studio, &|_, [x, y, z]| [-x, y, z]), "a mirrored one is crossed there");
    // The corner is pulled past its neighbour; the edges there stay away from the middle of the picture.
    let pulled = |place: u8, at: [f32; 3]| if place == 7 { [-0.6, 0.9, 0.9] } else { at };
    assert!(!marked(&mut studio, &pulled), "one corner that is on the wrong side makes no such cell");
}

#[test]
fn what_is_placed_on_the_screen_stays_in_its_corner() {
    let mut studio = Studio::new();
    let mut scene = cube();
    let segment = Segment::new(Vec3::new(-40.0, 20.0, 0.0), Vec3::new(-20.0, 20.0, 0.0), WHITE, 4.0);
    let ends = LineEnds::Screen(Arc::new(vec![segment]));
    scene.overlay.lines = vec![Lines { ends, tint: Tint::Own, opacity: 1.0, width: 1.0, hidden: 0.0 }];
    for (size, scale) in [([240, 240], 1.0), ([300, 200], 2.0)] {
        scene.overlay.scale = scale;
        let [r, g, b, _] = {
            let corner = Vec2::new(size[0] as f32, size[1] as f32) - Vec2::new(30.0, 20.0) * scale;
            let [x, y] = [corner.x, corner.y].map(f32::round);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the picture")]
            studio.picture(&scene, size).pixel([x as u32, y as u32]).unwrap()
        };
        assert!(r.min(g).min(b) > 240, "white 30 points left of the corner and 20 above it: {:?}", [r, g, b]);
    }
}

#[test]
fn flat_shapes_lie_over_everything() {
    let mut studio = Studio::new();
    let mut scene = cube();
    let corners = [Vec3::new(-0.3, 0.3, -1.0), Vec3::new(0.3, 0.3, -1.0), Vec3::new(0.0, 0.9, -1.0)];
    scene.overlay.fills = Arc::new(corners.map(|place| Fill { place: place.to_array(), color: WHITE }).to_vec());
    let [r, g, b, _] = studio.picture(&scene, SIZE).pixel([120, 118]).unwrap();
    assert!(r.min(g).min(b) > 250, "a white triangle behind the cube is seen: {:?}", [r, g, b]);
}

#[test]
fn overlays_that_are_not_numbers_do_no_harm() {
    let mut studio = Studio::new();
    let mut scene = cube();
    let wild = [Vec3::NAN, Vec3::splat(f32::INFINITY), Vec3::splat(1e30), Vec3::ZERO];
    let segments = wild.iter().map(|&end| Segment::new(Vec3::Y, end, WHITE, 3.0)).collect();
    let ends = LineEnds::Placed(Arc::new(segments));
    scene.overlay.lines = vec![
        Lines { ends, tint: Tint::Own, opacity: 1.0, width: 1.0, hidden: 0.5 },
        Lines {
            ends: LineEnds::Particles { ends: Arc::new(vec![[0, 9_999_999]]), first: 7 },
            tint: Tint::Own,
            opacity: 1.0,
            width: 1.0,
            hidden: 0.0,
        },
    ];
    let places = PointPlaces::Placed(Arc::new(wild.map(|place| place.to_array()).to_vec()));
    scene.overlay.points = vec![Points { places, tint: Tint::Own, size: 5.0, hidden: 0.5 }];
    studio.picture(&scene, [64, 64]);
    let ends = LineEnds::Particles { ends: Arc::new(vec![[0, 1], [1, 124]]), first: 0 };
    scene.overlay.lines[0].ends = ends;
    scene.overlay.cells = vec![CellFrames { cells: Arc::new(vec![[0, 1, 2, 3, 4, 5, 6, 7]]), first: 0, width: 1.0 }];
    scene.overlay.points[0].places = PointPlaces::Particles { first: 100, count: 100 };
    scene.selected = Some(Selected::Skin(0));
    scene.particles = Arc::new(scene.particles.iter().map(|_| [f32::NAN, f32::INFINITY, 0.0]).collect());
    studio.picture(&scene, [64, 64]);
    studio.gpu.check().unwrap();
}

#[test]
fn overlays_have_the_colours_of_the_theme_they_are_drawn_in() {
    let mut studio = Studio::new();
    for style in [Style::dark(), Style::light()] {
        let mut scene = DrawList {
            style,
            ..with_lines(cube(), vec![line(Vec3::new(-0.4, 0.5, 0.7), Vec3::new(0.4, 0.5, 0.7), 6.0, 0.0)])
        };
        scene.overlay.lines[0].tint = Tint::Link(1);
        let [r, g, b, _] = studio.picture(&scene, SIZE).pixel([120, 120]).unwrap();
        let wanted = gelatin::math::color::srgb_from_linear(style.overlay.links[1]);
        assert!([r, g, b].iter().zip(wanted).all(|(a, b)| a.abs_diff(b) <= 2), "{:?}, not {wanted:?}", [r, g, b]);
    }
}
