//! The part of a glTF 2.0 document that is read, as plain data, and the check that its references lead somewhere.
//!
//! Placements are read as f64: a part ten kilometres away would otherwise move by millimetres. Numbers that count or
//! refer are u64 and never narrowed, so a reference cannot wrap around to something else. What is not read
//! is not looked at, and a mistake in what says of pictures costs the picture ([`picture_document`](super::picture_document)),
//! not the geometry. (The crate `gltf` holds placements
//! in f32, cuts references to 32 bits, and refuses a document for any mistake: hence types of our own.)

use super::picture_document::{Image, List, Sampler, Texture, TextureInfo, lenient};
use crate::LoadError;
use crate::load::source::Source;
use serde::Deserialize;
use serde::de::IgnoredAny;

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Document {
    pub(super) asset: Asset,
    pub(super) scene: Option<u64>,
    pub(super) scenes: Vec<Roots>,
    pub(super) nodes: Vec<Node>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) accessors: Vec<Accessor>,
    pub(super) buffer_views: Vec<BufferView>,
    pub(super) buffers: Vec<Buffer>,
    pub(super) materials: Vec<Material>,
    pub(super) cameras: Vec<Camera>,
    pub(super) animations: Vec<IgnoredAny>,
    pub(super) textures: List<Texture>,
    pub(super) images: List<Image>,
    pub(super) samplers: List<Sampler>,
    pub(super) extensions: RootExtensions,
    pub(super) extensions_used: Vec<String>,
    pub(super) extensions_required: Vec<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Asset {
    pub(super) version: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Roots {
    pub(super) nodes: Vec<u64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub(super) name: Option<String>,
    pub(super) children: Vec<u64>,
    pub(super) mesh: Option<u64>,
    pub(super) camera: Option<u64>,
    pub(super) skin: Option<IgnoredAny>,
    // Boxed: few nodes of a large assembly have both a matrix and the rest.
    pub(super) matrix: Option<Box<[f64; 16]>>,
    pub(super) translation: Option<[f64; 3]>,
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
    pub(super) extensions: NodeExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub(super) light: Option<LightReference>,
}

#[derive(Debug, Deserialize)]
pub(super) struct LightReference {
    pub(super) light: u64,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Mesh {
    pub(super) name: Option<String>,
    pub(super) primitives: Vec<Primitive>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Primitive {
    pub(super) attributes: Attributes,
    pub(super) indices: Option<u64>,
    pub(super) material: Option<u64>,
    pub(super) mode: Option<u64>,
    pub(super) targets: Vec<IgnoredAny>,
    pub(super) extensions: PrimitiveExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "SCREAMING_SNAKE_CASE")]
pub(super) struct Attributes {
    pub(super) position: Option<u64>,
    pub(super) normal: Option<u64>,
    #[serde(rename = "TEXCOORD_0")]
    pub(super) texture_coordinates: Option<u64>,
    #[serde(rename = "COLOR_0")]
    pub(super) color: Option<IgnoredAny>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    pub(super) draco: Option<IgnoredAny>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<u64>,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u64,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: u64,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) sparse: Option<Sparse>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub(super) count: u64,
    pub(super) indices: SparseIndices,
    pub(super) values: SparseValues,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub(super) buffer_view: u64,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u64,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub(super) buffer_view: u64,
    #[serde(default)]
    pub(super) byte_offset: u64,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: u64,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    #[serde(default)]
    pub(super) byte_stride: u64,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Material {
    pub(super) name: Option<String>,
    pub(super) pbr_metallic_roughness: MetallicRoughness,
    pub(super) emissive_factor: Option<[f32; 3]>,
    #[serde(deserialize_with = "lenient")]
    pub(super) emissive_texture: Option<TextureInfo>,
    pub(super) alpha_mode: Option<String>,
    #[serde(deserialize_with = "lenient")]
    pub(super) alpha_cutoff: Option<f32>,
    pub(super) extensions: MaterialExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct MetallicRoughness {
    pub(super) base_color_factor: Option<[f32; 4]>,
    #[serde(deserialize_with = "lenient")]
    pub(super) base_color_texture: Option<TextureInfo>,
    #[serde(deserialize_with = "lenient")]
    pub(super) metallic_roughness_texture: Option<TextureInfo>,
    pub(super) metallic_factor: Option<f32>,
    pub(super) roughness_factor: Option<f32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_emissive_strength")]
    pub(super) emissive_strength: EmissiveStrength,
    #[serde(rename = "KHR_materials_transmission")]
    pub(super) transmission: Transmission,
    #[serde(rename = "KHR_materials_ior")]
    pub(super) refraction: Refraction,
    #[serde(rename = "KHR_materials_specular", deserialize_with = "lenient")]
    pub(super) specular: Option<Specular>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Specular {
    pub(super) specular_factor: Option<f32>,
    pub(super) specular_color_factor: Option<[f32; 3]>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct EmissiveStrength {
    pub(super) emissive_strength: Option<f32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Transmission {
    pub(super) transmission_factor: Option<f32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Refraction {
    pub(super) ior: Option<f32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Camera {
    pub(super) name: Option<String>,
    pub(super) perspective: Option<Perspective>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Perspective {
    pub(super) yfov: f32,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct RootExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub(super) punctual: Lights,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Lights {
    pub(super) lights: Vec<Light>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Light {
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) color: Option<[f32; 3]>,
    pub(super) intensity: Option<f32>,
}

/// What is read of a document that cannot be read in full.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Beginning {
    asset: Asset,
}

impl Document {
    /// Reads the text of a document.
    pub(super) fn parse(source: &Source, json: &[u8]) -> Result<Self, LoadError> {
        let parsed = serde_json::from_slice::<Self>(json);
        // Version 1 has other types in the same places: its version says more than the first of them.
        let version = match &parsed {
            Ok(document) => document.asset.version.clone(),
            Err(_) => serde_json::from_slice::<Beginning>(json).ok().and_then(|begun| begun.asset.version),
        };
        if let Some(version) = version.filter(|version| !version.starts_with("2.")) {
            let what = format!("this is glTF {version}; version 2 is read");
            return Err(source.malformed("asset.version", what));
        }
        parsed.map_err(|error| {
            let place = format!("JSON line {} column {}", error.line(), error.column());
            let text = error.to_string();
            // The message ends with the place, which is said already.
            let what = text.rsplit_once(" at line ").map_or(text.as_str(), |(what, _)| what);
            source.malformed(place, what)
        })
    }

    /// Checks that references between the parts that are read lead somewhere.
    pub(super) fn check_references(&self, source: &Source) -> Result<(), LoadError> {
        let check = |place: &dyn Fn() -> String, index: u64, what: &str, count: usize| {
            if index < count as u64 {
                return Ok(());
            }
            Err(source.malformed(place(), format!("this names {what} {index}, but the file has {count}")))
        };
        for (number, view) in self.buffer_views.iter().enumerate() {
            check(&|| format!("bufferViews[{number}]"), view.buffer, "buffer", self.buffers.len())?;
        }
        for (number, accessor) in self.accessors.iter().enumerate() {
            let sparse = accessor.sparse.as_ref();
            let sparse = sparse.map(|sparse| [sparse.indices.buffer_view, sparse.values.buffer_view]);
            for view in accessor.buffer_view.into_iter().chain(sparse.into_iter().flatten()) {
                check(&|| format!("accessors[{number}]"), view, "bufferView", self.buffer_views.len())?;
            }
        }
        for (number, mesh) in self.meshes.iter().enumerate() {
            for (part, primitive) in mesh.primitives.iter().enumerate() {
                let place = || format!("meshes[{number}].primitives[{part}]");
                for accessor in [primitive.indices, primitive.attributes.position].into_iter().flatten() {
                    check(&place, accessor, "accessor", self.accessors.len())?;
                }
                if let Some(material) = primitive.material {
                    check(&place, material, "material", self.materials.len())?;
                }
            }
        }
        for (number, node) in self.nodes.iter().enumerate() {
            let place = || format!("nodes[{number}]");
            for &child in &node.children {
                check(&place, child, "node", self.nodes.len())?;
            }
            if let Some(mesh) = node.mesh {
                check(&place, mesh, "mesh", self.meshes.len())?;
            }
            if let Some(camera) = node.camera {
                check(&place, camera, "camera", self.cameras.len())?;
            }
            if let Some(light) = &node.extensions.light {
                check(&place, light.light, "light", self.extensions.punctual.lights.len())?;
            }
        }
        for (number, scene) in self.scenes.iter().enumerate() {
            for &node in &scene.nodes {
                check(&|| format!("scenes[{number}]"), node, "node", self.nodes.len())?;
            }
        }
        Ok(())
    }

    /// A node in messages: its index, and its name where it has one.
    pub(super) fn node_place(&self, index: usize) -> String {
        match self.nodes.get(index).and_then(|node| node.name.as_ref()) {
            Some(name) => format!("nodes[{index}] '{name}'"),
            None => format!("nodes[{index}]"),
        }
    }
}

/// The element that a reference names.
pub(super) fn get<T>(list: &[T], index: u64) -> Option<&T> {
    list.get(usize::try_from(index).ok()?)
}
