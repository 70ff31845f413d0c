//! One element of a PLY file: what a surface needs of it.

use ply_rs_bw::ply::{ElementDef, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType};

use crate::geometry::import::error::{Problem, coordinate, quote};

/// The names that the property of a face's corners may have.
pub(super) const INDICES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// What a surface needs of a vertex or of a face.
#[derive(Debug)]
pub(super) struct Element {
    /// Of a vertex.
    pub(super) position: [f64; 3],
    /// Of a vertex; zero if it is not given.
    pub(super) normal: [f64; 3],
    /// sRGB red, green, blue, 0..1; NaN if it is not given.
    pub(super) color: [f64; 3],
    /// Of a face, as written.
    pub(super) corners: Vec<i64>,
}

impl PropertyAccess for Element {
    fn new() -> Self {
        Self { position: [0.0; 3], normal: [0.0; 3], color: [f64::NAN; 3], corners: Vec::new() }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if let Some(axis) = axis(name) {
            self.position[axis] = number(&property);
        } else if let Some(axis) = normal_axis(name) {
            self.normal[axis] = number(&property);
        } else if let Some(channel) = channel(name) {
            self.color[channel] = number(&property) / full_scale(&kind(&property));
        } else if INDICES.contains(&name) {
            self.corners = whole_numbers(property);
        } else {
            return PropertyAccessResult::Ignored;
        }
        PropertyAccessResult::Set
    }
}

/// Reads the element in a line of a text.
pub(super) fn text_element(line: &[u8], def: &ElementDef) -> Result<Element, Problem> {
    let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    let mut next = || words.next().ok_or(Problem::Missing("a number that the header describes"));
    let mut element = Element::new();
    for (name, property) in &def.properties {
        match (&property.data_type, axis(name)) {
            (PropertyType::Scalar(_), Some(axis)) => element.position[axis] = coordinate(next()?)?,
            (PropertyType::Scalar(kind), None) => {
                let word = next()?;
                if let Some(axis) = normal_axis(name) {
                    element.normal[axis] = coordinate(word).unwrap_or(f64::NAN);
                } else if let Some(channel) = channel(name) {
                    element.color[channel] = coordinate(word).unwrap_or(f64::NAN) / full_scale(kind);
                }
            }
            (PropertyType::List(..), _) => {
                let count: u32 = whole_number(next()?, "a number of entries")?;
                let is_corner = INDICES.contains(&name.as_str());
                // Nothing is reserved for the claimed count: the list grows with the words that are there.
                for _ in 0..count {
                    let word = next()?;
                    if is_corner {
                        element.corners.push(whole_number(word, "the number of a vertex")?);
                    }
                }
            }
        }
    }
    Ok(element)
}

/// Returns the axis of a coordinate by the name of its property.
fn axis(name: &str) -> Option<usize> {
    ["x", "y", "z"].iter().position(|axis| *axis == name)
}

/// Returns the axis of a coordinate of a normal by the name of its property.
fn normal_axis(name: &str) -> Option<usize> {
    ["nx", "ny", "nz"].iter().position(|axis| *axis == name)
}

/// Returns the channel of a colour by the name of its property.
fn channel(name: &str) -> Option<usize> {
    let name = name.strip_prefix("diffuse_").unwrap_or(name);
    ["red", "green", "blue"].iter().position(|channel| *channel == name)
}

/// The kind of number of a property that is no list.
fn kind(property: &Property) -> ScalarType {
    match property {
        Property::Float(_) => ScalarType::Float,
        Property::Double(_) => ScalarType::Double,
        Property::Short(_) => ScalarType::Short,
        Property::UShort(_) => ScalarType::UShort,
        _ => ScalarType::UChar,
    }
}

/// The value of full light.
fn full_scale(kind: &ScalarType) -> f64 {
    match kind {
        ScalarType::Float | ScalarType::Double => 1.0,
        ScalarType::Short | ScalarType::UShort => f64::from(u16::MAX),
        _ => f64::from(u8::MAX),
    }
}

fn whole_number<T: std::str::FromStr>(word: &[u8], needed: &'static str) -> Result<T, Problem> {
    let number = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
    number.ok_or_else(|| Problem::Unexpected { found: quote(word), needed })
}

fn number(property: &Property) -> f64 {
    match *property {
        Property::Char(value) => value.into(),
        Property::UChar(value) => value.into(),
        Property::Short(value) => value.into(),
        Property::UShort(value) => value.into(),
        Property::Int(value) => value.into(),
        Property::UInt(value) => value.into(),
        Property::Float(value) => value.into(),
        Property::Double(value) => value,
        // A header with a list as a coordinate was refused before.
        _ => f64::NAN,
    }
}

fn whole_numbers(property: Property) -> Vec<i64> {
    match property {
        Property::ListChar(list) => wide(list),
        Property::ListUChar(list) => wide(list),
        Property::ListShort(list) => wide(list),
        Property::ListUShort(list) => wide(list),
        Property::ListInt(list) => wide(list),
        Property::ListUInt(list) => wide(list),
        // A header with anything else as corners was refused before.
        _ => Vec::new(),
    }
}

fn wide<T: Into<i64>>(list: Vec<T>) -> Vec<i64> {
    list.into_iter().map(Into::into).collect()
}
