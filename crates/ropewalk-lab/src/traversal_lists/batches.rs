//! The rays of a class, where each begins, and the answers that every setting must give.

use super::orbit::{Orbit, picture};
use super::truth::{Sides, Truth};
use glam::DVec3;
use ropewalk::traversal_list::Frustum;
use ropewalk::{Answer, Hit, Query, Ray, TraceError, Traced};
use ropewalk_testkit::random::Random;

/// What is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    /// The pixels of all views.
    Primary,
    /// From the front of what is seen to the light, where it faces the light.
    Shadow,
    /// From there distributed by the cosine.
    Diffuse,
    /// One view of many pixels, with its shadow rays.
    Frame,
}

impl Class {
    /// The name in tables and files.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Diffuse => "diffuse",
            Self::Frame => "frame",
        }
    }
}

/// What is known of where the rays of a part begin.
#[derive(Clone, Debug)]
pub(super) enum Begin {
    /// At the eye, each in a cell of the screen.
    Eye { frustum: Frustum, cells: Vec<u32> },
    /// On a triangle each, by their numbers.
    Triangles(Vec<u32>),
}

/// Rays that are traced in one go.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) query: Query,
    pub(super) rays: Vec<Ray>,
    pub(super) begin: Begin,
    /// What triangles of two sides answer.
    pub(super) two_sided: Traced,
    /// What triangles of one side answer.
    pub(super) one_sided: Traced,
}

/// Rays of a class.
#[derive(Clone, Debug)]
pub(super) struct Batch {
    pub(super) class: Class,
    pub(super) parts: Vec<Part>,
}

impl Batch {
    /// How many rays there are.
    pub(super) fn len(&self) -> usize {
        self.parts.iter().map(|part| part.rays.len()).sum()
    }
}

/// The batches that are counted: all views, `side` pixels wide.
pub(super) fn counted(orbit: &Orbit, side: usize, truth: &Truth) -> Result<Vec<Batch>, TraceError> {
    let views = orbit
        .frustums
        .iter()
        .map(|frustum| Part::primary(frustum, side, truth))
        .collect::<Result<Vec<_>, _>>()?;
    let seen: Vec<SurfacePoint> = views.iter().flat_map(|part| part.seen(orbit, truth)).collect();
    let shadow = Part::towards(&seen, orbit.light, truth)?;
    let diffuse = Part::bounced(&seen, truth)?;
    let batches = [(Class::Primary, views), (Class::Shadow, vec![shadow]), (Class::Diffuse, vec![diffuse])];
    Ok(batches.into_iter().map(|(class, parts)| Batch { class, parts }).filter(|it| it.len() > 0).collect())
}

/// The frame that is timed: the first view, `side` pixels wide.
pub(super) fn frame(orbit: &Orbit, side: usize, truth: &Truth) -> Result<Option<Batch>, TraceError> {
    let Some(frustum) = orbit.frustums.first() else { return Ok(None) };
    let primary = Part::primary(frustum, side, truth)?;
    let seen = primary.seen(orbit, truth);
    let shadow = Part::towards(&seen, orbit.light, truth)?;
    Ok(Some(Batch { class: Class::Frame, parts: vec![primary, shadow] }))
}

/// A point of a front that is seen, moved off the surface.
#[derive(Clone, Copy, Debug)]
struct SurfacePoint {
    position: DVec3,
    normal: DVec3,
    /// The triangle's number.
    triangle: u32,
}

impl Part {
    fn new(query: Query, rays: Vec<Ray>, begin: Begin, truth: &Truth) -> Result<Self, TraceError> {
        let two_sided = truth.answer(Sides::Two, query, &rays)?;
        let one_sided = truth.answer(Sides::One, query, &rays)?;
        Ok(Self { query, rays, begin, two_sided, one_sided })
    }

    fn primary(frustum: &Frustum, side: usize, truth: &Truth) -> Result<Self, TraceError> {
        let (rays, cells) = picture(frustum, side);
        Self::new(Query::Closest, rays, Begin::Eye { frustum: *frustum, cells }, truth)
    }

