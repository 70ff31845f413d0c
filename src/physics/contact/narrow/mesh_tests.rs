//! Meshes against planes and boxes of the same form.

use std::sync::Arc;

use super::*;
use crate::geometry::{Surface as Geometry, TriMesh};

/// How a particle meets a mesh of which nothing is known.
fn meet_uncached(mesh: &MeshModel<f64>, side: i8, from: DVec3, path: DVec3) -> Option<Surface<f64>> {
    meet(mesh, side, from, path, &mut NearestPointCache::default())
}

/// A floor of two triangles 2 m wide, facing up, and a roof of the same size whose ridge is along z.
fn open(positions: [DVec3; 6], triangles: Vec<[u32; 3]>) -> MeshModel<f64> {
    let mesh = TriMesh { positions: positions.to_vec(), triangles };
    let surface = Arc::new(Geometry::new(&mesh).expect("a surface"));
    let length = surface.own_length();
    assert!(!surface.is_closed(), "it has two sides");
    MeshModel { center: mesh.bounds().center(), axes: DVec3::AXES, length, surface, side_row: Some(0), place: 0 }
}

fn roof() -> MeshModel<f64> {
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    open(
        [
            at(-1.0, 0.0, -1.0),
            at(-1.0, 0.0, 1.0),
            at(0.0, 1.0, -1.0),
            at(0.0, 1.0, 1.0),
            at(1.0, 0.0, -1.0),
            at(1.0, 0.0, 1.0),
        ],
        vec![[0, 1, 3], [0, 3, 2], [2, 3, 5], [2, 5, 4]],
    )
}

#[test]
fn what_is_fast_is_caught_from_either_side_of_an_open_mesh() {
    let slope = 0.5f64.sqrt();
    let from_above =
        meet_uncached(&roof(), 0, DVec3::new(0.5, 3.0, 0.0), DVec3::NEG_Y * 1e3).expect("it crosses the roof");
    assert!(from_above.normal.distance(DVec3::new(slope, slope, 0.0)) < 1e-12, "{from_above:?}");
    assert!((from_above.gap - 2.5 * slope).abs() < 1e-9, "{from_above:?}");
    let from_below =
        meet_uncached(&roof(), 0, DVec3::new(0.5, -3.0, 0.0), DVec3::Y * 1e3).expect("it crosses the roof");
    assert!(from_below.normal.distance(DVec3::new(-slope, -slope, 0.0)) < 1e-12, "{from_below:?}");
    assert_eq!(meet_uncached(&roof(), 0, DVec3::new(1.5, 3.0, 0.0), DVec3::NEG_Y * 1e3), None, "it passes by");
    assert_eq!(meet_uncached(&roof(), 0, DVec3::new(0.5, 3.0, 0.0), DVec3::NEG_Y), None, "it ends short");
}

#[test]
fn what_touches_an_open_mesh_keeps_its_side_over_the_ridge_and_loses_it_beyond_the_rim() {
    for (x, side) in [(0.3, 1), (-0.3, 1), (0.3, -1), (0.0, 1), (0.0, -1)] {
        let behind = if side > 0 { -0.1 } else { 0.1 };
        let at = DVec3::new(x, 1.0 - x.abs() + behind, 0.0);
        let is_up = is_upper(&roof(), at, DVec3::Y);
        let side = if is_up { side } else { -side };
        let met = meet_uncached(&roof(), side, at, DVec3::ZERO).expect("it is behind the surface");
        assert!(met.gap < 0.0 && met.normal.y * behind < 0.0, "{at} on side {side}: {met:?}");
    }
    assert_eq!(meet_uncached(&roof(), 1, DVec3::new(1.1, -0.1, 0.0), DVec3::ZERO), None, "beside it");
}

