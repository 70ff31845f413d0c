//! Measures what each feature of a scene costs: runs with and without the feature, in turn, from the same state. Times are
//! processor times, so whatever the processor does for other programs between two substeps does not count.

use std::hint::black_box;
use std::sync::Arc;

use cpu_time::ThreadTime;
use serde::Serialize;

use super::noise::{Change, median};
use crate::geometry::Lattice;
use crate::physics::Arrival;
use crate::physics::{Plan, Quantity, Simulation};
use crate::scene::{Family, Material, Scene, Springs};

/// How often every variant is measured; and how often where a substep takes long.
const ROUND_COUNTS: [usize; 2] = [15, 7];

/// A simulation whose substep takes longer than this is measured less often, s.
const LONG_SUBSTEP_SECS: f64 = 0.02;

/// About the time of the substeps that are measured in one go, s: short, so that little else comes between.
const SLICE_SECS: f64 = 2e-3;

/// The cost of a feature: times with and without it, from the same state in the same run, in turn.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names are the keys of the command line's JSON")]
pub struct Ablation {
    pub feature: String,
    /// What one time covers: a substep or a picture.
    pub per: &'static str,
    /// Medians.
    pub secs_on: f64,
    pub secs_off: f64,
    /// The share by which the feature changes the time.
    pub change: Change,
    /// Whether the change may be noise of the machine.
    pub within_noise: bool,
    /// Whether the motion is the same to the bit.
    pub same_bits: bool,
    /// Whether it must be the same, because the feature only saves time or had nothing to do.
    pub must_be_same: bool,
}

impl Ablation {
    /// Whether the motion differs although it must be the same: a defect.
    pub fn is_defect(&self) -> bool {
        self.must_be_same && !self.same_bits
    }
}

/// A simulation with or without a feature; all variants are compared with one common simulation.
struct Variant {
    feature: String,
    /// Whether this variant has the feature and the common simulation has not; otherwise it is the other way round.
    has_feature: bool,
    simulation: Simulation<f32>,
    must_be_same: bool,
}

/// Measures the features of a scene in the simulation's present state. Every body is awake, except in the row about
/// sleeping.
pub(super) fn ablation(simulation: &Simulation<f32>, scene: &Scene, lattices: &[Arc<Lattice>]) -> Vec<Ablation> {
    let mut awake = simulation.clone();
    awake.plan_mut().sleeping = false;
    awake.wake_all();
    let plan = awake.plan();
    let mut variants = Vec::new();
    let mut compare = |feature: &str, must_be_same, simulation| {
        variants.push(Variant { feature: feature.to_owned(), has_feature: false, simulation, must_be_same });
    };
    let planned = |change: fn(&mut Plan)| {
        let mut changed = awake.clone();
        change(changed.plan_mut());
        changed
    };
    let compiled = |change: fn(&mut Scene)| {
        let mut scene = scene.clone();
        scene.settings.sleeping = false;
        change(&mut scene);
        let kept: Vec<_> = (0..scene.obstacles.len()).map(Some).collect();
        let mut changed = awake.clone();
        changed.set_parameters(&scene, lattices, &kept, Arrival::Placed);
        changed
    };
    let without_links: [fn(&mut Plan); 3] =
        [|plan| plan.families[0] = false, |plan| plan.families[1] = false, |plan| plan.families[2] = false];
    for (family, off) in
        Family::ALL.into_iter().zip(without_links).filter(|(family, _)| plan.families[*family as usize])
    {
        compare(&format!("{} links", family.name()), false, planned(off));
    }
    if plan.damped.contains(&true) {
        compare("damping", false, compiled(without_damping));
    }
    if plan.recovery {
        compare("recovery from inversion", true, planned(|plan| plan.recovery = false));
    }
    if plan.contact {
        compare("broad phase", true, planned(|plan| plan.broad_phase = false));
        compare("contact", false, planned(|plan| plan.contact = false));
    }
    if plan.friction || (plan.between_bodies.is_some() && scene.bodies.len() > 1) {
        compare("friction", false, compiled(without_friction));
    }
    if scene.settings.body_contact {
        if scene.bodies.iter().filter(|body| body.collides).count() > 1 {
            compare("contact between bodies", false, compiled(without_contact_between_bodies));
        }
        if scene.bodies.iter().any(|body| body.self_collides) {
            compare("contact within bodies", false, compiled(without_contact_within_bodies));
        }
    }
    compare("nothing (control)", true, awake.clone());
    compare("leaving out what is not needed", true, planned(Plan::work_out_everything));
    if simulation.plan().sleeping {
        variants.push(Variant {
            feature: "sleeping".to_owned(),
            has_feature: true,
            simulation: simulation.clone(),
            must_be_same: !simulation.is_asleep(),
        });
    }
    let mut rows = measure_variants(&awake, variants);
    rows.push(colours(&awake));
    rows
}

fn without_damping(scene: &mut Scene) {
    for body in &mut scene.bodies {
        match &mut body.material {
            Material::Springs(springs) => undamp(springs),
            Material::Solid(solid) => solid.damping_ratio = 0.0,
        }
        for inlay in &mut body.inlays {
            undamp(&mut inlay.springs);
            inlay.solid.damping_ratio = 0.0;
        }
        for part in &mut body.parts {
            undamp(&mut part.springs);
            part.solid.damping_ratio = 0.0;
        }
    }
}

fn undamp(springs: &mut Springs) {
    for family in [&mut springs.structural, &mut springs.shear, &mut springs.bending] {
        family.damping = 0.0;
    }
}

