// A soft gradient wherever nothing else is, dithered so that it shows no bands.

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) height: f32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0;
    // Depth 0 is infinitely far away.
    return Varying(vec4f(corner, 0.0, 1.0), 0.5 + 0.5 * corner.y);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let color = mix(frame.background_bottom, frame.background_top, smoothstep(0.0, 1.0, in.height));
    // Interleaved gradient noise (Jimenez, SIGGRAPH 2014 course), half a step of an 8-bit channel.
    let noise = fract(52.9829189 * fract(dot(in.position.xy, vec2f(0.06711056, 0.00583715)))) - 0.5;
    return vec4f(color * (1.0 + noise * 0.012), 1.0);
}
