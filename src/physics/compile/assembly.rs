//! Masses of particles and constants of links: the same for all (springs), or sums of the cells' shares (solid); springs
//! that differ by cell are in [`mod@super::springs_by_cell`].
//!
//! Every cell of edge h gives each of its own links a share, and a link's constant is the sum over the cells that hold it,
//! so that a surface is as soft as it is thin and a block has the given modulus at any resolution:
//!
//! ```text
//!   12 edges             a quarter of the structural constant   (four cells meet at an edge)
//!   12 face diagonals    half of the shear constant             (two cells meet at a face)
//!    4 body diagonals    the shear constant
//!    8 corners           an eighth of the cell's mass
//! ```
//!
//! With `k_shear = E h²/3.69227` and `k_structural = 2.24671 k_shear` the lattice is isotropic, `E = 2.5 C12` with
//! `C12 h² = k_shear (√2/2 + 4√3/9)` and Poisson's ratio 1/4, as central forces always give (Cauchy). Bending links
//! would break the balance at free surfaces and are left without force.

use std::sync::Arc;

use glam::DVec3;

use crate::geometry::{Family, Lattice};
use crate::math::Real;
use crate::physics::compile::link_classes::{ClassKey, Classes, NO_CELL, cells_around, holders, present};
use crate::physics::model::levels::StiffnessLevels;
use crate::physics::model::{CellKind, Link, LinkConstants, LinkFamily, Values};
use crate::scene::Springs;
use crate::scene::material::Solid;

/// `E h²` over the constant of diagonal links: 2.5 (√2/2 + 4√3/9) isotropic constants.
pub(in crate::physics) const MODULUS_OVER_SHEAR: f64 = 3.692_27;

/// The constant of edges over that of diagonals in an isotropic lattice.
pub(in crate::physics) const STRUCTURAL_OVER_SHEAR: f64 = 2.246_71;

/// The material side of a body model.
#[derive(Debug)]
pub(in crate::physics) struct Assembled<R: Real> {
    /// The mass of every particle, or the mean, kg.
    pub(in crate::physics) particle_mass: f64,
    /// The masses of the particles, kg.
    pub(in crate::physics) masses: Values<f64>,
    /// The links by family.
    pub(in crate::physics) links: [LinkFamily<R>; 3],
}

/// The thesis's seven values: every particle and every link of a family alike. `measured` are the lattice's links.
pub(in crate::physics) fn uniform<R: Real>(springs: &Springs, measured: [Arc<[Link<R>]>; 3]) -> Assembled<R> {
    let [structural, shear, bending] = measured;
    let links = [(Family::Structural, structural), (Family::Shear, shear), (Family::Bending, bending)];
    let links = links.map(|(family, links)| {
        let constants = springs.family(family);
        uniform_family(links, [constants.stiffness, constants.damping].map(R::from_f64))
    });
    let particle_mass = springs.particle_mass;
    Assembled { particle_mass, masses: Values::Uniform(particle_mass), links }
}

/// The constants that a cell of a solid shares out. `size` is the body's longest extent, m: its slowest vibration has the
/// solid's damping ratio, faster ones have more in proportion to their frequency.
pub(in crate::physics) fn solid_cell(solid: &Solid, lattice: &Lattice, size: f64) -> CellKind {
    let h = lattice.grid.cell_size;
    let shear = solid.young_modulus * h * h / MODULUS_OVER_SHEAR;
    let stiffness = [STRUCTURAL_OVER_SHEAR * shear, shear, 0.0];
    let slowest = std::f64::consts::PI / size * (solid.young_modulus / solid.density).sqrt();
    let damping_over_stiffness = 2.0 * solid.damping_ratio / slowest;
    CellKind {
        stiffness,
        damping: stiffness.map(|stiffness| stiffness * damping_over_stiffness),
        mass: solid.density * h * h * h,
    }
}

/// Young's modulus of the solid whose diagonal links have this stiffness (N), Pa.
#[expect(clippy::cast_possible_truncation, reason = "it is shown")]
pub(in crate::physics) fn modulus(diagonal: f64, lattice: &Lattice) -> f32 {
    let h = lattice.grid.cell_size;
    (MODULUS_OVER_SHEAR * diagonal / (h * h)) as f32
}

