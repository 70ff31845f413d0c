//! Springs that differ by cell. A link has the mean constants of the cells that hold it; a link that runs straight through a
//! particle has those of the cells around both its halves. A particle has the mean mass of the cells around it. So cells of
//! the body's own springs are as if there were no others, at a surface too.

use std::sync::Arc;

use super::assembly::{Assembled, classed_family};
use super::link_classes::{ClassKey, Classes, NO_CELL, cells_around, holders, present};
use crate::geometry::{Family, Lattice};
use crate::math::Real;
use crate::physics::limits::particles::{Mixture, MixtureClasses, ParticleLoads};
use crate::physics::model::{CellKind, Link, Values};
use crate::scene::Springs;

/// The cell of a body of these springs alone: the constants of its links and the mass of its particles.
pub(in crate::physics) fn spring_cell(springs: &Springs) -> CellKind {
    let spring = Family::ALL.map(|family| springs.family(family));
    CellKind {
        stiffness: spring.map(|spring| spring.stiffness),
        damping: spring.map(|spring| spring.damping),
        mass: springs.particle_mass,
    }
}

/// The means over the cells, and the loads that limit the step. `measured` are the lattice's links; `kind_of_cell` holds a
/// place in `kinds` for every cell of the lattice; the first kind is the body's own.
pub(super) fn springs_by_cell<R: Real>(
    kinds: Vec<CellKind>,
    kind_of_cell: &Values<u8>,
    lattice: &Lattice,
    measured: [Arc<[Link<R>]>; 3],
) -> (Assembled<R>, ParticleLoads) {
    let around = cells_around(lattice);
    let kind_of = |cell: u32| kind_of_cell.of(cell as usize);
    let mut classes = Classes::default();
    let class =
        |around: &[u32; 8]| classes.of_mean(around.iter().filter(|&&cell| cell != NO_CELL).map(|&cell| kind_of(cell)));
    let of_particle: Vec<u16> = around.iter().map(class).collect();
    let mass = |kind: &CellKind| [kind.mass, 0.0];
    let of_masses: Vec<Mixture> = classes.keys.iter().map(mixture).collect();
    let masses: Vec<f64> = of_masses.iter().map(|mixture| mean(mixture, &kinds, mass)[0]).collect();
    let masses: Vec<f64> = of_particle.iter().map(|&class| masses[usize::from(class)]).collect();

    let [structural, shear, bending] = measured;
    let families = [(Family::Structural, structural), (Family::Shear, shear), (Family::Bending, bending)];
    let families = families.map(|(family, links)| {
        let mut classes = Classes::default();
        let class = |&link: &[u32; 2]| classes.of_mean(holders_of(link, family, lattice, &around).map(kind_of));
        let of_link: Vec<u16> = lattice.links[family as usize].iter().map(class).collect();
        let constants = |kind: &CellKind| [kind.stiffness[family as usize], kind.damping[family as usize]];
        let mixtures: Vec<Mixture> = classes.keys.iter().map(mixture).collect();
        let constants = mixtures.iter().map(|mixture| mean(mixture, &kinds, constants)).collect();
        (classed_family(links, of_link, constants), mixtures)
    });
    let made_of = families.each_ref().map(|(family, mixtures)| MixtureClasses { class: family.classes(), mixtures });
    let masses_made_of = MixtureClasses { class: &of_particle, mixtures: &of_masses };
    let loads = ParticleLoads::of(kinds, lattice, &made_of, masses_made_of);
    let particle_mass = masses.iter().sum::<f64>() / masses.len().max(1) as f64;
    let links = families.map(|(family, _)| family);
    (Assembled { particle_mass, masses: Values::Each(masses), links }, loads)
}

/// The cells that hold a link: of one with two halves, first those around the one half, then those around the other.
fn holders_of(
    [low, high]: [u32; 2],
    family: Family,
    lattice: &Lattice,
    around: &[[u32; 8]],
) -> impl Iterator<Item = u32> {
    let corner = |particle: u32| lattice.corners[particle as usize];
    let (from, to) = (corner(low), corner(high));
    let middle = std::array::from_fn(|axis| u32::midpoint(from[axis], to[axis]));
    let is_halved = family == Family::Bending;
    let first = holders(&around[low as usize], from, if is_halved { middle } else { to });
    let second = is_halved.then(|| holders(&around[high as usize], to, middle));
    first.chain(second.into_iter().flatten())
}

/// The means of two values over the kinds of a mixture.
fn mean(mixture: &Mixture, kinds: &[CellKind], of: impl Fn(&CellKind) -> [f64; 2]) -> [f64; 2] {
    mixture.iter().fold([0.0; 2], |sum, &(kind, share)| {
        let values = of(&kinds[usize::from(kind)]);
        std::array::from_fn(|which| sum[which] + share * values[which])
    })
}

