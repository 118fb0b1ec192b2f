//! Where the sides of a node's boxes can be: along each axis 256 places, a step apart, from a corner on.
//!
//! A place is `corner + number * step`. Steps have three significant bits, so that the product is exact, fused or not, and the
//! one rounding is that of the sum: a side that is right without it is right with it, because what it must not pass is a float
//! itself. It is checked all the same, with the operations of the walk, and the step widened until it holds.
//!
//! **No number here is subnormal**, neither a corner nor a product nor a sum: a corner is 0 or at least 2^-100, and so is a step;
//! both are multiples of 2^-123 then, and so is each sum. A processor that flushes subnormal numbers to zero makes the same sides
//! as one that does not; and comparisons are of bits, which it does not touch. Boxes smaller than that become as large, where no
//! triangle can be hit any more. **Where a box is so large** that no step reaches across, a place may be infinite, which contains
//! everything.
//!
//! **Cost.** 16 bytes a node: three corners, and three steps of 10 bits, the exponent and two bits behind the leading one.

use crate::bvh8::tree::WIDTH;

/// The smallest step, and the smallest corner that is not 0: 2^-100.
const SMALLEST: f32 = f32::from_bits((127 - 100) << 23);

/// A step, as the upper bits of a float without its sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Step(u32);

impl Step {
    pub(super) const BITS: u32 = 10;
    /// The lower bits of a float, which steps do not have.
    const SHIFT: u32 = 31 - Self::BITS;
    const SMALLEST: Self = Self(SMALLEST.to_bits() >> Self::SHIFT);
    const LARGEST: Self = Self(f32::MAX.to_bits() >> Self::SHIFT);

    /// Of the lower bits of a word.
    #[inline(always)]
    pub(super) const fn from_bits(word: u32) -> Self {
        Self(word & ((1 << Self::BITS) - 1))
    }

    pub(super) const fn bits(self) -> u32 {
        self.0
    }

    #[inline(always)]
    pub(super) const fn length(self) -> f32 {
        f32::from_bits(self.0 << Self::SHIFT)
    }

    /// A step that is about as long, and not shorter than the smallest.
    fn near(length: f64) -> Self {
        let bits = (length as f32).to_bits() >> Self::SHIFT;
        Self(bits.clamp(Self::SMALLEST.0, Self::LARGEST.0))
    }

    /// The next longer one; the longest of all is its own.
    fn next(self) -> Self {
        Self((self.0 + 1).min(Self::LARGEST.0))
    }
}

/// The places along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ruler {
    pub(super) corner: f32,
    pub(super) step: Step,
}

impl Ruler {
    /// Of a node without boxes.
    pub(super) const NONE: Self = Self { corner: 0.0, step: Step::SMALLEST };

    /// A place, with the operations of the walk.
    #[inline(always)]
    pub(super) fn place(self, number: u8) -> f32 {
        self.corner + f32::from(number) * self.step.length()
    }

    /// The shortest that reaches from one number to another.
    fn across(low: f32, high: f32) -> Self {
        let corner = match rank(low).abs() < rank(SMALLEST) {
            true if rank(low) < 0 => -SMALLEST,
            true => 0.0,
            false => low,
        };
        let step = Step::near((f64::from(high) - f64::from(corner)) / 255.0);
        let mut ruler = Self { corner, step };
        while rank(ruler.place(255)) < rank(high) && ruler.step != Step::LARGEST {
            ruler.step = ruler.step.next();
        }
        ruler
    }

    /// The last place that is not above a side, or nearly so.
    fn below(self, side: f32) -> u8 {
        let mut number = self.steps_to(side).floor() as u8;
        while number > 0 && rank(self.place(number)) > rank(side) {
            number -= 1;
        }
        number
    }

    /// The first place that is not below a side, or nearly so.
    fn above(self, side: f32) -> u8 {
        let mut number = self.steps_to(side).ceil() as u8;
        while number < 255 && rank(self.place(number)) < rank(side) {
            number += 1;
        }
        number
    }

    /// Conversion to a byte keeps what is beyond its ends at its ends.
    fn steps_to(self, side: f32) -> f64 {
        (f64::from(side) - f64::from(self.corner)) / f64::from(self.step.length())
    }

    /// Whether the places of two numbers contain two sides.
    pub(super) fn contains(self, [below, above]: [u8; 2], [low, high]: [f32; 2]) -> bool {
        rank(self.place(below)) <= rank(low) && rank(self.place(above)) >= rank(high)
    }
}

/// The sides of some boxes along an axis, lower and upper.
pub(super) type Sides = [[u8; WIDTH]; 2];

/// What holds nothing is turned inside out.
pub(super) const NOTHING: [u8; 2] = [u8::MAX, 0];

/// The places along an axis, and the numbers of the sides of the first `filled` boxes: each contains the box that was given,
/// whose sides are finite.
pub(super) fn quantise(low: &[f32; WIDTH], high: &[f32; WIDTH], filled: usize) -> (Ruler, Sides) {
    let filled = filled.min(WIDTH);
    let mut sides = NOTHING.map(|number| [number; WIDTH]);
    let (Some(&first), Some(&last)) = (
        low[..filled].iter().min_by_key(|side| rank(**side)),
        high[..filled].iter().max_by_key(|side| rank(**side)),
    ) else {
        return (Ruler::NONE, sides);
    };
    let mut ruler = Ruler::across(first, last);
    loop {
        let mut holds = true;
        for place in 0..filled {
            let numbers = [ruler.below(low[place]), ruler.above(high[place])];
            holds &= ruler.contains(numbers, [low[place], high[place]]);
            (sides[0][place], sides[1][place]) = (numbers[0], numbers[1]);
        }
        if holds || ruler.step == Step::LARGEST {
            return (ruler, sides);
        }
        ruler.step = ruler.step.next();
    }
}

