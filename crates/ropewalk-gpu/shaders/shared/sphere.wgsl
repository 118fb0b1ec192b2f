// Where a ray goes through a sphere: the twin of Sphere::interval in ropewalk's sphere.rs.
// Source: the padding and why an entry counts, not the smallest positive root, are explained there.
// Invariants: same operations in the same order as in Rust. Sums of products are dot(), for the reason that
//   shared/triangle gives. Comparisons stand as they do in Rust, so that a sphere out of all proportion is entered.

#import shared/aabb

// Padded, up to `limit`; not hit where the ray passes by. The radius is the fourth component.
fn sphere_interval(ray: PreparedRay, sphere: vec4<f32>, limit: f32) -> Interval {
    let offset = permute(sphere.xyz - ray.origin, ray.kz);
    // In units of the direction's largest component.
    let along = vec3<f32>(ray.shear.xy, 1.0);
    let square = dot(along, along);
    let middle = dot(offset, along) / square;
    let size = abs(offset);
    let pad = #{SPHERE_PAD} * (size.x + size.y + size.z + sphere.w);
    let radius = sphere.w + pad;
    let beside = offset - along * middle;
    let distance = sqrt(dot(beside, beside));
    if distance > radius {
        return Interval(#{LARGEST_FLOAT}, -#{LARGEST_FLOAT});
    }
    // Two roots: a product of small numbers would lose its digits.
    let half = sqrt(radius - distance) * sqrt(radius + distance) / sqrt(square) + pad;
    let a = (middle - half) * ray.shear.z;
    let b = (middle + half) * ray.shear.z;
    let entry = select(b, a, ray.forward);
    let exit = select(a, b, ray.forward);
    return Interval(select(ray.t_min, entry, entry > ray.t_min), select(limit, exit, exit < limit));
}
