//! The bytes of a scene file, un-gzipped, without byte order mark, with the name they came by. UTF-16 becomes UTF-8.
//!
//! Gzip is told by its magic number, never by the name; a file of several members is one stream. The size that a
//! gzip trailer claims is not believed: the output grows as bytes arrive, up to [`size_limit`].

use super::format::has_the_size_of_binary_stl;
use super::text::without_byte_order_mark;
use crate::LoadError;
use std::fs::{self, Metadata};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// The most that a file may hold once unpacked. A scene of 2³¹ triangles, the most that one structure takes, is
/// larger as text, but would not fit the memory of a machine that must hold it twice.
const LARGEST_CONTENT: u64 = 16 << 30;

/// Below this size a file may be packed as tightly as it likes.
const ALWAYS_UNPACKED: u64 = 1 << 30;

/// Meshes shrink by 2 to 30 times, deflate by at most 1032: what shrinks more than this is no mesh.
const LARGEST_RATIO: u64 = 256;

/// A file's content.
#[derive(Debug)]
pub(crate) struct Source {
    /// The name it came by, for messages and for files beside it.
    pub(crate) path: PathBuf,
    /// The content, un-gzipped, without byte order mark.
    pub(crate) bytes: Vec<u8>,
}

impl Source {
    /// Reads a file, gzipped or not.
    pub(crate) fn open(path: &Path) -> Result<Self, LoadError> {
        let failed = |source| LoadError::Io { path: path.into(), source };
        let file = fs::File::open(path).map_err(failed)?;
        let metadata = file.metadata().map_err(failed)?;
        if metadata.is_dir() {
            let what = "this is a directory; name a scene file in it";
            return Err(failed(io::Error::new(io::ErrorKind::IsADirectory, what)));
        }
        if !is_readable_to_an_end(&metadata) {
            return Err(failed(io::Error::other("this is a device, not a file")));
        }
        let mut bytes = Vec::new();
        // A file's size is what the system says, not what the file says: it may be allocated at once.
        let size = metadata.len().min(LARGEST_CONTENT);
        bytes.try_reserve_exact(usize::try_from(size).unwrap_or(0)).map_err(|error| failed(error.into()))?;
        file.take(LARGEST_CONTENT + 1).read_to_end(&mut bytes).map_err(failed)?;
        if bytes.len() as u64 > LARGEST_CONTENT {
            return Err(failed(too_large(LARGEST_CONTENT)));
        }
        Self::from_bytes(path, bytes)
    }

    /// Takes the content of a file, gzipped or not.
    pub(crate) fn from_bytes(path: &Path, bytes: Vec<u8>) -> Result<Self, LoadError> {
        let bytes = if bytes.starts_with(&[0x1f, 0x8b]) {
            unpack(&bytes, size_limit(bytes.len() as u64))
                .map_err(|source| LoadError::Io { path: path.into(), source })?
        } else {
            bytes
        };
        // A binary file may begin with anything; of the binary formats only STL has no magic number of its own.
        let bytes = if has_the_size_of_binary_stl(&bytes) { bytes } else { without_byte_order_mark(bytes) };
        Ok(Self { path: path.into(), bytes })
    }

    /// The error that this content breaks a rule at a place, such as `line 17`.
    pub(crate) fn malformed(&self, place: impl Into<String>, what: impl Into<String>) -> LoadError {
        LoadError::Malformed { path: self.path.clone(), place: place.into(), what: what.into() }
    }

    /// Reads a file that this one names: beside it, gzipped or not, or under the same name with `.gz` behind it.
    ///
    /// Names written on Windows are understood: where there is no such file, `\` is read as `/`.
    pub(crate) fn sibling(&self, name: &str) -> Result<Self, LoadError> {
        let directory = self.path.parent().unwrap_or(Path::new(""));
        let slashed = name.replace('\\', "/");
        let names = [name.to_owned(), format!("{name}.gz"), format!("{slashed}.gz"), slashed];
        // Only files: a scene may not make the program wait for a pipe.
        match names.iter().map(|name| directory.join(name)).find(|path| path.is_file()) {
            Some(path) => Self::open(&path),
            None => {
                let path = directory.join(name);
                Err(LoadError::Io {
                    path,
                    source: io::Error::new(io::ErrorKind::NotFound, "there is no such file"),
                })
            }
        }
    }
}

