//! The rays of the arena: five classes, the same for every engine.
//!
//! Directions have unit length, `t_min` is 0, and no ray has a mask: every engine can take them as they are. Where a class has
//! packets, they are laid out beforehand and cost their engine no time.

use ropewalk::glam::{DVec3, Vec3};
use ropewalk::{FlatScene, Hit, Query, Ray};
use ropewalk_testkit::rays::{Closest, RayClass, RayMaker};
use std::fmt;
use std::str::FromStr;

use super::{Turn, Viewpoint};

/// A kind of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ArenaClass {
    /// Through the pixels of a camera, row by row; closest hit.
    Primary,
    /// From what the camera sees, distributed by the cosine, in the camera's order; closest hit.
    Diffuse,
    /// The same in random order; closest hit.
    DiffuseShuffled,
    /// From what the camera sees to a point light; any hit.
    Shadow,
    /// The rays of [`ArenaClass::DiffuseShuffled`], however far; any hit.
    AmbientOcclusion,
}

impl ArenaClass {
    /// Every class.
    pub const EVERY: [Self; 5] =
        [Self::Primary, Self::Diffuse, Self::DiffuseShuffled, Self::Shadow, Self::AmbientOcclusion];

    /// The name in tables and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Diffuse => "diffuse",
            Self::DiffuseShuffled => "diffuse-shuffled",
            Self::Shadow => "shadow",
            Self::AmbientOcclusion => "ambient-occlusion",
        }
    }

    /// What is asked.
    #[must_use]
    pub const fn query(self) -> Query {
        match self {
            Self::Shadow | Self::AmbientOcclusion => Query::Any,
            _ => Query::Closest,
        }
    }

    /// Whether neighbouring rays go the same way, so that packets make sense.
    #[must_use]
    pub const fn is_coherent(self) -> bool {
        matches!(self, Self::Primary | Self::Shadow)
    }

    const fn made_as(self) -> RayClass {
        match self {
            Self::Primary => RayClass::Primary,
            Self::Diffuse => RayClass::DiffuseBounce,
            Self::DiffuseShuffled | Self::AmbientOcclusion => RayClass::DiffuseShuffled,
            Self::Shadow => RayClass::Shadow,
        }
    }
}

impl fmt::Display for ArenaClass {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for ArenaClass {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::EVERY.into_iter().find(|class| class.name() == text).ok_or_else(|| {
            let names = Self::EVERY.map(Self::name).join(", ");
            format!("there is no ray class '{text}'; the classes are {names}")
        })
    }
}

/// So many rays lane by lane, as packet tracers take them.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Packet<const N: usize> {
    /// Origins: all x, all y, all z.
    pub origin: [[f32; N]; 3],
    /// The lower ends of the windows.
    pub t_min: [f32; N],
    /// Directions: all x, all y, all z.
    pub dir: [[f32; N]; 3],
    /// The upper ends of the windows.
    pub t_max: [f32; N],
    /// How many lanes are rays; the others repeat the last one.
    pub count: usize,
}

impl<const N: usize> Packet<N> {
    fn new(rays: &[Ray]) -> Self {
        let lane = |lane: usize| rays[lane.min(rays.len() - 1)];
        let each = |pick: &dyn Fn(&Ray) -> f32| std::array::from_fn(|index| pick(&lane(index)));
        Self {
            origin: std::array::from_fn(|axis| each(&|ray| ray.origin[axis])),
            t_min: each(&|ray| ray.t_min),
            dir: std::array::from_fn(|axis| each(&|ray| ray.dir[axis])),
            t_max: each(&|ray| ray.t_max),
            count: rays.len(),
        }
    }

    fn of_all(rays: &[Ray]) -> Vec<Self> {
        rays.chunks(N).map(Self::new).collect()
    }
}

/// The rays of a class.
#[derive(Clone, Debug)]
pub struct RaySet {
    /// Which.
    pub class: ArenaClass,
    /// The rays.
    pub rays: Vec<Ray>,
    /// The same by eights, where the class is coherent; packet `i` begins at ray `8 i`.
    pub packets8: Vec<Packet<8>>,
    /// The same by sixteens.
    pub packets16: Vec<Packet<16>>,
}

impl RaySet {
    /// Rays of a class.
    #[must_use]
    pub fn new(class: ArenaClass, rays: Vec<Ray>) -> Self {
        let coherent = if class.is_coherent() { &rays[..] } else { &[] };
        let (packets8, packets16) = (Packet::of_all(coherent), Packet::of_all(coherent));
        Self { class, rays, packets8, packets16 }
    }

