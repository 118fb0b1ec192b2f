//! The pictures that a file names: each in the folder `TextureFiles` beside the main file, or in `TextureFiles.tar`
//! there, gzipped or not, as the BART scenes bring them.

use super::document::Document;
use crate::load::source::Source;
use crate::load::textures::{Colors, Textures};
use std::collections::HashMap;
use std::ops::Range;

const FOLDER: &str = "TextureFiles";

/// More pictures than any scene has; a file may not make the program ask the file system without end.
const MOST: usize = 4096;

/// Reads the pictures, and makes the materials name them: until then they name the names. Those whose picture is
/// missing or broken lose it.
pub(super) fn read(source: &Source, document: &mut Document) -> Textures {
    let mut pictures = Textures::default();
    let mut archive = None;
    let mut index_of = Vec::with_capacity(document.textures.len());
    for (number, name) in document.textures.iter().enumerate() {
        if number >= MOST {
            pictures.refuse(name, &format!("the file names more than {MOST} pictures, the limit"));
            index_of.push(None);
            continue;
        }
        index_of.push(match source.sibling(&format!("{FOLDER}/{name}")) {
            Ok(file) => pictures.decode(name, &file.bytes, Colors::Shown),
            Err(error) => {
                let archive = archive.get_or_insert_with(|| Archive::open(source));
                match archive.as_ref().and_then(|archive| archive.file(name)) {
                    Some(bytes) => pictures.decode(name, bytes, Colors::Shown),
                    None => {
                        let what = match archive {
                            Some(_) => format!("{FOLDER}.tar does not hold it"),
                            None => error.to_string(),
                        };
                        pictures.refuse(name, &what);
                        None
                    }
                }
            }
        });
    }
    for material in &mut document.materials {
        let Some(texture) = &mut material.base_color_texture else { continue };
        match index_of.get(texture.texture as usize).copied().flatten() {
            Some(index) => texture.texture = index,
            None => material.base_color_texture = None,
        }
    }
    pictures
}

/// An archive in memory, and where its files lie.
struct Archive {
    bytes: Vec<u8>,
    files: HashMap<Vec<u8>, Range<u64>>,
}

impl Archive {
    /// The archive beside a file. One that is broken holds what comes before the break.
    fn open(source: &Source) -> Option<Self> {
        let bytes = source.sibling(&format!("{FOLDER}.tar")).ok()?.bytes;
        let mut files = HashMap::new();
        for entry in tar::Archive::new(bytes.as_slice()).entries().ok()?.map_while(Result::ok) {
            if !entry.header().entry_type().is_file() {
                continue;
            }
            let start = entry.raw_file_position();
            let path = entry.path_bytes();
            let path = path.strip_prefix(b"./").unwrap_or(&path);
            let name = path.strip_prefix(FOLDER.as_bytes()).and_then(|path| path.strip_prefix(b"/"));
            files.insert(name.unwrap_or(path).to_vec(), start..start.saturating_add(entry.size()));
        }
        Some(Self { bytes, files })
    }

    /// The bytes of a file, as far as they are there.
    fn file(&self, name: &str) -> Option<&[u8]> {
        let Range { start, end } = self.files.get(name.as_bytes())?;
        let behind = self.bytes.get(usize::try_from(*start).ok()?..)?;
        let length = usize::try_from(end - start).unwrap_or(usize::MAX);
        Some(behind.get(..length).unwrap_or(behind))
    }
}
