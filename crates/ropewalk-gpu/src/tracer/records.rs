//! The records of rays: what a kernel reads of each.
//!
//! A record is the ray's own nine words, with [`Query::All`](ropewalk::Query::All) where its hits go and how many there are
//! room for, and the heads with which it begins, one for each layer.

use ropewalk::Ray;
use std::borrow::Cow;
use std::ops::Range;

/// The rays of a batch, and the elements that they begin with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Records<'a> {
    rays: &'a [Ray],
    /// So many heads a ray.
    layers: usize,
    heads: &'a [u32],
}

impl<'a> Records<'a> {
    /// Of rays that begin where their structure does.
    pub(super) const fn plain(rays: &'a [Ray]) -> Self {
        Self { rays, layers: 0, heads: &[] }
    }

    /// Of rays with `layers` heads each, those of the first ray first.
    pub(super) fn from_heads(rays: &'a [Ray], layers: usize, heads: &'a [u32]) -> Self {
        debug_assert_eq!(rays.len() * layers, heads.len());
        Self { rays, layers, heads }
    }

    /// Heads a ray.
    pub(super) const fn starts(&self) -> u32 {
        self.layers as u32
    }

    /// How many rays there are.
    pub(super) const fn len(&self) -> usize {
        self.rays.len()
    }

    /// Ranges of so many rays each, but for the last.
    pub(super) fn parts(&self, rays: usize) -> impl Iterator<Item = Range<usize>> + use<> {
        let len = self.rays.len();
        (0..len).step_by(rays).map(move |first| first..len.min(first + rays))
    }

    /// The records of some rays, without places for hits.
    pub(super) fn of(&self, part: Range<usize>) -> Cow<'a, [u32]> {
        if self.layers == 0 {
            return Cow::Borrowed(bytemuck::cast_slice(&self.rays[part]));
        }
        let mut records = Vec::with_capacity(part.len() * (9 + self.layers));
        for ray in part {
            self.append(&mut records, ray, &[]);
        }
        Cow::Owned(records)
    }

    /// Appends the record of a ray with `places` for its hits.
    pub(super) fn append(&self, records: &mut Vec<u32>, ray: usize, places: &[u32]) {
        records.extend_from_slice(bytemuck::cast_slice(&self.rays[ray..=ray]));
        records.extend_from_slice(places);
        records.extend_from_slice(&self.heads[ray * self.layers..(ray + 1) * self.layers]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::glam::Vec3;

    #[test]
    fn a_record_has_the_ray_its_places_and_its_heads() {
        let rays: Vec<Ray> = (0..5).map(|index| Ray::new(Vec3::X * index as f32, Vec3::Z)).collect();
        let plain = Records::plain(&rays);
        assert_eq!(plain.parts(2).collect::<Vec<_>>(), [0..2, 2..4, 4..5]);
        assert_eq!(*plain.of(1..3), *bytemuck::cast_slice::<Ray, u32>(&rays[1..3]));
        let heads: Vec<u32> = (100..110).collect();
        let started = Records::from_heads(&rays, 2, &heads);
        let records = started.of(3..5);
        assert_eq!(records.len(), 2 * 11);
        assert_eq!((records[0], &records[9..11]), (3.0_f32.to_bits(), [106, 107].as_slice()));
        let mut record = Vec::new();
        started.append(&mut record, 4, &[7, 8]);
        assert_eq!(record[9..], [7, 8, 108, 109]);
    }
}
