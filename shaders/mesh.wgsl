// Jelly: Phong (ambient, diffuse, specular) with a rim of light, a crisp highlight, and light that shines through thin parts
// of the body. If scalars are shown, the surface takes its colour from the map, without highlights. It may also show the paint
// of its vertices.

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) scalar: f32,
    @location(3) @interpolate(flat) color: vec3f,
    // The body's largest side, m.
    @location(4) @interpolate(flat) size: f32,
    // Linear red, green, blue of the paint, and its opacity, 0..1; premultiplied.
    @location(5) paint: vec4f,
}

fn linear_from_srgb(srgb: vec3f) -> vec3f {
    return select(pow((srgb + 0.055) / 1.055, vec3f(2.4)), srgb / 12.92, srgb <= vec3f(0.04045));
}

@vertex
fn vertex(
    @location(0) position: vec3f,
    @location(1) scalar: f32,
    @location(2) normal: vec3f,
    @location(3) color: vec3f,
    @location(4) size: f32,
    @location(5) tint: vec4f,
) -> Varying {
    return carried(position, scalar, normal, color, size, tint);
}

fn carried(position: vec3f, scalar: f32, normal: vec3f, color: vec3f, size: f32, tint: vec4f) -> Varying {
    let paint = vec4f(linear_from_srgb(tint.rgb) * tint.a, tint.a);
    return Varying(frame.clip_from_world * vec4f(position, 1.0), position, normal, scalar, color, size, paint);
}

@fragment
fn fragment(in: Varying, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    return lit(in, front, in.paint);
}

// The colour of a point with this paint.
fn lit(in: Varying, front: bool, paint: vec4f) -> vec4f {
    let to_eye = normalize(frame.eye - in.world);
    var normal = normalize(in.normal);
    normal = select(-normal, normal, front);

    var albedo = in.color;
    var gloss = 1.0;
    var highlight = 1.0;
    if frame.coloring == 2u {
        albedo = paint.rgb + (1.0 - paint.a) * in.color;
    }
    if frame.coloring == 1u {
        let level = clamp((in.scalar - frame.color_low) * frame.color_scale, 0.0, 1.0);
        albedo = textureLoad(colormap, vec2i(i32(level * 255.0 + 0.5), 0), 0).rgb;
        // A highlight would be a colour that is not on the scale.
        gloss = 0.12;
        highlight = 0.0;
    }

    let place = shadow_place(in.world, normal);
    let share = light_share(place);
    let facing = dot(normal, frame.light_direction);
    let diffuse = max((facing + 0.25) / 1.25, 0.0) * mix(0.15, 1.0, share);
    // Light that has come through the body to a point under the skin, the weaker the longer its way (Beer and Lambert): thin
    // parts and edges towards the light glow, the inside of the body has a deeper colour.
    let under = shadow_place(in.world - normal * (0.18 * in.size), vec3f(0.0));
    var through = exp(-4.5 * depth_below_light(under) / in.size);
    if frame.coloring == 1u {
        // Colours of a scale must not depend on the thickness of the body.
        through = mix(0.5, through, 0.2);
    }
    let halfway = normalize(frame.light_direction + to_eye);
    let aligned = max(dot(normal, halfway), 0.0);
    let seen = select(0.0, share, facing > 0.0);
    // Powers 16 and 128, by squaring: a fraction of the cost of pow in software.
    let aligned_2 = aligned * aligned;
    let aligned_4 = aligned_2 * aligned_2;
    let aligned_8 = aligned_4 * aligned_4;
    let aligned_16 = aligned_8 * aligned_8;
    let aligned_32 = aligned_16 * aligned_16;
    let aligned_64 = aligned_32 * aligned_32;
    let specular = (0.9 * aligned_64 * aligned_64 + 0.10 * aligned_16) * seen * highlight;
    // A rim of light, and the bright sky mirrored at grazing angles (Schlick's approximation).
    let grazing = 1.0 - max(dot(normal, to_eye), 0.0);
    let grazing_2 = grazing * grazing;
    let rim = 0.40 * grazing_2 * grazing;
    let mirrored = smoothstep(-0.1, 0.9, reflect(-to_eye, normal).y);
    let sky_shine = mirrored * (0.06 + 0.5 * grazing_2 * grazing_2 * grazing);

    let sky = mix(0.45, 1.0, 0.5 + 0.5 * normal.y);
    let body = albedo * (frame.ambient * sky + frame.light_color * (0.52 * diffuse + 0.62 * through));
    let tint = mix(albedo, vec3f(1.0), 0.35);
    let shine = frame.light_color * (vec3f(specular + sky_shine) + rim * tint) * gloss;
    return vec4f(body + shine, 1.0);
}
