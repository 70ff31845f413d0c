//! The parts of a model by the names that its file gives: of materials, of groups, of objects.
//!
//! A triangle may have a name of each kind. A name means all triangles whose material has it; if no material has it, those
//! of the group of that name; else those of the object. Names are kept printable and short, for messages.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::text::echo_up_to;

/// The longest name, letters.
const MAX_NAME_LENGTH: usize = 100;

/// The most combinations of names, the one without names included: a triangle's combination is stored in 16 bits.
const MAX_LABELS: usize = 1 << 16;

/// The kind of thing that has a name. A name that several kinds have means the first of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NameKind {
    /// A material: `usemtl` of an OBJ file, a material of a glTF file.
    Material,
    /// A group: `g` of an OBJ file, a mesh of a glTF file.
    Group,
    /// An object: `o` of an OBJ file, a node of a glTF file.
    Object,
}

impl NameKind {
    /// All kinds, in order of precedence.
    pub const ALL: [Self; 3] = [Self::Material, Self::Group, Self::Object];
}

/// The names of a triangle by [`NameKind`], as indices into all names.
type Label = [Option<u32>; 3];

/// The names of the triangles of a mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedParts {
    names: Arc<[String]>,
    /// Every combination of names once; the first is the one without names.
    labels: Vec<Label>,
    /// The index of every triangle's combination among the labels.
    of_triangle: Vec<u16>,
}

impl NamedParts {
    /// All names that mean a part, in the order of the file.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Returns the same names to keep.
    pub fn shared_names(&self) -> Arc<[String]> {
        Arc::clone(&self.names)
    }

    /// Whether a name means a part.
    pub fn has(&self, name: &str) -> bool {
        self.place(name).is_some()
    }

    /// Returns the index of a triangle's combination of names among all labels.
    pub fn label(&self, triangle: usize) -> u16 {
        self.of_triangle[triangle]
    }

    /// How many triangles there are.
    pub fn count(&self) -> usize {
        self.of_triangle.len()
    }

    /// How many labels there are.
    pub(super) fn labels(&self) -> usize {
        self.labels.len()
    }

    /// Whether each label belongs to the part that a name means.
    pub(super) fn is_in_part(&self, name: &str) -> impl Iterator<Item = bool> {
        let place = self.place(name);
        let kind = place.and_then(|place| self.kind(place)).map_or(0, |kind| kind as usize);
        self.labels.iter().map(move |label| place.is_some() && label[kind] == place)
    }

    /// Returns the index of each label's name of a kind.
    pub(super) fn places(&self, kind: NameKind) -> impl Iterator<Item = Option<u32>> {
        self.labels.iter().map(move |label| label[kind as usize])
    }

    /// Returns the kind that every name means.
    pub(super) fn kinds(&self) -> Vec<NameKind> {
        let mut kinds = vec![NameKind::Object; self.names.len()];
        for kind in NameKind::ALL.into_iter().rev() {
            for place in self.places(kind).flatten() {
                kinds[place as usize] = kind;
            }
        }
        kinds
    }

    fn place(&self, name: &str) -> Option<u32> {
        let name = clean(name);
        self.names.iter().zip(0..).find(|(known, _)| **known == name).map(|(_, place)| place)
    }

    fn kind(&self, place: u32) -> Option<NameKind> {
        NameKind::ALL.into_iter().find(|&kind| self.places(kind).any(|named| named == Some(place)))
    }
}

/// Collects the names of triangles while a file is read.
#[derive(Clone, Debug)]
pub(super) struct Namer {
    current: [String; 3],
    /// The label of the names in `current`, once it was looked up.
    label: Option<u16>,
    name_places: BTreeMap<String, u32>,
    label_places: BTreeMap<Label, u16>,
    names: Vec<String>,
    labels: Vec<Label>,
    has_too_many: bool,
}

impl Namer {
    pub(super) fn new() -> Self {
        Self {
            current: <[String; 3]>::default(),
            label: Some(0),
            name_places: BTreeMap::new(),
            label_places: BTreeMap::from([(Label::default(), 0)]),
            names: Vec::new(),
            labels: vec![Label::default()],
            has_too_many: false,
        }
    }

    /// Gives the triangles that follow this name; an empty one is none.
    pub(super) fn set_name(&mut self, kind: NameKind, name: &str) {
        self.current[kind as usize] = clean(name);
        self.label = None;
    }

    /// Returns the label of the triangles that follow.
    pub(super) fn label(&mut self) -> u16 {
        if let Some(label) = self.label {
            return label;
        }
        let label = self.label_of_current();
        self.label = Some(label);
        label
    }

