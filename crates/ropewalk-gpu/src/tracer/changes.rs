//! What differs between two contents of a buffer, and writing no more than that.

use super::content::Bytes;
use super::structure::PIECE;
use crate::scope::scoped;
use crate::{Gpu, GpuError};
use std::ops::Range;

/// Bytes that are compared, and written, at a time. A copy of a range costs a device about as much as that of some
/// kilobytes more, and a moved vertex changes few neighbours: with more, much is written that is what it was.
const GRAIN: u64 = 4 << 10;

/// The ranges in which `new` differs from `old`, or goes on behind its end. They follow each other and do not touch.
pub(super) fn between(old: Option<&Bytes<'_>>, new: &Bytes<'_>) -> Vec<Range<u64>> {
    let mut ranges: Vec<Range<u64>> = Vec::new();
    let mut at = 0;
    let end = new.written();
    while at < end {
        let is = new.from(at);
        let was = old.map_or(&[][..], |old| old.from(at));
        if !was.is_empty() && std::ptr::eq(is.as_ptr(), was.as_ptr()) {
            // What both versions share needs no look: the structures of objects that only moved.
            at += is.len().min(was.len()) as u64;
            continue;
        }
        let mut len = (is.len() as u64).min(GRAIN - at % GRAIN);
        if !was.is_empty() {
            len = len.min(was.len() as u64);
        }
        let next = at + len;
        if was.is_empty() || is[..len as usize] != was[..len as usize] {
            match ranges.last_mut() {
                Some(last) if last.end == at => last.end = next,
                _ => ranges.push(at..next),
            }
        }
        at = next;
    }
    ranges
}

/// Writes ranges of a content to their places in a buffer. The bytes go through buffers of no more than [`PIECE`] bytes, one
/// for many ranges. Whatever was sent to the device before comes before, whatever is sent later, later.
pub(super) fn write(
    gpu: &Gpu,
    buffer: &wgpu::Buffer,
    bytes: &Bytes<'_>,
    ranges: &[Range<u64>],
) -> Result<(), GpuError> {
    let most = (gpu.device().limits().max_buffer_size.min(PIECE as u64) / 4 * 4).max(4);
    let pieces: Vec<Range<u64>> = ranges.iter().flat_map(|range| cut(range, most)).collect();
    let mut rest = pieces.as_slice();
    while !rest.is_empty() {
        let mut size = 0;
        let together = rest.iter().take_while(|range| {
            size += range.end - range.start;
            size <= most
        });
        let (some, later) = rest.split_at(together.count().max(1));
        rest = later;
        stage(gpu, buffer, bytes, some)?;
    }
    Ok(())
}

/// A range in parts of no more than so many bytes.
fn cut(range: &Range<u64>, most: u64) -> impl Iterator<Item = Range<u64>> + use<> {
    let end = range.end;
    (range.start..end).step_by(most as usize).map(move |start| start..end.min(start + most))
}

/// Writes a few ranges through one buffer.
fn stage(gpu: &Gpu, buffer: &wgpu::Buffer, bytes: &Bytes<'_>, ranges: &[Range<u64>]) -> Result<(), GpuError> {
    let size = ranges.iter().map(|range| range.end - range.start).sum();
    let label = Some("ropewalk changes");
    let sent = scoped(gpu.device(), bytes.what, size, || {
        let staged = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label,
            size,
            usage: wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: true,
        });
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        {
            let mut view = staged.slice(..).get_mapped_range_mut()?;
            let mut place = 0;
            for range in ranges {
                let (mut at, first) = (range.start, place);
                while at < range.end {
                    let piece = bytes.from(at);
                    let piece = &piece[..piece.len().min((range.end - at) as usize)];
                    view.slice(place..place + piece.len()).copy_from_slice(piece);
                    at += piece.len() as u64;
                    place += piece.len();
                }
                let len = range.end - range.start;
                encoder.copy_buffer_to_buffer(&staged, first as u64, buffer, range.start, len);
            }
        }
        staged.unmap();
        gpu.queue().submit([encoder.finish()]);
        Ok(())
    })?;
    sent.map_err(|error: wgpu::MapRangeError| GpuError::Refused {
        what: "writing changes",
        reason: error.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::borrow::Cow;

    fn bytes<'a>(pieces: &[&'a [u8]]) -> Bytes<'a> {
        let pieces = pieces.iter().map(|&piece| Cow::Borrowed(piece)).collect();
        Bytes { what: "bytes", way_out: "", least: 8, most: u64::MAX, pieces }
    }

    #[test]
    fn what_differs_is_found_and_no_more() {
        let grain = GRAIN as usize;
        let old: Vec<u8> = (0..5 * grain + 40).map(|index| (index % 251) as u8).collect();
        let ranges = |new: &[u8], cut: usize| {
            let (a, b) = new.split_at(cut);
            between(Some(&bytes(&[&old])), &bytes(&[a, b]))
        };
        assert_eq!(ranges(&old, 100), []);
        let mut new = old.clone();
        new[grain] ^= 1;
        new[2 * grain - 1] ^= 1;
        assert_eq!(ranges(&new, 0), vec![GRAIN..2 * GRAIN; 1]);
        new[2 * grain] ^= 1;
        new[5 * grain + 39] ^= 1;
        assert_eq!(ranges(&new, 0), [GRAIN..3 * GRAIN, 5 * GRAIN..5 * GRAIN + 40]);
        // Where a piece ends, a range may end too.
        assert_eq!(ranges(&new, grain + 4)[0], GRAIN..3 * GRAIN);
        // What is shorter leaves the end as it was; what is longer goes on.
        assert_eq!(ranges(&old[..grain + 8], 0), []);
        new.truncate(5 * grain + 36);
        new.extend([7; 12]);
        assert_eq!(ranges(&new, 0).last(), Some(&(5 * GRAIN..5 * GRAIN + 48)));
        assert_eq!(between(None, &bytes(&[&old])), vec![0..5 * GRAIN + 40; 1]);
        assert_eq!(between(None, &bytes(&[])), []);
    }

    #[test]
    fn long_ranges_are_cut() {
        assert_eq!(cut(&(8..30), 8).collect::<Vec<_>>(), [8..16, 16..24, 24..30]);
        assert_eq!(cut(&(8..8), 8).count(), 0);
    }
}
