// Jelly: Phong (ambient, diffuse, specular) with a rim of light, a crisp highlight and light that shines through
// where the body is thin. With scalars shown the surface takes its colour from the map and shines less.

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) scalar: f32,
    @location(3) @interpolate(flat) color: vec3f,
}

@vertex
fn vertex(
    @location(0) position: vec3f,
    @location(1) scalar: f32,
    @location(2) normal: vec3f,
    @location(3) color: vec3f,
) -> Varying {
    return Varying(frame.clip_from_world * vec4f(position, 1.0), position, normal, scalar, color);
}

@fragment
fn fragment(in: Varying, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let to_eye = normalize(frame.eye - in.world);
    var normal = normalize(in.normal);
    normal = select(-normal, normal, front);

    var albedo = in.color;
    var gloss = 1.0;
    if frame.show_scalars != 0u {
        let level = clamp((in.scalar - frame.color_low) * frame.color_scale, 0.0, 1.0);
        albedo = textureSampleLevel(colormap, colormap_sampler, vec2f((level * 255.0 + 0.5) / 256.0, 0.5), 0.0).rgb;
        gloss = 0.35;
    }

    let place = shadow_place(in.world, normal);
    let share = light_share(place);
    let facing = dot(normal, frame.light_direction);
    let diffuse = max((facing + 0.25) / 1.25, 0.0) * mix(0.15, 1.0, share);
    // Light that entered elsewhere and comes out here, less the longer its way (Beer and Lambert).
    let through = exp(-3.0 * depth_below_light(place) / frame.body_size) * (1.0 - max(facing, 0.0)) * 0.55;
    let halfway = normalize(frame.light_direction + to_eye);
    let aligned = max(dot(normal, halfway), 0.0);
    let seen = select(0.0, share, facing > 0.0);
    let specular = (0.9 * pow(aligned, 160.0) + 0.10 * pow(aligned, 18.0)) * seen * gloss;
    let rim = pow(1.0 - max(dot(normal, to_eye), 0.0), 3.0) * gloss;

    let sky = mix(0.6, 1.0, 0.5 + 0.5 * normal.y);
    let body = albedo * (frame.ambient * sky + frame.light_color * (0.7 * diffuse + through));
    let shine = frame.light_color * (specular + rim * 0.45 * mix(albedo, vec3f(1.0), 0.35));
    return vec4f(body + shine, 1.0);
}
