//! What the pointer hits on a gizmo, and what a drag does.

use super::*;
use crate::view::{Orbit, Style};

const SIZE: Vec2 = Vec2::new(1280.0, 800.0);
const CENTER: Vec3 = Vec3::new(0.4, 0.7, -0.3);

/// From the front, a little from the right and from above, so that no axis points at the eye.
fn camera(distance: f32) -> Camera {
    Orbit { target: CENTER, yaw_rad: 0.5, pitch_rad: 0.4, distance, ..Orbit::default() }.camera()
}

fn gizmo() -> Gizmo {
    Gizmo::new(CENTER, true)
}

fn pixel(camera: &Camera, point: Vec3) -> Vec2 {
    camera.pixel_of(point, SIZE).expect("in front of the eye")
}

/// The middle of every handle, in pixels.
fn middles(gizmo: &Gizmo, camera: &Camera) -> Vec<(Handle, Vec2)> {
    let projected = ProjectedGizmo::new(gizmo, camera, SIZE).expect("in front of the eye");
    let arrows = projected.arrows().map(|(axis, [tail, tip])| (Handle::Arrow(axis), tail.lerp(tip, 0.9)));
    let squares = projected.squares().map(|(axis, corners)| (Handle::Square(axis), (corners[0] + corners[2]) * 0.5));
    let rings = projected.rings().map(|(axis, points)| (Handle::Ring(axis), points[points.len() / 4]));
    arrows.chain(squares).chain(rings).collect()
}

#[test]
fn every_handle_is_hit_where_it_is_drawn_at_any_distance() {
    for distance in [0.05, 3.0, 400.0] {
        let camera = camera(distance);
        let middles = middles(&gizmo(), &camera);
        assert_eq!(middles.len(), 9, "three arrows, three squares, three rings");
        for (handle, middle) in middles {
            assert_eq!(gizmo().hit(&camera, SIZE, middle), Some(handle), "from {distance} m");
        }
        let beside = pixel(&camera, CENTER) + Vec2::new(160.0, 90.0);
        assert_eq!(gizmo().hit(&camera, SIZE, beside), None, "beside all of them, from {distance} m");
    }
}

#[test]
fn a_sphere_has_no_rings_and_nothing_behind_the_eye_has_handles() {
    let camera = camera(3.0);
    let still = Gizmo { has_rings: false, ..gizmo() };
    assert!(middles(&still, &camera).iter().all(|(handle, _)| !matches!(handle, Handle::Ring(_))), "no rings");
    let behind = Gizmo::new(camera.eye - camera.forward(), true);
    assert_eq!(behind.hit(&camera, SIZE, SIZE * 0.5), None, "behind the eye");
    let mut overlay = Overlay::default();
    behind.add_to(&mut overlay, &camera, SIZE, None, &Style::default().overlay);
    assert!(overlay.is_empty(), "nor is it drawn");
}

#[test]
fn handles_that_point_at_the_eye_are_no_handles() {
    let camera = Orbit { target: CENTER, yaw_rad: 0.0, pitch_rad: 0.0, ..Orbit::default() }.camera();
    let handles: Vec<Handle> = middles(&gizmo(), &camera).into_iter().map(|(handle, _)| handle).collect();
    assert!(!handles.contains(&Handle::Arrow(2)), "z points at the eye");
    assert!(!handles.contains(&Handle::Square(0)) && !handles.contains(&Handle::Square(1)), "two squares are lines");
    assert!(handles.contains(&Handle::Square(2)) && handles.contains(&Handle::Ring(2)), "the third is seen in full");
}

fn moved(handle: Handle, from: Vec3, to: Vec3) -> Vec3 {
    let camera = camera(3.0);
    match gizmo().drag(&camera, SIZE, handle, pixel(&camera, from), pixel(&camera, to)) {
        Some(Drag::Move(moved)) => moved,
        other => panic!("{handle:?} moves, not {other:?}"),
    }
}

