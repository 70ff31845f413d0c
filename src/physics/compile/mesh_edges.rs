//! The edges of a mesh: where its faces meet at an angle, its rim, and where it is narrower than a cell.
//!
//! A smooth wire has no edge, and would cut through a jelly between its particles. So a place of the surface counts as one
//! where the surface falls away on both sides of it, in one of four directions, within half a cell h:
//!
//! ```text
//!        q ├──── h/2 ────●──── h/2 ────┤ q       how far q is from the surface: √(R² + h²/4) − R on a wire of radius R,
//!                      ╭─┴─╮                     nothing on a sheet, however thin
//!                      ╰───╯
//! ```

use glam::DVec3;

use super::edges::{EdgeList, Places};
use crate::geometry::Surface;
use crate::math::Real;
use crate::physics::model::MeshModel;

/// Faces that meet at a smaller angle have no edge between them.
const SHARP_ANGLE_DEG: f64 = 30.0;

/// Corners above a face by less than this share of a mesh's length are on it.
const ROUNDING_SHARE: f64 = 1e-9;

/// The surface falls away where a point beside it, half a cell off, is farther from it than this many cells: on a wire about as
/// wide as a cell.
const FALL: f64 = 0.18;

/// Directions along the surface in which it may fall away.
const DIRECTIONS: u32 = 4;

/// Most places that are looked at along the edge between two faces.
const MAX_PLACES_AN_EDGE: f64 = 1e3;

impl EdgeList {
    /// The edges of a mesh among cells up to this size, m.
    pub(super) fn add_mesh<R: Real>(&mut self, mesh: &MeshModel<R>, cell: f64) {
        let surface: &Surface = &mesh.surface;
        self.add_sharp_edges(surface, mesh.length);
        self.add_narrow_places(surface, mesh.length, cell);
    }

    /// Where faces meet at an angle, and the rim of an open mesh; `length` is that of the mesh, m.
    fn add_sharp_edges(&mut self, surface: &Surface, length: f64) {
        let flat = libm::cos(SHARP_ANGLE_DEG.to_radians());
        let at = |vertex: u32| surface.positions()[vertex as usize] * length;
        let normals = surface.normals();
        for (number, (triangle, beside)) in (0_u32..).zip(surface.triangles().iter().zip(surface.neighbours())) {
            let normal = normals[number as usize];
            for side in 0..3 {
                let ends = [at(triangle[side]), at(triangle[(side + 1) % 3])];
                let apex = at(triangle[(side + 2) % 3]);
                let Some(other) = normals.get(beside[side] as usize) else {
                    let away = (ends[1] - ends[0]).cross(normal);
                    let outward = if away.dot(apex - ends[0]) > 0.0 { -away } else { away };
                    self.add_stretch(ends, outward.normalize_or_zero());
                    continue;
                };
                let is_first = number < beside[side];
                let is_sharp = normal.dot(*other) < flat;
                if !(is_first && is_sharp) {
                    continue;
                }
                // Where the other face falls away from this one, the edge points outwards; the edges of a notch are met by nobody.
                let far = surface.triangles()[beside[side] as usize].map(at);
                let is_convex = far.iter().all(|far| (*far - ends[0]).dot(normal) <= ROUNDING_SHARE * length);
                if is_convex || !surface.is_closed() {
                    let outward = (normal + *other).normalize_or_zero() * if is_convex { 1.0 } else { -1.0 };
                    self.add_stretch(ends, outward);
                    for end in ends {
                        self.add_place(end, outward);
                    }
                }
            }
        }
    }

    /// Places between faces that meet smoothly, where the mesh is narrower than a cell of this size, m.
    fn add_narrow_places(&mut self, surface: &Surface, length: f64, cell: f64) {
        let flat = libm::cos(SHARP_ANGLE_DEG.to_radians());
        let mut looked_at = Places::new(self.spacing);
        let normals = surface.normals();
        for (number, (triangle, beside)) in (0_u32..).zip(surface.triangles().iter().zip(surface.neighbours())) {
            for side in 0..3 {
                let Some(other) = normals.get(beside[side] as usize) else { continue };
                let normal = normals[number as usize];
                if beside[side] < number || normal.dot(*other) < flat {
                    continue;
                }
                let ends =
                    [triangle[side], triangle[(side + 1) % 3]].map(|corner| surface.positions()[corner as usize]);
                let outward = (normal + *other).normalize_or_zero();
                let along = (ends[1] - ends[0]).normalize_or_zero();
                let count =
                    ((ends[1] - ends[0]).length() * length / self.spacing).ceil().clamp(1.0, MAX_PLACES_AN_EDGE);
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 1 and a thousand")]
                for place in 0..count as u32 {
                    let at = ends[0].lerp(ends[1], (f64::from(place) + 0.5) / count);
                    if looked_at.insert(at * length, outward) && is_narrow(surface, at, [outward, along], cell / length)
                    {
                        self.add_place(at * length, outward);
                    }
                }
            }
        }
    }
}

