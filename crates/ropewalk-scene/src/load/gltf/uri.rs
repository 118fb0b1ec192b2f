//! The names of buffers: data that stands in the name itself (RFC 2397), or the name of a file (RFC 3986).

/// What a URI stands for.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Uri {
    /// The bytes themselves.
    Data(Vec<u8>),
    /// A file beside the scene, by its name with percent codes resolved.
    File(String),
}

impl Uri {
    /// Reads a URI; an error says what is wrong with it.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        if let Some(data) = text.strip_prefix("data:") {
            let Some((kind, content)) = data.split_once(',') else {
                return Err("the data URI has no comma before its data".into());
            };
            let decode = if kind.ends_with(";base64") { base64 } else { |text: &str| Ok(percent(text)) };
            return decode(content).map(Self::Data);
        }
        if text.contains("://") {
            return Err(format!(
                "'{text}' is not a file beside the scene; fetch it and name it relative to the scene"
            ));
        }
        String::from_utf8(percent(text))
            .map(Self::File)
            .map_err(|_| format!("'{text}' is no UTF-8 once decoded"))
    }
}

/// Resolves percent codes; a `%` that begins none stands for itself.
fn percent(text: &str) -> Vec<u8> {
    let mut decoded = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, behind)) = rest.split_first() {
        let code = match behind {
            [high, low, ..] if first == b'%' => hex(*high).zip(hex(*low)),
            _ => None,
        };
        match code {
            Some((high, low)) => {
                decoded.push(high << 4 | low);
                rest = behind.get(2..).unwrap_or_default();
            }
            None => {
                decoded.push(first);
                rest = behind;
            }
        }
    }
    decoded
}

fn hex(digit: u8) -> Option<u8> {
    char::from(digit).to_digit(16).map(|value| value as u8)
}

/// Decodes base64 (RFC 4648), padded or not.
fn base64(text: &str) -> Result<Vec<u8>, String> {
    let digits = text.trim_end_matches('=');
    if text.len() - digits.len() > 2 {
        return Err("the base64 data ends with more than two '='".into());
    }
    let mut decoded = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    let (mut bits, mut held) = (0_u32, 0);
    for (index, &digit) in digits.as_bytes().iter().enumerate() {
        let value = match digit {
            b'A'..=b'Z' => digit - b'A',
            b'a'..=b'z' => digit - b'a' + 26,
            b'0'..=b'9' => digit - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => {
                return Err(format!("character {index} of the base64 data is no digit of base64"));
            }
        };
        bits = bits << 6 | u32::from(value);
        held += 6;
        if held >= 8 {
            held -= 8;
            decoded.push((bits >> held) as u8);
        }
    }
    // A byte takes two digits: one alone is left over from data that was cut off.
    if held == 6 { Err("the base64 data is cut off".into()) } else { Ok(decoded) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_the_standard() {
        let pairs =
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYmE", "fooba"), ("+/8=", "")];
        for (encoded, plain) in &pairs[..5] {
            assert_eq!(base64(encoded).as_deref(), Ok(plain.as_bytes()));
        }
        assert_eq!(base64(pairs[5].0), Ok(vec![0xfb, 0xff]));
        for broken in ["Z", "Zm9vY", "Zm9v!", "Z===", "Zm 9v"] {
            assert!(base64(broken).is_err(), "{broken}");
        }
    }

    #[test]
    fn kinds_of_names() {
        let file = |name: &str| Ok(Uri::File(name.into()));
        assert_eq!(Uri::parse("a%20b/%C3%A9.bin"), file("a b/é.bin"));
        assert_eq!(Uri::parse("100%.bin"), file("100%.bin"));
        assert_eq!(Uri::parse("data:application/octet-stream;base64,AAE="), Ok(Uri::Data(vec![0, 1])));
        assert_eq!(Uri::parse("data:,a%00"), Ok(Uri::Data(vec![b'a', 0])));
        for (broken, word) in [("data:xyz", "comma"), ("https://x/y.bin", "https"), ("%ff.bin", "UTF-8")] {
            assert!(Uri::parse(broken).unwrap_err().contains(word), "{broken}");
        }
    }
}
