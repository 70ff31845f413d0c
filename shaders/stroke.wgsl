// Lines of a width in pixels, antialiased by the distance from their middle. Put in front of the passes that draw lines. A
// line is a strip of two triangles over its ends and half its width around them:
//
//   ┌─────────────────┐   place.x runs from one end (0) to the other (reach), place.y across, both in pixels
//   │ ·─────────────· │
//   └─────────────────┘

struct Stroke {
    @builtin(position) position: vec4f,
    @location(0) place: vec2f,
    // The line's length and half its widths at the two ends, pixels.
    @location(1) @interpolate(flat) reach: vec3f,
    @location(2) @interpolate(flat) color: vec4f,
}

// Lines are drawn this much nearer than they are, so that they win against the surface they lie on.
const NEARER = 1.0008;

// A corner 0..3 of a line between two points in clip space. Bit 0 chooses the end, bit 1 the side.
fn stroke(corner: u32, from_clip: vec4f, to_clip: vec4f, widths: vec2f, color: vec4f) -> Stroke {
    var a = from_clip;
    var b = to_clip;
    // The part in front of the near plane is cut off; a line wholly in front of it becomes nothing.
    let room = vec2f(a.w - a.z, b.w - b.z);
    if max(room.x, room.y) < 0.0 || !all(abs(a + b) < vec4f(1e30)) {
        return Stroke(vec4f(0.0, 0.0, -1.0, 1.0), vec2f(0.0), vec3f(0.0), vec4f(0.0));
    }
    if room.x < 0.0 {
        a = mix(a, b, room.x / (room.x - room.y));
    } else if room.y < 0.0 {
        b = mix(b, a, room.y / (room.y - room.x));
    }
    let half_view = 0.5 * frame.viewport;
    let pixel_a = a.xy / a.w * half_view;
    let pixel_b = b.xy / b.w * half_view;
    let way = pixel_b - pixel_a;
    let reach = length(way);
    let along = select(vec2f(1.0, 0.0), way / reach, reach > 1e-4);
    let across = vec2f(-along.y, along.x);

    let at_end = (corner & 1u) != 0u;
    let side = select(-1.0, 1.0, (corner & 2u) != 0u);
    // The distance up to which a line covers part of a pixel, measured to the pixel's middle.
    let border = 0.5 * max(widths.x, widths.y) + 0.5;
    let place = vec2f(select(-border, reach + border, at_end), side * border);
    let pixel = pixel_a + along * place.x + across * place.y;
    let depth = select(a.z / a.w, b.z / b.w, at_end);
    return Stroke(vec4f(pixel / half_view, min(depth * NEARER, 1.0), 1.0), place, vec3f(reach, 0.5 * widths), color);
}

// The colour of a pixel of a line, weighted by the share of the pixel that the line covers.
fn stroke_color(in: Stroke) -> vec4f {
    let reach = in.reach.x;
    let share = clamp(in.place.x / max(reach, 1e-4), 0.0, 1.0);
    let radius = mix(in.reach.y, in.reach.z, share);
    let beyond = max(-in.place.x, in.place.x - reach);
    let rounded = length(vec2f(max(beyond, 0.0), in.place.y)) - radius;
    let flat_ended = max(abs(in.place.y) - radius, beyond);
    let distance = select(rounded, flat_ended, in.reach.y != in.reach.z);
    // Lines thinner than a pixel fade instead.
    let coverage = clamp(0.5 - distance, 0.0, 1.0) * clamp(2.0 * max(in.reach.y, in.reach.z), 0.0, 1.0);
    return vec4f(in.color.rgb, in.color.a * coverage);
}
