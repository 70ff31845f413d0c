// The outline of the selected thing: a mask of it, then lines along its silhouette wherever the mask is empty.

// How much of a pixel the selected thing covers.
@group(2) @binding(0) var mask: texture_2d<f32>;

@vertex
fn mask_body(@location(0) position: vec3f) -> @builtin(position) vec4f {
    return frame.clip_from_world * vec4f(position, 1.0);
}

@vertex
fn mask_obstacle(
    @location(0) position: vec3f,
    @location(2) center: vec3f,
    @location(3) axis_x: vec3f,
    @location(4) axis_y: vec3f,
    @location(5) axis_z: vec3f,
) -> @builtin(position) vec4f {
    let world = center + axis_x * position.x + axis_y * position.y + axis_z * position.z;
    return frame.clip_from_world * vec4f(world, 1.0);
}

@fragment
fn mask_fragment() -> @location(0) vec4f {
    return vec4f(1.0);
}

// Half of an outline lies over the ground under the thing, which is a little nearer there. So the outline counts as hidden
// only behind things that are nearer by more than this factor.
const IN_FRONT = 1.02;

fn pulled(line: Stroke) -> Stroke {
    var out = line;
    out.position.z = min(out.position.z * IN_FRONT, 1.0);
    return out;
}

@vertex
fn carried(@builtin(vertex_index) corner: u32, @location(0) ends: vec2u) -> Stroke {
    return pulled(stroke(corner, clip_of(ends.x), clip_of(ends.y), vec2f(lines.width), lines.color));
}

@vertex
fn placed(
    @builtin(vertex_index) corner: u32,
    @location(0) first: vec3f,
    @location(1) second: vec3f,
    @location(2) color: vec4f,
    @location(3) widths: vec2f,
) -> Stroke {
    return pulled(placed_stroke(corner, first, second, color, widths));
}

fn outside(in: Stroke) -> vec4f {
    let color = stroke_color(in);
    let covered = textureLoad(mask, vec2i(in.position.xy), 0).r;
    return vec4f(color.rgb, color.a * (1.0 - covered));
}

@fragment
fn seen(in: Stroke) -> @location(0) vec4f {
    return outside(in);
}

@fragment
fn hidden(in: Stroke) -> @location(0) vec4f {
    let color = outside(in);
    return vec4f(color.rgb, color.a * lines.hidden);
}