fn without_friction(scene: &mut Scene) {
    for obstacle in &mut scene.obstacles {
        (obstacle.friction_static, obstacle.friction_dynamic) = (0.0, 0.0);
    }
    for body in &mut scene.bodies {
        (body.friction_static, body.friction_dynamic) = (0.0, 0.0);
    }
}

fn without_contact_between_bodies(scene: &mut Scene) {
    scene.bodies.iter_mut().for_each(|body| body.collides = false);
}

fn without_contact_within_bodies(scene: &mut Scene) {
    scene.bodies.iter_mut().for_each(|body| body.self_collides = false);
}

/// Takes one substep that moves the bodies; steps that only advance the time are skipped. Returns how many cells were pushed
/// back to shape.
fn moving_substep(simulation: &mut Simulation<f32>) -> u64 {
    loop {
        let report = simulation.substep(&mut ());
        if report.counters.substeps > 0 || report.diverged {
            return report.counters.recovery_cells;
        }
    }
}

/// Times all variants in turn, again and again, so that other load of the machine meets all of them. Every other round goes
/// backwards, so that a variant does not always follow the same one.
fn measure_variants(common: &Simulation<f32>, variants: Vec<Variant>) -> Vec<Ablation> {
    let TimingPlan { substeps, rounds } = TimingPlan::of(common);
    let simulations: Vec<_> =
        std::iter::once(common).chain(variants.iter().map(|variant| &variant.simulation)).collect();
    let mut times = vec![Vec::new(); simulations.len()];
    let mut ends = vec![(0, 0); simulations.len()];
    for round in 0..rounds {
        for place in 0..simulations.len() {
            let place = if round % 2 == 0 { place } else { simulations.len() - 1 - place };
            let (secs, end) = timed(simulations[place], substeps);
            times[place].push(secs);
            ends[place] = end;
        }
    }
    let row = |(place, variant): (usize, Variant)| {
        let (theirs, ours) = (&times[0], &times[place + 1]);
        let [on, off] = if variant.has_feature { [ours, theirs] } else { [theirs, ours] };
        // If cells were pushed back to shape, leaving out the recovery or looking at the cells more often may change the
        // motion.
        let pushed = ends[0].1 + ends[place + 1].1;
        Ablation {
            feature: variant.feature,
            same_bits: ends[0].0 == ends[place + 1].0,
            must_be_same: variant.must_be_same && pushed == 0,
            ..compared("substep", on, off)
        }
    };
    variants.into_iter().enumerate().map(row).collect()
}

/// How much is measured.
pub(super) struct TimingPlan {
    /// Substeps timed in one go.
    pub(super) substeps: usize,
    /// How often they are timed.
    pub(super) rounds: usize,
}

impl TimingPlan {
    /// Chooses the effort by how long a substep of this simulation takes.
    pub(super) fn of(simulation: &Simulation<f32>) -> Self {
        let (first, _) = timed(simulation, 1);
        let (second, _) = timed(simulation, 1);
        let secs = first.min(second).max(1e-9);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
        let substeps = (SLICE_SECS / secs).clamp(1.0, 1000.0) as usize;
        Self { substeps, rounds: ROUND_COUNTS[usize::from(secs > LONG_SUBSTEP_SECS)] }
    }
}

/// Times substeps of a copy. Returns the time of one substep, and the copy's final state hash with its count of cells pushed
/// back to shape.
pub(super) fn timed(simulation: &Simulation<f32>, substeps: usize) -> (f64, (u64, u64)) {
    let mut copy = simulation.clone();
    let begin = ThreadTime::now();
    let pushed = (0..substeps).map(|_| moving_substep(&mut copy)).sum::<u64>();
    (begin.elapsed().as_secs_f64() / substeps as f64, (copy.hash(), pushed))
}

/// Compares the times taken in turn with a feature and without it.
fn compared(per: &'static str, on: &[f64], off: &[f64]) -> Ablation {
    let change = Change::of(on, off);
    Ablation {
        feature: String::new(),
        per,
        secs_on: median(on),
        secs_off: median(off),
        change,
        within_noise: change.is_noise(),
        same_bits: true,
        must_be_same: true,
    }
}

/// Times working out the value that a force map shows of every particle.
fn colours(simulation: &Simulation<f32>) -> Ablation {
    let before = simulation.hash();
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..ROUND_COUNTS[0] {
        for (times, quantity) in times.iter_mut().zip([Some(Quantity::MeanLinkForce), None]) {
            let begin = ThreadTime::now();
            black_box(quantity.map(|quantity| simulation.scalars(quantity)));
            times.push(begin.elapsed().as_secs_f64());
        }
    }
    let [on, off] = &times;
    Ablation { feature: "colours".to_owned(), same_bits: simulation.hash() == before, ..compared("picture", on, off) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Body;
    use crate::scene::body::Inlay;

    #[test]
    fn damping_that_is_left_out_is_left_out_of_inlays_too() {
        let inlay = Inlay { min: [-9.0; 3], max: [9.0; 3], ..Inlay::default() };
        let mut scene = Scene { bodies: vec![Body { inlays: vec![inlay], ..Body::default() }], ..Scene::default() };
        let damped = |scene: &Scene| {
            let mut simulation = Simulation::<f32>::from_scene(scene, "".as_ref()).expect("a sound scene");
            simulation.step().counters.damped_link_forces
        };
        assert!(damped(&scene) > 0);
        without_damping(&mut scene);
        assert_eq!(damped(&scene), 0);
    }
}
