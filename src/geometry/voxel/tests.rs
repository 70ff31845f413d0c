//! Meshes in, cells out: the three ways, the choice between them and what the report says.

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::geometry::trimesh::tests::{boxed, together};

pub(super) fn run(mesh: &TriMesh, divisions: u32, occupancy: OccupancyChoice, keep: Keep) -> Voxelization {
    voxelize(mesh, &VoxelizeOptions { divisions, occupancy, keep }, &()).expect("a sensible mesh")
}

fn auto(mesh: &TriMesh, divisions: u32) -> Voxelization {
    run(mesh, divisions, OccupancyChoice::Auto, Keep::All)
}

pub(super) fn solid_box(min: [f64; 3], max: [f64; 3]) -> TriMesh {
    boxed(DVec3::from_array(min), DVec3::from_array(max))
}

/// A square of the plane y = 0, seen from above.
pub(super) fn sheet() -> TriMesh {
    let positions = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]].map(|[x, z]| DVec3::new(x, 0.0, z));
    TriMesh { positions: positions.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]] }
}

/// A ball of latitudes and longitudes.
pub(super) fn ball(center: DVec3, radius: f64, rings: u32) -> TriMesh {
    let sides = 2 * rings;
    let at = |ring: u32, side: u32| {
        let (latitude, longitude) = (f64::from(ring) / f64::from(rings), f64::from(side % sides) / f64::from(rings));
        let (latitude, longitude) = (latitude * std::f64::consts::PI, longitude * std::f64::consts::PI);
        let (width, height) = if ring == rings { (0.0, -1.0) } else { (libm::sin(latitude), libm::cos(latitude)) };
        center + radius * DVec3::new(width * libm::cos(longitude), height, width * libm::sin(longitude))
    };
    let mut mesh = TriMesh::default();
    for (ring, side) in (0..rings).flat_map(|ring| (0..sides).map(move |side| (ring, side))) {
        let base = u32::try_from(mesh.positions.len()).expect("small");
        mesh.positions.extend([at(ring, side), at(ring, side + 1), at(ring + 1, side + 1), at(ring + 1, side)]);
        mesh.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    }
    mesh
}

#[test]
fn a_box_on_cell_boundaries_gives_exactly_its_cells() {
    let brick = solid_box([0.1, 0.2, 0.3], [0.7, 0.4, 0.7]);
    for occupancy in [OccupancyChoice::Auto, OccupancyChoice::Centre, OccupancyChoice::Solid] {
        for (divisions, dims) in [(3, [3, 1, 2]), (6, [6, 2, 4])] {
            let Voxelization { cells, report } = run(&brick, divisions, occupancy, Keep::Largest);
            assert_eq!((cells.grid.dims, cells.count()), (dims, cells.grid.len()), "{occupancy:?} {divisions}");
            assert_eq!((report.components, report.dropped_cells, report.warnings.len()), (1, 0, 0), "nothing to say");
        }
    }
    assert_eq!(run(&brick, 6, OccupancyChoice::Surface, Keep::All).cells.count(), 48, "all are at the wall");
}

#[test]
fn a_shape_of_blocks_gives_exactly_its_blocks_under_centre_and_solid() {
    let l = together(&[solid_box([0.0, 0.0, 0.0], [2.0, 1.0, 1.0]), solid_box([0.0, 1.0, 0.0], [1.0, 4.0, 1.0])]);
    for occupancy in [OccupancyChoice::Auto, OccupancyChoice::Centre, OccupancyChoice::Solid] {
        for divisions in [4, 8] {
            let blocks = (divisions / 4_usize).pow(3) * 5;
            let divisions = u32::try_from(divisions).expect("small");
            assert_eq!(run(&l, divisions, occupancy, Keep::All).cells.count(), blocks, "{occupancy:?} {divisions}");
        }
    }
}

#[test]
fn a_ball_fills_its_volume() {
    let ball = ball(DVec3::new(3.0, 4.0, 5.0), 2.0, 40);
    let Voxelization { cells, report } = auto(&ball, 40);
    assert_eq!((report.occupancy, report.closed), (OccupancyChoice::Centre, true), "closed, so centre");
    let volume = cells.count() as f64 * cells.grid.cell_size.powi(3) / (4.0 / 3.0 * std::f64::consts::PI * 8.0);
    assert!((volume - 1.0).abs() < 0.01, "{volume} of the ball's volume");
    let mut inverted = ball;
    for triangle in &mut inverted.triangles {
        triangle.swap(0, 1);
    }
    assert_eq!(auto(&inverted, 40).cells, cells, "inside-out makes no difference");
}

