//! A texture kept between frames: the view's picture, or the panels.

use glam::Vec2;

use crate::app::input::ViewRect;

/// A texture kept between frames.
#[derive(Debug)]
pub(super) struct Layer {
    pub(super) texture: wgpu::Texture,
    /// The view to draw into, in the drawer's colour space.
    pub(super) target: wgpu::TextureView,
    /// The view that the compositor reads, in the window's colour space.
    pub(super) source: wgpu::TextureView,
    pub(super) size: [u32; 2],
}

impl Layer {
    /// Makes a layer to be drawn into as `format`.
    pub(super) fn new(
        device: &wgpu::Device,
        label: &'static str,
        format: wgpu::TextureFormat,
        size @ [width, height]: [u32; 2],
    ) -> Self {
        let plain = format.remove_srgb_suffix();
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::COPY_DST
                | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[plain],
        });
        let view =
            |format| texture.create_view(&wgpu::TextureViewDescriptor { format: Some(format), ..Default::default() });
        let (target, source) = (view(format), view(plain));
        Self { texture, target, source, size }
    }

    /// Copies a part, in pixels, to the same place of a layer of the same size.
    pub(super) fn copy_to(&self, encoder: &mut wgpu::CommandEncoder, other: &Self, part: egui::Rect) {
        let part = ViewRect {
            origin: Vec2::from(<[f32; 2]>::from(part.min.to_vec2())),
            size: Vec2::from(<[f32; 2]>::from(part.size())),
        };
        let Some(([x, y], [width, height])) = pixels(part, self.size) else { return };
        let origin = wgpu::Origin3d { x, y, z: 0 };
        let [from, to] = [&self.texture, &other.texture]
            .map(|texture| wgpu::TexelCopyTextureInfo { origin, ..texture.as_image_copy() });
        encoder.copy_texture_to_texture(from, to, wgpu::Extent3d { width, height, depth_or_array_layers: 1 });
    }
}

/// The whole pixels of a surface that the view covers; `None` if there are none.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the surface before")]
pub(super) fn pixels(view: ViewRect, [width, height]: [u32; 2]) -> Option<([u32; 2], [u32; 2])> {
    let surface = Vec2::new(width as f32, height as f32);
    let low = view.origin.round().clamp(Vec2::ZERO, surface);
    let high = (view.origin + view.size).round().clamp(Vec2::ZERO, surface);
    let size = high - low;
    let whole = |value: Vec2| [value.x as u32, value.y as u32];
    (size.is_finite() && size.min_element() >= 1.0).then(|| (whole(low), whole(size)))
}

/// The size of a picture with `scale` times the pixels of its place along each side.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "no larger than a texture")]
pub(super) fn scaled([width, height]: [u32; 2], scale: f32) -> [u32; 2] {
    [width, height].map(|side| ((side as f32 * scale).round() as u32).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(x: f32, y: f32, width: f32, height: f32) -> ViewRect {
        ViewRect { origin: Vec2::new(x, y), size: Vec2::new(width, height) }
    }

    #[test]
    fn the_picture_never_leaves_the_surface() {
        assert_eq!(pixels(view(0.0, 40.4, 900.0, 520.0), [900, 600]), Some(([0, 40], [900, 520])));
        assert_eq!(pixels(view(-5.0, 40.0, 2000.0, 2000.0), [900, 600]), Some(([0, 40], [900, 560])));
    }

    #[test]
    fn a_view_without_pixels_has_no_picture() {
        assert_eq!(pixels(view(0.0, 40.0, 900.0, 0.2), [900, 600]), None, "too flat");
        assert_eq!(pixels(view(0.0, 700.0, 900.0, 50.0), [900, 600]), None, "below the surface");
        assert_eq!(pixels(view(f32::NAN, 0.0, 9.0, 9.0), [900, 600]), None, "not a number");
    }

    #[test]
    fn a_coarse_picture_keeps_at_least_a_pixel() {
        assert_eq!(scaled([750, 691], 1.0), [750, 691]);
        assert_eq!(scaled([750, 691], 0.5), [375, 346]);
        assert_eq!(scaled([1, 1], 0.1), [1, 1]);
    }
}
