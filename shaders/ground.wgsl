// The ground at y = 0: a faint grid that fades out, and the shadows that fall on it.

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) world: vec3f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let place = frame.camera_target.xz + corner * frame.ground_radius;
    let world = vec3f(place.x, 0.0, place.y);
    var clip = frame.clip_from_world * vec4f(world, 1.0);
    // A fifth of a per cent farther away than it is: whatever lies on the ground wins, at any distance.
    clip.z *= 0.998;
    return Varying(clip, world);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let place = in.world.xz;
    let strong = grid_lines(place, frame.grid_spacing, 1.4);
    let faint = grid_lines(place, frame.grid_spacing * 0.2, 1.0) * 0.35;
    let distance = length(place - frame.camera_target.xz) / frame.ground_radius;
    let fade = 1.0 - smoothstep(0.15, 1.0, distance);
    let lines = max(strong, faint) * frame.grid_opacity * fade;

    let up = vec3f(0.0, 1.0, 0.0);
    let facing = smoothstep(0.0, 0.15, frame.light_direction.y);
    let shadow = (1.0 - light_share(shadow_place(in.world, up))) * frame.shadow_opacity * fade * facing;
    // Premultiplied: the shadow darkens what is behind, the lines lie on top.
    return vec4f(frame.grid * lines, 1.0 - (1.0 - lines) * (1.0 - shadow));
}