    /// Returns the warning about a file with more names than are kept.
    pub(super) fn warning(&self) -> Option<String> {
        let said = || format!("the model has more than {MAX_LABELS} parts with names of their own; the rest has none");
        self.has_too_many.then(said)
    }

    /// Returns the names of triangles with these labels; none if no triangle has a name.
    pub(super) fn finish(self, of_triangle: Vec<u16>) -> Option<NamedParts> {
        let Self { names, labels, .. } = self;
        (labels.len() > 1).then(|| NamedParts { names: names.into(), labels, of_triangle })
    }

    fn label_of_current(&mut self) -> u16 {
        let known = |name: &String| self.name_places.get(name).copied();
        let places: [Option<u32>; 3] = self.current.each_ref().map(known);
        let is_known = self.current.iter().zip(&places).all(|(name, place)| name.is_empty() || place.is_some());
        if let Some(label) = self.label_places.get(&places).filter(|_| is_known) {
            return *label;
        }
        let Ok(label) = u16::try_from(self.labels.len()) else {
            self.has_too_many = true;
            return 0;
        };
        let mut places = Label::default();
        for (name, place) in self.current.iter().zip(&mut places).filter(|(name, _)| !name.is_empty()) {
            // Three new names a label at most.
            let next = u32::try_from(self.names.len()).unwrap_or(u32::MAX);
            let known = *self.name_places.entry(name.clone()).or_insert(next);
            if known == next {
                self.names.push(name.clone());
            }
            *place = Some(known);
        }
        self.label_places.insert(places, label);
        self.labels.push(places);
        label
    }
}

/// A name as it is kept: printable, short, without blanks around it.
pub(super) fn clean(name: &str) -> String {
    echo_up_to(name.trim(), MAX_NAME_LENGTH)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The named parts of triangles with these names: material, group and object of each.
    pub(in crate::geometry) fn named(triangles: &[[&str; 3]]) -> Option<NamedParts> {
        let mut namer = Namer::new();
        let labels = triangles.iter().map(|names| {
            NameKind::ALL.into_iter().zip(names).for_each(|(kind, name)| namer.set_name(kind, name));
            namer.label()
        });
        let labels = labels.collect();
        namer.finish(labels)
    }

    fn triangles_of(parts: &NamedParts, name: &str) -> Vec<usize> {
        let is_in_part: Vec<bool> = parts.is_in_part(name).collect();
        (0..parts.of_triangle.len()).filter(|&triangle| is_in_part[usize::from(parts.label(triangle))]).collect()
    }

    #[test]
    fn a_name_means_a_material_before_a_group_and_a_group_before_an_object() {
        let parts = named(&[["rubber", "wheel", "car"], ["steel", "rubber", "car"], ["", "car", "cart"], ["", "", ""]]);
        let parts = parts.expect("names");
        assert_eq!(parts.names(), ["rubber", "wheel", "car", "steel", "cart"], "in the order of the file");
        for (name, triangles) in [
            ("rubber", vec![0]),
            ("wheel", vec![0]),
            ("car", vec![2]),
            ("cart", vec![2]),
            (" steel ", vec![1]),
            ("glass", vec![]),
            ("", vec![]),
        ] {
            assert_eq!(triangles_of(&parts, name), triangles, "{name}");
            assert_eq!(parts.has(name), !triangles.is_empty(), "{name}");
        }
        assert_eq!(named(&[["", "", ""], [" ", "", "\t"]]), None, "nothing has a name");
    }

    #[test]
    fn names_that_would_steer_a_terminal_or_have_no_end_are_kept_clean() {
        let long = "x".repeat(500);
        let parts = named(&[["a\u{1b}[2Jb", &long, "\u{202e}"]]).expect("names");
        assert_eq!(parts.names()[0], "a\u{fffd}[2Jb", "no escape sequence");
        assert!(
            parts.names()[1].chars().count() == MAX_NAME_LENGTH + 1 && parts.has(&long),
            "cut, and found by all of it"
        );
        assert_eq!(parts.names()[2], "\u{fffd}");
    }

    #[test]
    fn more_names_than_there_may_be_are_left_out_and_told() {
        let mut namer = Namer::new();
        let mut labels = Vec::new();
        for number in 0..MAX_LABELS + 5 {
            namer.set_name(NameKind::Group, &number.to_string());
            labels.push(namer.label());
        }
        assert_eq!(labels[MAX_LABELS - 2..], [65535, 0, 0, 0, 0, 0, 0], "those too many have no name");
        assert!(namer.warning().is_some_and(|warning| warning.contains("more than 65536 parts")), "said");
        namer.set_name(NameKind::Group, "7");
        assert_eq!(namer.label(), 8, "what is known is found again");
        assert_eq!(namer.finish(labels).expect("names").names().len(), MAX_LABELS - 1, "no name beyond");
    }
}
