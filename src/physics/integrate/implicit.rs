//! Linearly implicit Euler: one step of Newton's method for backward Euler, stable at any step, dissipative (Baraff and
//! Witkin, "Large steps in cloth simulation", 1998).
//!
//! ```text
//! (M + dt C + dt² K⁺) v' = M v + dt F(x)          x' = x + dt v'
//! K⁺ of a link = k/l0 ( d̂ d̂ᵀ + max(0, 1 − l0/l) (I − d̂ d̂ᵀ) )
//! ```
//!
//! K⁺ leaves out what a squashed link does across its direction, which could push outwards: so the matrix is positive
//! definite whatever the state. Contact is in it as `(dt² k + dt d) n nᵀ`, friction as a resistance `c (I − n nᵀ)`;
//! which touches push and how much each resists is found by solving again, from the last solution. Conjugate gradients
//! from scratch in double precision, whatever the state is in: what is held by friction is a million times stiffer than
//! what is not. Preconditioned by the diagonal, and by its whole 3×3 block where a particle touches something; sums in
//! a fixed order, body by body: the result is a function of the state alone.

use glam::{DMat3, DVec3};

use super::Free;
use crate::math::{Real, Vector};
use crate::physics::contact::Touch;
use crate::physics::forces::for_each_bond;
use crate::physics::interaction::Grab;
use crate::physics::model::{BodyModel, Model};
use crate::physics::plan::Plan;
use crate::physics::recovery::{self, Resistance};
use crate::physics::report::StepReport;
use crate::physics::state::BodyMemory;

/// Solves in which touches may change their minds.
const ROUNDS: usize = 16;

/// The last of these, which end with what is safe whatever the others have come to.
const CAREFUL_ROUNDS: usize = 2;

/// Iterations of one solve: some ten times those a stiff body of 20 cells an edge takes.
const MOST_ITERATIONS: u64 = 400;

/// The share of a body's momentum, or of the right-hand side where that is smaller, that a solution may miss.
const TOLERANCE: f64 = 1e-4;

/// The least share of the right-hand side that a solution may miss, however slow the body: what is held by friction on
/// a slope would creep by what is missed.
const FINEST_TOLERANCE: f64 = 1e-7;

/// Where the potential rises by no more than this share of how it fell at first, it is as good as level.
const LEVEL: f64 = 0.1;

/// Halvings of the way in which the least of the potential is looked for.
const HALVINGS: usize = 40;

/// A link in the matrix: `across I + along alongᵀ` between its ends. In the precision of the state: reading these is
/// what an iteration takes longest for, and the matrix may be a little off as long as it is the same throughout.
#[derive(Clone, Copy, Debug)]
struct Bond<R: Real> {
    ends: [u32; 2],
    across: R,
    along: R::Vec3,
}

impl<R: Real> Bond<R> {
    #[inline]
    fn times(&self, v: DVec3) -> DVec3 {
        let along = self.along.to_dvec3();
        v * self.across.to_f64() + along * along.dot(v)
    }
}

/// Room for the largest body.
#[derive(Clone, Debug, Default)]
pub(super) struct Room<R: Real> {
    bonds: Vec<Bond<R>>,
    /// Of cells that are pushed back from inversion.
    resistances: Vec<Resistance>,
    inverse_diagonal: Vec<f64>,
    /// The inverse blocks of the touched particles, one for each touch; only the first of a particle's counts.
    inverse_blocks: Vec<DMat3>,
    known: Vec<DVec3>,
    velocity: Vec<DVec3>,
    residual: Vec<DVec3>,
    scaled: Vec<DVec3>,
    search: Vec<DVec3>,
    product: Vec<DVec3>,
    /// The velocity before a solve, and the residual there.
    before: Vec<DVec3>,
    residual_before: Vec<DVec3>,
}

impl<R: Real> Room<R> {
    /// Room for the bodies of a model.
    pub(super) fn new(model: &Model<R>) -> Self {
        let most = |count: fn(&BodyModel<R>) -> usize| model.bodies.iter().map(count).max().unwrap_or(0);
        let particles = most(|body| body.particles.len());
        let links = most(|body| body.links.iter().map(|family| family.links.len()).sum());
        let vectors = || vec![DVec3::ZERO; particles];
        Self {
            bonds: Vec::with_capacity(links),
            resistances: Vec::with_capacity(most(|body| body.lattice.cells.len())),
            inverse_diagonal: vec![0.0; particles],
            inverse_blocks: Vec::with_capacity(particles),
            known: vectors(),
            velocity: vectors(),
            residual: vectors(),
            scaled: vectors(),
            search: vectors(),
            product: vectors(),
            before: vectors(),
            residual_before: vectors(),
        }
    }
}

