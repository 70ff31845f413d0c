//! Skins: every outer face once, normals outward, exact under affine motion.

use std::collections::BTreeMap;
use std::num::NonZeroU32;
use std::sync::Arc;

use glam::{DMat3, Vec3};

use super::*;
use crate::geometry::texturing::Texturing;
use crate::geometry::voxel::Cells;
use crate::math::picture::{Picture, Sampling};
use crate::math::rotation::from_euler_deg;

const SIZE: f64 = 0.5;
const U: [[i32; 3]; 7] = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, 0], [0, 2, 0], [2, 2, 0]];

fn lattice(list: &[[i32; 3]]) -> Lattice {
    Lattice::new(&Cells::from_list(list, SIZE).expect("a small list of cells"))
}

/// The particles after an affine motion.
fn moved(lattice: &Lattice, motion: DMat3) -> Vec<[f32; 3]> {
    (0..lattice.corners.len()).map(|p| (motion * lattice.rest_position(p)).as_vec3().to_array()).collect()
}

/// A closed box of 12 triangles whose corners are shared, or repeated for every face.
fn boxed(half: f64, repeat: bool) -> TriMesh {
    let skin = cells_skin(&lattice(&[[0, 0, 0]]), 0);
    let corners = lattice(&[[0, 0, 0]]);
    let place = |vertex: u32| {
        let particle = skin.vertices()[vertex as usize].particles[0];
        corners.rest_position(particle as usize) * (2.0 * half / SIZE)
    };
    if repeat {
        let positions = (0..).take(skin.vertices().len()).map(place).collect();
        return TriMesh { positions, triangles: skin.triangles().to_vec() };
    }
    let particle = |vertex: u32| skin.vertices()[vertex as usize].particles[0];
    TriMesh {
        positions: (0..8).map(|p| corners.rest_position(p) * (2.0 * half / SIZE)).collect(),
        triangles: skin.triangles().iter().map(|triangle| triangle.map(particle)).collect(),
    }
}

#[test]
fn every_outer_face_is_there_exactly_once() {
    for (cells, faces) in [(&U[..1], 6), (&U[..], 30)] {
        let skin = cells_skin(&lattice(cells), 0);
        assert_eq!(skin.triangles().len(), 2 * faces, "two triangles a face");
        let mut corners: Vec<Vec<u32>> = skin
            .triangles()
            .chunks(2)
            .map(|pair| {
                let mut corners: Vec<u32> = pair.iter().flatten().copied().collect();
                corners.sort_unstable();
                corners.dedup();
                corners
            })
            .collect();
        corners.sort();
        corners.dedup();
        assert_eq!(corners.len(), faces, "no face twice");
    }
}

#[test]
fn the_surface_is_closed() {
    let skin = cells_skin(&lattice(&U), 0);
    let mut edges: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for triangle in skin.triangles() {
        let [a, b, c] = triangle.map(|vertex| skin.vertices()[vertex as usize].particles[0]);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *edges.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
    }
    assert!(edges.values().all(|&balance| balance == 0), "every edge is passed as often there as back");
}

