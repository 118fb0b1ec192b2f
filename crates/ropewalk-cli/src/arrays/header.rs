//! The header of an `.npy` file: a magic word, a version, and a Python dictionary of three known keys.
//!
//! The dictionary is read by a scanner that knows just those keys and neither recurses nor allocates by what the
//! file declares. The header of any real file is below a kilobyte; the format allows 4 GiB, this reader 64 KiB.

use std::io::{self, Read};

const MAGIC: &[u8] = b"\x93NUMPY";
const LONGEST: usize = 1 << 16;

/// What a header says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Header {
    /// The element type, such as `<f4`.
    pub(crate) descr: String,
    /// Whether the first index runs fastest.
    pub(crate) fortran_order: bool,
    /// The lengths of the dimensions.
    pub(crate) shape: Vec<u64>,
}

impl Header {
    /// Reads a header; the reader then stands at the first element. `Err` holds what is wrong.
    pub(crate) fn read(reader: &mut impl Read) -> Result<Self, String> {
        let mut start = [0; 8];
        read_exact(reader, &mut start, "it is no .npy file: it is shorter than the first 8 bytes of one")?;
        if &start[..6] != MAGIC {
            let hint = if start.starts_with(b"PK") { "; it is a zip file, perhaps an .npz" } else { "" };
            return Err(format!("it is no .npy file: it does not begin with \\x93NUMPY{hint}"));
        }
        let cut = "it ends within its header";
        let length = match start[6] {
            1 => {
                let mut length = [0; 2];
                read_exact(reader, &mut length, cut)?;
                usize::from(u16::from_le_bytes(length))
            }
            2 | 3 => {
                let mut length = [0; 4];
                read_exact(reader, &mut length, cut)?;
                u32::from_le_bytes(length) as usize
            }
            version => {
                return Err(format!("it is an .npy file of version {version}; 1, 2 and 3 can be read"));
            }
        };
        if length > LONGEST {
            return Err(format!("its header claims {length} bytes; at most {LONGEST} are read"));
        }
        let mut text = vec![0; length];
        read_exact(reader, &mut text, cut)?;
        Self::parse(&String::from_utf8_lossy(&text))
    }

    fn parse(text: &str) -> Result<Self, String> {
        let bad = |what: &str| format!("its header is not that of an array of numbers: {what}");
        let value = |key: &str| {
            let quoted = [format!("'{key}'"), format!("\"{key}\"")];
            let after =
                quoted.iter().find_map(|quoted| text.split_once(quoted.as_str())).map(|(_, after)| after);
            let after = after.and_then(|after| after.trim_start().strip_prefix(':')).map(str::trim_start);
            after.ok_or_else(|| bad(&format!("there is no key '{key}'")))
        };
        let descr = value("descr")?;
        let quote = descr.chars().next().filter(|quote| matches!(quote, '\'' | '"'));
        let descr = quote
            .and_then(|quote| descr.get(1..)?.split_once(quote))
            .map(|(descr, _)| descr.to_owned())
            .ok_or_else(|| bad("its type has several fields"))?;
        let order = value("fortran_order")?;
        let fortran_order = match (order.starts_with("True"), order.starts_with("False")) {
            (true, _) => true,
            (_, true) => false,
            _ => return Err(bad("fortran_order is neither True nor False")),
        };
        let shape = value("shape")?;
        let shape = shape
            .strip_prefix('(')
            .and_then(|shape| shape.split_once(')'))
            .map(|(shape, _)| shape)
            .ok_or_else(|| bad("shape is no tuple"))?;
        let shape = shape
            .split(',')
            .map(str::trim)
            .filter(|length| !length.is_empty())
            .map(|length| length.parse().map_err(|_| bad(&format!("'{length}' in its shape is no length"))))
            .collect::<Result<_, _>>()?;
        Ok(Self { descr, fortran_order, shape })
    }

    /// The header as bytes, version 1, padded so that the elements begin at a multiple of 64.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let order = if self.fortran_order { "True" } else { "False" };
        let lengths: String = self.shape.iter().map(|length| format!("{length}, ")).collect();
        // A tuple of one needs its comma in Python; longer ones look better without the last one.
        let lengths = if self.shape.len() == 1 { lengths.trim_end() } else { lengths.trim_end_matches(", ") };
        let text = format!("{{'descr': '{}', 'fortran_order': {order}, 'shape': ({lengths}), }}", self.descr);
        let unpadded = MAGIC.len() + 4 + text.len() + 1;
        let length = text.len() + 1 + (64 - unpadded % 64) % 64;
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        bytes.extend((length as u16).to_le_bytes());
        bytes.extend(text.as_bytes());
        bytes.resize(MAGIC.len() + 4 + length - 1, b' ');
        bytes.push(b'\n');
        bytes
    }
}

/// Fills the buffer; a file that ends before is answered with `cut`.
pub(crate) fn read_exact(reader: &mut impl Read, buffer: &mut [u8], cut: &str) -> Result<(), String> {
    reader.read_exact(buffer).map_err(|error| match error.kind() {
        io::ErrorKind::UnexpectedEof => cut.into(),
        _ => error.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        for shape in [vec![], vec![3], vec![1_000_000, 6], vec![u64::MAX, 0, 2]] {
            let header = Header { descr: "<f4".into(), fortran_order: false, shape };
            let bytes = header.to_bytes();
            assert_eq!(bytes.len() % 64, 0);
            assert_eq!(Header::read(&mut bytes.as_slice()), Ok(header));
        }
    }

    #[test]
    fn odd_headers_are_read_or_refused() {
        let read = Header::parse("{\"shape\":(2,3L),'fortran_order': True,\"descr\":\">f8\"}");
        assert!(read.unwrap_err().contains("3L"), "the long integers of Python 2 are refused");
        let read = Header::parse("{\"shape\":( 2 , 3 ),'fortran_order': True,\"descr\" : \">f8\"}").unwrap();
        assert_eq!(read, Header { descr: ">f8".into(), fortran_order: true, shape: vec![2, 3] });
        for bad in [
            "",
            "{}",
            "{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (3,)}",
            "{'descr': '<f4', 'fortran_order': Maybe, 'shape': (3,)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (3,",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (-3,)}",
            "{'descr': '",
            "{'descr': \u{e9}",
        ] {
            assert!(Header::parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn damaged_files_are_refused() {
        let good = Header { descr: "<f4".into(), fortran_order: false, shape: vec![1, 6] }.to_bytes();
        for length in 0..good.len() {
            assert!(Header::read(&mut &good[..length]).is_err());
        }
        let mut version = good.clone();
        version[6] = 9;
        assert!(Header::read(&mut version.as_slice()).unwrap_err().contains("version 9"));
        let mut huge = good;
        huge[6] = 2;
        huge[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(Header::read(&mut huge.as_slice()).unwrap_err().contains("claims"));
        assert!(Header::read(&mut b"PK\x03\x04abcdefgh".as_slice()).unwrap_err().contains("npz"));
    }
}
