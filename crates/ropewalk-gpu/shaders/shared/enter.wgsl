// Entering an object: the twin of ropewalk's two_level/enter.rs and of Placed in instance.rs.
// Source: the same; why the t of a hit is moved is explained there.
// Invariants: same operations in the same order as in Rust. Sums of products are dot(), for the reason that shared/triangle
//   gives.

#import #{COLLECT}
#import shared/levels
#import shared/ray

// The object that a ray is in.
struct Inside {
    object: LevelObject,
    // The ray in the object's frame.
    ray: PreparedRay,
    // Where the ray is in the instance's box.
    span: Interval,
    // A t in the frame, times this, is the same t in the scene: a power of two, nearly always 1.
    scale: f32,
    instance: u32,
}

// The larger of two numbers; of two zeroes the second.
fn larger(a: f32, b: f32) -> f32 {
    return select(b, a, a > b);
}

// The smaller of two numbers; of two zeroes the second.
fn smaller(a: f32, b: f32) -> f32 {
    return select(b, a, a < b);
}

// A vector in the frame.
fn to_frame(placed: Placed, v: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(
        dot(vec3<f32>(placed.axis_x.x, placed.axis_y.x, placed.axis_z.x), v),
        dot(vec3<f32>(placed.axis_x.y, placed.axis_y.y, placed.axis_z.y), v),
        dot(vec3<f32>(placed.axis_x.z, placed.axis_y.z, placed.axis_z.z), v),
    );
}

// How far the frame is searched where the scene is of interest up to a limit.
fn limit_inside(inside: Inside, limit: f32) -> f32 {
    if limit >= inside.span.exit {
        return inside.ray.t_max;
    }
    return limit / inside.scale;
}

// Makes ready to enter an instance. Whether there is anything of interest in it; then `inside` is filled in.
fn approach_instance(
    placed: Placed,
    seeker: Seeker,
    limit: f32,
    inside: ptr<function, Inside>,
) -> bool {
    if (placed.instance_and_mask & seeker.ray.mask) == 0u {
        return false;
    }
    let span = slab_span(seeker.ray, placed.low, placed.high);
    let entry = larger(span.entry, seeker.ray.t_min);
    if entry > smaller(span.exit, seeker.ray.t_max) {
        return false;
    }
    var local = seeker.question;
    local.origin = to_frame(placed, seeker.question.origin) + placed.origin;
    local.dir = to_frame(placed, seeker.question.dir);
    local.mask = 0xffu;
    let lengths = abs(local.dir);
    let size = max(lengths.x, max(lengths.y, lengths.z));
    var scale = 1.0;
    if !(size >= #{SMALLEST_DIRECTION} && size <= #{LARGEST_DIRECTION}) {
        scale = select(1.0 / #{DIRECTION_STEP}, #{DIRECTION_STEP}, size < 1.0);
        local.dir *= scale;
        local.t_min /= scale;
        local.t_max /= scale;
    }
    if !is_valid(local) {
        return false;
    }
    (*inside).object = load_level_object(placed.object);
    (*inside).ray = prepare_ray(local);
    (*inside).span = Interval(entry, span.exit);
    (*inside).scale = scale;
    (*inside).instance = placed.instance_and_mask & 0x00ffffffu;
    let low = (*inside).object.low;
    let high = (*inside).object.high;
    return is_hit(slab_test((*inside).ray, low, high, limit_inside(*inside, limit)));
}

// Offers the hit of an object to the collector of the scene.
fn offer_moved(inside: Inside, hit: Hit, collect: ptr<function, Collect>) -> bool {
    var moved = hit;
    // A driver may take the comparisons for a minimum and a maximum, which choose either zero.
    let t = smaller(larger(hit.t * inside.scale, inside.span.entry), inside.span.exit);
    moved.t = without_negative_zero(t);
    moved.instance = inside.instance;
    // The end of the box's interval may lie a little behind the end of the ray's window, or behind what was found since.
    if moved.t > (*collect).t_max {
        return false;
    }
    return offer(collect, moved);
}
