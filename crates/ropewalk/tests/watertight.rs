//! No ray escapes from a closed mesh, wherever it is aimed, neither through the binary tree nor through the packed one: ten million rays from inside, most of them at edges and
//! vertices, on spheres, on one that is turned and moved far away, on a mesh with vertices in the middle of its
//! neighbours' edges, and, where the files are at hand, on scanned models scaled and moved 10,000 units away.

use glam::{DQuat, DVec3, Vec3};
use ropewalk::{BuildOptions, Bvh, Bvh8, Bvh8Options, Hit, Mesh, Ray, Scene, glam};
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;
use std::collections::HashMap;
use std::path::PathBuf;

/// Rays that are made and traced at a time.
const BATCH: usize = 1 << 16;

/// A mesh that is closed, and points inside of it.
struct Closed {
    name: &'static str,
    mesh: Mesh,
    bvh: Bvh,
    packed: Bvh8,
    inside: Vec<DVec3>,
}

impl Closed {
    fn new(name: &'static str, mesh: Mesh) -> Self {
        assert!(meshes::is_closed(&mesh), "{name} has a hole: the test would mean nothing");
        let scene = Scene::from_mesh(mesh.clone());
        let bvh = scene.build(&BuildOptions::default()).unwrap();
        let packed = scene.build_packed(&Bvh8Options::default()).unwrap();
        // Inside is where a ray meets an odd number of walls; three rays in no special direction must agree.
        let mut random = Random::new(3);
        let bounds = bvh.bounds();
        let points: Vec<DVec3> = (0..3000).map(|_| random.in_box(&bounds, 1.0)).collect();
        let mut is_inside = |point: &DVec3| {
            (0..3).all(|_| bvh.count(&Ray::new(point.as_vec3(), random.direction().as_vec3())) % 2 == 1)
        };
        let inside = points.into_iter().filter(|point| is_inside(point)).collect();
        Self { name, mesh, bvh, packed, inside }
    }

    /// A batch of rays from inside: one in eight anywhere, two at vertices, five at edges.
    fn rays(&self, seed: u64, rays: &mut Vec<Ray>) {
        let mut random = Random::new(seed);
        rays.clear();
        rays.extend((0..BATCH).map(|index| {
            let from = random.pick(&self.inside);
            let triangle = random.pick(&self.mesh.triangles);
            let first = random.below(3);
            let corner = |index: usize| self.mesh.positions[triangle[index % 3] as usize].as_dvec3();
            let target = match index % 8 {
                0 => from + random.direction(),
                1 | 2 => corner(first),
                _ => {
                    let along = if index % 2 == 0 { 0.5 } else { random.unit() };
                    corner(first) + (corner(first + 1) - corner(first)) * along
                }
            };
            let ray = Ray::new(from.as_vec3(), (target - from).as_vec3());
            if ray.is_valid() { ray } else { Ray { dir: Vec3::X, ..ray } }
        }));
    }

    /// How many of about `count` rays escape, and the first of them.
    fn escaping(&self, count: usize) -> (usize, Option<Ray>) {
        assert!(self.inside.len() > 100, "{}: only {} points are inside", self.name, self.inside.len());
        let (mut rays, mut hits) = (Vec::new(), vec![Hit::MISS; BATCH]);
        let mut packed = hits.clone();
        let (mut escaped, mut first) = (0, None);
        for batch in 0..count.div_ceil(BATCH) {
            self.rays(batch as u64, &mut rays);
            self.bvh.closest_batch(&rays, &mut hits);
            self.packed.closest_batch(&rays, &mut packed);
            for ((ray, hit), packed) in rays.iter().zip(&hits).zip(&packed) {
                assert_eq!(packed.to_words(), hit.to_words(), "{}: {ray:?}", self.name);
            }
            for (ray, _) in rays.iter().zip(&hits).filter(|(_, hit)| !hit.is_hit()) {
                escaped += 1;
                first.get_or_insert(*ray);
            }
        }
        (escaped, first)
    }

    fn assert_tight(&self, count: usize) {
        let (escaped, first) = self.escaping(count);
        println!(
            "{}: {} triangles, {} left out, {escaped} of {count} rays escape",
            self.name,
            self.bvh.triangles().len(),
            self.bvh.report().input.skipped()
        );
        assert_eq!((escaped, first), (0, None), "{}", self.name);
    }
}

#[test]
fn nothing_escapes_from_a_sphere() {
    Closed::new("sphere", meshes::icosphere(4)).assert_tight(3_000_000);
}

#[test]
fn nothing_escapes_from_a_sphere_far_away() {
    let turn = DQuat::from_xyzw(0.1, -0.5, 0.3, 0.8).normalize();
    let place = |point: DVec3| turn * (point * 25.0) + DVec3::new(10_000.0, -10_000.0, 5_000.0);
    Closed::new("far sphere", meshes::mapped(meshes::icosphere(4), place)).assert_tight(3_000_000);
}

#[test]
fn nothing_escapes_from_a_box_with_axis_aligned_walls() {
    // Flat boxes everywhere, and rays in their planes.
    Closed::new("box", meshes::cuboid(Vec3::new(-1.0, -2.0, 0.0), Vec3::new(1.5, 0.25, 3.0)))
        .assert_tight(500_000);
}

