//! SCENE on the command line: a file, or `builtin:NAME`.

use crate::failure::Failure;
use crate::output::note;
use crate::progress::Progress;
use ropewalk_scene::builtin::{NAMES, builtin, builtin_animated};
use ropewalk_scene::{Animated, Model};
use std::ffi::OsString;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The scene that is taken where none is named.
pub(crate) const DEFAULT_SCENE: &str = "builtin:assembly";

/// What the SCENE arguments of all commands say in their help.
pub(crate) fn scene_help() -> String {
    let names = NAMES.map(|(name, _)| format!("builtin:{name}")).join(", ");
    format!("OBJ, PLY, STL, glTF, GLB, AFF or NFF file, gzipped or not; or {names}")
}

/// Which scene is meant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum SceneArgument {
    /// The name of a built-in scene.
    Builtin(String),
    /// A file.
    File(PathBuf),
}

impl From<OsString> for SceneArgument {
    fn from(text: OsString) -> Self {
        match text.to_str().and_then(|text| text.strip_prefix("builtin:")) {
            Some(name) => Self::Builtin(name.into()),
            None => Self::File(text.into()),
        }
    }
}

impl fmt::Display for SceneArgument {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Builtin(name) => write!(formatter, "builtin:{name}"),
            Self::File(path) => write!(formatter, "{}", path.display()),
        }
    }
}

/// A scene that was read.
#[derive(Debug)]
pub(crate) struct LoadedScene {
    /// What it holds.
    pub(crate) model: Model,
    /// How long reading or making it took.
    pub(crate) time: Duration,
}

impl SceneArgument {
    /// Finds out what can be found out without reading the scene: whether there is such a file or such a name.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        let path = match self {
            Self::File(path) => path,
            Self::Builtin(name) if NAMES.iter().any(|(known, _)| known == name) => return Ok(()),
            // Its error lists the names that there are.
            Self::Builtin(name) => return Ok(builtin(name).map(drop)?),
        };
        let failure = |what: &dyn fmt::Display| Failure::failed(format!("{}: {what}", path.display()));
        let metadata = std::fs::metadata(path).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => failure(&missing(path)),
            _ => failure(&error),
        })?;
        if metadata.is_dir() {
            return Err(failure(&"this is a folder; name a scene file in it"));
        }
        // A device or a pipe may never end.
        if !metadata.is_file() {
            return Err(failure(&"this is no regular file; scenes are read from files"));
        }
        Ok(())
    }

    /// Reads the scene, or makes it.
    pub(crate) fn load(&self) -> Result<LoadedScene, Failure> {
        self.check()?;
        let start = Instant::now();
        let progress = Progress::spinner(format!("reading {self}"));
        let model = match self {
            Self::Builtin(name) => builtin(name)?,
            Self::File(path) => ropewalk_scene::load::load(path)?,
        };
        drop(progress);
        Ok(LoadedScene { model, time: start.elapsed() })
    }

    /// Reads the scene with its motion, and tells the user what was left out of it; how long it took.
    pub(crate) fn load_animated(&self) -> Result<(Animated, Duration), Failure> {
        self.check()?;
        let start = Instant::now();
        let progress = Progress::spinner(format!("reading {self}"));
        let animated = match self {
            Self::Builtin(name) => builtin_animated(name)?,
            Self::File(path) => ropewalk_scene::load::load_animated(path)?,
        };
        drop(progress);
        note_defects(animated.model());
        Ok((animated, start.elapsed()))
    }
}

impl LoadedScene {
    /// Tells the user what was left out of the scene, and what was understood in a way worth knowing.
    pub(crate) fn note_defects(&self) {
        note_defects(&self.model);
    }
}

/// The same of a model.
fn note_defects(model: &Model) {
    for text in &model.report.notes {
        note(text);
    }
    for row in &model.report.skipped {
        note(&format!("left out: {} {} (the first: {})", row.count, row.what, row.first));
    }
}

fn missing(path: &Path) -> String {
    let name = path.to_string_lossy();
    if NAMES.iter().any(|(known, _)| *known == name) {
        format!("there is no such file; the built-in scene is written builtin:{name}")
    } else {
        "there is no such file".into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_and_names_are_told_apart() {
        let scene = SceneArgument::from(OsString::from(DEFAULT_SCENE));
        assert_eq!(scene, SceneArgument::Builtin("assembly".into()));
        assert_eq!(scene.to_string(), DEFAULT_SCENE);
        assert!(scene.check().is_ok());
        let scene = SceneArgument::from(OsString::from("a/builtin:x.obj"));
        assert_eq!(scene, SceneArgument::File("a/builtin:x.obj".into()));
    }

    #[test]
    fn a_wrong_name_is_answered_with_the_right_ones() {
        let message =
            |text: &str| SceneArgument::from(OsString::from(text)).check().unwrap_err().message().to_owned();
        for (name, _) in NAMES {
            assert!(message("builtin:pyramids").contains(name));
            assert!(message(name).contains(&format!("builtin:{name}")));
        }
        assert!(message(".").contains("folder"));
    }
}
