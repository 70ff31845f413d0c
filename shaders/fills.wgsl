// Flat triangles over everything: the handles of a gizmo.

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) color: vec4f,
}

@vertex
fn vertex(@location(0) place: vec3f, @location(1) color: vec4f) -> Varying {
    return Varying(frame.clip_from_world * vec4f(place, 1.0), color);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    return in.color;
}
