//! The edges of an obstacle that bodies may meet between their particles.
//!
//! Particles meet the faces of obstacles. An obstacle that is narrower than a cell, an edge or a corner may pass between them:
//! a jelly would fall through a thin wall that stands between its rows of particles. So points along edges, and all over forms
//! that are narrower than a cell, meet the cells of bodies ([`crate::physics::contact`], `samples`).
//!
//! ```text
//! plane       its rim                             box    where faces meet, corners
//! ball, capsule, cylinder                         mesh   see `mesh_edges`
//!             lines and points all over, if narrower than a cell
//! ```

use std::collections::BTreeSet;

use glam::DVec3;

use crate::geometry::Lattice;
use crate::math::Real;
use crate::physics::model::{Edge, Edges, ObstacleShape, OrientedForm};

/// Points on an edge are at most a cell apart, as particles are, and as close as this share of a body's longest extent: a body of
/// few cells would stand on few points.
const SPACING_IN_BODY: f64 = 0.125;

/// Most points of an edge: beyond that they are further apart.
const MAX_POINTS_AN_EDGE: f64 = 1e6;

/// Lines along a thin rod, and points around its ends.
const LINES_AROUND: u32 = 6;

/// The directions from the middle of a small ball to the points on it, of any length.
const AROUND_BALL: [[i8; 3]; 14] = [
    [1, 0, 0],
    [-1, 0, 0],
    [0, 1, 0],
    [0, -1, 0],
    [0, 0, 1],
    [0, 0, -1],
    [1, 1, 1],
    [1, 1, -1],
    [1, -1, 1],
    [1, -1, -1],
    [-1, 1, 1],
    [-1, 1, -1],
    [-1, -1, 1],
    [-1, -1, -1],
];

/// What the edges that a body meets have to fit, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EdgeSizes {
    /// The distance between points that it needs.
    pub(super) spacing: f64,
    /// The size of its cells.
    pub(super) cell: f64,
}

impl EdgeSizes {
    /// Those for a body of these cells.
    pub(super) fn of(lattice: &Lattice) -> Self {
        let (cell, longest) = (lattice.grid.cell_size, lattice.grid.dims.iter().max());
        let in_body = SPACING_IN_BODY * longest.map_or(1.0, |cells| f64::from(*cells));
        Self { spacing: in_body.min(1.0) * cell, cell }
    }
}

/// The edges of an obstacle for a body.
pub(super) fn edges<R: Real>(shape: &ObstacleShape<R>, sizes: EdgeSizes) -> Edges {
    let EdgeSizes { spacing, cell } = sizes;
    let mut list = EdgeList::new(spacing);
    let is_thin = |radius: f64| 2.0 * radius < cell;
    match shape {
        ObstacleShape::Plane(plane) => list.add_rim(plane.half_extents.map(Real::to_f64)),
        ObstacleShape::Sphere { radius, .. } => {
            let radius = radius.to_f64();
            if is_thin(radius) {
                for direction in AROUND_BALL {
                    let outward = DVec3::from(direction.map(f64::from)).normalize_or_zero();
                    list.add_point(outward * radius, outward);
                }
            }
        }
        ObstacleShape::Oriented(model) => match model.form {
            OrientedForm::Box { half_extents } => list.add_box(half_extents.map(Real::to_f64), cell),
            OrientedForm::Capsule { radius, half_height } => {
                let [radius, half_height] = [radius, half_height].map(Real::to_f64);
                if is_thin(radius) {
                    list.add_rod(radius, half_height);
                    for end in [DVec3::Y, DVec3::NEG_Y] {
                        list.add_point(end * (half_height + radius), end);
                    }
                }
            }
            OrientedForm::Cylinder { radius, half_height } => {
                let [radius, half_height] = [radius, half_height].map(Real::to_f64);
                list.add_cylinder(radius, half_height, is_thin(radius));
            }
        },
        ObstacleShape::Mesh(mesh) => list.add_mesh(mesh, cell),
    }
    Edges::new(list.edges)
}

/// The edges of an obstacle as they are found.
pub(super) struct EdgeList {
    /// Between points, m.
    pub(super) spacing: f64,
    edges: Vec<Edge>,
    /// The places of points and of edges no longer than the distance of points.
    places: Places,
}

/// Places by the cube that they are in, the axis along which they face most and the way along it. Of those that have all in common
/// one is taken: a model that is smaller than a cell may have thousands of edges.
#[derive(Debug)]
pub(super) struct Places {
    cube: f64,
    known: BTreeSet<([i64; 3], usize, bool)>,
}

impl Places {
    /// None yet, in cubes of this size, m.
    pub(super) fn new(cube: f64) -> Self {
        Self { cube, known: BTreeSet::new() }
    }

