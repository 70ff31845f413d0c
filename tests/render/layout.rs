//! Structs that the program and the shaders share have the same members at the same places.

use std::mem::offset_of;

use gelatin::render::layout::{CellSet, DeformedVertex, Frame, LineSet, PointSet, SkinVertex};
use gelatin::render::shader::{self, Shader};
use wgpu::naga::front::wgsl;
use wgpu::naga::{Module, TypeInner};

/// Members by name and offset, and the size of the whole.
type Members = (Vec<(String, usize)>, usize);

fn shader_members(source: &str, name: &str) -> Members {
    let module: Module = wgsl::parse_str(source).unwrap();
    let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
    let TypeInner::Struct { members, span } = &found.unwrap().1.inner else { panic!("{name} is no struct") };
    let member = |member: &wgpu::naga::StructMember| (member.name.clone().unwrap(), member.offset as usize);
    (members.iter().map(member).collect(), *span as usize)
}

macro_rules! members {
    ($type:ty: $($member:ident),+) => {
        (vec![$((stringify!($member).to_owned(), offset_of!($type, $member))),+], size_of::<$type>())
    };
}

fn check(shader: Shader, name: &str, ours: &Members) {
    assert_eq!(&shader_members(&shader.source(), name), ours, "{name} in {}.wgsl", shader.name);
}

#[test]
fn the_frame_agrees() {
    let ours = members!(Frame:
        clip_from_world, shadow_from_world, eye, ambient, light_direction, shadow_texel, light_color, shadow_span,
        background_top, shadow_opacity, background_bottom, grid_opacity, grid, grid_spacing, grid_strengths, grid_width,
        plane_line, plane_line_opacity, camera_target, ground_radius, contact_origin, contact_side, contact_height,
        contact_reach, contact_opacity, color_low, viewport, color_scale, coloring);
    for shader in [shader::SHADOW, shader::SOLID, shader::MESH, shader::BACKGROUND, shader::GROUND, shader::LINES] {
        check(shader, "Frame", &ours);
    }
}

#[test]
fn skin_vertices_agree() {
    check(shader::SKIN, "SkinVertex", &members!(SkinVertex: particles, position, tangent_u, tangent_v, tint));
    check(shader::SKIN, "DeformedVertex", &members!(DeformedVertex: position, scalar, normal, tint));
}

#[test]
fn the_looks_of_overlays_agree() {
    let lines = members!(LineSet: color, width, hidden, stride, first);
    check(shader::LINES, "LineSet", &lines);
    check(shader::OUTLINE, "LineSet", &lines);
    check(shader::POINTS, "PointSet", &members!(PointSet: color, size, hidden, first, padding));
    check(shader::CELLS, "CellSet", &members!(CellSet: color, inverted, width, first, padding));
}

#[test]
fn a_struct_in_another_order_is_found() {
    let (ours, size) = members!(DeformedVertex: position, scalar, normal, tint);
    let swapped =
        shader::SKIN.source().replacen("position: vec3f,\n    scalar: f32", "scalar: f32,\n    position: vec3f", 1);
    assert_ne!(shader_members(&swapped, "DeformedVertex"), (ours, size), "position and scalar have changed places");
}
