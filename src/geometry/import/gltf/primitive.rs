//! The triangles of a glTF primitive: positions and indices out of accessors, in the order that its mode says.

use glam::{DMat4, DVec3};
use gltf_json::Root;
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;

use super::base_colors::{BaseColor, BaseColors};
use super::buffers::Buffers;
use crate::geometry::import::assembly::{Assembly, vertex_index, within_reach};
use crate::geometry::import::error::{ImportError, Place, Problem};
use crate::geometry::import::formats::MAX_PARTS;
use crate::geometry::import::model_file::{Detail, Imported, ModelFile};
use crate::geometry::named_parts::NameKind;
use crate::geometry::paint::{NO_TINT, Tint, tint_of_linear};
use crate::geometry::texturing::TexturePlace;

/// Follows the indices of a file into its buffers, and collects the triangles.
pub(super) struct Reader<'a> {
    file: ModelFile<'a>,
    root: &'a Root,
    buffers: Buffers<'a>,
    assembly: Assembly<'a>,
    base_colors: BaseColors,
    /// Primitives that have a picture but no texture coordinates.
    unplaced: usize,
}

/// The attributes of a primitive's vertices beside their positions; empty where it has none.
#[derive(Default)]
struct Attributes {
    tints: Vec<Tint>,
    normals: Vec<DVec3>,
    places: Vec<TexturePlace>,
}

/// The numbers of an accessor, element by element.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
    component: ComponentType,
    normalized: bool,
}

impl<'a> Reader<'a> {
    /// Starts without triangles; `blob` is the buffer within a binary file.
    pub(super) fn new(file: ModelFile<'a>, root: &'a Root, blob: Option<&'a [u8]>) -> Self {
        let (buffers, assembly) = (Buffers::new(file, root, blob), Assembly::new(file));
        Self { file, root, buffers, assembly, base_colors: BaseColors::new(), unplaced: 0 }
    }

    /// Adds a warning for the user.
    pub(super) fn warn(&mut self, warning: String) {
        self.assembly.warn(warning);
    }

    /// Names the primitives that follow; none is no name.
    pub(super) fn set_name(&mut self, kind: NameKind, name: Option<&String>) {
        self.assembly.set_name(kind, name.map_or("", String::as_str));
    }

    /// Returns the mesh of all that was added.
    pub(super) fn finish(mut self) -> Result<Imported, ImportError> {
        if self.unplaced > 0 {
            let said = "meshes without texture coordinates have no picture but their plain colour";
            self.warn(format!("{said}: {}", self.unplaced));
        }
        if self.base_colors.is_empty() {
            return self.assembly.finish();
        }
        let mut warnings = Vec::new();
        let textures = self.base_colors.load(self.file, self.root, &mut self.buffers, &mut warnings)?;
        for warning in warnings {
            self.assembly.warn(warning);
        }
        self.assembly.finish_with(textures)
    }

