//! Data on the device between frames: particles, scalars and skins, uploaded only when they are new.

use std::ops::Range;
use std::sync::Arc;

use super::buffer::filled;
use super::error::RenderError;
use super::layout::{DeformedVertex, SKIN_WORKGROUP, SkinVertex};
use super::picture::FrameCounters;
use crate::view::{DrawList, Skin, SkinTextures};

/// The most vertices of a skin: every device takes 65 535 workgroups.
const MAX_VERTICES: u32 = 65_535 * SKIN_WORKGROUP;

/// Data on the device between frames.
#[derive(Debug, Default)]
pub(super) struct MeshBuffers {
    particles: Option<Uploaded<Vec<[f32; 3]>>>,
    scalars: Option<Uploaded<Vec<f32>>>,
    /// One per skin of the last draw list, in its order.
    pub(super) skins: Vec<SkinBuffers>,
}

/// The changes that a draw list has caused on the device.
#[derive(Clone, Copy, Debug)]
pub(super) struct Changes {
    /// Whether bind groups refer to buffers that no longer exist.
    pub(super) has_new_buffers: bool,
    /// Whether skins no longer lie where their particles are.
    pub(super) needs_deforming: bool,
}

/// Data on the device, and its source.
#[derive(Debug)]
struct Uploaded<T> {
    source: Arc<T>,
    buffer: wgpu::Buffer,
}

/// A skin on the device.
#[derive(Debug)]
pub(super) struct SkinBuffers {
    source: Arc<Skin>,
    particles_needed: usize,
    /// The range of the particles that carry it, among those of all bodies.
    pub(super) particles: Range<usize>,
    /// One [`SkinVertex`] after another.
    pub(super) vertices: wgpu::Buffer,
    /// One [`DeformedVertex`] after another.
    pub(super) deformed: wgpu::Buffer,
    /// Pairs of vertices, one pair per edge, and their number; made when edges are first drawn.
    edges: Option<(wgpu::Buffer, usize)>,
    /// Indices of vertices, three per triangle.
    pub(super) indices: wgpu::Buffer,
    /// Number of indices.
    pub(super) index_count: u32,
    /// Number of indices of triangles without a picture, which come first.
    pub(super) plain_index_count: u32,
    /// Texture coordinates of each vertex; none if the skin has no pictures.
    pub(super) texture_coordinates: Option<wgpu::Buffer>,
    /// Number of vertices.
    pub(super) vertex_count: u32,
}

impl MeshBuffers {
    /// Brings the device up to date with a draw list.
    pub(super) fn update(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        draw_list: &DrawList,
        counters: &mut FrameCounters,
    ) -> Result<Changes, RenderError> {
        check(device, draw_list)?;
        let new_skins = self.update_skins(device, queue, draw_list, counters)?;
        let (moved, moved_buffer) =
            upload(device, queue, "particles", &mut self.particles, &draw_list.particles, &mut counters.particle_bytes);
        let (colored, colored_buffer) = match &draw_list.scalars {
            None => {
                let had_scalars = self.scalars.take().is_some();
                (had_scalars, had_scalars)
            }
            Some(scalars) => upload(device, queue, "scalars", &mut self.scalars, scalars, &mut counters.scalar_bytes),
        };
        Ok(Changes {
            has_new_buffers: new_skins || moved_buffer || colored_buffer,
            needs_deforming: new_skins || moved || colored,
        })
    }

    /// The particles, three numbers each; none before the first draw list.
    pub(super) fn particles(&self) -> Option<&wgpu::Buffer> {
        self.particles.as_ref().map(|particles| &particles.buffer)
    }

    /// The scalars, one number per particle; none where no scalars are shown.
    pub(super) fn scalars(&self) -> Option<&wgpu::Buffer> {
        self.scalars.as_ref().map(|scalars| &scalars.buffer)
    }

    fn update_skins(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        draw_list: &DrawList,
        counters: &mut FrameCounters,
    ) -> Result<bool, RenderError> {
        let mut old = std::mem::take(&mut self.skins);
        let mut changed = old.len() != draw_list.skins.len();
        let given = draw_list.particles.len();
        for (place, instance) in draw_list.skins.iter().enumerate() {
            let known = old.iter().position(|skin| Arc::ptr_eq(&skin.source, &instance.skin));
            changed |= known.is_none() || place > 0 && known != Some(0);
            let skin = match known {
                Some(index) => old.remove(index),
                None => SkinBuffers::new(device, queue, &instance.skin, counters)?,
            };
            let needed = skin.particles_needed;
            self.skins.push(skin);
            if needed > given {
                return Err(RenderError::MissingParticles { needed, given });
            }
        }
        Ok(changed)
    }
}

impl SkinBuffers {
    /// The skin that it was made from.
    pub(super) fn source(&self) -> &Arc<Skin> {
        &self.source
    }

