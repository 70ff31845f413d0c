//! The bodies of a scene made ready: lattices to simulate, skins to draw. What an edit leaves alone is kept.

use std::sync::Arc;

use serde::Serialize;

use super::document::Opened;
use super::shape_cache::ShapeCache;
use super::{SessionError, memory};
use crate::extract::skin::{cells_skin, model_skin};
use crate::geometry::part_cells::PartCount;
use crate::geometry::{Lattice, Paint, Watch};
use crate::scene::param::Problem;
use crate::scene::part_problem::part_problem;
use crate::scene::resolve::{Jelly, Outline};
use crate::scene::{Body, Material, Scene, Shape, Skin as SkinChoice};
use crate::view::{Skin, SkinInstance, Style};

/// The bodies of a scene, made ready.
#[derive(Clone, Debug, Default)]
pub(super) struct Bodies {
    jellies: Vec<Jelly>,
    body_skins: Vec<BodySkin>,
    /// The empty skin, for a body that has left the scene.
    empty_skin: Arc<Skin>,
}

/// The parts of a body's model that have names. Field names are the keys of the JSON report.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct BodyParts {
    /// The body's place in the scene.
    pub body: usize,
    /// Its parts in the order of the model's file.
    pub parts: Vec<PartCount>,
}

/// A visible body's skin and what it was made from.
#[derive(Clone, Debug)]
struct BodySkin {
    body: usize,
    lattice: Arc<Lattice>,
    choice: SkinChoice,
    first_particle: u32,
    skin: Arc<Skin>,
}

impl Bodies {
    /// Makes the shape of every body ready, without skins yet. Refuses the scene before that if its bodies need more memory
    /// together than there is.
    pub(super) fn resolve(
        scene: &Scene,
        shape_cache: &mut ShapeCache,
        watch: &dyn Watch,
    ) -> Result<Self, SessionError> {
        let outlines = outlines(scene, shape_cache, watch);
        let checked = outlines.and_then(|outlines| {
            watch.expect_particles(outlines.iter().map(|outline| outline.counts.particles).sum());
            memory::check_memory(scene, &outlines)
        });
        let resolved = checked.and_then(|()| Self::resolve_unchecked(scene, shape_cache, watch));
        shape_cache.forget_filled();
        resolved
    }

    fn resolve_unchecked(scene: &Scene, shape_cache: &mut ShapeCache, watch: &dyn Watch) -> Result<Self, SessionError> {
        let resolve_one = |(index, body): (usize, &Body)| {
            let made = shape_cache.get(&body.shape, watch).map_err(|source| SessionError::Shape { index, source })?;
            made.ok_or(SessionError::Stopped)
        };
        let jellies = scene.bodies.iter().enumerate().map(resolve_one).collect::<Result<_, _>>()?;
        let bodies = Self { jellies, ..Self::default() };
        bodies.part_problem(scene).map_or(Ok(bodies), |problem| Err(SessionError::Part(problem)))
    }

    /// Returns the first named part in a scene of the same bodies that its model does not have.
    pub(super) fn part_problem(&self, scene: &Scene) -> Option<Problem> {
        let mut bodies = scene.bodies.iter().zip(&self.jellies).enumerate();
        bodies.find_map(|(place, (body, jelly))| part_problem(place, body, &jelly.lattice))
    }

    /// The bodies whose models have parts with names, and their parts.
    pub(super) fn named_parts(&self) -> Vec<BodyParts> {
        let of_one = |(body, jelly): (usize, &Jelly)| BodyParts { body, parts: jelly.lattice.part_counts() };
        let all = self.jellies.iter().enumerate().map(of_one);
        all.filter(|of_one| !of_one.parts.is_empty()).collect()
    }

    /// Returns these bodies with the skins of others at hand for the next [`Bodies::update_skins`].
    pub(super) fn with_skins_of(self, others: &Self) -> Self {
        Self { body_skins: others.body_skins.clone(), empty_skin: Arc::clone(&others.empty_skin), ..self }
    }

