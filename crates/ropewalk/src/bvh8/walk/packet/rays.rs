//! The rays of a packet, side by side, and the intervals that hold them.

use super::super::ray::{FAR, NEAR, OCTANTS, Slabs};
use super::super::triangles::{RayLanes, Triple};
use super::{GROUPS, RAYS};
use crate::Ray;
use crate::aabb::{PAD_ENTRY, PAD_EXIT, larger, smaller};
use crate::bvh8::simd::Level;
use crate::bvh8::tree::WIDTH;
use crate::ray::{LARGEST_DIRECTION, PARALLEL, SMALLEST_DIRECTION};

/// A number of each ray.
type Numbers = [[f32; WIDTH]; GROUPS];

/// Rays side by side.
#[repr(C, align(64))]
pub(super) struct Packet {
    origin: [Numbers; 3],
    inverse: [Numbers; 3],
    shears: [Numbers; 3],
    pub(super) t_min: Numbers,
    pub(super) t_max: Numbers,
    pub(super) masks: [u32; RAYS],
    /// Origins and directions, a lane a group: what intervals are made of.
    across: [Numbers; 6],
    /// The intervals of each group, a lane a group: as [`Slabs`], and ends of windows.
    near: [[f32; WIDTH]; 3],
    far: [[f32; WIDTH]; 3],
    near_inverse: [[f32; WIDTH]; 3],
    far_inverse: [[f32; WIDTH]; 3],
    ends: [f32; WIDTH],
    /// The intervals of all rays.
    pub(super) slabs: Slabs,
    pub(super) axes: [usize; 3],
    forward: bool,
    /// Along which axes they run backwards.
    backwards: [bool; 3],
    /// How many groups of eight there are.
    pub(super) groups: usize,
}

impl Packet {
    pub(super) const EMPTY: Self = Self {
        origin: [[[0.0; WIDTH]; GROUPS]; 3],
        inverse: [[[0.0; WIDTH]; GROUPS]; 3],
        shears: [[[0.0; WIDTH]; GROUPS]; 3],
        t_min: [[0.0; WIDTH]; GROUPS],
        t_max: [[0.0; WIDTH]; GROUPS],
        masks: [0; RAYS],
        across: [[[0.0; WIDTH]; GROUPS]; 6],
        near: [[0.0; WIDTH]; 3],
        far: [[0.0; WIDTH]; 3],
        near_inverse: [[0.0; WIDTH]; 3],
        far_inverse: [[0.0; WIDTH]; 3],
        ends: [0.0; WIDTH],
        slabs: Slabs::NONE,
        axes: [0, 1, 2],
        forward: true,
        backwards: [false; 3],
        groups: 0,
    };

    /// Takes the rays; false where they do not all run alike, or need the care that single rays get.
    #[inline(always)]
    pub(super) fn take<L: Level>(&mut self, level: L, rays: &[Ray]) -> bool {
        if !may_run_alike(rays) {
            return false;
        }
        self.groups = (rays.len() / WIDTH).min(GROUPS);
        // Directions lie where the inverses will.
        for (place, ray) in rays.iter().enumerate().take(RAYS) {
            let (group, lane) = (place / WIDTH, place % WIDTH);
            let (origin, dir) = (ray.origin.to_array(), ray.dir.to_array());
            for axis in 0..3 {
                self.origin[axis][group][lane] = origin[axis];
                self.inverse[axis][group][lane] = dir[axis];
                self.across[axis][lane][group] = origin[axis];
                self.across[3 + axis][lane][group] = dir[axis];
            }
            self.t_min[group][lane] = ray.t_min;
            self.t_max[group][lane] = ray.t_max;
            self.masks[place] = ray.mask << 24;
        }
        let first = rays[0].dir.abs();
        let of_two = usize::from(first.y > first.x);
        let kz = if first.z > first[of_two] { 2 } else { of_two };
        self.axes = [(kz + 1) % 3, (kz + 2) % 3, kz];
        self.forward = rays[0].dir[kz] > 0.0;
        self.backwards = [rays[0].dir.x < 0.0, rays[0].dir.y < 0.0, rays[0].dir.z < 0.0];
        self.prepare(level)
    }

