//! The loads of a step that have to stay below their limit: the share of contact, and how much lighter a body may be.

use crate::geometry::Family;
use crate::math::Real;
use crate::physics::limits::{
    ContactPush, LATTICE_LIMIT, LoadShare, Margin, has_pushes, load_shares, most_stiffness_per_damping,
};
use crate::physics::model::{BodyModel, Scheme};
use crate::scene::Scene;
use crate::scene::material::Spring;
use crate::scene::obstacle::ContactStiffness;
use crate::scene::settings::{ContactRule, Integrator};

/// The step that bounds are for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepSettings {
    /// Its length, s.
    pub dt_secs: f64,
    /// The scheme that takes it.
    pub integrator: Integrator,
}

impl StepSettings {
    /// The step in a scene's settings.
    pub fn of(scene: &Scene) -> Self {
        Self { dt_secs: scene.settings.dt, integrator: scene.settings.integrator }
    }

    pub(super) fn scheme(self) -> Scheme {
        self.integrator.into()
    }

    /// The margin of automatic stepping for a body whose cells' angles are held, or are not.
    pub(super) fn margin(self, angles_are_held: bool) -> Margin {
        Margin::of(self.scheme(), angles_are_held)
    }

    /// The largest stiffness over damping of a link, 1/s, where the scheme limits that.
    pub(super) fn stiffness_per_damping(self) -> Option<f64> {
        // It follows from the margin of stiffness, which is the same with both.
        most_stiffness_per_damping(self.scheme(), self.dt_secs, self.margin(true))
    }
}

impl LoadShare {
    /// The load of a family's constants.
    pub(super) fn of(&self, family: Family, constants: Spring) -> f64 {
        self.stiffness * constants.stiffness + self.damping[family as usize] * constants.damping
    }
}

/// What contact takes of the limit, as links do: by the thesis's rule (GC §5.2) as a spring, by its stiffness over the mass
/// of the lightest particle, 1/s²; by the other rule where it pushes at the stages of the scheme.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactLoad {
    /// Of obstacles whose stiffness follows from the mass: the same whatever that is.
    following: ObstacleLoad,
    /// Of obstacles whose stiffness is given: it falls as the mass grows.
    given: ObstacleLoad,
}

/// The most that obstacles of one kind add.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ObstacleLoad {
    /// By the thesis's rule, 1/s².
    stiffness: f64,
    pub(super) pushes: ContactPush,
}

impl ObstacleLoad {
    fn max(self, other: Self) -> Self {
        Self { stiffness: self.stiffness.max(other.stiffness), pushes: self.pushes.max(other.pushes) }
    }
}

impl ContactLoad {
    /// The load of contact on a body of the scene that its model was compiled from.
    pub fn of<R: Real>(body: &BodyModel<R>, scene: &Scene) -> Self {
        let mut load = Self::default();
        let is_thesis = scene.settings.contact == ContactRule::Thesis;
        let has_pushes = has_pushes(StepSettings::of(scene).scheme(), scene.settings.contact.into());
        let lightest = body.lightest_mass().to_f64();
        for (obstacle, contact) in scene.obstacles.iter().zip(&body.contacts) {
            let of_kind = match obstacle.stiffness {
                ContactStiffness::Auto => &mut load.following,
                ContactStiffness::Given(_) => &mut load.given,
            };
            let stiffness = if is_thesis { contact.stiffness.to_f64() / lightest } else { 0.0 };
            let pushes = if has_pushes { ContactPush::of_contact(contact, lightest) } else { ContactPush::default() };
            *of_kind = of_kind.max(ObstacleLoad { stiffness, pushes });
        }
        load
    }

    pub(super) fn now(self) -> ObstacleLoad {
        self.following.max(self.given)
    }

