//! Small scenes that are hard to get right, each with its rays.
//!
//! A case stands for a way to be wrong: ties, flat boxes, huge and tiny numbers, damaged input, deep trees. The
//! names are stable, because tests name the case that must catch a mistake. All are small enough to be asked
//! everything of, by every row of the catalogue, in seconds.

mod input;
mod scale;
mod shape;
mod ties;
mod tree;

pub use tree::Tree;

use crate::random::Random;
use crate::rays::{RayClass, RayMaker};
use glam::DVec3;
use ropewalk::{BuildOptions, FlatScene, Hit, PreparedRay, Ray, Scene, StructureSpec};
use std::ops::Range;

/// A scene, and what is asked of it.
#[derive(Clone, Debug)]
pub struct Case {
    /// The stable name.
    pub name: &'static str,
    /// What is hard about it.
    pub about: &'static str,
    /// The scene.
    pub scene: Scene,
    /// The rays, class after class.
    pub rays: Vec<Ray>,
    /// Which rays are of which class.
    pub classes: Vec<(RayClass, Range<usize>)>,
    /// Depth caps to build with, besides the structure's own, with one triangle a leaf.
    pub depth_caps: &'static [u32],
    /// Depths of chains that are asked besides, whatever a builder would make.
    pub chains: &'static [u32],
    /// How many triangles of the scene must be left out as bad input.
    pub skipped: usize,
}

impl Case {
    /// Every case.
    #[must_use]
    pub fn every() -> Vec<Self> {
        recipes().map(|(name, make)| make(name)).collect()
    }

    /// The names of all cases.
    #[must_use]
    pub fn names() -> Vec<&'static str> {
        recipes().map(|(name, _)| *name).collect()
    }

    /// One case.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        recipes().find(|(other, _)| *other == name).map(|(name, make)| make(name))
    }

    /// A case with rays of every class.
    fn new(name: &'static str, about: &'static str, scene: Scene) -> Self {
        let flat = scene.flatten().unwrap_or_default();
        // The name is the seed, so that a new case leaves the rays of the others alone.
        let seed = name.bytes().fold(17u64, |seed, byte| seed.wrapping_mul(31).wrapping_add(u64::from(byte)));
        let maker = RayMaker::new(&flat, seed);
        let closest = |rays: &[Ray]| rays.iter().map(|ray| closest_by_force(&flat, ray)).collect();
        let mut case = Self {
            name,
            about,
            scene,
            rays: vec![],
            classes: vec![],
            depth_caps: &[],
            chains: &[],
            skipped: 0,
        };
        for class in RayClass::EVERY {
            case.add(class, maker.make(class, RAYS_A_CLASS, &closest));
        }
        case
    }

    /// Adds rays of a class.
    fn add(&mut self, class: RayClass, rays: Vec<Ray>) {
        let first = self.rays.len();
        self.rays.extend(rays);
        self.classes.push((class, first..self.rays.len()));
    }

    fn with_rays(mut self, class: RayClass, rays: Vec<Ray>) -> Self {
        self.add(class, rays);
        self
    }

    /// Adds rays that start within `reach` of `inside` and of which none may escape.
    fn closed_around(mut self, inside: DVec3, reach: f64) -> Self {
        let flat = self.scene.flatten().unwrap_or_default();
        let rays = RayMaker::new(&flat, 99).rays_from_inside(inside, reach, 4 * RAYS_A_CLASS);
        self.add(RayClass::Inside, rays);
        self
    }

    /// Adds rays from outside into the ball of radius `reach` about `inside`, none of which may come in unseen: for closed
    /// meshes whose fronts are outside.
    fn entered_into(mut self, inside: DVec3, reach: f64) -> Self {
        let flat = self.scene.flatten().unwrap_or_default();
        let rays = RayMaker::new(&flat, 98).rays_from_outside(inside, reach, 4 * RAYS_A_CLASS);
        self.add(RayClass::Outside, rays);
        self
    }

    fn with_depth_caps(self, depth_caps: &'static [u32]) -> Self {
        Self { depth_caps, ..self }
    }

    fn with_chains(self, chains: &'static [u32]) -> Self {
        Self { chains, ..self }
    }

    /// The trees to ask for a row: its own, one for each depth cap, and chains.
    #[must_use]
    pub fn trees(&self, row: StructureSpec) -> Vec<Tree> {
        // Structures that choose their depth themselves have one tree.
        let caps = if row.build_options().is_some() { self.depth_caps } else { &[] };
        let capped = caps.iter().map(|&max_depth| {
            let plain = row.build_options().copied().unwrap_or_default();
            row.with_build_options(BuildOptions { max_depth, max_leaf: 1, ..plain })
        });
        let built = std::iter::once(row).chain(capped).map(Tree::built);
        built.chain(Tree::chains(row, self.chains)).collect()
    }
}

/// A case's name and how it is made.
type Recipe = (&'static str, fn(&'static str) -> Case);

fn recipes() -> impl Iterator<Item = &'static Recipe> {
    [input::RECIPES, shape::RECIPES, ties::RECIPES, scale::RECIPES].into_iter().flatten()
}

/// Rays of each class in each case.
const RAYS_A_CLASS: usize = 96;

/// The closest hit by testing every triangle.
fn closest_by_force(scene: &FlatScene, ray: &Ray) -> Hit {
    let Some(prepared) = PreparedRay::new(ray) else { return Hit::MISS };
    let hits = scene.triangles.iter().filter_map(|triangle| triangle.intersect(&prepared, ray.t_max));
    hits.fold(Hit::MISS, |best, hit| if hit.precedes(&best) { hit } else { best })
}

/// A random rotation, from a random unit quaternion.
fn rotation(random: &mut Random) -> glam::DQuat {
    loop {
        let (a, b) = (random.in_cube(), random.between(-1.0, 1.0));
        let quaternion = glam::DQuat::from_xyzw(a.x, a.y, a.z, b);
        if (0.01..=1.0).contains(&quaternion.length_squared()) {
            return quaternion.normalize();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cases_are_named_apart_small_and_full_of_rays() {
        let cases = Case::every();
        let names: std::collections::HashSet<&str> = cases.iter().map(|case| case.name).collect();
        assert_eq!((names.len(), Case::names().len()), (cases.len(), cases.len()));
        assert!(Case::named("soup").is_some_and(|case| case.name == "soup") && Case::named("soap").is_none());
        assert!(cases.len() >= 20);
        for case in &cases {
            let flat = case.scene.flatten().unwrap();
            assert_eq!(flat.report.skipped(), case.skipped, "{}", case.name);
            assert!(flat.triangles.len() <= 6000, "{} has {}", case.name, flat.triangles.len());
            assert!((500..8000).contains(&case.rays.len()), "{} has {} rays", case.name, case.rays.len());
            let ends = case.classes.iter().map(|(_, range)| range.len()).sum::<usize>();
            assert_eq!(ends, case.rays.len(), "{}", case.name);
            let centers = flat.triangles.iter().map(|triangle| triangle.triangle().bounds().center());
            assert!(
                case.name != "concentric" || centers.into_iter().all(|center| center == glam::Vec3::ZERO)
            );
            let hits = case.rays.iter().filter(|ray| closest_by_force(&flat, ray).is_hit()).count();
            assert!(flat.triangles.is_empty() || hits > 300, "{}: only {hits} rays hit", case.name);
        }
    }
}
