//! `--frames` and `--shard`: which frames of an animation this run renders.

use crate::failure::Failure;
use ropewalk_scene::Span;
use std::str::FromStr;

/// How ranges are written.
const FORMS: &str = "frames are written A..B (without B), A..=B, A.., ..B, .. (all) or N";

/// Frames as the user wrote them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FrameRange {
    first: u32,
    /// The one behind the last; `None` for all there are.
    end: Option<u32>,
}

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = |text: &str| text.trim().parse::<u32>().map_err(|_| FORMS.to_owned());
        let behind = |last: u32| last.checked_add(1).ok_or_else(|| FORMS.to_owned());
        let (first, end) = match text.split_once("..") {
            None => {
                let frame = number(text)?;
                (frame, Some(behind(frame)?))
            }
            Some((first, end)) => {
                let first = if first.trim().is_empty() { 0 } else { number(first)? };
                let end = match end.strip_prefix('=') {
                    Some(last) => Some(behind(number(last)?)?),
                    None if end.trim().is_empty() => None,
                    None => Some(number(end)?),
                };
                (first, end)
            }
        };
        if end.is_some_and(|end| end <= first) {
            return Err(format!("no frame lies in {text}; {FORMS}"));
        }
        Ok(Self { first, end })
    }
}

impl FrameRange {
    /// The frames with their times; an error where the animation does not have them all.
    pub(super) fn resolve(self, span: Span) -> Result<Vec<(u32, f64)>, Failure> {
        let frames = span.frames.max(1);
        let end = self.end.unwrap_or(frames);
        if self.first >= frames || end > frames {
            let asked = if self.first >= frames { self.first } else { end - 1 };
            return Err(Failure::usage(format!(
                "there is no frame {asked}: the animation has {frames}, which are 0..{frames}"
            )));
        }
        Ok((self.first..end).map(|frame| (frame, span.time(frame))).collect())
    }
}

/// A share of the frames: of `count` runs this is the one of this number, and renders each frame that leaves it as the
/// remainder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shard {
    number: u32,
    count: u32,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parts = text.split_once('/').and_then(|(number, count)| {
            Some(Self { number: number.trim().parse().ok()?, count: count.trim().parse().ok()? })
        });
        parts.filter(|shard| shard.number < shard.count).ok_or_else(|| {
            "a share of the frames is written I/N, I from 0 to N - 1: the frames that divided by N leave I".into()
        })
    }
}

impl Shard {
    /// Whether a frame is this run's.
    pub(super) const fn has(self, frame: u32) -> bool {
        frame % self.count == self.number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_read() {
        let range = |text: &str| text.parse::<FrameRange>().map(|range| (range.first, range.end));
        assert_eq!(range("3..5"), Ok((3, Some(5))));
        assert_eq!(range("3..=5"), Ok((3, Some(6))));
        assert_eq!(range("3.."), Ok((3, None)));
        assert_eq!(range("..5"), Ok((0, Some(5))));
        assert_eq!(range(".."), Ok((0, None)));
        assert_eq!(range("7"), Ok((7, Some(8))));
        for wrong in
            ["", "a", "5..5", "6..5", "-1..5", "1...5", "1..=", "4294967295", "0..=4294967295", "1..2..3"]
        {
            assert!(range(wrong).unwrap_err().contains("A..B"), "{wrong}");
        }
    }

    #[test]
    fn frames_beyond_the_animation_are_refused() {
        let span = Span { start: 1.0, end: 3.0, frames: 5 };
        let frames = |text: &str| text.parse::<FrameRange>().unwrap().resolve(span);
        assert_eq!(frames("1..3").unwrap(), [(1, 1.5), (2, 2.0)]);
        assert_eq!(frames("..").unwrap().len(), 5);
        for (wrong, frame) in
            [("4..6", "frame 5"), ("5..", "frame 5"), ("0..=4294967294", "frame 4294967294")]
        {
            let failure = frames(wrong).unwrap_err();
            assert!(failure.message().contains(frame) && failure.message().contains("0..5"), "{failure:?}");
        }
    }

    #[test]
    fn shards_share_all_frames() {
        let shards: Vec<Shard> = ["0/3", "1/3", "2/3"].map(|text| text.parse().unwrap()).into();
        for frame in 0..20 {
            assert_eq!(shards.iter().filter(|shard| shard.has(frame)).count(), 1);
        }
        for wrong in ["", "3/3", "0/0", "1", "-1/2", "a/b", "1/2/3"] {
            assert!(wrong.parse::<Shard>().unwrap_err().contains("I/N"), "{wrong}");
        }
    }
}
