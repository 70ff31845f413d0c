//! How large a step may be, computed before anything moves.
//!
//! Semi-implicit Euler with link forces `K` and damping `C` is the leapfrog scheme with centred damping; its energy stays
//! positive, and the motion bounded, iff `4M − dt² K − 2 dt C` is positive definite. Each link contributes
//! `κ (d̂·(x_j − x_i))²` with `κ = dt² k/l0 + 2 dt d/l0`. For an infinite lattice the largest eigenvalue follows from plane
//! waves (Bloch): over wave vectors q,
//!
//! ```text
//! λ(dt) = max_q λ_max( Σ over 16 half links of 2 κ (1 − cos q·δ) d̂ d̂ᵀ ) / m   ≤   4
//! ```
//!
//! If cells share out links and masses, the bound is that of the stiffest cell (`cells`), or of the whole lattice if all
//! cells are alike (`lattice`). If springs differ by cell, the bound is that of the particle whose links hold it most
//! strongly (`particles`).
//!
//! Removing links only lowers the quadratic form, so the bound holds for every subset of cells with the same mass per
//! particle, whatever its size. It is a bound at rest. Bodies whose particles are misplaced by a cell were seen to blow up
//! from about 0.58 of it where stiffness limits them, and from 1.0 where the damping of all families does. Without the
//! damping of shear links a body folds freely, structural links line up along its creases, and it blows up from 0.7. Hence
//! stiffness and the damping of each family have margins of their own. Without the stiffness of shear links, bending links
//! line up as well, before any is strained: then the margin of stiffness counts for all. Bodies that are torn or crumpled
//! further take a substep in parts.
//!
//! Verlet with its predicted damping velocity counts the damping twice; RK4 has a stability region of its own; the implicit
//! scheme has no limit but that of the thesis's explicit contact.

pub(in crate::physics) mod any_state;
pub(in crate::physics) mod cells;
pub(in crate::physics) mod eigenvalue;
pub(in crate::physics) mod lattice;
pub(in crate::physics) mod load;
pub(in crate::physics) mod particles;
pub(in crate::physics) mod present;
pub(in crate::physics) mod tension;

#[cfg(test)]
mod fastest_tests;

use glam::{DMat3, DVec3};

pub(in crate::physics) use load::{
    HOLDING_SHARE, LATTICE_LIMIT, LoadShare, Margin, angles_are_held, has_pushes, load_shares,
    most_stiffness_per_damping,
};
pub use load::{LinkLoad, SAFETY};

use eigenvalue::{largest_eigenvalue, shifted};
use load::{StabilityRegion, damped_limit, undamped_limit};

use super::model::{BodyModel, ContactModel, Model};
use crate::geometry::Family;
use crate::math::Real;
use crate::physics::limits::cells::CellLoads;
use crate::physics::limits::particles::Constant;
use crate::physics::model::{Composition, ContactRule, Scheme};

/// Wave numbers 0, π/8 … π along each axis: the extremes of the stencil lie on this grid.
const WAVES: usize = 9;

/// What can limit a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Term {
    /// A family's stiffness.
    Stiffness(Family),
    /// A family's damping.
    Damping(Family),
    /// The thesis's explicit contact.
    Contact,
    /// The step the person asked for.
    User,
    /// All terms together.
    Combined,
}

impl Term {
    /// Returns the term's name in figures.
    pub fn name(self) -> String {
        match self {
            Self::Stiffness(family) => format!("{}_stiffness", family.name()),
            Self::Damping(family) => format!("{}_damping", family.name()),
            Self::Contact => "contact".to_owned(),
            Self::User => "user".to_owned(),
            Self::Combined => "combined".to_owned(),
        }
    }

    /// Returns the term's words on screen.
    pub fn words(self) -> String {
        match self {
            Self::Stiffness(family) => format!("{} stiffness", family.name()),
            Self::Damping(family) => format!("{} damping", family.name()),
            Self::Contact => "contact stiffness".to_owned(),
            Self::User => "the step asked for".to_owned(),
            Self::Combined => "all springs together".to_owned(),
        }
    }
}

