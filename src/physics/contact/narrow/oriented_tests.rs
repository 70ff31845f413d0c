//! Closed forms against their definitions, sampled.

use glam::{DMat3, DVec3, Vec3};
use rapier3d::math::Vector;
use rapier3d::parry::query::PointQuery;
use rapier3d::parry::shape::{Capsule, Cuboid, Cylinder};

use super::*;
use crate::math::rng::Rng;
use crate::math::rotation::from_euler_deg;

/// One of each form, thick, thin and long.
fn forms() -> Vec<OrientedForm<f64>> {
    let [a, b, c] = [0.7, 0.4, 0.05];
    vec![
        OrientedForm::Box { half_extents: [a, b, a] },
        OrientedForm::Box { half_extents: [a, c, b] },
        OrientedForm::Capsule { radius: b, half_height: a },
        OrientedForm::Capsule { radius: c, half_height: a },
        OrientedForm::Cylinder { radius: b, half_height: a },
        OrientedForm::Cylinder { radius: a, half_height: c },
    ]
}

/// Whether a point is inside, by the definition of the form alone.
fn holds(form: &OrientedForm<f64>, at: DVec3) -> bool {
    let level = DVec3::new(at.x, 0.0, at.z).length();
    match *form {
        OrientedForm::Box { half_extents } => at.abs().cmple(half_extents.into()).all(),
        OrientedForm::Capsule { radius, half_height } => {
            at.distance(DVec3::Y * at.y.clamp(-half_height, half_height)) <= radius
        }
        OrientedForm::Cylinder { radius, half_height } => level <= radius && at.y.abs() <= half_height,
    }
}

/// A number of −1 … 1.
fn any(rng: &mut Rng) -> f64 {
    rng.between(-1.0, 1.0)
}

fn anywhere(rng: &mut Rng, reach: f64) -> DVec3 {
    DVec3::new(any(rng), any(rng), any(rng)) * reach
}

/// Points of the surface, by halving from the middle outwards.
fn surface(form: &OrientedForm<f64>) -> Vec<DVec3> {
    let mut rng = Rng::new(5);
    let mut points = Vec::new();
    for _ in 0..60_000 {
        let way = anywhere(&mut rng, 1.0).normalize();
        let (mut inside, mut outside) = (0.0, 3.0);
        for _ in 0..40 {
            let middle = 0.5 * (inside + outside);
            if holds(form, way * middle) { inside = middle } else { outside = middle }
        }
        points.push(way * inside);
    }
    points
}

#[test]
fn the_distance_is_that_to_the_nearest_of_many_points_of_the_surface() {
    for form in forms() {
        let surface = surface(&form);
        let mut rng = Rng::new(11);
        for _ in 0..120 {
            let at = anywhere(&mut rng, 1.3);
            let Surface { normal, gap } = nearest(&form, at);
            let sampled = surface.iter().map(|point| point.distance(at)).fold(f64::INFINITY, f64::min);
            assert_eq!(gap < 0.0, holds(&form, at), "{form:?} at {at}: inside or outside");
            assert!(gap.abs() < sampled + 1e-9, "{form:?} at {at}: {gap} m, a point is {sampled} m away");
            assert!(gap.abs() > sampled - 0.03, "{form:?} at {at}: {gap} m, the nearest point is {sampled} m away");
            assert!((normal.length() - 1.0).abs() < 1e-12, "{form:?} at {at}: a unit normal");
            let foot = nearest(&form, at - normal * gap);
            assert!(foot.gap.abs() < 1e-12, "{form:?} at {at}: along the normal lies the surface, not {}", foot.gap);
        }
    }
}

/// Parry's shapes, in single precision.
#[test]
fn distances_are_those_that_parry_finds() {
    let mut rng = Rng::new(29);
    let single = |of: [f64; 2]| glam::DVec2::from(of).as_vec2().to_array();
    let vector = |at: DVec3| Vector::from(at.as_vec3().to_array());
    for form in forms() {
        let theirs: Box<dyn PointQuery> = match form {
            OrientedForm::Box { half_extents } => Box::new(Cuboid::new(vector(half_extents.into()))),
            OrientedForm::Capsule { radius, half_height } => {
                let [half_height, radius] = single([half_height, radius]);
                Box::new(Capsule::new_y(half_height, radius))
            }
            OrientedForm::Cylinder { radius, half_height } => {
                let [half_height, radius] = single([half_height, radius]);
                Box::new(Cylinder::new(half_height, radius))
            }
        };
        for _ in 0..1000 {
            let at = anywhere(&mut rng, 1.3);
            let point = vector(at);
            let projected = theirs.project_local_point(point, false);
            let distance = f64::from((projected.point - point).length());
            let wanted = if projected.is_inside { -distance } else { distance };
            let gap = nearest(&form, at).gap;
            assert!((gap - wanted).abs() < 2e-6, "{form:?} at {at}: {gap} m, by parry {wanted} m");
        }
    }
}

