//! The plane of a body's damping and stiffness, each per unit mass of a particle and length of a link, and where in it a
//! step is stable at rest: the same bound as [`crate::physics::limits`], solved for the stiffness.
//!
//! ```text
//! stiffness ▲  beyond the border vibrations grow
//!    (1/s²) │────────────╮
//!           │  stable    │
//!           └────────────┴─────► damping (1/s)
//! ```
//!
//! For springs the plane is that of one family, by default the one that limits the step most; the other families stay as
//! they are. For a solid all links scale together, and the axes are those of its structural ones.

use super::assembly::solid_cell;
use super::safe_values::{longest_extent, other_loads};
use super::spring_loads::SpringLoads;
use super::step_loads::StepSettings;
use crate::geometry::Family;
use crate::math::Real;
use crate::physics::limits::cells::CellLoads;
use crate::physics::limits::particles::Constant;
use crate::physics::limits::{LATTICE_LIMIT, LoadShare, Margin, load_shares, most_stiffness_per_damping};
use crate::physics::model::BodyModel;
use crate::scene::material::{Solid, Spring};
use crate::scene::{Body, Material, MaterialValue, Springs};

/// A place in the plane, or a step along its axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// 1/s.
    pub damping: f64,
    /// 1/s².
    pub stiffness: f64,
}

/// The plane of one body.
#[derive(Clone, Debug)]
pub struct StabilityPlane {
    values: Values,
    shares: Option<Vec<LoadShare>>,
    step: StepSettings,
}

/// The values along the axes.
#[derive(Clone, Debug)]
enum Values {
    /// Of one family of springs, and the family that limits the step most.
    Springs { springs: Springs, loads: SpringLoads, family: Family, limiting: Family, per_value: f64 },
    /// Of a solid: its place, the place's damping at damping ratio 1, the load per stiffness of the plane, and the loads of
    /// the other solids in it.
    Solid { solid: Solid, place: Place, critical_damping: f64, load: f64, others: CellLoads },
}

impl StabilityPlane {
    /// The plane of a body that was compiled to `model`; for springs that of `family`, where it has links.
    pub fn of<R: Real>(body: &Body, model: &BodyModel<R>, step: StepSettings, family: Option<Family>) -> Self {
        let shares: Option<Vec<_>> = load_shares(step.scheme(), step.dt_secs, Margin::NONE).map(Iterator::collect);
        let values = match &body.material {
            Material::Springs(springs) => {
                // The implicit scheme has no limit: what would limit the default one is shown.
                let of_default = || vec![LoadShare::of_default(step.dt_secs)];
                let telling = shares.clone().unwrap_or_else(of_default);
                Values::of_springs(springs, SpringLoads::of(model), &telling, family)
            }
            Material::Solid(solid) => Values::of_solid(solid, model),
        };
        Self { values, shares, step }
    }

    /// The step that the plane is for.
    pub fn step(&self) -> StepSettings {
        self.step
    }

    /// The family whose values the axes are; none of a solid.
    pub fn family(&self) -> Option<Family> {
        match &self.values {
            Values::Springs { family, .. } => Some(*family),
            Values::Solid { .. } => None,
        }
    }

    /// The family of springs that limits the step most; none of a solid.
    pub fn limiting_family(&self) -> Option<Family> {
        match &self.values {
            Values::Springs { limiting, .. } => Some(*limiting),
            Values::Solid { .. } => None,
        }
    }

    /// The family whose plane to show once the body has another material: the same one, unless only the values of another
    /// one have changed.
    pub fn family_after(&self, material: &Material) -> Option<Family> {
        let (Values::Springs { springs, family, .. }, Material::Springs(now)) = (&self.values, material) else {
            return None;
        };
        let has_changed = |family: &Family| springs.family(*family) != now.family(*family);
        let other = Family::ALL.into_iter().find(has_changed);
        Some(other.filter(|_| !has_changed(family)).unwrap_or(*family))
    }

    /// Where the body stands.
    pub fn place(&self) -> Place {
        match &self.values {
            Values::Springs { springs, family, per_value, .. } => {
                let Spring { stiffness, damping } = springs.family(*family);
                Place { damping: damping * per_value, stiffness: stiffness * per_value }
            }
            Values::Solid { place, .. } => *place,
        }
    }

