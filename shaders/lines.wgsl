// Overlay lines: between points that are given, between pixels, or between positions that lie on the device.

struct LineSet {
    color: vec4f,
    // Multiplies the width of every line, pixels.
    width: f32,
    // What is left behind other things, 0..1.
    hidden: f32,
    // Numbers from one position to the next.
    stride: u32,
    // The position that is number 0.
    first: u32,
}

@group(1) @binding(0) var<uniform> lines: LineSet;
@group(1) @binding(1) var<storage, read> positions: array<f32>;

fn clip_of(number: u32) -> vec4f {
    let at = (lines.first + number) * lines.stride;
    return frame.clip_from_world * vec4f(positions[at], positions[at + 1u], positions[at + 2u], 1.0);
}

@vertex
fn carried(@builtin(vertex_index) corner: u32, @location(0) ends: vec2u) -> Stroke {
    return stroke(corner, clip_of(ends.x), clip_of(ends.y), vec2f(lines.width), lines.color);
}

@vertex
fn placed(
    @builtin(vertex_index) corner: u32,
    @location(0) first: vec3f,
    @location(1) second: vec3f,
    @location(2) color: vec4f,
    @location(3) widths: vec2f,
) -> Stroke {
    let a = frame.clip_from_world * vec4f(first, 1.0);
    let b = frame.clip_from_world * vec4f(second, 1.0);
    return stroke(corner, a, b, widths * lines.width, color * lines.color);
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
    let color = stroke_color(in);
    if color.a <= 0.004 {
        discard;
    }
    return color;
}

@fragment
fn hidden(in: Stroke) -> @location(0) vec4f {
    let color = stroke_color(in);
    return vec4f(color.rgb, color.a * lines.hidden);
}
