// Cells as frames a little smaller than the cells; those turned inside out are crossed, in another colour.

struct CellSet {
    color: vec4f,
    inverted: vec4f,
    width: f32,
    // The position that index 0 refers to.
    first: u32,
    padding: vec2u,
}

@group(1) @binding(0) var<uniform> cells: CellSet;
@group(1) @binding(1) var<storage, read> positions: array<f32>;

// The ends of a cell's twelve edges and four diagonals. In a corner's number bit 0 is x, bit 1 y, bit 2 z.
const ENDS = array<vec2u, 16>(
    vec2u(0u, 1u), vec2u(2u, 3u), vec2u(4u, 5u), vec2u(6u, 7u),
    vec2u(0u, 2u), vec2u(1u, 3u), vec2u(4u, 6u), vec2u(5u, 7u),
    vec2u(0u, 4u), vec2u(1u, 5u), vec2u(2u, 6u), vec2u(3u, 7u),
    vec2u(0u, 7u), vec2u(1u, 6u), vec2u(2u, 5u), vec2u(3u, 4u),
);
// The size of a frame as a share of its cell.
const SPAN = 0.86;

fn particle(number: u32) -> vec3f {
    let at = (cells.first + number) * 3u;
    return vec3f(positions[at], positions[at + 1u], positions[at + 2u]);
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @location(0) low: vec4u, @location(1) high: vec4u) -> Stroke {
    var corners = array<vec3f, 8>(
        particle(low.x), particle(low.y), particle(low.z), particle(low.w),
        particle(high.x), particle(high.y), particle(high.z), particle(high.w),
    );
    // The mean edges along x, y and z. The sign of their volume tells whether the cell counts as turned inside out.
    var x = vec3f(0.0);
    var y = vec3f(0.0);
    var z = vec3f(0.0);
    var center = vec3f(0.0);
    for (var corner = 0u; corner < 8u; corner++) {
        let here = corners[corner];
        x += select(-here, here, (corner & 1u) != 0u);
        y += select(-here, here, (corner & 2u) != 0u);
        z += select(-here, here, (corner & 4u) != 0u);
        center += 0.125 * here;
    }
    let is_inverted = dot(cross(x, y), z) <= 0.0;
    let line = index / 6u;
    var ends = ENDS;
    let a = mix(center, corners[ends[line].x], SPAN);
    let b = mix(center, corners[ends[line].y], SPAN);
    if line >= 12u && !is_inverted {
        return Stroke(vec4f(0.0, 0.0, -1.0, 1.0), vec2f(0.0), vec3f(0.0), vec4f(0.0));
    }
    let width = cells.width * select(1.0, 2.2, is_inverted);
    let from_clip = frame.clip_from_world * vec4f(a, 1.0);
    let to_clip = frame.clip_from_world * vec4f(b, 1.0);
    // The corners of the two triangles are 0 1 2 and 2 1 3.
    let corner = index % 6u;
    let which = select(corner, 6u - corner, corner > 2u) % 4u;
    var out = stroke(which, from_clip, to_clip, vec2f(width), select(cells.color, cells.inverted, is_inverted));
    if is_inverted {
        // Inverted cells are drawn over everything.
        out.position.z = 0.5 + 0.5 * out.position.z;
    }
    return out;
}

@fragment
fn fragment(in: Stroke) -> @location(0) vec4f {
    return stroke_color(in);
}
