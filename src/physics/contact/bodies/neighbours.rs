//! Neighbour lists: which points of one body are so near which cells of another, or of the same, that they can be in them
//! until bodies have moved past each other by more than a margin (Verlet, *Computer "experiments" on classical fluids*, 1967).
//!
//! Lists are made of where particles were at some time, from which every body has moved since by displacements within a box.
//! A point is in the box around a cell only where it was in the one then, grown by as much as the two boxes of displacements
//! lie apart. So what is found by them is what is found without, to the last bit, and they are no part of the state.

use std::ops::Range;

use glam::DVec3;

use super::buckets::{Buckets, Seen};
use super::cell::TOLERANCE;
use crate::math::{Aabb, Real};
use crate::physics::kernels::{SimdLevel, bounds_of_ways};
use crate::physics::model::{BodyModel, Model};

/// How far bodies may move past each other until lists are made anew, in cells.
const MARGIN: f64 = 0.15;

/// The share of it that is used: the rest is rounding.
const USED: f64 = 0.999;

/// The share of it that a way is taken to be longer by, for rounding in what is near.
const ROUNDING: f64 = 1e-3;

/// A point that may be in a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbour {
    /// The cell.
    pub(super) cell: u32,
    /// The point's place among those of the list.
    pub(super) place: u32,
    /// How far outside the box around the cell the point was when the list was made, m; less than nothing inside.
    beyond: f32,
}

/// The list of a pair, as it is looked through.
#[derive(Clone, Copy, Debug)]
pub(super) struct Listed<'a> {
    /// The points that may be in cells, by their places on the hull.
    pub(super) points: &'a [u32],
    /// By cell, ascending.
    pairs: &'a [Neighbour],
    /// How far the bodies may have moved past each other since, m.
    way: f32,
}

impl<'a> Listed<'a> {
    /// What may be in each cell by now, of the cells where anything may be.
    pub(super) fn by_cell(self) -> impl Iterator<Item = (u32, impl Iterator<Item = u32> + use<'a>)> {
        let may_be_in = move |neighbour: &&Neighbour| neighbour.beyond <= self.way;
        let cells = self.pairs.chunk_by(|one, next| one.cell == next.cell);
        cells.filter_map(move |of_cell| {
            let first = of_cell.iter().position(|neighbour| may_be_in(&neighbour))?;
            let places = of_cell[first..].iter().filter(may_be_in).map(|neighbour| neighbour.place);
            Some((of_cell[first].cell, places))
        })
    }
}

/// The list of one body's points and another's cells.
#[derive(Clone, Debug)]
struct List {
    of: [usize; 2],
    points: Range<usize>,
    pairs: Range<usize>,
}

/// All lists there are.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbours {
    /// Where particles were when the lists were made, m.
    then: Vec<DVec3>,
    /// The box around the displacements of each body since, m.
    moved: Vec<Aabb<f64>>,
    lists: Vec<List>,
    /// The points of all lists by their places on the hulls, ascending in each list.
    points: Vec<u32>,
    /// By cell in each list, ascending.
    pairs: Vec<Neighbour>,
    /// The points of the list that is being made.
    seen: Vec<Seen>,
    /// 1 for each of them that has neighbours, and then its place in the list.
    place_of: Vec<u32>,
}

impl Neighbours {
    /// Room for bodies that have so many points on their outside, all and the one with the most, and so many particles.
    pub(super) fn new(all: usize, most: usize, particles: usize, bodies: usize) -> Self {
        Self {
            then: Vec::with_capacity(particles),
            moved: Vec::with_capacity(bodies),
            lists: Vec::with_capacity(bodies * bodies.min(8)),
            points: Vec::with_capacity(2 * all),
            pairs: Vec::with_capacity(8 * all),
            seen: Vec::with_capacity(most),
            place_of: Vec::with_capacity(most),
        }
    }

