//! The pictures of a glTF file's base colours: the picture of each material, and how it lies on surfaces with that material.

use std::collections::BTreeMap;

use gltf_json::material::AlphaMode;
use gltf_json::texture::{Info, MagFilter, MinFilter, WrappingMode};
use gltf_json::validation::Checked;
use gltf_json::{Material, Root};

use super::buffers::Buffers;
use crate::geometry::import::error::{ImportError, Place};
use crate::geometry::import::model_file::ModelFile;
use crate::geometry::import::texture_requests::{PictureBytes, TextureRequests, Textures};
use crate::geometry::picture_file::Opacity;
use crate::geometry::texturing::TexturePlace;
use crate::math::picture::{Filter, Sampling, Wrap};

/// The pictures of base colours that are asked for.
pub(super) struct BaseColors {
    requests: TextureRequests<Source>,
    /// The picture of every material that was asked for.
    known: BTreeMap<usize, Option<BaseColor>>,
}

/// Where a picture comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source {
    /// An image of the file.
    Image(usize),
    /// A texture without an image that can be read.
    Texture(usize),
}

/// The picture of a material's base colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BaseColor {
    /// Its number among the requests.
    pub(super) number: u16,
    /// The set of texture coordinates that places it on a mesh.
    pub(super) set: u32,
    /// How these are moved: u is multiplied by the first number of each row, v by the second, and the third is added.
    rows: [[f64; 3]; 2],
}

impl BaseColors {
    pub(super) fn new() -> Self {
        Self { requests: TextureRequests::new(), known: BTreeMap::new() }
    }

    /// The picture of a material's base colour, if it has one.
    pub(super) fn of(&mut self, root: &Root, material: usize) -> Option<BaseColor> {
        if let Some(known) = self.known.get(&material) {
            return *known;
        }
        let found = root.materials.get(material).and_then(|material| self.request(root, material));
        self.known.insert(material, found);
        found
    }

    fn request(&mut self, root: &Root, material: &Material) -> Option<BaseColor> {
        let info = material.pbr_metallic_roughness.base_color_texture.as_ref()?;
        let texture = root.textures.get(info.index.value());
        let sampler = texture.and_then(|texture| root.samplers.get(texture.sampler?.value()));
        let image = texture.map(|texture| texture.source.value()).filter(|&image| image < root.images.len());
        let source = image.map_or(Source::Texture(info.index.value()), Source::Image);
        // In an opaque material, the opacity of the picture may be anything.
        let opacity = match material.alpha_mode {
            Checked::Valid(AlphaMode::Opaque) | Checked::Invalid => Opacity::Ignored,
            Checked::Valid(AlphaMode::Mask | AlphaMode::Blend) => Opacity::Counts,
        };
        let number = self.requests.request(source, opacity, sampler.map_or_else(Sampling::default, sampling))?;
        Some(BaseColor::new(number, info))
    }

    /// Whether nothing was asked for.
    pub(super) fn is_empty(&self) -> bool {
        self.requests.is_empty()
    }

    /// Reads and unpacks the pictures; a picture that cannot be read gives a warning.
    ///
    /// # Errors
    /// If the watch has cancelled.
    pub(super) fn load(
        self,
        file: ModelFile<'_>,
        root: &Root,
        buffers: &mut Buffers<'_>,
        warnings: &mut Vec<String>,
    ) -> Result<Textures, ImportError> {
        self.requests.load(file, |source| bytes_of(root, buffers, source), warnings)
    }
}

impl BaseColor {
    fn new(number: u16, info: &Info) -> Self {
        let moved = info.extensions.as_ref().and_then(|extensions| extensions.texture_transform.as_ref());
        let set = moved.and_then(|moved| moved.tex_coord).unwrap_or(info.tex_coord);
        let Some(moved) = moved else { return Self { number, set, rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] } };
        let ([offset_u, offset_v], [scale_u, scale_v]) = (moved.offset.0.map(f64::from), moved.scale.0.map(f64::from));
        let angle_rad = f64::from(moved.rotation.0);
        let (sin, cos) = (libm::sin(angle_rad), libm::cos(angle_rad));
        // Scaled, turned, shifted: KHR_texture_transform.
        let rows = [[cos * scale_u, sin * scale_v, offset_u], [-sin * scale_u, cos * scale_v, offset_v]];
        Self { number, set, rows }
    }

    /// Where a texture coordinate lies in the picture. glTF counts from its upper left corner.
    #[expect(clippy::cast_possible_truncation, reason = "a place in a picture needs no more than single precision")]
    pub(super) fn place(&self, [u, v]: [f64; 2]) -> TexturePlace {
        self.rows.map(|[of_u, of_v, shift]| (of_u * u + of_v * v + shift) as f32)
    }
}

/// Returns the URIs of the images of base colours, as the file has them.
pub(super) fn uris(root: &Root) -> impl Iterator<Item = &str> {
    let infos =
        root.materials.iter().filter_map(|material| material.pbr_metallic_roughness.base_color_texture.as_ref());
    let textures = infos.filter_map(|info| root.textures.get(info.index.value()));
    let images = textures.filter_map(|texture| root.images.get(texture.source.value()));
    images.filter_map(|image| image.uri.as_deref())
}

fn bytes_of(root: &Root, buffers: &mut Buffers<'_>, source: Source) -> PictureBytes {
    let number = match source {
        Source::Image(number) => number,
        Source::Texture(number) => {
            let why = "it has no image in a format that is read; PNG and JPEG are".to_owned();
            return PictureBytes { name: format!("texture {number}"), bytes: Err(why) };
        }
    };
    let image = &root.images[number];
    let uri = image.uri.as_deref();
    let own = image.name.as_deref().filter(|name| !name.is_empty());
    let name = uri.filter(|uri| !uri.starts_with("data:")).or(own);
    let bytes = match (uri, image.buffer_view) {
        (Some(uri), _) => buffers.of_uri(uri, "picture"),
        (None, Some(view)) => {
            let bytes = buffers.view(view.value(), &Place::Asset).map(<[u8]>::to_vec);
            bytes.map_err(|error| error.to_string())
        }
        (None, None) => Err("it has neither a `uri` nor a `bufferView`".to_owned()),
    };
    PictureBytes { name: name.map_or_else(|| format!("image {number}"), str::to_owned), bytes }
}

fn sampling(sampler: &gltf_json::texture::Sampler) -> Sampling {
    let wrap = |mode| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    };
    let usual = Sampling::default();
    let (minified, levels) = match sampler.min_filter {
        Some(Checked::Valid(MinFilter::Nearest)) => (Filter::Nearest, None),
        Some(Checked::Valid(MinFilter::Linear)) => (Filter::Linear, None),
        Some(Checked::Valid(MinFilter::NearestMipmapNearest)) => (Filter::Nearest, Some(Filter::Nearest)),
        Some(Checked::Valid(MinFilter::LinearMipmapNearest)) => (Filter::Linear, Some(Filter::Nearest)),
        Some(Checked::Valid(MinFilter::NearestMipmapLinear)) => (Filter::Nearest, Some(Filter::Linear)),
        Some(Checked::Valid(MinFilter::LinearMipmapLinear) | Checked::Invalid) | None => (usual.minified, usual.levels),
    };
    let magnified = match sampler.mag_filter {
        Some(Checked::Valid(MagFilter::Nearest)) => Filter::Nearest,
        _ => Filter::Linear,
    };
    Sampling { wrap: [wrap(sampler.wrap_s), wrap(sampler.wrap_t)], magnified, minified, levels }
}