    /// The material with these values; they are kept within their parameters' ranges.
    pub fn material_at(&self, at: Place) -> Material {
        match &self.values {
            Values::Springs { springs, family, per_value, .. } => {
                let stiffness = MaterialValue::Stiffness(*family).in_range(at.stiffness / per_value);
                let damping = MaterialValue::Damping(*family).in_range(at.damping / per_value);
                let mut springs = *springs;
                *springs.family_mut(*family) = Spring { stiffness, damping };
                Material::Springs(springs)
            }
            Values::Solid { solid, place, critical_damping, .. } => {
                let times = at.stiffness / place.stiffness;
                let young_modulus = MaterialValue::YoungModulus.in_range(solid.young_modulus * times);
                let ratio = at.damping / (critical_damping * (young_modulus / solid.young_modulus).sqrt());
                let damping_ratio = MaterialValue::DampingRatio.in_range(ratio);
                Material::Solid(Solid { young_modulus, damping_ratio, ..*solid })
            }
        }
    }

    /// The largest stiffness that is stable at rest with some damping, 1/s²: zero where none is, infinite where all are.
    pub fn stable_stiffness(&self, damping: f64) -> f64 {
        self.largest_stiffness(damping, self.shares.as_deref(), Margin::NONE)
    }

    /// The same with the margin that automatic stepping keeps.
    pub fn safe_stiffness(&self, damping: f64) -> f64 {
        let [free, held] = [false, true].map(|angles_are_held| {
            let margin = self.step.margin(angles_are_held);
            let shares = load_shares(self.step.scheme(), self.step.dt_secs, margin).map(Iterator::collect::<Vec<_>>);
            self.largest_stiffness(damping, shares.as_deref(), margin)
        });
        self.values.largest_held([free, held])
    }

    fn largest_stiffness(&self, damping: f64, shares: Option<&[LoadShare]>, margin: Margin) -> f64 {
        let per_damping = most_stiffness_per_damping(self.step.scheme(), self.step.dt_secs, margin);
        let of = |share: &LoadShare| self.values.largest_stiffness(damping, *share);
        let in_proportion = per_damping.map_or(f64::INFINITY, |per_damping| per_damping * damping);
        shares.into_iter().flatten().map(of).fold(in_proportion, f64::min)
    }

    /// The largest damping without stiffness and the largest stiffness without damping that are stable where nothing else
    /// limits; none where everything is stable.
    pub fn ends(&self) -> Option<Place> {
        let (load, shares) = (self.values.largest_load(), self.shares.as_deref()?);
        let of = |of: &dyn Fn(&LoadShare) -> f64| shares.iter().map(of).fold(0.0, f64::max) * load;
        let (stiffness, damping) = (of(&|share| share.stiffness), of(&|share| self.values.damping_share(share)));
        let end = LATTICE_LIMIT / damping;
        let per_damping = most_stiffness_per_damping(self.step.scheme(), self.step.dt_secs, Margin::NONE);
        let end_of_stiffness = per_damping.map_or(LATTICE_LIMIT / stiffness, |per_damping| per_damping * end);
        (end_of_stiffness.is_finite() && damping > 0.0).then_some(Place { damping: end, stiffness: end_of_stiffness })
    }

    /// The load of the whole body over its limit with the default scheme: to compare bodies, whatever the scheme in use.
    pub fn load(&self) -> f64 {
        self.values.load(LoadShare::of_default(self.step.dt_secs)) / LATTICE_LIMIT
    }
}

impl Values {
    fn of_springs(springs: &Springs, loads: SpringLoads, shares: &[LoadShare], wanted: Option<Family>) -> Self {
        let mut found = (Family::Structural, 0.0);
        for family in Family::ALL.into_iter().filter(|family| loads.has_links[*family as usize]) {
            let load = shares.iter().map(|share| loads.alone(springs, share, family)).fold(0.0, f64::max);
            if load > found.1 {
                found = (family, load);
            }
        }
        let limiting = found.0;
        let family = wanted.filter(|family| loads.has_links[*family as usize]).unwrap_or(limiting);
        let per_value = loads.per_value(springs);
        Self::Springs { springs: *springs, loads, family, limiting, per_value }
    }

    fn of_solid<R: Real>(solid: &Solid, model: &BodyModel<R>) -> Self {
        let lattice = &model.lattice;
        let (size, h) = (longest_extent(lattice), lattice.grid.cell_size);
        let kind_of = |damping_ratio: f64| solid_cell(&Solid { damping_ratio, ..*solid }, lattice, size);
        let (kind, critical) = (kind_of(solid.damping_ratio), kind_of(1.0));
        let per_value = 1.0 / (kind.mass * h);
        let place = Place { damping: kind.damping[0] * per_value, stiffness: kind.stiffness[0] * per_value };
        let load = CellLoads::of(&[kind], h).shared(model.composition.load_share()).stiffness / place.stiffness;
        let critical_damping = critical.damping[0] * per_value;
        Self::Solid { solid: *solid, place, critical_damping, load, others: other_loads(model) }
    }

