// Traversal lists: the twin of ropewalk's traversal_list/element.rs and directions.rs. One part, list_word, has a
// header and the elements of all lists of all layers, five words each; the other, shared_word, has the vertices that all lists share,
// three words each, and behind them who each triangle is, three words too.
// Source: Toczek, Houzet, Mancini 2010, section 2.1. The header's places come from ropewalk-gpu's shader/list_layout.rs.
// Invariants: words are loaded as integers, since those of identity may look like a NaN. An element that is no triangle
//   has a next one, the first of its children; an escape index leads to an element of the same list, or is 0 or -1.

#import #{LIST_BUFFERS}
#import shared/triangle


// The place of an element that is not there: of the first of an empty list, and behind the last.
const NO_ELEMENT: u32 = 0xffffffffu;

struct Element {
    // How far it is to what comes after the subtree; 1 and 0 for a triangle, the last of which has 0; -1 for an inner
    // node whose subtree the list ends with.
    escape: i32,
    // A sphere, a box, or three vertices and the triangle's number.
    payload: vec4<u32>,
}

fn layer_count() -> u32 {
    return list_word(0);
}

// The place of the first element of a list, or NO_ELEMENT.
fn first_element(layer: u32, list: u32) -> u32 {
    return list_word(#{LIST_LAYERS_AT}u + #{LIST_LAYER_WORDS}u * layer + list);
}

fn load_element(place: u32) -> Element {
    let at = #{LIST_HEADER_WORDS}u + 5u * place;
    return Element(
        bitcast<i32>(list_word(at)),
        vec4<u32>(list_word(at + 1u), list_word(at + 2u), list_word(at + 3u), list_word(at + 4u)),
    );
}

fn is_triangle(element: Element) -> bool {
    // -1 becomes the largest number.
    return bitcast<u32>(element.escape) <= 1u;
}

fn load_vertex(index: u32) -> vec3<f32> {
    let at = 3u * index;
    return bitcast<vec3<f32>>(vec3<u32>(shared_word(at), shared_word(at + 1u), shared_word(at + 2u)));
}

// The triangle of an element that is one.
fn load_listed_triangle(payload: vec4<u32>) -> Triangle {
    let identity = list_word(2) + 3u * payload.w;
    return Triangle(
        load_vertex(payload.x),
        shared_word(identity),
        load_vertex(payload.y),
        shared_word(identity + 1u),
        load_vertex(payload.z),
        shared_word(identity + 2u),
    );
}

// The list that serves a ray: of 2, that of its sign along x; of 6, that of its largest component; of 8, that of its
// signs. The same in every layer.
fn list_of(ray: PreparedRay) -> u32 {
    let negative = vec3<u32>(ray.inverse < vec3<f32>(0.0));
    switch list_word(1) {
        case 2u: {
            return negative.x;
        }
        case 6u: {
            return 2u * ray.kz + u32(!ray.forward);
        }
        case 8u: {
            return negative.x | (negative.y << 1u) | (negative.z << 2u);
        }
        default: {
            return 0u;
        }
    }
}
