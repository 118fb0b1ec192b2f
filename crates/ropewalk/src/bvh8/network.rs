//! The sorting network of eight: 19 comparisons in six layers, the fewest there can be, and no branch.
//!
//! After Batcher and Floyd (Knuth, The Art of Computer Programming, volume 3, 5.3.4).

/// Eight in growing order, as `exchange` orders two of them. It may be asked of several lists at once, one a lane.
#[inline(always)]
pub(super) fn sorted<T>(eight: [T; 8], exchange: impl Fn(T, T) -> [T; 2]) -> [T; 8] {
    let [a, b, c, d, e, f, g, h] = eight;
    let ([a, c], [b, d], [e, g], [f, h]) = (exchange(a, c), exchange(b, d), exchange(e, g), exchange(f, h));
    let ([a, e], [b, f], [c, g], [d, h]) = (exchange(a, e), exchange(b, f), exchange(c, g), exchange(d, h));
    let ([a, b], [c, d], [e, f], [g, h]) = (exchange(a, b), exchange(c, d), exchange(e, f), exchange(g, h));
    let ([c, e], [d, f]) = (exchange(c, e), exchange(d, f));
    let ([b, e], [d, g]) = (exchange(b, e), exchange(d, g));
    let ([b, c], [d, e], [f, g]) = (exchange(b, c), exchange(d, e), exchange(f, g));
    [a, b, c, d, e, f, g, h]
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_list_of_zeros_and_ones_is_sorted() {
        // A network that sorts these sorts everything.
        for bits in 0..256 {
            let list: [u32; 8] = std::array::from_fn(|place| bits >> place & 1);
            let sorted = super::sorted(list, |a, b| [a.min(b), a.max(b)]);
            let mut expected = list;
            expected.sort_unstable();
            assert_eq!(sorted, expected);
        }
    }
}