/// Pipes are welcome, `/dev/zero` is not.
#[cfg(unix)]
fn is_readable_to_an_end(metadata: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    metadata.is_file() || metadata.file_type().is_fifo()
}

#[cfg(not(unix))]
fn is_readable_to_an_end(metadata: &Metadata) -> bool {
    metadata.is_file()
}

/// How large the content of a gzip file of `packed` bytes may be.
fn size_limit(packed: u64) -> u64 {
    packed.saturating_mul(LARGEST_RATIO).clamp(ALWAYS_UNPACKED, LARGEST_CONTENT)
}

fn too_large(limit: u64) -> io::Error {
    let what = format!(
        "the content is larger than {limit} bytes, the limit for a file of this size; unpack or split it"
    );
    io::Error::new(io::ErrorKind::FileTooLarge, what)
}

fn unpack(packed: &[u8], limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    flate2::bufread::MultiGzDecoder::new(packed).take(limit + 1).read_to_end(&mut bytes).map_err(
        |error| {
            let what = match error.kind() {
                io::ErrorKind::UnexpectedEof => "it ends too early".to_owned(),
                _ => error.to_string(),
            };
            io::Error::new(
                error.kind(),
                format!("the gzip stream is broken after {} bytes: {what}", bytes.len()),
            )
        },
    )?;
    if bytes.len() as u64 > limit {
        return Err(too_large(limit));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn pack(content: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(content).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn members_follow_each_other() {
        let packed = [pack(b"one "), pack(b"two")].concat();
        assert_eq!(Source::from_bytes(Path::new("x"), packed).unwrap().bytes, b"one two");
    }

    #[test]
    fn a_broken_stream_is_an_error_at_every_length() {
        let packed = pack(&b"v 1 2 3\n".repeat(50));
        for length in 2..packed.len() {
            let error =
                Source::from_bytes(Path::new("x.gz"), packed[..length].to_vec()).unwrap_err().to_string();
            assert!(error.contains("x.gz") && error.contains("ends too early"), "{length}: {error}");
        }
        let mut flipped = packed;
        let checksum = flipped.len() - 8;
        flipped[checksum] ^= 1;
        assert!(Source::from_bytes(Path::new("x.gz"), flipped).unwrap_err().to_string().contains("gzip"));
    }

    #[test]
    fn limits_grow_with_the_file() {
        assert_eq!(size_limit(10), ALWAYS_UNPACKED);
        assert_eq!(size_limit(10 << 20), 2560 << 20);
        assert_eq!(size_limit(u64::MAX), LARGEST_CONTENT);
        let packed = pack(&[b' '; 5000]);
        assert_eq!(unpack(&packed, 5000).unwrap().len(), 5000);
        let error = unpack(&packed, 4999).unwrap_err().to_string();
        assert!(error.contains("larger than 4999 bytes"), "{error}");
    }

    #[test]
    fn siblings_are_found_packed_too() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("sub")).unwrap();
        fs::write(folder.path().join("sub/plain.mtl"), "plain").unwrap();
        fs::write(folder.path().join("packed.mtl.gz"), pack(b"packed")).unwrap();
        let source = Source::from_bytes(&folder.path().join("scene.obj"), Vec::new()).unwrap();
        assert_eq!(source.sibling("sub/plain.mtl").unwrap().bytes, b"plain");
        assert_eq!(source.sibling("sub\\plain.mtl").unwrap().bytes, b"plain");
        assert_eq!(source.sibling("packed.mtl").unwrap().bytes, b"packed");
        let error = source.sibling("missing.mtl").unwrap_err().to_string();
        assert!(error.contains("missing.mtl"), "{error}");
        assert!(source.sibling("sub").is_err(), "a directory is no file");
    }
}
