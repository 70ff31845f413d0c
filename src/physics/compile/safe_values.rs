//! How far each value of a material may go before the step asked for is no longer safe, the others left as they
//! are: what a slider marks on its track.

use crate::geometry::{Family, Lattice};
use crate::math::{Aabb, Real};
use crate::physics::compile::assembly;
use crate::physics::compile::spring_loads::SpringLoads;
use crate::physics::compile::step_loads::{ContactLoad, Load, StepSettings, loads, max_factor_within};
use crate::physics::limits::cells::CellLoads;
use crate::physics::limits::particles::Constant;
use crate::physics::model::BodyModel;
use crate::scene::material::Solid;
use crate::scene::{Body, Material, MaterialValue, Springs};

/// Which of a body's materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaterialOf {
    /// Its own.
    Body,
    /// That of a part, by its place.
    Part(usize),
    /// That of an inlay, by its place.
    Inlay(usize),
}

/// How far one value of a material of a body may go.
#[derive(Clone, Debug, PartialEq)]
pub struct SafeValue {
    /// The material.
    pub of: MaterialOf,
    /// The value.
    pub value: MaterialValue,
    /// The bound in the value's unit; absent where every value is safe. Zero where no value is: the others have to
    /// change first; for a smallest value infinity.
    pub bound: Option<f64>,
    /// Whether the bound is the smallest safe value (masses), not the largest.
    pub is_smallest: bool,
}

impl SafeValue {
    /// The path of the value below a body.
    pub fn path(&self) -> String {
        match self.of {
            MaterialOf::Body => self.value.path().to_owned(),
            MaterialOf::Part(place) => format!("parts.{place}.{}", self.below_material()),
            MaterialOf::Inlay(place) => format!("inlays.{place}.{}", self.below_material()),
        }
    }

    /// Whether this is the path of the value.
    pub fn is_at(&self, path: &str) -> bool {
        path.ends_with(self.below_material()) && self.path() == path
    }

    fn below_material(&self) -> &'static str {
        let path = self.value.path();
        path.strip_prefix("material.").unwrap_or(path)
    }
}

/// The bounds of all values of a body's materials, at rest and with the margin that automatic stepping keeps; for springs
/// also those of parts and inlays that have cells. Where a body contains other solids, contact is taken to change with the
/// body's density as if all of it were of its own solid. `model` is the compiled body.
pub fn largest_safe<R: Real>(
    body: &Body,
    model: &BodyModel<R>,
    step: StepSettings,
    contact: ContactLoad,
) -> Vec<SafeValue> {
    let [free, held] = [false, true].map(|angles_are_held| loads(step, contact, angles_are_held));
    let per_damping = step.stiffness_per_damping().unwrap_or(f64::INFINITY);
    match &body.material {
        Material::Springs(springs) => {
            let parts = body.parts.iter().enumerate().map(|(place, part)| (MaterialOf::Part(place), &part.springs));
            let inlays =
                body.inlays.iter().enumerate().map(|(place, inlay)| (MaterialOf::Inlay(place), &inlay.springs));
            let all = [(MaterialOf::Body, springs)].into_iter().chain(parts).chain(inlays).enumerate();
            let bounds = all.filter_map(|(number, (of, springs))| {
                let of_number = SpringLoads::of_number(model, number)?;
                Some(of_springs((of, springs), &of_number, [&free, &held], per_damping, contact))
            });
            bounds.flatten().collect()
        }
        Material::Solid(solid) => of_solid(solid, model, &held, per_damping, contact),
    }
}

