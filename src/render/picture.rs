//! The target of a picture, and the cost of drawing it.

/// The target of a picture.
#[derive(Clone, Copy, Debug)]
pub struct FrameTarget<'a> {
    /// A view in the renderer's format; all of it is overwritten.
    pub view: &'a wgpu::TextureView,
    /// The view's width and height, pixels.
    pub size: [u32; 2],
    /// The part that shows the scene, with black around it; the whole view if absent.
    pub viewport: Option<Viewport>,
}

/// A rectangle of a picture, pixels from its upper left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Viewport {
    /// The upper left corner.
    pub origin: [u32; 2],
    /// Width and height.
    pub size: [u32; 2],
}

/// The cost of a frame.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FrameCounters {
    /// Particle positions uploaded, bytes.
    pub particle_bytes: u64,
    /// Scalars uploaded, bytes.
    pub scalar_bytes: u64,
    /// Skins uploaded, bytes.
    pub static_bytes: u64,
    /// Camera, light, colours and places of obstacles uploaded, bytes.
    pub frame_bytes: u64,
    /// Overlays uploaded, bytes; zero without overlays.
    pub overlay_bytes: u64,
    /// Triangles drawn into the picture.
    pub triangles: u64,
    /// The passes that ran, in order.
    pub passes: Vec<&'static str>,
}
