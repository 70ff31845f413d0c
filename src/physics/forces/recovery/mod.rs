//! Recovery from inversion (the "broken cube" of GC §10): springs alone have mirrored minima, in which crushed
//! cells stay inside out for ever.
//!
//! The means a, b, c of a cell's four edges along each axis and its cell size h give the signed volume `V = a·(b×c)/h³`,
//! which is 1 at rest and at most 0 if the cell is inverted. Below [`VOLUME_THRESHOLD`] the cell pushes back:
//!
//! ```text
//!       6───────7         force on the mean edge a, cyclic in a, b, c:
//!      /│      /│         f_a = κ/h min(s, 2) (b×c/h² + s ∂C/∂a)/C,  s = (T − V)/C
//!     4───────5 │  y      each of the four ends of an axis takes a quarter; the others the opposite
//!     │ 2─────│─3  │
//!     │/      │/   └─ x   T = 0.3
//!     0───────1  z            C = max(1, largest face/h²)
//! ```
//!
//! One common C for all three edges keeps momentum and angular momentum. It makes s a length: the height over its largest
//! face that the cell lacks, in cell sizes. So the push is nowhere stronger than 4 κ/h, and a cell is nowhere stiffer than
//! at rest. A push by the volume itself would throw a cell that is a hundred times as wide from one side to the other within
//! a substep: its volume changes a hundred times as fast with its height. The part with ∂C resists what makes a wide cell
//! narrower; it is left out while the cell becomes wider. A damper beside the spring weakens the push on a cell on its way
//! back, by half at most: the cell gives back less than it took from a blow, so that crushed bodies come to rest rather than
//! gain energy. κ follows from the links (`compile::recovery`), so that the push needs no smaller step.
//!
//! Only cells on a list are pushed: those near inversion. All cells are checked for it once in every 1/60 s of simulated
//! time, sooner if particles move past each other fast enough to crush a cell in that time, and in every substep while the
//! list is not empty: a cell that inverted unseen would be given energy. An intact body costs nothing but those few checks.
//! The list is part of the [`State`]: the motion follows from the state alone.
//!
//! If the stiffnesses of the link families are far apart, the push is not enough: see `soft_links`. A body that comes to
//! rest with cells still inverted is also pulled: see `pull`. The implicit integrator takes push and pull into its
//! equations: see `resistance`. Soft links and pull give no more energy than recovery took: see `account`.

mod account;
mod edges;
mod near_inversion;
mod pull;
mod resistance;
mod rotation;
mod soft_links;

pub(in crate::physics) use account::track_energy;
pub(in crate::physics) use resistance::{Resistance, energy_past_work, resistances};
pub(in crate::physics) use rotation::nearest_rotation;
pub(in crate::physics) use soft_links::{RecoveryWorkspace, families_are_far_apart};

use edges::{MeanEdges, Strength, VOLUME_THRESHOLD, add_edge_forces, is_inverted, mean_edges};
use soft_links::soften;

use crate::math::Real;
use crate::physics::forces::links::Configuration;
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Model, Scheme};
use crate::physics::report::Recorder;
use crate::physics::state::{BodyMemory, State};
use crate::physics::step::substep::Substep;
use crate::physics::stepping::checks;
use crate::physics::stepping::speeds::Speeds;
use crate::physics::team::{self, MIN_CONTACT_PARTICLES};

/// Finds the bodies whose cells are checked before this substep: those with cells on their lists, and others from time to
/// time. Returns whether there are any.
pub(in crate::physics) fn find_due_bodies<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    state: &State<R>,
    speeds: &mut Speeds<R>,
    due: &mut Vec<bool>,
) -> bool {
    let taken = checks::substeps_taken(plan, state);
    if plan.lean && state.bodies.iter().any(|memory| !memory.asleep && !memory.is_watched()) {
        speeds.measure(model, plan, state);
    }
    let is_due = |number: usize| {
        let (body, memory) = (&model.bodies[number], &state.bodies[number]);
        let is_time = || checks::is_check_due(body, plan, taken, speeds.relative[number]);
        !memory.asleep && (memory.is_watched() || !plan.lean || is_time())
    };
    due.clear();
    due.extend((0..model.bodies.len()).map(is_due));
    due.contains(&true)
}