fn of_springs(
    (of, springs): (MaterialOf, &Springs),
    loads: &SpringLoads,
    by_angles: [&[Load]; 2],
    per_damping: f64,
    contact: ContactLoad,
) -> Vec<SafeValue> {
    let now = by_angles[usize::from(loads.angles_are_held(springs))];
    let has_links = loads.has_links;
    // Where the scheme limits stiffness over damping: whether a family, other springs or contact exceed that limit.
    let has_more = |family: Family, damping: f64| {
        has_links[family as usize] && springs.family(family).stiffness > per_damping * damping
    };
    let family_has_more = |family: Family| has_more(family, springs.family(family).damping);
    let contact_has_more = contact.now().pushes.stiffness_per_damping > per_damping;
    let within_has_more = loads.others_per_damping() > per_damping;
    let mut bounds = Vec::new();
    for family in Family::ALL {
        let others_have_more = contact_has_more
            || within_has_more
            || Family::ALL.into_iter().any(|other| other != family && family_has_more(other));
        let stiffness = (MaterialValue::Stiffness(family), Constant::Stiffness);
        let damping = (MaterialValue::Damping(family), Constant::Damping);
        for (value, constant) in [stiffness, damping] {
            let of_load = |load: &Load| loads.largest(springs, (family, constant), &load.links, load.limit());
            let bound_by = |all: &[Load]| all.iter().map(of_load).fold(f64::INFINITY, f64::min);
            let is_damping = constant == Constant::Damping;
            let own = if is_damping || per_damping.is_infinite() {
                f64::INFINITY
            } else {
                per_damping * springs.family(family).damping
            };
            let of_links =
                if is_damping { bound_by(now) } else { loads.largest_held(springs, family, by_angles.map(bound_by)) };
            let bound = own.min(of_links);
            let none_is_safe = others_have_more || is_damping && has_more(family, bound);
            let bound = if none_is_safe { 0.0 } else { bound };
            let bound = (has_links[family as usize] && bound < f64::INFINITY).then_some(bound);
            bounds.push(SafeValue { of, value, bound, is_smallest: false });
        }
    }
    let least = |load: &Load| {
        1.0 / match loads.by_lightness(springs, &load.links) {
            None => load.max_inverse_mass_factor(loads.all(springs, &load.links), 0.0),
            Some(links) => load.max_inverse_mass_factor_by(links),
        }
    };
    let by_contact = contact.min_mass_factor(per_damping);
    let any_has_more = within_has_more || Family::ALL.into_iter().any(family_has_more);
    let own = if any_has_more { f64::INFINITY } else { by_contact };
    let mass = springs.particle_mass * now.iter().map(least).fold(own, f64::max);
    let bound = (mass > 0.0).then_some(mass);
    bounds.push(SafeValue { of, value: MaterialValue::ParticleMass, bound, is_smallest: true });
    bounds
}

fn of_solid<R: Real>(
    solid: &Solid,
    model: &BodyModel<R>,
    all: &[Load],
    per_damping: f64,
    contact: ContactLoad,
) -> Vec<SafeValue> {
    let lattice = &model.lattice;
    let size = longest_extent(lattice);
    let loads_of = |damping_ratio: f64| {
        let kind = assembly::solid_cell(&Solid { damping_ratio, ..*solid }, lattice, size);
        CellLoads::of(&[kind], lattice.grid.cell_size).shared(model.composition.load_share())
    };
    let (loads, critical) = (loads_of(solid.damping_ratio), loads_of(1.0));
    let [mut times, mut times_lighter, mut damping_ratio] = [f64::INFINITY; 3];
    let others = other_loads(model);
    // Stiffness over damping grows with the root of E/ρ.
    let room = per_damping / loads.stiffness_per_damping;
    (times, times_lighter) = (times.min(room * room), times_lighter.min(room * room));
    if others.stiffness_per_damping > per_damping {
        (times, times_lighter, damping_ratio) = (0.0, 0.0, 0.0);
    }
    times_lighter = times_lighter.min(1.0 / contact.min_mass_factor(per_damping));
    if contact.now().pushes.stiffness_per_damping > per_damping {
        (times, damping_ratio) = (0.0, 0.0);
    }
    for load in all {
        let (share, limit) = (&load.links, load.limit());
        let of_damping = share.damping_of_cells();
        if share.stiffness * others.stiffness + of_damping * others.damping > limit {
            (times, times_lighter, damping_ratio) = (0.0, 0.0, 0.0);
        }
        let (stiff, damped) = (share.stiffness * loads.stiffness, of_damping * loads.damping);
        // The factors by which E, and by which 1/ρ, may grow.
        times = times.min(max_factor_within(stiff, damped, limit));
        times_lighter = times_lighter.min(load.max_inverse_mass_factor(stiff, damped));
        let room = limit - stiff;
        if room < 0.0 {
            damping_ratio = 0.0;
        } else if of_damping > 0.0 {
            damping_ratio = damping_ratio.min(room / (of_damping * critical.damping));
        }
    }
    // Stiffness over damping falls as the damping ratio grows.
    if critical.stiffness_per_damping > per_damping * damping_ratio {
        damping_ratio = 0.0;
    }
    [
        (MaterialValue::YoungModulus, solid.young_modulus * times, false),
        (MaterialValue::Density, solid.density / times_lighter, true),
        (MaterialValue::DampingRatio, damping_ratio, false),
    ]
    .map(|(value, bound, is_smallest)| SafeValue { of: MaterialOf::Body, value, bound: Some(bound), is_smallest })
    .into()
}

