//! Drawing by the processor.
//!
//! Instances come from front to back. Of some at a time, few at first and more later, when much is hidden, it is found which pixels
//! each triangle may touch ([`super::footprint`]); then the tiles of the picture are drawn side by side, each ray tested against
//! what may touch its pixel. A tile knows how far its farthest ray reaches: what lies behind that is left out, triangles in
//! the tile and whole instances.
//!
//! **The same hits.** No triangle that a ray can meet is left out, each is tested as walks test it, and the tie rule does not
//! depend on the order. So the hits are a walk's, to the bit.
//!
//! **Cost.** 64 bytes for each of at most 2^18 triangles at a time in lists of tiles, about 110 bytes in footprints, and 250 bytes a
//! ray, of two levels twice that.

use super::drawing::Drawing;
use super::footprint::{Extent, Footprint, Window, meet};
use super::sight::Sight;
use super::tile::Tile;
use super::{Rasterised, Request};
use glam::{DVec2, Vec2};
use rayon::prelude::*;
use ropewalk::{Hit, Status};
use std::ops::Range;

/// The side of a tile with one ray a pixel: a thousand rays fit a core's own cache, and thousands of tiles many cores.
const TILE_SIDE: u32 = 32;
/// Triangles of the first instances that are drawn together, and of the last.
const FIRST_TRIANGLES: usize = 1 << 12;
const MOST_TRIANGLES: usize = 1 << 18;
/// Triangles that a thread looks at together.
const TOGETHER: usize = 1 << 11;
/// A triangle that may touch more tiles than this is listed once for all of them.
const FEW_TILES: usize = 16;

/// The tiles of a run of pixels.
struct Tiles {
    side: u32,
    /// Tiles in a row.
    in_row: usize,
    top: u32,
    tiles: Vec<Tile>,
    /// For each the footprints of this round, by number.
    lists: Vec<Vec<u32>>,
}

/// Triangles of one part.
struct Batch {
    rank: u32,
    triangles: Range<usize>,
}

/// The hits of a run's rays. The run must not be empty.
pub(super) fn hits(drawing: &Drawing<'_>, request: &Request<'_>) -> Rasterised {
    let window = window_of(request);
    let mut tiles = Tiles::new(&window, request);
    let size = [request.width, window.pixels[3] + 1];
    let order = drawing.front_to_back(request.pinhole.plane()[0]);
    let mut waiting = (0..).zip(&order).peekable();
    let mut most = FIRST_TRIANGLES;
    while waiting.peek().is_some() {
        let mut batches = Vec::new();
        let mut sights = Vec::new();
        let mut held = 0;
        while held < most {
            let Some((rank, &index)) = waiting.next() else { break };
            let part = &drawing.parts[index as usize];
            if !part.is_seen_by(request.pinhole.mask()) {
                continue;
            }
            let sight = Sight::new(request.pinhole, size, part);
            if sight.as_ref().is_some_and(|sight| tiles.hides(&window, sight, &part.bounds)) {
                continue;
            }
            held += part.triangles.len();
            let first = sights.len();
            sights.push(sight);
            let steps = part.triangles.clone().step_by(TOGETHER);
            batches.extend(steps.map(|from| {
                let to = (from + TOGETHER).min(part.triangles.end);
                (first, Batch { rank, triangles: from..to })
            }));
        }
        // A large instance is drawn in several rounds.
        for together in batches.chunks(MOST_TRIANGLES / TOGETHER) {
            let footprints: Vec<Footprint> = together
                .par_iter()
                .flat_map_iter(|(sight, batch)| {
                    let sight = sights[*sight].as_ref();
                    batch.triangles.clone().filter_map(move |index| {
                        let flat = &drawing.triangles[index];
                        Footprint::new(&window, sight, batch.rank, index as u32, flat)
                    })
                })
                .collect();
            tiles.draw(drawing, &order, &footprints, request);
        }
        most = (most * 2).min(MOST_TRIANGLES);
    }
    tiles.answer(request)
}

