//! Pictures into files: PNG (8-bit sRGB) and EXR (32-bit linear, with depth, coverage and layers).
//!
//! A file is written beside its target under a temporary name and renamed when it is whole, so what stands
//! under the final name is complete, or what was there before.

use crate::error::ImageError;
use crate::film::Film;
use crate::metadata::Metadata;
use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, Image, LineOrder, Text, WritableImage};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A format of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageFormat {
    /// 8-bit sRGB.
    Png,
    /// 32-bit linear.
    Exr,
}

impl ImageFormat {
    /// The format that the ending of a name says.
    ///
    /// # Errors
    /// When it says none that is known.
    pub fn from_path(path: &Path) -> Result<Self, ImageError> {
        let extension = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
        match extension.as_deref().and_then(std::ffi::OsStr::to_str) {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(ImageError::UnknownExtension { path: path.into() }),
        }
    }
}

/// Finds out, before any work is done, whether a picture can be written there: the ending, the folder, and
/// whether the folder takes files.
///
/// # Errors
/// When it cannot.
pub fn check(path: &Path) -> Result<ImageFormat, ImageError> {
    let format = ImageFormat::from_path(path)?;
    drop(temporary(path)?);
    Ok(format)
}

/// Writes bytes, three a pixel, as a PNG.
///
/// # Errors
/// When the file cannot be written, or the bytes are not those of a picture of this size.
pub fn write_png(path: &Path, width: u32, height: u32, srgb: &[u8]) -> Result<(), ImageError> {
    write_png_with(path, width, height, srgb, &Metadata::default())
}

/// Writes bytes, three a pixel, as a PNG that says something about itself.
///
/// # Errors
/// When the file cannot be written, or the bytes are not those of a picture of this size.
pub fn write_png_with(
    path: &Path,
    width: u32,
    height: u32,
    srgb: &[u8],
    metadata: &Metadata,
) -> Result<(), ImageError> {
    if srgb.len() as u64 != u64::from(width) * u64::from(height) * 3 {
        let what = format!("{} bytes are no picture of {width}x{height}", srgb.len());
        return Err(ImageError::Encode { path: path.into(), what });
    }
    let encode = |file: &mut BufWriter<NamedTempFile>| {
        let mut encoder = png::Encoder::new(file, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Balanced);
        encoder.set_filter(png::Filter::Adaptive);
        for (keyword, text) in metadata.pairs() {
            encoder.add_itxt_chunk(keyword.clone(), text.clone())?;
        }
        let mut writer = encoder.write_header()?;
        writer.write_image_data(srgb)?;
        writer.finish()
    };
    write(path, |file| {
        encode(file).map_err(|error| match error {
            png::EncodingError::IoError(source) => ImageError::Io { path: path.into(), source },
            other => ImageError::Encode { path: path.into(), what: other.to_string() },
        })
    })
}

/// Writes a film as an EXR with the channels R, G, B, Z (depth) and coverage, and those of its layers.
///
/// # Errors
/// When the file cannot be written.
pub fn write_exr(path: &Path, film: &Film) -> Result<(), ImageError> {
    write_exr_with(path, film, &Metadata::default())
}

