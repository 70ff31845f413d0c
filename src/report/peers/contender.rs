//! The contenders of the comparison, and the materials of the peers.

use serde::{Serialize, Serializer};

use super::cube::Cube;
use crate::report::error::SteppingMethod;
use crate::scene::settings::Integrator;
use crate::scene::{Material, Solid};

/// The damping ratio of a peer's cells while it is brought to rest.
const CELLS_DAMPING_RATIO: f64 = 0.1;

/// A soft body of another engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Peer {
    /// Edges made from our links.
    Links,
    /// Elastic cells, solved as constraints.
    Cells,
    /// Elastic cells, solved as finite elements by implicit Euler steps.
    Elements,
}

impl Peer {
    /// All peers.
    pub const ALL: [Self; 3] = [Self::Links, Self::Cells, Self::Elements];

    /// The peer's material before it is tuned: our links, or cells of our modulus.
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

/// The material of a peer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tuning {
    /// Stiffness as a multiple of our links', or Young's modulus, Pa.
    pub(super) stiffness: f64,
    /// Damping as a multiple of our links', or the damping ratio of the cells.
    pub(super) damping: f64,
    /// Rate at which every particle loses speed, 1/s; brings a body to rest.
    pub(super) drag: f64,
}

/// An engine, and the way it takes its steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contender {
    /// Gelatin.
    Ours(SteppingMethod),
    /// Another engine.
    Peer(Peer),
}

impl Contender {
    /// All contenders, ours first.
    pub const ALL: [Self; 5] = [
        Self::Ours(SteppingMethod::Automatic),
        Self::Ours(SteppingMethod::Manual(Integrator::Verlet)),
        Self::Peer(Peer::Links),
        Self::Peer(Peer::Cells),
        Self::Peer(Peer::Elements),
    ];

    /// The name in tables and pictures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ours(SteppingMethod::Automatic) => "Gelatin, automatic",
            Self::Ours(SteppingMethod::Manual(Integrator::Verlet)) => "Gelatin, Verlet",
            Self::Ours(method) => method.name(),
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
