//! Links of crushed cells flow, in bodies whose link families have stiffnesses far apart.
//!
//! In such a body the push of [`super`] alone does not turn every cell back. With shear links alone, for example, it is two
//! sublattices that hold their mirror images against any push that the step could bear. So the links between particles of
//! crushed cells gradually lose their elastic force, all but 1 % where V ≤ 0 and the families are furthest apart, and get a
//! damping of `k dt/2` in its place: they flow while the volume turns over and are springs again as soon as it has. Link
//! forces act in pairs along the link: momentum and angular momentum stay. A body in violent motion keeps its links as they
//! are. So does a body whose families are alike, or that has little but bending links: the push alone turns it back.
//!
//! Stretching or squeezing a soft link takes 1 % of the work that it gives back once it is hard again. The difference is
//! paid from the energy that recovery has taken from the body, see [`super::account`]; where nothing is left, only links
//! that return to their rest length are soft.
//!
//! Measured with 9 ways to break a cube and the 6 ways in which families can be 1e4 apart, over 5 to 10 particles an edge,
//! free, held and on rough ground, with three integrators: of 594 cubes 54 stay broken (by up to 187 cells) with the push
//! alone, 11 (by one or two cells) with soft links, and none flies apart.
//!
//! A body of shear links alone, or of shear and bending links, that was crushed to a point stays in a knot: in 14 of 36 such
//! cubes (5 to 10 particles an edge, three random starts) one to three cells stay inverted for ever. The pull of
//! [`crate::physics::forces::recovery::pull`] turned all of those 36 back; of 600 others (5 to 8 particles an edge) it left
//! one in ten with one to three cells inverted after half a second. Which ones depends on the rounding of forces. None of
//! the three (push, soft links, pull) sees anything smaller than a cell: in each of the two sublattices about a fifth of the
//! tetrahedra of such a cube stay mirrored.
//!
//! The implicit integrator needs no such damping: its matrix has the whole stiffness of softened links, which resists as a
//! damping of `k dt` would.

use super::edges::VOLUME_THRESHOLD;
use crate::math::{Real, Vector};
use crate::physics::forces::links::link_force;
use crate::physics::forces::recovery::edges::MeanEdges;
use crate::physics::model::{BodyModel, Composition, Link, Model};
use crate::physics::state::BodyMemory;

/// The share of their elastic force that links between particles of inverted cells lose if the families are far apart.
/// Losing all of it would leave nothing to put a body in order that was crushed to a point.
const MAX_SOFTNESS: f64 = 0.99;

/// Families are far apart if such links lose more than this: one is ten times as stiff as the other.
const FAR_APART_SOFTNESS: f64 = 0.9 * MAX_SOFTNESS;

/// The damping that such links get instead, over `k dt`. In semi-implicit Euler a half limits the step as much as the
/// elastic force that was taken away; at three quarters Verlet, which counts damping twice, kept cubes broken.
const FLOW_DAMPING: f64 = 0.5;

/// The strains between which soft links regain their whole force: parts that fly apart unhindered come back with more energy
/// than they left with; crumpled cubes blew up.
const TAUT_STRAINS: [f64; 2] = [0.5, 2.0];

/// Links are soft while the mean kinetic energy of a particle is below this share of a cell's stiffness against inversion:
/// what crushes soft links with force is given back in full by hard ones. At a hundredth, random extreme scenes gained
/// energy; at a ten thousandth, crumpled cubes stayed broken.
const CALM_ENERGY_SHARE: f64 = 1e-3;

/// The workspace for softening the links of a body; empty where they are never softened.
#[derive(Clone, Debug)]
pub(in crate::physics) struct RecoveryWorkspace<R: Real> {
    /// For each particle the share of elastic force that its links lose.
    softness: Vec<R>,
    /// The particles with a softness above zero, ascending.
    soft: Vec<u32>,
}

impl<R: Real> RecoveryWorkspace<R> {
    /// Allocates the workspaces of a model's bodies.
    pub(in crate::physics) fn of_each(model: &Model<R>) -> Vec<Self> {
        let particles = |body: &BodyModel<R>| if max_softness(body) > R::ZERO { body.particles.len() } else { 0 };
        let room = |count| Self { softness: vec![R::ZERO; count], soft: Vec::with_capacity(count) };
        model.bodies.iter().map(particles).map(room).collect()
    }
}

