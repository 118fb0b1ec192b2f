// Panes, behind which light goes straight on: the twin of ropewalk-render's looks/panes.rs.
// Source: the same.
// Invariants: none.

#import bsdf
#import looks_shaded

// Whether some material is a pane, so that rays to lights must know what they meet.
fn has_panes() -> bool {
    return (looks_word(#{LOOKS_FLAGS}u) & #{LOOKS_HAS_PANES}u) != 0u;
}

// The share of light that goes straight on through a surface of this material; zero for what is no pane.
fn through_pane(material: Shaded, bsdf: Bsdf) -> vec3<f32> {
    return select(vec3<f32>(0.0), bsdf.through, material.ior == 1.0 && material.transmission > 0.0);
}