/// The kinds of a class with their shares.
fn mixture((count, held): &ClassKey) -> Mixture {
    present(held).map(|(kind, cells)| (kind, f64::from(cells) / f64::from(*count))).collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::voxel::Cells;
    use crate::physics::compile::assembly::measure_links;

    fn springs(stiffness: f64, particle_mass: f64) -> Springs {
        let mut springs = Springs { particle_mass, ..Springs::default() };
        for (family, times) in Family::ALL.into_iter().zip([1.0, 2.0, 3.0]) {
            let spring = springs.family_mut(family);
            (spring.stiffness, spring.damping) = (times * stiffness, 0.1 * times * stiffness);
        }
        springs
    }

    /// Cells in a list, of two kinds, the first soft and light.
    fn assembled(cells: &[[i32; 3]], kind_of_cell: Vec<u8>) -> (Lattice, Assembled<f64>) {
        let lattice = Lattice::new(&Cells::from_list(cells, 1.0).expect("cells"));
        let rest: Vec<DVec3> = (0..lattice.corners.len()).map(|p| lattice.rest_position(p)).collect();
        let kinds = [springs(1.0, 4.0), springs(9.0, 12.0)].map(|springs| spring_cell(&springs));
        let (assembled, _) =
            springs_by_cell(kinds.into(), &Values::Each(kind_of_cell), &lattice, measure_links(&lattice, &rest));
        (lattice, assembled)
    }

    fn constants(lattice: &Lattice, assembled: &Assembled<f64>, family: Family, ends: [[u32; 3]; 2]) -> [f64; 2] {
        let mut ends = ends.map(|end| lattice.corners.iter().position(|&corner| corner == end).expect("a corner"));
        ends.sort_unstable();
        let links = &assembled.links[family as usize];
        let link = links.links.iter().position(|link| link.ends.map(|end| end as usize) == ends).expect("a link");
        links.constants(link)
    }

    #[test]
    fn links_and_particles_have_the_mean_of_the_cells_that_hold_them() {
        // Two cells in a row, and a third beside the second.
        let (lattice, found) = assembled(&[[0, 0, 0], [1, 0, 0], [1, 1, 0]], vec![0, 1, 1]);
        let of = |family, ends| constants(&lattice, &found, family, ends);
        let near = |found: [f64; 2], mean: f64, times: f64| {
            let right = [times * mean, 0.1 * times * mean];
            found.iter().zip(right).all(|(a, b)| (a - b).abs() < 1e-12)
        };
        let alone = of(Family::Structural, [[0, 0, 0], [1, 0, 0]]);
        assert!(near(alone, 1.0, 1.0), "held by the soft cell alone: {alone:?}");
        let shared = of(Family::Structural, [[1, 0, 0], [1, 0, 1]]);
        assert!(near(shared, 5.0, 1.0), "held by one of each: {shared:?}");
        let of_three = of(Family::Structural, [[1, 1, 0], [1, 1, 1]]);
        assert!(near(of_three, 19.0 / 3.0, 1.0), "one soft, two stiff: {of_three:?}");
        let across = of(Family::Shear, [[1, 0, 0], [1, 1, 1]]);
        assert!(near(across, 5.0, 2.0), "a diagonal of the face between: {across:?}");
        let through = of(Family::Shear, [[1, 0, 0], [2, 1, 1]]);
        assert!(near(through, 9.0, 2.0), "through the stiff cell: {through:?}");
        // Its halves are held by one soft cell and by one stiff one, at the edge y = 1 by another stiff one too.
        let straight = of(Family::Bending, [[0, 0, 0], [2, 0, 0]]);
        assert!(near(straight, 5.0, 3.0), "straight through a particle: {straight:?}");
        let straight = of(Family::Bending, [[0, 1, 0], [2, 1, 0]]);
        assert!(near(straight, 19.0 / 3.0, 3.0), "held by three in all: {straight:?}");
        let mass =
            |corner: [u32; 3]| found.masses.of(lattice.corners.iter().position(|&c| c == corner).expect("a corner"));
        assert_eq!((mass([0, 0, 0]), mass([1, 0, 0]), mass([2, 0, 0])), (4.0, 8.0, 12.0), "light, shared, heavy");
        assert!((mass([1, 1, 0]) - 28.0 / 3.0).abs() < 1e-12, "of three cells");
        let whole: f64 = (0..lattice.corners.len()).map(|particle| found.masses.of(particle)).sum();
        assert!((found.particle_mass * lattice.corners.len() as f64 - whole).abs() < 1e-12, "the mean mass");
    }

    #[test]
    fn cells_of_one_kind_are_as_if_there_were_no_other() {
        let (lattice, found) = assembled(&[[0, 0, 0], [1, 0, 0], [1, 1, 0]], vec![1, 1, 1]);
        for family in &found.links {
            let [stiffness, damping] = [family.stiffness, family.damping].map(f64::to_bits);
            let all = (0..family.links.len()).map(|link| family.constants(link).map(f64::to_bits));
            assert!(all.into_iter().all(|found| found == [stiffness, damping]), "to the last bit");
        }
        assert!((0..lattice.corners.len()).all(|particle| found.masses.of(particle).to_bits() == 12f64.to_bits()));
    }
}