    /// Adds a place. Returns whether it is the first that faces this way in its cube.
    #[expect(clippy::cast_possible_truncation, reason = "saturating")]
    pub(super) fn insert(&mut self, at: DVec3, outward: DVec3) -> bool {
        let cube = (at / self.cube).floor().to_array().map(|along| along as i64);
        let axis = outward.abs().max_position();
        self.known.insert((cube, axis, outward[axis] < 0.0))
    }
}

impl EdgeList {
    fn new(spacing: f64) -> Self {
        Self { spacing, edges: Vec::new(), places: Places::new(spacing) }
    }

    /// Adds a point unless there is one beside it that leads out the same way.
    pub(super) fn add_place(&mut self, at: DVec3, outward: DVec3) {
        if self.places.insert(at, outward) {
            self.add_point(at, outward);
        }
    }

    /// Adds an edge, or a place if it is shorter than the distance of points.
    pub(super) fn add_stretch(&mut self, ends: [DVec3; 2], outward: DVec3) {
        if (ends[1] - ends[0]).length() < self.spacing {
            self.add_place(0.5 * (ends[0] + ends[1]), outward);
        } else {
            self.add(ends, outward);
        }
    }

    /// Adds an edge and the way out of the obstacle there.
    fn add(&mut self, ends: [DVec3; 2], outward: DVec3) {
        let parts = ((ends[1] - ends[0]).length() / self.spacing).ceil().clamp(1.0, MAX_POINTS_AN_EDGE);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 1 and a million")]
        let count = parts as usize;
        self.edges.push(Edge { ends, outward, first: 0, count });
    }

    /// Adds a point.
    fn add_point(&mut self, at: DVec3, outward: DVec3) {
        self.add([at; 2], outward);
    }

    /// The four sides of a rectangle across y.
    fn add_rim(&mut self, [x, z]: [f64; 2]) {
        for (outward, along) in [(DVec3::X * x, DVec3::Z * z), (DVec3::Z * z, DVec3::X * x)]
            .into_iter()
            .flat_map(|(a, b)| [(a, b), (-a, b)])
        {
            self.add([outward - along, outward + along], outward.normalize_or_zero());
        }
    }