#[test]
fn a_line_is_inside_between_where_it_enters_and_where_it_leaves() {
    for form in forms() {
        let mut rng = Rng::new(17);
        let mut met = 0;
        for _ in 0..4000 {
            let (from, way) = (anywhere(&mut rng, 1.5), anywhere(&mut rng, 2.0));
            let points = (0..200).map(|step| from + way * (f64::from(step) / 20.0 - 5.0));
            let is_met = points.clone().any(|at| holds(&form, at));
            let Some(Crossing { enter, leave, normal }) = crossing(&form, from, way) else {
                assert!(!is_met, "{form:?}: {from} along {way} is missed");
                continue;
            };
            met += 1;
            for share in [0.001, 0.3, 0.999] {
                assert!(holds(&form, from + way * (enter + share * (leave - enter))), "{form:?}: between the ends");
            }
            for end in [enter - 1e-6, leave + 1e-6] {
                assert!(!holds(&form, from + way * end), "{form:?}: beyond the ends");
            }
            assert!(way.dot(normal) < 1e-9, "{form:?}: the normal at the entrance is against the way");
            let there = nearest(&form, from + way * enter - normal * 1e-6);
            assert!(there.gap < 0.0 && there.gap > -2e-6, "{form:?}: just inside of it lies the inside");
        }
        assert!(met > 40, "{form:?}: only {met} lines met it");
    }
}

#[test]
fn a_fast_particle_is_caught_and_one_that_ends_short_passes_by_or_leaves_is_not() {
    let turn = from_euler_deg([20.0, -50.0, 70.0]);
    let center = DVec3::new(3.0, -2.0, 5.0);
    for form in forms() {
        let obstacle = OrientedModel { center, axes: [turn.x_axis, turn.y_axis, turn.z_axis], form };
        let way = turn * DVec3::NEG_Y;
        let from = center - way * 2.0 + turn.x_axis * 0.01;
        let fast = meet(&obstacle, from, way * 1e6).expect("it crosses");
        assert!(fast.gap > 0.0 && fast.normal.dot(way) < -0.9, "{form:?}: {fast:?}");
        let slow = meet(&obstacle, from, way * 2.0).expect("it ends inside");
        assert!((slow.gap - fast.gap).abs() < 1e-9, "{form:?}: the same surface at any speed");
        assert_eq!(meet(&obstacle, from, way * 0.2), None, "{form:?}: short of it");
        assert_eq!(meet(&obstacle, from, way * -2.0), None, "{form:?}: away from it");
        assert_eq!(meet(&obstacle, from + turn.x_axis * 2.0, way * 9.0), None, "{form:?}: beside it");
    }
}

#[test]
fn a_turned_form_elsewhere_is_met_as_one_that_stands_at_the_origin() {
    let mut rng = Rng::new(23);
    for form in forms() {
        let plain = OrientedModel { center: DVec3::ZERO, axes: DVec3::AXES, form };
        for _ in 0..500 {
            let turn: DMat3 = from_euler_deg((anywhere(&mut rng, 180.0)).to_array());
            let center = anywhere(&mut rng, 5.0);
            let turned = OrientedModel { center, axes: [turn.x_axis, turn.y_axis, turn.z_axis], form };
            let (from, path) = (anywhere(&mut rng, 1.5), anywhere(&mut rng, 3.0));
            let met = [meet(&plain, from, path), meet(&turned, center + turn * from, turn * path)];
            match met {
                [Some(here), Some(there)] => {
                    assert!((here.gap - there.gap).abs() < 1e-9, "{form:?}: {here:?} and {there:?}");
                    assert!((turn * here.normal).distance(there.normal) < 1e-6, "{form:?}: {here:?} and {there:?}");
                }
                [None, None] => (),
                [here, there] => panic!("{form:?}: {here:?} and {there:?}"),
            }
        }
    }
}

#[test]
fn in_the_very_middle_there_is_a_way_out() {
    for form in forms() {
        let Surface { normal, gap } = nearest(&form, DVec3::ZERO);
        assert!(gap < 0.0 && (normal.length() - 1.0).abs() < 1e-12, "{form:?}: {normal}, {gap}");
        let single = match form {
            OrientedForm::Box { half_extents } => OrientedForm::Box { half_extents: half_extents.map(f32::from_f64) },
            OrientedForm::Capsule { radius, half_height } => {
                OrientedForm::Capsule { radius: f32::from_f64(radius), half_height: f32::from_f64(half_height) }
            }
            OrientedForm::Cylinder { radius, half_height } => {
                OrientedForm::Cylinder { radius: f32::from_f64(radius), half_height: f32::from_f64(half_height) }
            }
        };
        assert!(nearest(&single, Vec3::ZERO).normal.is_finite(), "{form:?} in single precision");
    }
}
