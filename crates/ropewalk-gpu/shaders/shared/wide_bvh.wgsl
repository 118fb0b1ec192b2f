// A node of several children, in the buffers of shared/bvh: the children of wide node i are the WIDTH records from
// i * WIDTH on.
// Source: the twin of ropewalk's wide_bvh/mod.rs. An inner child has count 0 and its wide node as link; a place that
//   holds nothing has 0 for both, since no child leads to the root.
// Invariants: places that hold nothing come last.

#import shared/bvh
#import shared/postponed

// The children that the ray hits, nearest first, at equal distance by their places; how many there are. Each child goes to
// the place of its rank: no loop, no branch that a neighbour does not take, and nothing is moved twice.
fn hit_children(
    ray: PreparedRay,
    wide_node: u32,
    t_max: f32,
    sorted: ptr<function, array<Postponed, #{WIDTH}>>,
) -> u32 {
    let first = wide_node * #{WIDTH}u;
#repeat SLOT #{WIDTH}
    let child_#{SLOT} = load_node(first + #{SLOT}u);
    let span_#{SLOT} = slab_test(ray, child_#{SLOT}.low, child_#{SLOT}.high, t_max);
    let hit_#{SLOT} = is_hit(span_#{SLOT}) && (child_#{SLOT}.count | child_#{SLOT}.link) != 0u;
    // Behind all that are hit: no ray enters a box so far away.
    let entry_#{SLOT} = select(#{LARGEST_FLOAT}, span_#{SLOT}.entry, hit_#{SLOT});
#endrepeat
    var hits = 0u;
#repeat SLOT #{WIDTH}
    if hit_#{SLOT} {
        var rank = 0u;
#repeat OTHER #{WIDTH}
        rank += u32(select(entry_#{OTHER} < entry_#{SLOT}, entry_#{OTHER} <= entry_#{SLOT}, #{OTHER}u < #{SLOT}u));
#endrepeat
        (*sorted)[rank].node = first + #{SLOT}u;
        (*sorted)[rank].entry = entry_#{SLOT};
        hits += 1u;
    }
#endrepeat
    return hits;
}
