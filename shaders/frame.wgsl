// The data of the frame that every drawing pass reads. Put in front of each of their files.

struct Frame {
    clip_from_world: mat4x4f,
    // Texture coordinates (x, y) and depth (z) of the shadow map.
    shadow_from_world: mat4x4f,
    eye: vec3f,
    ambient: f32,
    light_direction: vec3f,
    // Size of a texel of the shadow map, m.
    shadow_texel: f32,
    light_color: vec3f,
    // Distance that the depth of the shadow map spans, m.
    shadow_span: f32,
    background_top: vec3f,
    shadow_opacity: f32,
    background_bottom: vec3f,
    grid_opacity: f32,
    grid: vec3f,
    // Distance between the finest lines of the grid, m.
    grid_spacing: f32,
    // Strength of the lines of each level, the finest first.
    grid_strengths: vec3f,
    // Width of the lines, m.
    grid_width: f32,
    plane_line: vec3f,
    plane_line_opacity: f32,
    camera_target: vec3f,
    // Distance at which the ground has faded out, m.
    ground_radius: f32,
    // The corner of least x, y and z of the map of contact shadows, m.
    contact_origin: vec3f,
    // The sides of that map along x and z, m.
    contact_side: f32,
    // The height of that map, m.
    contact_height: f32,
    // How far a contact shadow reaches, m.
    contact_reach: f32,
    contact_opacity: f32,
    color_low: f32,
    // Width and height of the picture, pixels.
    viewport: vec2f,
    // One over the range of the colour map; 0 where the range is empty.
    color_scale: f32,
    coloring: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
