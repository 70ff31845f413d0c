// A picture enlarged to its place in the window, and the panels over it. Both are in the window's colour space, in which
// panels are blended.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var picture_sampler: sampler;
// Premultiplied, the window's size.
@group(0) @binding(2) var panels: texture_2d<f32>;

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) place: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return Varying(vec4f(corner * 2.0 - 1.0, 0.0, 1.0), vec2f(corner.x, 1.0 - corner.y));
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let behind = textureSampleLevel(picture, picture_sampler, in.place, 0.0);
    let over = textureLoad(panels, vec2i(in.position.xy), 0);
    return vec4f(over.rgb + behind.rgb * (1.0 - over.a), 1.0);
}
