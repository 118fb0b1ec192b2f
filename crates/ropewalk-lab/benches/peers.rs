//! Side by side with another crate: obvhs 0.4, its binary BVH and its walk, on the same triangles and the same rays.
//!
//!     cargo bench -p ropewalk-lab --bench peers -- SCENE...
//!
//! Both run in one process on one thread, turn by turn in every round; what counts is the median of the rounds'
//! ratios. The hits are compared before anything is timed: obvhs renounces watertightness and ids at ties, so what
//! must agree is whether a ray hits and where, within 1e-4; how many rays do not is printed. Each class has a second
//! row in which our walk goes over a copy of the peer's tree: what is left of the ratio is the walks' own.

use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::ray::RayHit;
use obvhs::rt_triangle::RtTriangle;
use obvhs::{BvhBuildParams, triangle};
use ropewalk::bvh::Node;
use ropewalk::glam::Vec3;
use ropewalk::{Aabb, BuildOptions, Bvh, FlatScene, FlatTriangle, Hit, Query, Ray, TraceOptions, Walk};
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
    let transplanted = transplant(&peer, &flat)?;
    for class in RayClass::MEASURED {
        let rays = rays(&flat, &bvh, class);
        for (label, tree) in [(class.name(), &bvh), ("  over its tree", &transplanted)] {
            match class.query() {
                Query::Any => {
                    let ours = |ray: &Ray| tree.any(ray);
                    let theirs = |ray: &Ray| {
                        !peer.ray_traverse_miss(peer_ray(ray), |ray, at| ordered[at].intersect(ray))
                    };
                    let differ = rays.iter().filter(|ray| ours(ray) != theirs(ray)).count();
                    row(label, &rays, differ, &|ray| u32::from(ours(ray)), &|ray| u32::from(theirs(ray)));
                }
                _ => {
                    let theirs = |ray: &Ray| {
                        let mut hit = RayHit::none();
                        peer.ray_traverse(peer_ray(ray), &mut hit, |ray, at| ordered[at].intersect(ray));
                        hit
                    };
                    let differ = rays.iter().filter(|ray| differs(&tree.closest(ray), &theirs(ray))).count();
                    row(label, &rays, differ, &|ray| tree.closest(ray).primitive_index, &|ray| {
                        theirs(ray).primitive_id
                    });
                }
            }
            let options = TraceOptions { counters: true };
            let totals =
                tree.trace(Walk::default(), class.query(), &rays, options)?.totals().unwrap_or_default();
            println!("    {:.1} inner visits a ray", totals.inner_visits as f64 / rays.len() as f64);
        }
    }
    Ok(())
}

/// The peer's tree in our nodes, so that the walks can be compared without the trees. The boxes are made anew from
/// the triangles: the peer's own do not always lie in their parents'.
fn transplant(peer: &Bvh2, flat: &FlatScene) -> Result<Bvh, Box<dyn Error + Send + Sync>> {
    fn copy(peer: &Bvh2, from: usize, flat: &FlatScene, to: &mut (Vec<Node>, Vec<FlatTriangle>)) -> Aabb {
        let node = &peer.nodes[from];
        let (first, count) = (node.first_index as usize, node.prim_count as usize);
        let place = to.0.len();
        let nothing = Aabb::new(Vec3::ZERO, Vec3::ZERO);
        to.0.push(Node::inner(&nothing, 0));
        if node.is_leaf() {
            let triangles = peer.primitive_indices[first..first + count]
                .iter()
                .map(|&index| flat.triangles[index as usize]);
            let start = to.1.len();
            to.1.extend(triangles);
            let bounds = to.1[start..]
                .iter()
                .map(|triangle| triangle.triangle().bounds())
                .fold(Aabb::EMPTY, Aabb::union);
            to.0[place] = Node::leaf(&bounds, start as u32, count as u32);
            return bounds;
        }
        let near = copy(peer, first, flat, to);
        let second = to.0.len() as u32;
        let bounds = near.union(copy(peer, first + 1, flat, to));
        to.0[place] = Node::inner(&bounds, second);
        bounds
    }
    let mut parts = (Vec::new(), Vec::new());
    copy(peer, 0, flat, &mut parts);
    Ok(Bvh::from_parts(parts.0, parts.1)?)
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

fn row(label: &str, rays: &[Ray], differ: usize, ours: &dyn Fn(&Ray) -> u32, theirs: &dyn Fn(&Ray) -> u32) {
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
        "  {label:18} {ours:8.2} Mrays/s    obvhs {theirs:8.2} Mrays/s    time ratio {ratio:.2}    {differ} of {} differ",
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

fn peer_triangle(flat: &FlatTriangle) -> triangle::Triangle {
    triangle::Triangle { v0: flat.v0.into(), v1: flat.v1.into(), v2: flat.v2.into() }
}

fn peer_ray(ray: &Ray) -> obvhs::ray::Ray {
    obvhs::ray::Ray::new(ray.origin.into(), ray.dir.into(), ray.t_min, ray.t_max)
}