    /// Bodies would be there (m) at the end of the substep.
    pub(super) fn follow<R: Real>(&mut self, level: SimdLevel, model: &Model<R>, ahead: &[DVec3]) {
        if self.then.len() != ahead.len() {
            self.start(model, ahead);
            return;
        }
        self.moved.clear();
        self.moved.extend(model.bodies.iter().map(|body| {
            let [then, now] = [&self.then, ahead].map(|of| &of[body.particles.clone()]);
            bounds_of_ways::<f64>(level, then, now)
        }));
    }

    /// Makes all lists anew, of these places.
    fn start<R: Real>(&mut self, model: &Model<R>, ahead: &[DVec3]) {
        self.lists.clear();
        self.points.clear();
        self.pairs.clear();
        self.then.clear();
        self.then.extend_from_slice(ahead);
        self.moved.clear();
        self.moved.resize(model.bodies.len(), Aabb { min: DVec3::ZERO, max: DVec3::ZERO });
    }

    /// The points of one body that may be in cells of another, and which these may be in.
    pub(super) fn list<R: Real>(
        &mut self,
        model: &Model<R>,
        of: [usize; 2],
        ahead: &[DVec3],
        buckets: &mut Buckets,
    ) -> Listed<'_> {
        let margin = MARGIN * of.map(|number| model.bodies[number].lattice.grid.cell_size)[1];
        let way = |moved: &[Aabb<f64>]| {
            let [points, cells] = of.map(|number| moved[number]);
            (points.max - cells.min).max(cells.max - points.min).max_element()
        };
        let gone = way(&self.moved);
        // What is not a number is no way either.
        if gone.is_nan() || gone > USED * margin {
            self.start(model, ahead);
        }
        let known = self.lists.iter().position(|list| list.of == of);
        let number = known.unwrap_or_else(|| {
            self.make(model, of, margin, buckets);
            self.lists.len() - 1
        });
        let List { points, pairs, .. } = &self.lists[number];
        #[expect(clippy::cast_possible_truncation, reason = "what is lost is allowed for")]
        let way = (way(&self.moved) / USED) as f32 + (ROUNDING * margin) as f32;
        Listed { points: &self.points[points.clone()], pairs: &self.pairs[pairs.clone()], way }
    }

    /// Makes the list of a pair.
    fn make<R: Real>(&mut self, model: &Model<R>, of: [usize; 2], margin: f64, buckets: &mut Buckets) {
        let [points, cells] = of.map(|number| &model.bodies[number]);
        let (hull, is_itself) = (points.hull(), of[0] == of[1]);
        let cell_size = cells.lattice.grid.cell_size;
        let reach = TOLERANCE * cell_size + margin;
        let own = &self.then[cells.particles.clone()];
        let all = Aabb::<f64>::around(own.iter().copied()).grown(reach);
        self.seen.clear();
        self.seen.extend((0..).zip(&hull.points).filter_map(|(point, particle)| {
            let then = self.then[points.particles.start + *particle as usize];
            all.holds(then).then_some(Seen::of(point, then))
        }));
        let first = (self.points.len(), self.pairs.len());
        if !self.seen.is_empty() {
            let bounds = Aabb::<f64>::around(self.seen.iter().map(|seen| seen.ahead));
            buckets.sort(&self.seen, &bounds, cell_size);
            self.place_of.clear();
            self.place_of.resize(self.seen.len(), 0);
            for number in looked_at(cells, is_itself) {
                let cell = around(cells, number, own).grown(TOLERANCE * cell_size);
                let around = cell.grown(margin);
                if !around.overlaps(&bounds) {
                    continue;
                }
                let low = cells.lattice.low(number);
                for place in buckets.near(&around) {
                    let Seen { point, ahead, .. } = self.seen[place];
                    if around.holds(ahead) && !(is_itself && hull.surroundings[point as usize].touch(low)) {
                        self.place_of[place] = 1;
                        let beyond = (cell.min - ahead).max(ahead - cell.max).max_element();
                        #[expect(
                            clippy::cast_possible_truncation,
                            reason = "points are counted in 32 bits, and what is lost of a way is allowed for"
                        )]
                        self.pairs.push(Neighbour { cell: number, place: place as u32, beyond: beyond as f32 });
                    }
                }
            }
            // Only those that have neighbours are in the list.
            let has_any = self.seen.iter().zip(&mut self.place_of).filter(|(_, place)| **place > 0);
            for ((seen, place), count) in has_any.zip(0..) {
                *place = count;
                self.points.push(seen.point);
            }
            for neighbour in &mut self.pairs[first.1..] {
                neighbour.place = self.place_of[neighbour.place as usize];
            }
        }
        let (points, pairs) = (first.0..self.points.len(), first.1..self.pairs.len());
        self.lists.push(List { of, points, pairs });
    }
}