/// Writes the velocities at the end of the substep.
pub(super) fn solve<R: Real>(
    free: &mut Free<'_, R>,
    grab: Option<&Grab<R>>,
    touches: &mut [Touch],
    velocity: &mut [R::Vec3],
    report: &mut StepReport,
) {
    let Free { model, plan, dt, state, force, .. } = *free;
    let room = &mut free.scratch.room;
    let mut touches = touches;
    for (number, body) in model.bodies.iter().enumerate() {
        // Nothing touches what sleeps.
        if state.bodies[number].asleep {
            continue;
        }
        let own = touches.partition_point(|touch| touch.particle < body.particles.end);
        let (own, others) = touches.split_at_mut(own);
        touches = others;
        let range = body.particles.clone();
        let grab = grab.filter(|grab| grab.body == number);
        let mut system = System { body, dt: dt.to_f64(), grab, touches: own, room };
        let own = [&state.position[..], &state.velocity, force].map(|of| &of[range.clone()]);
        system.assemble(plan, &state.bodies[number], own);
        let enough = system.start();
        for round in 1..=ROUNDS {
            report.solves += 1;
            report.iterations += system.iterate(enough);
            let careful = round + CAREFUL_ROUNDS;
            let all = careful > ROUNDS || system.hold_back();
            if !system.reconsider(careful >= ROUNDS) && all {
                break;
            }
        }
        system.finish(&mut velocity[range]);
    }
}

/// The equations of one body.
struct System<'a, R: Real> {
    body: &'a BodyModel<R>,
    dt: f64,
    grab: Option<&'a Grab<R>>,
    touches: &'a mut [Touch],
    room: &'a mut Room<R>,
}

