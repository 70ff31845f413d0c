//! From a document to a running simulation, and from the document as it was edited to one that goes on.

use std::path::Path;
use std::sync::Arc;

use thiserror::Error;

use super::compile;
use crate::geometry::Lattice;
use crate::math::Real;
use crate::physics::simulation::{Arrival, Simulation};
use crate::scene::Scene;
use crate::scene::param::{self, Problem};
use crate::scene::resolve::{ResolveError, resolve};

/// Why a scene cannot be simulated.
#[derive(Debug, Error)]
pub enum SceneError {
    /// A value is not allowed.
    #[error(transparent)]
    Value(#[from] Problem),
    /// A shape gives no particles.
    #[error("bodies.{body}: its shape cannot be made of cells")]
    Shape {
        /// Its place among the bodies, from 0.
        body: usize,
        /// Why.
        source: ResolveError,
    },
}

impl<R: Real> Simulation<R> {
    /// A scene at its start. Model files are looked for in `folder`, read and filled with cells.
    ///
    /// # Errors
    /// The first value that is not allowed, by its path, or the first body whose shape cannot be made of cells.
    pub fn from_scene(scene: &Scene, folder: &Path) -> Result<Self, SceneError> {
        if let Some(problem) = param::validate(scene).into_iter().next() {
            return Err(problem.into());
        }
        let lattices = scene.bodies.iter().enumerate().map(|(body, described)| {
            let jelly = resolve(&described.shape, folder, &());
            jelly.map(|jelly| jelly.lattice).map_err(|source| SceneError::Shape { body, source })
        });
        Ok(Self::new(scene, &lattices.collect::<Result<Vec<_>, _>>()?))
    }

    /// A scene at its start. `lattices` are those of the scene's bodies, in their order.
    pub fn new(scene: &Scene, lattices: &[Arc<Lattice>]) -> Self {
        let (model, plan) = compile(scene, lattices, None);
        Self::start(model, plan)
    }

    /// Takes new parameters, obstacles and settings while everything keeps moving: the scene must have the bodies
    /// and lattices it had. `kept` names, for each obstacle of the scene, the one it was.
    pub fn set_parameters(
        &mut self,
        scene: &Scene,
        lattices: &[Arc<Lattice>],
        kept: &[Option<usize>],
        arrival: Arrival,
    ) {
        let (model, plan) = compile(scene, lattices, Some(self.model()));
        self.replace_model(model, plan, kept, arrival);
    }
}

#[cfg(test)]
mod tests {
    use std::error::Error;

    use super::*;
    use crate::scene::body::{Body, ModelShape, Shape};

    fn refused(change: impl FnOnce(&mut Scene)) -> String {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        change(&mut scene);
        let error = Simulation::<f32>::from_scene(&scene, Path::new(".")).expect_err("it is refused");
        let cause = error.source().map_or_else(String::new, |cause| format!(": {cause}"));
        format!("{error}{cause}")
    }

    #[test]
    fn what_cannot_be_simulated_is_refused_by_its_path() {
        let said = refused(|scene| scene.settings.dt = -1.0);
        assert!(said.starts_with("settings.dt = "), "{said}");
        let shape = ModelShape { path: "no-such-file.obj".to_owned(), ..ModelShape::default() };
        let said = refused(|scene| scene.bodies[0].shape = Shape::Model(shape));
        assert!(said.starts_with("bodies.0: ") && said.contains("no-such-file.obj"), "{said}");
    }
}
