//! Large pictures are drawn in pieces: rectangles that fit a target.

use crate::raster::Request;
use crate::raster::footprint::Window;

/// A rectangle of the picture that is drawn at once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) left: u32,
    pub(super) top: u32,
    pub(super) width: u32,
    pub(super) height: u32,
}

impl Piece {
    pub(super) fn pixels(self) -> [u32; 4] {
        [self.left, self.top, self.left + self.width - 1, self.top + self.height - 1]
    }

    /// The pixels that are in the run: their places in the piece, and of their first samples among all rays.
    pub(super) fn pixels_of(self, request: &Request<'_>) -> impl Iterator<Item = ((u32, u32), usize)> {
        let pixels = (0..self.height).flat_map(move |row| (0..self.width).map(move |column| (column, row)));
        pixels.filter_map(move |(column, row)| {
            let first = request.first_sample(self.left + column, self.top + row)?;
            Some(((column, row), first))
        })
    }
}

/// The pieces of a window, none with a longer side.
pub(super) fn pieces(window: &Window, side: u32) -> Vec<Piece> {
    let [left, top, right, bottom] = window.pixels;
    let side = side.max(1);
    let mut pieces = Vec::new();
    for above in (top..=bottom).step_by(side as usize) {
        for before in (left..=right).step_by(side as usize) {
            let (width, height) = ((right - before + 1).min(side), (bottom - above + 1).min(side));
            pieces.push(Piece { left: before, top: above, width, height });
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn pieces_cover_each_pixel_once() {
        let window = Window { pixels: [3, 5, 40, 21], least: DVec2::ZERO, largest: DVec2::ONE };
        for side in [0, 1, 7, 16, 38, 4096] {
            let mut covered = std::collections::BTreeSet::new();
            for piece in pieces(&window, side) {
                let [left, top, right, bottom] = piece.pixels();
                assert!(piece.width <= side.max(1) && piece.height <= side.max(1));
                for row in top..=bottom {
                    assert!((left..=right).all(|column| covered.insert((column, row))), "{side}: twice");
                }
            }
            assert_eq!(covered.len(), 38 * 17, "{side}");
        }
    }
}