#[test]
fn a_ball_with_holes_is_filled_all_the_same() {
    let mut ball = ball(DVec3::ZERO, 1.0, 30);
    let whole = run(&ball, 20, OccupancyChoice::Solid, Keep::All);
    ball.triangles.retain(|triangle| triangle[0] % 37 != 0);
    let holed = auto(&ball, 20);
    assert!(holed.report.boundary_edges > 50, "many holes");
    assert_eq!(holed.report.occupancy, OccupancyChoice::Solid, "open, so solid");
    let lost = whole.cells.count() - holed.cells.count();
    assert!(lost < whole.cells.count() / 100, "holes smaller than a cell do not leak: {lost} cells lost");
}

#[test]
fn solid_contains_surface_and_surface_contains_what_centre_lacks() {
    let ball = ball(DVec3::ZERO, 1.0, 20);
    let [centre, surface, solid] = [OccupancyChoice::Centre, OccupancyChoice::Surface, OccupancyChoice::Solid]
        .map(|occupancy| run(&ball, 12, occupancy, Keep::All).cells.filled);
    for cell in 0..solid.len() {
        assert_eq!(solid[cell], surface[cell] || centre[cell], "solid is the surface and the inside, cell {cell}");
    }
    assert!(surface != solid, "the surface alone is hollow");
}

#[test]
fn a_flat_sheet_gives_one_layer() {
    let Voxelization { cells, report } = auto(&sheet(), 5);
    assert_eq!((cells.grid.dims, cells.count()), ([5, 1, 5], 25), "one layer of cells");
    assert_eq!(report.occupancy, OccupancyChoice::Surface, "nothing to enclose");
    assert_eq!(report.thin_parts, 1, "thinner than a cell");
    let centre = voxelize(&sheet(), &VoxelizeOptions { occupancy: OccupancyChoice::Centre, ..Default::default() }, &());
    assert_eq!(centre, Err(VoxelizeError::NoCells(20)), "no centre is inside a sheet");
}

#[test]
fn a_sheet_between_cells_fills_one_side() {
    let posts = [0.0, 1.0].map(|x| solid_box([x, -0.5, 0.0], [x + 1e-3, 0.5, 1e-3]));
    let table = together(&[sheet(), posts[0].clone(), posts[1].clone()]);
    let Voxelization { cells, .. } = run(&table, 4, OccupancyChoice::Surface, Keep::All);
    let layer = |j: u32| cells.iter().filter(|cell| cell[1] == j).count();
    assert_eq!([0, 1, 2, 3].map(layer), [2, 16, 2, 2], "the sheet at half height fills the layer below");
}

#[test]
fn the_automatic_choice_says_why_it_leaves_centre() {
    let plate = |x: f64| solid_box([x, 0.0, 0.0], [x + 0.01, 1.0, 1.0]);
    let thin = auto(&together(&[plate(0.0), plate(1.0)]), 4).report;
    assert_eq!((thin.occupancy, thin.thin_parts), (OccupancyChoice::Solid, 2), "no centre inside: {}", thin.why);
    let speck = together(&[solid_box([0.0; 3], [1.0; 3]), solid_box([2.0; 3], [2.01; 3])]);
    let speck = auto(&speck, 10).report;
    assert!(speck.why.contains("1 of its 2 parts"), "the speck would be lost: {}", speck.why);
    let crossing = together(&[solid_box([0.0; 3], [2.0; 3]), solid_box([1.0; 3], [3.0; 3])]);
    let crossing = auto(&crossing, 6);
    assert!(crossing.report.why.contains("passes through itself"), "parity: {}", crossing.report.why);
    assert_eq!(crossing.cells.count(), 64 + 64 - 8, "the overlap is filled");
}

#[test]
fn repeated_triangles_count_once() {
    let ball = ball(DVec3::ZERO, 1.0, 20);
    let mut repeated = ball.clone();
    repeated.triangles.extend(ball.triangles.iter().map(|&[a, b, c]| [b, c, a]));
    let twice = auto(&repeated, 12);
    assert_eq!(twice.cells, auto(&ball, 12).cells, "parity would find nothing inside");
    assert_eq!(twice.report.warnings.len(), 1, "said once: {:?}", twice.report.warnings);
}

#[test]
fn legs_too_thin_for_a_centre_are_kept() {
    let legs = [0.0, 3.6].map(|x| solid_box([x, 0.0, 0.0], [x + 0.4, 3.0, 0.4]));
    let table = together(&[solid_box([0.0, 3.0, 0.0], [4.0, 5.0, 4.0]), legs[0].clone(), legs[1].clone()]);
    let joined = auto(&table, 5);
    assert_eq!(joined.report.occupancy, OccupancyChoice::Solid, "the legs hold no centre: {}", joined.report.why);
    assert_eq!(joined.cells.count(), 2 * 16 + 2 * 3, "a top of two layers and two legs of three cells");
}

