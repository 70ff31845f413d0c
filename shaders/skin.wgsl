// Carries a skin along with its particles: one invocation per vertex.

struct SkinVertex {
    particles: array<u32, 8>,
    position: array<f32, 8>,
    tangent_u: array<f32, 8>,
    tangent_v: array<f32, 8>,
    tint: u32,
}

struct DeformedVertex {
    position: vec3f,
    scalar: f32,
    normal: vec3f,
    tint: u32,
}

// Three numbers per particle.
@group(0) @binding(0) var<storage, read> particles: array<f32>;
// One number per particle, or a single one if no scalars are shown.
@group(0) @binding(1) var<storage, read> scalars: array<f32>;
@group(0) @binding(2) var<storage, read> skin: array<SkinVertex>;
@group(0) @binding(3) var<storage, read_write> deformed: array<DeformedVertex>;

@compute @workgroup_size(64)
fn deform(@builtin(global_invocation_id) id: vec3u) {
    let index = id.x;
    if index >= arrayLength(&skin) {
        return;
    }
    var position = vec3f(0.0);
    var tangent_u = vec3f(0.0);
    var tangent_v = vec3f(0.0);
    var scalar = 0.0;
    for (var slot = 0u; slot < 8u; slot++) {
        let particle = skin[index].particles[slot];
        let weight = skin[index].position[slot];
        let x = vec3f(particles[3u * particle], particles[3u * particle + 1u], particles[3u * particle + 2u]);
        position += weight * x;
        tangent_u += skin[index].tangent_u[slot] * x;
        tangent_v += skin[index].tangent_v[slot] * x;
        scalar += weight * scalars[min(particle, arrayLength(&scalars) - 1u)];
    }
    let normal = cross(tangent_u, tangent_v);
    let length_of_normal = length(normal);
    deformed[index].position = position;
    deformed[index].scalar = scalar;
    deformed[index].normal = select(vec3f(0.0), normal / length_of_normal, length_of_normal > 0.0);
    deformed[index].tint = skin[index].tint;
}
