//! How the constants of a body's links and particles follow from its cells.

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
    /// Cells of solids: each gives a share to its links and particles.
    Solids {
        /// The body's own kind, even if no cell is of it, and the other kinds that occur.
        kinds: Vec<CellKind>,
        /// The largest load of the cells together over that of a single cell, at most 1; less only where all cells are of
        /// one kind and not too many.
        load_share: f64,
    },
    /// Cells of several springs: links and particles have the mean over their cells.
    Springs {
        /// The loads that limit the step.
        loads: Arc<ParticleLoads>,
        /// The number of each kind's material: 0 for the body's own, then its parts, then its inlays, in their order.
        numbers: Vec<u8>,
    },
}

impl Composition {
    /// The largest load of the cells together over that of a single cell, at most 1.
    pub(in crate::physics) fn load_share(&self) -> f64 {
        match self {
            Self::Solids { load_share, .. } => *load_share,
            Self::Alike | Self::Springs { .. } => 1.0,
        }
    }

    /// The kinds of its cells, the body's own first, even if no cell is of it; empty where all is alike.
    pub(in crate::physics) fn kinds(&self) -> &[CellKind] {
        match self {
            Self::Alike => &[],
            Self::Solids { kinds, .. } => kinds,
            Self::Springs { loads, .. } => loads.kinds(),
        }
    }
}

/// The constants of links by family in an endless lattice of alike cells; 0 for a family without links.
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