    /// The edges of its triangles as pairs of vertices, and their number.
    pub(super) fn edges(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        bytes_counted: &mut u64,
    ) -> Result<(wgpu::Buffer, usize), RenderError> {
        if let Some((buffer, count)) = &self.edges {
            return Ok((buffer.clone(), *count));
        }
        let edges = self.source.edges();
        let bytes: &[u8] = bytemuck::cast_slice(edges);
        let (size, limit) = (bytes.len() as u64, device.limits().max_buffer_size);
        if size > limit {
            return Err(RenderError::TooMuch { what: "edges of a skin", bytes: size, limit });
        }
        *bytes_counted += size;
        let contents = if bytes.is_empty() { &[0; 16] } else { bytes };
        let buffer = filled(device, queue, "edges", contents, wgpu::BufferUsages::VERTEX);
        self.edges = Some((buffer.clone(), edges.len()));
        Ok((buffer, edges.len()))
    }

    fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        skin: &Arc<Skin>,
        counters: &mut FrameCounters,
    ) -> Result<Self, RenderError> {
        let limit = storage_limit(device);
        let bytes = (skin.vertices().len() * size_of::<SkinVertex>()) as u64;
        let most = u64::from(MAX_VERTICES) * size_of::<SkinVertex>() as u64;
        let index_bytes = size_of_val(skin.triangles()) as u64;
        if bytes > limit.min(most) {
            return Err(RenderError::TooMuch { what: "vertices of a skin", bytes, limit: limit.min(most) });
        }
        if index_bytes > device.limits().max_buffer_size {
            let limit = device.limits().max_buffer_size;
            return Err(RenderError::TooMuch { what: "triangles of a skin", bytes: index_bytes, limit });
        }
        let vertices: Vec<SkinVertex> = skin.vertices().iter().map(SkinVertex::from).collect();
        let uploaded = |label, contents: &[u8], usage| {
            // A skin without triangles draws nothing, but a buffer cannot be empty.
            let contents = if contents.is_empty() { &[0; size_of::<SkinVertex>()] } else { contents };
            filled(device, queue, label, contents, usage)
        };
        let deformed = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("deformed skin"),
            size: (vertices.len().max(1) * size_of::<DeformedVertex>()) as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let texture_coordinates = skin.textures().map(|textures| bytemuck::cast_slice(&textures.places));
        counters.static_bytes +=
            bytes + index_bytes + texture_coordinates.map_or(0, |places: &[u8]| places.len() as u64);
        let plain = skin.textures().map_or(skin.triangles().len(), SkinTextures::plain_triangles);
        Ok(Self {
            source: Arc::clone(skin),
            particles_needed: skin.particles_needed(),
            particles: skin.particle_range(),
            vertices: uploaded("skin", bytemuck::cast_slice(&vertices), wgpu::BufferUsages::STORAGE),
            deformed,
            edges: None,
            indices: uploaded("triangles", bytemuck::cast_slice(skin.triangles()), wgpu::BufferUsages::INDEX),
            index_count: count(skin.triangles().len() * 3),
            plain_index_count: count(plain * 3),
            texture_coordinates: texture_coordinates
                .map(|places| uploaded("places in pictures", places, wgpu::BufferUsages::VERTEX)),
            vertex_count: count(skin.vertices().len()),
        })
    }
}

/// Uploads data if its source differs from last frame's. Returns whether it was uploaded, and whether the buffer is new.
fn upload<T: bytemuck::NoUninit>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    slot: &mut Option<Uploaded<Vec<T>>>,
    source: &Arc<Vec<T>>,
    bytes_counted: &mut u64,
) -> (bool, bool) {
    if slot.as_ref().is_some_and(|uploaded| Arc::ptr_eq(&uploaded.source, source)) {
        return (false, false);
    }
    let bytes: &[u8] = bytemuck::cast_slice(source.as_slice());
    *bytes_counted += bytes.len() as u64;
    match slot {
        Some(uploaded) if uploaded.buffer.size() == bytes.len() as u64 => {
            queue.write_buffer(&uploaded.buffer, 0, bytes);
            uploaded.source = Arc::clone(source);
            (true, false)
        }
        _ => {
            let contents = if bytes.is_empty() { &[0; 16] } else { bytes };
            let buffer = filled(device, queue, label, contents, wgpu::BufferUsages::STORAGE);
            *slot = Some(Uploaded { source: Arc::clone(source), buffer });
            (true, true)
        }
    }
}

fn check(device: &wgpu::Device, draw_list: &DrawList) -> Result<(), RenderError> {
    let particles = draw_list.particles.len();
    let (bytes, limit) = ((particles * size_of::<[f32; 3]>()) as u64, storage_limit(device));
    if bytes > limit {
        return Err(RenderError::TooMuch { what: "particles", bytes, limit });
    }
    match &draw_list.scalars {
        Some(scalars) if scalars.len() != particles => {
            Err(RenderError::ScalarCount { scalars: scalars.len(), particles })
        }
        _ => Ok(()),
    }
}

fn storage_limit(device: &wgpu::Device) -> u64 {
    let limits = device.limits();
    limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
}

#[expect(clippy::cast_possible_truncation, reason = "limits of the device, checked before, are below 2^32")]
fn count(length: usize) -> u32 {
    length as u32
}
