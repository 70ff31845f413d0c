//! All passes of an overlay, and their place in the picture. Parts that hang on bodies are drawn before the bodies if these
//! are see-through; the rest is drawn over everything.

use super::device::Device;
use super::error::RenderError;
use super::mesh_buffers::MeshBuffers;
use super::passes::cells::CellsPass;
use super::passes::fills::FillsPass;
use super::passes::lines::LinesPass;
use super::passes::points::PointsPass;
use super::picture::FrameCounters;
use super::target::Output;
use crate::view::Overlay;
use crate::view::style::OverlayColors;

/// Draws overlays.
#[derive(Debug)]
pub(super) struct OverlayPasses {
    lines: LinesPass,
    cells: CellsPass,
    points: PointsPass,
    fills: FillsPass,
}

impl OverlayPasses {
    pub(super) fn new(device: &wgpu::Device, output: Output, frame: &wgpu::BindGroupLayout) -> Self {
        Self {
            lines: LinesPass::new(device, output, frame),
            cells: CellsPass::new(device, output, frame),
            points: PointsPass::new(device, output, frame),
            fills: FillsPass::new(device, output, frame),
        }
    }

    /// Brings the device up to date with the overlays to draw, the second over the first.
    pub(super) fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        overlays: [&Overlay; 2],
        colors: &OverlayColors,
        meshes: &mut MeshBuffers,
        counters: &mut FrameCounters,
    ) -> Result<(), RenderError> {
        let (device, bytes) = (Device { device, queue }, &mut counters.overlay_bytes);
        self.lines.prepare(device, overlays, colors, meshes, bytes)?;
        self.cells.prepare(device, overlays, colors, meshes, bytes)?;
        self.points.prepare(device, overlays, colors, meshes, bytes)?;
        self.fills.prepare(device, overlays, bytes)
    }

    /// Draws the parts that hang on particles and skins.
    pub(super) fn draw_carried(&self, pass: &mut wgpu::RenderPass<'_>, counters: &mut FrameCounters) {
        let drawn = [self.lines.draw_carried(pass), self.cells.draw(pass), self.points.draw_carried(pass)];
        note(counters, ["lines", "cells", "points"], drawn);
    }

    /// Draws the rest.
    pub(super) fn draw_placed(&self, pass: &mut wgpu::RenderPass<'_>, counters: &mut FrameCounters) {
        // Flat shapes lie under the lines around them.
        let drawn = [self.fills.draw(pass), self.lines.draw_placed(pass), self.points.draw_placed(pass)];
        note(counters, ["fills", "lines", "points"], drawn);
    }
}

fn note(counters: &mut FrameCounters, names: [&'static str; 3], drawn: [bool; 3]) {
    counters.passes.extend(names.into_iter().zip(drawn).filter(|&(_, drawn)| drawn).map(|(name, _)| name));
}
