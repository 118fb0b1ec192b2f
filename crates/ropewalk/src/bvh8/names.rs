//! What the triangles of the leaves are called: a number each, in the order of the tie rule.
//!
//! A leaf keeps one word of a triangle instead of the three of [`FlatTriangle`]. The numbers of a geometry of an instance are those of its
//! primitives behind a base; bases grow with (instance, geometry), so the smaller number is the smaller id. A table with
//! an entry for each (instance, geometry) leads back, by bisection, once for each hit that is reported.
//!
//! A tree that is built over a scene numbers all of its triangles as they come, those that were left out, too. So the table follows
//! from the scene alone; that of triangles from anywhere else is found by looking at all of them.

use crate::{FlatTriangle, Scene};

/// One geometry of one instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run {
    /// The number of its primitive 0.
    base: u32,
    /// As in [`FlatTriangle`].
    geometry_and_mirror: u32,
    instance_and_mask: u32,
}

/// All runs, and the mask of all instances where they have the same.
#[derive(Clone, Debug, Default)]
pub(super) struct Names {
    runs: Vec<Run>,
    /// All numbers are below.
    end: u32,
    /// The numbers below that are no triangle's, ascending: those of triangles that were left out.
    holes: Vec<u32>,
    /// The mask, in the top 8 bits, where one mask is every instance's.
    common_mask: Option<u32>,
}

/// One geometry of one instance, and its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Part {
    pub(super) instance: u32,
    pub(super) geometry: u32,
    /// The number of its primitive 0.
    pub(super) base: u32,
    /// Behind the number of its last primitive.
    pub(super) end: u32,
}

/// A triangle's full name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Name {
    pub(super) primitive: u32,
    pub(super) geometry: u32,
    pub(super) instance: u32,
    pub(super) mirrored: bool,
    /// The instance's mask, in the top 8 bits.
    pub(super) mask: u32,
}

/// Which numbers below an end are missing.
fn holes(numbers: &[u32], end: u32) -> Vec<u32> {
    // Nearly always, and told in a quarter of the time.
    if numbers.len() == end as usize && numbers.is_sorted_by(|a, b| a < b) {
        return Vec::new();
    }
    let mut seen = vec![0u64; (end as usize).div_ceil(64)];
    for &number in numbers {
        seen[number as usize / 64] |= 1 << (number % 64);
    }
    let mut holes = Vec::new();
    for (first, word) in (0..end).step_by(64).zip(seen) {
        let mut missing = !word;
        while missing != 0 {
            let number = first.saturating_add(missing.trailing_zeros());
            if number < end {
                holes.push(number);
            }
            missing &= missing - 1;
        }
    }
    holes
}

fn common_mask(runs: &[Run]) -> Option<u32> {
    let mask = |run: &Run| run.instance_and_mask & 0xff00_0000;
    runs.first().map(mask).filter(|&common| runs.iter().all(|run| mask(run) == common))
}

impl Names {
    /// Of the triangles of all instances of a scene, which are numbered as they come; `holes` are the numbers, ascending, of those
    /// that were left out ([`Scene::flatten_numbered`]).
    pub(super) fn of_scene(scene: &Scene, holes: Vec<u32>) -> Self {
        let (mut runs, mut end) = (Vec::new(), 0);
        for (index, instance) in scene.instances.iter().enumerate() {
            let mirror = if instance.transform.mirrors() { FlatTriangle::MIRROR } else { 0 };
            let instance_and_mask = index as u32 | instance.mask << 24;
            for (geometry, mesh) in scene.objects[instance.object as usize].geometries.iter().enumerate() {
                if !mesh.triangles.is_empty() {
                    runs.push(Run {
                        base: end,
                        geometry_and_mirror: geometry as u32 | mirror,
                        instance_and_mask,
                    });
                    end += mesh.triangles.len() as u32;
                }
            }
        }
        Self { common_mask: common_mask(&runs), runs, end, holes }
    }

