//! Neighbour lists: pairs of a point of one body and a cell of another, or of the same, near enough for the point to get into
//! the cell before the bodies have moved past each other by more than a margin (Verlet, *Computer "experiments" on classical
//! fluids*, 1967).
//!
//! Lists are made from stored positions of the particles of each body; its displacements since lie within a box. A point is in
//! the box around a cell only if it was in that box then, grown by as much as the two boxes of displacements lie apart. So
//! a search with lists finds what one without does, to the last bit, and lists are no part of the state. Where one body flies
//! past another, only its own positions are stored anew: lists of bodies that lie together stay.

use std::ops::Range;

use glam::DVec3;

use super::buckets::{Buckets, CandidatePoint};
use super::cell::INSIDE_TOLERANCE;
use super::outcode::{are_beyond, write_outcodes};
use super::stored_positions::{StoredPositions, USED_MARGIN_SHARE, list_margin};
use super::surface_points::SurfacePoints;
use crate::math::{Aabb, Real};
use crate::physics::model::{BodyModel, Model};

/// A way is taken to be longer by this share of the margin, for rounding error in the distances of a list.
const ROUNDING_SHARE: f64 = 1e-3;

/// A point that may be in a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbour {
    /// The cell.
    pub(super) cell: u32,
    /// The point's place among those of the list.
    pub(super) place: u32,
    /// How far outside the box around the cell the point was when the list was made, m; negative inside.
    distance_outside: f32,
}

/// The list of a pair, as it is searched.
#[derive(Clone, Copy, Debug)]
pub(super) struct NeighbourListView<'a> {
    /// The points that may be in cells, by their numbers on the outside of their body.
    pub(super) points: &'a [u32],
    /// By cell, ascending.
    neighbours: &'a [Neighbour],
    /// How far the bodies may have moved past each other since, m.
    displacement: f32,
}

impl<'a> NeighbourListView<'a> {
    /// The points that may be in each cell by now, for the cells with any.
    pub(super) fn by_cell(self) -> impl Iterator<Item = (u32, impl Iterator<Item = u32> + use<'a>)> {
        let may_be_in = move |neighbour: &&Neighbour| neighbour.distance_outside <= self.displacement;
        let cells = self.neighbours.chunk_by(|one, next| one.cell == next.cell);
        cells.filter_map(move |of_cell| {
            let first = of_cell.iter().position(|neighbour| may_be_in(&neighbour))?;
            let places = of_cell[first..].iter().filter(may_be_in).map(|neighbour| neighbour.place);
            Some((of_cell[first].cell, places))
        })
    }
}

/// The list of one body's points and the cells of another.
#[derive(Clone, Debug)]
struct NeighbourList {
    /// The body whose cells they are.
    cell_body: usize,
    /// How often the positions of the two bodies had been stored when it was made.
    store_counts: [u32; 2],
    points: Range<usize>,
    neighbours: Range<usize>,
}

/// All lists of one body's points.
#[derive(Clone, Debug, Default)]
pub(super) struct NeighbourLists {
    lists: Vec<NeighbourList>,
    /// The points of all lists by their numbers on the outside, ascending in each list.
    points: Vec<u32>,
    /// By cell in each list, ascending.
    neighbours: Vec<Neighbour>,
    /// For the list that is being made: the outcodes of the cells' particles, for the bounding box of the points.
    outcodes: Vec<u8>,
    /// For the list that is being made: 1 for each point that has neighbours, later its place in the list.
    place_of: Vec<u32>,
}

impl NeighbourLists {
    /// Makes room for a body with this many points on its outside, among this many bodies.
    pub(super) fn new(points: usize, bodies: usize) -> Self {
        Self {
            lists: Vec::with_capacity(bodies.min(8)),
            points: Vec::with_capacity(2 * points),
            neighbours: Vec::with_capacity(8 * points),
            outcodes: Vec::new(),
            place_of: Vec::with_capacity(points),
        }
    }

