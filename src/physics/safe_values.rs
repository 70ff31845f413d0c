//! How far each value of a material may go before the step asked for is no longer safe, the others left as they are
//! (I6): what a slider marks on its track.

use super::assembly;
use super::cell_bound::CellLoads;
use super::stability::{LATTICE_LIMIT, SAFETY, WaveTensors, largest, largest_eigenvalue, lattice_waves};
use crate::geometry::Lattice;
use crate::math::Aabb;
use crate::scene::material::Solid;
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

/// The bounds of all values of a body's material for steps of `dt_secs`, of semi-implicit Euler at rest with the
/// margin that automatic stepping keeps.
pub fn largest_safe(body: &Body, lattice: &Lattice, dt_secs: f64) -> Vec<SafeValue> {
    let dt = dt_secs / SAFETY;
    match &body.material {
        Material::Springs(springs) => of_springs(springs, lattice, dt),
        Material::Solid(solid) => of_solid(solid, lattice, dt),
    }
}

fn of_springs(springs: &Springs, lattice: &Lattice, dt: f64) -> Vec<SafeValue> {
    let waves = lattice_waves();
    let scale = 1.0 / (springs.particle_mass * lattice.grid.cell_size);
    let has_links = Family::ALL.map(|family| !lattice.links[family as usize].is_empty());
    let factors = [dt * dt * scale, 2.0 * dt * scale];
    let loads: [f64; 3] = Family::ALL.map(|family| {
        let constants = springs.family(family);
        let load = factors[0] * constants.stiffness + factors[1] * constants.damping;
        if has_links[family as usize] { load } else { 0.0 }
    });
    let mut bounds = Vec::new();
    for family in Family::ALL {
        let constants = springs.family(family);
        for (name, value, factor) in
            [("stiffness", constants.stiffness, factors[0]), ("damping", constants.damping, factors[1])]
        {
            let mut rest = loads;
            rest[family as usize] -= factor * value;
            let bound = has_links[family as usize].then(|| largest_share(&waves, rest, family) / factor);
            let path = format!("material.springs.{}.{name}", family.name());
            bounds.push(SafeValue { path, bound, is_smallest: false });
        }
    }
    let mass = springs.particle_mass * largest(&waves, loads) / LATTICE_LIMIT;
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

fn of_solid(solid: &Solid, lattice: &Lattice, dt: f64) -> Vec<SafeValue> {
    let rest = (0..lattice.corners.len()).map(|particle| lattice.rest_position(particle));
    let size = Aabb::<f64>::around(rest).size().max_element();
    let kind = assembly::solid_cell(solid, lattice, size);
    let loads = CellLoads::of(&[kind], lattice.grid.cell_size);
    // Stiffness grows with E/ρ, damping with z √(E/ρ).
    let (stiff, damped) = (dt * dt * loads.stiffness, 2.0 * dt * loads.damping);
    // stiff x² + damped x = 4 for the root x of how many times E/ρ may be what it is.
    let root = 2.0 * LATTICE_LIMIT / (damped + (damped * damped + 4.0 * LATTICE_LIMIT * stiff).sqrt());
    let times = root * root;
    let damping_ratio = if solid.damping_ratio > 0.0 {
        solid.damping_ratio * ((LATTICE_LIMIT - stiff) / damped).max(0.0)
    } else {
        let unit = assembly::solid_cell(&Solid { damping_ratio: 1.0, ..*solid }, lattice, size);
        let damped = 2.0 * dt * CellLoads::of(&[unit], lattice.grid.cell_size).damping;
        ((LATTICE_LIMIT - stiff) / damped).max(0.0)
    };
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
    use crate::physics::Simulation;
    use crate::scene::resolve::resolve;
    use crate::scene::{Scene, path};

    fn scene(changes: &[(&str, &str)]) -> Scene {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        for (name, value) in changes {
            path::set(&mut scene, &format!("bodies.0.{name}"), value).expect("in range");
        }
        scene
    }

    fn lattice(scene: &Scene) -> Arc<Lattice> {
        resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice
    }

    /// The step that is safe with a value a little within its bound and a little beyond it, over the step asked for.
    fn around(scene: &Scene, safe: &SafeValue, dt: f64) -> [f64; 2] {
        let bound = safe.bound.expect("limited");
        [0.999, 1.001].map(|factor| {
            let mut changed = scene.clone();
            let value = if safe.is_smallest { bound / factor } else { bound * factor };
            path::set(&mut changed, &format!("bodies.0.{}", safe.path), &format!("{value:e}")).expect("in range");
            let simulation = Simulation::<f64>::new(&changed, &[lattice(&changed)]);
            simulation.plan().limits.dt_safe_secs().expect("limited") / dt
        })
    }

    fn check(scene: &Scene, dt: f64) {
        for safe in largest_safe(&scene.bodies[0], &lattice(scene), dt) {
            let [within, beyond] = around(scene, &safe, dt);
            assert!(within >= 1.0 && beyond <= 1.0, "{safe:?} at {dt} s: {within} within, {beyond} beyond");
        }
    }

    #[test]
    fn each_value_of_the_springs_is_just_safe_at_its_bound() {
        check(&scene(&[]), 1e-3);
        check(&scene(&[("material.springs.shear.damping", "0"), ("material.springs.particle_mass", "0.5")]), 5e-3);
    }

    #[test]
    fn each_value_of_a_solid_is_just_safe_at_its_bound() {
        check(&scene(&[("material.solid.young_modulus", "1e5")]), 5e-4);
        check(&scene(&[("material.solid.damping_ratio", "0")]), 1e-3);
    }

    #[test]
    fn what_is_unsafe_already_leaves_no_room_for_the_others() {
        let scene = scene(&[("material.springs.structural.stiffness", "1e8")]);
        let bounds = largest_safe(&scene.bodies[0], &lattice(&scene), 1e-3);
        let of = |end: &str| bounds.iter().find(|safe| safe.path.ends_with(end)).and_then(|safe| safe.bound);
        assert_eq!(of("shear.stiffness"), Some(0.0), "no shear stiffness is small enough");
        assert!(of("structural.stiffness").is_some_and(|bound| bound > 1.0), "the guilty one can be taken back");
        assert!(of("particle_mass").is_some_and(|mass| mass > 1.0), "or the particles made heavier");
    }

    #[test]
    fn a_family_without_links_has_no_bound() {
        let scene = scene(&[("shape.cube.cells", "1")]);
        let bounds = largest_safe(&scene.bodies[0], &lattice(&scene), 1e-3);
        assert!(bounds.iter().all(|safe| safe.path.contains("bending") == safe.bound.is_none()), "{bounds:?}");
    }
}
