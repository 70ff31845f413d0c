// Lines on floors, filtered: lines colour a pixel by the share of it that they cover, so that nothing shimmers when the eye
// moves. Put in front of the passes that draw floors.

// Extent of a pixel on a floor along both directions, m.
fn footprint_of(place: vec2f) -> vec2f {
    return max(fwidth(place), vec2f(1e-6));
}

// The share of a pixel around a place on a floor that lines cover, times their strength, 0..1; both arguments in metres.
fn grid_lines(place: vec2f, footprint: vec2f) -> f32 {
    // Near the eye, lines are no wider than they should be in the picture.
    let width = min(vec2f(frame.grid_width), 1.4 * footprint);
    let low = place + 0.5 * (width - footprint);
    let high = low + footprint;
    let share = 1.0 / footprint;
    let finest = lines_of_level(low, high, width, share, frame.grid_spacing);
    let middle = lines_of_level(low, high, width, share, 10.0 * frame.grid_spacing);
    let coarsest = lines_of_level(low, high, width, share, 100.0 * frame.grid_spacing);
    let strong = vec3f(finest, middle, coarsest) * frame.grid_strengths;
    return max(max(strong.x, strong.y), strong.z);
}

// The share of a pixel, from its low to its high corner, that the lines of one level cover.
fn lines_of_level(low: vec2f, high: vec2f, width: vec2f, share: vec2f, spacing: f32) -> f32 {
    let covered = saturate((lines_before(high, width, spacing) - lines_before(low, width, spacing)) * share);
    return covered.x + covered.y - covered.x * covered.y;
}

// The length that lines cover from 0 up to a place, m, if one begins at every multiple of the spacing.
fn lines_before(place: vec2f, width: vec2f, spacing: f32) -> vec2f {
    let whole = floor(place * (1.0 / spacing));
    return whole * width + min(place - whole * spacing, width);
}