/// All pixels of a run's rows.
pub(super) fn window_of(request: &Request<'_>) -> Window {
    let [top, bottom] = request.rows();
    let fold = |start: Vec2, pick: fn(Vec2, Vec2) -> Vec2| {
        request.subpixels.iter().copied().fold(start, pick).as_dvec2()
    };
    let (least, largest): (DVec2, DVec2) =
        (fold(Vec2::INFINITY, Vec2::min), fold(Vec2::NEG_INFINITY, Vec2::max));
    Window { pixels: [0, top, request.width - 1, bottom], least, largest }
}

impl Tiles {
    fn new(window: &Window, request: &Request<'_>) -> Self {
        let side = (TILE_SIDE / (request.subpixels.len() as u32).isqrt().max(1)).max(4);
        let [_, top, right, bottom] = window.pixels;
        let columns: Vec<u32> = (0..=right).step_by(side as usize).collect();
        let rows: Vec<u32> = (top..=bottom).step_by(side as usize).collect();
        let corners: Vec<(u32, u32)> =
            rows.iter().flat_map(|&row| columns.iter().map(move |&column| (column, row))).collect();
        let tiles: Vec<Tile> = corners
            .into_par_iter()
            .map(|(left, above)| {
                let pixels = [left, above, (left + side - 1).min(right), (above + side - 1).min(bottom)];
                Tile::new(window.part(pixels), request)
            })
            .collect();
        let lists = vec![Vec::new(); tiles.len()];
        Self { side, in_row: columns.len(), top, tiles, lists }
    }

    /// The tiles that a rectangle of pixels touches.
    fn touched(&self, pixels: [u32; 4]) -> impl Iterator<Item = usize> + use<> {
        let [left, right] = [pixels[0], pixels[2]].map(|column| (column / self.side) as usize);
        let [above, below] = [pixels[1], pixels[3]].map(|row| ((row - self.top) / self.side) as usize);
        let in_row = self.in_row;
        (above..=below).flat_map(move |row| (left..=right).map(move |column| row * in_row + column))
    }

    /// Whether nothing of a box can be seen.
    fn hides(&self, window: &Window, sight: &Sight, bounds: &ropewalk::Aabb) -> bool {
        let (extent, nearest) = window.of_box(sight, bounds);
        let pixels = match extent {
            Extent::Outside => return true,
            Extent::Within(pixels, _) => pixels,
            Extent::Around => window.pixels,
        };
        self.touched(pixels).all(|tile| nearest > self.tiles[tile].far())
    }

    /// Draws triangles of which it is known what they may touch.
    fn draw(
        &mut self,
        drawing: &Drawing<'_>,
        order: &[u32],
        footprints: &[Footprint],
        request: &Request<'_>,
    ) {
        self.lists.iter_mut().for_each(Vec::clear);
        let mut wide = Vec::new();
        for (number, footprint) in (0..).zip(footprints) {
            if self.touched(footprint.pixels).take(FEW_TILES + 1).count() > FEW_TILES {
                wide.push(footprint);
                continue;
            }
            for tile in self.touched(footprint.pixels) {
                self.lists[tile].push(number);
            }
        }
        self.tiles.par_iter_mut().zip(&self.lists).for_each(|(tile, list)| {
            let touches = |footprint: &Footprint| {
                let [left, top, right, bottom] = meet(footprint.pixels, tile.window.pixels);
                left <= right && top <= bottom
            };
            let mut own: Vec<&Footprint> = list
                .iter()
                .map(|&number| &footprints[number as usize])
                .chain(wide.iter().copied().filter(|footprint| touches(footprint)))
                .filter(|footprint| footprint.nearest <= tile.far())
                .collect();
            tile.draw(drawing, order, &mut own, request);
        });
    }

    fn answer(&self, request: &Request<'_>) -> Rasterised {
        let mut hits = vec![Hit::MISS; request.rays.len()];
        let mut status = vec![Status::INVALID_RAY; request.rays.len()];
        for (place, hit) in self.tiles.iter().flat_map(Tile::answers) {
            hits[place] = hit;
            status[place] = Status::COMPLETE;
        }
        Rasterised { hits, status, traced_instead: 0 }
    }
}
