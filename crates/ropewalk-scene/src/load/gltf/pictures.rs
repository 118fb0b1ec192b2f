//! The pictures of materials: PNG and JPEG in a buffer view, in a data URI, or in a file beside the document.
//!
//! Only pictures that a material of the file uses are read, each once for what it is used as: colours are sRGB, metal and
//! roughness are not. Normal and occlusion maps are not read.

use super::buffers::Buffers;
use super::document::{self, get};
use super::picture_document::{Sampler, TextureInfo, TextureTransform};
use crate::load::textures::{Colors, Textures};
use crate::{Filter, Model, TextureUse, Wrap};
use glam::Vec2;
use std::collections::HashMap;

/// Reads the pictures of all materials of the document into the model, whose materials are those of the document.
pub(super) fn read(buffers: &Buffers<'_>, model: &mut Model) {
    let mut reader =
        Reader { buffers, textures: Textures::default(), read: HashMap::new(), turned: 0, other_set: 0 };
    for (material, stored) in model.materials.iter_mut().zip(&buffers.document.materials) {
        let document::MetallicRoughness { base_color_texture, metallic_roughness_texture, .. } =
            &stored.pbr_metallic_roughness;
        material.base_color_texture = reader.texture(base_color_texture.as_ref(), Colors::Shown);
        material.metallic_roughness_texture =
            reader.texture(metallic_roughness_texture.as_ref(), Colors::Data);
        material.emissive_texture = reader.texture(stored.emissive_texture.as_ref(), Colors::Shown);
    }
    let rows = [
        (reader.turned, "shown without the rotation of their KHR_texture_transform"),
        (reader.other_set, "use other texture coordinates than the first, left out"),
    ];
    let rows = rows.into_iter().filter(|&(count, _)| count > 0);
    model.report.notes.extend(rows.map(|(count, fate)| format!("{count} textures of materials: {fate}")));
    reader.textures.finish(model);
}

struct Reader<'b, 'a> {
    buffers: &'b Buffers<'a>,
    textures: Textures,
    /// Of the images that were asked for.
    read: HashMap<(u64, Colors), Option<u32>>,
    turned: usize,
    other_set: usize,
}

impl Reader<'_, '_> {
    fn texture(&mut self, info: Option<&TextureInfo>, colors: Colors) -> Option<TextureUse> {
        let info = info?;
        let plain = TextureTransform::default();
        let transform = info.extensions.transform.as_ref().unwrap_or(&plain);
        if transform.tex_coord.unwrap_or(info.tex_coord) != 0 {
            self.other_set += 1;
            return None;
        }
        let document = self.buffers.document;
        let Some(texture) = get(&document.textures.0, info.index) else {
            self.textures.refuse(&format!("textures[{}]", info.index), "there is no such texture");
            return None;
        };
        let Some(image) = texture.source else {
            let what = "it names no image of a kind that is read, PNG or JPEG";
            self.textures.refuse(&format!("textures[{}]", info.index), what);
            return None;
        };
        let index = match self.read.get(&(image, colors)) {
            Some(&index) => index,
            None => {
                let index = self.image(image, colors);
                self.read.insert((image, colors), index);
                index
            }
        };
        let plain = TextureUse::plain(index?);
        let pair = |pair: Option<[f32; 2]>, otherwise: Vec2| {
            pair.map(Vec2::from).filter(|pair| pair.is_finite()).unwrap_or(otherwise)
        };
        self.turned += usize::from(transform.rotation != 0.0);
        let sampler = texture.sampler.and_then(|sampler| get(&document.samplers.0, sampler));
        let (wrap, filter) = sampler.map_or((plain.wrap, plain.filter), look_up);
        let (scale, offset) = (pair(transform.scale, plain.scale), pair(transform.offset, plain.offset));
        Some(TextureUse { wrap, filter, scale, offset, ..plain })
    }

    fn image(&mut self, index: u64, colors: Colors) -> Option<u32> {
        let place = format!("images[{index}]");
        let buffers = self.buffers;
        let Some(image) = get(&buffers.document.images.0, index) else {
            self.textures.refuse(&place, "there is no such image");
            return None;
        };
        let name = match (&image.name, &image.uri) {
            (Some(name), _) => name,
            // A data URI is no name.
            (None, Some(uri)) if !uri.starts_with("data:") => uri,
            _ => &place,
        };
        if let Some(uri) = &image.uri {
            return match buffers.fetch(uri) {
                Ok(bytes) => self.textures.decode(name, &bytes, colors),
                Err(what) => {
                    self.textures.refuse(name, &what);
                    None
                }
            };
        }
        let Some(view) = image.buffer_view else {
            self.textures.refuse(name, "it has neither uri nor bufferView");
            return None;
        };
        match buffers.view(view, 0) {
            Ok(view) => self.textures.decode(name, view.bytes, colors),
            Err(error) => {
                self.textures.refuse(name, &error.to_string());
                None
            }
        }
    }
}

/// What a sampler says of the outside, and of the inside of texels that are seen large.
fn look_up(sampler: &Sampler) -> ([Wrap; 2], Filter) {
    const NEAREST: u64 = 9728;
    const CLAMP_TO_EDGE: u64 = 33071;
    const MIRRORED_REPEAT: u64 = 33648;
    let wrap = |code: Option<u64>| match code {
        Some(CLAMP_TO_EDGE) => Wrap::Clamp,
        Some(MIRRORED_REPEAT) => Wrap::Mirror,
        _ => Wrap::Repeat,
    };
    let filter = if sampler.mag_filter == Some(NEAREST) { Filter::Nearest } else { Filter::Linear };
    ([wrap(sampler.wrap_s), wrap(sampler.wrap_t)], filter)
}