/// The largest stable steps of a scene: the smallest over its bodies, `None` where nothing limits. The default is that of a
/// scene without bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneLimits {
    /// The limit of each term alone, s: the same terms for every body.
    pub terms: Vec<(Term, Option<f64>)>,
    /// All terms together at rest, s.
    pub dt_limit_secs: Option<f64>,
    /// The largest step that automatic stepping takes, s.
    pub dt_safe_secs: Option<f64>,
    /// The largest rate of damping at rest, 1/s: of links with the margin that automatic stepping keeps, plus that of
    /// contact.
    pub(in crate::physics) damping_rate: f64,
    /// The part of contact alone, if it pushes at the stages of a scheme, 1/s.
    pub(in crate::physics) push_rate: f64,
}

impl SceneLimits {
    /// Returns the limits of a model that a scheme advances. Explicit Euler and RK2 have no stable step for an undamped
    /// vibration: their limits are the steps beyond which every vibration blows up at once.
    pub fn of<R: Real>(model: &Model<R>, rule: ContactRule, scheme: Scheme) -> Self {
        let waves = lattice_waves();
        let margin = |body: &BodyModel<R>| Margin::of(scheme, angles_are_held_in(body));
        let bodies = model.bodies.iter();
        let bodies = bodies.map(|body| body_limits(body, rule, StabilityRegion::of(scheme), margin(body), &waves));
        bodies.reduce(Self::tighter).unwrap_or_default()
    }

    /// Returns the smaller of each limit of two bodies.
    fn tighter(mut self, other: Self) -> Self {
        for ((_, mine), (_, theirs)) in self.terms.iter_mut().zip(other.terms) {
            *mine = smaller_limit(*mine, theirs);
        }
        Self {
            dt_limit_secs: smaller_limit(self.dt_limit_secs, other.dt_limit_secs),
            dt_safe_secs: smaller_limit(self.dt_safe_secs, other.dt_safe_secs),
            damping_rate: self.damping_rate.max(other.damping_rate),
            push_rate: self.push_rate.max(other.push_rate),
            ..self
        }
    }

    /// Returns how many equal substeps make a whole step of `dt_secs` safe.
    pub fn substeps(&self, dt_secs: f64) -> u32 {
        match self.dt_safe_secs {
            None => 1,
            // The conversion saturates, which is right: a step of more substeps than fit in a u32 never ends anyway.
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least one, saturating")]
            Some(safe) => libm::ceil(dt_secs / safe).max(1.0) as u32,
        }
    }

    /// Returns the longest step that can be divided into safe ones, s: no more of them can be counted.
    pub(in crate::physics) fn longest_step_secs(&self) -> f64 {
        self.dt_safe_secs.map_or(f64::INFINITY, |safe| safe * f64::from(u32::MAX))
    }

