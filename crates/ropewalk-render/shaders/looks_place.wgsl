// From a ray and its hit to the place on the surface: the twin of ropewalk-render's looks/place.rs.
// Source: the same; Hanika 2021 for the curved surface above the triangle.
// Invariants: same operations in the same order as in Rust. Sums of products are dot().

#import shared/hit
#import shared/ray
#import looks_words
#import looks_shaded
#import bsdf_arithmetic

struct Place {
    position: vec3<f32>,
    // From where rays leave it on the side from which it is seen, and on the other.
    origin_outside: vec3<f32>,
    origin_inside: vec3<f32>,
    // Both normals are of unit length and on the side from which the place is seen.
    geometric_normal: vec3<f32>,
    normal: vec3<f32>,
    // Against the ray, of unit length.
    to_eye: vec3<f32>,
    front: bool,
    uv: vec2<f32>,
    is_catcher: bool,
    material: Shaded,
}

// The rows of a triangle that a hit names; `is_there` where they lead anywhere.
struct PlaceRows {
    instance: u32,
    triangle: u32,
    is_there: bool,
}

fn rows_of(hit: Hit) -> PlaceRows {
    var rows = PlaceRows(0u, 0u, false);
    if hit.instance >= looks_word(#{LOOKS_INSTANCES}u + 1u) {
        return rows;
    }
    rows.instance = looks_row(#{LOOKS_INSTANCES}u, hit.instance, #{LOOKS_INSTANCE_WORDS}u);
    if hit.geometry >= looks_word(rows.instance + 22u) {
        return rows;
    }
    let geometry = looks_row(
        #{LOOKS_GEOMETRIES}u,
        looks_word(rows.instance + 21u) + hit.geometry,
        #{LOOKS_GEOMETRY_WORDS}u,
    );
    if hit.primitive >= looks_word(geometry + 1u) {
        return rows;
    }
    rows.triangle =
        looks_row(#{LOOKS_TRIANGLES}u, looks_word(geometry) + hit.primitive, #{LOOKS_TRIANGLE_WORDS}u);
    rows.is_there = looks_word(rows.triangle) != #{LOOKS_NOTHING};
    return rows;
}

// A value at a triangle's first corner, plus its changes along two edges times how far along them.
fn along_edges(first: f32, change_b: f32, change_c: f32, barycentrics: vec2<f32>) -> f32 {
    return first + kept(dot(vec2<f32>(change_b, change_c), barycentrics));
}

fn uv_of(triangle: u32, barycentrics: vec2<f32>) -> vec2<f32> {
    if looks_word(triangle + 6u) == #{LOOKS_NOTHING} {
        return vec2<f32>(0.0);
    }
    let a = looks_pair(looks_row(#{LOOKS_COORDINATES}u, looks_word(triangle + 6u), 2u));
    let b = looks_pair(looks_row(#{LOOKS_COORDINATES}u, looks_word(triangle + 7u), 2u));
    let c = looks_pair(looks_row(#{LOOKS_COORDINATES}u, looks_word(triangle + 8u), 2u));
    return vec2<f32>(
        along_edges(a.x, b.x - a.x, c.x - a.x, barycentrics),
        along_edges(a.y, b.y - a.y, c.y - a.y, barycentrics),
    );
}

// Whether there is a hole where the hit is: then it is no hit.
fn is_cut_out(hit: Hit) -> bool {
    let rows = rows_of(hit);
    if !rows.is_there {
        return false;
    }
    return is_hole(looks_word(rows.triangle + 9u), uv_of(rows.triangle, vec2<f32>(hit.u, hit.v)));
}

// A point of an instance's object in the scene.
fn to_world(instance: u32, point: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(
        dot(looks_vector(instance), point) + looks_float(instance + 3u),
        dot(looks_vector(instance + 4u), point) + looks_float(instance + 7u),
        dot(looks_vector(instance + 8u), point) + looks_float(instance + 11u),
    );
}

// A normal of an instance's object in the scene, not of unit length.
fn normal_to_world(instance: u32, normal: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(
        dot(looks_vector(instance + 12u), normal),
        dot(looks_vector(instance + 15u), normal),
        dot(looks_vector(instance + 18u), normal),
    );
}

fn vertex_of(rows: PlaceRows, corner: u32) -> vec3<f32> {
    let row = looks_row(#{LOOKS_VERTICES}u, looks_word(rows.triangle + corner), 3u);
    return to_world(rows.instance, looks_vector(row));
}

// The vector with length 1, or another where it is too short to have a direction.
fn unit_or(vector: vec3<f32>, other: vec3<f32>) -> vec3<f32> {
    let square = dot(vector, vector);
    return select(other, vector / sqrt(square), square > 1e-30);
}

// The vector or its opposite: the one on the side of `side`.
fn facing(vector: vec3<f32>, side: vec3<f32>) -> vec3<f32> {
    return select(vector, -vector, dot(vector, side) < 0.0);
}

fn largest_of(v: vec3<f32>) -> f32 {
    return max(max(v.x, v.y), v.z);
}

// The normal of a triangle, of unit length, from two of its edges; `other` for one that is no more than a line.
fn triangle_normal(first: vec3<f32>, second: vec3<f32>, other: vec3<f32>) -> vec3<f32> {
    let largest = largest_of(max(abs(first), abs(second)));
    if largest <= 0.0 {
        return other;
    }
    let ab = first / largest;
    let ac = second / largest;
    let bc = ac - ab;
    let ab_square = dot(ab, ab);
    let bc_square = dot(bc, bc);
    let ac_square = dot(ac, ac);
    var normal = cross(ab, ac);
    if ab_square >= bc_square && ab_square >= ac_square {
        normal = cross(ac, bc);
    } else if ac_square >= bc_square {
        normal = cross(ab, bc);
    }
    return unit_or(normal, other);
}

// How far off the triangle's plane rays leave it.
fn offset_step(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, normal: vec3<f32>) -> f32 {
    let largest = max(max(abs(a), abs(b)), abs(c));
    let size = max(max(a, b), c) - min(min(a, b), c);
    return (dot(abs(normal), largest) + largest_of(size)) * (8.0f / 16777216.0f);
}

fn normal_of(rows: PlaceRows, corner: u32, outward: vec3<f32>) -> vec3<f32> {
    let row = looks_row(#{LOOKS_NORMALS}u, looks_word(rows.triangle + 3u + corner), 3u);
    return facing(unit_or(normal_to_world(rows.instance, looks_vector(row)), outward), outward);
}

// The place of a hit, whose rows must be there, with its coordinates and the material there.
fn place_of(ray: Ray, hit: Hit, rows: PlaceRows, uv: vec2<f32>, material: Shaded) -> Place {
    let a = vertex_of(rows, 0u);
    let b = vertex_of(rows, 1u);
    let c = vertex_of(rows, 2u);
    let ab = b - a;
    let ac = c - a;
    let barycentrics = vec2<f32>(hit.u, hit.v);
    // Kept, or what is subtracted below would be taken out of it.
    let position = kept_vector(vec3<f32>(
        along_edges(a.x, ab.x, ac.x, barycentrics),
        along_edges(a.y, ab.y, ac.y, barycentrics),
        along_edges(a.z, ab.z, ac.z, barycentrics),
    ));
    let to_eye = unit(-ray.dir / largest_of(abs(ray.dir)));
    let outward = facing(triangle_normal(ab, ac, to_eye), to_eye);
    let step = offset_step(a, b, c, outward);
    var place: Place;
    place.position = position;
    place.origin_outside = position + outward * step;
    place.origin_inside = position - outward * step;
    place.geometric_normal = outward;
    place.normal = outward;
    place.to_eye = to_eye;
    place.front = hit.front_face;
    place.uv = uv;
    place.is_catcher = hit.instance == looks_word(#{LOOKS_CATCHER}u);
    place.material = material;
    if looks_word(rows.triangle + 3u) == #{LOOKS_NOTHING} {
        return place;
    }
    // The curved surface above the triangle.
    let na = normal_of(rows, 0u, outward);
    let nb = normal_of(rows, 1u, outward);
    let nc = normal_of(rows, 2u, outward);
    let weights = vec3<f32>(kept(1.0 - barycentrics.x) - barycentrics.y, barycentrics.x, barycentrics.y);
    let mean = sum_of_three(na, nb, nc, weights);
    if dot(mean, outward) <= 0.0 {
        return place;
    }
    place.normal = unit_or(mean, outward);
    let depths = vec3<f32>(dot(position - a, na), dot(position - b, nb), dot(position - c, nc));
    let below = min(depths, vec3<f32>(0.0)) * weights;
    let above = max(depths, vec3<f32>(0.0)) * weights;
    let bulge = kept_vector(sum_of_three(na, nb, nc, below));
    let hollow = kept_vector(sum_of_three(na, nb, nc, above));
    place.origin_outside = (position - bulge) + outward * step;
    place.origin_inside = (position - hollow) - outward * step;
    return place;
}
