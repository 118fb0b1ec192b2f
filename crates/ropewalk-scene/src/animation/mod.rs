//! Scenes that move: a [`Model`] as it is when its animation begins, and for every time the [`Pose`] in which its parts are then.
//!
//! | file | concept |
//! |---|---|
//! | `pose` | where everything is at a time, and how that is put into a model |
//! | `span` | from when to when an animation goes, and at which times its frames are |
//! | this | the scene with its clips |
//!
//! **Invariants.** A pose has one transform for each instance of the model, in the model's order and relative to its fixed
//! origin, whatever is visible: indices of hits mean the same in every frame. Objects keep their triangles; what deforms has
//! other positions and normals, as many as before. A pose depends on the time alone, so frames can be made in any order and on
//! any machine.
//!
//! **Cost.** A pose costs what moves: no file is read again and no mesh put together again.

mod pose;
mod span;

pub use pose::{GeometryShape, ObjectShape, Pose};
pub use span::{MOST_FRAMES, Span};

use crate::{LoadError, Model};
use std::fmt;
use std::sync::Arc;

/// What knows where the parts of a model are at a time.
pub trait Motion: fmt::Debug + Send + Sync {
    /// The pose of a clip at a time. Before and behind the clip's span its ends hold.
    ///
    /// It must keep what a [`Pose`] promises: as many transforms as the model has instances, and so on.
    fn pose(&self, clip: usize, time: f64) -> Pose;
}

/// One of the things that a scene can do.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// The name in the file; empty where it gives none.
    pub name: String,
    /// From when to when.
    pub span: Span,
}

/// A scene that moves, or one that stands still.
#[derive(Clone, Debug)]
pub struct Animated {
    model: Model,
    clips: Vec<Clip>,
    clip: usize,
    motion: Option<Arc<dyn Motion>>,
}

impl Animated {
    /// A scene that stands still.
    #[must_use]
    pub fn still(model: Model) -> Self {
        Self { model, clips: Vec::new(), clip: 0, motion: None }
    }

    /// A scene that moves through clips, of which the first is chosen. The model is brought into the pose in which that begins.
    /// Without clips it stands still.
    #[must_use]
    pub fn new(model: Model, clips: Vec<Clip>, motion: Arc<dyn Motion>) -> Self {
        if clips.is_empty() {
            return Self::still(model);
        }
        let mut animated = Self { model, clips, clip: 0, motion: Some(motion) };
        animated.begin();
        animated
    }

    /// The model as it is when the chosen clip begins.
    #[must_use]
    pub const fn model(&self) -> &Model {
        &self.model
    }

    /// The model alone, given away: what is asked of a scene that moves are its poses.
    #[must_use]
    pub fn take_model(&mut self) -> Model {
        std::mem::take(&mut self.model)
    }

    /// What the scene can do.
    #[must_use]
    pub fn clips(&self) -> &[Clip] {
        &self.clips
    }

    /// The clip that was chosen; `None` where the scene stands still.
    #[must_use]
    pub fn clip(&self) -> Option<&Clip> {
        self.clips.get(self.clip)
    }

    /// From when to when the chosen clip goes; `None` where the scene stands still.
    #[must_use]
    pub fn span(&self) -> Option<Span> {
        self.clip().map(|clip| clip.span)
    }

    /// Chooses a clip by its name; where none has the name, by its number from 0. The model is brought into the pose in which it
    /// begins.
    ///
    /// # Errors
    /// When there is none; the error lists those that there are.
    pub fn choose_clip(&mut self, wanted: &str) -> Result<(), LoadError> {
        let by_name = self.clips.iter().position(|clip| clip.name == wanted);
        let by_number = || wanted.parse().ok().filter(|&number: &usize| number < self.clips.len());
        self.clip = by_name
            .or_else(by_number)
            .ok_or_else(|| LoadError::NoSuchClip { name: wanted.into(), known: self.known_clips() })?;
        self.begin();
        Ok(())
    }

    fn known_clips(&self) -> String {
        /// More would make no sentence.
        const MOST: usize = 20;
        if self.clips.is_empty() {
            return "the scene has none: it stands still".into();
        }
        let listed: Vec<String> = self
            .clips
            .iter()
            .enumerate()
            .take(MOST)
            .map(|(number, clip)| match clip.name.as_str() {
                "" => number.to_string(),
                name => format!("{number} '{name}'"),
            })
            .collect();
        let more = if self.clips.len() > MOST { ", ..." } else { "" };
        format!("the scene has {}{more}", listed.join(", "))
    }

    /// The pose at a time; `None` where the scene stands still.
    #[must_use]
    pub fn pose(&self, time: f64) -> Option<Pose> {
        self.motion.as_ref().map(|motion| motion.pose(self.clip, time))
    }

    fn begin(&mut self) {
        if let Some(pose) = self.span().and_then(|span| self.pose(span.start)) {
            pose.apply(&mut self.model);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Affine3A, Vec3};
    use ropewalk::{Mesh, Scene};

    #[derive(Debug)]
    struct Slide;

    impl Motion for Slide {
        fn pose(&self, clip: usize, time: f64) -> Pose {
            let way = if clip == 0 { Vec3::X } else { Vec3::Y };
            Pose {
                time,
                transforms: vec![Affine3A::from_translation(way * time as f32)],
                visible: vec![true],
                ..Pose::default()
            }
        }
    }

    fn sliding() -> Animated {
        let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
        let model = Model { scene: Scene::from_mesh(mesh), ..Model::default() };
        let clip = |name: &str| Clip { name: name.into(), span: Span { start: 2.0, end: 4.0, frames: 3 } };
        Animated::new(model, vec![clip("along"), clip("0"), clip("")], Arc::new(Slide))
    }

    #[test]
    fn clips_are_chosen_by_name_then_by_number_and_the_model_is_at_their_start() {
        let mut animated = sliding();
        let at = |animated: &Animated| animated.model().scene.instances[0].transform.point(Vec3::ZERO);
        assert_eq!(at(&animated), Vec3::X * 2.0);
        animated.choose_clip("0").unwrap();
        assert_eq!(animated.clip().unwrap().name, "0", "a name goes before a number");
        assert_eq!(at(&animated), Vec3::Y * 2.0);
        animated.choose_clip("2").unwrap();
        assert_eq!(animated.clip().unwrap().name, "");
        for wrong in ["3", "", "run"] {
            let Err(error) = animated.choose_clip(wrong) else {
                assert_eq!(wrong, "", "the third has no name");
                continue;
            };
            assert!(error.to_string().contains("0 'along', 1 '0', 2"), "{error}");
        }
    }

    #[test]
    fn what_stands_still_has_no_pose_and_no_clip() {
        let mut still = Animated::new(Model::default(), Vec::new(), Arc::new(Slide));
        assert!(still.span().is_none() && still.pose(0.0).is_none());
        assert!(still.choose_clip("0").unwrap_err().to_string().contains("stands still"));
    }
}
