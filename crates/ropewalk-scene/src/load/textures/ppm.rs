//! Binary PPM (`P6`): a header of words, then three bytes or three big-endian pairs of bytes a texel.
//!
//! Our own reader: pictures of the BART scenes have comments that are not ASCII and bytes left over at their end, which
//! other readers refuse.

use super::budget::Budget;
use super::decode::Picture;

/// Reads a picture; its size is believed when its texels are there.
pub(super) fn decode(bytes: &[u8], budget: &mut Budget) -> Result<Picture, String> {
    let mut header = Header { rest: bytes.get(2..).unwrap_or_default() };
    let (width, height) = (header.number("width")?, header.number("height")?);
    let most = header.number("largest value")?;
    if most == 0 || most > 65535 {
        return Err(format!("its largest value is {most}; it must lie between 1 and 65535"));
    }
    // One white space ends the header: what follows may look like more.
    let rest = header.rest.get(1..).unwrap_or_default();
    let sample = if most > 255 { 2 } else { 1 };
    let need = u128::from(width) * u128::from(height) * 3 * sample as u128;
    let rows = usize::try_from(need).ok().and_then(|need| rest.get(..need)).ok_or_else(|| {
        format!("{width} by {height} texels take {need} bytes, but {} are there", rest.len())
    })?;
    budget.take(width, height, bytes.len())?;
    let scaled = |value: u32| ((value.min(most) * 255 + most / 2) / most) as u8;
    let texels = rows
        .chunks_exact(3 * sample)
        .map(|texel| {
            let part = |index: usize| {
                let digits = texel.get(index * sample..(index + 1) * sample).unwrap_or_default();
                scaled(digits.iter().fold(0, |value, &digit| value << 8 | u32::from(digit)))
            };
            [part(0), part(1), part(2), 255]
        })
        .collect();
    Ok(Picture { width, height, texels })
}

struct Header<'a> {
    rest: &'a [u8],
}

impl Header<'_> {
    /// The next number; `#` begins a comment to the end of its line.
    fn number(&mut self, what: &str) -> Result<u32, String> {
        let mut is_comment = false;
        let start = self.rest.iter().position(|&byte| {
            is_comment = if is_comment { byte != b'\n' && byte != b'\r' } else { byte == b'#' };
            !is_comment && !byte.is_ascii_whitespace()
        });
        let word = start.and_then(|start| self.rest.get(start..)).unwrap_or_default();
        let length = word.iter().position(|byte| !byte.is_ascii_digit()).unwrap_or(word.len());
        let (digits, behind) = word.split_at(length);
        self.rest = behind;
        let number = std::str::from_utf8(digits).ok().and_then(|digits| digits.parse().ok());
        number.ok_or_else(|| format!("its header gives no {what}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<Picture, String> {
        decode(bytes, &mut Budget::default())
    }

    #[test]
    fn rows_come_in_the_order_of_the_file() {
        let picture = read(b"P6\n# caf\xe9 3 3\n2 2\n#x\n255\n\nabcdefghijk and more").unwrap();
        assert_eq!((picture.width, picture.height), (2, 2));
        let rows = [*b"\nab\xff", *b"cde\xff", *b"fgh\xff", *b"ijk\xff"];
        assert_eq!(picture.texels, rows, "a line break may be the first sample");
    }

    #[test]
    fn other_largest_values_are_scaled() {
        assert_eq!(read(b"P6 1 1 15 \x00\x0f\x05").unwrap().texels, [[0, 255, 85, 255]]);
        assert_eq!(read(b"P6 1 1 15 \x00\x10\xff").unwrap().texels, [[0, 255, 255, 255]]);
        let wide = b"P6 1 1 65535 \x00\x00\xff\xff\x80\x80";
        assert_eq!(read(wide).unwrap().texels, [[0, 255, 128, 255]]);
    }

    #[test]
    fn headers_are_not_believed() {
        let cases: [(&[u8], &str); 8] = [
            (b"P6", "no width"),
            (b"P6 2 # 2", "no height"),
            (b"P6 2 -2 255 ", "no height"),
            (b"P6 99999999999 1 255 ", "no width"),
            (b"P6 1 1 0 abc", "largest value is 0"),
            (b"P6 1 1 65536 abcdef", "largest value is 65536"),
            (b"P6 4000000000 4000000000 255 abc", "3 are there"),
            (b"P6 1 1 256 abcde", "5 are there"),
        ];
        for (bytes, words) in cases {
            let error = read(bytes).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
    }
}
