//! From the bytes of a picture file to texels.

use super::budget::Budget;
use super::ppm;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use std::io::Cursor;

/// A decoded picture.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Picture {
    pub(super) width: u32,
    pub(super) height: u32,
    /// `width * height` of them, the first row of the file first.
    pub(super) texels: Vec<[u8; 4]>,
}

/// Decodes a picture, told by its first bytes; an error says why it cannot be read.
pub(super) fn decode(bytes: &[u8], budget: &mut Budget) -> Result<Picture, String> {
    match bytes {
        [b'P', b'6', ..] => ppm::decode(bytes, budget),
        [0x89, b'P', b'N', b'G', ..] => packed(bytes, ImageFormat::Png, budget),
        [0xff, 0xd8, 0xff, ..] => packed(bytes, ImageFormat::Jpeg, budget),
        _ => Err("it is neither PNG, JPEG nor binary PPM; convert it to PNG".into()),
    }
}

/// The most that decoding may allocate for a texel: four samples of two bytes, and as much again for tables and rows.
const DECODER_BYTES: u64 = 16;

fn packed(bytes: &[u8], format: ImageFormat, budget: &mut Budget) -> Result<Picture, String> {
    let mut limits = Limits::default();
    limits.max_image_width = Some(Budget::LONGEST);
    limits.max_image_height = Some(Budget::LONGEST);
    limits.max_alloc = Some(Budget::most(bytes.len()) * DECODER_BYTES);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(|error| error.to_string())?;
    let (width, height) = decoder.dimensions();
    budget.take(width, height, bytes.len())?;
    let image = DynamicImage::from_decoder(decoder).map_err(|error| error.to_string())?;
    let texels = image.into_rgba8().into_raw().as_chunks::<4>().0.to_vec();
    Ok(Picture { width, height, texels })
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{Rgba, RgbaImage};

    fn packed_as(format: ImageFormat, width: u32, height: u32) -> Vec<u8> {
        let picture =
            RgbaImage::from_fn(width, height, |x, y| Rgba([(x * 40) as u8, (y * 80) as u8, 7, 128]));
        let picture = DynamicImage::ImageRgba8(picture);
        let picture =
            if format == ImageFormat::Jpeg { DynamicImage::ImageRgb8(picture.into_rgb8()) } else { picture };
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn png_and_jpeg_are_told_by_their_content() {
        let png = decode(&packed_as(ImageFormat::Png, 3, 2), &mut Budget::default()).unwrap();
        assert_eq!((png.width, png.height), (3, 2));
        assert_eq!(png.texels[5], [80, 80, 7, 128]);
        let jpeg = decode(&packed_as(ImageFormat::Jpeg, 16, 8), &mut Budget::default()).unwrap();
        assert_eq!((jpeg.width, jpeg.height, jpeg.texels.len()), (16, 8, 128));
        assert!(jpeg.texels.iter().all(|texel| texel[3] == 255));
        assert!(decode(b"GIF89a", &mut Budget::default()).unwrap_err().contains("neither PNG"));
    }

    #[test]
    fn broken_pictures_are_errors_at_every_length() {
        for format in [ImageFormat::Png, ImageFormat::Jpeg] {
            let whole = packed_as(format, 8, 8);
            for length in 0..whole.len() {
                // A JPEG that lacks its last bits may still be a picture; it must have its size then.
                if let Ok(picture) = decode(&whole[..length], &mut Budget::default()) {
                    assert_eq!(picture.texels.len(), 64, "{format:?} {length}");
                }
            }
        }
    }

    #[test]
    fn flipped_bits_are_errors_or_other_pictures() {
        for format in [ImageFormat::Png, ImageFormat::Jpeg] {
            let whole = packed_as(format, 24, 16);
            for place in 0..whole.len() {
                for bit in [0, 3, 7] {
                    let mut bytes = whole.clone();
                    bytes[place] ^= 1 << bit;
                    if let Ok(picture) = decode(&bytes, &mut Budget::default()) {
                        let count = picture.width as usize * picture.height as usize;
                        assert_eq!(picture.texels.len(), count, "{format:?} {place} {bit}");
                    }
                }
            }
        }
    }

    #[test]
    fn headers_are_not_believed() {
        let mut png = packed_as(ImageFormat::Png, 8, 8);
        png[16..24].copy_from_slice(&[0, 0, 0x7f, 0xff, 0, 0, 0x7f, 0xff]);
        assert!(decode(&png, &mut Budget::default()).is_err());
        let mut jpeg = packed_as(ImageFormat::Jpeg, 8, 8);
        let frame = jpeg.windows(2).position(|pair| pair == [0xff, 0xc0]).unwrap();
        jpeg[frame + 5..frame + 9].copy_from_slice(&[0xff; 4]);
        assert!(decode(&jpeg, &mut Budget::default()).is_err());
        // Within the longest side, but more than so few bytes can hold beside others.
        let mut budget = Budget::default();
        jpeg[frame + 5..frame + 9].copy_from_slice(&[0x40, 0, 0x40, 0]);
        assert!(decode(&jpeg, &mut budget).unwrap_err().contains("limit"));
    }
}