    /// The least factor of the mass where stiffness over damping may be `per_damping` (1/s) at most.
    pub(super) fn min_mass_factor(self, per_damping: f64) -> f64 {
        let [following, given] = [self.following, self.given].map(|load| load.pushes.stiffness_per_damping);
        if following > per_damping { f64::INFINITY } else { (given / per_damping) * (given / per_damping) }
    }
}

/// One load that has to stay below [`LATTICE_LIMIT`]: what links and contact add to it.
pub(super) struct Load {
    pub(super) links: LoadShare,
    /// As [`LoadShare::stiffness`], of the contact's.
    contact_secs2: f64,
    contact: ContactLoad,
}

impl Load {
    fn of(&self, obstacles: ObstacleLoad) -> f64 {
        self.contact_secs2 * obstacles.stiffness + self.links.pushes * obstacles.pushes.rate
    }

    /// What is left for the links, as contact is now.
    pub(super) fn limit(&self) -> f64 {
        LATTICE_LIMIT - self.of(self.contact.now())
    }

    /// The largest factor of 1/mass. The links add `stiff` and `damped` to the load now: the former grows with 1/mass, the
    /// latter with its root.
    pub(super) fn max_inverse_mass_factor(&self, stiff: f64, damped: f64) -> f64 {
        let of_following = LATTICE_LIMIT - self.of(self.contact.following);
        let given = self.contact.given;
        let (stiff_given, damped_given) = (self.contact_secs2 * given.stiffness, self.links.pushes * given.pushes.rate);
        max_factor_within(stiff, damped, of_following).min(max_factor_within(
            stiff + stiff_given,
            damped + damped_given,
            LATTICE_LIMIT,
        ))
    }

    /// The same where `links` is what the links add for a factor of 1/mass.
    pub(super) fn max_inverse_mass_factor_by(&self, links: impl Fn(f64) -> f64) -> f64 {
        let of_following = LATTICE_LIMIT - self.of(self.contact.following);
        let given = self.contact.given;
        let (stiff_given, damped_given) = (self.contact_secs2 * given.stiffness, self.links.pushes * given.pushes.rate);
        let fits = |times: f64| {
            let links = links(times);
            links <= of_following && links + stiff_given * times + damped_given * times.sqrt() <= LATTICE_LIMIT
        };
        let [mut low, mut high] = [-MAX_LOG2_FACTOR, MAX_LOG2_FACTOR];
        if fits(libm::exp2(high)) {
            return f64::INFINITY;
        }
        if !fits(libm::exp2(low)) {
            return 0.0;
        }
        while high - low > 1e-9 {
            let middle = 0.5 * (low + high);
            if fits(libm::exp2(middle)) { low = middle } else { high = middle }
        }
        libm::exp2(low)
    }
}

/// Factors of 1/mass are searched from two to the power of minus this up to two to the power of this.
const MAX_LOG2_FACTOR: f64 = 60.0;

/// The loads of a step.
pub(super) fn loads(step: StepSettings, contact: ContactLoad, angles_are_held: bool) -> Vec<Load> {
    let margin = step.margin(angles_are_held);
    match load_shares(step.scheme(), step.dt_secs, margin) {
        Some(shares) => shares.map(|links| Load { links, contact_secs2: links.stiffness, contact }).collect(),
        None if contact.now().stiffness > 0.0 => {
            let links = LoadShare { stiffness: 0.0, damping: [0.0; 3], pushes: 0.0 };
            vec![Load { links, contact_secs2: margin.contact_secs2(step.dt_secs), contact }]
        }
        None => Vec::new(),
    }
}

/// The largest factor of E/ρ, x², with which stiff x² + damped x is within the limit: stiffness grows with E/ρ, damping with
/// z √(E/ρ).
pub(super) fn max_factor_within(stiff: f64, damped: f64, limit: f64) -> f64 {
    if limit <= 0.0 {
        return 0.0;
    }
    let root = 2.0 * limit / (damped + (damped * damped + 4.0 * limit * stiff).sqrt());
    root * root
}