    fn largest_stiffness(&self, damping: f64, share: LoadShare) -> f64 {
        match self {
            Self::Springs { springs, loads, family, per_value, .. } => {
                let mut there = *springs;
                there.family_mut(*family).damping = damping / per_value;
                per_value * loads.largest(&there, (*family, Constant::Stiffness), &share, LATTICE_LIMIT)
            }
            Self::Solid { load, others, .. } => {
                let of_damping = self.damping_share(&share);
                let room = LATTICE_LIMIT - of_damping * load * damping;
                if room < 0.0 || share.stiffness * others.stiffness + of_damping * others.damping > LATTICE_LIMIT {
                    0.0
                } else if share.stiffness > 0.0 {
                    room / (share.stiffness * load)
                } else {
                    f64::INFINITY
                }
            }
        }
    }

    /// The largest safe stiffness, from the bounds for cells whose angles are free and for cells whose angles are held.
    fn largest_held(&self, bounds: [f64; 2]) -> f64 {
        match self {
            Self::Springs { springs, loads, family, per_value, .. } => {
                per_value * loads.largest_held(springs, *family, bounds.map(|bound| bound / per_value))
            }
            Self::Solid { .. } => bounds[1],
        }
    }

    /// The load per damping of the plane, s.
    fn damping_share(&self, share: &LoadShare) -> f64 {
        match self {
            Self::Springs { family, .. } => share.damping[*family as usize],
            Self::Solid { .. } => share.damping_of_cells(),
        }
    }

    fn load(&self, share: LoadShare) -> f64 {
        match self {
            Self::Springs { springs, loads, .. } => loads.all(springs, &share),
            Self::Solid { place, load, others, .. } => {
                let of_damping = self.damping_share(&share);
                let own = load * (share.stiffness * place.stiffness + of_damping * place.damping);
                own.max(share.stiffness * others.stiffness + of_damping * others.damping)
            }
        }
    }

