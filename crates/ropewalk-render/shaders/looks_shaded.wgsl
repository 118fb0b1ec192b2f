// The material at a place: the twin of ropewalk-render's looks/shaded.rs.
// Source: the same.
// Invariants: same operations in the same order as in Rust.

#import looks_words
#import looks_texture

struct Shaded {
    base_color: vec3<f32>,
    emissive: vec3<f32>,
    ambient: vec3<f32>,
    roughness: f32,
    metallic: f32,
    transmission: f32,
    ior: f32,
    specular: vec3<f32>,
    gives_specular: bool,
    mirrors_sharply: bool,
}

// A material at texture coordinates.
fn shaded_material(material: u32, uv: vec2<f32>) -> Shaded {
    let at = looks_row(#{LOOKS_MATERIALS}u, material, #{LOOKS_MATERIAL_WORDS}u);
    let flags = looks_word(at + 11u);
    var shaded: Shaded;
    shaded.base_color = looks_vector(at);
    shaded.emissive = looks_vector(at + 4u);
    shaded.ambient = shaded.base_color;
    if (flags & #{MATERIAL_GIVES_AMBIENT}u) != 0u {
        shaded.ambient = looks_vector(at + 8u);
    }
    shaded.roughness = looks_float(at + 16u);
    shaded.metallic = looks_float(at + 17u);
    // In a loop that no compiler unrolls, so that there is one copy of what looks textures up.
    let textures = 3u | looks_word(#{LOOKS_ZERO}u);
    for (var i = 0u; i < textures; i += 1u) {
        let description = looks_word(at + 20u + i);
        if description == #{LOOKS_NOTHING} {
            continue;
        }
        let texel = look_up(description, uv);
        if i == 0u {
            shaded.base_color *= texel.xyz;
            shaded.ambient *= texel.xyz;
        } else if i == 1u {
            shaded.emissive *= texel.xyz;
        } else {
            shaded.roughness *= texel.y;
            shaded.metallic *= texel.z;
        }
    }
    shaded.transmission = looks_float(at + 18u);
    shaded.ior = looks_float(at + 15u);
    shaded.specular = looks_vector(at + 12u);
    shaded.gives_specular = (flags & #{MATERIAL_GIVES_SPECULAR}u) != 0u;
    if !shaded.gives_specular {
        let dielectric = looks_float(at + 19u);
        shaded.specular = vec3<f32>(
            mix_numbers(dielectric, shaded.base_color.x, shaded.metallic),
            mix_numbers(dielectric, shaded.base_color.y, shaded.metallic),
            mix_numbers(dielectric, shaded.base_color.z, shaded.metallic),
        );
    }
    shaded.mirrors_sharply = (flags & #{MATERIAL_MIRRORS_SHARPLY}u) != 0u;
    return shaded;
}

// Whether a material has a hole at texture coordinates.
fn is_hole(material: u32, uv: vec2<f32>) -> bool {
    let at = looks_row(#{LOOKS_MATERIALS}u, material, #{LOOKS_MATERIAL_WORDS}u);
    let cutoff = looks_float(at + 7u);
    if cutoff <= 0.0 {
        return false;
    }
    var alpha = looks_float(at + 3u);
    let color_texture = looks_word(at + 20u);
    if color_texture != #{LOOKS_NOTHING} {
        alpha *= look_up(color_texture, uv).w;
    }
    return alpha < cutoff;
}