    /// Returns the points on the outside of one body that may be in cells of another, and the cells that they may be in. Makes
    /// the list if it is missing or outdated; `candidates` and `buckets` are its workspace.
    pub(super) fn updated_list<R: Real>(
        &mut self,
        model: &Model<R>,
        (pair, surface_points): ([usize; 2], SurfacePoints<'_>),
        stored: &StoredPositions,
        candidates: &mut Vec<CandidatePoint>,
        buckets: &mut Buckets,
    ) -> NeighbourListView<'_> {
        let store_counts = stored.store_counts(pair);
        if self.lists.iter().any(|list| list.store_counts[0] != store_counts[0]) {
            self.lists.clear();
            self.points.clear();
            self.neighbours.clear();
        }
        if let Some(old) =
            self.lists.iter().position(|list| list.cell_body == pair[1] && list.store_counts != store_counts)
        {
            self.forget(old);
        }
        let known = self.lists.iter().position(|list| list.cell_body == pair[1]);
        let number = known.unwrap_or_else(|| {
            self.make(model, (pair, surface_points), stored, candidates, buckets);
            self.lists.len() - 1
        });
        let NeighbourList { points, neighbours, .. } = &self.lists[number];
        #[expect(clippy::cast_possible_truncation, reason = "what is lost is allowed for")]
        let displacement = (stored.relative_displacement(pair) / USED_MARGIN_SHARE) as f32
            + (ROUNDING_SHARE * list_margin(model, pair)) as f32;
        NeighbourListView {
            points: &self.points[points.clone()],
            neighbours: &self.neighbours[neighbours.clone()],
            displacement,
        }
    }

    /// Forgets a list.
    fn forget(&mut self, number: usize) {
        let NeighbourList { points, neighbours, .. } = self.lists.remove(number);
        self.points.drain(points.clone());
        self.neighbours.drain(neighbours.clone());
        for list in &mut self.lists[number..] {
            list.points = list.points.start - points.len()..list.points.end - points.len();
            list.neighbours = list.neighbours.start - neighbours.len()..list.neighbours.end - neighbours.len();
        }
    }

    /// Makes the list of a pair.
    fn make<R: Real>(
        &mut self,
        model: &Model<R>,
        (pair, surface_points): ([usize; 2], SurfacePoints<'_>),
        stored: &StoredPositions,
        candidates: &mut Vec<CandidatePoint>,
        buckets: &mut Buckets,
    ) {
        let ([points, cells], positions) = (pair.map(|number| &model.bodies[number]), &stored.positions);
        let (is_itself, margin) = (pair[0] == pair[1], list_margin(model, pair));
        let cell_size = cells.lattice.grid.cell_size;
        let reach = INSIDE_TOLERANCE * cell_size + margin;
        let own = &positions[cells.particles.clone()];
        let all = Aabb::<f64>::around(own.iter().copied()).grown(reach);
        candidates.clear();
        let own_points = &positions[points.particles.clone()];
        candidates.extend(surface_points.numbers().filter_map(|point| {
            let position = surface_points.position(point, own_points);
            all.holds(position).then_some(CandidatePoint::new(point, position))
        }));
        let first = (self.points.len(), self.neighbours.len());
        if !candidates.is_empty() {
            let bounds = Aabb::<f64>::around(candidates.iter().map(|candidate| candidate.position));
            buckets.sort(candidates, &bounds, cell_size);
            self.place_of.clear();
            self.place_of.resize(candidates.len(), 0);
            let region = bounds.grown(reach * (1.0 + ROUNDING_SHARE));
            write_outcodes(&region, own.iter().copied(), &mut self.outcodes);
            for number in candidate_cells(cells, is_itself) {
                // The corners of most cells are all beyond one side of the region.
                let corners = &cells.lattice.cells[number as usize];
                if are_beyond(corners, &self.outcodes) {
                    continue;
                }
                let cell = cell_bounds(cells, number, own).grown(INSIDE_TOLERANCE * cell_size);
                let around = cell.grown(margin);
                if !around.overlaps(&bounds) {
                    continue;
                }
                let low = cells.lattice.low(number);
                for place in buckets.near(&around) {
                    let CandidatePoint { point, position, .. } = candidates[place];
                    if around.holds(position) && !(is_itself && surface_points.touch(point, low)) {
                        self.place_of[place] = 1;
                        let distance_outside = (cell.min - position).max(position - cell.max).max_element();
                        #[expect(
                            clippy::cast_possible_truncation,
                            reason = "points are counted in 32 bits, and what is lost of a way is allowed for"
                        )]
                        self.neighbours.push(Neighbour {
                            cell: number,
                            place: place as u32,
                            distance_outside: distance_outside as f32,
                        });
                    }
                }
            }
            // Only points that have neighbours are in the list.
            let has_any = candidates.iter().zip(&mut self.place_of).filter(|(_, place)| **place > 0);
            for ((candidate, place), count) in has_any.zip(0..) {
                *place = count;
                self.points.push(candidate.point);
            }
            for neighbour in &mut self.neighbours[first.1..] {
                neighbour.place = self.place_of[neighbour.place as usize];
            }
        }
        let (points, neighbours) = (first.0..self.points.len(), first.1..self.neighbours.len());
        self.lists.push(NeighbourList {
            cell_body: pair[1],
            store_counts: stored.store_counts(pair),
            points,
            neighbours,
        });
    }
}

