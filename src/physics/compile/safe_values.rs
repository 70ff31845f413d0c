//! How far each value of a material may go before the step asked for is no longer safe, the others left as they are
//! (I6): what a slider marks on its track.

use crate::geometry::Lattice;
use crate::math::Aabb;
use crate::physics::compile::assembly;
use crate::physics::limits::cells::CellLoads;
use crate::physics::limits::{
    LATTICE_LIMIT, LoadShare, WaveTensors, largest, largest_eigenvalue, lattice_waves, load_shares, safety,
};
use crate::scene::body::Inlay;
use crate::scene::material::Solid;
use crate::scene::settings::Integrator;
use crate::scene::{Body, Family, Material, Springs};

/// Steps of a bisection: enough for any range of values to a millionth.
const HALVINGS: usize = 60;

/// How far one value of a body's material may go.
#[derive(Clone, Debug, PartialEq)]
pub struct SafeValue {
    /// The value's path below the body: `material.springs.shear.stiffness`.
    pub path: String,
    /// The bound in the value's unit; absent where every value is safe. Zero where no value is: the others have to
    /// change first; for a smallest value infinity.
    pub bound: Option<f64>,
    /// Whether the bound is the smallest safe value (masses), not the largest.
    pub is_smallest: bool,
}

/// The bounds of all values of a body's material for steps of `dt_secs` of a scheme, at rest and with the margin that
/// automatic stepping keeps, which may be wider among obstacles.
pub fn largest_safe(
    body: &Body,
    lattice: &Lattice,
    dt_secs: f64,
    integrator: Integrator,
    among_obstacles: bool,
) -> Vec<SafeValue> {
    let shares = load_shares(integrator, dt_secs / safety(integrator, among_obstacles));
    match &body.material {
        Material::Springs(springs) => of_springs(springs, lattice, &shares),
        Material::Solid(solid) => of_solid(solid, &body.inlays, lattice, &shares),
    }
}

fn of_springs(springs: &Springs, lattice: &Lattice, shares: &[LoadShare]) -> Vec<SafeValue> {
    let waves = lattice_waves();
    let scale = 1.0 / (springs.particle_mass * lattice.grid.cell_size);
    let has_links = Family::ALL.map(|family| !lattice.links[family as usize].is_empty());
    let loads = |share: &LoadShare| {
        Family::ALL.map(|family| {
            let constants = springs.family(family);
            let load = scale * (share.stiffness * constants.stiffness + share.damping * constants.damping);
            if has_links[family as usize] { load } else { 0.0 }
        })
    };
    let mut bounds = Vec::new();
    for family in Family::ALL {
        for name in ["stiffness", "damping"] {
            let constants = springs.family(family);
            let bound = |share: &LoadShare| {
                let (value, factor) = match name {
                    "stiffness" => (constants.stiffness, share.stiffness * scale),
                    _ => (constants.damping, share.damping * scale),
                };
                let mut rest = loads(share);
                rest[family as usize] -= factor * value;
                if factor > 0.0 {
                    largest_share(&waves, rest, family) / factor
                } else if largest(&waves, rest) > LATTICE_LIMIT {
                    0.0
                } else {
                    f64::INFINITY
                }
            };
            let bound = shares.iter().map(bound).fold(f64::INFINITY, f64::min);
            let bound = (has_links[family as usize] && bound < f64::INFINITY).then_some(bound);
            let path = format!("material.springs.{}.{name}", family.name());
            bounds.push(SafeValue { path, bound, is_smallest: false });
        }
    }
    let load = shares.iter().map(|share| largest(&waves, loads(share))).fold(0.0, f64::max);
    let mass = springs.particle_mass * load / LATTICE_LIMIT;
    let path = "material.springs.particle_mass".to_owned();
    bounds.push(SafeValue { path, bound: (mass > 0.0).then_some(mass), is_smallest: true });
    bounds
}

/// How much one family may add to the loads of the others on every wave. A family that is zero for some wave is not
/// limited by it.
fn largest_share(waves: &[WaveTensors], rest: [f64; 3], family: Family) -> f64 {
    let mut share = f64::INFINITY;
    let load = |tensors: &WaveTensors, share: f64| {
        let mut constants = rest.map(|load| load.max(0.0));
        constants[family as usize] += share;
        largest_eigenvalue(tensors[0] * constants[0] + tensors[1] * constants[1] + tensors[2] * constants[2])
    };
    for tensors in waves {
        let own = largest_eigenvalue(tensors[family as usize]);
        if own <= 1e-9 {
            if load(tensors, 0.0) > LATTICE_LIMIT {
                return 0.0;
            }
            continue;
        }
        // Alone it may not add more than this.
        let high = share.min(LATTICE_LIMIT / own);
        share = if load(tensors, high) <= LATTICE_LIMIT {
            high
        } else {
            bisect(0.0, high, |share| load(tensors, share) <= LATTICE_LIMIT)
        };
    }
    share
}