/// Takes most of their elastic force from the links between particles of crushed cells and lets them flow instead. The links
/// of a mirrored cell would hold it in its mirror image, and springs that are only weakened would give back more than they
/// took when they strengthen again. Links flow as in whole substeps, even if these are divided: with less flow, links that
/// were crushed to a point stayed crushed.
pub(super) fn soften<R: Real>(
    body: &BodyModel<R>,
    memory: &BodyMemory,
    at: [&[R::Vec3]; 2],
    workspace: &mut RecoveryWorkspace<R>,
    force: &mut [R::Vec3],
) {
    for_each_soft_link(body, memory, at, workspace, |[i, j], link| {
        let on_i = link_force(link.d, link.dv, link.inverse_rest_length, link.stiffness, -link.flow) * link.softness;
        force[i] -= on_i;
        force[j] += on_i;
    });
}

/// A link that is soft.
pub(super) struct SoftLink<R: Real> {
    /// Vector from the first end to the second, m.
    pub(super) d: R::Vec3,
    /// Rate at which `d` changes, m/s.
    pub(super) dv: R::Vec3,
    pub(super) inverse_rest_length: R,
    /// The link's own force at 100 % strain, N.
    pub(super) stiffness: R,
    /// The force at a speed of one rest length a second that replaces it, N.
    pub(super) flow: R,
    /// The share to which both apply.
    pub(super) softness: R,
}

/// Calls `visit` with the ends of every soft link of a body, and the link; where recovery has no energy left to give, only
/// those whose energy falls. Positions and velocities are the body's own.
pub(super) fn for_each_soft_link<R: Real>(
    body: &BodyModel<R>,
    memory: &BodyMemory,
    [position, velocity]: [&[R::Vec3]; 2],
    workspace: &mut RecoveryWorkspace<R>,
    mut visit: impl FnMut([usize; 2], SoftLink<R>),
) {
    let softest = max_softness(body);
    if softest <= R::ZERO {
        return;
    }
    let crushed = |&cell: &u32| {
        let corners = &body.lattice.cells[cell as usize];
        let missing = R::from_f64(VOLUME_THRESHOLD) - MeanEdges::of(position, corners, body.inverse_cell_size).volume();
        let share = softest * (missing * R::from_f64(1.0 / VOLUME_THRESHOLD)).min(R::ONE);
        (missing.is_finite() && missing > R::ZERO).then_some((corners, share))
    };
    let mut crushed = memory.near_inversion.iter().filter_map(crushed).peekable();
    if crushed.peek().is_none() {
        return;
    }
    // In a body that moves so little soft links can do no harm.
    let is_calm = kinetic_share(body, velocity) < CALM_ENERGY_SHARE;
    if !is_calm {
        return;
    }
    let RecoveryWorkspace { softness, soft } = workspace;
    softness.fill(R::ZERO);
    for (corners, share) in crushed {
        for &corner in corners {
            softness[corner as usize] = softness[corner as usize].max(share);
        }
    }
    soft.clear();
    soft.extend((0..).zip(&*softness).filter(|(_, softness)| **softness > R::ZERO).map(|(particle, _)| particle));
    let may_give = memory.account.taken_j > 0.0;
    for family in &body.links {
        for (number, link) in links_from(&family.links, soft) {
            let [i, j] = link.ends.map(|end| end as usize);
            let softness = softness[i].min(softness[j]);
            if softness > R::ZERO {
                let (d, dv) = (position[j] - position[i], velocity[j] - velocity[i]);
                let strain = d.length() * link.inverse_rest_length - R::ONE;
                if !may_give && strain * d.dot(dv) > R::ZERO {
                    continue;
                }
                let stretched =
                    (strain - R::from_f64(TAUT_STRAINS[0])) * R::from_f64(1.0 / (TAUT_STRAINS[1] - TAUT_STRAINS[0]));
                let share = softness * (R::ONE - stretched).max(R::ZERO).min(R::ONE);
                let inverse_rest_length = link.inverse_rest_length;
                let [stiffness, _] = family.constants(number);
                let flow = stiffness * body.recovery.flow_secs * R::from_f64(FLOW_DAMPING);
                visit([i, j], SoftLink { d, dv, inverse_rest_length, stiffness, flow, softness: share });
            }
        }
    }
}

/// Returns the links whose first end is one of these particles, with their numbers. Both ascend, so that the links of a few
/// crushed cells are found without a walk over all links of a large body.
fn links_from<'a, R: Real>(links: &'a [Link<R>], particles: &'a [u32]) -> impl Iterator<Item = (usize, &'a Link<R>)> {
    let mut first = 0;
    particles.iter().flat_map(move |&particle| {
        first += links[first..].partition_point(|link| link.ends[0] < particle);
        (first..).zip(&links[first..]).take_while(move |(_, link)| link.ends[0] == particle)
    })
}