    /// What the rays see of fronts.
    fn seen(&self, orbit: &Orbit, truth: &Truth) -> Vec<SurfacePoint> {
        let Answer::Closest(hits) = &self.two_sided.answer else { return Vec::new() };
        let point = |(ray, hit): (&Ray, &Hit)| {
            let triangle = hit.front_face.then(|| truth.number_of(hit)).flatten()?;
            let normal = truth.triangles().get(triangle as usize)?.front().as_dvec3().try_normalize()?;
            let at = ray.origin.as_dvec3() + ray.dir.as_dvec3() * f64::from(hit.t);
            Some(SurfacePoint { position: at + normal * orbit.off, normal, triangle })
        };
        self.rays.iter().zip(hits).filter_map(point).collect()
    }

    /// A ray to the light from each point that faces it.
    fn towards(seen: &[SurfacePoint], light: DVec3, truth: &Truth) -> Result<Self, TraceError> {
        let ray = |point: &SurfacePoint| {
            let origin = point.position.as_vec3();
            let dir = light - origin.as_dvec3();
            let faces = dir.dot(point.normal) > 0.0;
            faces.then(|| (Ray::new(origin, dir.as_vec3()).window(0.0, 1.0), point.triangle))
        };
        let (rays, triangles) = seen.iter().filter_map(ray).unzip();
        Self::new(Query::Any, rays, Begin::Triangles(triangles), truth)
    }

    /// A ray from each point, distributed by the cosine to the normal.
    fn bounced(seen: &[SurfacePoint], truth: &Truth) -> Result<Self, TraceError> {
        let mut random = Random::new(7);
        let ray = |point: &SurfacePoint| {
            let dir = (point.normal + random.direction() * 0.999_999).normalize();
            (Ray::new(point.position.as_vec3(), dir.as_vec3()), point.triangle)
        };
        let (rays, triangles) = seen.iter().map(ray).unzip();
        Self::new(Query::Closest, rays, Begin::Triangles(triangles), truth)
    }
}

#[cfg(test)]
mod tests {
    use super::super::stage::Stage;
    use super::*;
    use ropewalk::Scene;
    use ropewalk::traversal_list::{Clearance, Heads, ListOptions, Starts};
    use ropewalk_testkit::meshes;

    #[test]
    fn rays_leave_the_fronts_of_what_is_seen() {
        let stage = Stage::new(Scene::from_mesh(meshes::icosphere(2)));
        let truth = Truth::new(&stage.on_ground).unwrap();
        let above =
            ListOptions { heads: Heads::Simple, clearance: Clearance::Above, ..ListOptions::default() };
        let orbit = Orbit::around(&stage.bounds, &stage.on_ground.bounds(), 4);
        let batches = counted(&orbit, 12, &truth).unwrap();
        let classes: Vec<_> = batches.iter().map(|batch| (batch.class.name(), batch.parts.len())).collect();
        assert_eq!(classes, [("primary", 6), ("shadow", 1), ("diffuse", 1)]);
        assert_eq!(batches[0].len(), 6 * 144);
        assert!(batches[1].len() > 100 && batches[2].len() > batches[1].len());
        for part in batches.iter().skip(1).flat_map(|batch| &batch.parts) {
            let Begin::Triangles(numbers) = &part.begin else { panic!("{part:?}") };
            for (ray, &number) in part.rays.iter().zip(numbers) {
                let triangle = truth.triangles()[number as usize];
                assert!(ray.dir.dot(triangle.front()) > 0.0 && triangle.front().y.is_finite());
                assert!((ray.origin - triangle.triangle().vertices[0]).dot(triangle.front()) >= 0.0);
            }
            // They begin so far above that the heads of such rays are theirs.
            let lists = stage.on_ground.build_list(&above).unwrap();
            let starts = lists.polygon_starts(&part.rays, numbers);
            let none = starts.iter().filter(|&&row| row == Starts::FROM_THE_FIRST).count();
            assert!(100 * none <= starts.len(), "{none} of {}", starts.len());
        }
        let frame = frame(&orbit, 10, &truth).unwrap().unwrap();
        assert_eq!((frame.parts[0].rays.len(), frame.class.name()), (100, "frame"));
        assert_eq!(frame.parts[1].query, Query::Any);
    }
}
