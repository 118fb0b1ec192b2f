//! The part of a glTF document that says what moves. It is read by itself and only where motion is asked for, so that a mistake
//! in it never costs the geometry.

use crate::LoadError;
use crate::load::source::Source;
use serde::Deserialize;

/// What is wrong with the keys of a sampler, as the end of `animation channels ...`.
pub(super) type SamplerError = &'static str;

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct MovingDocument {
    pub(super) animations: Vec<Animation>,
    pub(super) skins: Vec<Skin>,
    pub(super) nodes: Vec<SkinnedNode>,
    pub(super) meshes: Vec<SkinnedMesh>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Animation {
    pub(super) name: Option<String>,
    pub(super) channels: Vec<Channel>,
    pub(super) samplers: Vec<Sampler>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Channel {
    pub(super) sampler: u64,
    pub(super) target: Target,
}

#[derive(Debug, Deserialize)]
pub(super) struct Target {
    pub(super) node: Option<u64>,
    pub(super) path: String,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sampler {
    pub(super) input: u64,
    pub(super) output: u64,
    pub(super) interpolation: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Skin {
    pub(super) inverse_bind_matrices: Option<u64>,
    pub(super) joints: Vec<u64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct SkinnedNode {
    pub(super) skin: Option<u64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct SkinnedMesh {
    pub(super) primitives: Vec<SkinnedPrimitive>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct SkinnedPrimitive {
    pub(super) attributes: SkinAttributes,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "SCREAMING_SNAKE_CASE")]
pub(super) struct SkinAttributes {
    #[serde(rename = "JOINTS_0")]
    pub(super) joints: Option<u64>,
    #[serde(rename = "WEIGHTS_0")]
    pub(super) weights: Option<u64>,
    /// A second set of joints.
    #[serde(rename = "JOINTS_1")]
    pub(super) more_joints: Option<serde::de::IgnoredAny>,
}

impl MovingDocument {
    /// Reads what moves out of the text of a document.
    pub(super) fn parse(source: &Source, json: &[u8]) -> Result<Self, LoadError> {
        serde_json::from_slice(json).map_err(|error| {
            let place = format!("JSON line {} column {}", error.line(), error.column());
            source.malformed(place, format!("what moves cannot be read: {error}"))
        })
    }
}
