// Hits and the tie rule: the twin of ropewalk's hit.rs.
// Source: DESIGN, "Ties": the smaller t, at equal t the smaller (instance, geometry, primitive).
// Invariants: a miss has every field written. WGSL has no word for infinity, so it comes with the batch.

struct Hit {
    t: f32,
    u: f32,
    v: f32,
    primitive: u32,
    geometry: u32,
    instance: u32,
    front_face: bool,
}

fn miss(infinity: f32) -> Hit {
    return Hit(infinity, 0.0, 0.0, #{NONE}, #{NONE}, #{NONE}, false);
}

// Whether `a` is preferred to `b`.
fn precedes(a: Hit, b: Hit) -> bool {
    if a.t != b.t {
        return a.t < b.t;
    }
    if a.instance != b.instance {
        return a.instance < b.instance;
    }
    if a.geometry != b.geometry {
        return a.geometry < b.geometry;
    }
    return a.primitive < b.primitive;
}
