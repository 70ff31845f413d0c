//! The energy balance of an implicit substep: whether its linear equations were accurate enough.
//!
//! The implicit integrator linearises the links as they stand when the substep begins. Links that turn or stretch far within
//! it end with more energy than the linear equations account for. With the impulses J of contact and of a hand, and F all
//! other forces, the energy from nowhere is
//!
//! ```text
//! Σ links and crushed cells [V(d') − V(d) − V'(d)·(d' − d)]  +  T(v') − T(v)  −  Σ particles v'·(dt F + J)
//! ```
//!
//! which is the change of a body's energy less all work done on it. For backward Euler, of which the integrator is the first
//! iteration, it is never above zero if the energy is convex (Hairer, Lubich and Wanner, "Geometric Numerical Integration",
//! 2006, VIII.6). The work of contact with obstacles is that of moving surfaces; the energy that its springs store counts as
//! the body's. The work of contact of points, in other bodies or of a mesh at obstacles, is that of its impulses at v', and what
//! is more of it than its spring and parting can do is from nowhere: the rounds that look for what pushes may end before they
//! have settled, with contacts that pull.

use std::ops::Add;

use crate::math::{Real, Vector};
use crate::physics::contact::{BodyContact, ContactRecord, Contacts, SampleContact, WeightedParticles};
use crate::physics::forces::exact::ExactLinks;
use crate::physics::forces::recovery;
use crate::physics::interaction::{Grab, resistance};
use crate::physics::kernels::LinkSum;
use crate::physics::model::BodyModel;
use crate::physics::state::State;
use crate::physics::step::substep::Substep;

/// The rounding error of a body's kinetic energy, as a share of it: velocities are in single precision.
const ROUNDING: f64 = 1e-6;

/// The forces on a particle are rounded as they are added up, each sum by half a unit in the last place. The errors of n
/// forces amount to `√n/2` such units of the sum of their sizes (Higham and Mary, "A new approach to probabilistic rounding
/// error analysis", 2019). A particle has at most 26 structural and shear links, and its weight. Its 6 bending links are not
/// counted: with them it would be 2.9, so this is on the strict side.
const SUMMATION_ERROR: f64 = 2.6;

/// The share of the work of contact that may be missing from the balance: the tolerance of the equations. The work counts up
/// to the kinetic energy at the start, or equations that were not solved at all would pass.
const UNSOLVED_WORK_SHARE: f64 = 2e-4;

/// Whether a substep with this end gives any body energy from nowhere.
pub(in crate::physics) fn gains_energy<R: Real>(
    substep: Substep<'_, R>,
    end: SubstepEnd<'_, R>,
    exact: &mut ExactLinks,
    stops: &dyn Fn() -> bool,
) -> bool {
    let mut bodies = 0..substep.model.bodies.len();
    bodies.any(|number| !substep.state.bodies[number].asleep && body_gains_energy(substep, number, end, exact, stops))
}

/// The end of a substep that is yet to be accepted.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct SubstepEnd<'a, R: Real> {
    /// The velocities at the end, m/s, ...
    pub(in crate::physics) velocity: &'a [R::Vec3],
    /// ... and those that lead particles there.
    pub(in crate::physics) moving: &'a [R::Vec3],
    /// The forces of the state without contact and hand, N.
    pub(in crate::physics) force: &'a [R::Vec3],
    /// What contact did.
    pub(in crate::physics) contacts: Contacts<'a, R>,
}