#[test]
fn an_arrow_moves_along_its_axis_by_as_much_as_the_pointer() {
    for (axis, direction) in Vec3::AXES.into_iter().enumerate() {
        let (from, to) = (CENTER + direction * 0.2, CENTER + direction * 0.55);
        let moved = moved(Handle::Arrow(axis), from, to);
        assert!(moved.distance(direction * 0.35) < 1e-3, "{moved} along axis {axis}");
    }
}

#[test]
fn a_square_moves_in_its_plane_so_that_what_was_grabbed_stays_under_the_pointer() {
    for axis in 0..3 {
        let [u, v] = [1, 2].map(|next| Vec3::AXES[(axis + next) % 3]);
        let grabbed = CENTER + (u + v) * 0.1;
        let way = u * 0.3 - v * 0.2;
        let moved = moved(Handle::Square(axis), grabbed, grabbed + way);
        assert!(moved.distance(way) < 1e-3, "{moved} in the plane at right angles to axis {axis}");
    }
}

fn turn(camera: &Camera, axis: usize, from: Vec2, to: Vec2) -> f32 {
    match gizmo().drag(camera, SIZE, Handle::Ring(axis), from, to) {
        Some(Drag::Turn { axis: about, angle_rad }) if about == Vec3::AXES[axis] => angle_rad,
        other => panic!("a turn about axis {axis}, not {other:?}"),
    }
}

#[test]
fn a_ring_turns_by_the_angle_the_pointer_goes_around() {
    let camera = camera(3.0);
    for (axis, direction) in Vec3::AXES.into_iter().enumerate() {
        let arm = Vec3::AXES[(axis + 1) % 3] * 0.3;
        for angle in [0.4_f32, -1.2, 2.8] {
            let turned = glam::Quat::from_axis_angle(direction, angle) * arm;
            let (from, to) = (pixel(&camera, CENTER + arm), pixel(&camera, CENTER + turned));
            let got = turn(&camera, axis, from, to);
            assert!((got - angle).abs() < 1e-3, "{got} of {angle} about axis {axis}");
        }
    }
}

#[test]
fn a_ring_seen_flat_turns_along_its_tangent() {
    let camera = Orbit { target: CENTER, yaw_rad: 0.0, pitch_rad: 0.0, ..Orbit::default() }.camera();
    let middle = pixel(&camera, CENTER);
    let right = turn(&camera, 1, middle, middle + Vec2::X * RING_RADIUS);
    assert!((right - 1.0).abs() < 0.01, "a radius to the right is a radian about the vertical: {right}");
    let none = turn(&camera, 1, middle, middle + Vec2::Y * 50.0);
    assert!(none.abs() < 1e-3, "along the axis nothing turns: {none}");
}

#[test]
fn a_drag_to_the_horizon_means_nothing() {
    let camera = camera(3.0);
    let from = pixel(&camera, CENTER + (Vec3::X + Vec3::Z) * 0.1);
    let drag = |to| gizmo().drag(&camera, SIZE, Handle::Square(1), from, to);
    assert_eq!(drag(Vec2::new(640.0, -4000.0)), None, "above the horizon");
    let horizon = pixel(&camera, CENTER + Vec3::NEG_Z.rotate_y(0.5) * 500.0);
    assert_eq!(drag(horizon), None, "nor half a kilometre away");
}

#[test]
fn the_handle_under_the_pointer_stands_out() {
    let colors = Style::default().overlay;
    let count = |hot| {
        let mut overlay = Overlay::default();
        gizmo().add_to(&mut overlay, &camera(3.0), SIZE, hot, &colors);
        let LineEnds::Placed(segments) = &overlay.lines[0].ends else { panic!("handles are in the world") };
        segments.iter().filter(|segment| segment.color[..3] == colors.hot).count()
    };
    assert_eq!((count(None), count(Some(Handle::Arrow(1)))), (0, 2), "a shaft and a head");
}