    /// The twelve edges of a box and its corners. Where it is thinner than a cell of this size, edges lead out along its longer
    /// sides alone.
    fn add_box(&mut self, half: [f64; 3], cell: f64) {
        let unit = [DVec3::X, DVec3::Y, DVec3::Z];
        let is_thin = half.map(|half| 2.0 * half < cell);
        let outward = |sides: &[(usize, f64)]| {
            let all = || sides.iter().map(|&(axis, sign)| unit[axis] * sign).sum::<DVec3>();
            let thick = sides.iter().filter(|(axis, _)| !is_thin[*axis]);
            let of_thick: DVec3 = thick.map(|&(axis, sign)| unit[axis] * sign).sum();
            of_thick.try_normalize().unwrap_or_else(|| all().normalize_or_zero())
        };
        for along in 0..3 {
            let [a, b] = [(along + 1) % 3, (along + 2) % 3];
            for (on_a, on_b) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
                let middle = unit[a] * (half[a] * on_a) + unit[b] * (half[b] * on_b);
                let way = unit[along] * half[along];
                self.add([middle - way, middle + way], outward(&[(a, on_a), (b, on_b)]));
            }
        }
        for corner in 0..8 {
            let signs = [1, 2, 4].map(|bit| if corner & bit == 0 { -1.0 } else { 1.0 });
            let at = DVec3::from([0, 1, 2].map(|axis| half[axis] * signs[axis]));
            self.add_point(at, outward(&[(0, signs[0]), (1, signs[1]), (2, signs[2])]));
        }
    }

    /// Directions across y around a rod or disc.
    fn around(count: u32) -> impl Iterator<Item = DVec3> {
        (0..count).map(move |number| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(number) / f64::from(count));
            DVec3::new(cos, 0.0, sin)
        })
    }

    /// Lines along a thin rod about y.
    fn add_rod(&mut self, radius: f64, half_height: f64) {
        for outward in Self::around(LINES_AROUND) {
            let [side, way] = [outward * radius, DVec3::Y * half_height];
            self.add([side - way, side + way], outward);
        }
    }

    /// The rims of a cylinder about y; if it is thin also lines along it, and the middles of its ends.
    fn add_cylinder(&mut self, radius: f64, half_height: f64, is_thin: bool) {
        for end in [DVec3::Y, DVec3::NEG_Y] {
            let middle = end * half_height;
            if is_thin {
                self.add_point(middle, end);
                for side in Self::around(LINES_AROUND) {
                    self.add_point(middle + side * radius, end);
                }
                continue;
            }
            let parts = (std::f64::consts::TAU * radius / self.spacing).ceil().clamp(12.0, MAX_POINTS_AN_EDGE);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 12 and a million")]
            for side in Self::around(parts as u32) {
                self.add_point(middle + side * radius, (side + end).normalize_or_zero());
            }
        }
        if is_thin {
            self.add_rod(radius, half_height);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::compile::obstacles::obstacles;
    use crate::scene::obstacle::{Capsule, Cuboid, Cylinder, Plane, Sphere};
    use crate::scene::{self, Obstacle};

    const SIZES: EdgeSizes = EdgeSizes { spacing: 0.05, cell: 0.2 };

    fn of(shape: scene::ObstacleShape) -> Vec<Edge> {
        let made = obstacles::<f64>(&[Obstacle { shape, ..Obstacle::default() }], &[SIZES], None);
        made[0].edges[0].near(|_, _| true).copied().collect()
    }

    fn of_box(half_extents: [f64; 3]) -> Vec<Edge> {
        of(scene::ObstacleShape::Box(Cuboid { half_extents, ..Cuboid::default() }))
    }

    #[test]
    fn points_are_as_close_as_asked_for_and_numbered_one_after_the_other() {
        let mut next = 0;
        for edge in of_box([0.5, 0.01, 0.333]) {
            let apart = (edge.ends[1] - edge.ends[0]).length() / edge.count as f64;
            assert!(edge.first == next && apart <= 0.05 + 1e-12, "{edge:?}");
            next = edge.first + edge.count;
        }
    }

    #[test]
    fn every_body_has_points_as_close_as_its_own_cells_need() {
        let wall = scene::ObstacleShape::Box(Cuboid { half_extents: [0.5, 0.05, 0.5], ..Cuboid::default() });
        let large = EdgeSizes { spacing: 0.5, cell: 2.0 };
        let made = obstacles::<f64>(&[Obstacle { shape: wall, ..Obstacle::default() }], &[SIZES, large, SIZES], None);
        let [small_count, large_count, _] = [0, 1, 2].map(|body: usize| made[0].edges[body].point_count());
        assert!(small_count > 5 * large_count, "{small_count} and {large_count} points");
        assert!(std::sync::Arc::ptr_eq(&made[0].edges[0], &made[0].edges[2]), "bodies of like cells share them");
    }

    #[test]
    fn the_edges_of_a_thin_box_lead_out_along_its_longer_sides() {
        for edge in of_box([0.01, 0.5, 0.5]) {
            assert!(edge.outward.x == 0.0 && (edge.outward.length() - 1.0).abs() < 1e-12, "a wall: {edge:?}");
        }
        let rod = of_box([0.01, 0.5, 0.01]);
        let (along, across): (Vec<&Edge>, Vec<&Edge>) =
            rod.iter().partition(|edge| (edge.ends[1] - edge.ends[0]).y != 0.0);
        assert!(along.len() == 4 && along.iter().all(|edge| edge.outward.y == 0.0), "{along:?}");
        assert!(across.iter().all(|edge| edge.outward.y.abs() > 1.0 - 1e-12), "{across:?}");
        let cube = of_box([0.5; 3]);
        assert_eq!(cube.len(), 12 + 8, "edges and corners");
        assert!(cube.iter().all(|edge| edge.outward.dot(edge.ends[0] + edge.ends[1]) > 0.7), "outwards: {cube:?}");
    }

    #[test]
    fn round_forms_have_edges_only_where_they_are_thin() {
        let ball = |radius| of(scene::ObstacleShape::Sphere(Sphere { radius, ..Sphere::default() })).len();
        let capsule = |radius| of(scene::ObstacleShape::Capsule(Capsule { radius, ..Capsule::default() })).len();
        assert_eq!([ball(0.2), capsule(0.2)], [0, 0]);
        assert!(ball(0.09) == 14 && capsule(0.09) == 8, "14 points, six lines and two ends");
        let cylinder = |radius| of(scene::ObstacleShape::Cylinder(Cylinder { radius, ..Cylinder::default() }));
        let rims = cylinder(0.5);
        assert!(rims.len() > 100 && rims.iter().all(|edge| edge.outward.y.abs() > 0.7), "two rims");
        assert!(cylinder(0.05).iter().any(|edge| edge.count > 1), "lines along a rod");
    }

    #[test]
    fn a_plane_has_a_rim_that_leads_away_from_its_middle() {
        let rim = of(scene::ObstacleShape::Plane(Plane { half_extents: [1.0, 2.0], ..Plane::default() }));
        assert_eq!(rim.len(), 4);
        for edge in rim {
            let middle = 0.5 * (edge.ends[0] + edge.ends[1]);
            assert!(middle.y == 0.0 && middle.normalize().dot(edge.outward) > 1.0 - 1e-12, "{edge:?}");
        }
    }
}