    /// Of triangles in any order, none of them twice or all of them the same; and the number of each. `None` where there are more numbers than a
    /// word has.
    pub(super) fn of(triangles: &[FlatTriangle]) -> Option<(Self, Vec<u32>)> {
        let key = |triangle: &FlatTriangle| (triangle.instance(), triangle.geometry());
        // Flattened scenes come run after run, so that there are few.
        let mut runs: Vec<(Run, u32)> = Vec::new();
        for part in triangles.chunk_by(|a, b| key(a) == key(b)) {
            let most = part.iter().map(|triangle| triangle.primitive).max().unwrap_or(0);
            let FlatTriangle { geometry_and_mirror, instance_and_mask, .. } = part[0];
            runs.push((Run { base: 0, geometry_and_mirror, instance_and_mask }, most));
        }
        let key_of_run = |run: &Run| {
            (run.instance_and_mask & 0x00ff_ffff, run.geometry_and_mirror & !FlatTriangle::MIRROR)
        };
        runs.sort_by_key(|(run, most)| (key_of_run(run), std::cmp::Reverse(*most)));
        runs.dedup_by_key(|(run, _)| key_of_run(run));
        let mut next = 0u32;
        for (run, most) in &mut runs {
            run.base = next;
            next = next.checked_add(*most)?.checked_add(1)?;
        }
        let runs: Vec<Run> = runs.into_iter().map(|(run, _)| run).collect();
        let mut numbers = Vec::with_capacity(triangles.len());
        for part in triangles.chunk_by(|a, b| key(a) == key(b)) {
            let place = runs.partition_point(|run| key_of_run(run) < key(&part[0]));
            numbers.extend(part.iter().map(|triangle| runs[place].base + triangle.primitive));
        }
        let names = Self { common_mask: common_mask(&runs), runs, end: next, holes: holes(&numbers, next) };
        Some((names, numbers))
    }

    /// Takes masks and sides of the instances of a scene that has all of them.
    pub(super) fn follow(&mut self, scene: &Scene) {
        for run in &mut self.runs {
            let index = run.instance_and_mask & 0x00ff_ffff;
            let Some(instance) = scene.instances.get(index as usize) else { continue };
            let mirror = if instance.transform.mirrors() { FlatTriangle::MIRROR } else { 0 };
            run.instance_and_mask = index | instance.mask << 24;
            run.geometry_and_mirror = run.geometry_and_mirror & !FlatTriangle::MIRROR | mirror;
        }
        self.common_mask = common_mask(&self.runs);
    }

    /// The parts of the scene that have triangles, in the order of their numbers. They end behind their last triangles.
    pub(super) fn parts(&self) -> impl Iterator<Item = Part> + '_ {
        let ends = self.runs.iter().skip(1).map(|run| run.base).chain([self.end]);
        self.runs.iter().zip(ends).filter_map(|(run, end)| {
            let last = self.triangles_end(run.base, end);
            (run.base < last).then_some(Part {
                instance: run.instance_and_mask & 0x00ff_ffff,
                geometry: run.geometry_and_mirror & !FlatTriangle::MIRROR,
                base: run.base,
                end: last,
            })
        })
    }

    /// Behind the last number between two that is a triangle's.
    fn triangles_end(&self, base: u32, mut end: u32) -> u32 {
        for &hole in self.holes[..self.holes.partition_point(|&hole| hole < end)].iter().rev() {
            if end == base || hole + 1 != end {
                break;
            }
            end = hole;
        }
        end
    }

    /// The name behind a number.
    #[inline(always)]
    pub(super) fn name(&self, number: u32) -> Name {
        let place = match self.runs.as_slice() {
            [_] => 0,
            runs => runs.partition_point(|run| run.base <= number) - 1,
        };
        let run = &self.runs[place];
        Name {
            primitive: number - run.base,
            geometry: run.geometry_and_mirror & !FlatTriangle::MIRROR,
            instance: run.instance_and_mask & 0x00ff_ffff,
            mirrored: run.geometry_and_mirror & FlatTriangle::MIRROR != 0,
            mask: run.instance_and_mask & 0xff00_0000,
        }
    }

    /// Whether a ray of some mask, in the top 8 bits, sees the triangle.
    #[inline(always)]
    pub(super) fn sees(&self, mask: u32, number: u32) -> bool {
        match self.common_mask {
            Some(common) => common & mask != 0,
            None => self.name(number).mask & mask != 0,
        }
    }

    /// The mask, in the top 8 bits, that every instance has.
    #[inline(always)]
    pub(super) const fn common_mask(&self) -> Option<u32> {
        self.common_mask
    }

    /// The numbers of a part that are no triangle's, ascending.
    pub(super) fn holes(&self, part: &Part) -> &[u32] {
        let below = |number: u32| self.holes.partition_point(|&hole| hole < number);
        &self.holes[below(part.base)..below(part.end)]
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.runs.as_slice()) + size_of_val(self.holes.as_slice())
    }
}
