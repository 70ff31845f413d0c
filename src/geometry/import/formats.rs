//! The formats that are read, and the limits on their size.

/// The formats that are read, for messages.
pub const FORMATS: &str = "OBJ, STL, PLY or glTF";

/// The endings of the names of their files.
pub const ENDINGS: [&str; 5] = ["obj", "stl", "ply", "gltf", "glb"];

/// The largest file that is read, bytes: about twenty million triangles.
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// The most vertices and the most triangles of a model: a file can say with few bytes that it has very many.
pub const MAX_PARTS: usize = 1 << 25;
