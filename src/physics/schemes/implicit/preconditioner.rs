//! The preconditioner: a rough solution for a residual, the sum of
//!
//! ```text
//! diagonal       particle by particle; for particles that touch an obstacle their 3×3 blocks
//! points         what contacts of points make of that
//! multigrid      the stiffness of bodies over many cells
//! rigid          the motions of bodies that touch each other as rigid ones
//! ```
//!
//! Each of them is symmetric, and so is their sum; the first is positive definite, the others are not negative. Where these do
//! not suffice, a factor of the matrix takes the place of all ([`super::direct`]).

use glam::{DMat3, DVec3};

use super::rigid::{MAX_BODIES, MOTIONS};
use super::system::{BodyEquations, ImplicitWorkspace, System};
use super::vectors::scale;
use crate::math::{Real, Vector};
use crate::physics::contact::ParticleConstraint;
use crate::physics::forces::particles::zero_pinned;
use crate::physics::model::Values;

impl<R: Real> System<'_, R> {
    /// Sets up all parts for the constraints as they are.
    pub(super) fn precondition(&mut self) {
        let ImplicitWorkspace { inverse_blocks, diagonal, .. } = &mut *self.workspace;
        inverse_blocks.clear();
        for own in self.at_obstacles.chunk_by(|a, b| a.particle == b.particle) {
            let particle = own[0].particle;
            let block = own.iter().fold(DMat3::from_diagonal(DVec3::splat(diagonal[particle])), |sum, one| {
                sum + *one.constraint.matrix()
            });
            inverse_blocks.push((particle, block.inverse()));
        }
        let Self { points, weights, workspace, .. } = self;
        let ImplicitWorkspace { point_blocks, inverse_blocks, inverse_diagonal, .. } = &mut **workspace;
        point_blocks.clear();
        for contact in points.iter().filter(|contact| contact.constraint.is_in_equations()) {
            point_blocks.add_contact(contact, weights, inverse_diagonal, inverse_blocks);
        }
        self.set_grid_resistance();
        self.make_rigid_motions();
    }

    /// Passes contact on to the coarse grids.
    fn set_grid_resistance(&mut self) {
        let (model, weights) = (self.model, self.weights);
        for number in self.bodies {
            let own = model.bodies[*number].particles.clone();
            let BodyEquations { grids, uses_grids, .. } = &mut self.workspace.bodies[*number];
            let Some(grids) = grids.as_mut().filter(|_| *uses_grids) else { continue };
            let at_obstacles = self.at_obstacles.iter().filter(|one| own.contains(&one.particle));
            let at_obstacles = at_obstacles.map(|one| (one.particle - own.start, *one.constraint.matrix()));
            // The weights of a body in a contact sum to one, so that the whole of it is resisted by as much as the contact
            // resists.
            let points = self.points.iter().filter(|contact| contact.touching.bodies().contains(number));
            let points = points.filter(|contact| contact.constraint.is_in_equations());
            let points = points.flat_map(|contact| {
                let matrix = *contact.constraint.matrix();
                contact.own(weights).iter().map(move |&(particle, weight)| (particle as usize, matrix * weight.abs()))
            });
            let points = points.filter(|(particle, _)| own.contains(particle));
            grids.set_resistance(at_obstacles.chain(points.map(|(particle, matrix)| (particle - own.start, matrix))));
        }
    }

    /// Divides the residual by the diagonal, or by the blocks of touched particles, and lets contacts of points act on it. Finds its squared norm over the diagonal
    /// without constraints for each body: over the diagonal with them, held particles would hardly count.
    pub(super) fn scale_residual(&mut self) {
        let ranges = self.ranges();
        let ImplicitWorkspace {
            bodies, residual, scaled, inverse_diagonal, inverse_blocks, point_blocks, direct, ..
        } = &mut *self.workspace;
        for (number, own) in ranges {
            let [residual, inverse] = [&*residual, inverse_diagonal].map(|of| &of[own.clone()]);
            bodies[number].squared_residual = scale(self.level, residual, inverse, &mut scaled[own]);
        }
        if direct.is_used {
            direct.precondition(self.level, residual, scaled);
            return;
        }
        for (particle, block) in &*inverse_blocks {
            scaled[*particle] = *block * residual[*particle];
        }
        point_blocks.relax(inverse_blocks, scaled);
    }

    /// Adds the corrections of the coarse grids and of the rigid motions for the residual.
    pub(super) fn add_coarse_correction(&mut self) {
        if self.workspace.direct.is_used {
            return;
        }
        for (number, own) in self.ranges() {
            let ImplicitWorkspace { bodies, scaled, residual, .. } = &mut *self.workspace;
            let BodyEquations { grids, uses_grids, .. } = &mut bodies[number];
            let Some(grids) = grids.as_mut().filter(|_| *uses_grids) else { continue };
            let body = &self.model.bodies[number];
            let (residual, scaled) = (&mut residual[own.clone()], &mut scaled[own.clone()]);
            zero_pinned(body, 0..own.len(), residual);
            grids.correct(self.level, residual, scaled);
            zero_pinned(body, 0..own.len(), scaled);
        }
        self.add_rigid_correction();
    }

    /// Finds the bodies that move as a whole, and where their particles are from their middles.
    pub(super) fn prepare_rigid_motions(&mut self, position: &[R::Vec3]) {
        let (model, ranges) = (self.model, self.ranges());
        let has_points = !self.points.is_empty() && self.bodies.len() <= MAX_BODIES;
        let rigid = &mut self.workspace.rigid;
        rigid.count = 0;
        if !has_points {
            return;
        }
        // Room for the largest island that there may be.
        let most = MOTIONS * model.bodies.len().min(MAX_BODIES);
        for equations in [&mut rigid.masses, &mut rigid.matrix] {
            equations.reserve((most * most).saturating_sub(equations.len()));
        }
        rigid.solution.reserve(most.saturating_sub(rigid.solution.len()));
        let bodies = ranges.filter(|(number, _)| model.bodies[*number].pinned == Values::Uniform(false));
        rigid.count = MOTIONS * bodies.clone().count();
        rigid.masses.clear();
        rigid.masses.resize(rigid.count * rigid.count, 0.0);
        rigid.place_of.clear();
        rigid.place_of.resize(model.bodies.len(), None);
        rigid.from_middle.resize(model.particle_count(), DVec3::ZERO);
        for (place, (number, own)) in bodies.enumerate() {
            rigid.place_of[number] = Some(place);
            let middle = own.clone().fold(DVec3::ZERO, |sum, particle| sum + position[particle].to_dvec3());
            let middle = middle / own.len() as f64;
            for (local, particle) in own.enumerate() {
                rigid.from_middle[particle] = position[particle].to_dvec3() - middle;
                rigid.add_mass(place, particle, model.bodies[number].mass(local).to_f64());
            }
        }
    }

    /// Sets up and factorises the equations of the rigid motions for the constraints as they are.
    fn make_rigid_motions(&mut self) {
        if self.workspace.rigid.count == 0 {
            return;
        }
        let model = self.model;
        let Self { at_obstacles, points, weights, workspace, .. } = self;
        let rigid = &mut workspace.rigid;
        rigid.begin();
        for ParticleConstraint { body, particle, constraint, .. } in &**at_obstacles {
            if let Some(place) = rigid.place_of[*body] {
                rigid.add(&[(place, rigid.rows(*particle))], *constraint.matrix());
            }
        }
        for contact in points.iter().filter(|contact| contact.constraint.is_in_equations()) {
            let of_body = |number: usize| {
                let mut sums = [DVec3::ZERO; MOTIONS];
                for &(particle, weight) in contact.own(weights) {
                    let particle = particle as usize;
                    if model.bodies[number].particles.contains(&particle) {
                        let rows = rigid.rows(particle);
                        sums.iter_mut().zip(rows).for_each(|(sum, row)| *sum += row * weight);
                    }
                }
                (rigid.place_of[number].unwrap_or_default(), sums)
            };
            let [one, other] = contact.touching.bodies();
            let matrix = *contact.constraint.matrix();
            let moving = [one, other].map(|number| rigid.place_of[number].is_some());
            match moving {
                [true, true] if one != other => {
                    let both = [of_body(one), of_body(other)];
                    rigid.add(&both, matrix);
                }
                [true, _] => {
                    let alone = [of_body(one)];
                    rigid.add(&alone, matrix);
                }
                [false, true] => {
                    let alone = [of_body(other)];
                    rigid.add(&alone, matrix);
                }
                [false, false] => {}
            }
        }
        rigid.factorise();
    }

    /// Adds the rigid motions for the residual.
    fn add_rigid_correction(&mut self) {
        let bodies = self.ranges();
        let ImplicitWorkspace { rigid, residual, scaled, .. } = &mut *self.workspace;
        if rigid.count == 0 {
            return;
        }
        for (number, own) in bodies.clone() {
            let Some(place) = rigid.place_of[number] else { continue };
            let of_particles = residual[own.clone()].iter().zip(&rigid.from_middle[own]);
            let (force, torque) = of_particles.fold((DVec3::ZERO, DVec3::ZERO), |(force, torque), (residual, from)| {
                (force + *residual, torque + from.cross(*residual))
            });
            let load = &mut rigid.solution[place * MOTIONS..][..MOTIONS];
            load.copy_from_slice(&[force.x, force.y, force.z, torque.x, torque.y, torque.z]);
        }
        rigid.solve();
        for (number, own) in bodies {
            let Some(place) = rigid.place_of[number] else { continue };
            let [drift, turn] = [0, 3].map(|first| DVec3::from_slice(&rigid.solution[place * MOTIONS + first..]));
            for (scaled, from) in scaled[own.clone()].iter_mut().zip(&rigid.from_middle[own]) {
                *scaled += drift + turn.cross(*from);
            }
        }
    }
}
