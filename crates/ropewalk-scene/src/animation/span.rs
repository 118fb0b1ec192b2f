//! From when to when an animation goes.

/// The most frames that an animation is cut into: more than a day at 60 a second.
pub const MOST_FRAMES: u32 = 1 << 23;

/// From when to when an animation goes, and how many frames it is cut into. The first and the last frame are at its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// When it begins, in seconds.
    pub start: f64,
    /// When it ends.
    pub end: f64,
    /// How many frames there are, from 1 to [`MOST_FRAMES`].
    pub frames: u32,
}

impl Span {
    /// Frames a second where a file does not say how many: film's.
    pub const FRAMES_PER_SECOND: f64 = 24.0;

    /// A span of [`Span::FRAMES_PER_SECOND`], to the nearest frame.
    #[must_use]
    pub fn of_seconds(start: f64, end: f64) -> Self {
        // A length that is no number is none; the cast keeps what is too large within 32 bits.
        let steps = ((end - start) * Self::FRAMES_PER_SECOND).round().max(0.0) as u32;
        Self { start, end, frames: steps.saturating_add(1).min(MOST_FRAMES) }
    }

    /// When a frame is, counted from 0.
    #[must_use]
    pub fn time(&self, frame: u32) -> f64 {
        match self.frames {
            0 | 1 => self.start,
            frames => self.start + f64::from(frame) * (self.end - self.start) / f64::from(frames - 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_are_frames() {
        let robots = Span { start: 0.0, end: 50.0, frames: 800 };
        assert!((robots.time(100) - 6.257_822_277_8).abs() < 1e-9);
        assert_eq!((robots.time(0), robots.time(799)), (0.0, 50.0));
        let museum = Span { start: -1.0, end: 5.0, frames: 300 };
        assert!((museum.time(100) - 1.006_688_963_2).abs() < 1e-9);
        assert_eq!(Span { start: 3.0, end: 9.0, frames: 1 }.time(7), 3.0);
        assert_eq!(Span { start: 3.0, end: 9.0, frames: 0 }.time(0), 3.0);
    }

    #[test]
    fn seconds_are_cut_into_frames() {
        assert_eq!(Span::of_seconds(1.0, 3.0).frames, 49);
        assert_eq!(Span::of_seconds(1.0, 1.0).frames, 1);
        assert_eq!(Span::of_seconds(5.0, 1.0).frames, 1);
        assert_eq!(Span::of_seconds(0.0, f64::NAN).frames, 1);
        assert_eq!(Span::of_seconds(0.0, f64::INFINITY).frames, MOST_FRAMES);
    }
}
