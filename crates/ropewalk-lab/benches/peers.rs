//! Side by side with another crate: obvhs 0.4, its binary BVH and its walk, on the same triangles and the same rays.
//!
//!     cargo bench -p ropewalk-lab --bench peers -- SCENE...
//!
//! Both run in one process on one thread, turn by turn in every round; what counts is the median of the rounds'
//! ratios. The hits are compared before anything is timed: obvhs renounces watertightness and ids at ties, so what
//! must agree is whether a ray hits and where, within 1e-4; how many rays do not is printed.

use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::ray::RayHit;
use obvhs::rt_triangle::RtTriangle;
use obvhs::{BvhBuildParams, triangle};
use ropewalk::{BuildOptions, Bvh, FlatScene, Hit, Query, Ray};
use ropewalk_lab::{Machine, Spread};
use ropewalk_testkit::rays::{RayClass, RayMaker};
use std::error::Error;
use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

const ROUNDS: usize = 9;
const RAYS: usize = 1 << 18;

fn main() -> Result<(), Box<dyn Error + Send + Sync>> {
    // Cargo adds `--bench`.
    let scenes: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let machine = Machine::here();
    println!(
        "{}, {}, ropewalk {} against obvhs 0.4, one thread",
        machine.cpu, machine.date, machine.ropewalk
    );
    let names = if scenes.is_empty() { vec!["builtin:assembly".to_owned()] } else { scenes };
    for name in names {
        let model = match name.strip_prefix("builtin:") {
            Some(builtin) => ropewalk_scene::builtin::builtin(builtin)?,
            None => ropewalk_scene::load::load(Path::new(&name))?,
        };
        let short =
            Path::new(&name).file_name().map_or(name.clone(), |file| file.to_string_lossy().into_owned());
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
        pool.install(|| side_by_side(&short, &model.scene))?;
    }
    Ok(())
}

fn side_by_side(name: &str, scene: &ropewalk::Scene) -> Result<(), Box<dyn Error + Send + Sync>> {
    let flat = scene.flatten()?;
    let triangles: Vec<triangle::Triangle> = flat.triangles.iter().map(peer_triangle).collect();
    println!("\n{name}: {} triangles", triangles.len());
    let (bvh, peer) = builds(scene, &triangles)?;
    let ordered: Vec<RtTriangle> =
        peer.primitive_indices.iter().map(|&index| RtTriangle::from(&triangles[index as usize])).collect();
    for class in RayClass::MEASURED {
        let rays = rays(&flat, &bvh, class);
        match class.query() {
            Query::Any => {
                let ours = |ray: &Ray| bvh.any(ray);
                let theirs =
                    |ray: &Ray| !peer.ray_traverse_miss(peer_ray(ray), |ray, at| ordered[at].intersect(ray));
                let differ = rays.iter().filter(|ray| ours(ray) != theirs(ray)).count();
                row(class, &rays, differ, &|ray| u32::from(ours(ray)), &|ray| u32::from(theirs(ray)));
            }
            _ => {
                let theirs = |ray: &Ray| {
                    let mut hit = RayHit::none();
                    peer.ray_traverse(peer_ray(ray), &mut hit, |ray, at| ordered[at].intersect(ray));
                    hit
                };
                let differ = rays.iter().filter(|ray| differs(&bvh.closest(ray), &theirs(ray))).count();
                row(class, &rays, differ, &|ray| bvh.closest(ray).primitive_index, &|ray| {
                    theirs(ray).primitive_id
                });
            }
        }
    }
    Ok(())
}

/// Builds both, turn by turn, and prints the times of the builders alone.
fn builds(
    scene: &ropewalk::Scene,
    triangles: &[triangle::Triangle],
) -> Result<(Bvh, Bvh2), Box<dyn Error + Send + Sync>> {
    let options = BuildOptions::default();
    let (mut ours, mut theirs, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    let mut built = None;
    for _ in 0..ROUNDS {
        let bvh = scene.build(&options)?;
        let mut time = Duration::ZERO;
        let peer = build_bvh2_from_tris(triangles, BvhBuildParams::fast_build(), &mut time);
        ours.push(bvh.report().build_time.as_secs_f64() * 1e3);
        theirs.push(time.as_secs_f64() * 1e3);
        ratios.push(bvh.report().build_time.as_secs_f64() / time.as_secs_f64());
        built = Some((bvh, peer));
    }
    let [ours, theirs, ratio] = [ours, theirs, ratios].map(|numbers| median(&numbers));
    println!(
        "  build              {ours:8.1} ms    obvhs fast_build {theirs:8.1} ms    time ratio {ratio:.2}"
    );
    built.ok_or_else(|| "no round".into())
}

fn rays(flat: &FlatScene, bvh: &Bvh, class: RayClass) -> Vec<Ray> {
    let closest = |rays: &[Ray]| {
        let mut hits = vec![Hit::MISS; rays.len()];
        bvh.closest_batch(rays, &mut hits);
        hits
    };
    RayMaker::new(flat, 1).make(class, RAYS, &closest)
}

fn row(
    class: RayClass,
    rays: &[Ray],
    differ: usize,
    ours: &dyn Fn(&Ray) -> u32,
    theirs: &dyn Fn(&Ray) -> u32,
) {
    let time = |trace: &dyn Fn(&Ray) -> u32| {
        let start = Instant::now();
        black_box(rays.iter().fold(0u32, |sum, ray| sum.wrapping_add(trace(ray))));
        start.elapsed().as_secs_f64()
    };
    let rounds: Vec<(f64, f64)> = (0..ROUNDS).map(|_| (time(ours), time(theirs))).collect();
    let rate = |seconds: f64| rays.len() as f64 / seconds / 1e6;
    let ours = median(&rounds.iter().map(|round| rate(round.0)).collect::<Vec<_>>());
    let theirs = median(&rounds.iter().map(|round| rate(round.1)).collect::<Vec<_>>());
    let ratio = median(&rounds.iter().map(|round| round.0 / round.1).collect::<Vec<_>>());
    println!(
        "  {:18} {ours:8.2} Mrays/s    obvhs {theirs:8.2} Mrays/s    time ratio {ratio:.2}    {differ} of {} differ",
        class.name(),
        rays.len()
    );
}

fn median(numbers: &[f64]) -> f64 {
    Spread::of(numbers).map_or(f64::NAN, |spread| spread.median)
}

fn differs(ours: &Hit, theirs: &RayHit) -> bool {
    let they_hit = theirs.t.is_finite() && theirs.primitive_id != u32::MAX;
    ours.is_hit() != they_hit || (they_hit && (ours.t - theirs.t).abs() > 1e-4 * ours.t)
}

fn peer_triangle(flat: &ropewalk::FlatTriangle) -> triangle::Triangle {
    triangle::Triangle { v0: flat.v0.into(), v1: flat.v1.into(), v2: flat.v2.into() }
}

fn peer_ray(ray: &Ray) -> obvhs::ray::Ray {
    obvhs::ray::Ray::new(ray.origin.into(), ray.dir.into(), ray.t_min, ray.t_max)
}
