// Jelly with a picture on it, which multiplies the paint of its vertices. Put behind `mesh.wgsl`, which lights it.

// Premultiplied: light times opacity.
@group(2) @binding(0) var picture: texture_2d<f32>;
@group(2) @binding(1) var picture_sampler: sampler;

struct TexturedVarying {
    @builtin(position) position: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(3) @interpolate(flat) color: vec3f,
    @location(4) @interpolate(flat) size: f32,
    @location(5) paint: vec4f,
    // Texture coordinates from the upper left corner of the picture.
    @location(6) place: vec2f,
}

@vertex
fn textured_vertex(
    @location(0) position: vec3f,
    @location(1) scalar: f32,
    @location(2) normal: vec3f,
    @location(3) color: vec3f,
    @location(4) size: f32,
    @location(5) tint: vec4f,
    @location(6) place: vec2f,
) -> TexturedVarying {
    let plain = carried(position, scalar, normal, color, size, tint);
    return TexturedVarying(plain.position, position, normal, color, size, plain.paint, place);
}

@fragment
fn textured_fragment(in: TexturedVarying, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let texel = textureSample(picture, picture_sampler, in.place);
    let plain = Varying(in.position, in.world, in.normal, 0.0, in.color, in.size, in.paint);
    return lit(plain, front, in.paint * texel);
}
