//! Small displacements of a compiled body: its links as a linear operator, solved by conjugate gradients.

use glam::DVec3;

use crate::physics::BodyModel;

/// The most steps of the conjugate gradients.
const MAX_ITERATIONS: usize = 20_000;

/// A body's links, linearised about its start, in double precision.
#[derive(Clone, Debug)]
pub struct Linear {
    /// Where the particles start, m.
    pub start: Vec<DVec3>,
    /// The particles' masses, kg.
    pub mass: Vec<f64>,
    /// Masks every particle's displacements: 1 where an axis is free, 0 where it is held.
    pub free: Vec<DVec3>,
    links: Vec<([usize; 2], DVec3, f64)>,
}

impl Linear {
    /// Takes the links of a compiled body.
    pub fn of(body: &BodyModel<f64>) -> Self {
        let mut links = Vec::new();
        for family in &body.links {
            for (number, link) in family.links.iter().enumerate() {
                let ends = link.ends.map(|end| end as usize);
                let direction = (body.start[ends[1]] - body.start[ends[0]]) * link.inverse_rest_length;
                let stiffness = family.constants(number)[0] * link.inverse_rest_length;
                if stiffness > 0.0 {
                    links.push((ends, direction, stiffness));
                }
            }
        }
        let count = body.start.len();
        Self {
            start: body.start.clone(),
            mass: (0..count).map(|particle| body.mass(particle)).collect(),
            free: vec![DVec3::ONE; count],
            links,
        }
    }

    /// Holds the axes for which `held` is one, at the particles chosen by `chosen`.
    pub fn hold_axes(&mut self, held: DVec3, chosen: impl Fn(DVec3) -> bool) {
        for (free, start) in self.free.iter_mut().zip(&self.start) {
            if chosen(*start) {
                *free *= DVec3::ONE - held;
            }
        }
    }

    /// The forces that hold the particles at these displacements, N.
    pub fn stiffness_forces(&self, displacement: &[DVec3]) -> Vec<DVec3> {
        let mut force = vec![DVec3::ZERO; displacement.len()];
        for &([i, j], direction, stiffness) in &self.links {
            let pull = direction * (stiffness * direction.dot(displacement[j] - displacement[i]));
            force[j] += pull;
            force[i] -= pull;
        }
        for (force, free) in force.iter_mut().zip(&self.free) {
            *force *= *free;
        }
        force
    }

    /// The displacements under these loads, N, by conjugate gradients with a diagonal preconditioner; none where they do not
    /// converge, as for a body that nothing holds.
    pub fn solve(&self, load: &[DVec3]) -> Option<Vec<DVec3>> {
        let scale = self.inverse_diagonal();
        let mut x = vec![DVec3::ZERO; load.len()];
        let mut r: Vec<DVec3> = load.iter().zip(&self.free).map(|(load, free)| *load * *free).collect();
        let mut z = componentwise_product(&scale, &r);
        let mut p = z.clone();
        let mut rho = dot(&r, &z);
        let squared_tolerance = 1e-16 * rho;
        for _ in 0..MAX_ITERATIONS {
            if rho <= squared_tolerance {
                return Some(x);
            }
            let q = self.stiffness_forces(&p);
            let alpha = rho / dot(&p, &q);
            for i in 0..x.len() {
                x[i] += p[i] * alpha;
                r[i] -= q[i] * alpha;
            }
            z = componentwise_product(&scale, &r);
            let next = dot(&r, &z);
            for (p, z) in p.iter_mut().zip(&z) {
                *p = *z + *p * (next / rho);
            }
            rho = next;
        }
        None
    }

    /// The squared frequency, 1/s², of the lowest vibration that shares the symmetry of `shape`, by inverse iteration; none
    /// where nothing holds the body.
    pub fn lowest_squared_frequency(&self, mut shape: Vec<DVec3>) -> Option<f64> {
        let mut lambda = f64::INFINITY;
        for _ in 0..20 {
            let load: Vec<DVec3> = shape.iter().zip(&self.mass).map(|(u, m)| *u * *m).collect();
            let next = self.solve(&load)?;
            let inertia: f64 = next.iter().zip(&self.mass).map(|(u, m)| u.length_squared() * m).sum();
            let found = dot(&next, &load) / inertia;
            let is_settled = (found / lambda - 1.0).abs() < 1e-4;
            (lambda, shape) = (found, next);
            if is_settled {
                break;
            }
        }
        Some(lambda)
    }

    fn inverse_diagonal(&self) -> Vec<DVec3> {
        let mut diagonal = vec![DVec3::ZERO; self.start.len()];
        for &(ends, direction, stiffness) in &self.links {
            for end in ends {
                diagonal[end] += direction * direction * stiffness;
            }
        }
        diagonal.iter().map(|d| d.max(DVec3::splat(f64::MIN_POSITIVE)).recip()).collect()
    }
}

/// A load of 1 N in all, spread by area over a face of a box with its middle at the origin.
pub fn face_load(body: &Linear, size: DVec3, cell: f64, face: DVec3, direction: DVec3) -> Vec<DVec3> {
    let near = 1e-6 * cell;
    let share = |start: &DVec3| {
        let edge = |axis: usize| if 0.5 * size[axis] - start[axis].abs() < near { 0.5 } else { 1.0 };
        let on_face = (*start * face).element_sum() - 0.5 * (size * face.abs()).element_sum() > -near;
        let across: f64 = (0..3).filter(|&axis| face[axis] == 0.0).map(edge).product();
        if on_face { across } else { 0.0 }
    };
    let cells: f64 = (0..3).filter(|&axis| face[axis] == 0.0).map(|axis| size[axis] / cell).product();
    body.start.iter().map(|start| direction * (share(start) / cells)).collect()
}

/// The mean displacement along a load, weighted by the load.
pub fn mean_displacement(load: &[DVec3], displacement: &[DVec3]) -> f64 {
    dot(load, displacement)
}

/// The sum of the scalar products.
pub fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

fn componentwise_product(a: &[DVec3], b: &[DVec3]) -> Vec<DVec3> {
    a.iter().zip(b).map(|(a, b)| *a * *b).collect()
}
