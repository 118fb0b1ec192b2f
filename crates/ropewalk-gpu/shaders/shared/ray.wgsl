// Rays, and what the box and triangle tests need ready of them: the twin of ropewalk's ray.rs.
// Source: the slabs' two origins and the shear's axes are explained there; Woop, Benthin, Wald 2013 for the shear.
// Invariants: a prepared ray holds no NaN, and an infinity only where an origin is next to the largest float. Same
//   operations in the same order as in Rust.

#import shared/float

struct Ray {
    origin: vec3<f32>,
    t_min: f32,
    dir: vec3<f32>,
    t_max: f32,
    mask: u32,
}

struct PreparedRay {
    // The origins for planes of the lower and of the upper side.
    origin_low: vec3<f32>,
    origin_high: vec3<f32>,
    // One over the direction.
    inverse: vec3<f32>,
    origin: vec3<f32>,
    // dir[kx] / dir[kz], dir[ky] / dir[kz], 1 / dir[kz].
    shear: vec3<f32>,
    t_min: f32,
    // Finite.
    t_max: f32,
    // The axis of the largest component; kx and ky follow it cyclically.
    kz: u32,
    // Whether dir[kz] is positive.
    forward: bool,
    // The mask in the top 8 bits.
    mask: u32,
}

// All tests go by bits: see shared/float.
fn is_valid(ray: Ray) -> bool {
    let size = bitcast<vec3<u32>>(ray.dir) & vec3<u32>(0x7fffffffu);
    let largest = max(size.x, max(size.y, size.z));
    let t_min = bitcast<u32>(ray.t_min);
    return is_finite(ray.origin)
        && largest >= #{SMALLEST_DIRECTION_BITS}
        && largest <= #{LARGEST_DIRECTION_BITS}
        // Not negative, not NaN; -0 counts as 0.
        && (t_min <= 0x7f800000u || t_min == 0x80000000u)
        && !is_nan(ray.t_max);
}

// The components in the order kx, ky, kz.
fn permute(v: vec3<f32>, kz: u32) -> vec3<f32> {
    return select(select(v.zxy, v.yzx, kz == 0u), v, kz == 2u);
}

// The ray must be valid.
fn prepare_ray(ray: Ray) -> PreparedRay {
    let size = abs(ray.dir);
    var kz = 2u;
    if size.x >= size.y && size.x >= size.z {
        kz = 0u;
    } else if size.y >= size.z {
        kz = 1u;
    }
    let largest = max(size.x, max(size.y, size.z));
    let parallel = size <= vec3<f32>(largest * #{PARALLEL});
    let parallel_inverse = min(#{PARALLEL_INVERSE} / largest, #{LARGEST_INVERSE});
    let outwards = max(#{LEAST_OUTWARDS_SHORT} / largest, #{LEAST_OUTWARDS});
    let next_above = vec3<f32>(next_up(ray.origin.x), next_up(ray.origin.y), next_up(ray.origin.z));
    let next_below = vec3<f32>(next_down(ray.origin.x), next_down(ray.origin.y), next_down(ray.origin.z));
    let above = max(ray.origin + outwards, next_above);
    let below = min(ray.origin - outwards, next_below);
    let divisor = select(ray.dir, vec3<f32>(1.0), parallel);
    let d = permute(ray.dir, kz);

    var prepared: PreparedRay;
    prepared.origin_low = select(ray.origin, above, parallel);
    prepared.origin_high = select(ray.origin, below, parallel);
    prepared.inverse = select(1.0 / divisor, vec3<f32>(parallel_inverse), parallel);
    prepared.origin = ray.origin;
    prepared.shear = vec3<f32>(d.x / d.z, d.y / d.z, 1.0 / d.z);
    prepared.t_min = ray.t_min;
    // Infinity is the t of a miss, so no hit may have it.
    prepared.t_max = min(ray.t_max, #{LARGEST_FLOAT});
    prepared.kz = kz;
    prepared.forward = d.z > 0.0;
    prepared.mask = ray.mask << 24u;
    return prepared;
}