#[test]
fn components_are_counted_kept_or_dropped() {
    let boxes = [0.0, 2.0, 8.0].map(|x| solid_box([x, 0.0, 0.0], [x + 1.0, if x > 7.0 { 2.0 } else { 1.0 }, 1.0]));
    let Voxelization { cells, report } = run(&together(&boxes), 9, OccupancyChoice::Auto, Keep::Largest);
    assert_eq!((report.parts, report.components, report.dropped_cells, cells.count()), (3, 3, 2, 2), "the tall one");
    assert_eq!(report.warnings.len(), 2, "dropped cells, absent parts: {:?}", report.warnings);
    let all = auto(&together(&boxes), 9).report;
    assert_eq!((all.cells, all.joined_parts, all.dropped_cells), (4, 0, 0), "a cell of air keeps them apart");
}

#[test]
fn parts_that_a_cell_joins_are_counted() {
    let boxes = [0.0, 1.1, 8.0].map(|x| solid_box([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0]));
    let report = auto(&together(&boxes), 9).report;
    assert_eq!((report.parts, report.components, report.joined_parts), (3, 2, 2), "a gap of a tenth is bridged");
}

struct Never;

impl Watch for Never {
    fn cancelled(&self) -> bool {
        true
    }
}

#[test]
fn what_cannot_be_filled_is_refused() {
    let fails = |mesh: &TriMesh, divisions: u32| {
        voxelize(mesh, &VoxelizeOptions { divisions, ..Default::default() }, &()).expect_err("refused")
    };
    assert_eq!(fails(&sheet(), 0), VoxelizeError::Divisions(0), "no cells");
    assert_eq!(fails(&sheet(), 100_000), VoxelizeError::Divisions(100_000), "too many cells");
    assert_eq!(fails(&TriMesh::default(), 20), VoxelizeError::NoTriangles, "nothing");
    let line = TriMesh { positions: vec![DVec3::ZERO, DVec3::ONE, DVec3::splat(2.0)], triangles: vec![[0, 1, 2]] };
    assert_eq!(fails(&line, 20), VoxelizeError::NoArea, "a line");
    let point = TriMesh { positions: vec![DVec3::ONE], triangles: vec![[0, 0, 0]] };
    assert_eq!(fails(&point, 20), VoxelizeError::Extent(0.0), "a point");
    let cancelled = voxelize(&solid_box([0.0; 3], [1.0; 3]), &VoxelizeOptions::default(), &Never);
    assert_eq!(cancelled, Err(VoxelizeError::Cancelled), "stopped");
}

#[test]
fn the_result_is_the_same_for_any_number_of_threads() {
    let mesh = together(&[ball(DVec3::ZERO, 1.0, 40), ball(DVec3::X * 1.9, 1.0, 30), sheet()]);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| auto(&mesh, 30))
    };
    assert_eq!(with(1), with(4), "cells and report");
}

fn asset(bytes: &[u8]) -> TriMesh {
    let imported = crate::geometry::import::parse_obj(bytes, "asset").expect("a good file");
    assert_eq!(imported.warnings, [""; 0], "nothing is left out");
    imported.mesh
}

#[test]
fn the_tree_is_its_blocks_and_stands_on_its_roots() {
    let tree = asset(include_bytes!("../../../assets/tree.obj"));
    for (divisions, cells) in [(10, 214), (20, 214 * 8)] {
        let report = auto(&tree, divisions).report;
        assert_eq!((report.cells, report.components, report.non_manifold_edges), (cells, 1, 0), "{report:?}");
    }
    let roots = auto(&tree, 10).cells.iter().filter(|cell| cell[1] == 0).count();
    assert_eq!(roots, 21, "the lowest layer");
}

/// A triangle, one with two corners at the same place, and one whose corners are in a line.
#[test]
fn solid_holds_what_a_triangle_without_width_touches() {
    let corners = [[0, 0, 0], [6, 6, 8], [6, 6, 8], [0, 0, 0], [0, 0, 1], [0, 1, 0], [0, 1, 8], [2, 1, 8], [1, 1, 8]];
    let positions: Vec<DVec3> =
        corners.iter().map(|corner: &[u8; 3]| DVec3::from_array(corner.map(f64::from))).collect();
    let mesh = TriMesh { triangles: vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]], positions };
    let [surface, solid] = [OccupancyChoice::Surface, OccupancyChoice::Solid].map(|how| run(&mesh, 2, how, Keep::All));
    assert!(surface.cells.filled.is_subset(&solid.cells.filled), "{:?} of {:?}", surface.cells, solid.cells);
    assert!(surface.cells.is_filled([0, 0, 0]) && surface.cells.count() > 2, "{:?}", surface.cells);
}

