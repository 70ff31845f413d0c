// Contact shadows: the height of the lowest surface over every place, seen from straight below, then softened. A body near a
// floor darkens a narrow strip of it, a body above it a wide one, faintly, so its height can be seen.

fn seen_from_below(position: vec3f) -> vec4f {
    let place = (position - frame.contact_origin) / vec3f(frame.contact_side, frame.contact_height, frame.contact_side);
    return vec4f(place.x * 2.0 - 1.0, 1.0 - place.z * 2.0, place.y, 1.0);
}

@vertex
fn body(@location(0) position: vec3f) -> @builtin(position) vec4f {
    return seen_from_below(position);
}

@vertex
fn obstacle(
    @location(0) position: vec3f,
    @location(2) center: vec3f,
    @location(3) axis_x: vec3f,
    @location(4) axis_y: vec3f,
    @location(5) axis_z: vec3f,
) -> @builtin(position) vec4f {
    return seen_from_below(center + axis_x * position.x + axis_y * position.y + axis_z * position.z);
}

@group(1) @binding(0) var lowest: texture_depth_2d;

@vertex
fn everywhere(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0, 0.0, 1.0);
}

// Nearness of the lowest surface over a texel to the bottom of the map: 1 at the bottom, e times smaller for every reach
// above.
fn nearness(texel: vec2i, last: i32) -> f32 {
    let height = textureLoad(lowest, clamp(texel, vec2i(0), vec2i(last)), 0);
    return select(exp(-height * frame.contact_height / frame.contact_reach), 0.0, height >= 1.0);
}

// Softens by averaging `exp(−height ÷ reach)`, over a quarter of the reach (x) and over all of it (y); converts back to
// heights, m. An average of such exponentials is right for a floor at any height below.
@fragment
fn soften(@builtin(position) position: vec4f) -> @location(0) vec2f {
    let size = f32(textureDimensions(lowest).x);
    let texel = vec2i(position.xy);
    let last = i32(size) - 1;
    let stride = 0.6 * frame.contact_reach / frame.contact_side * size;
    var near = 0.0;
    var far = 0.0;
    for (var row = -2; row <= 2; row++) {
        for (var column = -2; column <= 2; column++) {
            let offset = vec2f(f32(column), f32(row));
            let weight = exp(-0.5 * dot(offset, offset)) / 6.17;
            far += weight * nearness(texel + vec2i(round(offset * stride)), last);
            let close = nearness(texel + vec2i(round(offset * stride * 0.25)), last);
            near += weight * close * close * close * close;
        }
    }
    let least = vec2f(1e-12);
    return -log(max(vec2f(near, far), least)) * frame.contact_reach * vec2f(0.25, 1.0);
}