/// Checks all cells of the bodies that are due before a substep of `secs`, lists those near inversion, and updates which
/// bodies are stuck.
pub(in crate::physics) fn check_cells<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    state: &mut State<R>,
    due: &[bool],
    secs: f64,
    recorder: &mut Recorder<'_>,
) {
    let State { position, velocity, bodies, .. } = state;
    let checked = model.bodies.iter().zip(due).filter(|(body, is_due)| **is_due && recovers(body));
    recorder.counters.cells_looked_at += checked.map(|(body, _)| body.lattice.cells.len() as u64).sum::<u64>();
    let (position, velocity) = (&*position, &*velocity);
    team::for_body_ranges(plan.threads, MIN_CONTACT_PARTICLES, model, (&mut bodies[..], ()), |these, memories, ()| {
        for (number, memory) in these.zip(memories).filter(|(number, _)| due[*number]) {
            let body = &model.bodies[number];
            let own = [position, velocity].map(|of| &of[body.particles.clone()]);
            check_body(body, plan, own, secs, memory);
        }
    });
}

/// Whether crushed cells of a body are pushed back.
fn recovers<R: Real>(body: &BodyModel<R>) -> bool {
    body.recovery.stiffness > R::ZERO
}

/// [`check_cells`] for one body, whose particles are at `position` (m) and move with `velocity` (m/s).
fn check_body<R: Real>(
    body: &BodyModel<R>,
    plan: &Plan,
    [position, velocity]: [&[R::Vec3]; 2],
    secs: f64,
    memory: &mut BodyMemory,
) {
    memory.near_inversion.clear();
    if !recovers(body) {
        pull::reset(memory);
        return;
    }
    let (cells, scale) = (&body.lattice.cells, body.inverse_cell_size);
    near_inversion::list_near_inversion(plan.simd, cells, position, scale, &mut memory.near_inversion);
    let mut extremes = pull::CellExtremes::default();
    for &number in &memory.near_inversion {
        extremes.include(&MeanEdges::of(position, &cells[number as usize], scale));
    }
    if memory.near_inversion.is_empty() {
        // A debt stays, a credit expires.
        memory.account.taken_j = memory.account.taken_j.min(0.0);
    }
    pull::update_stuck(body, memory, extremes, position, velocity, secs);
    pull::raise_pull_share(body, memory, position);
}

/// A body whose particles have less than this share of a cell's stiffness against inversion as mean kinetic energy is nearly
/// still. What lies on crushed cells then comes to rest in short substeps, whose damper is the strongest; in longer ones it
/// trembles, unseen, and never falls asleep.
const STILL_ENERGY_SHARE: f64 = 1e-5;

/// Whether a body is nearly still but for the motion of the whole along a line.
pub(in crate::physics) fn is_nearly_still<R: Real>(body: &BodyModel<R>, state: &State<R>) -> bool {
    soft_links::kinetic_share(body, &state.velocity[body.particles.clone()]) < STILL_ENERGY_SHARE
}

/// Whether any cell of a body is pushed in this state.
pub(in crate::physics) fn pushes<R: Real>(body: &BodyModel<R>, memory: &BodyMemory, state: &State<R>) -> bool {
    let position = &state.position[body.particles.clone()];
    memory.near_inversion.iter().any(|&cell| {
        let edges = MeanEdges::of(position, &body.lattice.cells[cell as usize], body.inverse_cell_size);
        edges.volume() < R::from_f64(VOLUME_THRESHOLD)
    })
}