    /// Returns what limits a whole step of `dt_secs`: the tightest term, or the user, who asked for no more than is safe.
    pub fn limited_by(&self, dt_secs: f64) -> Term {
        if self.dt_safe_secs.is_none_or(|safe| dt_secs <= safe) {
            return Term::User;
        }
        self.terms
            .iter()
            .filter_map(|(term, dt)| dt.map(|dt| (*term, dt)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(Term::User, |(term, _)| term)
    }
}

/// Whether the links of all cells of a body hold the cells' angles. Those of a solid do.
fn angles_are_held_in<R: Real>(body: &BodyModel<R>) -> bool {
    matches!(body.composition, Composition::Solids { .. })
        || body.lattices().all(|lattice| angles_are_held(lattice.stiffness))
}

fn smaller_limit(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

/// The tensors `Σ 2 (1 − cos q·δ) d̂ d̂ᵀ / |δ|` of each family on a lattice of unit cells, for one wave vector.
pub(super) type WaveTensors = [DMat3; 3];

/// The tensors for every wave vector of the grid with `0 ≤ q_z ≤ q_y ≤ q_x ≤ π`; symmetry covers the others.
pub(super) fn lattice_waves() -> Vec<WaveTensors> {
    let step = std::f64::consts::PI / (WAVES - 1) as f64;
    let mut waves = Vec::new();
    for x in 0..WAVES {
        for y in 0..=x {
            for z in 0..=y {
                waves.push(wave_tensors(DVec3::new(x as f64, y as f64, z as f64) * step));
            }
        }
    }
    waves
}

fn wave_tensors(q: DVec3) -> WaveTensors {
    let mut tensors = [DMat3::ZERO; 3];
    for (family, offset) in half_stencil() {
        let length = offset.length();
        let direction = offset / length;
        let outer = DMat3::from_cols(direction * direction.x, direction * direction.y, direction * direction.z);
        tensors[family as usize] += outer * (2.0 * (1.0 - libm::cos(q.dot(offset))) / length);
    }
    tensors
}

/// Returns the 3 structural, 6 + 4 shear and 3 bending offsets to half of a particle's neighbours, in cells.
fn half_stencil() -> impl Iterator<Item = (Family, DVec3)> {
    let unit_box = (-1..=1).flat_map(|z| (-1..=1).flat_map(move |y| (-1..=1).map(move |x| (z, y, x))));
    let near = unit_box.filter(|&offset| offset > (0, 0, 0)).map(|(z, y, x)| {
        let axes = [x, y, z].iter().filter(|&&c| c != 0).count();
        let family = if axes == 1 { Family::Structural } else { Family::Shear };
        (family, DVec3::new(f64::from(x), f64::from(y), f64::from(z)))
    });
    near.chain(DVec3::AXES.into_iter().map(|axis| (Family::Bending, 2.0 * axis)))
}

fn body_limits<R: Real>(
    body: &BodyModel<R>,
    rule: ContactRule,
    region: StabilityRegion,
    margin: Margin,
    waves: &[WaveTensors],
) -> SceneLimits {
    let lightest = body.lightest_mass().to_f64();
    let contact = match rule {
        ContactRule::Implicit => 0.0,
        ContactRule::Thesis => body.contacts.iter().map(|c| c.stiffness.to_f64()).fold(0.0, f64::max) / lightest,
    };
    let pushes = ContactPush::of(body, rule, region);
    match &body.composition {
        Composition::Alike => (),
        Composition::Solids { kinds, load_share } => {
            let loads = CellLoads::of(kinds, body.lattice.grid.cell_size).shared(*load_share);
            let safe_damping = loads.damping / margin.damping[Family::Structural as usize];
            return limits_of_loads(&loads, safe_damping, contact, pushes, region, margin);
        }
        Composition::Springs { loads, .. } => {
            let own = loads.own();
            let safe_damping = loads.largest_load(own, Constant::Damping, margin.damping.map(|share| 1.0 / share));
            return limits_of_loads(&loads.of_springs(own), safe_damping, contact, pushes, region, margin);
        }
    }
    // With the cell size h the tensors scale by 1/h; every constant is divided by mass and cell size.
    let scale = 1.0 / (body.particle_mass.to_f64() * body.lattice.grid.cell_size);
    let mut stiffness = [0.0; 3];
    let mut damping = [0.0; 3];
    for (f, family) in body.links.iter().enumerate().filter(|(_, family)| !family.links.is_empty()) {
        stiffness[f] = family.stiffness.to_f64() * scale;
        damping[f] = family.damping.to_f64() * scale;
    }
    let only = |constants: [f64; 3], family: usize| {
        let mut alone = [0.0; 3];
        alone[family] = constants[family];
        alone
    };
    let mut terms = Vec::new();
    for (f, family) in Family::ALL.into_iter().enumerate() {
        let [stiff, damped] = [stiffness, damping].map(|constants| largest_over_waves(waves, only(constants, f)));
        terms.push((Term::Stiffness(family), region.stiffness_limit(stiff, damped)));
        terms.push((Term::Damping(family), region.damped_limit(damped)));
    }
    let contact_limit = smaller_limit(region.contact_limit(contact), pushes.limit(region));
    terms.push((Term::Contact, contact_limit));
    // A ratio of stiffness to damping that holds in every family holds for all of them together.
    let in_proportion = terms.iter().filter_map(|(term, limit)| matches!(term, Term::Stiffness(_)).then_some(*limit));
    let in_proportion = in_proportion.fold(None, smaller_limit);
    let [dt_limit_secs, dt_safe_secs] = [Margin::NONE, margin].map(|margin| {
        let damping = std::array::from_fn(|family| damping[family] / margin.damping[family]);
        match region {
            StabilityRegion::Leapfrog(share) => {
                let k = 1.0 / (margin.stiffness * margin.stiffness);
                combined_limit(waves, stiffness.map(|of| of * k), damping.map(|of| share * of), contact * k)
            }
            StabilityRegion::HalfDisc(_) => smaller_limit(
                region
                    .undamped_limit(largest_over_waves(waves, stiffness) + contact)
                    .map(|limit| limit * margin.stiffness),
                region.damped_limit(largest_over_waves(waves, damping)),
            ),
            StabilityRegion::DiscAndAxis => {
                let of_stiffness = smaller_limit(in_proportion, contact_limit);
                smaller_limit(
                    of_stiffness.map(|limit| limit * margin.stiffness),
                    region.damped_limit(largest_over_waves(waves, damping) + pushes.rate),
                )
            }
            StabilityRegion::Everywhere => region.contact_limit(contact).map(|limit| limit * margin.stiffness),
        }
    });
    let of_links = largest_over_waves(waves, std::array::from_fn(|family| damping[family] / margin.damping[family]));
    let damping_rate = of_links + pushes.rate;
    SceneLimits { terms, dt_limit_secs, dt_safe_secs, damping_rate, push_rate: pushes.rate }
}

/// The springs of contact, if they push at the stages of a scheme.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::physics) struct ContactPush {
    /// Their largest ratio of stiffness to damping, 1/s.
    pub(in crate::physics) stiffness_per_damping: f64,
    /// The largest rate at which they stop a particle, 1/s.
    pub(in crate::physics) rate: f64,
}

impl ContactPush {
    fn of<R: Real>(body: &BodyModel<R>, rule: ContactRule, region: StabilityRegion) -> Self {
        if !region.has_pushes(rule) {
            return Self::default();
        }
        let lightest = body.lightest_mass().to_f64();
        body.contacts.iter().map(|contact| Self::of_contact(contact, lightest)).fold(Self::default(), Self::max)
    }

    /// Returns the springs of contact with one obstacle; the lightest particle has this mass, kg.
    pub(in crate::physics) fn of_contact<R: Real>(contact: &ContactModel<R>, lightest: f64) -> Self {
        if contact.stiffness <= R::ZERO {
            return Self::default();
        }
        let [stiffness, damping] = [contact.stiffness, contact.damping].map(Real::to_f64);
        Self { stiffness_per_damping: stiffness / damping, rate: damping / lightest }
    }

    pub(in crate::physics) fn max(self, other: Self) -> Self {
        Self {
            stiffness_per_damping: self.stiffness_per_damping.max(other.stiffness_per_damping),
            rate: self.rate.max(other.rate),
        }
    }

    fn limit(self, region: StabilityRegion) -> Option<f64> {
        region.stiffness_limit(self.stiffness_per_damping, 1.0)
    }
}

/// Returns the limits of a body whose links add these loads, and whose damping with its margin is `safe_damping` (1/s).
fn limits_of_loads(
    loads: &CellLoads,
    safe_damping: f64,
    contact: f64,
    pushes: ContactPush,
    region: StabilityRegion,
    margin: Margin,
) -> SceneLimits {
    let mut terms = Vec::new();
    for (f, family) in Family::ALL.into_iter().enumerate() {
        let [stiff, damped] = [loads.stiffness_alone[f], loads.damping_alone[f]];
        terms.push((Term::Stiffness(family), region.stiffness_limit(stiff, damped)));
        terms.push((Term::Damping(family), region.damped_limit(damped)));
    }
    let contact_limit = smaller_limit(region.contact_limit(contact), pushes.limit(region));
    terms.push((Term::Contact, contact_limit));
    let in_proportion = region.stiffness_limit(loads.stiffness, loads.stiffness / loads.stiffness_per_damping);
    let stiffness = loads.stiffness + contact;
    let whole = (Margin::NONE, loads.damping);
    let [dt_limit_secs, dt_safe_secs] = [whole, (margin, safe_damping)].map(|(margin, damping)| match region {
        StabilityRegion::Leapfrog(share) => {
            CellLoads::dt_limit_secs(stiffness / (margin.stiffness * margin.stiffness), share * damping)
        }
        StabilityRegion::HalfDisc(_) => smaller_limit(
            region.undamped_limit(stiffness).map(|limit| limit * margin.stiffness),
            region.damped_limit(damping),
        ),
        StabilityRegion::DiscAndAxis => {
            let of_stiffness = smaller_limit(in_proportion, contact_limit);
            smaller_limit(
                of_stiffness.map(|limit| limit * margin.stiffness),
                region.damped_limit(damping + pushes.rate),
            )
        }
        StabilityRegion::Everywhere => region.contact_limit(contact).map(|limit| limit * margin.stiffness),
    });
    let damping_rate = safe_damping + pushes.rate;
    SceneLimits { terms, dt_limit_secs, dt_safe_secs, damping_rate, push_rate: pushes.rate }
}

/// Returns the largest dt with `λ_max(dt² K + 2 dt C) + dt² contact ≤ 4`, by bisection on a function that grows with dt.
fn combined_limit(waves: &[WaveTensors], stiffness: [f64; 3], damping: [f64; 3], contact: f64) -> Option<f64> {
    let load = |dt: f64| {
        let constants = std::array::from_fn(|f| dt * dt * stiffness[f] + 2.0 * dt * damping[f]);
        largest_over_waves(waves, constants) + dt * dt * contact
    };
    let undamped = undamped_limit(largest_over_waves(waves, stiffness) + contact);
    let damped = damped_limit(largest_over_waves(waves, damping));
    let mut high = smaller_limit(undamped, damped)?;
    if load(high) <= 4.0 {
        return Some(high);
    }
    // At half of both limits, stiffness and damping together add at most 1 + 2 < 4.
    let mut low = 0.5 * high;
    while high - low > 1e-9 * high {
        let middle = 0.5 * (low + high);
        if load(middle) <= 4.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(low)
}

/// Returns the largest eigenvalue over all wave vectors of the lattice with these constants by family.
pub(super) fn largest_over_waves(waves: &[WaveTensors], constants: [f64; 3]) -> f64 {
    if constants.iter().all(|&constant| constant <= 0.0) {
        return 0.0;
    }
    let mut most = 0.0_f64;
    for tensors in waves {
        let sum = tensors[0] * constants[0] + tensors[1] * constants[1] + tensors[2] * constants[2];
        let (_, mean, p) = shifted(sum);
        // No eigenvalue is above this bound, and for most waves it is far below the largest so far: their angle need not be
        // computed.
        if mean + 2.0 * p >= (1.0 - 1e-9) * most {
            most = most.max(largest_eigenvalue(sum));
        }
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_half_stencil_reaches_16_neighbours() {
        let count = |family| half_stencil().filter(|(f, _)| *f == family).count();
        assert_eq!(Family::ALL.map(count), [3, 10, 3], "3 axes, 6 face and 4 body diagonals, 3 second neighbours");
    }

    #[test]
    fn the_eigenvalue_of_a_known_matrix() {
        let rotation = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
        let a = rotation * DMat3::from_diagonal(DVec3::new(-3.0, 1.0, 7.5)) * rotation.transpose();
        assert!((largest_eigenvalue(a) - 7.5).abs() < 1e-12, "rotating a matrix keeps its eigenvalues");
        assert!((largest_eigenvalue(DMat3::IDENTITY * 2.0) - 2.0).abs() < 1e-15, "a multiple of the identity");
    }

    #[test]
    fn waves_that_are_passed_over_are_below_the_worst() {
        let waves = lattice_waves();
        let mut rng = crate::math::rng::Rng::new(7);
        for _ in 0..200 {
            let constants = [0; 3].map(|_| 10f64.powf(rng.between(-3.0, 3.0)) * f64::from(u8::from(rng.unit() < 0.8)));
            let of = |tensors: &WaveTensors| {
                largest_eigenvalue(tensors[0] * constants[0] + tensors[1] * constants[1] + tensors[2] * constants[2])
            };
            let all = waves.iter().map(of).fold(0.0, f64::max);
            assert_eq!(largest_over_waves(&waves, constants).to_bits(), all.to_bits(), "{constants:?}");
        }
    }

    #[test]
    fn structural_links_alone_give_the_chain_limit() {
        // Along an axis the lattice is a chain: w² = 4 k/(m l0), dt = 2/w.
        let waves = lattice_waves();
        let limit = undamped_limit(largest_over_waves(&waves, [9.0, 0.0, 0.0])).expect("a stiffness limits");
        // The eigenvalue formula loses half the digits where two eigenvalues meet, as they do here.
        assert!((limit - 2.0 / 6.0).abs() < 1e-8, "chain limit 1/3, got {limit}");
    }

    #[test]
    fn stiffness_and_damping_combine_as_for_one_mode() {
        // One family: dt² w² + 2 dt c = 4 with w² = 4 k', c = 4 d'.
        let waves = lattice_waves();
        let dt = combined_limit(&waves, [2.0, 0.0, 0.0], [0.5, 0.0, 0.0], 0.0).expect("limited");
        assert!((dt * dt * 8.0 + 2.0 * dt * 2.0 - 4.0).abs() < 1e-6, "the scalar condition holds with equality: {dt}");
    }

    #[test]
    fn nothing_limits_a_body_without_forces() {
        let limits = SceneLimits::default();
        assert_eq!(limits.substeps(0.1), 1, "one substep is enough");
        assert_eq!(limits.limited_by(0.1), Term::User, "only the person limits");
    }
}
