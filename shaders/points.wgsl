// Overlay points: discs of a size in pixels with a dark rim, at given places or at particles.

struct PointSet {
    color: vec4f,
    // Diameter, pixels.
    size: f32,
    // Opacity of the part behind other things, as a share, 0..1.
    hidden: f32,
    // The particle that index 0 refers to.
    first: u32,
    padding: u32,
}

@group(1) @binding(0) var<uniform> points: PointSet;
@group(1) @binding(1) var<storage, read> positions: array<f32>;

struct Varying {
    @builtin(position) position: vec4f,
    // Pixels from the middle.
    @location(0) place: vec2f,
}

fn disc(corner: u32, middle: vec3f) -> Varying {
    let clip = frame.clip_from_world * vec4f(middle, 1.0);
    if clip.w < clip.z || !all(abs(clip) < vec4f(1e30)) {
        return Varying(vec4f(0.0, 0.0, -1.0, 1.0), vec2f(0.0));
    }
    let sides = vec2f(select(-1.0, 1.0, (corner & 1u) != 0u), select(-1.0, 1.0, (corner & 2u) != 0u));
    let place = sides * (0.5 * points.size + 1.0);
    // Points are drawn a little nearer than they are, so that they win against the surface they lie on.
    let depth = min(clip.z / clip.w * 1.001, 1.0);
    return Varying(vec4f(clip.xy / clip.w + place * 2.0 / frame.viewport, depth, 1.0), place);
}

@vertex
fn carried(@builtin(vertex_index) corner: u32, @builtin(instance_index) number: u32) -> Varying {
    let at = (points.first + number) * 3u;
    return disc(corner, vec3f(positions[at], positions[at + 1u], positions[at + 2u]));
}

@vertex
fn placed(@builtin(vertex_index) corner: u32, @location(0) middle: vec3f) -> Varying {
    return disc(corner, middle);
}

fn disc_color(place: vec2f) -> vec4f {
    let radius = 0.5 * points.size;
    let distance = length(place);
    let rim = clamp(distance - radius + 1.6, 0.0, 1.0);
    return vec4f(points.color.rgb * (1.0 - 0.75 * rim), points.color.a * clamp(radius + 0.5 - distance, 0.0, 1.0));
}

@fragment
fn seen(in: Varying) -> @location(0) vec4f {
    let color = disc_color(in.place);
    if color.a <= 0.004 {
        discard;
    }
    return color;
}

@fragment
fn hidden(in: Varying) -> @location(0) vec4f {
    let color = disc_color(in.place);
    return vec4f(color.rgb, color.a * points.hidden);
}