#[test]
fn normals_point_outward_at_rest_and_edges_are_crisp() {
    for cells in [&U[..], &[[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]] {
        let lattice = lattice(cells);
        let skin = cells_skin(&lattice, 0);
        let surface = skin.evaluate(&moved(&lattice, DMat3::IDENTITY));
        for triangle in skin.triangles() {
            let [a, b, c] = triangle.map(|vertex| surface[vertex as usize]);
            let facing = (b.0 - a.0).cross(c.0 - a.0).normalize();
            for (position, normal) in [a, b, c] {
                assert!(normal.distance(facing) < 1e-5, "at {position} the normal is {normal}, the face {facing}");
            }
            let outside = ((a.0 + b.0 + c.0) / 3.0 + facing * 0.1).as_dvec3();
            let cell = ((outside - lattice.grid.origin) / SIZE).floor();
            let filled = lattice.cells.iter().any(|cell_particles| {
                let low = lattice.corners[cell_particles[0] as usize].map(f64::from);
                DVec3::from(low) == cell
            });
            assert!(!filled, "the face at {} points into a cell", a.0);
        }
    }
}

#[test]
fn normals_turn_with_the_particles() {
    let lattice = lattice(&U);
    let skin = cells_skin(&lattice, 0);
    let rotation = from_euler_deg([20.0, -35.0, 110.0]);
    let rest = skin.evaluate(&moved(&lattice, DMat3::IDENTITY));
    let turned = skin.evaluate(&moved(&lattice, rotation));
    for (before, after) in rest.iter().zip(&turned) {
        let expected = (rotation * before.1.as_dvec3()).as_vec3();
        assert!(after.1.distance(expected) < 1e-5, "{} turned to {} and not {expected}", before.1, after.1);
    }
}

#[test]
fn particles_of_other_bodies_come_first() {
    let lattice = lattice(&[[0, 0, 0]]);
    let mut particles = vec![[9.0; 3]; 5];
    particles.extend(moved(&lattice, DMat3::IDENTITY));
    assert_eq!(
        cells_skin(&lattice, 5).evaluate(&particles),
        cells_skin(&lattice, 0).evaluate(&particles[5..]),
        "the same surface, five particles later"
    );
    assert_eq!(
        model_skin(&lattice, &boxed(0.2, false), None, None, 5).evaluate(&particles),
        model_skin(&lattice, &boxed(0.2, false), None, None, 0).evaluate(&particles[5..]),
        "for a model too"
    );
}

#[test]
fn a_model_stays_at_rest_and_follows_affine_motion_exactly() {
    let lattice = lattice(&U);
    let mesh = boxed(0.7, false);
    let skin = model_skin(&lattice, &mesh, None, None, 0);
    let squeeze = DMat3::from_diagonal(DVec3::new(1.4, 0.5, 1.1)) * from_euler_deg([10.0, 70.0, -30.0]);
    for motion in [DMat3::IDENTITY, squeeze] {
        let cofactors = motion.determinant() * motion.inverse().transpose();
        let surface = skin.evaluate(&moved(&lattice, motion));
        for triangle in skin.triangles() {
            let [a, b, c] = triangle.map(|vertex| surface[vertex as usize]);
            let facing = (b.0 - a.0).cross(c.0 - a.0).normalize();
            assert!(a.1.distance(facing) < 1e-4, "a flat face keeps its normal: {} and {facing}", a.1);
        }
        for (position, normal) in surface {
            let rest = (motion.inverse() * position.as_dvec3()).abs();
            assert!((rest - DVec3::splat(0.7)).abs().max_element() < 1e-5, "a corner of the box, not {rest}");
            let at_rest = (cofactors.inverse() * normal.as_dvec3()).normalize().abs();
            assert!((at_rest.max_element() - 1.0).abs() < 1e-4, "a normal along an axis at rest, not {at_rest}");
        }
    }
}

#[test]
fn creases_split_vertices_and_gentle_bends_do_not() {
    let lattice = lattice(&U);
    for repeat in [false, true] {
        let cube = model_skin(&lattice, &boxed(0.7, repeat), None, None, 0);
        assert_eq!(cube.vertices().len(), 24, "a cube has three normals a corner");
    }
    let roof = |height: f64| TriMesh {
        positions: vec![
            DVec3::new(-0.5, 0.0, 0.0),
            DVec3::new(0.0, height, -0.5),
            DVec3::new(0.0, height, 0.5),
            DVec3::new(0.5, 0.0, 0.0),
        ],
        triangles: vec![[0, 2, 1], [1, 2, 3]],
    };
    let gentle = model_skin(&lattice, &roof(0.1), None, None, 0);
    assert_eq!(gentle.vertices().len(), 4, "23 degrees are smooth");
    assert_eq!(model_skin(&lattice, &roof(0.3), None, None, 0).vertices().len(), 6, "62 degrees are a crease");
    let ridge = gentle.evaluate(&moved(&lattice, DMat3::IDENTITY));
    assert!(ridge.iter().any(|(_, normal)| normal.distance(Vec3::Y) < 1e-5), "the ridge looks straight up");
}

#[test]
fn what_a_file_says_of_smoothness_counts_more_than_the_angle() {
    let lattice = lattice(&U);
    let cube = boxed(0.7, false);
    let skin = |groups: &dyn Fn(usize) -> u32| {
        let corners = (0..cube.triangles.len()).map(|triangle| [NonZeroU32::new(groups(triangle)); 3]).collect();
        model_skin(&lattice, &cube, None, Shading::new(corners).as_ref(), 0)
    };
    assert_eq!(skin(&|_| 1).vertices().len(), 8, "a smooth cube");
    assert_eq!(skin(&|_| 0).vertices().len(), 24, "nothing is said");
    let gentle = TriMesh {
        positions: [[-0.5, 0.0, 0.0], [0.0, 0.1, -0.5], [0.0, 0.1, 0.5], [0.5, 0.0, 0.0]].map(DVec3::from).to_vec(),
        triangles: vec![[0, 2, 1], [1, 2, 3]],
    };
    let flat = Shading::new(vec![[NonZeroU32::new(1); 3], [NonZeroU32::new(2); 3]]);
    assert_eq!(model_skin(&lattice, &gentle, None, flat.as_ref(), 0).vertices().len(), 6, "a fold of 23 degrees");
}

#[test]
fn triangles_without_area_are_left_out() {
    let mesh = TriMesh { positions: vec![DVec3::ZERO, DVec3::X * 0.1, DVec3::X * 0.2], triangles: vec![[0, 1, 2]] };
    assert_eq!(model_skin(&lattice(&U), &mesh, None, None, 0).triangles(), Vec::<[u32; 3]>::new(), "nothing to see");
}

#[test]
fn a_part_of_the_mesh_without_cells_is_left_out() {
    let one_cell = lattice(&[[0, 0, 0]]);
    let mut mesh = boxed(0.5 * SIZE, false);
    let kept = model_skin(&one_cell, &mesh, None, None, 0).triangles().len();
    let far = boxed(0.5 * SIZE, false);
    mesh.triangles.extend(far.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + 8)));
    mesh.positions.extend(far.positions.iter().map(|position| *position + DVec3::X * 4.0 * SIZE));
    assert_eq!(kept, 12, "the box in the cell is there");
    assert_eq!(model_skin(&one_cell, &mesh, None, None, 0).triangles().len(), kept, "the one four cells away is not");
}

