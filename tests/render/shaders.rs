//! Every shader parses and validates without a device.

use gelatin::render::shader;
use wgpu::naga::front::wgsl;
use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};

fn validate(source: &str) -> Result<(), String> {
    let module = wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::default());
    validator.validate(&module).map(|_| ()).map_err(|error| error.emit_to_string(source))
}

#[test]
fn every_shader_is_valid() {
    for shader in shader::ALL {
        if let Err(error) = validate(&shader.source()) {
            panic!("{}.wgsl: {error}", shader.name);
        }
    }
}

#[test]
fn every_file_is_in_the_table_or_shared() {
    let shared = ["frame", "grid", "lighting", "stroke", "line_set"];
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/shaders");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let known = shared.contains(&name) || shader::ALL.iter().any(|shader| shader.name == name);
        assert!(known, "{} belongs to no pass", path.display());
    }
}

#[test]
fn a_wrong_type_is_found() {
    assert!(validate("@fragment fn f() -> @location(0) vec4f { return vec3f(0.0); }").is_err(), "vec3 is no vec4");
}
