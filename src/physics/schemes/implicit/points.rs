//! Contacts of points in the preconditioner.
//!
//! A contact of a point of one body in a cell of another ties their particles together, where friction holds it a million
//! times as stiffly as links do. Blocks on the diagonal would say that the particles are held fast, while the two may well
//! move together; and a point of a mesh at an obstacle holds the mean of particles that may turn about it. So the contacts are solved for: with D the part of the matrix by particle, W the weights of contacts and S
//! their matrices,
//!
//! ```text
//! (D + Wᵀ S W)⁻¹ r = y − D⁻¹ Wᵀ λ,   y = D⁻¹ r,   (S⁻¹ + W D⁻¹ Wᵀ) λ = W y
//! ```
//!
//! of which the system for λ is solved roughly, by one sweep of Gauss–Seidel through the contacts and one back. Such a pair of
//! sweeps is symmetric and makes λ too small rather than too large, so that the whole stays positive definite (Saad, "Iterative
//! Methods for Sparse Linear Systems", 2003, 10.2; Benzi, Golub and Liesen, "Numerical solution of saddle point problems",
//! 2005, 5).

use std::ops::Range;

use glam::{DMat3, DVec3};

use crate::physics::contact::{WeightedConstraint, WeightedConstraints};

/// A contact in the preconditioner.
#[derive(Clone, Debug)]
struct PointBlock {
    /// S, kg.
    matrix: DMat3,
    /// (1 + S W D⁻¹ Wᵀ)⁻¹.
    relaxation: DMat3,
    /// λ, N·s.
    impulse: DVec3,
    /// The particles that it weighs.
    particles: Range<usize>,
}

/// A particle that a contact weighs.
#[derive(Clone, Copy, Debug)]
struct WeighedParticle {
    particle: u32,
    /// The place of its block among those of particles that touch obstacles, or [`NO_BLOCK`].
    block: u32,
    weight: f64,
    /// The inverse of the diagonal, 1/kg, where it has no block.
    inverse: f64,
}

/// Stands where a particle has no block.
const NO_BLOCK: u32 = u32::MAX;

/// Bytes of a contact of a particle in a cell.
pub(super) const BYTES_A_BLOCK: usize = size_of::<PointBlock>() + 9 * size_of::<WeighedParticle>();

/// The contacts of an island in the preconditioner.
#[derive(Clone, Debug, Default)]
pub(super) struct PointBlocks {
    blocks: Vec<PointBlock>,
    particles: Vec<WeighedParticle>,
}

impl PointBlocks {
    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.blocks.clear();
        self.particles.clear();
    }

    /// Forgets all, and makes room for as many contacts as all of these.
    pub(super) fn make_room(&mut self, contacts: &WeightedConstraints) {
        self.clear();
        self.blocks.reserve(contacts.all.capacity());
        self.particles.reserve(contacts.weights.capacity());
    }

    /// Adds a contact, which weighs particles out of `weights`. Of the matrix without contacts of points the inverse diagonal of
    /// every particle is given, 1/kg, and the inverse blocks of those that touch obstacles, in order.
    pub(super) fn add_contact(
        &mut self,
        contact: &WeightedConstraint,
        weights: &[(u32, f64)],
        inverse_diagonal: &[DVec3],
        inverse_blocks: &[(usize, DMat3)],
    ) {
        let particles = contact.own(weights).iter().map(|&(particle, weight)| {
            let known = inverse_blocks.binary_search_by_key(&(particle as usize), |block| block.0);
            let block = known.ok().and_then(|place| u32::try_from(place).ok()).unwrap_or(NO_BLOCK);
            WeighedParticle { particle, block, weight, inverse: inverse_diagonal[particle as usize].x }
        });
        self.add(*contact.constraint.matrix(), particles, inverse_blocks);
    }

    /// Adds a contact of these particles.
    fn add(&mut self, matrix: DMat3, particles: impl Iterator<Item = WeighedParticle>, of_touched: &[(usize, DMat3)]) {
        let first = self.particles.len();
        self.particles.extend(particles);
        let gives = self.particles[first..]
            .iter()
            .fold(DMat3::ZERO, |sum, own| sum + own.inverse_block(of_touched) * (own.weight * own.weight));
        let relaxation = (DMat3::IDENTITY + matrix * gives).inverse();
        let particles = first..self.particles.len();
        self.blocks.push(PointBlock { matrix, relaxation, impulse: DVec3::ZERO, particles });
    }

    /// Lets the contacts act on the residual as scaled particle by particle.
    pub(super) fn relax(&mut self, of_touched: &[(usize, DMat3)], scaled: &mut [DVec3]) {
        self.blocks.iter_mut().for_each(|block| block.impulse = DVec3::ZERO);
        let Self { blocks, particles } = self;
        let mut relax = |block: &mut PointBlock| {
            let own = &particles[block.particles.clone()];
            let along = own.iter().fold(DVec3::ZERO, |sum, own| sum + scaled[own.particle as usize] * own.weight);
            let change = block.relaxation * (block.matrix * along - block.impulse);
            block.impulse += change;
            for own in own {
                scaled[own.particle as usize] -= own.answer(change * own.weight, of_touched);
            }
        };
        blocks.iter_mut().for_each(&mut relax);
        blocks.iter_mut().rev().for_each(&mut relax);
    }
}

