// Rows of heads that are cells of the screen: primary rays.
// Source: the twin of ropewalk's traversal_list/heads/frustum.rs, whose half-spaces the host works out, in f64.
// Invariants: a row is the four sides of a cell's pyramid. The half-spaces of a list begin at the eye.

#import shared/half_space

// Gathers what a row's rays of a list stay within: always something. `at` is where the list's words are, `rows_at` where the
// rows begin.
fn gather_half_spaces(row: u32, list: u32, at: u32, rows_at: u32) -> bool {
    for (var side = 0u; side < 4u; side += 1u) {
        add_half_space(load_half_space(rows_at + 20u * row + 5u * side));
    }
    let facets = records[at];
    for (var facet = 0u; facet < facets; facet += 1u) {
        add_half_space(load_half_space(at + 4u + 5u * facet));
    }
    return true;
}