    /// What [`crate::PreparedRay`] works out, for all.
    #[inline(always)]
    fn prepare<L: Level>(&mut self, level: L) -> bool {
        let [kx, ky, kz] = self.axes;
        let mut every = 0xff;
        let (largest, one, zero) = (level.splat(f32::MAX), level.splat(1.0), level.splat(0.0));
        let mut soonest = largest;
        for group in 0..self.groups.min(GROUPS) {
            let dir = self.at(level, &self.inverse, group);
            let origin = self.at(level, &self.origin, group);
            let size = [magnitude(level, dir[0]), magnitude(level, dir[1]), magnitude(level, dir[2])];
            // As the scalar code chooses, ties and all: y over x where it is larger, z over both where it is larger.
            let y_over_x = level.less(size[0], size[1]);
            let of_two = level.select(y_over_x, size[1], size[0]);
            let z_over_both = level.bits(level.less(of_two, size[2]));
            let chosen = match kz {
                2 => z_over_both,
                1 => level.bits(y_over_x) & !z_over_both,
                _ => !level.bits(y_over_x) & !z_over_both,
            };
            let alike = self.alike(level, &dir);
            let parallel = level.mul(size[kz], level.splat(PARALLEL));
            let steep = level.both(
                level.less(parallel, size[0]),
                level.both(level.less(parallel, size[1]), level.less(parallel, size[2])),
            );
            let usual = level.both(
                level.at_most(size[kz], level.splat(LARGEST_DIRECTION)),
                level.at_most(level.splat(SMALLEST_DIRECTION), size[kz]),
            );
            let t_min = level.row(&self.t_min[group]);
            let t_max = level.row(&self.t_max[group]);
            let window = level.both(level.at_most(zero, t_min), level.at_most(t_max, t_max));
            let there = level.both(
                level.at_most(magnitude(level, origin[0]), largest),
                level.both(
                    level.at_most(magnitude(level, origin[1]), largest),
                    level.at_most(magnitude(level, origin[2]), largest),
                ),
            );
            every &=
                alike & chosen & level.bits(level.both(level.both(steep, usual), level.both(window, there)));

            let inverse = [level.div(one, dir[0]), level.div(one, dir[1]), level.div(one, dir[2])];
            for (rows, inverse) in self.inverse.iter_mut().zip(inverse) {
                rows[group] = level.numbers(inverse);
            }
            soonest = level.smaller(soonest, t_min);
            self.shears[0][group] = level.numbers(level.div(dir[kx], dir[kz]));
            self.shears[1][group] = level.numbers(level.div(dir[ky], dir[kz]));
            self.shears[2][group] = level.numbers(level.div(one, dir[kz]));
            // Infinity is the t of a miss, so no hit may have it.
            self.t_max[group] = level.numbers(level.smaller(t_max, largest));
        }
        if every != 0xff {
            return false;
        }
        self.slabs.t_min = least(&level.numbers(soonest), self.groups);
        self.bound(level);
        true
    }

    /// Which directions have the octant of the first ray.
    #[inline(always)]
    fn alike<L: Level>(&self, level: L, dir: &Triple<L>) -> u32 {
        let mut alike = 0xff;
        for (&dir, expected) in dir.iter().zip(self.backwards) {
            let backwards = level.bits(level.less(dir, level.splat(0.0)));
            alike &= if expected { backwards } else { !backwards };
        }
        alike
    }

    /// Works out the intervals: along each axis the origin and the inverse that enter a box soonest, and those that leave it last.
    #[inline(always)]
    fn bound<L: Level>(&mut self, level: L) {
        let mut octant = 0;
        for axis in 0..3 {
            let (low, high) = extremes(level, &self.across[axis]);
            let (slowest, fastest) = extremes(level, &self.across[3 + axis]);
            // The inverse of the one is an end of the inverses' interval, as division is monotone.
            let one = level.splat(1.0);
            let backwards = self.backwards[axis];
            octant |= usize::from(backwards) << axis;
            let (near, far, slow, fast) =
                if backwards { (low, high, slowest, fastest) } else { (high, low, fastest, slowest) };
            let slow = level.mul(level.div(one, slow), level.splat(NEAR));
            let fast = level.mul(level.div(one, fast), level.splat(FAR));
            self.near[axis] = level.numbers(near);
            self.far[axis] = level.numbers(far);
            self.near_inverse[axis] = level.numbers(slow);
            self.far_inverse[axis] = level.numbers(fast);
            let slabs = &mut self.slabs;
            if backwards {
                slabs.near[axis] = least(&self.near[axis], self.groups);
                slabs.far[axis] = most(&self.far[axis], self.groups);
                slabs.near_inverse[axis] = most(&self.near_inverse[axis], self.groups);
                slabs.far_inverse[axis] = least(&self.far_inverse[axis], self.groups);
            } else {
                slabs.near[axis] = most(&self.near[axis], self.groups);
                slabs.far[axis] = least(&self.far[axis], self.groups);
                slabs.near_inverse[axis] = least(&self.near_inverse[axis], self.groups);
                slabs.far_inverse[axis] = most(&self.far_inverse[axis], self.groups);
            }
        }
        self.slabs.octant = OCTANTS[octant];
    }

    /// Three numbers of a group's rays.
    #[inline(always)]
    fn at<L: Level>(&self, level: L, numbers: &[Numbers; 3], group: usize) -> Triple<L> {
        [level.row(&numbers[0][group]), level.row(&numbers[1][group]), level.row(&numbers[2][group])]
    }

