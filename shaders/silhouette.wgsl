// Finds the silhouette edges of a deformed skin. The surface folds over at an edge if both of its triangles lie on one side
// of the edge, as the eye sees them. One invocation per edge.

// Stands for the far corner of an edge without two triangles, which always counts as silhouette.
const NONE = 0xffffffffu;
const WORKGROUP = 64u;

// The arguments of `draw_indirect`.
struct Draw {
    vertex_count: u32,
    instance_count: atomic<u32>,
    first_vertex: u32,
    first_instance: u32,
}

@group(0) @binding(0) var<uniform> eye: vec4f;
// The two ends of an edge, and the far corners of the triangles at it.
@group(0) @binding(1) var<storage, read> edges: array<vec4u>;
// Vertices of the deformed skin, eight numbers each.
@group(0) @binding(2) var<storage, read> vertices: array<f32>;
@group(0) @binding(3) var<storage, read_write> found: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> draw: Draw;

fn from_eye(vertex: u32) -> vec3f {
    let at = vertex * 8u;
    return vec3f(vertices[at], vertices[at + 1u], vertices[at + 2u]) - eye.xyz;
}

@compute @workgroup_size(WORKGROUP)
fn find(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * WORKGROUP;
    if index >= arrayLength(&edges) {
        return;
    }
    let edge = edges[index];
    if edge.w != NONE {
        let across = cross(from_eye(edge.x), from_eye(edge.y));
        if dot(across, from_eye(edge.z)) * dot(across, from_eye(edge.w)) < 0.0 {
            return;
        }
    }
    found[atomicAdd(&draw.instance_count, 1u)] = edge.xy;
}
