//! Paths, which are followed in waves on either device: to the bit, chance and all.

use crate::agreement::difference;
use crate::subject::{Subject, software, two_levels};
use crate::{render, settings};
use ropewalk::StructureSpec;
use ropewalk_render::{Integrator, RenderSettings, TreeSettings};

fn agree(name: &'static str, spec: StructureSpec) {
    let (Some(device), Some(subject)) = (software(), Subject::new(name)) else { return };
    let (stage, structure) = subject.at(subject.times(1)[0], spec);
    let settings = RenderSettings {
        samples: 4,
        integrator: Integrator::Path,
        tree: TreeSettings { bounces: 3, ..TreeSettings::default() },
        ..settings()
    };
    let on_processor = render(&stage, structure.as_ref(), &settings);
    let on_adapter = render(&stage, &device.prepare(structure).expect("the scene fits"), &settings);
    if let Err(told) = difference(&on_processor, &on_adapter) {
        panic!("{}: the processor's and the adapter's: {told}", subject.name);
    }
    assert_eq!(on_processor.statistics.noise, on_adapter.statistics.noise);
    let statistics = &on_processor.statistics;
    assert!(statistics.scattered_rays > 0 && statistics.shadow_rays > 0, "{statistics:?}");
    println!("{}: {} rays of paths, the same bits", subject.name, statistics.rays());
}

#[test]
fn paths_in_the_box() {
    agree("builtin:cornell", StructureSpec::default());
}

#[test]
fn paths_in_the_museum() {
    agree("bart_museum/museum5.aff", two_levels());
}

/// Under roofs of glass that bends nothing, through which lights are asked for.
#[test]
fn paths_among_the_robots() {
    agree("bart_robot/Robot.aff", two_levels());
}