/// Writes a film as an EXR that says something about itself: the channels R, G, B, Z (depth) and coverage; with visits the
/// channel `visits`; with layers `albedo.R` and so on, `normal.X` and so on, and as whole numbers `ids.instance`, `ids.geometry`
/// and `ids.primitive`, 4294967295 where nothing was hit.
///
/// # Errors
/// When the file cannot be written.
pub fn write_exr_with(path: &Path, film: &Film, metadata: &Metadata) -> Result<(), ImageError> {
    let numbers = |plane: Vec<f32>| FlatSamples::F32(plane);
    let component =
        |plane: &[[f32; 3]], index: usize| numbers(plane.iter().map(|color| color[index]).collect());
    let mut channels = vec![
        AnyChannel::new("R", component(&film.color, 0)),
        AnyChannel::new("G", component(&film.color, 1)),
        AnyChannel::new("B", component(&film.color, 2)),
        AnyChannel::new("Z", numbers(film.depth.clone())),
        AnyChannel::new("coverage", numbers(film.coverage.clone())),
    ];
    if !film.visits.is_empty() {
        channels.push(AnyChannel::new("visits", numbers(film.visits.clone())));
    }
    if let Some(layers) = &film.layers {
        let names = ["albedo.R", "albedo.G", "albedo.B"].into_iter().zip(0..);
        channels.extend(names.map(|(name, index)| AnyChannel::new(name, component(&layers.albedo, index))));
        let names = ["normal.X", "normal.Y", "normal.Z"].into_iter().zip(0..);
        channels.extend(names.map(|(name, index)| AnyChannel::new(name, component(&layers.normal, index))));
        let names = ["ids.instance", "ids.geometry", "ids.primitive"].into_iter().zip(0..3);
        channels.extend(names.map(|(name, index)| {
            AnyChannel::new(name, FlatSamples::U32(layers.ids.iter().map(|ids| ids[index]).collect()))
        }));
    }
    let size = (film.width as usize, film.height as usize);
    let channels = AnyChannels::sort(channels.into_iter().collect());
    let mut image = Image::from_channels(size, channels);
    // Else blocks are written as threads finish them, and equal pictures are unequal files.
    image.layer_data.encoding.line_order = LineOrder::Increasing;
    if !metadata.pairs().is_empty() {
        // One attribute for all: several of a caller's own would be written in a random order.
        image.layer_data.attributes.comments = Text::new_or_none(metadata.lines());
    }
    write(path, |file| {
        image.write().to_buffered(file).map_err(|error| match error {
            exr::error::Error::Io(source) => ImageError::Io { path: path.into(), source },
            other => ImageError::Encode { path: path.into(), what: other.to_string() },
        })
    })
}

/// Lets `encode` fill a temporary file and gives it its name when that went well.
fn write(
    path: &Path,
    encode: impl FnOnce(&mut BufWriter<NamedTempFile>) -> Result<(), ImageError>,
) -> Result<(), ImageError> {
    let io = |source| ImageError::Io { path: path.into(), source };
    let mut file = BufWriter::new(temporary(path)?);
    encode(&mut file)?;
    file.flush().map_err(io)?;
    let file = file.into_inner().map_err(|error| io(error.into_error()))?;
    file.as_file().sync_all().map_err(io)?;
    file.persist(path).map_err(|error| io(error.error))?;
    Ok(())
}

fn temporary(path: &Path) -> Result<NamedTempFile, ImageError> {
    if path.is_dir() {
        return Err(ImageError::IsFolder { path: path.into() });
    }
    let folder = match path.parent() {
        None => PathBuf::from("."),
        Some(parent) if parent.as_os_str().is_empty() => PathBuf::from("."),
        Some(parent) => parent.into(),
    };
    if !folder.is_dir() {
        return Err(ImageError::NoFolder { path: path.into(), folder });
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".ropewalk-").suffix(".part");
    // Temporary files are private by default; a picture is to have the rights of any new file.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(&folder).map_err(|source| ImageError::Io { path: path.into(), source: plain(source) })
}

