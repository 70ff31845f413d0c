//! Who is compared, and what a peer is made of.

use serde::{Serialize, Serializer};

use super::cube::Cube;
use crate::report::error::Way;
use crate::scene::settings::Integrator;
use crate::scene::{Material, Solid};

/// The damping ratio of its cells with which a peer is brought to rest.
const CELLS_DAMPING_RATIO: f64 = 0.1;

/// A soft body of another engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Peer {
    /// Our links as its edges.
    Links,
    /// Its elastic cells, solved as constraints.
    Cells,
    /// Its elastic cells, solved as finite elements by implicit Euler steps.
    Elements,
}

impl Peer {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Links, Self::Cells, Self::Elements];

    /// What it is made of before it is tuned: our links, or cells of our modulus.
    pub(super) fn start(self, cube: &Cube) -> Tuning {
        let Some(Material::Solid(Solid { young_modulus, .. })) = cube.scene.bodies.first().map(|body| &body.material)
        else {
            return Tuning { stiffness: 1.0, damping: 1.0, drag: 0.0 };
        };
        match self {
            Self::Links => Tuning { stiffness: 1.0, damping: 1.0, drag: 0.0 },
            Self::Cells | Self::Elements => {
                Tuning { stiffness: *young_modulus, damping: CELLS_DAMPING_RATIO, drag: 0.0 }
            }
        }
    }
}

/// What a peer is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tuning {
    /// Over that of our links, or Young's modulus, Pa.
    pub(super) stiffness: f64,
    /// Over that of our links, or the damping ratio of the cells.
    pub(super) damping: f64,
    /// Rate at which every particle loses speed, 1/s: to bring a body to rest.
    pub(super) drag: f64,
}

/// Who takes the steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contender {
    /// Gelatin.
    Ours(Way),
    /// Another engine.
    Peer(Peer),
}

impl Contender {
    /// All of them: ours first.
    pub const ALL: [Self; 5] = [
        Self::Ours(Way::Automatic),
        Self::Ours(Way::Manual(Integrator::Verlet)),
        Self::Peer(Peer::Links),
        Self::Peer(Peer::Cells),
        Self::Peer(Peer::Elements),
    ];

    /// The name in tables and pictures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ours(Way::Automatic) => "Gelatin, automatic",
            Self::Ours(Way::Manual(Integrator::Verlet)) => "Gelatin, Verlet",
            Self::Ours(way) => way.name(),
            Self::Peer(Peer::Links) => "rapier, our links",
            Self::Peer(Peer::Cells) => "rapier, cells",
            Self::Peer(Peer::Elements) => "rapier, finite elements",
        }
    }
}

impl Serialize for Contender {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl Serialize for Peer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Contender::Peer(*self).serialize(serializer)
    }
}
