// The kernel of rays.
// Source: as kernel/batch.
// Invariants: those of kernel/batch.

#import shared/ray
#import kernel/batch

#ifdef STARTS
// Where the record of the ray has its heads.
var<private> starts_at: u32;

// The element of its list with which the ray begins in a layer.
fn load_start(layer: u32) -> u32 {
    return records[starts_at + layer];
}
#endif

// RAY_WORDS a ray: nine, with ALL the place of its first hit and how many it has room for, with STARTS so many heads.
fn load_ray(index: u32) -> Ray {
    let at = #{RAY_WORDS}u * index;
    return Ray(
        bitcast<vec3<f32>>(vec3<u32>(records[at], records[at + 1u], records[at + 2u])),
        bitcast<f32>(records[at + 3u]),
        bitcast<vec3<f32>>(vec3<u32>(records[at + 4u], records[at + 5u], records[at + 6u])),
        bitcast<f32>(records[at + 7u]),
        records[at + 8u],
    );
}

fn answer(index: u32) {
    let ray = load_ray(index);
    var collect = new_collect(batch.infinity);
#ifdef STARTS
    starts_at = #{RAY_WORDS}u * (index + 1u) - #{STARTS}u;
#endif
#ifdef ALL
    collect.first = records[#{RAY_WORDS}u * index + 9u];
    collect.room = records[#{RAY_WORDS}u * index + 10u];
#endif
    var status = STATUS_INVALID_RAY;
    if is_valid(ray) {
        let prepared = prepare_ray(ray);
        collect.t_max = prepared.t_max;
#ifdef TWO_LEVEL
        status = lead(Seeker(ray, prepared), &collect);
#else
        status = lead(prepared, &collect);
#endif
    }
    store_result(index, collect, status);
}
