//! Trees of rays: three orders on the processor, waves and the kernel on an adapter, to the bit and to the ray; and drawn first
//! hits.

use crate::agreement::difference;
use crate::drawn;
use crate::subject::{Subject, software, two_levels};
use crate::{render, render_keeping, settings};
use ropewalk::StructureSpec;
use ropewalk_render::{Kept, Primary, RenderSettings, Statistics, TreeOrder, TreeSettings};

/// What all pictures of a scene took together.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    pictures: u32,
    shadow_rays: u64,
    reflected_rays: u64,
    refracted_rays: u64,
    cut_by_depth: u64,
    cut_by_weight: u64,
}

impl Sum {
    fn add(&mut self, statistics: &Statistics) {
        self.pictures += 1;
        self.shadow_rays += statistics.shadow_rays;
        self.reflected_rays += statistics.reflected_rays;
        self.refracted_rays += statistics.refracted_rays;
        self.cut_by_depth += statistics.cut_by_depth;
        self.cut_by_weight += statistics.cut_by_weight;
    }
}

fn in_order(order: TreeOrder) -> RenderSettings {
    RenderSettings { tree: TreeSettings { order, ..TreeSettings::default() }, ..settings() }
}

/// Compares every way of following trees at so many times of a scene.
fn agree(subject: &Subject, count: u32, spec: StructureSpec) -> Sum {
    let (mut sum, kept) = (Sum::default(), Kept::default());
    for time in subject.times(count) {
        let (stage, structure) = subject.at(time, spec);
        let what = format!("{} at {time:?}", subject.name);
        let reference = render(&stage, structure.as_ref(), &in_order(TreeOrder::Recursive));
        let statistics = &reference.statistics;
        assert!(statistics.incomplete.is_none() && statistics.not_finite == 0, "{what}: {statistics:?}");
        assert!(reference.film.coverage.iter().any(|&share| share > 0.0), "{what}: nothing is seen");
        sum.add(statistics);
        let same = |picture, way: &str| {
            if let Err(told) = difference(&reference, &picture) {
                panic!("{what}: the recursion's and {way}: {told}; notes {:?}", picture.notes);
            }
        };
        for order in [TreeOrder::Stack, TreeOrder::Wavefront] {
            same(render(&stage, structure.as_ref(), &in_order(order)), &format!("the processor's {order}"));
        }
        let drawn_first = RenderSettings { primary: Primary::Rasterised, ..in_order(TreeOrder::Stack) };
        same(render(&stage, structure.as_ref(), &drawn_first), "what the processor drew");
        let Some(device) = software() else { continue };
        let on_adapter = device.prepare(structure.clone()).expect("the scene fits");
        same(render(&stage, &on_adapter, &in_order(TreeOrder::Wavefront)), "the adapter's waves");
        // Asked for by name: where there is no kernel this is an error, and nothing else takes its place.
        same(render_keeping(&stage, &on_adapter, &in_order(TreeOrder::Stack), &kept), "the kernel");
        let drawn = render_keeping(&stage, &on_adapter, &drawn_first, &kept);
        let otherwise = drawn::explain(&stage, &structure, &reference, &drawn)
            .unwrap_or_else(|told| panic!("{what}: traced and drawn by the adapter: {told}"));
        println!(
            "{what}: the same bits in 6 ways; drawn otherwise by the adapter {otherwise:?}, {} rays traced instead",
            drawn.statistics.primary_traced_instead
        );
    }
    println!("{}: {sum:?}", subject.name);
    sum
}

fn all(name: &'static str, count: u32, spec: StructureSpec) -> Option<Sum> {
    Subject::new(name).map(|subject| agree(&subject, count, spec))
}

#[test]
fn robots() {
    let Some(sum) = all("bart_robot/Robot.aff", 3, two_levels()) else { return };
    assert!(sum.shadow_rays > 0 && sum.reflected_rays > 0 && sum.refracted_rays > 0, "{sum:?}");
    assert!(sum.cut_by_depth > 0 && sum.cut_by_weight > 0, "{sum:?}");
}

