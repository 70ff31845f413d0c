// Obstacles: matt planes, two-sided, with an edge and with lines in their own metres, and matt closed shapes.

struct Plane {
    @builtin(position) position: vec4f,
    @location(0) world: vec3f,
    // Metres from the middle.
    @location(1) place: vec2f,
    // Half the sides, m.
    @location(2) @interpolate(flat) half_extents: vec2f,
    // The normal of the visible side.
    @location(3) @interpolate(flat) normal: vec3f,
    @location(4) @interpolate(flat) color: vec3f,
    // The unshadowed light on it: the sky's, and the lamp's.
    @location(5) @interpolate(flat) sky: f32,
    @location(6) @interpolate(flat) lamp: vec3f,
}

// Places a corner of a plane's nine parts. −1 and 1 are the edges of the plane, −0.5 and 0.5 those of the middle part.
fn corner_of_part(position: vec2f, middle: vec4f) -> vec2f {
    return select(select(middle.xy, middle.zw, position > vec2f(0.0)), position, abs(position) > vec2f(0.75));
}

@vertex
fn plane(
    @location(0) position: vec3f,
    @location(2) center: vec3f,
    @location(3) axis_x: vec3f,
    @location(4) axis_y: vec3f,
    @location(5) axis_z: vec3f,
    @location(6) half_extents: vec2f,
    @location(7) color: vec3f,
    @location(8) shadowed_part: vec4f,
) -> Plane {
    let corner = corner_of_part(position.xy, shadowed_part);
    let world = center + axis_x * corner.x + axis_y * corner.y;
    let normal = axis_z * select(-1.0, 1.0, dot(axis_z, frame.eye - center) >= 0.0);
    let clip = frame.clip_from_world * vec4f(world, 1.0);
    let place = corner * half_extents;
    return Plane(clip, world, place, half_extents, normal, color, sky_light(normal), lamp_light(normal));
}

fn plane_albedo(in: Plane) -> vec3f {
    let footprint = footprint_of(in.place);
    let to_edge = (in.half_extents - abs(in.place)) / footprint;
    let edge = clamp(2.0 - min(to_edge.x, to_edge.y), 0.0, 1.0);
    let lines = grid_lines(in.place, footprint) * frame.plane_line_opacity;
    return mix(in.color, frame.plane_line, max(lines, edge));
}

@fragment
fn shadowed_plane(in: Plane) -> @location(0) vec4f {
    let share = light_share(shadow_place(in.world, in.normal));
    let open = open_sky(in.world, in.normal);
    return vec4f(plane_albedo(in) * (in.sky + in.lamp * share) * open, 1.0);
}

@fragment
fn bare_plane(in: Plane) -> @location(0) vec4f {
    return vec4f(plane_albedo(in) * (in.sky + in.lamp), 1.0);
}

struct Closed {
    @builtin(position) position: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) @interpolate(flat) color: vec3f,
}

@vertex
fn closed(
    @location(0) position: vec3f,
    @location(1) own_normal: vec3f,
    @location(2) center: vec3f,
    @location(3) axis_x: vec3f,
    @location(4) axis_y: vec3f,
    @location(5) axis_z: vec3f,
    @location(7) color: vec3f,
) -> Closed {
    let arm = axis_x * position.x + axis_y * position.y + axis_z * position.z;
    // An unequally scaled shape tilts its normal away from its longer axes.
    let lengths = vec3f(dot(axis_x, axis_x), dot(axis_y, axis_y), dot(axis_z, axis_z));
    let share = own_normal / lengths;
    let normal = axis_x * share.x + axis_y * share.y + axis_z * share.z;
    return Closed(frame.clip_from_world * vec4f(center + arm, 1.0), center + arm, normalize(normal), color);
}

@fragment
fn closed_fragment(in: Closed) -> @location(0) vec4f {
    let normal = normalize(in.normal);
    let share = light_share(shadow_place(in.world, normal));
    let light = sky_light(normal) + lamp_light(normal) * share;
    return vec4f(in.color * light * open_sky(in.world, normal), 1.0);
}

// The light of the sky on a matt surface.
fn sky_light(normal: vec3f) -> f32 {
    return frame.ambient * mix(0.55, 1.0, 0.5 + 0.5 * normal.y);
}

// The light of the lamp on a matt surface.
fn lamp_light(normal: vec3f) -> vec3f {
    return frame.light_color * (0.75 * max(dot(normal, frame.light_direction), 0.0));
}