/// Sums the shares of the cells. `measured` are the lattice's links; `kind_of_cell` holds a place in `kinds` for every
/// cell of the lattice.
pub(in crate::physics) fn by_cell<R: Real>(
    kinds: &[CellKind],
    kind_of_cell: &Values<u8>,
    lattice: &Lattice,
    measured: [Arc<[Link<R>]>; 3],
) -> Assembled<R> {
    let kind_of = |cell: u32| kind_of_cell.of(cell as usize);
    let around = cells_around(lattice);
    let mut masses = vec![0.0; lattice.corners.len()];
    for (mass, around) in masses.iter_mut().zip(&around) {
        for &cell in around.iter().filter(|&&cell| cell != NO_CELL) {
            *mass += kinds[usize::from(kind_of(cell))].mass / 8.0 * lattice.share(cell as usize);
        }
    }
    let particle_mass = masses.iter().sum::<f64>() / masses.len().max(1) as f64;
    let levels = StiffnessLevels::of(lattice);
    let level_of = |cell: u32| levels.as_ref().map_or(1, |levels| levels.of_cell[cell as usize]);
    let step = levels.as_ref().map_or(1.0, |levels| levels.step);
    let [structural, shear, bending] = measured;
    let links = [(Family::Structural, structural), (Family::Shear, shear), (Family::Bending, bending)];
    let links = links.map(|(family, links)| {
        if family == Family::Bending {
            return uniform_family(links, [R::ZERO; 2]);
        }
        let mut classes = Classes::default();
        let class = |&[low, high]: &[u32; 2]| {
            let [from, to] = [low, high].map(|corner| lattice.corners[corner as usize]);
            let axes = (0..3).filter(|&axis| from[axis] != to[axis]).count();
            let holders = holders(&around[low as usize], from, to).map(|cell| (kind_of(cell), level_of(cell)));
            classes.of(CELLS_PER_LINK[axes], holders, levels.is_some())
        };
        let of_link = lattice.links[family as usize].iter().map(class).collect();
        let constants = classes.keys.iter().map(|key| shares(key, kinds, step, family));
        classed_family(links, of_link, constants.collect())
    });
    Assembled { particle_mass, masses: Values::Each(masses), links }
}

/// A family whose links are all alike.
fn uniform_family<R: Real>(links: Arc<[Link<R>]>, [stiffness, damping]: [R; 2]) -> LinkFamily<R> {
    LinkFamily { stiffness, damping, links, constants: LinkConstants::Uniform([stiffness, damping]) }
}

/// A family whose links are of classes, which have these constants.
pub(super) fn classed_family<R: Real>(
    links: Arc<[Link<R>]>,
    of_link: Vec<u16>,
    constants: Vec<[f64; 2]>,
) -> LinkFamily<R> {
    let largest = |which: usize| R::from_f64(constants.iter().map(|c| c[which]).fold(0.0, f64::max));
    let [stiffness, damping] = [largest(0), largest(1)];
    let constants = constants.into_iter().map(|constants| constants.map(R::from_f64)).collect();
    LinkFamily { stiffness, damping, links, constants: LinkConstants::Classes { of_link, constants } }
}

/// How many cells share a link inside a body, by the number of axes that the link runs along.
const CELLS_PER_LINK: [u8; 4] = [1, 4, 2, 1];

/// The sum of the shares that the cells of a class give to a link of a family, N and N·s; `step` is that of their levels.
fn shares((shared_by, held): &ClassKey, kinds: &[CellKind], step: f64, family: Family) -> [f64; 2] {
    let known = present(held).filter_map(|(kind, level)| Some((kinds.get(usize::from(kind))?, level)));
    known.fold([0.0, 0.0], |[k, d], (kind, level)| {
        let share = step * f64::from(level) / f64::from(*shared_by);
        [k + share * kind.stiffness[family as usize], d + share * kind.damping[family as usize]]
    })
}

/// The links of a lattice by family; `rest` is where its particles are at rest, m.
pub(in crate::physics) fn measure_links<R: Real>(lattice: &Lattice, rest: &[DVec3]) -> [Arc<[Link<R>]>; 3] {
    let measure = |&ends: &[u32; 2]| {
        let rest_length = rest[ends[0] as usize].distance(rest[ends[1] as usize]);
        Link { ends, rest_length: R::from_f64(rest_length), inverse_rest_length: R::from_f64(1.0 / rest_length) }
    };
    Family::ALL.map(|family| lattice.links[family as usize].iter().map(measure).collect())
}

