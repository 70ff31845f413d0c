//! Shapes that have been made ready, so that none is filled with cells twice: not when its body is edited, not when it
//! comes back by undo, though its file may be gone by then.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::cancellation::run_until_cancelled;
use crate::geometry::Watch;
use crate::scene::body::ModelShape;
use crate::scene::resolve::{Filled, Jelly, ModelPlaces, Outline, ResolveError, fill};
use crate::scene::{Embedded, Shape, embedded};

/// Shapes kept; the one that was not asked for longest goes first.
const MAX_SHAPES: usize = 64;

/// Models kept as they were filled, so that cells can be changed by hand one after another; the oldest goes first.
const MAX_MODELS: usize = 4;

/// Shapes that have been made ready, the one asked for last at the end.
#[derive(Clone, Debug, Default)]
pub(super) struct ShapeCache {
    base_dir: PathBuf,
    /// Model files within the scene.
    embedded: Embedded,
    entries: Vec<(Shape, Jelly)>,
    /// Models that are filled but whose lattices are not built yet, which takes long.
    filled: Vec<(Shape, Filled)>,
    /// Models as they were filled, without what was changed by hand.
    models: Vec<(ModelShape, Filled)>,
}

impl ShapeCache {
    /// An empty one; relative model paths start at `base_dir`.
    pub(super) fn new(base_dir: PathBuf) -> Self {
        Self { base_dir, embedded: Embedded::default(), entries: Vec::new(), filled: Vec::new(), models: Vec::new() }
    }

    /// Sets the model files within the scene; forgets shapes made from those of another scene.
    pub(super) fn set_embedded(&mut self, embedded: &Embedded) {
        if self.embedded != *embedded {
            self.entries.retain(|(shape, _)| !is_embedded(shape));
            self.filled.retain(|(shape, _)| !is_embedded(shape));
            self.models.retain(|(model, _)| !model.path.starts_with(embedded::PREFIX));
            self.embedded = embedded.clone();
        }
    }

    /// Where models are.
    fn model_places(&self) -> ModelPlaces<'_> {
        ModelPlaces { base_dir: &self.base_dir, embedded: Some(&self.embedded) }
    }

    /// The folder that relative model paths start at.
    pub(super) fn base_dir(&self) -> &Path {
        &self.base_dir
    }

    /// Returns how large a shape is, without building it.
    pub(super) fn outline(&mut self, shape: &Shape, watch: &dyn Watch) -> Result<Outline, ResolveError> {
        if let Some((_, jelly)) = self.entries.iter().find(|(known, _)| known == shape) {
            return Ok(jelly.outline());
        }
        let filled = self.fill(shape, watch)?;
        let outline = filled.outline();
        if matches!(shape, Shape::Model(_)) {
            self.filled.push((shape.clone(), filled));
        }
        Ok(outline)
    }

    /// Forgets shapes that were filled and are not used.
    pub(super) fn forget_filled(&mut self) {
        self.filled.clear();
    }

    /// Returns the shape made ready, now or earlier; none once nobody waits for it.
    pub(super) fn get(&mut self, shape: &Shape, watch: &dyn Watch) -> Result<Option<Jelly>, ResolveError> {
        if let Some(place) = self.entries.iter().position(|(known, _)| known == shape) {
            let known = self.entries.remove(place);
            self.entries.push(known);
        } else {
            let filled = match self.filled.iter().position(|(known, _)| known == shape) {
                Some(place) => self.filled.remove(place).1,
                None => self.fill(shape, watch)?,
            };
            let Some(jelly) = run_until_cancelled(watch, || filled.build()) else { return Ok(None) };
            self.insert(shape.clone(), jelly);
        }
        Ok(self.entries.last().map(|(_, jelly)| jelly.clone()))
    }

    /// Fills a shape. A model is filled once; changes made by hand are applied to a copy of it.
    fn fill(&mut self, shape: &Shape, watch: &dyn Watch) -> Result<Filled, ResolveError> {
        let Shape::Model(model) = shape else { return fill(shape, self.model_places(), watch) };
        let own = model.without_changes();
        if let Some((_, filled)) = self.models.iter().find(|(known, _)| *known == own) {
            return filled.clone().with_manual_changes(model);
        }
        let filled = fill(&Shape::Model(own.clone()), self.model_places(), watch)?;
        if self.models.len() == MAX_MODELS {
            self.models.remove(0);
        }
        self.models.push((own, filled.clone()));
        filled.with_manual_changes(model)
    }

    /// Takes a shape that was made ready elsewhere. Shapes of one model share its pictures.
    pub(super) fn insert(&mut self, shape: Shape, mut jelly: Jelly) {
        self.entries.retain(|(known, _)| *known != shape);
        if let Some(paint) = jelly.paint.as_mut().filter(|paint| !paint.textures().is_empty()) {
            Arc::make_mut(paint).share_pictures(self.entries.iter().filter_map(|(_, jelly)| jelly.paint.as_deref()));
        }
        self.entries.push((shape, jelly));
        if self.entries.len() > MAX_SHAPES {
            self.entries.remove(0);
        }
    }
}

/// Whether a shape is a model within the scene.
fn is_embedded(shape: &Shape) -> bool {
    matches!(shape, Shape::Model(model) if model.path.starts_with(embedded::PREFIX))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scene::body::{CubeShape, ModelShape};

    #[test]
    fn a_shape_is_made_ready_once_and_outlives_its_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("box.obj");
        let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        std::fs::write(&file, triangle).expect("a file");
        let shape = Shape::Model(ModelShape { path: "box.obj".into(), divisions: 3, ..ModelShape::default() });
        let mut shape_cache = ShapeCache::new(folder.path().to_owned());
        let first = shape_cache.get(&shape, &()).expect("a flat model").expect("it is waited for");
        std::fs::remove_file(&file).expect("the file is there");
        let second = shape_cache.get(&shape, &()).expect("it is remembered").expect("it is waited for");
        assert!(Arc::ptr_eq(&first.lattice, &second.lattice), "the very same lattice");
    }

    #[test]
    fn the_shape_that_was_not_asked_for_longest_is_forgotten() {
        let cube = |cells| Shape::Cube(CubeShape { cells, size: 1.0 });
        let mut shape_cache = ShapeCache::default();
        for cells in 1..=64 {
            shape_cache.get(&cube(cells.min(2) + cells / 40), &()).expect("a cube");
        }
        assert!(shape_cache.entries.len() <= 4, "equal shapes count once");
        for size in 0..70 {
            let shape = Shape::Cube(CubeShape { cells: 1, size: 1.0 + f64::from(size) });
            shape_cache.get(&shape, &()).expect("a cube");
        }
        assert_eq!(shape_cache.entries.len(), MAX_SHAPES, "no more are kept");
        assert!(shape_cache.entries.iter().all(|(shape, _)| *shape != cube(2)), "the oldest ones are gone");
    }
}
