// The shadow map and the table of colours. Put in front of the passes that are lit.

@group(1) @binding(0) var shadow_map: texture_depth_2d;
@group(1) @binding(1) var shadow_sampler: sampler_comparison;
@group(1) @binding(2) var colormap: texture_2d<f32>;

// Where a point lands in the shadow map, moved along the normal so that a surface does not shadow itself.
fn shadow_place(position: vec3f, normal: vec3f) -> vec3f {
    let lifted = position + normal * frame.shadow_texel * 2.0;
    return (frame.shadow_from_world * vec4f(lifted, 1.0)).xyz;
}

fn outside(place: vec3f) -> bool {
    return any(place.xy <= vec2f(0.0)) || any(place.xy >= vec2f(1.0));
}

// The share of the light that reaches a point, 0..1. A loop, not a branch: software that runs pixels in step skips the
// rest of a loop when no pixel needs it, and most of a picture lies outside the map.
fn light_share(place: vec3f) -> f32 {
    let texel = 1.0 / vec2f(textureDimensions(shadow_map));
    let depth = min(place.z, 1.0) - 0.0008;
    let taps = select(4u, 0u, outside(place));
    var offset = vec2f(-0.4, -1.2) * texel;
    var blocked = 0.0;
    for (var tap = 0u; tap < taps; tap++) {
        blocked += 1.0 - textureSampleCompareLevel(shadow_map, shadow_sampler, place.xy + offset, depth);
        offset = vec2f(-offset.y, offset.x);
    }
    return 1.0 - 0.25 * blocked;
}

// How far light has travelled from the first surface it met to a point, m.
fn depth_below_light(place: vec3f) -> f32 {
    if outside(place) {
        return 0.0;
    }
    let texel = vec2i(place.xy * vec2f(textureDimensions(shadow_map)));
    return max(place.z - textureLoad(shadow_map, texel, 0), 0.0) * frame.shadow_span;
}

// How strongly a line of a grid with the given spacing covers a point, 0..1; antialiased, fading where lines are
// nearer than pixels.
fn grid_lines(place: vec2f, spacing: f32, width_pixels: f32) -> f32 {
    let coordinate = place / spacing;
    let pixel = max(fwidth(coordinate), vec2f(1e-6));
    let offset = abs(fract(coordinate - 0.5) - 0.5) / pixel;
    let line = clamp(vec2f(0.5 * width_pixels + 0.5) - offset, vec2f(0.0), vec2f(1.0));
    let sparse = clamp(1.5 - 4.0 * pixel, vec2f(0.0), vec2f(1.0));
    let covered = line * sparse;
    return max(covered.x, covered.y);
}
