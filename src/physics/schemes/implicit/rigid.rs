//! Bodies that touch each other as rigid ones, in the preconditioner.
//!
//! The coarse grids of a body know of a contact only that it resists, and so hold back bodies that move together, one on the
//! other. Their motions as rigid bodies are therefore solved for exactly, with all contacts:
//!
//! ```text
//! z += R (Rᵀ (M + Σ contacts) R)⁻¹ Rᵀ r     R the six rigid motions of every body about its middle
//! ```
//!
//! Without it a stack of three cubes takes three times as many iterations. It helps as well where points of a mesh stand on an
//! obstacle, to which the diagonal is blind.

use glam::{DMat3, DVec3};

/// Motions of a rigid body.
pub(super) const MOTIONS: usize = 6;

/// Islands of more bodies go without: the equations are dense.
pub(super) const MAX_BODIES: usize = 64;

/// A motion of which less than this share of its resistance is left by those before it is one of them.
const MIN_PIVOT_SHARE: f64 = 1e-13;

/// The rigid motions of the bodies of an island, and the factor of their equations.
#[derive(Clone, Debug, Default)]
pub(super) struct RigidMotions {
    /// The place of every body of the scene among those that move as a whole: no particle of them is pinned.
    pub(super) place_of: Vec<Option<usize>>,
    /// Where every particle is from the middle of its body, m.
    pub(super) from_middle: Vec<DVec3>,
    /// The motions of all these bodies together; none where they are left out.
    pub(super) count: usize,
    /// The equations by rows without contacts.
    pub(super) masses: Vec<f64>,
    /// The equations by rows, and then their lower factor.
    pub(super) matrix: Vec<f64>,
    /// The load, N·s and N·m·s, and then the solution, m/s and 1/s.
    pub(super) solution: Vec<f64>,
}

/// How a weighted sum of velocities changes with each motion of a body.
pub(super) type MotionRows = [DVec3; MOTIONS];

impl RigidMotions {
    /// How the motions of its body move a particle.
    pub(super) fn rows(&self, particle: usize) -> MotionRows {
        let from = self.from_middle[particle];
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
        [x, y, z, x.cross(from), y.cross(from), z.cross(from)]
    }

    /// Adds the mass of a particle, kg, of the body in this place, to the equations without contacts.
    pub(super) fn add_mass(&mut self, place: usize, particle: usize, mass: f64) {
        let rows = self.rows(particle);
        for (i, row) in rows.iter().enumerate() {
            let to = &mut self.masses[(place * MOTIONS + i) * self.count + place * MOTIONS..][..MOTIONS];
            for (to, column) in to.iter_mut().zip(&rows) {
                *to += (*row * mass).dot(*column);
            }
        }
    }

    /// Begins the equations, without contacts.
    pub(super) fn begin(&mut self) {
        self.matrix.clear();
        self.matrix.extend_from_slice(&self.masses);
        self.solution.resize(self.count, 0.0);
    }

    /// Adds the resistance of what acts on a sum of velocities, given how this changes with the motions of some bodies.
    pub(super) fn add(&mut self, of: &[(usize, MotionRows)], resistance: DMat3) {
        for (one, rows) in of {
            for (other, columns) in of {
                for (i, row) in rows.iter().enumerate() {
                    let row = resistance * *row;
                    let to = &mut self.matrix[(one * MOTIONS + i) * self.count + other * MOTIONS..][..MOTIONS];
                    for (to, column) in to.iter_mut().zip(columns) {
                        *to += row.dot(*column);
                    }
                }
            }
        }
    }

    /// Factorises the matrix (Cholesky). A motion that nothing resists is left out.
    pub(super) fn factorise(&mut self) {
        let Self { count, matrix, .. } = self;
        for i in 0..*count {
            let (before, row) = matrix.split_at_mut(i * *count);
            for j in 0..i {
                let other = &before[j * *count..][..=j];
                let sum = other[..j].iter().zip(&*row).fold(0.0, |sum, (a, b)| sum + a * b);
                row[j] = (row[j] - sum) / other[j];
            }
            let sum = row[..i].iter().fold(0.0, |sum, a| sum + a * a);
            let left = row[i] - sum;
            row[i] = if left > MIN_PIVOT_SHARE * row[i] { left.sqrt() } else { f64::INFINITY };
        }
    }

