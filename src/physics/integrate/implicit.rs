//! Linearly implicit Euler: one step of Newton's method for backward Euler, stable at any step, dissipative (Baraff and
//! Witkin, "Large steps in cloth simulation", 1998).
//!
//! ```text
//! (M + dt C + dt² K⁺) Δv = dt F(x, v) − dt² K⁺ v        v' = v + Δv      x' = x + dt v'
//! K⁺ of a link = k/l0 ( d̂ d̂ᵀ + max(0, 1 − l0/l) (I − d̂ d̂ᵀ) )
//! ```
//!
//! K⁺ leaves out what a squashed link does across its direction, which could push outwards: so the matrix is positive
//! definite whatever the state. Contact is in it as `(dt² k + dt d) n nᵀ`; what sticks has its sliding taken out of the
//! unknowns; which touches push, slide or stick is found by solving again. Conjugate gradients from scratch, with the
//! diagonal as preconditioner and inner products in double precision and a fixed order, body by body: the result is a
//! function of the state alone. Stopping early is harmless: every iterate takes less of the step, never more.

use super::Free;
use crate::math::{Real, Vector};
use crate::physics::contact::{Hold, Touch};
use crate::physics::forces::for_each_bond;
use crate::physics::interaction::Grab;
use crate::physics::model::{BodyModel, Model};
use crate::physics::plan::Plan;
use crate::physics::report::StepReport;

/// Solves in which touches may change their minds.
const ROUNDS: usize = 6;

/// Iterations of one solve: some ten times those a stiff body of 20 cells an edge takes.
const MOST_ITERATIONS: usize = 400;

/// A link in the matrix: `across I + along d̂ d̂ᵀ` between its ends.
#[derive(Clone, Copy, Debug)]
struct Bond<R: Real> {
    ends: [u32; 2],
    direction: R::Vec3,
    across: R,
    along: R,
}

impl<R: Real> Bond<R> {
    #[inline]
    fn times(&self, v: R::Vec3) -> R::Vec3 {
        v * self.across + self.direction * (self.along * self.direction.dot(v))
    }
}

/// Room for the largest body.
#[derive(Clone, Debug, Default)]
pub(super) struct Room<R: Real> {
    bonds: Vec<Bond<R>>,
    inverse_diagonal: Vec<R>,
    known: Vec<R::Vec3>,
    change: Vec<R::Vec3>,
    residual: Vec<R::Vec3>,
    scaled: Vec<R::Vec3>,
    search: Vec<R::Vec3>,
    product: Vec<R::Vec3>,
}

impl<R: Real> Room<R> {
    /// Room for the bodies of a model.
    pub(super) fn new(model: &Model<R>) -> Self {
        let most = |count: fn(&BodyModel<R>) -> usize| model.bodies.iter().map(count).max().unwrap_or(0);
        let particles = most(|body| body.particles.len());
        let links = most(|body| body.links.iter().map(|family| family.links.len()).sum());
        let vectors = || vec![R::Vec3::ZERO; particles];
        Self {
            bonds: Vec::with_capacity(links),
            inverse_diagonal: vec![R::ZERO; particles],
            known: vectors(),
            change: vectors(),
            residual: vectors(),
            scaled: vectors(),
            search: vectors(),
            product: vectors(),
        }
    }
}

/// Writes the velocities at the end of the substep.
pub(super) fn solve<R: Real>(
    free: &mut Free<'_, R>,
    grab: Option<&Grab<R>>,
    touches: &mut [Touch<R>],
    velocity: &mut [R::Vec3],
    report: &mut StepReport,
) {
    let Free { model, plan, dt, state, force, .. } = *free;
    let room = &mut free.scratch.room;
    let mut touches = touches;
    for (number, body) in model.bodies.iter().enumerate() {
        let own = touches.partition_point(|touch| touch.particle < body.particles.end);
        let (own, others) = touches.split_at_mut(own);
        touches = others;
        let range = body.particles.clone();
        let mut system = System {
            body,
            dt,
            position: &state.position[range.clone()],
            velocity: &state.velocity[range.clone()],
            grab: grab.filter(|grab| grab.body == number),
            touches: own,
            room,
        };
        system.assemble(plan, &force[range.clone()]);
        for round in 0..ROUNDS {
            system.start(round == 0);
            report.iterations += system.iterate();
            if !system.reconsider() {
                break;
            }
        }
        system.finish(&mut velocity[range]);
    }
}

