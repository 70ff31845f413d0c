//! The points of a modal body that meet obstacles: particles of its hull, or points of its mesh, in a tree of bounding boxes
//! that follow from the amplitudes alone (D. James, D. Pai, "BD-tree: output-sensitive collision detection for reduced
//! deformable models", SIGGRAPH 2004).
//!
//! ```text
//!   ┌───────────┐      a mode displaces the points of a box by between a least and a most, so that all points are within
//!   │ ∙ ┌─────┐ │      [min + Σ qᵢ least, max + Σ qᵢ most]  (the two exchanged where qᵢ < 0):
//!   │   │ ∙ ∙ │ │      a box that does not reach an obstacle is left out with all of its points, however many these are
//!   └───┴─────┴─┘
//! ```

use std::ops::Range;
use std::sync::Arc;

use glam::DVec3;

use super::hull::Hull;
use super::modal::ModalModel;
use super::samples::Samples;
use crate::geometry::Lattice;
use crate::math::Aabb;

/// The most points in a box that is not divided further.
const MAX_LEAF_POINTS: usize = 8;

/// What carries the points.
#[derive(Clone, Debug)]
enum Carriers {
    /// Each is a particle.
    Particles(Vec<u32>),
    /// Each is a mean of the particles of a cell.
    Samples(Arc<Samples>),
}

/// The points of a body that modes move, in their boxes. All in the body's coordinates.
#[derive(Clone, Debug)]
pub(in crate::physics) struct ModalPoints {
    carriers: Carriers,
    /// Where each is at rest, m.
    rest: Vec<DVec3>,
    /// The points in the order of the tree, box after box.
    order: Vec<u32>,
    /// The place of each point in that order.
    places: Vec<u32>,
    /// The box around all points first, every box before the boxes within it.
    boxes: Vec<PointBox>,
    /// Ranges of displacements by box and mode.
    ranges: Vec<DisplacementRange>,
    /// For each mode the largest displacement of a point for an amplitude of 1, 1/√kg.
    max_displacements: Vec<f64>,
    modes: usize,
}

/// The range of the displacements of a box's points for an amplitude of 1, along each axis, 1/√kg.
#[derive(Clone, Copy, Debug)]
struct DisplacementRange {
    min: [f32; 3],
    max: [f32; 3],
}

/// Points that are near each other.
#[derive(Clone, Debug)]
struct PointBox {
    /// The box around them at rest, m.
    bounds: Aabb<f64>,
    /// Places in the order.
    points: Range<usize>,
    /// The second of the two boxes within it; the first comes directly after this box. None where it is not divided.
    second: Option<usize>,
}

impl ModalPoints {
    /// The points of a lattice with these modes: of its mesh where there are `samples`, otherwise of its hull. A held body
    /// has only the points that a mode moves, a free body all of them.
    pub(in crate::physics) fn new(
        lattice: &Lattice,
        modes: &ModalModel,
        samples: Option<&Arc<Samples>>,
        is_free: bool,
    ) -> Self {
        let carriers = samples.map_or_else(
            || Carriers::Particles(Hull::new(lattice).points),
            |samples| Carriers::Samples(Arc::clone(samples)),
        );
        let all = match &carriers {
            Carriers::Particles(particles) => particles.len(),
            Carriers::Samples(samples) => samples.count(),
        };
        let mut points = Self {
            carriers,
            rest: Vec::with_capacity(all),
            order: Vec::new(),
            places: Vec::new(),
            boxes: Vec::new(),
            ranges: Vec::new(),
            max_displacements: vec![0.0; modes.count()],
            modes: modes.count(),
        };
        for point in 0..all {
            let mut at = DVec3::ZERO;
            points.for_each_carrier(point, |particle, weight| at += lattice.rest_position(particle) * weight);
            points.rest.push(at);
        }
        let mut row = vec![DVec3::ZERO; modes.count()];
        let moves = |point: &u32| {
            points.row(modes, *point as usize, &mut row);
            is_free || row.iter().any(|way| *way != DVec3::ZERO)
        };
        let mut order: Vec<u32> = (0..u32::try_from(all).unwrap_or(u32::MAX)).filter(moves).collect();
        points.divide(0, &mut order);
        points.places = vec![0; all];
        for (place, point) in (0..).zip(&order) {
            points.places[*point as usize] = place;
        }
        points.order = order;
        points.find_ranges(modes);
        points
    }

    /// Makes the box of some points and the boxes within it. `first` is the place of the first point in the order.
    fn divide(&mut self, first: usize, order: &mut [u32]) {
        let bounds = Aabb::<f64>::around(order.iter().map(|point| self.rest[*point as usize]));
        let number = self.boxes.len();
        let points = first..first + order.len();
        self.boxes.push(PointBox { bounds, points, second: None });
        if order.len() <= MAX_LEAF_POINTS {
            return;
        }
        let size = bounds.max - bounds.min;
        let axis = (0..3).fold(0, |longest, axis| if size[axis] > size[longest] { axis } else { longest });
        order.sort_unstable_by(|one, other| {
            let [a, b] = [one, other].map(|point| self.rest[*point as usize][axis]);
            a.total_cmp(&b).then(one.cmp(other))
        });
        let middle = order.len() / 2;
        let (low, high) = order.split_at_mut(middle);
        self.divide(first, low);
        self.boxes[number].second = Some(self.boxes.len());
        self.divide(first + middle, high);
    }