/// The end of what is allowed between two values, the lower of which is taken to be.
fn bisect(mut low: f64, mut high: f64, is_allowed: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if is_allowed(middle) {
            low = middle;
        } else {
            high = middle;
        }
        if high - low <= 1e-9 * high {
            break;
        }
    }
    low
}

fn of_solid(solid: &Solid, inlays: &[Inlay], lattice: &Lattice, shares: &[LoadShare]) -> Vec<SafeValue> {
    let rest: Vec<_> = (0..lattice.corners.len()).map(|particle| lattice.rest_position(particle)).collect();
    let size = Aabb::<f64>::around(rest.iter().copied()).size().max_element();
    let loads_of = |damping_ratio: f64| {
        let kind = assembly::solid_cell(&Solid { damping_ratio, ..*solid }, lattice, size);
        CellLoads::of(&[kind], lattice.grid.cell_size)
    };
    let (loads, critical) = (loads_of(solid.damping_ratio), loads_of(1.0));
    let (mut times, mut damping_ratio) = (f64::INFINITY, f64::INFINITY);
    let (kinds, _) = assembly::solid_cells(solid, inlays, lattice, size, &rest);
    let others = CellLoads::of(&kinds[1..], lattice.grid.cell_size);
    for share in shares {
        if share.stiffness * others.stiffness + share.damping * others.damping > LATTICE_LIMIT {
            (times, damping_ratio) = (0.0, 0.0);
        }
        let (stiff, damped) = (share.stiffness * loads.stiffness, share.damping * loads.damping);
        // Stiffness grows with E/ρ, damping with z √(E/ρ): stiff x² + damped x = 4 for the root x of how many times E/ρ
        // may be what it is.
        let root = 2.0 * LATTICE_LIMIT / (damped + (damped * damped + 4.0 * LATTICE_LIMIT * stiff).sqrt());
        times = times.min(root * root);
        let room = LATTICE_LIMIT - stiff;
        if room < 0.0 {
            damping_ratio = 0.0;
        } else if share.damping > 0.0 {
            damping_ratio = damping_ratio.min(room / (share.damping * critical.damping));
        }
    }
    [
        ("young_modulus", solid.young_modulus * times, false),
        ("density", solid.density / times, true),
        ("damping_ratio", damping_ratio, false),
    ]
    .map(|(name, bound, is_smallest)| SafeValue {
        path: format!("material.solid.{name}"),
        bound: Some(bound),
        is_smallest,
    })
    .into()
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::Simulation;
    use crate::scene::resolve::resolve;
    use crate::scene::{Scene, path};

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
        largest_safe(&scene.bodies[0], &lattice(scene), scene.settings.dt, scene.settings.integrator, false)
    }

    /// The safe step over the step asked for, with a value that many times its bound on the unsafe side of it; none where
    /// that is out of the value's range.
    fn room(scene: &Scene, safe: &SafeValue, bound: f64, excess: f64) -> Option<f64> {
        let mut changed = scene.clone();
        let value = if safe.is_smallest { bound / excess } else { bound * excess };
        path::set(&mut changed, &format!("bodies.0.{}", safe.path), &format!("{value:e}")).ok()?;
        let simulation = Simulation::<f64>::new(&changed, &[lattice(&changed)]);
        simulation.plan().limits.dt_safe_secs().map(|safe| safe / scene.settings.dt)
    }

    /// Checks every bound that can be set, and returns how many there were.
    fn check(scene: &Scene) -> usize {
        let bounds = bounds(scene);
        let can_be_set = |safe: &&SafeValue| safe.bound.is_some_and(|bound| bound > 0.0 && bound.is_finite());
        let mut checked = 0;
        for safe in bounds.iter().filter(can_be_set) {
            let bound = safe.bound.unwrap_or(0.0);
            let [Some(at), Some(beyond)] = [1.0, 1.01].map(|excess| room(scene, safe, bound, excess)) else { continue };
            // Others may be far nearer to the limit than the value that is looked at.
            assert!(at >= 1.0 - 1e-6 && beyond < 1.0 && beyond < at, "{safe:?}: {at} at it, {beyond} beyond {scene:?}");
            assert!(at <= 1.0 + 1e-6, "{safe:?}: more would be safe, {at} {scene:?}");
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
        let of = |end: &str| bounds.iter().find(|safe| safe.path.ends_with(end)).and_then(|safe| safe.bound);
        assert_eq!(of("shear.stiffness"), Some(0.0), "no shear stiffness is small enough");
        assert!(of("structural.stiffness").is_some_and(|bound| bound > 1.0), "the guilty one can be taken back");
        assert!(of("particle_mass").is_some_and(|mass| mass > 1.0), "or the particles made heavier");
    }

    #[test]
    fn a_family_without_links_has_no_bound() {
        let bounds = bounds(&scene(&[("shape.cube.cells", "1".to_owned())]));
        assert!(bounds.iter().all(|safe| safe.path.contains("bending") == safe.bound.is_none()), "{bounds:?}");
    }
}