#[test]
fn the_coupler_is_one_body_with_a_bore_at_every_resolution() {
    let coupler = asset(include_bytes!("../../../assets/coupler.obj"));
    for (divisions, rough) in [(7, 144), (8, 212), (20, 3273), (40, 26104)] {
        let Voxelization { cells, report } = auto(&coupler, divisions);
        assert_eq!((report.closed, report.parts, report.non_manifold_edges), (true, 1, 0), "a closed surface");
        assert_eq!(
            (report.components, report.cells, report.occupancy),
            (1, rough, OccupancyChoice::Centre),
            "{divisions}"
        );
        let [nx, ny, nz] = report.dims;
        assert!((0..ny).all(|j| !cells.is_filled([nx / 2, j, nz / 2])), "the bore goes through at {divisions}");
        let layer = |j: u32| cells.iter().filter(|cell| cell[1] == j).count();
        assert!(
            (0..ny).all(|j| layer(j) <= layer(0) + layer(0) / 5),
            "the flat end is as wide as any layer, but for its chamfer, at {divisions}"
        );
    }
}

/// The defects that SC lists for its bridge: parts that only cells join, as they cross or lie less than a cell apart,
/// isolated polygons, skinny triangles, open ends.
#[test]
fn the_bridge_has_every_defect_and_weighs_alike_in_any_number_of_divisions() {
    let bridge = asset(include_bytes!("../../../assets/bridge.obj"));
    let slim = |at: &usize| {
        let [a, b, c] = bridge.corners(*at);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        (b - a).cross(c - a).length() < 0.02 * longest * longest
    };
    assert!((0..bridge.triangles.len()).filter(slim).count() >= 20, "skinny triangles");
    let facts = bridge.facts();
    let mut of_part = vec![0; facts.parts];
    facts.part_of_triangle.iter().for_each(|part| of_part[*part as usize] += 1);
    assert!(of_part.iter().filter(|count| **count <= 2).count() >= 20, "polygons by themselves");
    assert!(facts.boundary_edges > 1000 && facts.parts == 310, "open ends, loose parts");
    let filled = auto(&bridge, 90).report;
    assert_eq!((filled.components, filled.joined_parts), (1, 310), "cells join all of it: {filled:?}");
    let weighs = [7, 10, 20, 40].map(|divisions| {
        let mut filled = auto(&bridge, divisions);
        filled.sample(&bridge, &()).expect("nobody stops it");
        filled.report.volume_m3
    });
    assert!(weighs.iter().all(|volume| (volume / weighs[3] - 1.0).abs() < 0.02), "{weighs:?}");
}

#[test]
fn spot_is_one_closed_body() {
    let report = auto(&asset(include_bytes!("../../../assets/spot.obj")), 20).report;
    assert_eq!((report.triangles, report.closed, report.parts), (5856, true, 1), "as published");
    assert_eq!((report.components, report.occupancy), (1, OccupancyChoice::Centre), "{}", report.why);
}

proptest! {
    #[test]
    fn any_triangles_on_and_off_the_grid_give_cells_or_a_sentence(
        corners in prop::collection::vec(prop::array::uniform3(0_u8..9), 3..40),
        divisions in 1_u32..9,
    ) {
        let positions: Vec<DVec3> = corners.iter().map(|&at| DVec3::from_array(at.map(f64::from)) * 0.5).collect();
        let triangles = (0..u32::try_from(positions.len() / 3).expect("small")).map(|at| [3 * at, 3 * at + 1, 3 * at + 2]);
        let mesh = TriMesh { triangles: triangles.collect(), positions };
        let fill = |occupancy| voxelize(&mesh, &VoxelizeOptions { divisions, occupancy, keep: Keep::All }, &());
        let (surface, solid) = (fill(OccupancyChoice::Surface), fill(OccupancyChoice::Solid));
        prop_assert_eq!(surface.is_ok(), !mesh.is_degenerate(), "an area gives cells");
        if let (Ok(surface), Ok(solid)) = (surface, solid) {
            prop_assert!(surface.cells.filled.is_subset(&solid.cells.filled), "solid holds the surface");
            prop_assert!(fill(OccupancyChoice::Auto).is_ok(), "the automatic choice finds a way");
        }
        if let Ok(centre) = fill(OccupancyChoice::Centre) {
            prop_assert!(centre.cells.count() > 0, "success means cells");
        }
    }
}