/// Returns the mean kinetic energy of a body's particles, without that of the whole body's motion along a line, over a cell's
/// stiffness against inversion.
pub(super) fn kinetic_share<R: Real>(body: &BodyModel<R>, velocity: &[R::Vec3]) -> f64 {
    let count = velocity.len().max(1) as f64;
    let mean = velocity.iter().fold(R::Vec3::ZERO, |sum, v| sum + *v) * R::from_f64(1.0 / count);
    let twice = velocity.iter().enumerate().fold(0.0, |sum, (local, v)| {
        let past = *v - mean;
        sum + body.mass(local).to_f64() * past.dot(past).to_f64()
    });
    0.5 * twice / (count * body.recovery.stiffness.to_f64())
}

/// Whether links between particles of inverted cells lose nearly all of their force.
pub(in crate::physics) fn families_are_far_apart<R: Real>(body: &BodyModel<R>) -> bool {
    max_softness(body) > R::from_f64(FAR_APART_SOFTNESS)
}

/// Returns the share of their elastic force that links between particles of inverted cells lose: it grows with the gap
/// between the structural and the shear stiffness. If bending links are stiffer than both, the push alone turns cells back,
/// and soft links would give a body energy. Links that cells share out never have families far apart.
fn max_softness<R: Real>(body: &BodyModel<R>) -> R {
    let softest = |[structural, shear, bending]: [R; 3]| {
        let most = structural.max(shear).max(bending);
        if most > R::ZERO {
            R::from_f64(MAX_SOFTNESS) * ((structural - shear).max(shear - structural) / most)
        } else {
            R::ZERO
        }
    };
    match &body.composition {
        Composition::Alike => softest(body.links.each_ref().map(|family| family.stiffness)),
        Composition::Solids { .. } => R::ZERO,
        Composition::Springs { loads, .. } => {
            loads.kinds().iter().map(|kind| softest(kind.stiffness.map(R::from_f64))).fold(R::ZERO, R::max)
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::physics::Simulation;
    use crate::scene::body::{CubeShape, Inlay};
    use crate::scene::resolve::resolve;
    use crate::scene::{Body, Scene, Shape, Springs};

    #[test]
    fn links_of_some_particles_are_found_among_all() {
        let link = |ends| Link::<f32> { ends, rest_length: 1.0, inverse_rest_length: 1.0 };
        let links: Vec<_> = [[0, 1], [0, 4], [2, 3], [2, 4], [2, 9], [3, 4], [7, 8]].map(link).into();
        for some in [&[][..], &[0], &[1], &[2], &[0, 2], &[1, 2, 3, 7], &[3, 5, 8], &[9]] {
            let found: Vec<_> = links_from(&links, some).collect();
            let among_all: Vec<_> = links.iter().enumerate().filter(|(_, link)| some.contains(&link.ends[0])).collect();
            assert_eq!(found, among_all, "{some:?}");
        }
    }

    #[test]
    fn a_soft_link_loses_of_its_own_stiffness_and_not_of_the_stiffest() {
        let mut stiff = Springs::default();
        stiff.shear.stiffness *= 1e4;
        let inlays = vec![Inlay { min: [0.0, -9.0, -9.0], max: [9.0; 3], springs: stiff, ..Inlay::default() }];
        let shape = Shape::Cube(CubeShape { cells: 4, size: 1.0 });
        let scene = Scene { bodies: vec![Body { shape, inlays, ..Body::default() }], ..Scene::default() };
        let lattice = resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice;
        let simulation = Simulation::<f64>::new(&scene, &[lattice]);
        let (body, mut memory) = (&simulation.model().bodies[0], simulation.state().bodies[0].clone());
        memory.near_inversion = (0..64).collect();
        let flat: Vec<_> = simulation.state().position.iter().map(|x| *x * glam::DVec3::new(1.0, 0.01, 1.0)).collect();
        let still = vec![glam::DVec3::ZERO; flat.len()];
        let mut soft = Vec::new();
        let mut workspaces = RecoveryWorkspace::of_each(simulation.model());
        for_each_soft_link(body, &memory, [&flat, &still], &mut workspaces[0], |ends, link| {
            soft.push((ends, link.stiffness));
        });
        let own = body.links.iter().flat_map(|family| {
            let links = family.links.iter().enumerate();
            links.map(|(number, link)| (link.ends.map(|end| end as usize), family.constants(number)[0]))
        });
        assert_eq!(soft, own.collect::<Vec<_>>());
    }
}
