#!/usr/bin/env python3
"""Holds `ropewalk trace` against Embree, and all of its walks and devices against each other.

    pip install numpy embreex
    cargo build --release
    python3 tools/embree_agreement.py --program target/release/ropewalk --rays 1000000 SCENE...

SCENE is an OBJ or PLY file of triangles, gzipped or not. For each ray class the rays are traced by every walk on
every device named by --device; the files must agree to the bit. Then Embree (robust mode) traces the same rays. A ray
on which the two differ is looked at again in f64 by brute force over the triangles that either of them named and
is put into one of the kinds that the table names. What is left over under `unexplained` is an error of ours or of Embree.
"""

import argparse
import gzip
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

WALKS = ["stack:order=unordered", "stack:order=culled", "stack:order=sorted", "stack:order=ordered", "recursive"]
MISS = 0xFFFFFFFF


def read_scene(path):
    data = path.read_bytes()
    if data[:2] == b"\x1f\x8b":
        data = gzip.decompress(data)
    return read_ply(data) if data[:3] == b"ply" else read_obj(data)


def read_obj(data):
    """Positions, triangles object by object, and how many triangles each object has."""
    positions, objects, name = [], {}, ("", "")
    for line in data.decode("utf-8", "replace").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            positions.append(words[1:4])
        elif words[:1] == ["o"]:
            name = (line, "")
        elif words[:1] == ["g"]:
            name = (name[0], line)
        elif words[:1] == ["f"]:
            corners = [int(word.split("/")[0]) for word in words[1:]]
            corners = [c - 1 if c > 0 else len(positions) + c for c in corners]
            faces = objects.setdefault(name, [])
            faces += [(corners[0], corners[i], corners[i + 1]) for i in range(1, len(corners) - 1)]
    triangles = np.array([corner for faces in objects.values() for corner in faces], np.uint32)
    return np.array(positions, np.float64).astype(np.float32), triangles, [len(f) for f in objects.values()]


def read_ply(data):
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode().splitlines()
    count = {line.split()[1]: int(line.split()[2]) for line in header if line.startswith("element")}
    before_faces = header[: next(i for i, line in enumerate(header) if line.startswith("element face"))]
    columns = sum(line.startswith("property") for line in before_faces)
    vertices, faces = count["vertex"], count["face"]
    if any("ascii" in line for line in header):
        numbers = data[end:].split()
        table = np.array(numbers[: vertices * columns], np.float64).reshape(vertices, columns)
        indices = np.array(numbers[vertices * columns :][: faces * 4], np.int64).reshape(faces, 4)
        return table[:, :3].astype(np.float32), indices[:, 1:].astype(np.uint32), [faces]
    order = "<" if any("little" in line for line in header) else ">"
    table = np.frombuffer(data, order + "f4", vertices * columns, end).reshape(vertices, columns)
    kind = np.dtype([("corners", "u1"), ("index", order + "i4", 3)])
    indices = np.frombuffer(data, kind, faces, end + table.nbytes)
    assert (indices["corners"] == 3).all(), "only triangles"
    return table[:, :3].astype(np.float32), indices["index"].astype(np.uint32), [faces]


class Ropewalk:
    def __init__(self, program, scene, folder):
        self.program, self.scene, self.folder = program, scene, pathlib.Path(folder)

    def trace(self, rays, query, walk, device):
        np.save(self.folder / "rays.npy", rays)
        output = self.folder / "hits.npz"
        command = [self.program, "trace", self.scene, "--rays", self.folder / "rays.npy", "-o", output]
        command += ["--query", query, "--walk", walk, "--device", device]
        subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        with np.load(output) as file:
            return {name: file[name] for name in file.files}


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def make_rays(origin, direction, t_min, t_max):
    rays = np.empty((len(origin), 8), np.float32)
    rays[:, 0:3], rays[:, 3:6], rays[:, 6], rays[:, 7] = origin, direction, t_min, t_max
    return rays