/// Whether the surface falls away on both sides of a place on it, within half a `cell`. The place is given by the way out and a
/// direction along the surface; all in units of the mesh's length.
fn is_narrow(surface: &Surface, at: DVec3, [outward, along]: [DVec3; 2], cell: f64) -> bool {
    let across = outward.cross(along);
    let is_far_outside = |beside: DVec3| {
        let nearest = surface.nearest(beside);
        nearest.distance > FALL * cell && !(surface.is_closed() && nearest.is_within(beside))
    };
    (0..DIRECTIONS).any(|number| {
        let (sin, cos) = libm::sincos(std::f64::consts::PI * f64::from(number) / f64::from(DIRECTIONS));
        let way = (across * cos + along * sin) * (0.5 * cell);
        [at + way, at - way].into_iter().all(is_far_outside)
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use super::*;
    use crate::geometry::TriMesh;
    use crate::physics::compile::edges::{EdgeSizes, edges};
    use crate::physics::model::{Edge, ObstacleShape};
    use crate::physics::{Arrival, Simulation};
    use crate::scene::obstacle::Mesh;
    use crate::scene::resolve::resolve;
    use crate::scene::{self, Body, Obstacle, Scene, builtin};

    const SIZES: EdgeSizes = EdgeSizes { spacing: 0.05, cell: 0.2 };

    fn of_mesh(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<Edge> {
        let mesh =
            TriMesh { positions: positions.iter().map(|at| DVec3::from(*at)).collect(), triangles: triangles.to_vec() };
        let surface = Arc::new(Surface::new(&mesh).expect("a sound surface"));
        let turned = [DVec3::X, DVec3::Y, DVec3::Z];
        let model =
            MeshModel::<f64> { center: DVec3::ZERO, axes: turned, length: 1.0, surface, side_row: None, place: 0 };
        edges(&ObstacleShape::Mesh(model), SIZES).near(|_, _| true).copied().collect()
    }

    #[test]
    fn a_mesh_has_edges_where_its_faces_fall_away_and_at_its_rim() {
        // A wedge of two faces over an edge along z, open below.
        let roof = |height: f64| {
            let corners = [
                [0.0, height, 0.0],
                [0.0, height, 1.0],
                [0.5, 0.0, 0.0],
                [0.5, 0.0, 1.0],
                [-0.5, 0.0, 0.0],
                [-0.5, 0.0, 1.0],
            ];
            of_mesh(&corners, &[[0, 1, 2], [1, 3, 2], [0, 4, 1], [1, 4, 5]])
        };
        let is_ridge = |edge: &&Edge| {
            let [a, b] = edge.ends;
            a.x.abs() < 1e-9 && b.x.abs() < 1e-9 && edge.count > 1
        };
        let steep = roof(1.0);
        let ridge: Vec<_> = steep.iter().filter(is_ridge).collect();
        assert!(ridge.len() == 1 && ridge[0].outward.y > 0.99, "{ridge:?}");
        assert_eq!(roof(0.05).iter().filter(is_ridge).count(), 0, "a flat roof has no ridge");
        let rim = steep.iter().filter(|edge| edge.count > 1 && !is_ridge(edge));
        assert_eq!(rim.count(), 6, "the rim");
    }

    /// A ring about z, of a wire of this radius, smooth.
    fn ring(radius: f64) -> Vec<Edge> {
        let [around, across] = [48_u32, 16];
        let angle = |number: u32, of: u32| std::f64::consts::TAU * f64::from(number) / f64::from(of);
        let positions: Vec<[f64; 3]> = (0..around * across)
            .map(|number| {
                let (sin, cos) = libm::sincos(angle(number / across, around));
                let (up, out) = libm::sincos(angle(number % across, across));
                [(0.5 + radius * out) * cos, (0.5 + radius * out) * sin, radius * up]
            })
            .collect();
        let corner = |i: u32, j: u32| i % around * across + j % across;
        let squares = (0..around * across).map(|number| [number / across, number % across]);
        let triangles: Vec<[u32; 3]> = squares
            .flat_map(|[i, j]| {
                let corners = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]
            })
            .collect();
        of_mesh(&positions, &triangles)
    }

    #[test]
    fn a_smooth_wire_has_points_all_over_and_a_thick_one_has_none() {
        let thin = ring(0.02);
        assert!((100..1000).contains(&thin.len()), "{} points", thin.len());
        for edge in &thin {
            let [at, _] = edge.ends;
            // The ring is scaled to a length of 1.
            let middle = DVec3::new(at.x, at.y, 0.0).normalize_or_zero() * (0.5 / 1.04);
            let out = (at - middle).normalize_or_zero();
            assert!(out.dot(edge.outward) > 0.9, "it leads out: {edge:?}");
        }
        let all_around = |number: i32| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(number) / 60.0);
            let at = DVec3::new(cos, sin, 0.0) * 0.5;
            thin.iter().any(|edge| (edge.ends[0] - at).length() < 0.075)
        };
        assert!((0..60).all(all_around), "no gap is much wider than a cell");
        assert_eq!(ring(0.3).len(), 0, "a wire twice as thick as a cell");
    }

    #[test]
    fn a_mesh_that_is_moved_keeps_its_edges_and_one_of_another_length_does_not() {
        let comb = |height: f64, length: f64| {
            let (path, center) = (format!("{}comb.obj", builtin::PREFIX), [0.0, height, 0.0]);
            let mesh = Mesh { path, center, length, ..Mesh::default() };
            let comb = Obstacle { shape: scene::ObstacleShape::Mesh(mesh), ..Obstacle::default() };
            Scene { bodies: vec![Body::default()], obstacles: vec![comb], ..Scene::default() }
        };
        let scene = comb(0.0, 1.0);
        let lattices = [resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice];
        let mut simulation = Simulation::<f32>::new(&scene, &lattices);
        let edges = |simulation: &Simulation<f32>| Arc::clone(&simulation.model().obstacles[0].edges[0]);
        let first = edges(&simulation);
        assert!(!first.is_empty());
        simulation.set_parameters(&comb(0.5, 1.0), &lattices, &[Some(0)], Arrival::Swept);
        assert!(Arc::ptr_eq(&edges(&simulation), &first), "moved");
        simulation.set_parameters(&comb(0.5, 2.0), &lattices, &[Some(0)], Arrival::Swept);
        assert!(edges(&simulation).point_count() > first.point_count(), "twice as long");
    }
}