#[expect(clippy::float_cmp, reason = "the shares are halves and quarters of small numbers")]
#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::voxel::Cells;

    const SOFT: CellKind = CellKind { stiffness: [4.0, 2.0, 0.0], damping: [0.4, 0.2, 0.0], mass: 8.0 };
    const HARD: CellKind = CellKind { stiffness: [40.0, 20.0, 0.0], damping: [4.0, 2.0, 0.0], mass: 80.0 };

    /// Two cells side by side along x.
    fn pair(kind_of_cell: &Values<u8>) -> (Lattice, Assembled<f64>) {
        pair_of(None, kind_of_cell)
    }

    fn pair_of(shares: Option<Vec<f64>>, kind_of_cell: &Values<u8>) -> (Lattice, Assembled<f64>) {
        let whole = Lattice::new(&Cells::from_list(&[[0, 0, 0], [1, 0, 0]], 1.0).expect("two cells"));
        let lattice = Lattice { shares, ..whole };
        let rest: Vec<DVec3> = (0..lattice.corners.len()).map(|p| lattice.rest_position(p)).collect();
        let assembled = by_cell(&[SOFT, HARD], kind_of_cell, &lattice, measure_links(&lattice, &rest));
        (lattice, assembled)
    }

    fn constant(lattice: &Lattice, family: &LinkFamily<f64>, from: [u32; 3], to: [u32; 3]) -> [f64; 2] {
        let at = |corner| lattice.corners.iter().position(|&c| c == corner).expect("a corner");
        let mut ends = [at(from), at(to)];
        ends.sort_unstable();
        let link = family.links.iter().position(|link| link.ends.map(|end| end as usize) == ends).expect("a link");
        family.constants(link)
    }

    #[test]
    fn every_cell_gives_its_links_a_share_and_its_corners_an_eighth() {
        let (lattice, Assembled { masses, links: [edges, diagonals, bending], .. }) = pair(&Values::Uniform(0));
        assert_eq!(constant(&lattice, &edges, [0, 0, 0], [1, 0, 0]), [1.0, 0.1], "a lonely edge has a quarter");
        assert_eq!(constant(&lattice, &edges, [1, 0, 0], [1, 1, 0]), [2.0, 0.2], "an edge of two cells has half");
        assert_eq!(constant(&lattice, &diagonals, [0, 0, 0], [1, 1, 0]), [1.0, 0.1], "half on a surface");
        assert_eq!(constant(&lattice, &diagonals, [1, 0, 0], [1, 1, 1]), [2.0, 0.2], "all of it between two cells");
        assert_eq!(
            constant(&lattice, &diagonals, [0, 0, 0], [1, 1, 1]),
            [2.0, 0.2],
            "a body diagonal is the cell's own"
        );
        assert_eq!(bending.stiffness, 0.0, "bending links have no force");
        assert_eq!((0..12).map(|particle| masses.of(particle)).sum::<f64>(), 16.0, "the masses of the cells");
        assert_eq!((masses.of(0), masses.of(1)), (1.0, 2.0), "an eighth of each cell around a corner");
    }

    #[test]
    fn a_cell_weighs_and_resists_as_it_is_full() {
        let halves = || Some(vec![0.5, 1.5]);
        let (lattice, Assembled { masses, links: [edges, diagonals, _], particle_mass, .. }) =
            pair_of(halves(), &Values::Uniform(0));
        assert_eq!((masses.of(0), masses.of(1), masses.of(2)), (0.5, 2.0, 1.5), "an eighth of what is in each");
        assert_eq!(particle_mass * 12.0, 16.0, "two cells in all");
        assert_eq!(constant(&lattice, &edges, [0, 0, 0], [1, 0, 0]), [0.5, 0.05], "half of a quarter");
        assert_eq!(constant(&lattice, &edges, [1, 0, 0], [1, 1, 0]), [2.0, 0.2], "an edge of both");
        assert_eq!(constant(&lattice, &diagonals, [1, 0, 0], [2, 1, 1])[0], 3.0, "the cell's own, half as much again");
        let (lattice, Assembled { links: [edges, ..], .. }) = pair_of(halves(), &Values::Each(vec![0, 1]));
        assert_eq!(constant(&lattice, &edges, [1, 0, 0], [1, 1, 0])[0], 0.5 + 15.0, "of two materials");
        let (_, Assembled { links: [edges, ..], .. }) = pair_of(Some(vec![0.3, 0.77]), &Values::Uniform(0));
        let largest = 0.25 * 0.77 * 4.0 + 0.25 * 0.3 * 4.0;
        assert!(edges.stiffness <= largest && edges.stiffness > 0.98 * largest, "rounded down: {}", edges.stiffness);
    }

    #[test]
    fn a_body_may_be_of_two_materials() {
        let (lattice, Assembled { masses, links: [edges, diagonals, _], .. }) = pair(&Values::Each(vec![0, 1]));
        assert_eq!(constant(&lattice, &edges, [0, 0, 0], [1, 0, 0]), [1.0, 0.1], "the soft cell's own edge");
        assert_eq!(constant(&lattice, &edges, [1, 0, 0], [2, 0, 0]), [10.0, 1.0], "the hard cell's own edge");
        assert_eq!(constant(&lattice, &edges, [1, 0, 0], [1, 1, 0])[0], 11.0, "a quarter of each between them");
        assert_eq!(constant(&lattice, &diagonals, [1, 0, 0], [1, 1, 1])[0], 11.0, "half of each between them");
        assert_eq!((masses.of(0), masses.of(1), masses.of(2)), (1.0, 11.0, 10.0), "light, shared, heavy");
    }
}
