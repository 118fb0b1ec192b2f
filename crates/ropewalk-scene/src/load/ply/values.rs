//! The numbers of a PLY body, one after the other, written as text or in binary.

use super::header::{Element, Kind, Scalar};
use crate::LoadError;
use crate::load::source::Source;
use crate::load::text::{number, quoted};

/// A body that is read from its beginning to its end.
pub(super) trait Values {
    /// The next number.
    fn number(&mut self, scalar: Scalar) -> Result<f64, LoadError>;
    /// The next number, which should be whole. [`i64::MIN`] stands for one that is not.
    fn integer(&mut self, scalar: Scalar) -> Result<i64, LoadError>;
    /// Passes over numbers.
    fn skip(&mut self, scalar: Scalar, count: usize) -> Result<(), LoadError>;
    /// Fails when an element goes on where its line should end.
    fn end_element(&mut self) -> Result<(), LoadError>;
    /// The number of bytes that are not read.
    fn bytes_left(&self) -> usize;
    /// The least number of bytes that `count` numbers take; `None` when that is more than any file.
    fn least_bytes(&self, scalar: Scalar, count: u64) -> Option<u64>;
    /// The error that something is wrong here.
    fn wrong(&self, what: String) -> LoadError;

    /// The length of a list whose items come next, and fit in what is left.
    fn list_length(&mut self, length: Scalar, item: Scalar) -> Result<usize, LoadError> {
        let Ok(length) = u64::try_from(self.integer(length)?) else {
            return Err(self.wrong("the length of a list is negative or not whole".into()));
        };
        let left = self.bytes_left();
        match (self.least_bytes(item, length), usize::try_from(length)) {
            (Some(needed), Ok(length)) if needed <= left as u64 => Ok(length),
            _ => Err(self.wrong(format!("a list of {length} is promised, but only {left} bytes are left"))),
        }
    }

    /// Checks that what is left can hold an element as often as promised. Nothing needs to be checked where an
    /// element takes no bytes.
    fn check_count(&self, element: &Element) -> Result<(), LoadError> {
        let scalars = element.properties.iter().map(|property| match property.kind {
            Kind::One(scalar) => scalar,
            Kind::List { length, .. } => length,
        });
        let needed = scalars
            .map(|scalar| self.least_bytes(scalar, element.count))
            .try_fold(0u64, |sum, needed| sum.checked_add(needed?));
        let left = self.bytes_left() as u64;
        if needed.is_some_and(|needed| needed <= left) {
            return Ok(());
        }
        let Element { name, count, .. } = element;
        Err(self.wrong(format!("{count} elements '{name}' are promised, but only {left} bytes are left")))
    }
}

/// A body of text: words between blanks and line ends.
pub(super) struct Text<'a> {
    source: &'a Source,
    rest: &'a [u8],
    line: usize,
}

impl<'a> Text<'a> {
    pub(super) fn new(source: &'a Source, header_length: usize, line: usize) -> Self {
        Self { source, rest: source.bytes.get(header_length..).unwrap_or_default(), line }
    }

    fn word(&mut self) -> Result<&'a [u8], LoadError> {
        let mut rest = self.rest;
        loop {
            match rest {
                [b'\r', b'\n', after @ ..] | [b'\n' | b'\r', after @ ..] => {
                    self.line += 1;
                    rest = after;
                }
                [blank, after @ ..] if blank.is_ascii_whitespace() => rest = after,
                _ => break,
            }
        }
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(length);
        self.rest = rest;
        if word.is_empty() {
            return Err(self.wrong("the file ends where a number should stand".into()));
        }
        Ok(word)
    }
}

