//! Surfaces of meshes against shapes whose distance is known.

use std::f64::consts::PI;

use rapier3d::math::Vector;
use rapier3d::parry::query::PointQuery;
use rapier3d::parry::shape::{TriMesh as ParryMesh, TriMeshFlags};

use super::*;
use crate::geometry::trimesh::tests::boxed;

/// A ball of radius 1 with this many rings.
fn ball(rings: u32) -> TriMesh {
    let mut mesh = TriMesh::default();
    for ring in 0..=rings {
        for side in 0..2 * rings {
            let (polar, around) = (PI * f64::from(ring) / f64::from(rings), PI * f64::from(side) / f64::from(rings));
            let (sin, cos) = (libm::sin(polar), libm::cos(polar));
            // Rounding must not open the poles.
            let sin = if ring == 0 || ring == rings { 0.0 } else { sin };
            mesh.positions.push(DVec3::new(sin * libm::cos(around), cos, sin * libm::sin(around)));
        }
    }
    for ring in 0..rings {
        for side in 0..2 * rings {
            let at = |ring: u32, side: u32| ring * 2 * rings + side % (2 * rings);
            let [a, b, c, d] = [at(ring, side), at(ring, side + 1), at(ring + 1, side), at(ring + 1, side + 1)];
            mesh.triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    mesh
}

fn cube() -> TriMesh {
    boxed(DVec3::new(1.0, 2.0, 3.0), DVec3::new(3.0, 4.0, 5.0))
}

fn surface(mesh: &TriMesh) -> Surface {
    Surface::new(mesh).expect("a surface")
}

/// Points within and around a unit box, the same every time.
fn points() -> impl Iterator<Item = DVec3> {
    let part = |number: u32, step: f64| (f64::from(number) * step).fract() * 1.6 - 0.8;
    (1..4000).map(move |n| DVec3::new(part(n, 0.618_033_99), part(n, 0.754_877_67), part(n, 0.569_840_29)))
}

/// Parry's triangle mesh, in single precision, of a ball that is squeezed and dented.
#[test]
fn distances_and_insides_are_those_that_parry_finds() {
    let mut dented = ball(14);
    for at in &mut dented.positions {
        let dent = 1.0 - 0.7 * (1.0 - at.distance(DVec3::new(0.6, 0.8, 0.0))).max(0.0);
        *at = *at * dent * DVec3::new(1.0, 0.6, 0.35);
    }
    let ours = surface(&dented);
    let vector = |at: DVec3| Vector::from(at.as_vec3().to_array());
    let corners = ours.positions().iter().map(|at| vector(*at)).collect();
    let triangles = ours.triangles().to_vec();
    let theirs = ParryMesh::with_flags(corners, triangles, TriMeshFlags::ORIENTED).expect("a mesh");
    let mut inside = 0;
    for at in points() {
        let (point, nearest) = (vector(at), ours.nearest(at));
        let projected = theirs.project_local_point(point, false);
        let wanted = f64::from((projected.point - point).length());
        assert!((nearest.distance - wanted).abs() < 1e-6, "{at}: {} is not {wanted}", nearest.distance);
        let is_close = nearest.distance < 1e-6;
        assert!(is_close || ours.holds(at) == projected.is_inside, "{at} is inside or not");
        inside += usize::from(projected.is_inside);
    }
    assert!(inside > 80, "{inside} points are inside");
}

#[test]
fn a_cube_is_as_far_as_a_cube_is() {
    let cube = surface(&cube());
    assert!(cube.is_closed() && (cube.own_length() - 2.0).abs() < 1e-12, "two metres long");
    assert!((cube.half_thickness() - 0.5).abs() < 1e-6, "its middle is half of it away: {}", cube.half_thickness());
    for at in points() {
        let past = at.abs() - 0.5;
        let outside = past.max(DVec3::ZERO).length();
        let wanted = if outside > 0.0 { outside } else { past.max_element() };
        let nearest = cube.nearest(at);
        let signed = if cube.holds(at) { -nearest.distance } else { nearest.distance };
        assert!((signed - wanted).abs() < 1e-12, "{at}: {signed} is not {wanted}");
        assert!(!cube.is_beyond(at, wanted + 1e-9), "{at}: it is no farther than {wanted}");
    }
}

#[test]
fn the_grid_of_distances_changes_nothing_but_time() {
    for mesh in [ball(20), cube()] {
        let surface = surface(&mesh);
        for at in points() {
            let (found, searched) = (surface.nearest(at), surface.search(at, f64::INFINITY));
            assert_eq!(found.point, searched.point, "{at}");
            for known in [0, 7, u32::MAX] {
                assert_eq!(surface.nearest_beside(at, known, 0.0), (searched, 0.0), "{at}, beside triangle {known}");
            }
            assert_eq!(surface.holds(at), searched.is_within(at), "{at}");
            for depth in [0.0, 0.01, 0.1, 0.3] {
                let is_deep = searched.is_within(at) && searched.distance > depth;
                assert_eq!(surface.holds_deep(at, depth), is_deep, "{at}, {depth}");
            }
        }
    }
}

#[test]
fn a_triangle_stays_the_nearest_for_as_long_as_is_said() {
    let mut kept = 0;
    for mesh in [ball(20), cube()] {
        let surface = surface(&mesh);
        for (at, towards) in points().zip(points().skip(9)) {
            let (nearest, alone) = surface.nearest_beside(at, 3, 0.01);
            assert_eq!(nearest, surface.search(at, f64::INFINITY), "{at}: what else is looked for changes nothing");
            assert!((0.0..=0.01).contains(&alone), "{at}: no further than was looked for, {alone}");
            let there = at + (towards - at).normalize() * (0.999 * alone);
            assert_eq!(surface.nearest_of(there, nearest.triangle), surface.nearest(there), "{at} to {there}");
            kept += usize::from(alone > 0.001);
        }
    }
    assert!(kept > 1000, "{kept} of 7998 points may go anywhere near");
}

#[test]
fn the_tree_finds_what_all_triangles_have() {
    let ball = surface(&ball(12));
    for (from, to) in points().zip(points().skip(7)) {
        let way = to - from;
        let all = (0..ball.triangles().len()).filter(|&triangle| way.dot(ball.normals()[triangle]) < 0.0);
        let all = all.filter_map(|triangle| triangle::crossing(ball.corners(triangle), from, way));
        let first = all.filter(|t| (0.0..=1.0).contains(t)).min_by(f64::total_cmp);
        assert_eq!(ball.pierced(from, way, true).map(|found| found.t), first, "{from} to {to}");
        let near = (0..ball.triangles().len()).map(|t| triangle::nearest(ball.corners(t), from).0.distance(from));
        let least = near.fold(f64::INFINITY, f64::min);
        assert!((ball.nearest(from).distance - least).abs() < 1e-14, "{from}");
    }
}

#[test]
fn what_is_inside_out_or_turned_at_random_is_put_right() {
    let right = surface(&ball(10));
    let mut inside_out = ball(10);
    inside_out.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
    let mut mixed = ball(10);
    mixed.triangles.iter_mut().step_by(3).for_each(|triangle| triangle.swap(0, 1));
    for mesh in [inside_out, mixed] {
        let turned = surface(&mesh);
        assert!(turned.is_closed() && points().all(|at| turned.holds(at) == right.holds(at)), "the same inside");
    }
}

#[test]
fn what_is_open_flat_or_doubled_has_two_sides_and_a_rim() {
    let mut bowl = ball(10);
    bowl.triangles.truncate(200);
    let mut sheet = TriMesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Z, DVec3::Z],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    assert!(!surface(&bowl).is_closed() && !surface(&sheet).is_closed(), "neither has an inside");
    sheet.triangles.extend([[2, 1, 0], [3, 2, 0]]);
    let sheet = surface(&sheet);
    assert_eq!((sheet.is_closed(), sheet.triangles().len()), (false, 2), "its other side is left out");
    let beside = sheet.nearest(DVec3::new(0.7, 0.1, 0.0));
    let over = sheet.nearest(DVec3::new(0.1, 0.1, 0.2));
    assert!(beside.is_on_rim && !over.is_on_rim && over.is_on_face, "{beside:?}, {over:?}");
    assert!((over.distance - 0.1).abs() < 1e-12, "{over:?}");
    assert!(sheet.pierced(DVec3::Y, DVec3::NEG_Y * 2.0, false).is_some(), "from above");
    assert!(sheet.pierced(DVec3::NEG_Y, DVec3::Y * 2.0, false).is_some(), "and from below");
}

#[test]
fn no_line_slips_through_an_edge_or_a_corner() {
    let ball = surface(&ball(16));
    for vertex in ball.positions() {
        let hit = ball.pierced(*vertex * 2.0, *vertex * -2.0, true);
        assert!(hit.is_some(), "straight to the corner {vertex}");
    }
    for (number, triangle) in ball.triangles().iter().enumerate() {
        let [a, b, _] = triangle.map(|vertex| ball.positions()[vertex as usize]);
        let middle = (a + b) * 0.5;
        assert!(ball.pierced(middle * 2.0, middle * -2.0, true).is_some(), "an edge of triangle {number}");
    }
}

#[test]
fn nothing_and_too_much_is_refused_in_a_sentence() {
    let line = TriMesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0], triangles: vec![[0, 1, 2]] };
    for mesh in [TriMesh::default(), line] {
        assert_eq!(Surface::new(&mesh).map(|_| ()), Err(SurfaceError::Nothing));
    }
    let many = TriMesh { triangles: vec![[0, 1, 2]; MAX_TRIANGLES + 1], ..cube() };
    let said = Surface::new(&many).map(|_| ()).expect_err("too many").to_string();
    assert!(said.contains("2000001 triangles"), "{said}");
}
