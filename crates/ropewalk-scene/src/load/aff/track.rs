//! Keyframe tracks: what a key frame animation says for a time.
//!
//! Positions and scales run along the splines of Kochanek and Bartels, "Interpolating splines with local tension,
//! continuity, and bias control" (SIGGRAPH 1984), with the correction for keys that are not evenly spaced. Rotations
//! run along the same kind of curve through quaternions, as squads (Shoemake 1987). The first and the last key are
//! never reached: they shape the curve at their neighbours. Before the second key and after the last but one the
//! value stands still.
//!
//! Rotations follow the benchmark's own programs to the letter, since its published frames show what these make: the
//! key two ahead keeps the sign that it has in the file, while those before it are turned into one half of space.
//!
//! A look at a track costs a walk over its keys: times need not rise, so no search may skip any.

use super::quaternion::Quaternion;
use glam::DVec3;

/// A key: a value at a time, and how the curve bends there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Key<V> {
    pub(super) time: f64,
    pub(super) value: V,
    pub(super) tension: f64,
    pub(super) continuity: f64,
    pub(super) bias: f64,
}

/// How many keys a spline takes at least.
pub(super) const FEWEST_KEYS: usize = 4;

/// The keys around the part of a curve that a time falls into, from the one before its start to the one after its end.
struct Segment<V> {
    keys: [Key<V>; 4],
    /// From 0 at the start to 1 at the end.
    along: f64,
    /// Which key the second of the four is.
    start: usize,
}

impl<V: Copy> Segment<V> {
    /// `None` with fewer than four keys.
    fn at(keys: &[Key<V>], time: f64) -> Option<Self> {
        let last = keys.len().checked_sub(FEWEST_KEYS)? + 1;
        let time_of = |key: usize| keys.get(key).map_or(f64::NAN, |key| key.time);
        let (start, along) = if time <= time_of(1) {
            (1, 0.0)
        } else if time >= time_of(last + 1) {
            (last, 1.0)
        } else {
            // The first that ends later, also where times go back.
            let start = (1..=last).find(|&start| time_of(start + 1) > time)?;
            (start, (time - time_of(start)) / (time_of(start + 1) - time_of(start)))
        };
        let keys = keys.get(start - 1..)?.first_chunk().copied()?;
        Some(Self { keys, along, start })
    }

    /// The tangents at the start and the end of the segment; `steps` lead from each of the four keys to the next.
    fn tangents(&self, [before, here, after]: [DVec3; 3]) -> (DVec3, DVec3) {
        let [previous, from, to, next] = &self.keys;
        let factor = |whole: f64| if whole == 0.0 { 0.0 } else { 2.0 * (to.time - from.time) / whole };
        let outgoing = {
            let Key { tension: t, continuity: c, bias: b, .. } = from;
            let weights = ((1.0 - t) * (1.0 + c) * (1.0 + b) / 2.0, (1.0 - t) * (1.0 - c) * (1.0 - b) / 2.0);
            factor(to.time - previous.time) * (weights.0 * before + weights.1 * here)
        };
        let incoming = {
            let Key { tension: t, continuity: c, bias: b, .. } = to;
            let weights = ((1.0 - t) * (1.0 - c) * (1.0 + b) / 2.0, (1.0 - t) * (1.0 + c) * (1.0 - b) / 2.0);
            factor(next.time - from.time) * (weights.0 * here + weights.1 * after)
        };
        (outgoing, incoming)
    }
}

/// A track of positions or scales.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct VectorTrack(Vec<Key<DVec3>>);

impl VectorTrack {
    /// A track of at least four keys.
    pub(super) fn new(keys: Vec<Key<DVec3>>) -> Option<Self> {
        (keys.len() >= FEWEST_KEYS).then_some(Self(keys))
    }

    /// The value at a time.
    pub(super) fn at(&self, time: f64) -> DVec3 {
        let Some(segment) = Segment::at(&self.0, time) else { return DVec3::NAN };
        let [before, from, to, next] = segment.keys.map(|key| key.value);
        let (outgoing, incoming) = segment.tangents([from - before, to - from, next - to]);
        let u = segment.along;
        let (square, cube) = (u * u, u * u * u);
        from * (2.0 * cube - 3.0 * square + 1.0)
            + to * (3.0 * square - 2.0 * cube)
            + outgoing * (cube - 2.0 * square + u)
            + incoming * (cube - square)
    }
}

/// A track of rotations.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RotationTrack {
    /// As in the file.
    keys: Vec<Key<Quaternion>>,
    /// The keys, each but the first two turned to the half of space in which the one before it lies.
    aligned: Vec<Quaternion>,
}

impl RotationTrack {
    /// A track of at least four keys, each an axis and an angle in degrees.
    pub(super) fn new(keys: &[Key<(DVec3, f64)>]) -> Option<Self> {
        if keys.len() < FEWEST_KEYS {
            return None;
        }
        let quaternion = |key: &Key<(DVec3, f64)>| {
            let (axis, degrees) = key.value;
            let Key { time, tension, continuity, bias, .. } = *key;
            Key { time, value: Quaternion::from_axis_angle(axis, degrees), tension, continuity, bias }
        };
        let keys: Vec<_> = keys.iter().map(quaternion).collect();
        let mut aligned: Vec<Quaternion> = Vec::with_capacity(keys.len());
        for (index, key) in keys.iter().enumerate() {
            let is_opposite = aligned.last().is_some_and(|before| before.dot(key.value) < 0.0);
            aligned.push(if index >= 2 && is_opposite { key.value.negated() } else { key.value });
        }
        Some(Self { keys, aligned })
    }

    /// The rotation at a time.
    pub(super) fn at(&self, time: f64) -> Quaternion {
        let nowhere = Quaternion::NAN;
        let Some(segment) = Segment::at(&self.keys, time) else { return nowhere };
        let aligned = self.aligned.get(segment.start - 1..).and_then(<[_]>::first_chunk);
        let Some(&[before, from, to]) = aligned else { return nowhere };
        let [.., next] = segment.keys.map(|key| key.value);
        let step = |one: Quaternion, other: Quaternion| one.conjugate().times(other).log();
        let here = step(from, to);
        let (outgoing, incoming) = segment.tangents([step(before, from), here, step(to, next)]);
        let a = from.times(Quaternion::exp((outgoing - here) / 2.0));
        let b = to.times(Quaternion::exp((here - incoming) / 2.0));
        let u = segment.along;
        Quaternion::slerp(Quaternion::slerp(from, to, u), Quaternion::slerp(a, b, u), 2.0 * u * (1.0 - u))
    }
}

/// When something is shown.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct VisibilityTrack(pub(super) Vec<(f64, bool)>);

impl VisibilityTrack {
    /// Whether it is shown at a time: before the first key it is.
    pub(super) fn at(&self, time: f64) -> bool {
        self.0.iter().rev().find(|(from, _)| *from <= time).is_none_or(|&(_, is_shown)| is_shown)
    }
}

#[cfg(test)]
mod tests;