impl WeighedParticle {
    /// The inverse of the matrix's block of the particle, without contacts of points, 1/kg.
    fn inverse_block(&self, of_touched: &[(usize, DMat3)]) -> DMat3 {
        match self.block {
            NO_BLOCK => DMat3::from_diagonal(DVec3::splat(self.inverse)),
            place => of_touched[place as usize].1,
        }
    }

    /// That times an impulse.
    fn answer(&self, impulse: DVec3, of_touched: &[(usize, DMat3)]) -> DVec3 {
        match self.block {
            NO_BLOCK => impulse * self.inverse,
            place => of_touched[place as usize].1 * impulse,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    fn random(rng: &mut Rng) -> DVec3 {
        DVec3::from([0; 3].map(|_| rng.between(-1.0, 1.0)))
    }

    /// What is left of a residual, by particle: D⁻¹ r with the contacts.
    fn answered(blocks: &mut PointBlocks, inverse: &[f64], residual: &[DVec3]) -> Vec<DVec3> {
        let mut scaled: Vec<_> = residual.iter().zip(inverse).map(|(residual, inverse)| *residual * *inverse).collect();
        blocks.relax(&[], &mut scaled);
        scaled
    }

    /// A contact: its matrix, and its particles with their weights.
    type Contact = (DMat3, Vec<(usize, f64)>);

    /// Contacts of eight particles each among twenty, up to a billion times as stiff as these.
    fn contacts(count: usize, inverse: &[f64], rng: &mut Rng) -> (PointBlocks, Vec<Contact>) {
        let (mut blocks, mut all) = (PointBlocks::default(), Vec::new());
        for _ in 0..count {
            let normal = random(rng).normalize();
            let along = DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
            let [push, friction] = [0; 2].map(|_| 10.0_f64.powf(rng.between(0.0, 9.0)));
            let matrix = along * push + (DMat3::IDENTITY - along) * friction;
            let weights: Vec<_> =
                (0..8).map(|place| ((rng.next_u64() % 20) as usize, if place < 4 { 0.25 } else { -0.25 })).collect();
            let particles = weights.iter().map(|&(particle, weight)| {
                let number = u32::try_from(particle).expect("one of twenty");
                WeighedParticle { particle: number, block: NO_BLOCK, weight, inverse: inverse[particle] }
            });
            blocks.add(matrix, particles, &[]);
            all.push((matrix, weights));
        }
        (blocks, all)
    }

    fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
    }

    #[test]
    fn what_they_make_of_a_residual_is_symmetric_and_positive() {
        let mut rng = Rng::new(3);
        for count in [0, 1, 2, 10, 60] {
            let inverse: Vec<_> = (0..20).map(|_| rng.between(0.1, 10.0)).collect();
            let (mut blocks, _) = contacts(count, &inverse, &mut rng);
            let [a, b] = [0; 2].map(|_| (0..20).map(|_| random(&mut rng)).collect::<Vec<_>>());
            let [of_a, of_b] = [&a, &b].map(|residual| answered(&mut blocks, &inverse, residual));
            let size = (dot(&a, &of_a) * dot(&b, &of_b)).sqrt();
            assert!(dot(&a, &of_a) > 0.0 && dot(&b, &of_b) > 0.0, "{count} contacts");
            let off = (dot(&a, &of_b) - dot(&b, &of_a)).abs() / size;
            assert!(off < 1e-6, "{count} contacts: {off}");
        }
    }

    #[test]
    fn a_single_contact_is_solved_for_exactly() {
        let mut rng = Rng::new(4);
        for _ in 0..20 {
            let inverse: Vec<_> = (0..20).map(|_| rng.between(0.1, 10.0)).collect();
            let (mut blocks, all) = contacts(1, &inverse, &mut rng);
            let (matrix, weights) = &all[0];
            let mut once = weights.clone();
            once.sort_unstable_by_key(|weighed| weighed.0);
            if once.windows(2).any(|two| two[0].0 == two[1].0) {
                // A particle that is weighed twice couples to itself, which the block leaves out.
                continue;
            }
            let residual: Vec<_> = (0..20).map(|_| random(&mut rng)).collect();
            let found = answered(&mut blocks, &inverse, &residual);
            let sum = weights.iter().fold(DVec3::ZERO, |sum, &(particle, weight)| sum + found[particle] * weight);
            let mut product: Vec<_> = found.iter().zip(&inverse).map(|(found, inverse)| *found / *inverse).collect();
            for &(particle, weight) in weights {
                product[particle] += *matrix * sum * weight;
            }
            let furthest = product.iter().zip(&residual).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
            assert!(furthest < 1e-5, "{furthest} N·s off");
            let alone: Vec<_> = residual.iter().zip(&inverse).map(|(residual, inverse)| *residual * *inverse).collect();
            assert!(found != alone, "without the contact it would be another");
        }
    }
}