/// The cells of a body in which points of another, or of the same, are looked for, ascending.
pub(super) fn candidate_cells<R: Real>(body: &BodyModel<R>, is_itself: bool) -> impl Iterator<Item = u32> {
    #[expect(clippy::cast_possible_truncation, reason = "cells are counted in 32 bits")]
    let all = 0..body.lattice.cells.len() as u32;
    let (all, outer) = if is_itself { (0..0, body.hull().outer_cells.as_slice()) } else { (all, &[][..]) };
    all.chain(outer.iter().copied())
}

/// The box around a cell of a body whose particles are at `own`, m.
pub(super) fn cell_bounds<R: Real>(body: &BodyModel<R>, cell: u32, own: &[DVec3]) -> Aabb<f64> {
    Aabb::<f64>::around(body.lattice.cells[cell as usize].iter().map(|corner| own[*corner as usize]))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::stored_positions::LIST_MARGIN;
    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::Simulation;
    use crate::scene::body::CubeShape;
    use crate::scene::resolve::resolve;
    use crate::scene::{Body, Scene, Shape};

    /// Two cubes of four cells along each side, a bit inside each other.
    fn two() -> Simulation<f64> {
        let cube = |height: f64| {
            let mut body = Body { shape: Shape::Cube(CubeShape { cells: 4, size: 0.4 }), ..Body::default() };
            (body.pose.position, body.pose.rotation_deg) = ([0.0, height, 0.0], [10.0, 20.0, height]);
            body
        };
        let scene = Scene { bodies: vec![cube(0.0), cube(0.35)], ..Scene::default() };
        let lattices: Vec<_> = (scene.bodies.iter())
            .map(|body| resolve(&body.shape, Path::new("."), &()).expect("a cube").lattice)
            .collect();
        Simulation::new(&scene, &lattices)
    }

    /// Particles near where they are, the first body moved by `way` (m) and everything by up to `by` (m).
    fn moved(simulation: &Simulation<f64>, rng: &mut Rng, way: f64, by: f64) -> Vec<DVec3> {
        let first = simulation.model().bodies[0].particles.clone();
        let places = simulation.state().position.iter().enumerate();
        let mut along = move |particle: usize| {
            let shaken = DVec3::from([0; 3].map(|_| rng.between(-by, by)));
            if first.contains(&particle) { shaken + DVec3::Y * way } else { shaken }
        };
        places.map(|(particle, at)| *at + along(particle)).collect()
    }

    /// The workspace that lists are made in.
    struct Room {
        stored: StoredPositions,
        lists: [NeighbourLists; 2],
        candidates: Vec<CandidatePoint>,
        buckets: Buckets,
    }

    impl Room {
        fn new(model: &Model<f64>) -> Self {
            Self {
                stored: StoredPositions::new(model.particle_count(), model.bodies.len()),
                lists: [NeighbourLists::default(), NeighbourLists::default()],
                candidates: Vec::new(),
                buckets: Buckets::new(1000),
            }
        }

        /// How many points are in the boxes of cells, and how many of those are in the list of their bodies.
        fn in_boxes(&mut self, simulation: &Simulation<f64>, of: [usize; 2], predicted: &[DVec3]) -> [usize; 2] {
            let Self { stored, lists, candidates, buckets } = self;
            let model = simulation.model();
            stored.update_displacements(simulation.plan(), model, predicted);
            stored.renew_outdated(model, &[of], predicted);
            let list =
                lists[of[0]].updated_list(model, (of, SurfacePoints::of(model, of)), stored, candidates, buckets);
            let near: Vec<(u32, Vec<u32>)> = list.by_cell().map(|(cell, places)| (cell, places.collect())).collect();
            let [points, cells] = of.map(|number| &model.bodies[number]);
            let own = &predicted[cells.particles.clone()];
            let (mut all, mut listed) = (0, 0);
            for (point, particle) in (0..).zip(&points.hull().points) {
                let at = predicted[points.particles.start + *particle as usize];
                for cell in candidate_cells(cells, false).filter(|cell| cell_bounds(cells, *cell, own).holds(at)) {
                    all += 1;
                    let of_cell = near.iter().filter(|(of, _)| *of == cell).flat_map(|(_, places)| places);
                    listed += of_cell.filter(|place| list.points[**place as usize] == point).count();
                }
            }
            [all, listed]
        }
    }

    #[test]
    fn every_point_in_the_box_of_a_cell_is_listed_once_as_long_as_lists_are_kept() {
        let (simulation, mut rng) = (two(), Rng::new(11));
        let mut room = Room::new(simulation.model());
        let mut most = 0;
        for round in 0..60 {
            let predicted = moved(&simulation, &mut rng, 0.003 * f64::from(round), 2e-3);
            for of in [[0, 1], [1, 0]] {
                let [all, listed] = room.in_boxes(&simulation, of, &predicted);
                assert_eq!(all, listed, "of {of:?} in round {round}");
                most = most.max(all);
            }
        }
        assert!(most > 50, "{most} points are in cells");
    }

    #[test]
    fn lists_are_kept_until_bodies_have_moved_past_each_other() {
        let (simulation, mut rng) = (two(), Rng::new(12));
        let mut room = Room::new(simulation.model());
        let mut made_of = |way: f64| {
            let predicted = moved(&simulation, &mut rng, way, 0.0);
            room.in_boxes(&simulation, [0, 1], &predicted);
            room.stored.positions.clone()
        };
        let first = made_of(0.0);
        assert_eq!(made_of(0.9 * LIST_MARGIN * 0.1), first, "within the margin");
        let (then, second) = (made_of(1.1 * LIST_MARGIN * 0.1), simulation.model().bodies[1].particles.start);
        assert_ne!(then[..second], first[..second], "beyond it");
        assert_eq!(then[second..], first[second..], "the other, which stays");
    }

    #[test]
    fn what_moved_along_with_a_body_that_is_written_down_anew_is_too() {
        let (simulation, mut rng) = (two(), Rng::new(13));
        let model = simulation.model();
        let [start, then] = [0.0, 1.0]
            .map(|by| moved(&simulation, &mut rng, 0.0, 0.0).iter().map(|at| *at + DVec3::Y * by).collect::<Vec<_>>());
        let mut stored = StoredPositions::new(model.particle_count(), 2);
        stored.update_displacements(simulation.plan(), model, &start);
        stored.update_displacements(simulation.plan(), model, &then);
        stored.renew_outdated(model, &[[0, 1], [1, 0]], &then);
        assert_eq!(stored.positions, start, "they have not moved past each other");
        stored.displacement_bounds[0].max += DVec3::X;
        stored.renew_outdated(model, &[[1, 0], [0, 1]], &then);
        assert_eq!(stored.positions, then);
    }
}
