//! Where results go: standard output, or a file that appears under its name only when it is complete.

use crate::failure::{Failure, one_line};
use serde::Serialize;
use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

/// Writes text to standard output. A reader that went away (`| head`) has seen what it wanted: no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::failed(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writes one JSON document to standard output.
pub(crate) fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let mut text = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::failed(format!("the result has no JSON form: {error}")))?;
    text.push('\n');
    print(&text)
}

/// Writes a JSON document as one line to standard output.
pub(crate) fn print_json_line(value: &impl Serialize) -> Result<(), Failure> {
    let mut text = serde_json::to_string(value)
        .map_err(|error| Failure::failed(format!("the result has no JSON form: {error}")))?;
    text.push('\n');
    print(&text)
}

/// Tells the user something that is no result, on standard error. That nobody reads it is no failure.
pub(crate) fn note(text: &str) {
    let _ = writeln!(io::stderr(), "ropewalk: note: {}", one_line(text));
}

/// A file to be written. It is written under another name in the same folder and renamed when it is complete, so
/// a failure leaves whatever was there before.
#[derive(Debug)]
pub(crate) struct OutputFile {
    /// As the user wrote it, for messages.
    name: PathBuf,
    /// Links followed.
    target: PathBuf,
    /// A device or a pipe, which must not be replaced by a file.
    special: bool,
}

impl OutputFile {
    /// Checks that the file can be written, before any work is done for it.
    pub(crate) fn new(name: &Path) -> Result<Self, Failure> {
        let failure = |what: &dyn std::fmt::Display| Failure::failed(format!("{}: {what}", name.display()));
        if name == Path::new("-") {
            return Err(Failure::usage("the result goes to a file, not to standard output: name one"));
        }
        let mut file = Self { name: name.into(), target: name.into(), special: false };
        match fs::metadata(name) {
            Ok(metadata) if metadata.is_dir() => {
                return Err(failure(&"this is a folder; name a file in it"));
            }
            Ok(metadata) if metadata.is_file() => {
                if metadata.permissions().readonly() {
                    return Err(failure(&"the file is there and is read-only"));
                }
                file.target = fs::canonicalize(name).map_err(|error| failure(&error))?;
            }
            Ok(_) => {
                file.special = true;
                return Ok(file);
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(failure(&error)),
        }
        if name.file_name().is_none() {
            return Err(failure(&"this names no file"));
        }
        // A temporary file that is made and dropped: the surest answer to whether one can be made.
        file.temporary().map_err(|error| file.failure(&error))?;
        Ok(file)
    }

    /// The name as the user wrote it.
    pub(crate) fn name(&self) -> &Path {
        &self.name
    }

    /// Writes the file with `write` and gives it its name.
    pub(crate) fn write(
        &self,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<(), Failure> {
        self.try_write(write).map_err(|error| self.failure(&error))
    }

    fn try_write(&self, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
        if self.special {
            // What is written needs to seek, which a pipe cannot: it takes a way round.
            let mut file = tempfile::tempfile()?;
            let mut buffer = BufWriter::new(file.try_clone()?);
            write(&mut buffer)?;
            buffer.flush()?;
            file.rewind()?;
            let mut target = fs::OpenOptions::new().write(true).open(&self.name)?;
            io::copy(&mut file, &mut target)?;
            return target.flush();
        }
        let temporary = self.temporary()?;
        let mut buffer = BufWriter::with_capacity(1 << 18, temporary.as_file().try_clone()?);
        write(&mut buffer)?;
        buffer.flush()?;
        temporary.persist(&self.target).map_err(|error| error.error)?;
        Ok(())
    }

    fn temporary(&self) -> io::Result<tempfile::NamedTempFile> {
        let folder = match self.target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(".ropewalk-").suffix(".part");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // What any new file gets, less what the user's umask takes away; the default is for secrets.
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        builder.tempfile_in(folder)
    }

    fn failure(&self, error: &io::Error) -> Failure {
        // From the system's code, for tempfile adds the path of the temporary file, which tells the user nothing.
        let reason = match (error.kind(), error.raw_os_error()) {
            (io::ErrorKind::NotFound, _) => "its folder is not there".into(),
            (_, Some(code)) => io::Error::from_raw_os_error(code).to_string(),
            (_, None) => error.to_string(),
        };
        Failure::failed(format!("{}: cannot be written: {reason}", self.name.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_failed_write_leaves_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.bin");
        fs::write(&path, "old").unwrap();
        let file = OutputFile::new(&path).unwrap();
        let failure = file
            .write(|out| {
                out.write_all(b"half")?;
                Err(io::Error::other("the disk burns"))
            })
            .unwrap_err();
        assert!(failure.message().contains("the disk burns"));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        file.write(|out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(entries(folder.path()), ["out.bin"]);
    }

    #[test]
    fn what_cannot_be_written_is_known_early() {
        let folder = tempfile::tempdir().unwrap();
        for name in [folder.path().to_path_buf(), folder.path().join("no/such/file"), PathBuf::from("")] {
            let failure = OutputFile::new(&name).unwrap_err();
            assert_eq!(failure.message().lines().count(), 1, "{failure:?}");
        }
        assert!(entries(folder.path()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_followed_and_a_device_is_not_replaced() {
        use std::os::unix::fs::FileTypeExt;
        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        fs::write(&real, "old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        OutputFile::new(&link).unwrap().write(|out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&real).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        let null = Path::new("/dev/null");
        OutputFile::new(null).unwrap().write(|out| out.write_all(b"gone")).unwrap();
        assert!(fs::metadata(null).unwrap().file_type().is_char_device());
    }
}
