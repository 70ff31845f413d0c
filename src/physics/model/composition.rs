//! What the links and particles of a body have from its cells.

use std::sync::Arc;

use super::cell_kind::CellKind;
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
