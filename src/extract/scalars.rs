//! The quantities that bodies are coloured by: those of the simulation that a colour map of the document shows.

use crate::math::Real;
use crate::physics::{Quantity, Simulation};
use crate::scene::ColorBy;

/// The scalar of every particle in the unit of [`ColorBy::unit`]; `None`, without any computation, if no map is shown.
pub fn scalars<R: Real>(simulation: &Simulation<R>, color: ColorBy) -> Option<Vec<f32>> {
    let quantity = match color {
        ColorBy::Plain | ColorBy::Model => return None,
        ColorBy::Load => Quantity::MeanLinkForce,
        ColorBy::Force => Quantity::LinkForce,
        ColorBy::Net => Quantity::NetForce,
        ColorBy::Strain => Quantity::Strain,
        ColorBy::Speed => Quantity::Speed,
        ColorBy::Contact => Quantity::ContactForce,
        ColorBy::Stiffness => Quantity::Modulus,
    };
    Some(simulation.scalars(quantity))
}