    /// Adds the triangles of a primitive, moved by a transform; returns whether it has a surface at all.
    pub(super) fn add(&mut self, primitive: &Primitive, transform: &DMat4, place: &Place) -> Result<bool, ImportError> {
        let Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) = primitive.mode else {
            return Ok(false);
        };
        let missing = || self.file.at(place.clone(), Problem::Missing("the attribute `POSITION`"));
        let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions)).ok_or_else(missing)?.value();
        let material = primitive.material.and_then(|material| self.root.materials.get(material.value()));
        self.set_name(NameKind::Material, material.and_then(|material| material.name.as_ref()));
        let base = material.map(|material| &material.pbr_metallic_roughness);
        let base = base.map(|base| base.base_color_factor.0);
        self.assembly.paint_faces(base.map_or(NO_TINT, |[red, green, blue, _]| tint_of_linear([red, green, blue])));
        let base = self.assembly.vertices();
        let colors = primitive.attributes.get(&Checked::Valid(Semantic::Colors(0)));
        let tints = colors.map(|accessor| self.tints(accessor.value(), place)).unwrap_or_default();
        let normals = primitive.attributes.get(&Checked::Valid(Semantic::Normals));
        let normals = normals.map(|accessor| self.normals(accessor.value(), transform, place)).unwrap_or_default();
        let color = match self.file.detail {
            Detail::Form => None,
            Detail::Pictures => primitive.material.and_then(|found| self.base_colors.of(self.root, found.value())),
        };
        let places = color.map(|color| self.places(primitive, &color, place)).unwrap_or_default();
        self.unplaced += usize::from(color.is_some() && places.is_empty());
        self.assembly.texture_faces(color.filter(|_| !places.is_empty()).map(|color| color.number));
        let count = self.add_positions(positions, transform, &Attributes { tints, normals, places }, place)?;
        let corners = match primitive.indices {
            Some(indices) => self.indices(indices.value(), place)?,
            None => (0..).take(count).collect(),
        };
        let mirrored = transform.determinant() < 0.0;
        let file = self.file;
        let mut face = Vec::new();
        for (number, [a, b, c]) in triangles(mode, corners.len()).enumerate() {
            file.report_progress(number, || 0.5)?;
            let order = if mirrored { [a, c, b] } else { [a, b, c] };
            face.clear();
            for corner in order {
                let index = vertex_index(corners[corner], count).map_err(|problem| file.at(place.clone(), problem))?;
                face.push(index + u32::try_from(base).unwrap_or(u32::MAX));
            }
            // A strip changes direction by triangles of no area, which are dropped without a warning.
            if mode == Mode::Triangles || (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) {
                self.assembly.face(&mut face)?;
            }
        }
        Ok(true)
    }

    /// Adds the vertices of an accessor with their attributes. Returns how many they are.
    fn add_positions(
        &mut self,
        accessor: usize,
        transform: &DMat4,
        Attributes { tints, normals, places }: &Attributes,
        place: &Place,
    ) -> Result<usize, ImportError> {
        let file = self.file;
        let elements = elements(self, accessor, &[Type::Vec3], place)?;
        let (count, stride, size) = (elements.count, elements.stride, elements.component.size());
        // Collected first: the elements borrow the reader, and so its assembly.
        let placed: Vec<DVec3> = (0..count)
            .map(|number| {
                let at = |axis: usize| elements.number(number * stride + axis * size);
                transform.transform_point3(DVec3::new(at(0), at(1), at(2)))
            })
            .collect();
        for (number, position) in placed.into_iter().enumerate() {
            file.report_progress(number, || 0.5)?;
            self.assembly.vertex(within_reach(file, position, || place.clone())?)?;
            self.assembly.paint_vertex(tints.get(number).copied().unwrap_or(NO_TINT));
            self.assembly.vertex_normal(normals.get(number).copied().unwrap_or(DVec3::ZERO));
            if !places.is_empty() {
                self.assembly.place_vertex(places.get(number).copied().unwrap_or([f32::NAN; 2]));
            }
        }
        Ok(count)
    }

    /// Returns the colours of an accessor; faulty ones are left out with a warning.
    fn tints(&mut self, accessor: usize, place: &Place) -> Vec<Tint> {
        let found = elements(self, accessor, &[Type::Vec3, Type::Vec4], place).map(|elements| {
            let (stride, size) = (elements.stride, elements.component.size());
            let tint = |number: usize| {
                #[expect(clippy::cast_possible_truncation, reason = "a colour needs no more than single precision")]
                let channel = |channel: usize| elements.number(number * stride + channel * size) as f32;
                tint_of_linear([channel(0), channel(1), channel(2)])
            };
            (0..elements.count).map(tint).collect()
        });
        found.unwrap_or_else(|error| {
            self.warn(format!("colours of vertices were left out: {error}"));
            Vec::new()
        })
    }

    /// Returns the normals of an accessor, turned by the transform; faulty ones are left out with a warning.
    fn normals(&mut self, accessor: usize, transform: &DMat4, place: &Place) -> Vec<DVec3> {
        let found = elements(self, accessor, &[Type::Vec3], place).map(|elements| {
            let (stride, size) = (elements.stride, elements.component.size());
            let at = |number: usize, axis: usize| elements.number(number * stride + axis * size);
            let normal = |number: usize| DVec3::from_array([0, 1, 2].map(|axis| at(number, axis)));
            // Normals are only compared with each other, so these are good enough. If there are none, glTF wants flat faces
            // (§ 3.7.2.1); here the angle decides as in other formats, so that round models exported without them look
            // round.
            (0..elements.count).map(|number| transform.transform_vector3(normal(number))).collect()
        });
        found.unwrap_or_else(|error| {
            self.warn(format!("normals were left out: {error}"));
            Vec::new()
        })
    }

    /// Returns where the vertices of a primitive lie in a picture; faulty places are left out with a warning.
    fn places(&mut self, primitive: &Primitive, color: &BaseColor, place: &Place) -> Vec<TexturePlace> {
        let accessor = primitive.attributes.get(&Checked::Valid(Semantic::TexCoords(color.set)));
        let Some(accessor) = accessor else { return Vec::new() };
        let found = elements(self, accessor.value(), &[Type::Vec2], place).map(|elements| {
            let (stride, size) = (elements.stride, elements.component.size());
            let at = |number: usize| [0, 1].map(|axis| elements.number(number * stride + axis * size));
            (0..elements.count).map(|number| color.place(at(number))).collect()
        });
        found.unwrap_or_else(|error| {
            self.warn(format!("texture coordinates were left out: {error}"));
            Vec::new()
        })
    }

    fn indices(&mut self, accessor: usize, place: &Place) -> Result<Vec<i64>, ImportError> {
        let file = self.file;
        let elements = elements(self, accessor, &[Type::Scalar], place)?;
        if !matches!(elements.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) {
            let what = format!("an index of the type {:?}", elements.component);
            return Err(file.at(place.clone(), Problem::Unsupported { what, remedy: "U8, U16 and U32 are" }));
        }
        let stride = elements.stride;
        // Exact: none is above 2³².
        #[expect(clippy::cast_possible_truncation, reason = "a whole number of at most four bytes")]
        Ok((0..elements.count).map(|number| elements.number(number * stride) as i64).collect())
    }
}