    /// The largest eigenvalue of the axes' links alone, for unit constants per unit mass.
    fn largest_load(&self) -> f64 {
        match self {
            Self::Springs { springs, loads, family, .. } => loads.load_per_unit(springs, *family),
            Self::Solid { load, .. } => *load,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use super::*;
    use crate::geometry::Lattice;
    use crate::math::rng::Rng;
    use crate::physics::Simulation;
    use crate::scene::Scene;
    use crate::scene::body::Inlay;
    use crate::scene::resolve::resolve;
    use crate::scene::settings::{Integrator, Stepping};

    fn lattice(body: &Body) -> Arc<Lattice> {
        resolve(&body.shape, Path::new("."), &()).expect("a cube").lattice
    }

    fn plane(body: &Body, dt_secs: f64, integrator: Integrator) -> StabilityPlane {
        let scene = Scene { bodies: vec![body.clone()], ..Scene::default() };
        let simulation = Simulation::<f32>::new(&scene, &[lattice(body)]);
        let step = StepSettings { dt_secs, integrator };
        StabilityPlane::of(body, &simulation.model().bodies[0], step, None)
    }

    /// The largest stable and the largest safe step of a body, s.
    fn limits(body: &Body, integrator: Integrator) -> [f64; 2] {
        let mut scene = Scene { bodies: vec![body.clone()], ..Scene::default() };
        (scene.settings.integrator, scene.settings.stepping) = (integrator, Stepping::Manual);
        let limits = Simulation::<f64>::new(&scene, &[lattice(body)]).plan().limits.clone();
        [limits.dt_limit_secs, limits.dt_safe_secs].map(|limit| limit.expect("springs limit the step"))
    }

    fn bodies() -> [Body; 3] {
        let solid = Material::Solid(Solid::default());
        let mut springs = Springs::default();
        (springs.shear.damping, springs.particle_mass) = (0.1, 0.012);
        let inlay = Inlay { min: [-9.0; 3], max: [0.0, 9.0, 9.0], springs, ..Inlay::default() };
        let mixed = Body { inlays: vec![inlay], ..Body::default() };
        [Body::default(), Body { material: solid, ..Body::default() }, mixed]
    }

    #[test]
    fn a_body_on_the_border_has_just_that_step_as_its_limit() {
        let mut rng = Rng::new(5);
        let dt_secs = 1e-3;
        for body in bodies() {
            for integrator in [Integrator::SemiImplicit, Integrator::Verlet, Integrator::Rk4] {
                let plane = plane(&body, dt_secs, integrator);
                let ends = plane.ends().expect("a border");
                for _ in 0..5 {
                    let damping = ends.damping * rng.between(0.01, 0.4);
                    for (stiffness, which) in [(plane.stable_stiffness(damping), 0), (plane.safe_stiffness(damping), 1)]
                    {
                        if stiffness == 0.0 {
                            continue;
                        }
                        assert!(stiffness < 1.001 * ends.stiffness, "{stiffness} of {ends:?}");
                        let there = Body { material: plane.material_at(Place { damping, stiffness }), ..body.clone() };
                        let limit = limits(&there, integrator)[which];
                        assert!((limit / dt_secs - 1.0).abs() < 1e-3, "{integrator:?} {which}: {limit} s, {there:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_body_is_where_its_values_are_and_goes_where_it_is_put() {
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
        for body in bodies() {
            let plane_now = plane(&body, 1e-3, Integrator::SemiImplicit);
            let at = plane_now.place();
            assert_eq!(plane_now.family(), matches!(body.material, Material::Springs(_)).then_some(Family::Shear));
            let wanted = Place { damping: 1.5 * at.damping, stiffness: 3.0 * at.stiffness };
            let moved = Body { material: plane_now.material_at(wanted), ..body.clone() };
            let found = plane(&moved, 1e-3, Integrator::SemiImplicit).place();
            assert!(near(found.damping, wanted.damping) && near(found.stiffness, wanted.stiffness), "{found:?}");
        }
    }

    #[test]
    fn a_solid_without_damping_can_be_given_some() {
        let body =
            Body { material: Material::Solid(Solid { damping_ratio: 0.0, ..Solid::default() }), ..Body::default() };
        let plane = plane(&body, 1e-3, Integrator::SemiImplicit);
        assert!(plane.place().damping == 0.0, "none yet: {:?}", plane.place());
        let Material::Solid(solid) = plane.material_at(Place { damping: 1.0, ..plane.place() }) else {
            panic!("still a solid")
        };
        assert!(solid.damping_ratio > 0.0 && solid.damping_ratio.is_finite(), "{solid:?}");
    }

    #[test]
    fn the_implicit_scheme_has_no_border_and_the_stiffest_body_the_largest_load() {
        let [soft, ..] = bodies();
        let everywhere = plane(&soft, 1e-3, Integrator::Implicit);
        assert!(everywhere.ends().is_none() && everywhere.stable_stiffness(1.0) == f64::INFINITY, "no border");
        let stiff = Body { material: everywhere.material_at(Place { damping: 0.0, stiffness: 1e9 }), ..soft.clone() };
        let loads = [&soft, &stiff].map(|body| plane(body, 1e-3, Integrator::SemiImplicit).load());
        assert!(loads[0] < 1.0 && loads[1] > 1.0, "{loads:?}");
    }

    #[test]
    fn the_family_stays_until_a_person_turns_to_another() {
        let body = Body::default();
        let Material::Springs(springs) = body.material else { panic!("springs") };
        let plane = plane(&body, 1e-3, Integrator::SemiImplicit);
        assert_eq!((plane.family(), plane.limiting_family()), (Some(Family::Shear), Some(Family::Shear)));
        let after = |change: &dyn Fn(&mut Springs)| {
            let mut springs = springs;
            change(&mut springs);
            plane.family_after(&Material::Springs(springs))
        };
        assert_eq!(after(&|springs| springs.shear.damping = 1e-3), Some(Family::Shear), "its own slider");
        assert_eq!(after(&|springs| springs.particle_mass *= 2.0), Some(Family::Shear), "no family's");
        assert_eq!(after(&|springs| springs.bending.stiffness = 1.0), Some(Family::Bending), "another one's");
        assert_eq!(plane.family_after(&Material::Solid(Solid::default())), None, "a solid has none");
    }

    #[test]
    fn others_that_are_unstable_leave_no_stable_place() {
        let mut springs = Springs::default();
        springs.structural.stiffness = 1e8;
        springs.shear.stiffness = 1e9;
        let body = Body { material: Material::Springs(springs), ..Body::default() };
        assert!(plane(&body, 1e-3, Integrator::SemiImplicit).stable_stiffness(0.0) == 0.0, "structural is too stiff");
    }
}