    /// The class with `count` rays. `upright` is the scene as it stands; where the scene is turned, so are the rays. Empty
    /// where the class starts on surfaces and the camera sees none.
    #[must_use]
    pub fn make(
        class: ArenaClass,
        upright: &FlatScene,
        viewpoint: &Viewpoint,
        turn: Option<&Turn>,
        count: usize,
        seed: u64,
        closest: &Closest<'_>,
    ) -> Self {
        let maker = RayMaker::new(upright, seed).with_view(viewpoint.view).with_light(viewpoint.light);
        let rays = maker.make(class.made_as(), count, closest);
        Self::new(class, rays.into_iter().filter_map(|ray| unit(&ray, turn)).collect())
    }

    /// What is asked.
    #[must_use]
    pub fn query(&self) -> Query {
        self.class.query()
    }
}

/// The same ray with a direction of unit length, turned.
fn unit(ray: &Ray, turn: Option<&Turn>) -> Option<Ray> {
    let dir = ray.dir.as_dvec3();
    let length = dir.length();
    let unit = dir.try_normalize()?;
    let place = |point: DVec3| turn.map_or(point, |turn| turn.point(point)).as_vec3();
    let dir: Vec3 = turn.map_or(unit, |turn| turn.direction(unit)).as_vec3();
    let t_max = (f64::from(ray.t_max) * length) as f32;
    Some(Ray::new(place(ray.origin.as_dvec3()), dir).window(0.0, t_max))
}

/// A tracer's answers to a set: one of the two is as long as the rays, the other empty.
#[derive(Clone, Debug, Default)]
pub struct Answers {
    /// Of closest hits.
    pub hits: Vec<Hit>,
    /// Of any hits.
    pub any: Vec<bool>,
}

impl Answers {
    /// Room for the answers to a set, filled with what no engine may leave there.
    #[must_use]
    pub fn poisoned(set: &RaySet) -> Self {
        let poison = Hit { t: f32::NAN, primitive_index: 0xdead_beef, ..Hit::MISS };
        match set.query() {
            Query::Any => Self { hits: Vec::new(), any: vec![false; set.rays.len()] },
            _ => Self { hits: vec![poison; set.rays.len()], any: Vec::new() },
        }
    }

    /// The opposite of what is there, so that an engine that writes nothing is found out.
    pub fn invert(&mut self) {
        self.any.iter_mut().for_each(|hit| *hit = !*hit);
        self.hits.iter_mut().for_each(|hit| hit.t = f32::NAN);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packets_hold_the_rays_lane_by_lane() {
        let rays: Vec<Ray> = (0..19)
            .map(|i| Ray::new(Vec3::new(i as f32, 1.0, 2.0), Vec3::Z).window(0.0, 5.0 + i as f32))
            .collect();
        let set = RaySet::new(ArenaClass::Primary, rays.clone());
        assert_eq!((set.packets8.len(), set.packets16.len()), (3, 2));
        assert_eq!(set.packets8[1].origin[0][2], 10.0);
        assert_eq!(
            (set.packets16[1].count, set.packets16[1].t_max[2], set.packets16[1].t_max[9]),
            (3, 23.0, 23.0)
        );
        assert!(RaySet::new(ArenaClass::Diffuse, rays).packets8.is_empty());
        assert!(RaySet::new(ArenaClass::Primary, Vec::new()).packets8.is_empty());
    }

    #[test]
    fn a_ray_keeps_its_end_when_its_direction_gets_unit_length() {
        let ray = Ray::new(Vec3::ONE, Vec3::new(0.0, 3.0, 4.0)).window(0.0, 1.0);
        let made = unit(&ray, None).unwrap();
        assert!(
            (made.at(made.t_max) - ray.at(1.0)).length() < 1e-5 && (made.dir.length() - 1.0).abs() < 1e-6
        );
        assert!(unit(&Ray::new(Vec3::ONE, Vec3::ZERO), None).is_none());
        assert!(unit(&Ray::new(Vec3::ONE, Vec3::X), None).unwrap().t_max.is_infinite());
    }

    #[test]
    fn classes_are_found_by_name() {
        for class in ArenaClass::EVERY {
            assert_eq!(class.name().parse(), Ok(class));
        }
        assert!("ao".parse::<ArenaClass>().unwrap_err().contains("ambient-occlusion"));
    }
}
