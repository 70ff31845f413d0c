//! Takes a software adapter first, so that pictures do not depend on the machine; without any, fails with what to install.

use gelatin::render::{Gpu, Preference, Quality, Renderer, offscreen};
use gelatin::view::{DrawList, Image};

/// A device and a renderer for pictures.
pub(crate) struct Studio {
    pub(crate) gpu: Gpu,
    pub(crate) renderer: Renderer,
}

impl Studio {
    pub(crate) fn new() -> Self {
        Self::of(Quality::Fine)
    }

    pub(crate) fn of(quality: Quality) -> Self {
        let gpu = Gpu::headless_with(Preference::Software).unwrap_or_else(|error| panic!("{error}"));
        let renderer = offscreen::renderer(&gpu, quality);
        Self { gpu, renderer }
    }

    pub(crate) fn picture(&mut self, draw_list: &DrawList, size: [u32; 2]) -> Image {
        offscreen::render_image(&self.gpu, &mut self.renderer, draw_list, size).expect("the picture can be drawn")
    }
}