/// A vertex may lie in the middle of a neighbour's edge, with a triangle without area to close the gap. Its area is
/// zero; it keeps the mesh closed all the same.
#[test]
fn nothing_escapes_beside_triangles_without_area() {
    let sphere = meshes::icosphere(3);
    let mut mesh = Mesh::new(sphere.positions.clone(), Vec::new());
    for (index, &[a, b, c]) in sphere.triangles.iter().enumerate() {
        // The first edge of each triangle is cut at its middle on this side only, and the gap closed by the
        // triangle of the two ends and the middle.
        let middle = (mesh.positions[a as usize] + mesh.positions[b as usize]) * 0.5;
        if index % 2 == 0 {
            let m = mesh.positions.len() as u32;
            mesh.positions.push(middle);
            mesh.triangles.extend([[a, m, c], [m, b, c], [a, b, m]]);
        } else {
            mesh.triangles.push([a, b, c]);
        }
    }
    let closed = Closed::new("sphere with cut edges", mesh);
    closed.assert_tight(1_500_000);
}

#[test]
fn nothing_escapes_from_scanned_models_far_away() {
    let scenes = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes"));
    for (name, file, count) in [
        ("dragon", "stanford_dragon/dragon_vrip_871414_le.ply.gz", 1_500_000),
        ("armadillo", "armadillo/armadillo.obj.gz", 1_000_000),
    ] {
        let path = scenes.join(file);
        let Ok(packed) = std::fs::read(&path) else {
            println!("skipped: {} is not there", path.display());
            continue;
        };
        let mut mesh = read(&packed);
        let bounds = mesh.bounds();
        let (center, size) = (bounds.center().as_dvec3(), f64::from(bounds.size().max_element()));
        close(&mut mesh);
        let far = DVec3::new(10_000.0, 10_000.0, -10_000.0);
        let placed = meshes::mapped(mesh, |point| (point - center) * (50.0 / size) + far);
        Closed::new(name, placed).assert_tight(count);
    }
}

/// The comparator of this file: an open mesh must let rays out.
#[test]
fn a_hole_is_found() {
    let mut closed = Closed::new("sphere", meshes::icosphere(3));
    closed.mesh.triangles.remove(700);
    let scene = Scene::from_mesh(closed.mesh.clone());
    closed.bvh = scene.build(&BuildOptions::default()).unwrap();
    closed.packed = scene.build_packed(&Bvh8Options::default()).unwrap();
    assert!(closed.escaping(100_000).0 > 0);
}

/// Just enough of binary PLY and of OBJ for the two files above.
fn read(packed: &[u8]) -> Mesh {
    use std::io::Read;
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(packed).read_to_end(&mut bytes).unwrap();
    let mut mesh = Mesh::default();
    if bytes.starts_with(b"ply") {
        let end = bytes.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
        let header = std::str::from_utf8(&bytes[..end]).unwrap();
        let count = |element: &str| -> usize {
            let line = header.lines().find_map(|line| line.strip_prefix(element)).unwrap();
            line.trim().parse().unwrap()
        };
        let (vertices, faces) = (count("element vertex"), count("element face"));
        let word = |at: usize| <[u8; 4]>::try_from(&bytes[at..at + 4]).unwrap();
        mesh.positions = (0..vertices)
            .map(|i| {
                Vec3::from_array([0, 4, 8].map(|offset| f32::from_le_bytes(word(end + 12 * i + offset))))
            })
            .collect();
        let first = end + 12 * vertices + 1;
        mesh.triangles = (0..faces)
            .map(|i| [0, 4, 8].map(|offset| u32::from_le_bytes(word(first + 13 * i + offset))))
            .collect();
    } else {
        for line in std::str::from_utf8(&bytes).unwrap().lines() {
            let mut words = line.split_whitespace();
            match words.next() {
                Some("v") => {
                    let numbers: Vec<f32> = words.map(|word| word.parse().unwrap()).collect();
                    mesh.positions.push(Vec3::from_slice(&numbers));
                }
                Some("f") => {
                    let index = |word: &str| word.split('/').next().unwrap().parse::<u32>().unwrap() - 1;
                    let corners: Vec<u32> = words.map(index).collect();
                    mesh.triangles.push([corners[0], corners[1], corners[2]]);
                }
                _ => {}
            }
        }
    }
    mesh
}

/// Closes every hole with a fan about a point in its middle.
fn close(mesh: &mut Mesh) {
    // How often an edge is used from its smaller to its larger vertex, minus how often the other way.
    let mut balance: HashMap<[u32; 2], i32> = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *balance.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
    }
    let mut open: Vec<([u32; 2], i32)> = balance.into_iter().filter(|&(_, balance)| balance != 0).collect();
    open.sort_unstable();
    // The holes: vertices that open edges connect.
    let mut hole_of: HashMap<u32, u32> = HashMap::new();
    fn root(hole_of: &mut HashMap<u32, u32>, vertex: u32) -> u32 {
        let mut at = vertex;
        while let Some(&up) = hole_of.get(&at)
            && up != at
        {
            at = up;
        }
        hole_of.insert(vertex, at);
        at
    }
    for &([a, b], _) in &open {
        let (a, b) = (root(&mut hole_of, a), root(&mut hole_of, b));
        hole_of.insert(a, b);
        hole_of.entry(b).or_insert(b);
    }
    let mut holes: HashMap<u32, Vec<([u32; 2], i32)>> = HashMap::new();
    for &(edge, balance) in &open {
        holes.entry(root(&mut hole_of, edge[0])).or_default().push((edge, balance));
    }
    let mut holes: Vec<_> = holes.into_iter().collect();
    holes.sort_unstable();
    for (_, edges) in holes {
        let sum: Vec3 = edges.iter().map(|([a, _], _)| mesh.positions[*a as usize]).sum();
        let hub = mesh.positions.len() as u32;
        mesh.positions.push(sum / edges.len() as f32);
        for ([a, b], balance) in edges {
            let [from, to] = if balance > 0 { [b, a] } else { [a, b] };
            mesh.triangles.extend((0..balance.abs()).map(|_| [from, to, hub]));
        }
    }
}