impl<R: Real> System<'_, R> {
    /// The matrix and the right-hand side without touches, and the velocities now.
    fn assemble(&mut self, plan: &Plan, memory: &BodyMemory, [position, velocity, force]: [&[R::Vec3]; 3]) {
        let dt = self.dt;
        let Room { bonds, known, inverse_diagonal, velocity: now, .. } = &mut *self.room;
        for (local, force) in force.iter().enumerate() {
            let mass = self.body.mass(local).to_f64();
            now[local] = velocity[local].to_dvec3();
            known[local] = now[local] * mass + force.to_dvec3() * dt;
            inverse_diagonal[local] = mass;
        }
        bonds.clear();
        for_each_bond(self.body, plan.families, position, |[i, j], bond| {
            let stiff = dt * dt * bond.stiffness.to_f64();
            let across = stiff * bond.slack.to_f64();
            let damping = dt * bond.damping.to_f64();
            let along = stiff - across + damping;
            let direction = bond.direction.to_dvec3();
            let diagonal = across + along / 3.0;
            inverse_diagonal[i as usize] += diagonal;
            inverse_diagonal[j as usize] += diagonal;
            let along = R::Vec3::from_dvec3(direction * along.sqrt());
            bonds.push(Bond { ends: [i, j], across: R::from_f64(across), along });
        });
        self.room.resistances.clear();
        self.room.resistances.extend(recovery::resistances(plan, self.body, memory, position));
        let Room { resistances, inverse_diagonal, .. } = &mut *self.room;
        for resistance in resistances {
            resistance.for_each_diagonal(|corner, diagonal| inverse_diagonal[corner] += dt * dt * diagonal);
        }
        if let Some(grab) = self.grab {
            let first = self.body.particles.start;
            let away = (grab.target - grab.mean_of(position, first)).to_dvec3();
            let resistance = self.grab_resistance(grab);
            for &(particle, weight) in &grab.weights {
                let (local, weight) = (particle - first, weight.to_f64());
                self.room.known[local] += away * (dt * grab.stiffness.to_f64() * weight);
                self.room.inverse_diagonal[local] += resistance * weight * weight;
            }
        }
        for diagonal in &mut self.room.inverse_diagonal[..self.body.particles.len()] {
            *diagonal = 1.0 / *diagonal;
        }
    }

    fn grab_resistance(&self, grab: &Grab<R>) -> f64 {
        self.dt * (self.dt * grab.stiffness.to_f64() + grab.damping(self.body).to_f64())
    }

    /// Where the iteration starts: with the velocities now and, where nothing holds the body, its motion as a whole.
    /// Returns how small a residual has to become.
    fn start(&mut self) -> f64 {
        let count = self.body.particles.len();
        self.find_residual(false);
        self.room.inverse_blocks.clear();
        let known = self.scale_residual();
        let moving = (0..count)
            .fold(0.0, |sum, local| sum + self.body.mass(local).to_f64() * self.room.velocity[local].length_squared());
        if self.touches.is_empty() && self.body.pinned.is_empty() {
            let (sum, mass) = (0..count).fold((DVec3::ZERO, 0.0), |(sum, mass), local| {
                (sum + self.room.residual[local], mass + self.body.mass(local).to_f64())
            });
            for velocity in &mut self.room.velocity[..count] {
                *velocity += sum / mass;
            }
        }
        (moving.min(known) * TOLERANCE * TOLERANCE).max(known * FINEST_TOLERANCE * FINEST_TOLERANCE)
    }

    /// What the equations miss of being fulfilled.
    fn find_residual(&mut self, touched: bool) {
        let mut product = std::mem::take(&mut self.room.product);
        self.times(&self.room.velocity, &mut product);
        self.room.product = product;
        let Room { residual, known, product, velocity, .. } = &mut *self.room;
        for (local, residual) in residual[..self.body.particles.len()].iter_mut().enumerate() {
            *residual = known[local] - product[local];
        }
        if touched {
            for touch in &*self.touches {
                let local = touch.particle - self.body.particles.start;
                residual[local] += touch.impulse(velocity[local]);
            }
        }
    }

    /// Conjugate gradients with the touches as they are. Returns how many iterations it took.
    fn iterate(&mut self, enough: f64) -> u64 {
        let count = self.body.particles.len();
        self.find_residual(true);
        self.precondition();
        self.room.before[..count].copy_from_slice(&self.room.velocity[..count]);
        self.room.residual_before[..count].copy_from_slice(&self.room.residual[..count]);
        let mut missed = self.scale_residual();
        let mut size = dot(&self.room.residual[..count], &self.room.scaled[..count]);
        self.room.search[..count].copy_from_slice(&self.room.scaled[..count]);
        let mut iterations = 0;
        while iterations < MOST_ITERATIONS && missed > enough {
            let mut product = std::mem::take(&mut self.room.product);
            self.times(&self.room.search, &mut product);
            for touch in &*self.touches {
                let local = touch.particle - self.body.particles.start;
                product[local] += *touch.matrix() * self.room.search[local];
            }
            self.room.product = product;
            let Room { search, product, velocity, residual, .. } = &mut *self.room;
            let curvature = dot(&search[..count], &product[..count]);
            if curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let length = size / curvature;
            for local in 0..count {
                velocity[local] += search[local] * length;
                residual[local] -= product[local] * length;
            }
            missed = self.scale_residual();
            let smaller = dot(&self.room.residual[..count], &self.room.scaled[..count]);
            let keep = smaller / size;
            let Room { search, scaled, .. } = &mut *self.room;
            for (search, scaled) in search[..count].iter_mut().zip(&scaled[..count]) {
                *search = *scaled + *search * keep;
            }
            size = smaller;
            iterations += 1;
        }
        iterations
    }

    /// Goes back from where the last solve led to the least of the potential on the way there, if that is not near the
    /// end: the equations of touches are true near where they were set up only. Says whether it is the end.
    ///
    /// The potential is convex as long as Coulomb's limits are what they are, and the way leads down. Its slope on the way
    /// is that of all but the touches, linear in the share of the way, and theirs.
    fn hold_back(&mut self) -> bool {
        let Room { before, velocity, residual_before, residual, search, .. } = &mut *self.room;
        let count = self.body.particles.len();
        let first = self.body.particles.start;
        for (way, (after, before)) in search[..count].iter_mut().zip(velocity[..count].iter().zip(before.iter())) {
            *way = *after - *before;
        }
        let ends = [(&*before, residual_before), (&*velocity, residual)].map(|(at, residual)| {
            let touched = self.touches.iter().map(|touch| {
                let local = touch.particle - first;
                touch.impulse(at[local]).dot(search[local])
            });
            touched.sum::<f64>() - dot(&residual[..count], &search[..count])
        });
        let slope = |share: f64| {
            let touched = self.touches.iter().map(|touch| {
                let local = touch.particle - first;
                touch.lawful_impulse(before[local] + search[local] * share).dot(search[local])
            });
            ends[0] + share * (ends[1] - ends[0]) - touched.sum::<f64>()
        };
        let least = LEVEL * slope(0.0).abs();
        if slope(1.0) <= least {
            return true;
        }
        let [mut low, mut high] = [0.0, 1.0];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if slope(middle) > 0.0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        let share = 0.5 * (low + high);
        for (velocity, (way, before)) in velocity[..count].iter_mut().zip(search.iter().zip(before.iter())) {
            *velocity = *before + *way * share;
        }
        false
    }

    /// The inverse blocks of touched particles.
    fn precondition(&mut self) {
        let Room { inverse_blocks, inverse_diagonal, .. } = &mut *self.room;
        inverse_blocks.clear();
        for own in self.touches.chunk_by(|a, b| a.particle == b.particle) {
            let diagonal = 1.0 / inverse_diagonal[own[0].particle - self.body.particles.start];
            let block =
                own.iter().fold(DMat3::from_diagonal(DVec3::splat(diagonal)), |sum, touch| sum + *touch.matrix());
            inverse_blocks.push(block.inverse());
        }
    }

    /// The residual over the diagonal. Returns its size in that norm: over the diagonal without touches, or what is held
    /// would hardly count.
    fn scale_residual(&mut self) -> f64 {
        let Room { residual, scaled, inverse_diagonal, inverse_blocks, .. } = &mut *self.room;
        let mut sum = 0.0;
        for local in 0..self.body.particles.len() {
            if self.body.is_pinned(local) {
                scaled[local] = DVec3::ZERO;
            } else {
                scaled[local] = residual[local] * inverse_diagonal[local];
                sum += residual[local].dot(scaled[local]);
            }
        }
        let touched = self.touches.chunk_by(|a, b| a.particle == b.particle);
        for (own, block) in touched.zip(inverse_blocks) {
            let local = own[0].particle - self.body.particles.start;
            scaled[local] = *block * residual[local];
        }
        sum
    }

    /// The matrix without touches times a vector.
    fn times(&self, of: &[DVec3], product: &mut [DVec3]) {
        for (local, of) in of[..self.body.particles.len()].iter().enumerate() {
            product[local] = *of * self.body.mass(local).to_f64();
        }
        for bond in &self.room.bonds {
            let [i, j] = bond.ends.map(|end| end as usize);
            let part = bond.times(of[i] - of[j]);
            product[i] += part;
            product[j] -= part;
        }
        for resistance in &self.room.resistances {
            resistance.add_product(self.dt * self.dt, of, product);
        }
        if let Some(grab) = self.grab {
            let first = self.body.particles.start;
            let speed: DVec3 = grab.weights.iter().map(|&(particle, w)| of[particle - first] * w.to_f64()).sum();
            let pull = speed * self.grab_resistance(grab);
            for &(particle, weight) in &grab.weights {
                product[particle - first] += pull * weight.to_f64();
            }
        }
    }

    /// Lets every touch decide again. Says whether it has to be solved again.
    fn reconsider(&mut self, carefully: bool) -> bool {
        let mut again = false;
        for touch in &mut *self.touches {
            let local = touch.particle - self.body.particles.start;
            again |= touch.reconsider(self.room.velocity[local], carefully);
        }
        again
    }

    fn finish(&self, velocity: &mut [R::Vec3]) {
        for (local, velocity) in velocity.iter_mut().enumerate() {
            let pinned = self.body.is_pinned(local);
            *velocity = if pinned { R::Vec3::ZERO } else { R::Vec3::from_dvec3(self.room.velocity[local]) };
        }
    }
}

/// The inner product: four sums in a fixed order.
fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    let mut sums = [0.0; 4];
    for (a, b) in a.chunks(4).zip(b.chunks(4)) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a.dot(*b);
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}