/// Whether a substep with this end gives one body energy from nowhere.
pub(in crate::physics) fn body_gains_energy<R: Real>(
    substep: Substep<'_, R>,
    number: usize,
    end: SubstepEnd<'_, R>,
    exact: &mut ExactLinks,
    stops: &dyn Fn() -> bool,
) -> bool {
    let Substep { model, state, dt, grab, .. } = substep;
    let SubstepEnd { velocity, moving, force, contacts } = end;
    let body = &model.bodies[number];
    let [first, after] = [body.particles.start, body.particles.end]
        .map(|particle| contacts.at_obstacles.partition_point(|contact| contact.particle < particle));
    let own = &contacts.at_obstacles[first..after];
    let (kinetic, gained, work) = particle_energy(body, dt.to_f64(), state, force, [velocity, moving]);
    let kinetic_at_start = (kinetic - gained - work).max(0.0);
    let (stored, carried, at_obstacles) = contact_energy(body, own, dt, moving);
    let between_bodies = between_bodies_work::<R>(number, contacts.between_bodies, dt.to_f64(), moving);
    let of_points = between_bodies + mesh_work::<R>(number, contacts.on_mesh, dt.to_f64(), moving);
    let total_contact_work = at_obstacles + of_points.total;
    let pulled = grab
        .filter(|grab| grab.body == number)
        .map_or(0.0, |grab| grab_work(grab, body, dt.to_f64(), state, [velocity, moving]));
    let own = [&state.position[..], &state.velocity, moving].map(|of| &of[body.particles.clone()]);
    let unfolded = recovery::energy_past_work(body, &state.bodies[number], own, dt);
    let from_nowhere = gained + link_energy_gain(substep, number, moving, exact, stops) + unfolded + stored
        - carried
        - pulled
        - of_points.sum
        + of_points.from_nowhere;
    let bearable = ROUNDING * kinetic + UNSOLVED_WORK_SHARE * total_contact_work.min(kinetic_at_start);
    // A NaN counts as energy from nowhere.
    from_nowhere.is_nan()
        || from_nowhere > bearable && from_nowhere > bearable + rounding(substep, number, velocity, exact, stops)
}

/// Returns the energy that rounding alone may give or take in this substep, J. A body at rest has no energy but this:
/// dividing the substep does not bring it below what little kinetic energy there is.
///
/// ```text
/// force      f dt (|vᵢ| + |vⱼ|) SUMMATION_ERROR ε    the forces that are worked with are not those of the links
/// velocity   ½ (dt² k/l0 + ½ dt d/l0) w²,  w = ½ ε (|vᵢ| + |vⱼ|)     the ends of a link miss their velocities by w
/// ```
///
/// each summed over all links with forces f. The second is the most that such an error adds: terms linear in w cancel by the
/// balance of momentum, but for that of damping, which together with what damping takes is `c u² − c u w ≥ −c w²/4`.
fn rounding<R: Real>(
    substep: Substep<'_, R>,
    number: usize,
    velocity: &[R::Vec3],
    exact: &mut ExactLinks,
    stops: &dyn Fn() -> bool,
) -> f64 {
    let (epsilon, dt) = (R::EPSILON.to_f64(), substep.dt.to_f64());
    let [of_force, of_velocity] = [SUMMATION_ERROR, 0.5].map(|share| share * epsilon);
    exact.sum(substep, number, velocity, LinkSum::Rounding { of_force, of_velocity }, stops, |[from, to], link| {
        let speeds = from.length() + to.length();
        let force = link.stiffness * (link.d.length() * link.inverse_rest_length - 1.0).abs();
        let resistance = dt * (dt * link.stiffness + 0.5 * link.damping) * link.inverse_rest_length;
        let missed = of_velocity * speeds;
        of_force * force * dt * speeds + 0.5 * resistance * missed * missed
    })
}

/// Returns the kinetic energy at the end, its gain beyond the work of the forces, and that work, J.
fn particle_energy<R: Real>(
    body: &BodyModel<R>,
    dt: f64,
    state: &State<R>,
    force: &[R::Vec3],
    [velocity, moving]: [&[R::Vec3]; 2],
) -> (f64, f64, f64) {
    body.particles.clone().enumerate().fold((0.0, 0.0, 0.0), |(kinetic, gained, sum), (local, particle)| {
        let mass = body.mass(local).to_f64();
        let [before, after] = [state.velocity[particle], velocity[particle]].map(Vector::to_dvec3);
        let change = 0.5 * mass * (after - before).dot(after + before);
        let work = dt * force[particle].to_dvec3().dot(moving[particle].to_dvec3());
        (kinetic + 0.5 * mass * after.length_squared(), gained + change - work, sum + work)
    })
}

/// Returns the energy that contact stores, the work that moving obstacles do, and the sum of the sizes of all work of
/// contact, J.
fn contact_energy<R: Real>(
    body: &BodyModel<R>,
    contacts: &[ContactRecord<R>],
    dt: R,
    velocity: &[R::Vec3],
) -> (f64, f64, f64) {
    let dt = dt.to_f64();
    contacts.iter().fold((0.0, 0.0, 0.0), |(stored, carried, total_contact_work), contact| {
        let [velocity, surface] = [velocity[contact.particle], contact.surface_velocity].map(Vector::to_dvec3);
        let spring = body.contacts[contact.obstacle].to_f64();
        let gap = contact.gap.to_f64();
        let later = gap + dt * (velocity - surface).dot(contact.normal.to_dvec3());
        let force = contact.force.to_dvec3();
        (
            stored + spring.energy(-later) - spring.energy(-gap),
            carried + dt * force.dot(surface),
            total_contact_work + dt * force.dot(velocity).abs(),
        )
    })
}