/// Returns the elements of an accessor, all of them within its buffer.
fn elements<'r>(
    reader: &'r mut Reader<'_>,
    number: usize,
    wanted: &[Type],
    place: &Place,
) -> Result<Elements<'r>, ImportError> {
    let file = reader.file;
    let fail = |problem| file.at(place.clone(), problem);
    let accessor = reader.root.accessors.get(number).ok_or_else(|| file.no_such(place.clone(), "accessor", number))?;
    let (Checked::Valid(found), Checked::Valid(component)) = (accessor.type_, accessor.component_type) else {
        return Err(fail(Problem::Missing("the type of an accessor")));
    };
    if !wanted.contains(&found) {
        let what = format!("accessor {number} of the type {found:?}");
        let remedy = match wanted {
            [Type::Vec3] => "positions and normals are of the type Vec3",
            [Type::Scalar] => "indices are of the type Scalar",
            [Type::Vec2] => "texture coordinates are of the type Vec2",
            _ => "colours are of the type Vec3 or Vec4",
        };
        return Err(fail(Problem::Unsupported { what, remedy }));
    }
    if accessor.sparse.is_some() {
        let what = format!("the sparse accessor {number}");
        return Err(fail(Problem::Unsupported { what, remedy: "export the model without sparse accessors" }));
    }
    let view = accessor.buffer_view.ok_or_else(|| fail(Problem::Missing("the buffer view of an accessor")))?.value();
    let component = component.0;
    let size = component.size() * found.multiplicity();
    let stride = reader.root.buffer_views.get(view).and_then(|view| view.byte_stride).map_or(size, |stride| stride.0);
    if stride < size {
        return Err(fail(Problem::TooShort {
            what: format!("elements of accessor {number}"),
            needed: size as u64,
            there: stride as u64,
        }));
    }
    if accessor.count.0 > 3 * MAX_PARTS as u64 {
        return Err(ImportError::TooDetailed { file: file.name.to_owned() });
    }
    let start = accessor.byte_offset.map_or(0, |offset| offset.0);
    let (count, normalized) = (accessor.count.0, accessor.normalized);
    let before_last = count.saturating_sub(1).saturating_mul(stride as u64);
    let needed = if count == 0 { 0 } else { start.saturating_add(before_last).saturating_add(size as u64) };
    let bytes = reader.buffers.view(view, place)?;
    let there = bytes.len() as u64;
    let within = usize::try_from(start).ok().and_then(|start| bytes.get(start..)).filter(|_| needed <= there);
    let short = || fail(Problem::TooShort { what: format!("the elements of accessor {number}"), needed, there });
    let bytes = within.ok_or_else(short)?;
    Ok(Elements { bytes, stride, count: usize::try_from(count).unwrap_or(0), component, normalized })
}

impl Elements<'_> {
    /// Returns the number at a place that [`elements`] has checked.
    fn number(&self, at: usize) -> f64 {
        let bytes = &self.bytes[at..at + self.component.size()];
        let (value, most) = match (self.component, bytes) {
            (ComponentType::I8, &[a]) => (f64::from(i8::from_le_bytes([a])), f64::from(i8::MAX)),
            (ComponentType::U8, &[a]) => (f64::from(a), f64::from(u8::MAX)),
            (ComponentType::I16, &[a, b]) => (f64::from(i16::from_le_bytes([a, b])), f64::from(i16::MAX)),
            (ComponentType::U16, &[a, b]) => (f64::from(u16::from_le_bytes([a, b])), f64::from(u16::MAX)),
            (ComponentType::U32, &[a, b, c, d]) => (f64::from(u32::from_le_bytes([a, b, c, d])), f64::from(u32::MAX)),
            (_, &[a, b, c, d]) => return f32::from_le_bytes([a, b, c, d]).into(),
            _ => return f64::NAN,
        };
        if self.normalized { (value / most).max(-1.0) } else { value }
    }
}

/// Returns the corners of all triangles, as places among `corners` indices.
///
/// ```text
///  strip  0---2---4    012 132 234    fan  1---2---3    012 023 034
///          \ / \ / \                        \  |  / \
///           1---3---5                        `-0-'---4
/// ```
fn triangles(mode: Mode, corners: usize) -> impl Iterator<Item = [usize; 3]> {
    let count = if mode == Mode::Triangles { corners / 3 } else { corners.saturating_sub(2) };
    (0..count).map(move |number| match mode {
        Mode::TriangleStrip if number % 2 == 1 => [number + 1, number, number + 2],
        Mode::TriangleStrip => [number, number + 1, number + 2],
        Mode::TriangleFan => [0, number + 1, number + 2],
        _ => [3 * number, 3 * number + 1, 3 * number + 2],
    })
}
