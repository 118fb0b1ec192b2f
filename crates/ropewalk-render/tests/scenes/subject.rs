//! What is looked at: a scene, brought into the pose of a time, and the one structure in which all of them are traced.

use ropewalk::two_level::{BottomSpec, Bottoms, TwoLevelOptions};
use ropewalk::{BuildOptions, NoMonitor, Structure, StructureSpec};
use ropewalk_gpu::{Device, DeviceChoice, adapters};
use ropewalk_render::{Stage, StageOptions};
use ropewalk_scene::{Animated, builtin, load};
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// A scene with its motion.
pub(crate) struct Subject {
    pub(crate) name: &'static str,
    pub(crate) animated: Animated,
}

impl Subject {
    /// A built-in scene, or a file beside the repository; `None`, with a word, where that is not there.
    pub(crate) fn new(name: &'static str) -> Option<Self> {
        if let Some(built_in) = name.strip_prefix("builtin:") {
            let animated = builtin::builtin_animated(built_in).expect("there is such a scene");
            return Some(Self { name, animated });
        }
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes")).join(name);
        if !path.exists() {
            println!("skipped: {name} is not there");
            return None;
        }
        let animated = load::load_animated(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
        Some(Self { name, animated })
    }

    /// The small scene of what tests the comparators themselves, which stands still.
    pub(crate) fn cubes() -> Self {
        Self { name: "cubes", animated: builtin::builtin_animated("cubes").expect("there is such a scene") }
    }

    /// Times between both ends of the span, evenly apart and not at a frame's. Of what stands still there is one, which is none.
    pub(crate) fn times(&self, count: u32) -> Vec<Option<f64>> {
        let Some(span) = self.animated.span() else { return vec![None] };
        let part = |index: u32| (f64::from(index) + 0.41) / f64::from(count);
        (0..count).map(|index| Some(span.start + part(index) * (span.end - span.start))).collect()
    }

    /// The stage as the animation begins.
    pub(crate) fn stage(&self) -> Stage {
        Stage::new(self.animated.model().clone(), &StageOptions::default())
    }

    /// The stage at a time, and a structure that was built for it.
    pub(crate) fn at(&self, time: Option<f64>, spec: StructureSpec) -> (Stage, Arc<Structure>) {
        let mut stage = self.stage();
        if let Some(time) = time {
            stage.pose(&self.animated.pose(time).expect("it moves"));
        }
        let structure = self.build(&stage, spec);
        (stage, structure)
    }

    /// The same of a stage that is set for the pose, in place of one that was brought into it.
    pub(crate) fn set_at(&self, time: f64, spec: StructureSpec) -> (Stage, Arc<Structure>) {
        let mut model = self.animated.model().clone();
        self.animated.pose(time).expect("it moves").apply(&mut model);
        let stage = Stage::new(model, &StageOptions::default());
        let structure = self.build(&stage, spec);
        (stage, structure)
    }

    fn build(&self, stage: &Stage, spec: StructureSpec) -> Arc<Structure> {
        let built = spec.build(stage.scene(), &NoMonitor);
        Arc::new(built.unwrap_or_else(|error| panic!("{}: {error}", self.name)))
    }
}

/// Two levels over BVHs: what every one of these scenes can move in, so that an adapter makes its kernels once.
pub(crate) fn two_levels() -> StructureSpec {
    StructureSpec::TwoLevel(TwoLevelOptions {
        bottoms: Bottoms::Each(BottomSpec::Bvh(BuildOptions::default())),
        oriented: false,
        ..TwoLevelOptions::default()
    })
}

/// The software adapter, opened once; `None`, with a word, where there is none.
pub(crate) fn software() -> Option<&'static Device> {
    static DEVICE: OnceLock<Option<Device>> = OnceLock::new();
    let device = DEVICE.get_or_init(|| {
        let found = adapters().into_iter().find(|adapter| adapter.is_software)?;
        Some(Device::open(&DeviceChoice::GpuIndex(found.index)).expect("the adapter opens").device)
    });
    if device.is_none() {
        assert!(std::env::var_os("CI").is_none(), "there is no software adapter, and CI wants one");
        println!("skipped: there is no software adapter here");
    }
    device.as_ref()
}
