// The ground at y = 0 of a scene without a floor: a faint grid that fades out, and the shadows that fall on it. It lies
// behind everything, as nothing stands on it.

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
    // Depth 0 is infinitely far away.
    clip.z = 0.0;
    return Varying(clip, world);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    let place = in.world.xz;
    let distance = length(place - frame.camera_target.xz) / frame.ground_radius;
    let fade = 1.0 - smoothstep(0.15, 1.0, distance);
    let lines = grid_lines(place, footprint_of(place)) * frame.grid_opacity * fade;

    let up = vec3f(0.0, 1.0, 0.0);
    let facing = smoothstep(0.0, 0.15, frame.light_direction.y) * select(0.0, 1.0, frame.eye.y > 0.0);
    let light = light_share(shadow_place(in.world, up)) * open_sky(in.world, up);
    let shadow = (1.0 - light) * frame.shadow_opacity * fade * facing;
    // Premultiplied colour: the shadow darkens the picture behind, the lines lie on top.
    return vec4f(frame.grid * lines, 1.0 - (1.0 - lines) * (1.0 - shadow));
}