    /// Finds the ranges of displacements of all boxes.
    fn find_ranges(&mut self, modes: &ModalModel) {
        let none = DisplacementRange { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };
        self.ranges = vec![none; self.boxes.len() * self.modes];
        let mut row = vec![DVec3::ZERO; self.modes];
        // Boxes within a box come after it.
        for number in (0..self.boxes.len()).rev() {
            let mut ranges = vec![none; self.modes];
            if let Some(second) = self.boxes[number].second {
                for (mode, range) in ranges.iter_mut().enumerate() {
                    *range = self.ranges_of(number + 1)[mode].joined(self.ranges_of(second)[mode]);
                }
            } else {
                for point in self.boxes[number].points.clone() {
                    self.row(modes, self.order[point] as usize, &mut row);
                    for (mode, at) in row.iter().enumerate() {
                        ranges[mode] = ranges[mode].joined(DisplacementRange::of(*at));
                        self.max_displacements[mode] = self.max_displacements[mode].max(at.length());
                    }
                }
            }
            self.ranges[number * self.modes..][..self.modes].copy_from_slice(&ranges);
        }
    }

    /// How many points are in the tree.
    pub(in crate::physics) fn count(&self) -> usize {
        self.order.len()
    }

    /// Whether the points are those of the body's mesh.
    pub(in crate::physics) fn is_on_mesh(&self) -> bool {
        matches!(self.carriers, Carriers::Samples(_))
    }

    /// The particle of each point; empty where the points are those of the mesh.
    pub(in crate::physics) fn particles(&self) -> &[u32] {
        match &self.carriers {
            Carriers::Particles(particles) => particles,
            Carriers::Samples(_) => &[],
        }
    }

    /// The largest displacement of a point for an amplitude of 1 of a mode, 1/√kg.
    pub(in crate::physics) fn max_displacement(&self, mode: usize) -> f64 {
        self.max_displacements[mode]
    }

    /// The place of a point in the order of the tree, in which neighbours mostly follow each other.
    pub(in crate::physics) fn place_in_tree(&self, point: usize) -> usize {
        self.places[point] as usize
    }

    /// Where a point is at rest, m.
    pub(in crate::physics) fn rest(&self, point: usize) -> DVec3 {
        self.rest[point]
    }

    /// How a point moves by each mode, 1/√kg.
    pub(in crate::physics) fn row(&self, modes: &ModalModel, point: usize, to: &mut [DVec3]) {
        to.fill(DVec3::ZERO);
        self.for_each_carrier(point, |particle, weight| {
            for (to, way) in to.iter_mut().zip(modes.row(particle)) {
                *to += DVec3::from(way.map(f64::from)) * weight;
            }
        });
    }

    /// Calls `with` for every particle that carries a point, with its weight.
    fn for_each_carrier(&self, point: usize, mut with: impl FnMut(usize, f64)) {
        match &self.carriers {
            Carriers::Particles(particles) => with(particles[point] as usize, 1.0),
            Carriers::Samples(samples) => {
                let (carriers, weights) = samples.point(point);
                carriers.iter().zip(weights).for_each(|(carrier, weight)| with(*carrier as usize, *weight));
            }
        }
    }

    /// Calls `with` for every point in a box for which `is_near` holds. `is_near` gets the box (m) that holds the points at
    /// both sets of amplitudes. Returns how many boxes were looked at.
    pub(in crate::physics) fn for_each_near(
        &self,
        amplitudes: [&[f64]; 2],
        is_near: impl Fn(Aabb<f64>) -> bool,
        mut with: impl FnMut(usize),
    ) -> u64 {
        let (mut boxes_tested, mut next) = (0, 0);
        while let Some(at) = self.boxes.get(next) {
            boxes_tested += 1;
            let [now, then] = amplitudes.map(|of| self.box_bounds(next, of));
            let enters = is_near(Aabb { min: now.min.min(then.min), max: now.max.max(then.max) });
            if enters && at.second.is_none() {
                self.order[at.points.clone()].iter().for_each(|point| with(*point as usize));
            }
            next = if enters { next + 1 } else { self.after_subtree(next) };
        }
        boxes_tested
    }

    /// The box around the points of a box at these amplitudes, m.
    fn box_bounds(&self, number: usize, amplitudes: &[f64]) -> Aabb<f64> {
        let mut around = self.boxes[number].bounds;
        for (DisplacementRange { min, max }, q) in self.ranges_of(number).iter().zip(amplitudes) {
            let [one, other] = [min, max].map(|end| DVec3::from(end.map(f64::from)) * *q);
            around.min += one.min(other);
            around.max += one.max(other);
        }
        around
    }

    /// The box that comes after all boxes within this one.
    fn after_subtree(&self, mut number: usize) -> usize {
        while let Some(second) = self.boxes[number].second {
            number = second;
        }
        number + 1
    }

    fn ranges_of(&self, number: usize) -> &[DisplacementRange] {
        &self.ranges[number * self.modes..][..self.modes]
    }
}

impl DisplacementRange {
    /// The range of one displacement, rounded outwards.
    #[expect(clippy::cast_possible_truncation, reason = "it is rounded outwards")]
    fn of(displacement: DVec3) -> Self {
        let single = displacement.to_array().map(|part| part as f32);
        Self { min: single.map(f32::next_down), max: single.map(f32::next_up) }
    }

    /// The range that holds both.
    fn joined(self, other: Self) -> Self {
        Self {
            min: std::array::from_fn(|axis| self.min[axis].min(other.min[axis])),
            max: std::array::from_fn(|axis| self.max[axis].max(other.max[axis])),
        }
    }
}
