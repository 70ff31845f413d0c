//! An obstacle in the form of a model, and what was read of the model's file.

use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::geometry::{Surface, UpAxis, import};
use crate::scene::builtin;

/// A model as an obstacle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Mesh {
    /// The model file, relative to the scene file; `builtin:NAME` for one that the program carries.
    pub path: String,
    /// The middle of the model's box, m.
    pub center: [f64; 3],
    /// Euler angles about x, then y, then z (fixed axes), degrees.
    pub rotation_deg: [f64; 3],
    /// Longest extent after scaling, m; 0 keeps the file's own size.
    pub length: f64,
    /// The axis of the file's own coordinates that points up.
    pub up: UpAxis,
    /// What the file holds, once it is read.
    #[serde(skip)]
    pub loaded: Loaded,
}

impl Default for Mesh {
    fn default() -> Self {
        Self {
            path: String::new(),
            center: [0.0, 0.5, 0.0],
            rotation_deg: [0.0; 3],
            length: 1.0,
            up: UpAxis::Y,
            loaded: Loaded::default(),
        }
    }
}

/// The surface of a model's file, kept with the obstacle so that the file is read once and an undone edit does not need it
/// again. It follows from the path, so comparing obstacles ignores it.
#[derive(Clone, Debug, Default)]
pub struct Loaded(Option<LoadedSurface>);

#[derive(Clone, Debug)]
struct LoadedSurface {
    path: String,
    up: UpAxis,
    surface: Arc<Surface>,
}

impl PartialEq for Loaded {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Mesh {
    /// Returns the surface, scaled to a longest extent of 1; none until the file is read.
    pub fn surface(&self) -> Option<Arc<Surface>> {
        let held = self.loaded.0.as_ref().filter(|held| held.path == self.path && held.up == self.up);
        held.map(|held| Arc::clone(&held.surface)).or_else(|| builtin_surface(&self.path, self.up))
    }

    /// Keeps the surface read from its file.
    pub fn load(&mut self, surface: Arc<Surface>) {
        self.loaded = Loaded(Some(LoadedSurface { path: self.path.clone(), up: self.up, surface }));
    }

    /// Returns the metres per unit of the surface, which is its longest extent.
    pub fn scale(&self, surface: &Surface) -> f64 {
        if self.length > 0.0 { self.length } else { surface.own_length() }
    }

    /// Returns half the extents of its box in its own axes, m; those of a cube until the file is read.
    pub fn half_extents(&self) -> DVec3 {
        let of = |surface: Arc<Surface>| surface.half_extents() * self.scale(&surface);
        self.surface().map_or_else(|| DVec3::splat(0.5 * self.length), of)
    }
}

/// Returns the surface of a model that the program carries; each is made once.
fn builtin_surface(path: &str, up: UpAxis) -> Option<Arc<Surface>> {
    static BUILTIN_SURFACES: Mutex<Vec<(String, UpAxis, Arc<Surface>)>> = Mutex::new(Vec::new());
    let bytes = builtin::model(path.strip_prefix(builtin::PREFIX)?)?;
    let mut made = BUILTIN_SURFACES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((.., surface)) = made.iter().find(|(known, known_up, _)| known == path && *known_up == up) {
        return Some(Arc::clone(surface));
    }
    let mut mesh = import::parse_obj(bytes, path).ok()?.mesh;
    up.found(&mesh).turn(&mut mesh);
    let surface = Arc::new(Surface::new(&mesh).ok()?);
    made.push((path.to_owned(), up, Arc::clone(&surface)));
    Some(surface)
}
