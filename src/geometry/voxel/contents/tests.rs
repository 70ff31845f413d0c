//! What cells hold, against volumes and areas that are known.

use glam::DVec3;

use super::super::tests::{ball, run, sheet, solid_box};
use super::super::{Keep, OccupancyChoice, Voxelization};
use super::{Contents, MIN_CELL_SHARE, SHEET_SHARE, raise_shares};
use crate::geometry::TriMesh;
use crate::geometry::trimesh::tests::together;
use crate::math::rng::Rng;

fn sampled(mesh: &TriMesh, divisions: u32, occupancy: OccupancyChoice) -> (Voxelization, Contents) {
    let mut filled = run(mesh, divisions, occupancy, Keep::Largest);
    let contents = filled.sample(mesh, &()).expect("nobody stops it");
    (filled, contents)
}

/// The volume of what is in the cells, in the mesh's units.
fn volume(mesh: &TriMesh, divisions: u32, occupancy: OccupancyChoice) -> f64 {
    sampled(mesh, divisions, occupancy).0.report.volume_m3
}

fn enclosed(mesh: &TriMesh) -> f64 {
    (0..mesh.triangles.len()).map(|at| mesh.corners(at)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum::<f64>().abs()
}

/// A ball cut off above a height.
fn bowl() -> TriMesh {
    let mut ball = ball(DVec3::ZERO, 1.0, 24);
    let is_low = |mesh: &TriMesh, triangle: usize| mesh.corners(triangle).iter().all(|corner| corner.y < 0.2);
    ball.triangles = (0..ball.triangles.len()).filter(|&at| is_low(&ball, at)).map(|at| ball.triangles[at]).collect();
    ball
}

#[test]
fn a_closed_mesh_has_its_volume_in_any_number_of_divisions() {
    let ball = ball(DVec3::new(3.0, -1.0, 0.5), 0.8, 32);
    let exact = enclosed(&ball);
    let round = 4.0 / 3.0 * std::f64::consts::PI * 0.8f64.powi(3);
    assert!((exact / round - 1.0).abs() < 0.01, "32 rings are nearly a ball");
    for occupancy in [OccupancyChoice::Auto, OccupancyChoice::Centre, OccupancyChoice::Solid] {
        for divisions in [1, 2, 7, 20, 40, 130] {
            let (filled, contents) = sampled(&ball, divisions, occupancy);
            let found = filled.report.volume_m3;
            assert!((found / exact - 1.0).abs() < 1e-9, "{occupancy:?} {divisions}: {found}, not {exact}");
            assert!(
                contents.shares.iter().all(|share| *share >= MIN_CELL_SHARE),
                "{occupancy:?} {divisions}: the least"
            );
            assert_eq!(contents.shares.len(), filled.cells.count(), "one each");
        }
    }
}

#[test]
fn the_samples_alone_come_near_the_volume_that_is_known() {
    let ball = ball(DVec3::ZERO, 0.8, 32);
    for divisions in [7, 20, 40] {
        let filled = run(&ball, divisions, OccupancyChoice::Solid, Keep::Largest);
        let found = super::sample_volume(&ball, &filled.cells.grid, false, &()).expect("nobody stops it");
        let cells: f64 = found.sampled_volume();
        let known = found.known_volume.expect("one skin");
        assert!((cells / known - 1.0).abs() < 2e-3, "{divisions}: {cells} cells, not {known}");
    }
}

/// The stated tolerance: no sample is outside the cells that the triangle test fills (SC). Some of these cells have no
/// sample, as the model only grazes them: at most a twentieth for volume, an eighth for surface.
#[test]
fn samples_agree_with_the_triangle_test() {
    for (name, mesh) in [("ball", ball(DVec3::ZERO, 0.8, 48)), ("box", solid_box([0.0; 3], [1.0, 0.63, 0.41]))] {
        for divisions in [7, 20, 40] {
            let [solid, surface] = [OccupancyChoice::Solid, OccupancyChoice::Surface]
                .map(|occupancy| run(&mesh, divisions, occupancy, Keep::All).cells);
            let of_volume = super::sample_volume(&mesh, &solid.grid, false, &()).expect("nobody stops it");
            let of_surface = super::sample_surface(&mesh, &surface.grid, 1.0, &()).expect("nobody stops it");
            for (what, sampled, cells, most) in
                [("volume", of_volume, solid, 0.05), ("surface", of_surface, surface, 0.125)]
            {
                let inside = sampled.of_cell.iter().filter(|(cell, _)| cells.filled[*cell as usize]).count();
                assert_eq!(inside, sampled.of_cell.len(), "{name} in {divisions}: no {what} elsewhere");
                let without = 1.0 - inside as f64 / cells.count() as f64;
                assert!(without < most, "{name} in {divisions}: {without} of the cells have no {what}");
            }
        }
    }
}

#[test]
fn a_cell_holds_what_is_in_it() {
    let whole = sampled(&solid_box([0.0; 3], [4.0, 2.0, 1.0]), 4, OccupancyChoice::Auto).1;
    assert!(whole.shares.iter().all(|share| (share - 1.0).abs() < 1e-6), "full: {:?}", whole.shares);
    assert_eq!(whole.raised, 0, "and none nearly empty");
    // The grid is centred: the rest of a layer is shared by both sides.
    let (_, halves) = sampled(&solid_box([0.0; 3], [4.0, 1.5, 1.0]), 4, OccupancyChoice::Solid);
    assert!(halves.shares.iter().all(|share| (share - 0.75).abs() < 1e-6), "{:?}", halves.shares);
    let (_, grazed) = sampled(&solid_box([0.0; 3], [4.0, 3.0, 2.02]), 4, OccupancyChoice::Solid);
    let (least, most) = grazed.shares.iter().fold((9.0_f64, 0.0_f64), |(a, b), share| (a.min(*share), b.max(*share)));
    assert!((grazed.volume_cells() - 4.0 * 3.0 * 2.02).abs() < 1e-6, "{grazed:?}");
    assert!(least < 0.52 && (most - 1.0).abs() < 0.02, "half a cell on both sides of a full one: {least}, {most}");
}

#[test]
fn what_is_beside_the_cells_is_held_by_those_that_share_a_face() {
    let slab = solid_box([0.0; 3], [4.0, 1.8, 1.0]);
    let (filled, contents) = sampled(&slab, 4, OccupancyChoice::Centre);
    assert_eq!(filled.cells.count(), 8, "two layers, both with their centres inside");
    assert!((contents.volume_cells() - 7.2).abs() < 1e-6, "{contents:?}");
    // Of five layers of half a metre the outer ones are a fifth full and not filled.
    let tall = together(&[solid_box([0.0; 3], [8.0, 1.0, 1.0]), solid_box([0.0, 1.0, 0.0], [8.0, 1.4, 1.0])]);
    let (filled, contents) = sampled(&tall, 8, OccupancyChoice::Centre);
    let exact = 8.0 * 1.4;
    assert!(contents.lost < 1e-12, "all of it is beside a cell");
    assert!((filled.report.volume_m3 / exact - 1.0).abs() < 0.02, "{} of {exact}", filled.report.volume_m3);
}

#[test]
fn holes_flipped_triangles_and_overlaps_hardly_matter() {
    let mut rng = Rng::new(2);
    let whole = ball(DVec3::ZERO, 1.0, 24);
    let exact = enclosed(&whole);
    let mut open = whole.clone();
    open.triangles.truncate(open.triangles.len() - 4);
    let mut flipped = whole.clone();
    for triangle in flipped.triangles.iter_mut().filter(|_| rng.unit() < 0.3) {
        triangle.swap(0, 1);
    }
    let mut inward = whole.clone();
    inward.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
    let twice = together(&[whole.clone(), ball(DVec3::ZERO, 0.7, 24)]);
    for (name, mesh) in [("open", &open), ("flipped", &flipped), ("inward", &inward), ("twice", &twice)] {
        for divisions in [7, 20, 40] {
            let found = volume(mesh, divisions, OccupancyChoice::Solid);
            assert!((found / exact - 1.0).abs() < 0.02, "{name} in {divisions}: {found}, not {exact}");
        }
    }
    assert!(!open.facts().closed, "a hole at a pole");
}

#[test]
fn a_sheet_weighs_its_area() {
    let area = |mesh: &TriMesh| {
        let of = |[a, b, c]: [DVec3; 3]| 0.5 * (b - a).cross(c - a).length();
        (0..mesh.triangles.len()).map(|at| of(mesh.corners(at))).sum::<f64>()
    };
    for (mesh, length) in [(sheet(), 1.0), (bowl(), 2.0)] {
        let exact = area(&mesh) * SHEET_SHARE * length;
        for divisions in [7, 20, 40] {
            for occupancy in [OccupancyChoice::Auto, OccupancyChoice::Surface] {
                let (filled, contents) = sampled(&mesh, divisions, occupancy);
                let found = filled.report.volume_m3;
                assert!(contents.of_surface && !contents.warnings().is_empty(), "and a person is told");
                assert!((found / exact - 1.0).abs() < 0.01, "{occupancy:?} in {divisions}: {found}, not {exact}");
            }
        }
    }
}

#[test]
fn a_plate_too_thin_for_the_samples_still_weighs_what_it_does() {
    let plate = solid_box([0.0, 0.1, 0.0], [1.0, 0.101, 0.7]);
    for divisions in [7, 20, 40] {
        let (filled, contents) = sampled(&plate, divisions, OccupancyChoice::Auto);
        let found = filled.report.volume_m3;
        assert!((found / 7e-4 - 1.0).abs() < 1e-6, "in {divisions}: {found}");
        let mean = contents.volume_cells() / contents.shares.len() as f64;
        assert!(contents.shares.iter().all(|share| *share > 0.4 * mean), "over all of it: {:?}", contents.shares);
    }
}

#[test]
fn no_cell_is_emptier_than_the_least_and_the_sum_stays() {
    let mut shares = vec![0.0, 0.01, 0.1, 0.13, 0.5, 1.0, 1.2];
    let all: f64 = shares.iter().sum();
    assert_eq!(raise_shares(&mut shares), 4, "the fourth sinks below as the others give");
    assert!((shares.iter().sum::<f64>() - all).abs() < 1e-12, "{shares:?}");
    assert!(shares[..4].iter().all(|share| (share - MIN_CELL_SHARE).abs() < 1e-12), "{shares:?}");
    assert!((shares[6] / shares[5] - 1.2).abs() < 1e-12, "the others keep their proportion: {shares:?}");
    let mut thin = vec![0.0, 0.002, 0.004];
    assert!(raise_shares(&mut thin) == 1 && (thin[0] - 0.001).abs() < 1e-15, "half the mean of a sheet: {thin:?}");
}

#[test]
fn a_part_that_was_dropped_weighs_nothing_and_a_person_is_told_of_what_is_lost() {
    let apart = together(&[solid_box([0.0; 3], [2.0, 1.0, 1.0]), solid_box([4.0, 0.0, 0.0], [5.0, 1.0, 1.0])]);
    let (filled, contents) = sampled(&apart, 10, OccupancyChoice::Auto);
    assert!((filled.report.volume_m3 - 2.0).abs() < 1e-6, "{} m³", filled.report.volume_m3);
    assert!((contents.lost - 1.0 / 3.0).abs() < 1e-6, "a third of it: {}", contents.lost);
    assert!(contents.warnings()[0].contains("33 %"), "{:?}", contents.warnings());
}
