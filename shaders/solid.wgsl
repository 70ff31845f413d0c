// Obstacles: matt, two-sided, planes with a visible edge and a faint grid in metres of their own.

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    // On a plane: metres from its middle.
    @location(2) place: vec2f,
    // Half the sides of a plane, m; 0 on a sphere.
    @location(3) @interpolate(flat) half_extents: vec2f,
}

@vertex
fn vertex(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) center: vec3f,
    @location(3) axis_x: vec3f,
    @location(4) axis_y: vec3f,
    @location(5) axis_z: vec3f,
    @location(6) half_extents: vec2f,
) -> Varying {
    let world = center + axis_x * position.x + axis_y * position.y + axis_z * position.z;
    let turned = axis_x * normal.x + axis_y * normal.y + axis_z * normal.z;
    return Varying(
        frame.clip_from_world * vec4f(world, 1.0),
        world,
        turned,
        position.xy * half_extents,
        half_extents,
    );
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    var normal = normalize(in.normal);
    normal = select(-normal, normal, dot(normal, frame.eye - in.world) >= 0.0);

    var albedo = frame.obstacle;
    let lines = grid_lines(in.place, frame.grid_spacing, 1.2);
    let to_edge = in.half_extents - abs(in.place);
    let edge_distance = min(to_edge.x, to_edge.y);
    let edge_pixels = edge_distance / max(fwidth(edge_distance), 1e-6);
    if in.half_extents.x > 0.0 {
        albedo = mix(albedo, frame.obstacle_edge, lines * 0.22);
        albedo = mix(albedo, frame.obstacle_edge, clamp(2.5 - edge_pixels, 0.0, 1.0));
    }

    let facing = max(dot(normal, frame.light_direction), 0.0);
    let share = light_share(shadow_place(in.world, normal));
    let sky = mix(0.55, 1.0, 0.5 + 0.5 * normal.y);
    let light = vec3f(frame.ambient * sky) + frame.light_color * (0.75 * facing * share);
    return vec4f(albedo * light, 1.0);
}