/// The system's reason without the temporary file's name, which would only confuse.
fn plain(error: std::io::Error) -> std::io::Error {
    error.kind().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film() -> Film {
        let mut film = Film::new(3, 2, false).unwrap();
        for (index, color) in film.color.iter_mut().enumerate() {
            *color = [index as f32 * 0.5, 1e-3, 7.25];
        }
        film.depth[4] = 12.5;
        film.coverage[4] = 0.75;
        film
    }

    #[test]
    fn a_png_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.PNG");
        let bytes: Vec<u8> = (0..18).map(|i| i * 14).collect();
        write_png(&path, 3, 2, &bytes).unwrap();
        let back = image::open(&path).unwrap().to_rgb8();
        assert_eq!((back.width(), back.height()), (3, 2));
        assert_eq!(back.into_raw(), bytes);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
        assert!(matches!(write_png(&path, 3, 3, &bytes), Err(ImageError::Encode { .. })));
    }

    #[test]
    fn an_exr_comes_back_to_the_bit() {
        use exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.exr");
        let film = film();
        write_exr(&path, &film).unwrap();
        let image = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(&path)
            .unwrap();
        let plane = |name: &str| {
            let channel = image.layer_data.channel_data.list.iter().find(|channel| channel.name.eq(name));
            match &channel.unwrap().sample_data {
                FlatSamples::F32(values) => values.clone(),
                other => panic!("{name} is stored as {other:?}"),
            }
        };
        let component = |index: usize| film.color.iter().map(|color| color[index]).collect::<Vec<_>>();
        assert_eq!((plane("R"), plane("G"), plane("B")), (component(0), component(1), component(2)));
        assert_eq!((plane("Z"), plane("coverage")), (film.depth.clone(), film.coverage.clone()));
    }

    #[test]
    fn an_exr_has_the_layers_of_its_film() {
        use exr::prelude::{ReadChannels, ReadLayers};
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.exr");
        let mut film = film().with_layers().unwrap();
        film.visits = vec![3.5; 6];
        let layers = film.layers.as_mut().unwrap();
        layers.albedo[2] = [0.1, 0.2, 0.3];
        layers.normal[2] = [0.0, -1.0, 0.5];
        layers.ids[2] = [16_777_217, 3, 9];
        let metadata = Metadata::default().with("Software", "ropewalk").with("Scene", "a\u{e4}");
        write_exr_with(&path, &film, &metadata).unwrap();
        let image = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(&path)
            .unwrap();
        let value = |name: &str| {
            let channel = image.layer_data.channel_data.list.iter().find(|channel| channel.name.eq(name));
            match &channel.unwrap_or_else(|| panic!("{name}")).sample_data {
                FlatSamples::F32(values) => f64::from(values[2]),
                FlatSamples::U32(values) => f64::from(values[2]),
                FlatSamples::F16(_) => panic!("{name} has lost bits"),
            }
        };
        assert_eq!(["albedo.G", "normal.Y", "visits"].map(value), [f64::from(0.2_f32), -1.0, 3.5]);
        // Beyond what a f32 counts.
        assert_eq!(["ids.instance", "ids.primitive"].map(value), [16_777_217.0, 9.0]);
        assert!(image.layer_data.attributes.comments.is_some());
    }

    #[test]
    fn a_png_says_what_it_is_told_to_say() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        let metadata = Metadata::default().with("Scene", "H\u{e4}user.obj").with("Size", "1x1");
        write_png_with(&path, 1, 1, &[1, 2, 3], &metadata).unwrap();
        let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
        let reader = png::Decoder::new(file).read_info().unwrap();
        let texts: Vec<(String, String)> = reader
            .info()
            .utf8_text
            .iter()
            .map(|chunk| (chunk.keyword.clone(), chunk.get_text().unwrap()))
            .collect();
        assert_eq!(texts, metadata.pairs());
        let plain = folder.path().join("plain.png");
        write_png(&plain, 1, 1, &[1, 2, 3]).unwrap();
        assert!(std::fs::read(&plain).unwrap() != std::fs::read(&path).unwrap());
    }

    #[test]
    fn equal_films_are_equal_files() {
        let folder = tempfile::tempdir().unwrap();
        let mut film = Film::new(64, 512, false).unwrap();
        for (index, depth) in film.depth.iter_mut().enumerate() {
            *depth = (index as f32).sqrt();
        }
        let bytes: Vec<Vec<u8>> = (0..8)
            .map(|round| {
                let path = folder.path().join(format!("{round}.exr"));
                write_exr(&path, &film).unwrap();
                std::fs::read(path).unwrap()
            })
            .collect();
        assert!(bytes.windows(2).all(|pair| pair[0] == pair[1]));
    }

    #[test]
    fn a_failed_write_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        std::fs::write(&path, "old").unwrap();
        let failed = write(&path, |file| {
            file.write_all(b"half").unwrap();
            Err(ImageError::Encode { path: path.clone(), what: "stopped half-way".into() })
        });
        assert!(failed.is_err());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    }

    #[test]
    fn what_cannot_be_written_is_said_beforehand() {
        let folder = tempfile::tempdir().unwrap();
        let message = |path: &Path| check(path).unwrap_err().to_string();
        for name in ["picture.jpg", "picture", ".png"] {
            let text = message(&folder.path().join(name));
            assert!(text.contains(name) && text.contains(".png") && text.contains(".exr"), "{text}");
        }
        let text = message(&folder.path().join("missing/picture.png"));
        assert!(text.contains("missing does not exist"), "{text}");
        let within = folder.path().join("folder.png");
        std::fs::create_dir(&within).unwrap();
        assert!(message(&within).contains("is a folder"));
        assert_eq!(check(&folder.path().join("fine.exr")).unwrap(), ImageFormat::Exr);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "a check leaves nothing behind");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn an_unwritable_folder_is_an_error_that_names_the_file() {
        // No one, not even root, makes files there.
        let path = Path::new("/proc/picture.png");
        let text = check(path).unwrap_err().to_string();
        assert!(text.starts_with("/proc/picture.png: "), "{text}");
        assert!(!text.contains(".part"), "{text}");
    }
}
