//! The model files that the program carries, so that presets need no file beside it.

/// The prefix of a model path that names one of these models.
pub const PREFIX: &str = "builtin:";

/// Every model carried: its name and the bytes of its OBJ file.
pub const MODELS: &[(&str, &[u8])] = &[
    ("bowl.obj", include_bytes!("../../assets/bowl.obj")),
    ("bridge.obj", include_bytes!("../../assets/bridge.obj")),
    ("chair.obj", include_bytes!("../../assets/chair.obj")),
    ("comb.obj", include_bytes!("../../assets/comb.obj")),
    ("coupler.obj", include_bytes!("../../assets/coupler.obj")),
    ("shell.obj", include_bytes!("../../assets/shell.obj")),
    ("spot.obj", include_bytes!("../../assets/spot.obj")),
    ("tree.obj", include_bytes!("../../assets/tree.obj")),
];

/// The bytes of a carried model by its name, without [`PREFIX`].
pub fn model(name: &str) -> Option<&'static [u8]> {
    MODELS.iter().find(|(carried, _)| *carried == name).map(|(_, bytes)| *bytes)
}