impl Values for Text<'_> {
    fn number(&mut self, _: Scalar) -> Result<f64, LoadError> {
        let word = self.word()?;
        number(word).ok_or_else(|| self.wrong(format!("{} is no number", quoted(word))))
    }

    fn integer(&mut self, _: Scalar) -> Result<i64, LoadError> {
        let word = self.word()?;
        if let Some(integer) = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok()) {
            return Ok(integer);
        }
        let value = number(word).ok_or_else(|| self.wrong(format!("{} is no number", quoted(word))))?;
        Ok(whole(value))
    }

    fn skip(&mut self, _: Scalar, count: usize) -> Result<(), LoadError> {
        (0..count).try_for_each(|_| self.word().map(drop))
    }

    fn end_element(&mut self) -> Result<(), LoadError> {
        let blanks = self.rest.iter().take_while(|&&byte| byte == b' ' || byte == b'\t').count();
        self.rest = self.rest.get(blanks..).unwrap_or_default();
        match self.rest.first() {
            None | Some(b'\n' | b'\r' | 0x0c) => Ok(()),
            Some(_) => Err(self.wrong("the line holds more numbers than the header describes".into())),
        }
    }

    fn bytes_left(&self) -> usize {
        self.rest.trim_ascii().len()
    }

    fn least_bytes(&self, _: Scalar, count: u64) -> Option<u64> {
        // Digits, and a blank behind all but the last.
        Some(count.checked_mul(2)?.saturating_sub(1))
    }

    fn wrong(&self, what: String) -> LoadError {
        self.source.malformed(format!("line {}", self.line), what)
    }
}

/// A binary body.
pub(super) struct Binary<'a, const BIG_ENDIAN: bool> {
    source: &'a Source,
    rest: &'a [u8],
}

impl<'a, const BIG_ENDIAN: bool> Binary<'a, BIG_ENDIAN> {
    pub(super) fn new(source: &'a Source, header_length: usize) -> Self {
        Self { source, rest: source.bytes.get(header_length..).unwrap_or_default() }
    }

    fn bytes<const SIZE: usize>(&mut self) -> Result<[u8; SIZE], LoadError> {
        let Some((bytes, rest)) = self.rest.split_first_chunk::<SIZE>() else { return Err(self.ends()) };
        self.rest = rest;
        let mut bytes = *bytes;
        if BIG_ENDIAN {
            bytes.reverse();
        }
        Ok(bytes)
    }

    #[cold]
    fn ends(&self) -> LoadError {
        self.wrong("the file ends where a number should stand".into())
    }
}

impl<const BIG_ENDIAN: bool> Values for Binary<'_, BIG_ENDIAN> {
    fn number(&mut self, scalar: Scalar) -> Result<f64, LoadError> {
        match scalar {
            Scalar::Float32 => Ok(f64::from(f32::from_le_bytes(self.bytes()?))),
            Scalar::Float64 => Ok(f64::from_le_bytes(self.bytes()?)),
            _ => Ok(self.integer(scalar)? as f64),
        }
    }

    fn integer(&mut self, scalar: Scalar) -> Result<i64, LoadError> {
        Ok(match scalar {
            Scalar::Int8 => i8::from_le_bytes(self.bytes()?).into(),
            Scalar::Uint8 => u8::from_le_bytes(self.bytes()?).into(),
            Scalar::Int16 => i16::from_le_bytes(self.bytes()?).into(),
            Scalar::Uint16 => u16::from_le_bytes(self.bytes()?).into(),
            Scalar::Int32 => i32::from_le_bytes(self.bytes()?).into(),
            Scalar::Uint32 => u32::from_le_bytes(self.bytes()?).into(),
            Scalar::Float32 | Scalar::Float64 => whole(self.number(scalar)?),
        })
    }

    fn skip(&mut self, scalar: Scalar, count: usize) -> Result<(), LoadError> {
        let rest = count.checked_mul(scalar.size()).and_then(|size| self.rest.get(size..));
        self.rest = rest.ok_or_else(|| self.ends())?;
        Ok(())
    }

    fn end_element(&mut self) -> Result<(), LoadError> {
        Ok(())
    }

    fn bytes_left(&self) -> usize {
        self.rest.len()
    }

    fn least_bytes(&self, scalar: Scalar, count: u64) -> Option<u64> {
        count.checked_mul(scalar.size() as u64)
    }

    fn wrong(&self, what: String) -> LoadError {
        self.source.malformed(format!("byte {}", self.source.bytes.len() - self.rest.len()), what)
    }
}

/// A float as an integer; [`i64::MIN`], which is no index, where it is none.
fn whole(value: f64) -> i64 {
    if value.fract() == 0.0 { value as i64 } else { i64::MIN }
}