    /// Gives every visible body its skin, for a scene of the same bodies; skins that fit are kept.
    pub(super) fn update_skins(&mut self, scene: &Scene) {
        let old = std::mem::take(&mut self.body_skins);
        let mut first_particle = 0u32;
        for (index, (body, jelly)) in scene.bodies.iter().zip(&self.jellies).enumerate() {
            let lattice = &jelly.lattice;
            if !body.hidden {
                let fits = |body_skin: &&BodySkin| {
                    Arc::ptr_eq(&body_skin.lattice, lattice)
                        && (body_skin.choice, body_skin.first_particle) == (body.skin, first_particle)
                };
                let skin = match old.iter().find(fits) {
                    Some(body_skin) => Arc::clone(&body_skin.skin),
                    None => Arc::new(match (&jelly.mesh, body.skin) {
                        (Some(mesh), SkinChoice::Auto) => {
                            model_skin(lattice, mesh, jelly.paint.as_deref(), jelly.shading.as_deref(), first_particle)
                        }
                        _ => cells_skin(lattice, first_particle),
                    }),
                };
                let lattice = Arc::clone(lattice);
                self.body_skins.push(BodySkin { body: index, lattice, choice: body.skin, first_particle, skin });
            }
            first_particle += u32::try_from(lattice.corners.len()).unwrap_or(u32::MAX);
        }
    }

    /// How large the bodies are, in the scene's order.
    pub(super) fn outlines(&self) -> Vec<Outline> {
        self.jellies.iter().map(Jelly::outline).collect()
    }

    /// The memory of the pictures on the models, bytes; a shared picture counts once.
    pub(super) fn picture_bytes(&self) -> u64 {
        let paints = self.jellies.iter().filter_map(|jelly| jelly.paint.as_deref());
        let pictures: Vec<_> = paints.flat_map(Paint::textures).map(|texture| &texture.picture).collect();
        let is_first = |place: usize| !pictures[..place].iter().any(|other| Arc::ptr_eq(other, pictures[place]));
        pictures.iter().enumerate().filter(|(place, _)| is_first(*place)).map(|(_, picture)| picture.bytes()).sum()
    }

    /// The lattices, in the scene's order.
    pub(super) fn lattices(&self) -> Vec<Arc<Lattice>> {
        self.jellies.iter().map(|jelly| Arc::clone(&jelly.lattice)).collect()
    }

    /// The skins of the visible bodies, in the scene's order; an empty one for a body that has left the scene.
    pub(super) fn skins(&self, is_there: impl Fn(usize) -> bool) -> Vec<SkinInstance> {
        let style = Style::default();
        let instance = |body_skin: &BodySkin| {
            let skin =
                if is_there(body_skin.body) { Arc::clone(&body_skin.skin) } else { Arc::clone(&self.empty_skin) };
            SkinInstance { skin, color: style.body(body_skin.body) }
        };
        self.body_skins.iter().map(instance).collect()
    }

    /// The longest extent of a body's model, m; 1 where it has none.
    pub(super) fn model_length(&self, body: usize) -> f64 {
        let mesh = self.jellies.get(body).and_then(|jelly| jelly.mesh.as_ref());
        mesh.map_or(1.0, |mesh| mesh.bounds().size().max_element())
    }

    /// Warnings about the models of a scene's bodies, a sentence each.
    pub(super) fn warnings(&self, scene: &Scene) -> Vec<String> {
        let of_one = |(jelly, body): (&Jelly, &Body)| match &body.material {
            Material::Springs(_) => jelly.warnings.clone(),
            Material::Solid(_) => [&jelly.warnings[..], &jelly.mass_warnings].concat(),
        };
        self.jellies.iter().zip(&scene.bodies).flat_map(of_one).collect()
    }
}

impl Opened {
    /// The lattices of the scene's bodies, for a caller that needs no session.
    ///
    /// # Errors
    /// If a shape cannot be made, or all of them together need more memory than there is.
    pub fn lattices(&self, watch: &dyn Watch) -> Result<Vec<Arc<Lattice>>, SessionError> {
        let mut shape_cache = ShapeCache::new(self.base_dir.clone());
        shape_cache.set_embedded(&self.scene.models);
        Ok(Bodies::resolve(&self.scene, &mut shape_cache, watch)?.lattices())
    }
}

/// How large every body will be; equal shapes are looked at once.
fn outlines(scene: &Scene, shape_cache: &mut ShapeCache, watch: &dyn Watch) -> Result<Vec<Outline>, SessionError> {
    let mut known: Vec<(&Shape, Outline)> = Vec::new();
    let mut outlines = Vec::new();
    for (index, body) in scene.bodies.iter().enumerate() {
        let outline = if let Some((_, outline)) = known.iter().find(|(shape, _)| **shape == body.shape) {
            *outline
        } else {
            let found = shape_cache.outline(&body.shape, watch);
            let outline = found.map_err(|source| SessionError::Shape { index, source })?;
            known.push((&body.shape, outline));
            outline
        };
        outlines.push(outline);
    }
    Ok(outlines)
}
