//! The account of a body: the energy that recovery takes from it, and what it gives back.
//!
//! The push takes energy: a cell gets back as little as half of what it gave. Soft links take the energy that they hold as
//! they return to their rest length, and what they lose in flowing; but links that something stretches hold more than was
//! put into them. The pull brings in energy when it is switched on. Recovery may give no more than it took:
//!
//! ```text
//! taken  +=  − ΔU − F·Δx                    push and pull, of energy U and force F, on the way Δx of a substep
//!            − s ΔE + flow                  links that lose the share s of their force, of energy E
//!            − Δp W                         the share p of the pull is switched on
//! ```
//!
//! Where nothing is left, links that would be stretched keep their whole force, see [`super::soft_links`], and the pull
//! grows no stronger, see [`super::pull`].
//!
//! Differences are taken over two substeps, the last and the coming one, and halved: a force of semi-implicit Euler works at
//! the mean velocity of both. Otherwise a spring would seem to gain energy as it swings.

use super::edges::{MeanEdges, Strength, mean_edges};
use super::pull;
use super::soft_links::{RecoveryWorkspace, for_each_soft_link};
use crate::math::{Real, Vector};
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Model, Scheme};
use crate::physics::state::{BodyMemory, State};
use crate::physics::team::{self, MIN_CONTACT_PARTICLES};

/// Books what recovery took in a substep of a scheme, of length `dt` (s), before particles move with velocity
/// `moving_velocity` (m/s).
pub(in crate::physics) fn track_energy<R: Real>(
    (model, plan): (&Model<R>, &Plan),
    (scheme, dt): (Scheme, R),
    moving_velocity: &[R::Vec3],
    state: &mut State<R>,
    workspaces: &mut [RecoveryWorkspace<R>],
) {
    let State { position, velocity, bodies, .. } = state;
    let of_bodies = (&mut bodies[..], workspaces);
    team::for_body_ranges(
        plan.threads,
        MIN_CONTACT_PARTICLES,
        model,
        (of_bodies, ()),
        |these, (memories, workspaces), ()| {
            let all = model.bodies[these].iter().zip(memories).zip(workspaces);
            for ((body, memory), workspace) in all.filter(|((_, memory), _)| memory.is_watched()) {
                let motion = Motion {
                    position: &position[body.particles.clone()],
                    velocity: &velocity[body.particles.clone()],
                    moving_velocity: &moving_velocity[body.particles.clone()],
                    scheme,
                    dt,
                };
                let taken = taken_by_cells(body, memory, motion) + taken_by_soft_links(body, memory, motion, workspace);
                if taken.is_finite() {
                    memory.account.taken_j += taken;
                }
            }
        },
    );
}

/// The positions of a body's particles, m, the velocities that brought them there and those that move them on, m/s.
#[derive(Clone, Copy)]
struct Motion<'a, R: Real> {
    position: &'a [R::Vec3],
    velocity: &'a [R::Vec3],
    moving_velocity: &'a [R::Vec3],
    scheme: Scheme,
    dt: R,
}

/// Returns what push and pull take, J.
fn taken_by_cells<R: Real>(body: &BodyModel<R>, memory: &BodyMemory, motion: Motion<'_, R>) -> f64 {
    let Motion { position, velocity, moving_velocity, scheme, dt } = motion;
    let push = body.recovery.push;
    let pull = pull::stiffness(body, memory);
    let per_size = body.inverse_cell_size;
    let energy_of = |edges: &MeanEdges<R>| {
        let pulled = pull.map_or(0.0, |pull| pull::cell_energy(edges) * pull.to_f64());
        edges.energy() * push.to_f64() + pulled
    };
    let strength = |stiffness| Strength::of(body, stiffness, scheme, dt);
    let own = [0, 1, 2, 3, 4, 5, 6, 7];
    let mut taken = 0.0;
    for &cell in &memory.near_inversion {
        let corners = &body.lattice.cells[cell as usize];
        let at = |place: fn(R::Vec3, [R::Vec3; 2]) -> R::Vec3| {
            let corners = corners.map(|corner| corner as usize);
            let places = corners.map(|p| place(position[p], [velocity[p] * dt, moving_velocity[p] * dt]));
            MeanEdges::of(&places, &own, per_size)
        };
        let [before, now, after] = [at(|x, [came, _]| x - came), at(|x, _| x), at(|x, [_, goes]| x + goes)];
        let rates = mean_edges(velocity, corners, R::ONE);
        let goes = mean_edges(moving_velocity, corners, R::ONE);
        let work_of = |force: [R::Vec3; 3]| {
            (0..3).fold(0.0, |sum, axis| sum + force[axis].dot((rates[axis] + goes[axis]) * dt).to_f64())
        };
        let pushed = now.push(&rates, strength(push)).map_or(0.0, work_of);
        let pulled = pull.and_then(|pull| pull::cell_force(&now, &rates, strength(pull))).map_or(0.0, work_of);
        taken += 0.5 * (energy_of(&before) - energy_of(&after) - pushed - pulled);
    }
    taken
}

/// Returns what soft links take, J.
fn taken_by_soft_links<R: Real>(
    body: &BodyModel<R>,
    memory: &BodyMemory,
    motion: Motion<'_, R>,
    workspace: &mut RecoveryWorkspace<R>,
) -> f64 {
    let Motion { position, velocity, moving_velocity, dt, .. } = motion;
    let mut taken = 0.0;
    for_each_soft_link(body, memory, [position, velocity], workspace, |[i, j], link| {
        let goes = moving_velocity[j] - moving_velocity[i];
        let energy = |d: R::Vec3| {
            let strain = (d.length() * link.inverse_rest_length - R::ONE).to_f64();
            0.5 * (link.stiffness / link.inverse_rest_length).to_f64() * strain * strain
        };
        let risen = 0.5 * (energy(link.d + goes * dt) - energy(link.d - link.dv * dt));
        let squared = link.d.dot(link.d);
        let along = link.d.dot(link.dv) * link.d.dot((link.dv + goes) * dt);
        let flown = if squared > R::ZERO { link.flow * link.inverse_rest_length * along / squared } else { R::ZERO };
        taken += link.softness.to_f64() * (0.5 * flown.to_f64() - risen);
    });
    taken
}