/// The order of floats as that of integers, both zeros alike: what no mode of the processor changes.
fn rank(number: f32) -> i32 {
    let size = (number.to_bits() & 0x7fff_ffff) as i32;
    if number.to_bits() >> 31 == 0 { size } else { -size }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// What holds of every quantised axis, flushed or not.
    fn check(low: [f32; WIDTH], high: [f32; WIDTH], filled: usize) -> Ruler {
        let (ruler, [below, above]) = quantise(&low, &high, filled);
        for place in 0..filled {
            let (numbers, sides) = ([below[place], above[place]], [low[place], high[place]]);
            assert!(ruler.contains(numbers, sides), "{sides:?} are not in {numbers:?} of {ruler:?}");
        }
        for place in filled..WIDTH {
            assert_eq!([below[place], above[place]], NOTHING);
        }
        for number in 0..=255 {
            let (product, place) = (f32::from(number) * ruler.step.length(), ruler.place(number));
            assert!(
                !ruler.corner.is_subnormal() && !product.is_subnormal() && !place.is_subnormal(),
                "{ruler:?}"
            );
            // A fused operation would make the same place.
            let fused = f32::from(number).mul_add(ruler.step.length(), ruler.corner);
            assert!(fused == place || place.is_infinite(), "{ruler:?}, {number}");
        }
        ruler
    }

    fn finite() -> impl Strategy<Value = f32> {
        prop_oneof![
            any::<u32>().prop_map(f32::from_bits).prop_filter("finite", |number| number.is_finite()),
            -10.0f32..10.0,
            (0u32..300, any::<bool>()).prop_map(|(bits, sign)| f32::from_bits(bits | u32::from(sign) << 31)),
            (any::<i16>())
                .prop_map(|ulps| f32::from_bits((1e6f32.to_bits() as i32 + i32::from(ulps)) as u32)),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn every_box_is_contained(
            sides in prop::array::uniform16(finite()),
            filled in 0..=WIDTH,
        ) {
            let low = std::array::from_fn(|place| sides[place].min(sides[8 + place]));
            let high = std::array::from_fn(|place| sides[place].max(sides[8 + place]));
            check(low, high, filled);
        }

        /// Boxes of one size, far away or near: no box grows by more than what two steps and rounding are.
        #[test]
        fn boxes_grow_little(
            corner in -1e6f32..1e6,
            size in 1e-3f32..1e3,
            parts in prop::array::uniform16(0.0f32..1.0),
        ) {
            let side = |part: f32| corner + part * size;
            let low: [f32; 8] = std::array::from_fn(|place| side(parts[place].min(parts[8 + place])));
            let high: [f32; 8] = std::array::from_fn(|place| side(parts[place].max(parts[8 + place])));
            let ruler = check(low, high, WIDTH);
            let (_, [below, above]) = quantise(&low, &high, WIDTH);
            let (first, last) = low.iter().zip(&high).fold((f32::MAX, f32::MIN), |(a, b), (&c, &d)| (a.min(c), b.max(d)));
            // A quarter longer than it must be at most.
            let most = (f64::from(last) - f64::from(first)) / 255.0 * 1.25 + 1e-30;
            prop_assert!(f64::from(ruler.step.length()) <= most);
            let slack = 1.001 * most + 1e-7 * f64::from(corner.abs() + size);
            for place in 0..WIDTH {
                prop_assert!(f64::from(low[place]) - f64::from(ruler.place(below[place])) <= slack);
                prop_assert!(f64::from(ruler.place(above[place])) - f64::from(high[place]) <= slack);
            }
        }
    }

    #[test]
    fn extreme_boxes_are_contained() {
        let tiny = f32::from_bits(1);
        let extremes = [
            0.0,
            -0.0,
            tiny,
            -tiny,
            f32::MIN_POSITIVE,
            -f32::MIN_POSITIVE,
            SMALLEST,
            -SMALLEST,
            1e-30,
            1.0,
            -1.0,
            1.0 + f32::EPSILON,
            1e12,
            -1e12,
            1e30,
            f32::MAX / 2.0,
            f32::MAX,
            f32::MIN,
        ];
        for low in extremes {
            for high in extremes.into_iter().filter(|&high| low <= high) {
                let mut boxes = ([low; WIDTH], [high; WIDTH]);
                check(boxes.0, boxes.1, WIDTH);
                // One of them flat, at either end.
                boxes.1[3] = low;
                boxes.0[5] = high;
                check(boxes.0, boxes.1, 7);
                check(boxes.0, boxes.1, 1);
            }
        }
        check([0.0; WIDTH], [0.0; WIDTH], 0);
    }

    #[test]
    fn flat_boxes_stay_flat() {
        let ruler = check([7.3; WIDTH], [7.3; WIDTH], WIDTH);
        assert_eq!((ruler.place(0), ruler.place(255)), (7.3, 7.3));
    }
}