    /// Solves for the load.
    pub(super) fn solve(&mut self) {
        let Self { count, matrix, solution, .. } = self;
        for i in 0..*count {
            let row = &matrix[i * *count..][..=i];
            let sum = row[..i].iter().zip(&*solution).fold(0.0, |sum, (a, b)| sum + a * b);
            solution[i] = (solution[i] - sum) / row[i];
        }
        for i in (0..*count).rev() {
            let row = &matrix[i * *count..][..=i];
            solution[i] /= row[i];
            let own = solution[i];
            for (solution, a) in solution[..i].iter_mut().zip(row) {
                *solution -= a * own;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::Simulation;
    use crate::scene::body::CubeShape;
    use crate::scene::obstacle::Plane;
    use crate::scene::{Body, Material, Obstacle, ObstacleShape, Scene, Shape, Springs};

    #[test]
    fn the_factor_solves_the_equations_and_leaves_out_what_nothing_resists() {
        let mut rng = Rng::new(6);
        let mut random = || DVec3::from([0; 3].map(|_| rng.between(-1.0, 1.0)));
        let mut rigid = RigidMotions { count: 2 * MOTIONS, ..RigidMotions::default() };
        rigid.matrix = vec![0.0; 144];
        rigid.solution = vec![0.0; 12];
        rigid.from_middle = (0..40).map(|_| random()).collect();
        for particle in 0..40 {
            let place = particle / 20;
            rigid.add(&[(place, rigid.rows(particle))], DMat3::IDENTITY);
        }
        // A contact a billion times as stiff ties one to the other.
        let tie = [(0, rigid.rows(0)), (1, rigid.rows(20).map(|row| -row))];
        rigid.add(&tie, DMat3::from_diagonal(DVec3::splat(1e9)));
        let (matrix, load) = (rigid.matrix.clone(), [1.0, 2.0, -1.0, 0.3, 0.2, 0.5, 0.0, 1.0, 0.0, 0.1, 0.0, 0.0]);
        rigid.factorise();
        rigid.solution.copy_from_slice(&load);
        rigid.solve();
        for (row, load) in matrix.chunks(12).zip(load) {
            let found: f64 = row.iter().zip(&rigid.solution).map(|(a, b)| a * b).sum();
            assert!((found - load).abs() < 1e-5, "{found}, not {load}");
        }
        // Particles on a line do not resist turning about it.
        let mut line = RigidMotions { count: MOTIONS, ..RigidMotions::default() };
        (line.matrix, line.solution) = (vec![0.0; 36], vec![1.0; 6]);
        line.from_middle = [-1.0, 0.0, 1.0].map(|x| DVec3::X * x).to_vec();
        for particle in 0..3 {
            line.add(&[(0, line.rows(particle))], DMat3::IDENTITY);
        }
        line.factorise();
        line.solve();
        assert!(line.solution.iter().all(|rate| rate.is_finite()), "{:?}", line.solution);
        assert!(line.solution[3].abs() < f64::EPSILON && line.solution[4].abs() > 0.1, "{:?}", line.solution);
    }

    /// Iterations of a solve, on average over landing and rest, of a stack of so many stiff cubes.
    fn iterations(count: u32) -> f64 {
        let mut springs = Springs::default();
        for spring in [&mut springs.structural, &mut springs.shear, &mut springs.bending] {
            (spring.stiffness, spring.damping) = (1e6, 1e3);
        }
        let ground = Obstacle { shape: ObstacleShape::Plane(Plane::default()), ..Obstacle::default() };
        let mut scene = Scene { obstacles: vec![ground], ..Scene::default() };
        scene.settings.sleeping = false;
        for place in 0..count {
            let shape = Shape::Cube(CubeShape { cells: 5, size: 1.0 });
            let mut body = Body { shape, material: Material::Springs(springs), ..Body::default() };
            body.pose.position = [0.0, 0.51 + 1.02 * f64::from(place), 0.0];
            scene.bodies.push(body);
        }
        let mut simulation = Simulation::<f32>::from_scene(&scene, "".as_ref()).expect("a sound scene");
        let counters = simulation.run_for(0.3).counters;
        assert!(simulation.body_contacts().len() >= 36 * (count as usize - 1), "they touch");
        counters.iterations as f64 / counters.solves as f64
    }

    #[test]
    fn a_stack_takes_hardly_more_iterations_than_a_cube() {
        let [alone, stack] = [1, 4].map(iterations);
        assert!(stack < 25.0, "{stack} iterations, {alone} for one");
    }
}
