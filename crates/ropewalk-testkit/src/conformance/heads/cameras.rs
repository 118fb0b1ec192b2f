//! Two cameras, one that sees the case from outside and one within, and the heads of their screens: of the whole, and of
//! four and of sixteen cells a side. Rays go through pixels, and exactly through the borders and corners of cells.

use super::Batch;
use crate::cases::Case;
use crate::random::Random;
use crate::rays::View;
use glam::Vec3;
use ropewalk::traversal_list::Frustum;
use ropewalk::{Aabb, Ray, TraversalList};

/// Cells a side of the screen.
const CELLS: [u32; 3] = [1, 4, 16];
/// Rays of each camera through any place of the screen, besides those through the borders.
const ANYWHERE: usize = 128;

/// The rays of both cameras, with the heads of all grids; none of an empty scene.
pub(super) fn batch(list: &TraversalList, case: &Case) -> Vec<Batch> {
    let bounds = list.bounds();
    if bounds.is_empty() {
        return Vec::new();
    }
    let seed = case.name.bytes().map(u64::from).sum();
    let own = list.options().frustum_grid;
    let views = [View::of_bounds(&bounds), within(&bounds)];
    let batch = |(index, view): (usize, &View)| {
        let (rays, places) = rays(view, &mut Random::new(seed));
        let frusta: Vec<Frustum> =
            CELLS.into_iter().chain((own > 0).then_some(own)).map(|cells| frustum(view, cells)).collect();
        Batch {
            // The heads of a whole screen pass by little, and may enter far below what most rays miss: 2.3 times as much
            // as without them was seen, for any hit of the boxes from outside.
            slack: None,
            what: ["seen from outside", "seen from within"][index],
            rays,
            tables: frusta.iter().map(|frustum| list.frustum_heads(frustum)).collect(),
            rows: frusta
                .iter()
                .map(|frustum| places.iter().map(|&[x, y]| frustum.cell(x, y)).collect())
                .collect(),
        }
    };
    views.iter().enumerate().map(batch).collect()
}

/// In the middle, along an axis: the middle of the screen has directions with two zeros.
fn within(bounds: &Aabb) -> View {
    View::look_at(bounds.center(), bounds.center() + Vec3::X * bounds.size().max_element(), 1.0)
}

fn frustum(view: &View, cells: u32) -> Frustum {
    let [corner, right, down] = view.picture();
    Frustum { eye: view.eye().as_vec3(), corner, right, down, cells }
}

/// Rays, and their places on the screen. Every other has a direction of length 1, as a renderer's have.
fn rays(view: &View, random: &mut Random) -> (Vec<Ray>, Vec<[f32; 2]>) {
    let border = |index: usize| [index % 17, index / 17].map(|step| step as f32 / 16.0);
    let anywhere = (0..ANYWHERE).map(|_| [random.unit() as f32, random.unit() as f32]);
    let places: Vec<[f32; 2]> = (0..17 * 17).map(border).chain(anywhere).collect();
    let Frustum { eye, corner, right, down, .. } = frustum(view, 1);
    let ray = |(index, &[x, y]): (usize, &[f32; 2])| {
        let dir = corner + right * x + down * y;
        Ray::new(eye, if index.is_multiple_of(2) { dir } else { dir.normalize() })
    };
    (places.iter().enumerate().map(ray).collect(), places)
}
