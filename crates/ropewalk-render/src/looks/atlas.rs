//! One picture for all textures: shelves of pictures of about the same height (shelf packing). Sorted by height, each
//! shelf wastes little; the atlas is at most about twice as large as its textures, or one texture's width wide.

use crate::error::RenderError;
use ropewalk_scene::Texture;

/// The most texels: 2^30, 4 GiB.
const MOST_TEXELS: u64 = 1 << 30;

/// Where each texture stands, and the texels of all.
#[derive(Debug)]
pub(super) struct Atlas {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) texels: Vec<u32>,
    /// Column and row of the first texel of each texture; `None` for one that is no picture.
    pub(super) places: Vec<Option<[u32; 2]>>,
}

/// Whether a texture has as many texels as its size says, and some.
fn is_picture(texture: &Texture) -> bool {
    let texels = u64::from(texture.width) * u64::from(texture.height);
    texels > 0 && texels <= MOST_TEXELS && texels == texture.texels.len() as u64
}

impl Atlas {
    pub(super) fn new(textures: &[Texture]) -> Result<Self, RenderError> {
        let mut order: Vec<usize> =
            (0..textures.len()).filter(|&index| is_picture(&textures[index])).collect();
        order.sort_by_key(|&index| (std::cmp::Reverse(textures[index].height), index));
        let area: u64 = order.iter().map(|&index| textures[index].texels.len() as u64).sum();
        let widest = order.iter().map(|&index| textures[index].width).max().unwrap_or(1);
        let width = widest.max(area.isqrt().min(1 << 15) as u32).max(1);
        let mut places = vec![None; textures.len()];
        let (mut column, mut row, mut next_row) = (0_u32, 0_u64, 0_u64);
        for &index in &order {
            let texture = &textures[index];
            if width - column < texture.width {
                (column, row) = (0, next_row);
            }
            if column == 0 {
                next_row = row + u64::from(texture.height);
            }
            if next_row * u64::from(width) > MOST_TEXELS {
                return Err(RenderError::Textures { texels: area, most: MOST_TEXELS });
            }
            places[index] = Some([column, row as u32]);
            column += texture.width;
        }
        let height = next_row.max(1) as u32;
        let count = width as usize * height as usize;
        let mut texels = Vec::new();
        texels
            .try_reserve_exact(count)
            .map_err(|_| RenderError::Textures { texels: area, most: MOST_TEXELS })?;
        texels.resize(count, 0);
        for (texture, place) in textures.iter().zip(&places) {
            let Some([column, row]) = *place else { continue };
            for (y, line) in texture.texels.chunks_exact(texture.width as usize).enumerate() {
                let start = (row as usize + y) * width as usize + column as usize;
                for (to, texel) in texels[start..start + line.len()].iter_mut().zip(line) {
                    *to = u32::from_le_bytes(*texel);
                }
            }
        }
        Ok(Self { width, height, texels, places })
    }
}