    /// The rays of a group as the triangle test takes them.
    #[inline(always)]
    pub(super) fn lanes<L: Level>(&self, level: L, group: usize) -> RayLanes<L> {
        let [kx, ky, kz] = self.axes;
        let origin = [
            level.row(&self.origin[kx][group]),
            level.row(&self.origin[ky][group]),
            level.row(&self.origin[kz][group]),
        ];
        RayLanes {
            origin,
            shears: self.at(level, &self.shears, group),
            low: origin,
            high: origin,
            inverse: [
                level.row(&self.inverse[kx][group]),
                level.row(&self.inverse[ky][group]),
                level.row(&self.inverse[kz][group]),
            ],
            t_min: level.row(&self.t_min[group]),
            t_max: level.row(&self.t_max[group]),
            forward: self.forward,
        }
    }

    /// Which rays of a group enter a box: the scalar slab test, its near and far sides known.
    #[inline(always)]
    pub(super) fn enters<L: Level>(&self, level: L, group: usize, near: &Triple<L>, far: &Triple<L>) -> u32 {
        let origin = self.at(level, &self.origin, group);
        let inverse = self.at(level, &self.inverse, group);
        let mut entry = level.mul(level.sub(near[0], origin[0]), inverse[0]);
        let mut exit = level.mul(level.sub(far[0], origin[0]), inverse[0]);
        for axis in 1..3 {
            entry = level.larger(level.mul(level.sub(near[axis], origin[axis]), inverse[axis]), entry);
            exit = level.smaller(level.mul(level.sub(far[axis], origin[axis]), inverse[axis]), exit);
        }
        let entry = level.larger(level.mul(entry, level.splat(PAD_ENTRY)), level.row(&self.t_min[group]));
        let exit = level.smaller(level.mul(exit, level.splat(PAD_EXIT)), level.row(&self.t_max[group]));
        level.bits(level.at_most(entry, exit))
    }

    /// Which groups may enter a box: a bit a group. None that has a ray which enters it is left out.
    #[inline(always)]
    pub(super) fn groups_that_enter<L: Level>(&self, level: L, near: &Triple<L>, far: &Triple<L>) -> u32 {
        let mut entry = level.splat(self.slabs.t_min);
        let mut exit = level.row(&self.ends);
        for axis in 0..3 {
            let first = level.sub(near[axis], level.row(&self.near[axis]));
            let last = level.sub(far[axis], level.row(&self.far[axis]));
            entry = level.larger(level.mul(first, level.row(&self.near_inverse[axis])), entry);
            exit = level.smaller(level.mul(last, level.row(&self.far_inverse[axis])), exit);
        }
        level.bits(level.at_most(entry, exit)) & (0xff >> (WIDTH - self.groups.min(WIDTH)))
    }

    /// Brings the ends of some groups, a bit each, up to date, and tells the last of all.
    #[inline(always)]
    pub(super) fn close(&mut self, changed: u32) -> f32 {
        for group in 0..self.groups.min(GROUPS) {
            if changed >> group & 1 != 0 {
                self.ends[group] = most(&self.t_max[group], WIDTH);
            }
        }
        most(&self.ends, self.groups)
    }
}

/// Whether some have the octant of the first: a first look, so that a batch that does not run alike costs little. The second look is
/// [`Packet::prepare`]'s.
#[inline(always)]
fn may_run_alike(rays: &[Ray]) -> bool {
    let first = octant(&rays[0]);
    let few = [1, rays.len() / 2, rays.len() - 1];
    few.into_iter().all(|place| octant(&rays[place]) == first)
}

#[inline(always)]
fn octant(ray: &Ray) -> u32 {
    let sign = 1 << 31;
    (ray.dir.x.to_bits() & sign) >> 2 | (ray.dir.y.to_bits() & sign) >> 1 | (ray.dir.z.to_bits() & sign)
}

/// The lowest and the highest of eight rows, lane by lane.
#[inline(always)]
fn extremes<L: Level>(level: L, rows: &Numbers) -> (L::Floats, L::Floats) {
    let mut low = level.row(&rows[0]);
    let mut high = low;
    for row in &rows[1..] {
        low = level.smaller(low, level.row(row));
        high = level.larger(high, level.row(row));
    }
    (low, high)
}

#[inline(always)]
fn magnitude<L: Level>(level: L, floats: L::Floats) -> L::Floats {
    level.larger(floats, level.sub(level.splat(0.0), floats))
}

/// The smallest of the first `count`.
#[inline(always)]
fn least(numbers: &[f32; WIDTH], count: usize) -> f32 {
    let mut least = numbers[0];
    for &number in numbers.iter().take(count) {
        least = smaller(number, least);
    }
    least
}

/// The largest of the first `count`.
#[inline(always)]
fn most(numbers: &[f32; WIDTH], count: usize) -> f32 {
    let mut most = numbers[0];
    for &number in numbers.iter().take(count) {
        most = larger(number, most);
    }
    most
}
