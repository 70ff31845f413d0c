// Depth as the light sees it, of bodies and obstacles.

fn shadow_clip(position: vec3f) -> vec4f {
    let place = frame.shadow_from_world * vec4f(position, 1.0);
    return vec4f(place.x * 2.0 - 1.0, 1.0 - place.y * 2.0, place.z, 1.0);
}

@vertex
fn body(@location(0) position: vec3f) -> @builtin(position) vec4f {
    return shadow_clip(position);
}

@vertex
fn obstacle(
    @location(0) position: vec3f,
    @location(2) center: vec3f,
    @location(3) axis_x: vec3f,
    @location(4) axis_y: vec3f,
    @location(5) axis_z: vec3f,
) -> @builtin(position) vec4f {
    return shadow_clip(center + axis_x * position.x + axis_y * position.y + axis_z * position.z);
}
