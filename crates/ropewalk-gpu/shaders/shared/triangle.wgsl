// The watertight ray-triangle test: the twin of FlatTriangle::intersect in ropewalk's triangle.rs, and with ONE_SIDED that
// of FlatTriangle::intersect_front.
// Source: Woop, Benthin, Wald 2013; that t comes from the plane, and that the triangle's own box decides too, is
//   explained in triangle.rs.
// Invariants: an edge function depends on the edge alone, not on the triangle that asks: where a device fuses
//   a * b - c * d, the two triangles of an edge still get the same number with opposite signs, and no ray slips
//   between them. Without fusing, the bits are those of the Rust code.
//   Sums of products are dot(): lavapipe sums it from the left, as Rust does, and reorders the same sum written out
//   when one factor is 1.

#import shared/aabb
#import shared/hit

struct Triangle {
    v0: vec3<f32>,
    primitive: u32,
    v1: vec3<f32>,
    // The geometry in the low 31 bits, and whether the instance mirrors.
    geometry_and_mirror: u32,
    v2: vec3<f32>,
    // The instance in the low 24 bits, its mask in the top 8.
    instance_and_mask: u32,
}

// A vertex in the space in which the ray is the z axis.
fn shear(ray: PreparedRay, vertex: vec3<f32>) -> vec3<f32> {
    let moved = permute(vertex - ray.origin, ray.kz);
    return vec3<f32>(moved.xy - ray.shear.xy * moved.z, moved.z);
}

// The cross product p x q, evaluated from the end that comes first in lexicographic order.
fn edge_function(p: vec2<f32>, q: vec2<f32>) -> f32 {
    let in_order = p.x < q.x || (p.x == q.x && p.y <= q.y);
    let first = select(q, p, in_order);
    let second = select(p, q, in_order);
    let cross = first.x * second.y - first.y * second.x;
    return select(0.0 - cross, cross, in_order);
}

struct TrianglePlane {
    // Of a vertex from the origin, along the normal.
    distance: f32,
    // Not of unit length.
    normal: vec3<f32>,
}

// The triangle's plane, as a ray sees it: with the axes in the ray's order. The normal is the cross product of the two
// shorter edges.
fn triangle_plane(triangle: Triangle, ray: PreparedRay) -> TrianglePlane {
    let a = permute(triangle.v0, ray.kz);
    let b = permute(triangle.v1, ray.kz);
    let c = permute(triangle.v2, ray.kz);
    let ab = b - a;
    let bc = c - b;
    let ca = a - c;
    let ab_length = dot(ab, ab);
    let bc_length = dot(bc, bc);
    let ca_length = dot(ca, ca);
    var one = ab;
    var other = bc;
    if ab_length >= bc_length && ab_length >= ca_length {
        one = bc;
        other = ca;
    } else if bc_length >= ca_length {
        one = ca;
        other = ab;
    }
    let normal = cross(one, other);
    return TrianglePlane(dot(normal, a - permute(ray.origin, ray.kz)), normal);
}

#ifdef ONE_SIDED
// Whether the ray runs against the normal of the front, strictly. Along an axis to which it is parallel for the slab test
// it does not run at all.
fn runs_against(ray: PreparedRay, mirrored: bool, normal: vec3<f32>) -> bool {
    let along = select(ray.shear.xy, vec2<f32>(0.0), abs(ray.shear.xy) <= vec2<f32>(#{PARALLEL}));
    let slope = dot(normal, vec3<f32>(along, 1.0));
    return select(slope > 0.0, slope < 0.0, ray.forward != mirrored);
}
#endif

// Whether the ray hits the triangle within [ray.t_min, t_max], ends included; then `hit` is filled in. Both sides
// are hit; with ONE_SIDED the front alone.
fn intersect_triangle(triangle: Triangle, ray: PreparedRay, t_max: f32, hit: ptr<function, Hit>) -> bool {
    if (triangle.instance_and_mask & ray.mask) == 0u {
        return false;
    }
    let a = shear(ray, triangle.v0);
    let b = shear(ray, triangle.v1);
    let c = shear(ray, triangle.v2);
    let u = edge_function(c.xy, b.xy);
    let v = edge_function(a.xy, c.xy);
    let w = edge_function(b.xy, a.xy);
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return false;
    }
    let determinant = u + v + w;
    // Below the smallest normal number the weights would lose their bits, and 1 / determinant overflow.
    if magnitude_bits(determinant) < 0x00800000u {
        return false;
    }
    let scale = 1.0 / determinant;
    let plane = triangle_plane(triangle, ray);
    let slope = dot(plane.normal, vec3<f32>(ray.shear.xy, 1.0));
    var depth = plane.distance / slope;
    if slope == 0.0 || magnitude_bits(depth) >= 0x7f800000u {
        // The ray runs in the plane: by the weights.
        depth = (u * a.z + v * b.z + w * c.z) * scale;
        if magnitude_bits(depth) >= 0x7f800000u {
            return false;
        }
    }
    let mirrored = (triangle.geometry_and_mirror & #{MIRROR}) != 0u;
    let seen_from_front = (determinant > 0.0) == ray.forward;
    let front_face = seen_from_front != mirrored;
#ifdef ONE_SIDED
    if !(front_face && runs_against(ray, mirrored, plane.normal)) {
        return false;
    }
#endif
    let low = min(triangle.v0, min(triangle.v1, triangle.v2));
    let high = max(triangle.v0, max(triangle.v1, triangle.v2));
    let span = slab_span(ray, low, high);
    if max(span.entry, ray.t_min) > span.exit {
        return false;
    }
    // The depth first, in units of the scene, and then t: a short direction must not make it overflow.
    let t = without_negative_zero(min(max(depth * ray.shear.z, span.entry), span.exit));
    if t < ray.t_min || t > t_max {
        return false;
    }
    *hit = Hit(
        t,
        without_negative_zero(v * scale),
        without_negative_zero(w * scale),
        triangle.primitive,
        triangle.geometry_and_mirror & ~#{MIRROR},
        triangle.instance_and_mask & 0x00ffffffu,
        front_face,
    );
    return true;
}
