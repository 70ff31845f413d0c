//! Models whose meshes meet obstacles, as scenes to begin from.

use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

use gelatin::geometry::embed::{Embedder, Embedding};
use gelatin::geometry::{Lattice, TriMesh};
use gelatin::math::{Real, Vector};
use gelatin::physics::Simulation;
use gelatin::scene::body::{ModelShape, Pose};
use gelatin::scene::resolve::resolve;
use gelatin::scene::{Body, ContactOn, Material, Obstacle, Scene, Shape};
use glam::DVec3;

use crate::support::{falling, run};

/// A scene of one model over nothing, and its lattice.
pub(crate) struct Made {
    pub(crate) scene: Scene,
    pub(crate) lattice: Arc<Lattice>,
}

impl Made {
    /// A model that meets obstacles with its mesh, with its middle at `position`.
    pub(crate) fn of(shape: ModelShape, material: Material, position: [f64; 3]) -> Self {
        let shape = Shape::Model(shape);
        let lattice = resolve(&shape, Path::new("."), &()).expect("a sound model").lattice;
        let pose = Pose { position, ..Pose::default() };
        let body = Body { shape, material, pose, contact_on: ContactOn::Mesh, ..Body::default() };
        Self { scene: falling(body), lattice }
    }

    /// As [`Made::of`], for a model given as the text of an OBJ file.
    pub(crate) fn of_text(obj: &str, divisions: u32, material: Material, position: [f64; 3]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("model.obj");
        std::fs::write(&path, obj).expect("a file");
        let path = path.to_string_lossy().into_owned();
        Self::of(ModelShape { path, divisions, ..ModelShape::default() }, material, position)
    }

    pub(crate) fn spot(position: [f64; 3]) -> Self {
        let path = "assets/spot.obj".to_owned();
        Self::of(ModelShape { path, divisions: 20, ..ModelShape::default() }, Material::default(), position)
    }

    pub(crate) fn on(mut self, obstacle: Obstacle) -> Self {
        self.scene.obstacles.push(obstacle);
        self
    }

    pub(crate) fn simulate<R: Real>(&self) -> Simulation<R> {
        Simulation::new(&self.scene, &[Arc::clone(&self.lattice)])
    }

    pub(crate) fn mesh(&self) -> &TriMesh {
        self.lattice.mesh.as_ref().expect("a model has a mesh")
    }

    /// The vertices of the mesh on the body as it is now, m.
    pub(crate) fn vertices<R: Real>(&self, simulation: &Simulation<R>) -> Vec<DVec3> {
        let embedded = Embedder::new(&self.lattice).embed_all(&self.mesh().positions).expect("finite");
        let at = |Embedding { particles, weights, .. }: &Embedding| {
            let terms = particles.iter().zip(weights);
            terms.map(|(particle, weight)| simulation.state().position[*particle as usize].to_dvec3() * *weight).sum()
        };
        embedded.iter().map(at).collect()
    }

    pub(crate) fn lowest<R: Real>(&self, simulation: &Simulation<R>) -> f64 {
        self.vertices(simulation).iter().map(|at| at.y).fold(f64::INFINITY, f64::min)
    }
}

/// A ball of 1 m diameter with `strips` strips from pole to pole.
pub(crate) fn ball_obj(strips: u32) -> String {
    let mut text = String::new();
    let around = 2 * strips;
    let angle = |of: u32| std::f64::consts::PI * f64::from(of) / f64::from(strips);
    for strip in 0..=strips {
        for place in 0..around {
            let (radius, height) = (0.5 * angle(strip).sin(), 0.5 * angle(strip).cos());
            let (x, z) = (radius * angle(place).cos(), radius * angle(place).sin());
            writeln!(text, "v {x} {height} {z}").expect("a text");
        }
    }
    for (strip, place) in (0..strips).flat_map(|strip| (0..around).map(move |place| (strip, place))) {
        let at = |strip: u32, place: u32| strip * around + place % around + 1;
        let [a, b] = [at(strip, place), at(strip, place + 1)];
        let [c, d] = [at(strip + 1, place), at(strip + 1, place + 1)];
        writeln!(text, "f {a} {b} {d} {c}").expect("a text");
    }
    text
}

/// A box of 1 m × 0.6 m × 0.8 m, six squares.
pub(crate) fn box_obj() -> String {
    let mut text = String::new();
    for corner in 0..8 {
        let end = |axis: usize, half: f64| if corner >> axis & 1 == 1 { half } else { -half };
        writeln!(text, "v {} {} {}", end(0, 0.5), end(1, 0.3), end(2, 0.4)).expect("a text");
    }
    text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
}

/// Returns the height of the lowest point of the mesh, m, of a ball of 1 m that was let down on an obstacle of 1 m.
pub(crate) fn ball_on(obstacle: Obstacle, material: Material) -> f64 {
    let made = Made::of_text(&ball_obj(24), 6, material, [0.0, 1.52, 0.0]).on(obstacle);
    let mut simulation = made.simulate::<f64>();
    run(&mut simulation, 1.0);
    made.lowest(&simulation)
}