#[test]
fn kitchen() {
    let Some(sum) = all("bart_kitchen/kitchen.aff", 3, two_levels()) else { return };
    assert!(sum.shadow_rays > 0 && sum.reflected_rays > 0 && sum.refracted_rays > 0, "{sum:?}");
    assert!(sum.cut_by_depth > 0 && sum.cut_by_weight > 0, "{sum:?}");
}

#[test]
fn museum() {
    let Some(sum) = all("bart_museum/museum5.aff", 3, two_levels()) else { return };
    assert!(sum.shadow_rays > 0 && sum.reflected_rays > 0, "{sum:?}");
}

#[test]
fn assembly() {
    let Some(sum) = all("builtin:assembly", 3, two_levels()) else { return };
    assert!(sum.pictures == 3 && sum.shadow_rays > 0, "{sum:?}");
}

/// The file has no animation.
#[test]
fn engine() {
    let Some(sum) = all("engine_2cylinder/2CylinderEngine.glb", 1, two_levels()) else { return };
    assert!(sum.shadow_rays > 0, "{sum:?}");
}

#[test]
fn truck() {
    let Some(sum) = all("milktruck/CesiumMilkTruck.glb", 2, two_levels()) else { return };
    assert!(sum.pictures == 2 && sum.shadow_rays > 0, "{sum:?}");
}

#[test]
fn fox() {
    let Some(sum) = all("fox/Fox.glb", 2, two_levels()) else { return };
    assert!(sum.pictures == 2 && sum.shadow_rays > 0, "{sum:?}");
}

/// A mirror and a ball of glass: rays go deeper than they may, and carry less than they must; both is told. In a plain BVH.
#[test]
fn cornell() {
    let Some(sum) = all("builtin:cornell", 1, StructureSpec::default()) else { return };
    assert!(sum.reflected_rays > 0 && sum.refracted_rays > 0, "{sum:?}");
    assert!(sum.cut_by_depth > 0 && sum.cut_by_weight > 0, "{sum:?}");
}

/// What else may be asked of trees: several samples, whose shadows are soft; no bounce; many, however faint; nothing followed.
#[test]
fn every_setting_of_trees_gives_the_same_bits() {
    let Some(subject) = Subject::new("bart_kitchen/kitchen.aff") else { return };
    let (stage, structure) = subject.at(subject.times(1)[0], two_levels());
    let on_adapter = software().map(|device| device.prepare(structure.clone()).expect("the scene fits"));
    let kept = Kept::default();
    let plain = TreeSettings::default();
    let nothing = TreeSettings { shadows: false, reflections: false, refractions: false, ..plain };
    // The largest first: its kernel's stacks are enough for all.
    for (samples, tree) in [
        (1, TreeSettings { bounces: 16, smallest_weight: 0.0, ..plain }),
        (4, plain),
        (1, TreeSettings { bounces: 0, ..plain }),
        (1, nothing),
        (1, TreeSettings { refractions: true, ..nothing }),
        (1, TreeSettings { smallest_weight: 0.25, ..plain }),
    ] {
        let ordered = |order| {
            let small = settings();
            let (width, height) = (small.width / 2, small.height / 2);
            RenderSettings { width, height, samples, tree: TreeSettings { order, ..tree }, ..small }
        };
        let reference = render(&stage, structure.as_ref(), &ordered(TreeOrder::Recursive));
        let same = |picture, way: &str| {
            if let Err(told) = difference(&reference, &picture) {
                panic!("{samples} samples, {tree:?}: the recursion's and {way}: {told}");
            }
        };
        same(render(&stage, structure.as_ref(), &ordered(TreeOrder::Stack)), "the processor's stack");
        same(render(&stage, structure.as_ref(), &ordered(TreeOrder::Wavefront)), "the processor's waves");
        let Some(on_adapter) = &on_adapter else { continue };
        same(render(&stage, on_adapter, &ordered(TreeOrder::Wavefront)), "the adapter's waves");
        same(render_keeping(&stage, on_adapter, &ordered(TreeOrder::Stack), &kept), "the kernel");
    }
}