/// The cells of a body in which points of another, or of the same, are looked for, ascending.
pub(super) fn looked_at<R: Real>(body: &BodyModel<R>, is_itself: bool) -> impl Iterator<Item = u32> {
    #[expect(clippy::cast_possible_truncation, reason = "cells are counted in 32 bits")]
    let all = 0..body.lattice.cells.len() as u32;
    let (all, outer) = if is_itself { (0..0, body.hull().outer.as_slice()) } else { (all, &[][..]) };
    all.chain(outer.iter().copied())
}

/// The box around a cell of a body whose particles are there, m.
pub(super) fn around<R: Real>(body: &BodyModel<R>, cell: u32, own: &[DVec3]) -> Aabb<f64> {
    Aabb::<f64>::around(body.lattice.cells[cell as usize].iter().map(|corner| own[*corner as usize]))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

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

    /// How many points are in the boxes of cells, and how many of those are in the list of their bodies.
    fn in_boxes(model: &Model<f64>, of: [usize; 2], ahead: &[DVec3], lists: &mut Neighbours) -> [usize; 2] {
        let mut buckets = Buckets::new(1000);
        lists.follow(SimdLevel::best(), model, ahead);
        let list = lists.list(model, of, ahead, &mut buckets);
        let near: Vec<(u32, Vec<u32>)> = list.by_cell().map(|(cell, places)| (cell, places.collect())).collect();
        let [points, cells] = of.map(|number| &model.bodies[number]);
        let own = &ahead[cells.particles.clone()];
        let (mut all, mut listed) = (0, 0);
        for (point, particle) in (0..).zip(&points.hull().points) {
            let at = ahead[points.particles.start + *particle as usize];
            for cell in looked_at(cells, false).filter(|cell| around(cells, *cell, own).holds(at)) {
                all += 1;
                let of_cell = near.iter().filter(|(of, _)| *of == cell).flat_map(|(_, places)| places);
                listed += of_cell.filter(|place| list.points[**place as usize] == point).count();
            }
        }
        [all, listed]
    }

    #[test]
    fn every_point_in_the_box_of_a_cell_is_listed_once_as_long_as_lists_are_kept() {
        let (simulation, mut rng) = (two(), Rng::new(11));
        let (model, mut lists) = (simulation.model(), Neighbours::default());
        let mut most = 0;
        for round in 0..60 {
            let ahead = moved(&simulation, &mut rng, 0.003 * f64::from(round), 2e-3);
            for of in [[0, 1], [1, 0]] {
                let [all, listed] = in_boxes(model, of, &ahead, &mut lists);
                assert_eq!(all, listed, "of {of:?} in round {round}");
                most = most.max(all);
            }
        }
        assert!(most > 50, "{most} points are in cells");
    }

    #[test]
    fn lists_are_kept_until_bodies_have_moved_past_each_other() {
        let (simulation, mut rng) = (two(), Rng::new(12));
        let (model, mut lists) = (simulation.model(), Neighbours::default());
        let mut made_of = |way: f64| {
            let ahead = moved(&simulation, &mut rng, way, 0.0);
            in_boxes(model, [0, 1], &ahead, &mut lists);
            lists.then.clone()
        };
        let first = made_of(0.0);
        assert_eq!(made_of(0.9 * MARGIN * 0.1), first, "within the margin");
        assert_ne!(made_of(1.1 * MARGIN * 0.1), first, "beyond it");
    }
}
