// The words of the looks: the twin of ropewalk-render's looks/mod.rs and looks/layout.rs, from which the numbers come.
// Source: the same.
// Invariants: every index that stands in a row was checked when it was packed.

fn looks_word(at: u32) -> u32 {
    return table_a[at];
}

fn looks_float(at: u32) -> f32 {
    return bitcast<f32>(table_a[at]);
}

fn looks_pair(at: u32) -> vec2<f32> {
    return bitcast<vec2<f32>>(vec2<u32>(table_a[at], table_a[at + 1u]));
}

fn looks_vector(at: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(vec3<u32>(table_a[at], table_a[at + 1u], table_a[at + 2u]));
}

// Where the row of a table stands.
fn looks_row(table: u32, row: u32, size: u32) -> u32 {
    return table_a[table] + row * size;
}

// How much of a shadow the ground that catches shadows shows at a point of it.
fn catcher_strength(point: vec3<f32>) -> f32 {
    let away = point - looks_vector(#{LOOKS_CATCHER}u + 1u);
    let share = sqrt(dot(away, away)) / looks_float(#{LOOKS_CATCHER}u + 4u);
    let fade = kept(min(max((1.0 - share) / 0.55, 0.0), 1.0));
    let square = fade * fade;
    return kept(square * (3.0 - (fade + fade)));
}