/// The longest extent of a body at rest, m.
pub(super) fn longest_extent(lattice: &Lattice) -> f64 {
    let rest = (0..lattice.corners.len()).map(|particle| lattice.rest_position(particle));
    Aabb::<f64>::around(rest).size().max_element()
}

/// The loads of the cells of a solid that are of other solids.
pub(super) fn other_loads<R: Real>(model: &BodyModel<R>) -> CellLoads {
    CellLoads::of(model.composition.kinds().get(1..).unwrap_or_default(), model.lattice.grid.cell_size)
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::Simulation;
    use crate::scene::body::Inlay;
    use crate::scene::obstacle::ContactStiffness;
    use crate::scene::resolve::resolve;
    use crate::scene::settings::{ContactRule, Integrator};
    use crate::scene::{Obstacle, Scene, param, path};

    fn scene(changes: &[(&str, String)]) -> Scene {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        for (name, value) in changes {
            path::set(&mut scene, &format!("bodies.0.{name}"), value).expect("in range");
        }
        scene
    }

    fn lattice(scene: &Scene) -> Arc<Lattice> {
        resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice
    }

    fn bounds(scene: &Scene) -> Vec<SafeValue> {
        let lattice = lattice(scene);
        let simulation = Simulation::<f64>::new(scene, std::slice::from_ref(&lattice));
        let body = &simulation.model().bodies[0];
        largest_safe(&scene.bodies[0], body, StepSettings::of(scene), ContactLoad::of(body, scene))
    }

    /// The safe step over the settings' step, with a value beyond its bound by the factor `excess`; none where that is out
    /// of the value's range.
    fn room(scene: &Scene, safe: &SafeValue, bound: f64, excess: f64) -> Option<f64> {
        let mut changed = scene.clone();
        let value = if safe.is_smallest { bound / excess } else { bound * excess };
        path::set(&mut changed, &format!("bodies.0.{}", safe.path()), &format!("{value:e}")).ok()?;
        let simulation = Simulation::<f64>::new(&changed, &[lattice(&changed)]);
        simulation.plan().limits.dt_safe_secs.map(|safe| safe / scene.settings.dt)
    }

    /// Checks every bound that can be set, and returns how many there were.
    fn check(scene: &Scene) -> usize {
        let bounds = bounds(scene);
        let can_be_set = |safe: &&SafeValue| safe.bound.is_some_and(|bound| bound > 0.0 && bound.is_finite());
        let mut checked = 0;
        for safe in bounds.iter().filter(can_be_set) {
            let bound = safe.bound.unwrap_or(0.0);
            let [Some(at), Some(just_beyond), Some(beyond)] =
                [1.0, 1.000_01, 1.01].map(|excess| room(scene, safe, bound, excess))
            else {
                continue;
            };
            // Others may be far nearer to the limit than the value that is looked at.
            assert!(at >= 1.0 - 1e-6 && beyond < 1.0 && beyond < at, "{safe:?}: {at} at it, {beyond} beyond {scene:?}");
            // Where the angles of cells are not held beyond it, the safe step leaps there.
            assert!(just_beyond <= 1.0 + 1e-6, "{safe:?}: more would be safe, {just_beyond} {scene:?}");
            checked += 1;
        }
        checked
    }

    fn random(rng: &mut Rng, is_solid: bool) -> Scene {
        let mut decade = |low: f64, high: f64| format!("{:e}", 10f64.powf(rng.between(low, high)));
        let mut changes: Vec<(String, String)> =
            vec![("shape.cube.cells".into(), "3".into()), ("shape.cube.size".into(), decade(-1.0, 1.0))];
        if is_solid {
            for (name, low, high) in [("young_modulus", 2.0, 6.0), ("density", 1.0, 4.0), ("damping_ratio", -3.0, 0.0)]
            {
                changes.push((format!("material.solid.{name}"), decade(low, high)));
            }
        } else {
            for family in Family::ALL {
                for (name, low, high) in [("stiffness", 0.0, 4.0), ("damping", -3.0, 1.0)] {
                    changes.push((format!("material.springs.{}.{name}", family.name()), decade(low, high)));
                }
            }
            changes.push(("material.springs.particle_mass".into(), decade(-2.0, 1.0)));
        }
        let changes: Vec<_> = changes.iter().map(|(name, value)| (name.as_str(), value.clone())).collect();
        let mut scene = scene(&changes);
        scene.settings.dt = 10f64.powf(rng.between(-4.0, -2.0));
        scene.settings.integrator =
            [Integrator::SemiImplicit, Integrator::Verlet, Integrator::Rk4][(rng.next_u64() % 3) as usize];
        scene
    }

    #[test]
    fn a_value_at_its_bound_is_just_safe_whatever_the_others_are() {
        let mut rng = Rng::new(17);
        for is_solid in [false, true] {
            let checked: usize = (0..60).map(|_| check(&random(&mut rng, is_solid))).sum();
            assert!(checked > 60, "bounds that can be set: {checked}");
        }
    }

    #[test]
    fn a_value_of_springs_among_others_is_just_safe_at_its_bound() {
        let mut rng = Rng::new(23);
        let mixed = |_| {
            let mut scene = random(&mut rng, false);
            let Material::Springs(mut springs) = scene.bodies[0].material else { panic!("of springs") };
            let mut times = || 10f64.powf(rng.between(-1.0, 0.3));
            for family in Family::ALL {
                let spring = springs.family_mut(family);
                (spring.stiffness, spring.damping) = (spring.stiffness * times(), spring.damping * times());
            }
            springs.particle_mass *= 2.0 * times();
            scene.bodies[0].inlays =
                vec![Inlay { min: [-99.0; 3], max: [0.0, 99.0, 99.0], springs, ..Inlay::default() }];
            check(&scene)
        };
        let checked: usize = (0..60).map(mixed).sum();
        assert!(checked > 120, "bounds that can be set, of the body's own and of the inlay's: {checked}");
    }

    #[test]
    fn bounds_of_parts_and_inlays_stand_at_their_paths_and_none_where_no_cell_is_of_them() {
        let mut scene = scene(&[]);
        let springs = Springs { particle_mass: 0.02, ..Springs::default() };
        let nowhere = Inlay { min: [9.0; 3], max: [9.0; 3], springs, ..Inlay::default() };
        scene.bodies[0].inlays = vec![nowhere, Inlay { min: [-9.0; 3], max: [0.0; 3], springs, ..Inlay::default() }];
        let bounds = bounds(&scene);
        assert_eq!(bounds.len(), 14, "seven of the body's own, seven of the second inlay");
        for path in ["material.springs.shear.damping", "inlays.1.springs.shear.damping"] {
            assert_eq!(bounds.iter().filter(|safe| safe.is_at(path)).count(), 1, "{path}");
        }
        assert!(!bounds.iter().any(|safe| safe.is_at("inlays.0.springs.shear.damping")));
        scene.bodies[0].inlays.truncate(1);
        assert_eq!(
            self::bounds(&scene).len(),
            7,
            "of an inlay without cells there are none, though its springs are others"
        );
        for safe in bounds {
            assert!(param::find(&format!("bodies.0.{}", safe.path())).is_some(), "{}", safe.path());
        }
    }

    /// Checks bounds of random bodies among obstacles of both kinds of stiffness, in scenes that are changed like this.
    fn check_among_obstacles(rng: &mut Rng, change: impl Fn(&mut Scene, &mut Rng, bool)) {
        for (is_solid, is_given) in [(false, false), (false, true), (true, false), (true, true)] {
            let mut checked = 0;
            for _ in 0..40 {
                let mut scene = random(rng, is_solid);
                change(&mut scene, rng, is_solid);
                let given = ContactStiffness::Given(10f64.powf(rng.between(2.0, 6.0)));
                let stiffness = if is_given { given } else { ContactStiffness::Auto };
                scene.obstacles = vec![Obstacle { stiffness, ..Obstacle::default() }];
                checked += check(&scene);
            }
            assert!(checked > 20, "bounds that can be set: {checked}, solid {is_solid}, given {is_given}");
        }
    }

    #[test]
    fn the_contact_of_the_thesis_takes_its_share() {
        check_among_obstacles(&mut Rng::new(29), |scene, _, is_solid| {
            scene.settings.contact = ContactRule::Thesis;
            // At rest contact takes about a third of the limit: a solid's lightest particle is an eighth of a cell.
            scene.settings.dt = if is_solid { 7e-4 } else { 2e-3 };
        });
    }

    #[test]
    fn contact_that_pushes_at_the_stages_takes_its_share() {
        check_among_obstacles(&mut Rng::new(31), |scene, rng, _| {
            scene.settings.integrator = Integrator::Stabilised;
            scene.settings.dt = 10f64.powf(rng.between(-4.0, -1.5));
        });
    }

    #[test]
    fn the_implicit_scheme_has_a_bound_on_the_mass_by_the_contact_of_the_thesis_alone() {
        let mut scene = scene(&[]);
        scene.settings.integrator = Integrator::Implicit;
        assert!(bounds(&scene).iter().all(|safe| safe.bound.is_none()), "none without contact");
        scene.settings.contact = ContactRule::Thesis;
        scene.obstacles = vec![Obstacle { stiffness: ContactStiffness::Given(1e3), ..Obstacle::default() }];
        assert_eq!(check(&scene), 1, "the mass");
    }

    #[test]
    fn a_solid_without_damping_has_a_bound_on_it() {
        let mut scene = scene(&[("material.solid.damping_ratio", "0".to_owned())]);
        scene.settings.dt = 5e-4;
        assert_eq!(check(&scene), 3, "modulus, density and damping");
    }

    #[test]
    fn what_is_unsafe_already_leaves_no_room_for_the_others() {
        let mut scene = scene(&[("material.springs.structural.stiffness", "1e8".to_owned())]);
        scene.settings.dt = 3e-4;
        let bounds = bounds(&scene);
        let of = |end: &str| bounds.iter().find(|safe| safe.value.path().ends_with(end)).and_then(|safe| safe.bound);
        assert_eq!(of("shear.stiffness"), Some(0.0), "no shear stiffness is small enough");
        assert!(of("structural.stiffness").is_some_and(|bound| bound > 1.0), "the guilty one can be taken back");
        assert!(of("particle_mass").is_some_and(|mass| mass > 1.0), "or the particles made heavier");
    }

    #[test]
    fn a_family_without_links_has_no_bound() {
        let bounds = bounds(&scene(&[("shape.cube.cells", "1".to_owned())]));
        assert!(bounds.iter().all(|safe| safe.value.path().contains("bending") == safe.bound.is_none()), "{bounds:?}");
    }
}