/// The work of contacts of points on a body, J.
#[derive(Clone, Copy, Debug, Default)]
struct PointWork {
    sum: f64,
    /// The sum of its sizes.
    total: f64,
    /// What is more than springs and parting can do.
    from_nowhere: f64,
}

impl Add for PointWork {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            sum: self.sum + other.sum,
            total: self.total + other.total,
            from_nowhere: self.from_nowhere + other.from_nowhere,
        }
    }
}

/// Returns the work of contacts between bodies on a body.
fn between_bodies_work<R: Real>(number: usize, contacts: &[BodyContact], dt: f64, velocity: &[R::Vec3]) -> PointWork {
    let of_velocity = |particles: &WeightedParticles| particles.mean(|particle| velocity[particle].to_dvec3());
    let own = contacts.iter().filter(|contact| contact.bodies.contains(&number));
    own.fold(PointWork::default(), |sum, contact| {
        let [of_point, of_cell] = contact.bodies.map(|body| if body == number { 1.0 } else { 0.0 });
        let [point, cell] = [&contact.own, &contact.cell].map(of_velocity);
        let work = dt * contact.force.dot(point * of_point - cell * of_cell);
        let from_nowhere = (dt * contact.force.dot(point - cell) - contact.max_work_j).max(0.0);
        sum + PointWork { sum: work, total: work.abs(), from_nowhere }
    })
}

/// Returns the work of contacts of a body's mesh with obstacles.
fn mesh_work<R: Real>(number: usize, contacts: &[SampleContact], dt: f64, velocity: &[R::Vec3]) -> PointWork {
    let own = contacts.iter().filter(|contact| contact.body == number);
    own.fold(PointWork::default(), |sum, contact| {
        let speed = contact.own.mean(|carrier| velocity[carrier].to_dvec3());
        let work = dt * contact.force.dot(speed);
        let from_nowhere = (dt * contact.force.dot(speed - contact.surface_velocity) - contact.max_work_j).max(0.0);
        sum + PointWork { sum: work, total: work.abs(), from_nowhere }
    })
}

/// Returns the energy that the links gain less the work against their forces at the beginning, J.
fn link_energy_gain<R: Real>(
    substep: Substep<'_, R>,
    number: usize,
    velocity: &[R::Vec3],
    exact: &mut ExactLinks,
    stops: &dyn Fn() -> bool,
) -> f64 {
    let dt = substep.dt.to_f64();
    exact.sum(substep, number, velocity, LinkSum::PastForces, stops, |[from, to], link| {
        let way = (to - from) * dt;
        let [before, after] = [link.d.length(), (link.d + way).length()];
        if before == 0.0 {
            // A link without length has no force at the beginning.
            let [strained, later] = [before, after].map(|length| length * link.inverse_rest_length - 1.0);
            return link.stiffness * 0.5 * (later + strained) * after;
        }
        let along = link.d.dot(way);
        let longer = (2.0 * along + way.length_squared()) / (before + after);
        let turned = (before * way.length_squared() - longer * along) / (before * (before + after));
        let strain = before * link.inverse_rest_length - 1.0;
        link.stiffness * (strain * turned + 0.5 * link.inverse_rest_length * longer * longer)
    })
}

/// Returns the work of a hand, J.
fn grab_work<R: Real>(
    grab: &Grab<R>,
    body: &BodyModel<R>,
    dt: f64,
    state: &State<R>,
    velocity: [&[R::Vec3]; 2],
) -> f64 {
    let own = body.particles.clone();
    let away = (grab.target - grab.mean_of(&state.position[own.clone()], own.start)).to_dvec3();
    let [speed, way] = velocity.map(|of| grab.mean_of(&of[own.clone()], own.start).to_dvec3());
    let [stiffness, damping] = [grab.stiffness, grab.damping(body)].map(Real::to_f64);
    let pull = away * stiffness - speed * resistance([stiffness, damping], dt);
    dt * pull.dot(way)
}