/// Adds the push and pull of the cells on the lists of the bodies, N, and softens their links.
pub(in crate::physics) fn add_forces<R: Real>(
    substep: Substep<'_, R>,
    Configuration { position, velocity, .. }: Configuration<'_, R>,
    force: &mut [R::Vec3],
    workspaces: &mut [RecoveryWorkspace<R>],
    recorder: &mut Recorder<'_>,
) {
    let Substep { model, state, plan, scheme, .. } = substep;
    // Verlet's predicted velocities know no contact: a cell that an obstacle is crushing would count as on its way back.
    let velocity = if scheme == Scheme::Verlet { &state.velocity } else { velocity };
    let awake = state.bodies.iter().filter(|memory| !memory.asleep);
    let cells: usize = awake.map(|memory| memory.near_inversion.len()).sum();
    recorder.counters.recovery_cells += cells as u64;
    if cells == 0 {
        return;
    }
    team::for_body_ranges(
        plan.threads,
        MIN_CONTACT_PARTICLES,
        model,
        (workspaces, force),
        |these, workspaces, force| {
            let first = model.bodies[these.start].particles.start;
            for (number, workspace) in these.zip(workspaces) {
                let own = model.bodies[number].particles.clone();
                let force = &mut force[own.start - first..own.end - first];
                push_cells(substep, number, [&position[own.clone()], &velocity[own]], workspace, force);
            }
        },
    );
}

/// [`add_forces`] for one body, whose particles are at `position` (m) and move with `velocity` (m/s).
fn push_cells<R: Real>(
    Substep { model, state, scheme, dt, .. }: Substep<'_, R>,
    number: usize,
    [position, velocity]: [&[R::Vec3]; 2],
    workspace: &mut RecoveryWorkspace<R>,
    force: &mut [R::Vec3],
) {
    let (body, memory) = (&model.bodies[number], &state.bodies[number]);
    if memory.asleep || memory.near_inversion.is_empty() {
        return;
    }
    soften(body, memory, [position, velocity], workspace, force);
    let strength = |stiffness| Strength::of(body, stiffness, scheme, dt);
    let pull = pull::stiffness(body, memory).map(strength);
    let strength = strength(body.recovery.push);
    for &cell in &memory.near_inversion {
        let corners = &body.lattice.cells[cell as usize];
        let edges = MeanEdges::of(position, corners, body.inverse_cell_size);
        let rates = mean_edges(velocity, corners, R::ONE);
        let Some(push) = edges.push(&rates, strength) else { continue };
        add_edge_forces::<R>(&push, corners, force);
        if let Some(pull) = pull.and_then(|pull| pull::cell_force(&edges, &rates, pull)) {
            add_edge_forces::<R>(&pull, corners, force);
        }
    }
}

/// Returns the energy of the push of a body's cells, J, and of the pull if the body is stuck. The cap on far-stretched cells
/// follows no potential: their share is the work that the present push would do.
pub(in crate::physics) fn energy<R: Real>(body: &BodyModel<R>, memory: &BodyMemory, state: &State<R>) -> f64 {
    let position = &state.position[body.particles.clone()];
    let stiffness = body.recovery.push.to_f64();
    let pull = pull::stiffness(body, memory).map_or(0.0, Real::to_f64);
    let energy_of = |corners: &[u32; 8]| {
        let edges = MeanEdges::of(position, corners, body.inverse_cell_size);
        let pulled = if pull > 0.0 { pull * pull::cell_energy(&edges) } else { 0.0 };
        stiffness * edges.energy() + pulled
    };
    body.lattice.cells.iter().map(energy_of).sum()
}

/// Returns how many cells of a body are inverted: their mean edges along the three axes span no positive volume. `position`
/// is the body's own.
pub(in crate::physics) fn inverted_cells<R: Real>(body: &BodyModel<R>, position: &[R::Vec3]) -> usize {
    let volume = |corners: &[u32; 8]| MeanEdges::of(position, corners, body.inverse_cell_size).volume().to_f64();
    body.lattice.cells.iter().filter(|corners| is_inverted(volume(corners))).count()
}