#[test]
fn a_floor_of_triangles_meets_as_a_plane_does() {
    use crate::physics::contact::narrow::plane;
    use crate::physics::model::PlaneModel;
    let at = |x: f64, z: f64| DVec3::new(x, 0.0, z);
    let floor = open(
        [at(-1.0, -1.0), at(-1.0, 1.0), at(0.0, -1.0), at(0.0, 1.0), at(1.0, -1.0), at(1.0, 1.0)],
        vec![[0, 1, 3], [0, 3, 2], [2, 3, 5], [2, 5, 4]],
    );
    let flat = PlaneModel {
        center: DVec3::ZERO,
        axes: [DVec3::X, DVec3::Z],
        half_extents: [1.0; 2],
        normal: DVec3::Y,
        side_row: 0,
    };
    let part = |number: u32, step: f64| (f64::from(number) * step).fract() * 2.4 - 1.2;
    for number in 1..2000 {
        let from = DVec3::new(part(number, 0.618), 0.1 * part(number, 0.755), part(number, 0.57));
        let path = DVec3::new(part(number, 0.31), part(number, 0.47), part(number, 0.83)) * 0.2;
        for side in [-1, 0, 1] {
            if side != 0 && (from.x.abs() > 1.0 || from.z.abs() > 1.0) {
                continue;
            }
            let side_of_mesh = if is_upper(&floor, from, DVec3::Y) { side } else { -side };
            let (mesh, plane) = (meet_uncached(&floor, side_of_mesh, from, path), plane::meet(&flat, side, from, path));
            let hit_is_inside = {
                let t = if path.y == 0.0 { 0.0 } else { (-from.y / path.y).clamp(0.0, 1.0) };
                let hit = from + path * t;
                hit.x.abs() < 1.0 && hit.z.abs() < 1.0
            };
            if !hit_is_inside {
                continue;
            }
            match (mesh, plane) {
                (None, None) => {}
                (Some(a), Some(b)) => {
                    assert!(a.normal.distance(b.normal) < 1e-12 && (a.gap - b.gap).abs() < 1e-12, "{a:?}, not {b:?}");
                }
                (mesh, plane) => panic!("{from} by {path} on side {side}: {mesh:?}, not {plane:?}"),
            }
        }
    }
}

#[test]
fn a_box_of_triangles_meets_as_a_box_does() {
    use crate::physics::contact::narrow::oriented;
    use crate::physics::model::{OrientedForm, OrientedModel};
    let mesh = crate::geometry::trimesh::tests::boxed(DVec3::new(-0.5, -0.3, -0.2), DVec3::new(0.5, 0.3, 0.2));
    let surface = Arc::new(Geometry::new(&mesh).expect("a box"));
    let turn = glam::DMat3::from_euler(glam::EulerRot::XYZ, 0.4, -0.7, 1.1);
    let (center, axes) = (DVec3::new(1.0, 2.0, 3.0), [turn.x_axis, turn.y_axis, turn.z_axis]);
    let mesh = MeshModel::<f64> { center, axes, length: 2.0, surface, side_row: None, place: 0 };
    let form = OrientedForm::Box { half_extents: [1.0, 0.6, 0.4] };
    let solid = OrientedModel { center, axes, form };
    let part = |number: u32, step: f64| (f64::from(number) * step).fract() * 3.0 - 1.5;
    let mut met = 0;
    for number in 1..4000 {
        let from = center + DVec3::new(part(number, 0.618), part(number, 0.755), part(number, 0.57));
        let path = DVec3::new(part(number, 0.31), part(number, 0.47), part(number, 0.83)) * 2.0;
        let (mesh, solid) = (meet_uncached(&mesh, 0, from, path), oriented::meet(&solid, from, path));
        assert_eq!(mesh.is_some(), solid.is_some(), "{from} by {path}: {mesh:?}, not {solid:?}");
        let (Some(mesh), Some(solid)) = (mesh, solid) else { continue };
        met += 1;
        assert!((mesh.gap - solid.gap).abs() < 1e-9, "{from} by {path}: {mesh:?}, not {solid:?}");
        let straight = mesh.normal.distance(solid.normal) < 1e-9 || mesh.gap.abs() < 1e-6;
        assert!(straight || mesh.gap < 0.0, "{from} by {path}: {mesh:?}, not {solid:?}");
    }
    assert!(met > 500, "{met} meet");
}
