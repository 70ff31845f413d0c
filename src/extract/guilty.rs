//! The links that broke a simulation, marked in the picture of its last good state.

use std::sync::Arc;

use crate::physics::Simulation;
use crate::scene::Family;
use crate::view::Overlay;
use crate::view::overlay::{LineEnds, Lines};
use crate::view::style::Tint;

/// Links are at fault if their rate of strain is at least this fraction of the largest. An unstable mode grows fastest where
/// the lattice is most confined, and falls off from there.
const MIN_RATE_SHARE: f32 = 0.25;
/// How much a body fades so that the links in it can be seen.
const SEE_THROUGH: f32 = 0.7;

/// Finds the links of some families in one body whose length changes fastest, as particles of the draw list. A time step
/// that is too large for a family shows there first: its links overshoot from step to step.
pub fn guilty_links(simulation: &Simulation<f32>, body: usize, families: &[Family]) -> Vec<[u32; 2]> {
    let Some(body) = simulation.model().bodies.get(body) else { return Vec::new() };
    let state = simulation.state();
    let first = u32::try_from(body.particles.start).unwrap_or(u32::MAX);
    let links = families.iter().flat_map(|&family| body.links[family as usize].links.iter());
    let rates: Vec<([u32; 2], f32)> = links
        .map(|link| {
            let ends = link.ends.map(|end| first + end);
            let [i, j] = ends.map(|end| end as usize);
            let direction = (state.position[j] - state.position[i]).normalize_or_zero();
            let rate = (state.velocity[j] - state.velocity[i]).dot(direction).abs() * link.inverse_rest_length;
            (ends, rate)
        })
        .collect();
    let largest = rates.iter().map(|(_, rate)| *rate).fold(0.0, f32::max);
    let is_guilty = |&&(_, rate): &&([u32; 2], f32)| largest > 0.0 && rate >= MIN_RATE_SHARE * largest;
    rates.iter().filter(is_guilty).map(|(ends, _)| *ends).collect()
}

/// Marks links over everything else, and makes bodies sheer.
pub fn mark_links(overlay: &mut Overlay, links: &Arc<Vec<[u32; 2]>>) {
    if links.is_empty() {
        return;
    }
    overlay.see_through = overlay.see_through.max(SEE_THROUGH);
    let ends = LineEnds::Particles { ends: Arc::clone(links), first: 0 };
    overlay.lines.push(Lines { ends, tint: Tint::Broken, opacity: 1.0, width: 2.4, hidden: 0.6 });
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::{Lattice, voxel::Cells};
    use crate::scene::body::CubeShape;
    use crate::scene::{Body, Scene, Shape};

    /// Two cubes of one cell. A corner of the second one is torn away along x.
    fn torn() -> Simulation<f32> {
        let body = || Body { shape: Shape::Cube(CubeShape { cells: 1, size: 1.0 }), ..Body::default() };
        let scene = Scene { bodies: vec![body(), body()], ..Scene::default() };
        let lattice = Arc::new(Lattice::new(&Cells::cube(1, 1.0).expect("a cell")));
        let mut simulation = Simulation::new(&scene, &[Arc::clone(&lattice), lattice]);
        let mut state = simulation.state().clone();
        state.velocity[8] = Vec3::NEG_X;
        simulation.set_state(state);
        simulation
    }

    #[test]
    fn the_links_that_change_fastest_are_guilty_and_only_of_the_family_and_body_accused() {
        let simulation = torn();
        assert_eq!(guilty_links(&simulation, 1, &[Family::Structural]), [[8, 9]], "the edge along the motion");
        let shear = guilty_links(&simulation, 1, &[Family::Shear]);
        assert!(shear.len() == 3 && shear.iter().all(|ends| ends.contains(&8)), "diagonals with a share: {shear:?}");
        assert!(guilty_links(&simulation, 0, &Family::ALL).is_empty(), "nothing moves in the other");
        assert!(guilty_links(&simulation, 2, &Family::ALL).is_empty(), "there is no third");
    }

    #[test]
    fn no_guilt_leaves_the_picture_alone() {
        let mut overlay = Overlay::default();
        mark_links(&mut overlay, &Arc::default());
        assert_eq!(overlay, Overlay::default(), "nothing to mark");
        mark_links(&mut overlay, &Arc::new(vec![[0, 1]]));
        assert!(overlay.see_through > 0.0 && overlay.lines[0].tint == Tint::Broken, "marked and seen: {overlay:?}");
    }
}