#[test]
fn vertices_are_split_where_colours_meet_and_nowhere_else() {
    let lattice = lattice(&[[0, 0, 0]]);
    let mesh = boxed(0.2, false);
    let bare = model_skin(&lattice, &mesh, None, None, 0);
    assert!(!bare.is_painted());
    let (red, blue) = ([255, 0, 0, 255], [0, 0, 255, 255]);
    let painted = |of: &dyn Fn(usize) -> Tint| {
        let paint = Paint::new(Vec::new(), (0..mesh.triangles.len()).map(of).collect(), None).expect("colours");
        model_skin(&lattice, &mesh, Some(&paint), None, 0)
    };
    let one = painted(&|_| red);
    assert!(one.is_painted() && one.vertices().iter().all(|vertex| vertex.tint == red), "all of it");
    assert_eq!((one.vertices().len(), one.triangles()), (bare.vertices().len(), bare.triangles()), "the same mesh");
    // Each side of the box is two triangles with four vertices of their own; two more are needed if the triangles differ.
    let two = painted(&|triangle| if triangle == 0 { blue } else { red });
    assert_eq!(two.vertices().len(), bare.vertices().len() + 2, "along one diagonal");
    for (number, corners) in two.triangles().iter().enumerate() {
        let tints = corners.map(|vertex| two.vertices()[vertex as usize].tint);
        assert_eq!(tints, [if number == 0 { blue } else { red }; 3], "triangle {number}");
    }
    assert_eq!(two.folds().len(), bare.folds().len(), "the surface is the same");
}

#[test]
fn vertices_are_split_where_places_in_a_picture_differ_and_triangles_are_sorted_by_it() {
    let lattice = lattice(&[[0, 0, 0]]);
    let mesh = boxed(0.2, false);
    let count = mesh.triangles.len();
    let picture = Arc::new(Picture::new([1, 1], vec![255; 4], 1).expect("one texel"));
    let textures = [Sampling::default(), Sampling { levels: None, ..Sampling::default() }]
        .map(|sampling| Texture { picture: Arc::clone(&picture), sampling });
    let dressed = |of: &dyn Fn(usize) -> Option<u16>, places: &dyn Fn(usize) -> [[f32; 2]; 3]| {
        let (of_triangles, corners) = ((0..count).map(of).collect(), (0..count).map(places).collect());
        let texturing = Texturing::new(textures.to_vec(), of_triangles, corners).expect("pictures");
        let paint = Paint::new(Vec::new(), Vec::new(), Some(texturing)).expect("pictures");
        model_skin(&lattice, &mesh, Some(&paint), None, 0)
    };
    let bare = model_skin(&lattice, &mesh, None, None, 0);
    let same = dressed(&|_| Some(0), &|_| [[0.5; 2]; 3]);
    assert_eq!(same.triangles(), bare.triangles(), "nothing is split where all lies in one place");
    assert!(same.is_painted() && same.vertices().iter().all(|vertex| vertex.tint == [255; 4]), "as the picture is");
    let each = |triangle: usize| [0.0, 1.0, 2.0].map(|corner| [triangle as f32, corner]);
    let split = dressed(&|triangle| [None, Some(1), Some(0)][triangle % 3], &each);
    let dressed = split.textures().expect("pictures");
    let runs: Vec<_> = dressed.runs.iter().map(|run| (run.triangles.clone(), run.texture.sampling.levels)).collect();
    let smooth = Sampling::default().levels;
    assert_eq!(
        (dressed.plain_triangles(), runs),
        (4, vec![(4..8, smooth), (8..12, None)]),
        "plain ones, then by picture"
    );
    for (number, corners) in split.triangles().iter().enumerate().skip(4) {
        let places = corners.map(|vertex| dressed.places[vertex as usize]);
        let triangle = if number < 8 { 3 * (number - 4) + 2 } else { 3 * (number - 8) + 1 };
        assert_eq!(places, each(triangle), "triangle {triangle} of the model is {number} of the skin");
        let positions =
            corners.map(|vertex| split.vertices()[vertex as usize].place(&moved(&lattice, DMat3::IDENTITY)));
        for (position, &vertex) in positions.into_iter().zip(&mesh.triangles[triangle]) {
            assert!(position.distance(mesh.positions[vertex as usize].as_vec3()) < 1e-5, "and lies where it did");
        }
    }
    assert_eq!(split.folds().len(), bare.folds().len(), "the surface is the same");
}
