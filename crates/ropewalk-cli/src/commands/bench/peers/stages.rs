//! What SCENE means in the arena: a file, one that is turned, or a room with scans standing in it.

use crate::commands::bench::Viewpoint as Camera;
use crate::failure::Failure;
use crate::scene_argument::SceneArgument;
use ropewalk::Scene;
use ropewalk_lab::arena::{Shape, Stage, Turn, Viewpoint, mixed};
use std::ffi::OsString;
use std::path::Path;

/// A scene of the arena that was named and not read yet.
#[derive(Clone, Debug)]
pub(super) struct StageArgument {
    name: String,
    scenes: Vec<SceneArgument>,
    is_turned: bool,
}

impl StageArgument {
    /// Understands a SCENE, and finds out what can be found out without reading it.
    pub(super) fn new(scene: &SceneArgument) -> Result<Self, Failure> {
        let text = scene.to_string();
        let scenes = |text: &str| -> Vec<SceneArgument> {
            text.split('+').map(|part| SceneArgument::from(OsString::from(part))).collect()
        };
        let stage = if let Some(file) = text.strip_prefix("rotated:") {
            let scenes = vec![SceneArgument::from(OsString::from(file))];
            Self { name: format!("{}, rotated", short(&scenes[0])), scenes, is_turned: true }
        } else if let Some(files) = text.strip_prefix("mixed:") {
            let scenes = scenes(files);
            if scenes.len() < 2 {
                return Err(Failure::usage(format!(
                    "{text}: name a room and what stands in it: mixed:ROOM+FILE"
                )));
            }
            Self { name: format!("{}, mixed", short(&scenes[0])), scenes, is_turned: false }
        } else {
            Self { name: short(scene), scenes: vec![scene.clone()], is_turned: false }
        };
        stage.scenes.iter().try_for_each(SceneArgument::check)?;
        Ok(stage)
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Reads it, or makes it.
    pub(super) fn load(&self, camera: Camera) -> Result<Stage, Failure> {
        let failure = |why: &dyn std::fmt::Display| Failure::failed(format!("{}: {why}", self.name));
        let mut models = Vec::new();
        for scene in &self.scenes {
            let loaded = scene.load()?;
            loaded.note_defects();
            models.push(loaded.model);
        }
        let view = models.first().and_then(|model| camera.view(model));
        let mut scenes = models.into_iter().map(|model| model.scene);
        let room = scenes.next().unwrap_or_default();
        let scans: Vec<Scene> = scenes.collect();
        let scene =
            if scans.is_empty() { room } else { mixed(&room, &scans).map_err(|why| failure(&why))? };
        let shape = Shape::new(&scene).map_err(|why| failure(&why))?;
        let turn = self.is_turned.then(|| Turn::off_axis(&shape.bounds()));
        // A camera that was asked for has its light where it stands, a little above: a point of the scene's own is not known.
        let viewpoint = view.map(|view| {
            let size = f64::from((shape.bounds().max - shape.bounds().min).length());
            Viewpoint::new(view, view.eye() + glam::DVec3::Y * (0.05 * size))
        });
        Ok(Stage { name: self.name.clone(), shape, turn, viewpoint })
    }
}

/// The name of a file without its folders and endings.
fn short(scene: &SceneArgument) -> String {
    let text = scene.to_string();
    let file = Path::new(&text).file_name().map_or(text.clone(), |name| name.to_string_lossy().into_owned());
    file.split('.').next().filter(|name| !name.is_empty()).map_or(file.clone(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stage(text: &str) -> Result<StageArgument, Failure> {
        StageArgument::new(&SceneArgument::from(OsString::from(text)))
    }

    #[test]
    fn names_are_short_and_prefixes_understood() {
        let stage =
            |text| stage(text).map(|stage| (stage.name, stage.scenes.len(), stage.is_turned)).unwrap();
        assert_eq!(stage("builtin:assembly"), ("builtin:assembly".into(), 1, false));
        assert_eq!(stage("rotated:builtin:assembly"), ("builtin:assembly, rotated".into(), 1, true));
        let mixed = stage("mixed:builtin:assembly+builtin:assembly");
        assert_eq!(mixed, ("builtin:assembly, mixed".into(), 2, false));
    }

    #[test]
    fn what_is_not_there_is_refused_early() {
        for text in ["rotated:no-such-file.obj", "mixed:builtin:assembly+no-such-file.obj"] {
            assert!(stage(text).unwrap_err().message().contains("no-such-file.obj"));
        }
        assert!(stage("mixed:builtin:assembly").unwrap_err().message().contains("mixed:ROOM+FILE"));
    }
}
