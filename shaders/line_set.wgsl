// The shared style of a set of lines. Put in front of the passes that draw lines between positions on the device.

struct LineSet {
    color: vec4f,
    // Multiplies the width of every line, pixels.
    width: f32,
    // Opacity of the part behind other things, as a share, 0..1.
    hidden: f32,
    // Numbers from one position to the next.
    stride: u32,
    // The position that index 0 refers to.
    first: u32,
}

@group(1) @binding(0) var<uniform> lines: LineSet;
@group(1) @binding(1) var<storage, read> positions: array<f32>;

// A line between two points of the world.
fn placed_stroke(corner: u32, first: vec3f, second: vec3f, color: vec4f, widths: vec2f) -> Stroke {
    let a = frame.clip_from_world * vec4f(first, 1.0);
    let b = frame.clip_from_world * vec4f(second, 1.0);
    return stroke(corner, a, b, widths * lines.width, color * lines.color);
}

fn clip_of(number: u32) -> vec4f {
    let at = (lines.first + number) * lines.stride;
    return frame.clip_from_world * vec4f(positions[at], positions[at + 1u], positions[at + 2u], 1.0);
}
