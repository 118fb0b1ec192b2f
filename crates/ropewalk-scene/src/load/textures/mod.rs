//! Pictures on their way into a model: found by the loaders, decoded here.
//!
//! The rules of the loaders hold for pictures too. How large a picture may become is decided from its header before
//! anything is allocated ([`budget`]), and a picture that is missing, broken or too large costs nothing but itself: its
//! surfaces keep their plain colours, and the report says how many such pictures there are and what is wrong with the
//! first.

mod budget;
mod decode;
mod ppm;

use crate::{Model, Texture};
use budget::Budget;

/// The pictures of one file.
#[derive(Debug, Default)]
pub(crate) struct Textures {
    list: Vec<Texture>,
    budget: Budget,
    /// How many could not be read, and what is wrong with the first.
    unreadable: usize,
    first: String,
}

/// What red, green and blue of a picture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Colors {
    /// Made to be shown: sRGB.
    Shown,
    /// Numbers of something else than light: linear.
    Data,
}

impl Textures {
    /// Decodes a picture: PNG, JPEG or binary PPM, told by its content. Returns its index; `None` where it cannot be read.
    pub(crate) fn decode(&mut self, name: &str, bytes: &[u8], colors: Colors) -> Option<u32> {
        match decode::decode(bytes, &mut self.budget) {
            Ok(picture) => {
                let decode::Picture { width, height, texels } = picture;
                let is_srgb = colors == Colors::Shown;
                self.list.push(Texture { name: name.into(), width, height, texels, is_srgb });
                Some(self.list.len() as u32 - 1)
            }
            Err(what) => {
                self.refuse(name, &what);
                None
            }
        }
    }

    /// A picture of the colours of one, white where there is none, and of the alpha of another: its own, or its brightness where
    /// it has none. `None` where they differ in size, where both are the same and have no alpha, or where there is no room.
    pub(crate) fn with_alpha(&mut self, color: Option<u32>, mask: u32) -> Option<u32> {
        let mask_picture = self.list.get(mask as usize)?;
        let has_alpha = mask_picture.texels.iter().any(|texel| texel[3] < 255);
        if color == Some(mask) {
            return has_alpha.then_some(mask);
        }
        let color = color.map(|color| self.list.get(color as usize));
        let size = |picture: &Texture| (picture.width, picture.height);
        if color.is_some_and(|color| color.map(size) != Some(size(mask_picture))) {
            return None;
        }
        let alpha = |&[red, green, blue, alpha]: &[u8; 4]| match has_alpha {
            true => alpha,
            false => ((u32::from(red) + u32::from(green) + u32::from(blue)) / 3) as u8,
        };
        let (width, height) = size(mask_picture);
        self.budget.take_more(width, height).ok()?;
        let mut texels: Vec<[u8; 4]> = match color.flatten() {
            Some(color) => color.texels.clone(),
            None => vec![[255; 4]; mask_picture.texels.len()],
        };
        for (texel, mask) in texels.iter_mut().zip(&mask_picture.texels) {
            texel[3] = alpha(mask);
        }
        let name = mask_picture.name.clone();
        self.list.push(Texture { name, width, height, texels, is_srgb: true });
        Some(self.list.len() as u32 - 1)
    }

    /// Counts a picture that cannot be read.
    pub(crate) fn refuse(&mut self, name: &str, what: &str) {
        self.unreadable += 1;
        if self.unreadable == 1 {
            self.first = format!("{name}: {what}");
        }
    }

    /// Puts the pictures into the model, and what could not be read into its report.
    pub(crate) fn finish(self, model: &mut Model) {
        if self.unreadable > 0 {
            let Self { unreadable, first, .. } = &self;
            let note = format!("{unreadable} textures: not read, surfaces keep their plain colours; {first}");
            model.report.notes.push(note);
        }
        model.textures = self.list;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_join_with_masks() {
        let mut textures = Textures::default();
        let mut picture = |bytes: &[u8]| textures.decode("x.ppm", bytes, Colors::Shown).unwrap();
        let (color, mask, other) = (
            picture(b"P6 2 1 255 abcdef"),
            picture(b"P6 2 1 255 \x00\x00\x00\xff\xff\xfe"),
            picture(b"P6 1 1 255 abc"),
        );
        let joined = textures.with_alpha(Some(color), mask).unwrap();
        assert_eq!(textures.list[joined as usize].texels, [*b"abc\x00", *b"def\xfe"]);
        let white = textures.with_alpha(None, mask).unwrap();
        assert_eq!(textures.list[white as usize].texels, [[255, 255, 255, 0], [255, 255, 255, 254]]);
        assert_eq!(textures.with_alpha(Some(joined), joined), Some(joined), "it has an alpha of its own");
        assert_eq!(textures.with_alpha(Some(color), white), Some(white + 1), "alpha goes before brightness");
        for (color, mask) in [(Some(color), color), (Some(other), mask), (Some(99), mask), (None, 99)] {
            assert_eq!(textures.with_alpha(color, mask), None);
        }
    }

    #[test]
    fn what_cannot_be_read_is_noted_once() {
        let mut textures = Textures::default();
        assert_eq!(textures.decode("a.ppm", b"P6 1 1 255 abc", Colors::Shown), Some(0));
        assert_eq!(textures.decode("b.ppm", b"P6 1 1 255 ab", Colors::Shown), None);
        assert_eq!(textures.decode("c.tga", b"TGA", Colors::Data), None);
        assert_eq!(textures.decode("d.ppm", b"P6 1 1 255 abc", Colors::Data), Some(1));
        let mut model = Model::default();
        textures.finish(&mut model);
        assert_eq!(model.textures.len(), 2);
        assert!(model.textures[0].is_srgb && !model.textures[1].is_srgb);
        let [note] = model.report.notes.as_slice() else { panic!("{:?}", model.report) };
        assert!(note.starts_with("2 textures: not read") && note.contains("b.ppm: "), "{note}");
    }
}