def ray_classes(positions, triangles, offsets, count, closest, random):
    """Yields name, query, rays. The bounces start at the hits of the primary rays."""
    low, high = positions.min(0).astype(np.float64), positions.max(0).astype(np.float64)
    size, middle = high - low, (low + high) / 2
    side = int(np.sqrt(count))
    x, y = np.meshgrid((np.arange(side) + 0.5) / side * 2 - 1, 1 - (np.arange(side) + 0.5) / side * 2)
    # Half of the picture from outside, half from the middle.
    eye = middle + np.array([0.35, 0.4, 1.1]) * size.max()
    outside = unit(np.column_stack([x.ravel() * 0.6, y.ravel() * 0.6, -np.ones(side * side)]) - [0.32, 0.36, 0])
    inside = unit(np.column_stack([np.ones(side * side), y.ravel() * 0.8, x.ravel() * 0.8]))
    upper = np.arange(side * side) % 2 == 0
    origin = np.where(upper[:, None], eye, middle)
    primary = make_rays(origin, np.where(upper[:, None], outside, inside), 0, np.inf)
    yield "primary", "closest", primary
    hits = closest(primary)
    hit = np.isfinite(hits["t"])
    corners = positions[triangles[global_index(hits, hit, offsets)]].astype(np.float64)
    normal = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    direction = primary[hit, 3:6].astype(np.float64)
    normal *= -np.sign((normal * direction).sum(1))[:, None]
    point = primary[hit, 0:3] + direction * hits["t"][hit, None] + normal * size.max() * 1e-5
    again = random.integers(0, len(point), count)
    point, normal = point[again], normal[again]
    light = middle + np.array([0.2, 0.9, 0.3]) * size
    yield "shadow", "any", make_rays(point, light - point, 0, 1)
    bounce = unit(normal + unit(random.normal(size=(count, 3))) * 0.999)
    yield "ambient occlusion", "any", make_rays(point, bounce, 0, size.max() * 0.1)
    yield "diffuse", "closest", make_rays(point, bounce, 0, np.inf)
    start = low - size * 0.25 + random.random((count, 3)) * size * 1.5
    yield "random", "closest", make_rays(start, unit(random.normal(size=(count, 3))), 0, np.inf)


def global_index(hits, mask, offsets):
    """A triangle's place among all, from its instance (these files place each object once) and primitive."""
    return offsets[hits["instance"][mask]] + hits["primitive"][mask]