/// The equations of one body.
struct System<'a, R: Real> {
    body: &'a BodyModel<R>,
    dt: R,
    position: &'a [R::Vec3],
    velocity: &'a [R::Vec3],
    grab: Option<&'a Grab<R>>,
    touches: &'a mut [Touch<R>],
    room: &'a mut Room<R>,
}

impl<R: Real> System<'_, R> {
    fn local(&self, particle: usize) -> usize {
        particle - self.body.particles.start
    }

    /// The links' part of the matrix and of the right-hand side.
    fn assemble(&mut self, plan: &Plan, force: &[R::Vec3]) {
        let dt = self.dt;
        let Room { bonds, known, inverse_diagonal, .. } = &mut *self.room;
        for (local, force) in force.iter().enumerate() {
            known[local] = *force * dt;
            inverse_diagonal[local] = self.body.mass(local);
        }
        bonds.clear();
        let (position, velocity) = (self.position, self.velocity);
        let third = R::from_f64(1.0 / 3.0);
        for_each_bond(self.body, plan.families, position, |[i, j], bond| {
            let stiff = dt * dt * bond.stiffness;
            let across = stiff * bond.slack;
            let rate = velocity[i as usize] - velocity[j as usize];
            let pushed = rate * across + bond.direction * ((stiff - across) * bond.direction.dot(rate));
            known[i as usize] -= pushed;
            known[j as usize] += pushed;
            let along = stiff - across + dt * bond.damping;
            let diagonal = across + along * third;
            inverse_diagonal[i as usize] += diagonal;
            inverse_diagonal[j as usize] += diagonal;
            bonds.push(Bond { ends: [i, j], direction: bond.direction, across, along });
        });
        if let Some(grab) = self.grab {
            let resistance = grab_resistance(grab, self.body, dt);
            let speed = self.grabbed(grab, self.velocity);
            let pull = (grab.target - grab.mean_of(self.position, self.body.particles.start)) * (dt * grab.stiffness)
                - speed * resistance;
            for &(particle, weight) in &grab.weights {
                let local = self.local(particle);
                self.room.known[local] += pull * weight;
                self.room.inverse_diagonal[local] += resistance * weight * weight;
            }
        }
        for touch in &*self.touches {
            let local = touch.particle - self.body.particles.start;
            self.room.inverse_diagonal[local] += touch.resistance * third;
        }
        for diagonal in &mut self.room.inverse_diagonal[..self.body.particles.len()] {
            *diagonal = R::ONE / *diagonal;
        }
    }

    /// The mean velocity of the grabbed point.
    fn grabbed(&self, grab: &Grab<R>, of: &[R::Vec3]) -> R::Vec3 {
        grab.mean_of(of, self.body.particles.start)
    }

    /// Where the iteration starts, and its residual: at first with the motion of the body as a whole, then with the
    /// last solution; what sticks is stopped from the beginning.
    fn start(&mut self, first: bool) {
        let count = self.body.particles.len();
        if first {
            let free = self.touches.is_empty() && self.body.pinned.is_empty();
            let (sum, mass) = (0..count).fold((R::Vec3::ZERO, R::ZERO), |(sum, mass), local| {
                (sum + self.room.known[local], mass + self.body.mass(local))
            });
            let whole = if free { sum * (R::ONE / mass) } else { R::Vec3::ZERO };
            self.room.change[..count].fill(whole);
        }
        for touch in &*self.touches {
            if touch.hold == Hold::Sticks {
                let local = touch.particle - self.body.particles.start;
                let change = &mut self.room.change[local];
                *change = touch.normal * change.dot(touch.normal) - touch.sliding(self.velocity[local]);
            }
        }
        let mut product = std::mem::take(&mut self.room.product);
        self.times(&self.room.change, &mut product);
        self.room.product = product;
        for local in 0..count {
            self.room.residual[local] = self.room.known[local] - self.room.product[local];
        }
        for touch in &*self.touches {
            let local = touch.particle - self.body.particles.start;
            self.room.residual[local] += touch.impulse(self.velocity[local]);
        }
    }

    /// Conjugate gradients. Returns how many iterations it took.
    fn iterate(&mut self) -> u64 {
        let count = self.body.particles.len();
        // Half the digits: what the rest of the substep is good for.
        let tolerance = R::EPSILON.to_f64();
        self.scale_residual();
        let mut size = dot::<R>(&self.room.residual[..count], &self.room.scaled[..count]);
        let enough = tolerance * self.size_of_known().max(size);
        self.room.search[..count].copy_from_slice(&self.room.scaled[..count]);
        let mut iterations = 0;
        while size > enough && iterations < MOST_ITERATIONS as u64 {
            let mut product = std::mem::take(&mut self.room.product);
            self.times(&self.room.search, &mut product);
            self.room.product = product;
            let Room { search, product, change, residual, .. } = &mut *self.room;
            let curvature = dot::<R>(&search[..count], &product[..count]);
            if curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let length = R::from_f64(size / curvature);
            for local in 0..count {
                change[local] += search[local] * length;
                residual[local] -= product[local] * length;
            }
            self.scale_residual();
            let smaller = dot::<R>(&self.room.residual[..count], &self.room.scaled[..count]);
            let keep = R::from_f64(smaller / size);
            let Room { search, scaled, .. } = &mut *self.room;
            for (search, scaled) in search[..count].iter_mut().zip(&scaled[..count]) {
                *search = *scaled + *search * keep;
            }
            size = smaller;
            iterations += 1;
        }
        iterations
    }

    /// The size of the right-hand side in the norm of the residual.
    fn size_of_known(&self) -> f64 {
        let Room { known, inverse_diagonal, .. } = &*self.room;
        (0..self.body.particles.len())
            .filter(|&local| !self.body.is_pinned(local))
            .map(|local| known[local].dot(known[local]).to_f64() * inverse_diagonal[local].to_f64())
            .sum()
    }

    /// The residual over the diagonal, along the unknowns only.
    fn scale_residual(&mut self) {
        let Room { residual, scaled, inverse_diagonal, .. } = &mut *self.room;
        for local in 0..self.body.particles.len() {
            let free = !self.body.is_pinned(local);
            scaled[local] = if free { residual[local] * inverse_diagonal[local] } else { R::Vec3::ZERO };
        }
        for touch in &*self.touches {
            if touch.hold == Hold::Sticks {
                let scaled = &mut scaled[touch.particle - self.body.particles.start];
                *scaled = touch.normal * scaled.dot(touch.normal);
            }
        }
    }

    /// The matrix times a vector.
    fn times(&self, of: &[R::Vec3], product: &mut [R::Vec3]) {
        for (local, of) in of[..self.body.particles.len()].iter().enumerate() {
            product[local] = *of * self.body.mass(local);
        }
        for bond in &self.room.bonds {
            let [i, j] = bond.ends.map(|end| end as usize);
            let part = bond.times(of[i] - of[j]);
            product[i] += part;
            product[j] -= part;
        }
        for touch in &*self.touches {
            if touch.hold != Hold::Free {
                let local = touch.particle - self.body.particles.start;
                product[local] += touch.normal * (touch.resistance * touch.normal.dot(of[local]));
            }
        }
        if let Some(grab) = self.grab {
            let pull = self.grabbed(grab, of) * grab_resistance(grab, self.body, self.dt);
            for &(particle, weight) in &grab.weights {
                product[self.local(particle)] += pull * weight;
            }
        }
    }

    /// Lets every touch decide again. Says whether any did otherwise.
    fn reconsider(&mut self) -> bool {
        let mut again = false;
        for touch in &mut *self.touches {
            let local = touch.particle - self.body.particles.start;
            let residual = self.room.residual[local];
            let kept = touch.normal * residual.dot(touch.normal) - residual;
            again |= touch.reconsider(self.velocity[local] + self.room.change[local], kept);
        }
        again
    }

    fn finish(&self, velocity: &mut [R::Vec3]) {
        for (local, velocity) in velocity.iter_mut().enumerate() {
            let solved = self.velocity[local] + self.room.change[local];
            *velocity = if self.body.is_pinned(local) { R::Vec3::ZERO } else { solved };
        }
        for touch in &*self.touches {
            let velocity = &mut velocity[touch.particle - self.body.particles.start];
            *velocity = touch.never_reversed(*velocity);
        }
    }
}

fn grab_resistance<R: Real>(grab: &Grab<R>, body: &BodyModel<R>, dt: R) -> R {
    dt * (dt * grab.stiffness + grab.damping(body))
}

/// The inner product in double precision: four sums in a fixed order.
fn dot<R: Real>(a: &[R::Vec3], b: &[R::Vec3]) -> f64 {
    let mut sums = [0.0; 4];
    for (a, b) in a.chunks(4).zip(b.chunks(4)) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            let ([ax, ay, az], [bx, by, bz]) = (a.components(), b.components());
            *sum += ax.to_f64() * bx.to_f64() + ay.to_f64() * by.to_f64() + az.to_f64() * bz.to_f64();
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}
