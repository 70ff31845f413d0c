// Shadows, and the table of colours. Put in front of the passes that are lit.

// Reads of the shadow map per point: 4 around it, or 1.
override shadow_taps: u32 = 4u;
// Texels along a side of the shadow map.
override shadow_size: f32 = 1024.0;

@group(1) @binding(0) var shadow_map: texture_depth_2d;
@group(1) @binding(1) var shadow_sampler: sampler_comparison;
@group(1) @binding(2) var colormap: texture_2d<f32>;
// Height of the lowest surface above the map's origin, softened over two distances, m.
@group(1) @binding(3) var contact_map: texture_2d<f32>;
@group(1) @binding(4) var contact_sampler: sampler;

// The place of a point in the shadow map, moved along the normal so that a surface does not shadow itself.
fn shadow_place(position: vec3f, normal: vec3f) -> vec3f {
    let lifted = position + normal * frame.shadow_texel * 2.0;
    return (frame.shadow_from_world * vec4f(lifted, 1.0)).xyz;
}

fn outside(place: vec2f) -> bool {
    return any(place <= vec2f(0.0)) || any(place >= vec2f(1.0));
}

// The share of the light that reaches a point, 0..1.
fn light_share(place: vec3f) -> f32 {
    let depth = min(place.z, 1.0) - 0.0008;
    if shadow_taps == 1u {
        let lit = textureSampleCompareLevel(shadow_map, shadow_sampler, place.xy, depth);
        return select(lit, 1.0, outside(place.xy));
    }
    // A loop instead of a branch: software that runs pixels in step skips the rest of a loop once no pixel needs it.
    let taps = select(shadow_taps, 0u, outside(place.xy));
    var offset = vec2f(-0.4, -1.2) / shadow_size;
    var blocked = 0.0;
    for (var tap = 0u; tap < taps; tap++) {
        blocked += 1.0 - textureSampleCompareLevel(shadow_map, shadow_sampler, place.xy + offset, depth);
        offset = vec2f(-offset.y, offset.x);
    }
    return 1.0 - blocked / f32(shadow_taps);
}

// The distance that light has travelled from the first surface it met to a point, m.
fn depth_below_light(place: vec3f) -> f32 {
    if outside(place.xy) {
        return 0.0;
    }
    let texel = vec2i(place.xy * shadow_size);
    return max(place.z - textureLoad(shadow_map, texel, 0), 0.0) * frame.shadow_span;
}

// The share of the sky that is open over a point of a surface with the given normal, 0..1; smaller close below a body.
fn open_sky(position: vec3f, normal: vec3f) -> f32 {
    let place = (position - frame.contact_origin).xz / frame.contact_side;
    let height = position.y - frame.contact_origin.y;
    let gap = textureSampleLevel(contact_map, contact_sampler, place, 0.0).xy - height;
    let shade = exp(-max(gap, vec2f(0.0)) / (frame.contact_reach * vec2f(0.25, 1.0)));
    // A point above the lowest surface is not below the body.
    let below = saturate(1.0 + 2.0 * gap.y / frame.contact_reach);
    let hidden = (0.4 * shade.x + 0.6 * shade.y) * below * max(normal.y, 0.0);
    return 1.0 - frame.contact_opacity * select(hidden, 0.0, outside(place));
}