def t_in_f64(positions, triangles, rays, index):
    """t, u, v of the plane hit, and how far outside the triangle it lies (0 inside), in f64."""
    a, b, c = np.moveaxis(positions[triangles[index]].astype(np.float64), 1, 0)
    o, d = rays[:, 0:3].astype(np.float64), rays[:, 3:6].astype(np.float64)
    p = np.cross(d, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = 1 / ((b - a) * p).sum(1)
        u = ((o - a) * p).sum(1) * scale
        q = np.cross(o - a, b - a)
        v, t = (d * q).sum(1) * scale, ((c - a) * q).sum(1) * scale
    outside = np.maximum.reduce([-u, -v, u + v - 1])
    return t, outside


def compare_with_embree(positions, triangles, offsets, rays, query, answer, scene):
    origin, direction = rays[:, 0:3].copy(), rays[:, 3:6].copy()
    far = np.where(np.isinf(rays[:, 7]), np.float32(1e37), rays[:, 7]).astype(np.float32)
    found = scene.run(origin, direction, dists=far.copy(), query="INTERSECT", output=True)
    their_hit = found["primID"] >= 0
    if query == "any":
        differ = np.flatnonzero(answer["hit"] != their_hit)
        index = np.where(their_hit, found["primID"], 0)[differ]
        _, outside = t_in_f64(positions, triangles, rays[differ], index)
        return {
            "rays": len(rays),
            "hits": int(answer["hit"].sum()),
            "differ": len(differ),
            "edge (f64 within 1e-4 of an edge)": int((np.abs(outside) < 1e-4).sum()),
            "unexplained": int((np.abs(outside) >= 1e-4).sum()),
        }
    hit = np.isfinite(answer["t"])
    ours = np.zeros(len(rays), np.int64)
    ours[hit] = global_index(answer, hit, offsets)
    both = hit & their_hit
    theirs = np.where(their_hit, found["primID"], 0).astype(np.int64)
    near = np.zeros(len(rays), bool)
    near[both] = np.abs(answer["t"][both] - found["tfar"][both]) <= 1e-5 * np.abs(found["tfar"][both]) + 1e-6
    same = (both & (ours == theirs) & near) | (~hit & ~their_hit)
    # The same distance on another triangle: a shared edge, or triangles that lie on each other.
    tie = both & (ours != theirs) & near
    rest = np.flatnonzero(~same & ~tie)
    our_t, our_outside = t_in_f64(positions, triangles, rays[rest], ours[rest])
    their_t, their_outside = t_in_f64(positions, triangles, rays[rest], theirs[rest])
    grazing = np.zeros(len(rest), bool)
    for it_hit, outside in ((hit[rest], our_outside), (their_hit[rest], their_outside)):
        grazing |= it_hit & (np.abs(outside) < 1e-4)
    # Both named the same triangle: who is nearer to f64?
    same_triangle = both[rest] & (ours[rest] == theirs[rest])
    with np.errstate(invalid="ignore"):
        we_are_nearer = same_triangle & (
            np.abs(answer["t"][rest] - our_t) <= np.abs(found["tfar"][rest] - their_t)
        )
    rounding = same_triangle & ~we_are_nearer & (np.abs(answer["t"][rest] - our_t) <= 1e-4 * np.abs(our_t) + 1e-5)
    explained = grazing | we_are_nearer | rounding
    return {
        "rays": len(rays),
        "hits": int(hit.sum()),
        "same triangle and t": int((same & hit).sum()),
        "tie (same t, other triangle)": int(tie.sum()),
        "differ": len(rest),
        "edge (f64 within 1e-4 of an edge)": int(grazing.sum()),
        "same triangle, ours nearer to f64": int((we_are_nearer & ~grazing).sum()),
        "same triangle, f64 within 1e-4": int((rounding & ~grazing).sum()),
        "unexplained": int((~explained).sum()),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", type=pathlib.Path)
    parser.add_argument("--program", default="target/release/ropewalk")
    parser.add_argument("--rays", type=int, default=1_000_000)
    parser.add_argument("--device", action="append", help="default: cpu and gpu")
    parser.add_argument("--json", type=pathlib.Path)
    options = parser.parse_args()
    devices = options.device or ["cpu", "gpu"]
    rows, failed = [], False
    for path in options.scenes:
        positions, triangles, counts = read_scene(path)
        offsets = np.concatenate([[0], np.cumsum(counts)])
        embree = rtcore_scene.EmbreeScene(robust=True)
        TriangleMesh(embree, positions, triangles.astype(np.int32))
        random = np.random.default_rng(1)
        with tempfile.TemporaryDirectory() as folder:
            program = Ropewalk(options.program, path, folder)

            def closest(rays):
                return program.trace(rays, "closest", "stack", "cpu")

            for name, query, rays in ray_classes(positions, triangles, offsets, options.rays, closest, random):
                answers = {}
                for device in devices:
                    for walk in WALKS:
                        if not (walk == "recursive" and device != "cpu"):
                            answers[f"{device} {walk}"] = program.trace(rays, query, walk, device)
                first = next(iter(answers.values()))
                unequal = [
                    run
                    for run, answer in answers.items()
                    if any(answer[field].tobytes() != first[field].tobytes() for field in first)
                ]
                row = {"scene": path.name, "class": name, "query": query, "runs": len(answers), "unequal": unequal}
                row |= compare_with_embree(positions, triangles, offsets, rays, query, first, embree)
                rows.append(row)
                failed |= bool(unequal) or row["unexplained"] > 0
                print(json.dumps(row), flush=True)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
