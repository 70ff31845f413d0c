//! Names of parts that a model does not have.

use super::param::Problem;
use super::resolve::MAX_NAMES_LISTED;
use super::{Body, Shape};
use crate::geometry::Lattice;
use crate::text::{echo, listed};

/// Returns the problem of the first named part of a body that its model does not have.
pub fn part_problem(place: usize, body: &Body, lattice: &Lattice) -> Option<Problem> {
    let names = lattice.parts.as_ref().map(|parts| &parts.names);
    let at = body.parts.iter().position(|part| !names.is_some_and(|names| names.has(&part.name)))?;
    let why = match (&body.shape, names) {
        (Shape::Model(_), Some(names)) => {
            let names = names.names().iter().map(|name| format!("\"{name}\""));
            format!("is no part of the model, which has {}", listed(names, MAX_NAMES_LISTED))
        }
        (Shape::Model(_), None) => "is no part of the model, whose file names none".to_owned(),
        _ => "is no part: only a model has parts with names".to_owned(),
    };
    let message = format!("\"{}\" {why}", echo(&body.parts[at].name));
    Some(Problem { path: format!("bodies.{place}.parts.{at}.name"), message })
}
