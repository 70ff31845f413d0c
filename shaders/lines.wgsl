// Overlay lines: between given points, between pixels, or between positions on the device.

@vertex
fn carried(@builtin(vertex_index) corner: u32, @location(0) ends: vec2u) -> Stroke {
    let a = clip_of(ends.x);
    let b = clip_of(ends.y);
    // Short lines are thinner, so that those of a body far away do not close into a surface.
    let pixels = 0.5 * length((a.xy / a.w - b.xy / b.w) * frame.viewport);
    let width = lines.width * min(1.0, 0.45 + 0.025 * pixels);
    return stroke(corner, a, b, vec2f(width), lines.color);
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

// Clip coordinates of a pixel, counted from the lower right corner of the picture; at the very front.
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
    // No fragment is discarded, so the part behind a line is never computed.
    return stroke_color(in);
}

@fragment
fn hidden(in: Stroke) -> @location(0) vec4f {
    let color = stroke_color(in);
    return vec4f(color.rgb, color.a * lines.hidden);
}
