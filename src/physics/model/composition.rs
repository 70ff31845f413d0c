//! What the links and particles of a body have from its cells.

use std::sync::Arc;

use super::cell_kind::CellKind;
use super::link::LinkFamily;
use crate::math::Real;
use crate::physics::limits::particles::ParticleLoads;

/// What a body is composed of.
#[derive(Clone, Debug)]
pub(in crate::physics) enum Composition {
    /// Every link of a family is alike, and every particle weighs alike.
    Alike,
    /// Of cells of solids, which share out links and masses.
    Solids {
        /// The body's own, whether it occurs or not, and the others that occur.
        kinds: Vec<CellKind>,
        /// The largest load of its cells together over that of one of them alone, at most 1: below it only where all cells
        /// are of one kind and not too many.
        load_share: f64,
    },
    /// Of cells of several springs, of which links and particles have the mean.
    Springs {
        /// What limits the step.
        loads: Arc<ParticleLoads>,
        /// Of which material each kind of cells is: 0 of the body's own, then of its parts and of its inlays, as they follow one
        /// another.
        numbers: Vec<u8>,
    },
}

impl Composition {
    /// The largest load of its cells together over that of one of them alone, at most 1.
    pub(in crate::physics) fn load_share(&self) -> f64 {
        match self {
            Self::Solids { load_share, .. } => *load_share,
            Self::Alike | Self::Springs { .. } => 1.0,
        }
    }

    /// The kinds of its cells, the body's own first, whether it occurs or not; none where all is alike.
    pub(in crate::physics) fn kinds(&self) -> &[CellKind] {
        match self {
            Self::Alike => &[],
            Self::Solids { kinds, .. } => kinds,
            Self::Springs { loads, .. } => loads.kinds(),
        }
    }
}

/// The constants of links by family in an endless lattice of alike cells; 0 of a family of which the body has no links.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct LatticeConstants {
    /// Force at 100 % strain, N.
    pub(in crate::physics) stiffness: [f64; 3],
    /// Force at a relative speed of one rest length a second, N·s.
    pub(in crate::physics) damping: [f64; 3],
}

impl Composition {
    /// The lattices that a body of these links is made of: one, or one for each kind of its cells.
    pub(in crate::physics) fn lattices<R: Real>(
        &self,
        links: &[LinkFamily<R>; 3],
    ) -> impl Iterator<Item = LatticeConstants> {
        let has_links = links.each_ref().map(|family| !family.links.is_empty());
        let of_links = move |constants: [f64; 3]| {
            std::array::from_fn(|family| if has_links[family] { constants[family] } else { 0.0 })
        };
        let kinds = self.kinds();
        let alike = kinds.is_empty().then(|| LatticeConstants {
            stiffness: of_links(links.each_ref().map(|family| family.stiffness.to_f64())),
            damping: of_links(links.each_ref().map(|family| family.damping.to_f64())),
        });
        let each = kinds
            .iter()
            .map(move |kind| LatticeConstants { stiffness: of_links(kind.stiffness), damping: of_links(kind.damping) });
        alike.into_iter().chain(each)
    }
}
