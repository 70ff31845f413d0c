// Overlay lines: between points that are given, between pixels, or between positions that lie on the device.

@vertex
fn carried(@builtin(vertex_index) corner: u32, @location(0) ends: vec2u) -> Stroke {
    return carried_stroke(corner, ends);
}

@vertex
fn placed(
    @builtin(vertex_index) corner: u32,
    @location(0) first: vec3f,
    @location(1) second: vec3f,
    @location(2) color: vec4f,
    @location(3) widths: vec2f,
) -> Stroke {
    return placed_stroke(corner, first, second, color, widths);
}

// Pixels from the lower right corner of the picture, at the very front.
fn clip_of_pixel(pixel: vec3f) -> vec4f {
    return vec4f(vec2f(1.0, -1.0) + pixel.xy * lines.width * 2.0 / frame.viewport, 1.0, 1.0);
}

@vertex
fn screen(
    @builtin(vertex_index) corner: u32,
    @location(0) first: vec3f,
    @location(1) second: vec3f,
    @location(2) color: vec4f,
    @location(3) widths: vec2f,
) -> Stroke {
    return stroke(corner, clip_of_pixel(first), clip_of_pixel(second), widths * lines.width, color * lines.color);
}

@fragment
fn seen(in: Stroke) -> @location(0) vec4f {
    // Nothing is discarded: what lies behind a line is then never computed.
    return stroke_color(in);
}

@fragment
fn hidden(in: Stroke) -> @location(0) vec4f {
    let color = stroke_color(in);
    return vec4f(color.rgb, color.a * lines.hidden);
}
