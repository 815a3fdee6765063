#!/usr/bin/python3
"""Compares oktett.open3d with Open3D: answers and times.

    PYTHONPATH=build/release/python bench/open3d_peer.py [--rays N] [--repeat N] MESH.obj ...

Needs python3-open3d (scripts/setup --bench). For each mesh it casts random rays and rays of a camera, explains every
ray for which the two name different triangles, and prints the medians of interleaved runs as ratios: 2.0 means that
Open3D takes twice as long. For closed meshes it counts wrong signs of distances on a grid of 64 x 64 x 64 points.

Debian's Embree tests the mask of rays, and Open3D 0.16.1 leaves it 0, so there all rays miss. A small library then
sets the mask; it is compiled in a temporary folder and preloaded.
"""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
import open3d

from obj_file import read_obj
from oktett.open3d import RaycastingScene

Theirs = open3d.t.geometry.RaycastingScene
Tensor = open3d.core.Tensor

SHIM = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <embree3/rtcore.h>
static void* find(const char* name) { return dlsym(dlopen("libembree3.so.3", RTLD_LAZY), name); }
void rtcIntersect1M(RTCScene scene, struct RTCIntersectContext* context, struct RTCRayHit* rays, unsigned int count,
                    size_t stride) {
  static void (*next)(RTCScene, struct RTCIntersectContext*, struct RTCRayHit*, unsigned int, size_t);
  if (!next) next = find("rtcIntersect1M");
  for (unsigned int i = 0; i < count; ++i) ((struct RTCRayHit*)((char*)rays + i * stride))->ray.mask = ~0u;
  next(scene, context, rays, count, stride);
}
void rtcOccluded1M(RTCScene scene, struct RTCIntersectContext* context, struct RTCRay* rays, unsigned int count,
                   size_t stride) {
  static void (*next)(RTCScene, struct RTCIntersectContext*, struct RTCRay*, unsigned int, size_t);
  if (!next) next = find("rtcOccluded1M");
  for (unsigned int i = 0; i < count; ++i) ((struct RTCRay*)((char*)rays + i * stride))->mask = ~0u;
  next(scene, context, rays, count, stride);
}
"""


def make_open3d_hit():
    """Starts this program again with rays that have a mask, if Open3D's have none."""
    scene = Theirs()
    corners = np.eye(3, dtype=np.float32)
    scene.add_triangles(Tensor(corners), Tensor(np.array([[0, 1, 2]], np.uint32)))
    ray = np.array([[1, 1, 1, -1, -1, -1]], np.float32)
    if np.isfinite(scene.cast_rays(Tensor(ray))["t_hit"].numpy()[0]):
        return
    if "OKTETT_PEER_SHIM" in os.environ:
        sys.exit("open3d_peer: all rays of Open3D miss, with a mask, too")
    print("Open3D's rays have no mask and all miss; a preloaded library sets it", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        source, library = os.path.join(folder, "mask.c"), os.path.join(folder, "mask.so")
        with open(source, "w") as file:
            file.write(SHIM)
        subprocess.run(["cc", "-O2", "-shared", "-fPIC", source, "-o", library, "-ldl"], check=True)
        environment = {**os.environ, "LD_PRELOAD": library, "OKTETT_PEER_SHIM": "1"}
        sys.exit(subprocess.run([sys.executable, *sys.argv], env=environment).returncode)


class Mesh:
    def __init__(self, path):
        self.name = os.path.basename(path)
        self.vertices, faces = read_obj(path)
        self.faces = faces.astype(np.uint32)
        used = self.vertices[self.faces.ravel()]
        self.low, self.high = used.min(axis=0).astype(float), used.max(axis=0).astype(float)
        self.center = (self.low + self.high) / 2
        self.radius = np.linalg.norm(self.high - self.low) / 2
        # Vertices at the same place are one, for the question of what shares an edge.
        _, self.welded = np.unique(self.vertices, axis=0, return_inverse=True)
        self.theirs, self.ours = Theirs(), RaycastingScene()
        self.theirs.add_triangles(Tensor(self.vertices), Tensor(self.faces))
        self.ours.add_triangles(self.vertices, self.faces)

    def is_closed(self):
        """Whether each edge has as many triangles on its one side as on its other."""
        corners = self.welded[self.faces.astype(np.int64)].astype(np.int64)
        begin, end = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
        size = len(self.welded)
        forward, forward_count = np.unique(begin * size + end, return_counts=True)
        backward, backward_count = np.unique(end * size + begin, return_counts=True)
        return np.array_equal(forward, backward) and np.array_equal(forward_count, backward_count)

    def random_rays(self, count, random):
        """From a sphere around the mesh into the ball in it."""
        outer, inner = random.normal(size=(2, count, 3))
        outer *= 1.5 * self.radius / np.linalg.norm(outer, axis=1)[:, None]
        inner *= 0.7 * self.radius * random.random((count, 1)) ** (1 / 3) / np.linalg.norm(inner, axis=1)[:, None]
        return np.concatenate([self.center + outer, inner - outer], axis=1).astype(np.float32)

    def camera_rays(self, count):
        side = int(np.sqrt(count))
        eye = self.center + self.radius * np.array([0.6, 0.5, 2.0])
        return RaycastingScene.create_rays_pinhole(50, self.center, eye, [0, 1, 0], side, side).reshape(-1, 6)

    def distances(self, rays, triangles):
        """Where rays meet the planes of triangles, in float64, and the weights of their corners there."""
        a, b, c = (self.vertices[self.faces[triangles][:, k]].astype(float) for k in range(3))
        origins, directions = rays[:, :3].astype(float), rays[:, 3:].astype(float)
        with np.errstate(all="ignore"):
            part = np.cross(directions, c - a)
            determinant = ((b - a) * part).sum(axis=1)
            u = ((origins - a) * part).sum(axis=1) / determinant
            q = np.cross(origins - a, b - a)
            v = (q * directions).sum(axis=1) / determinant
            t = ((c - a) * q).sum(axis=1) / determinant
        return t, np.minimum(np.minimum(u, v), 1 - u - v)


def compare_hits(mesh, rays, kind):
    theirs = {name: tensor.numpy() for name, tensor in mesh.theirs.cast_rays(Tensor(rays)).items()}
    ours = mesh.ours.cast_rays(rays)
    struck = np.isfinite(ours["t_hit"])
    both = struck & np.isfinite(theirs["t_hit"])
    same = both & (ours["primitive_ids"] == theirs["primitive_ids"])
    true_t, _ = mesh.distances(rays[same], ours["primitive_ids"][same])
    error = {}
    for name, answers in (("ours", ours), ("theirs", theirs)):
        error[name] = np.abs(answers["t_hit"][same].astype(float) / true_t - 1)
    difference = np.abs(ours["t_hit"][same].astype(float) / theirs["t_hit"][same] - 1)
    print(
        f"  {kind}: {len(rays)} rays, {struck.sum()} hits, {same.sum()} with the same triangle; their t differ by at most"
        f" {difference.max():.1e}, from float64 by at most {error['ours'].max():.1e} (oktett) and"
        f" {error['theirs'].max():.1e} (Open3D)"
    )
    assert difference.max() < 1e-4
    explain(mesh, rays, ours, theirs, both & ~same, kind)
    for name, found, lost in (("Open3D", theirs, ours), ("oktett", ours, theirs)):
        alone = np.nonzero(np.isfinite(found["t_hit"]) & ~np.isfinite(lost["t_hit"]))[0]
        for ray, t, least in zip(alone, *mesh.distances(rays[alone], found["primitive_ids"][alone])):
            print(f"    only {name} hits with ray {ray}: triangle {found['primitive_ids'][ray]}, t {t:.7g}, {least:.1e} inside")
    occluded = mesh.theirs.test_occlusions(Tensor(rays)).numpy() != mesh.ours.test_occlusions(rays)
    print(f"    occlusion differs for {occluded.sum()} rays")
    return mesh.theirs.count_intersections(Tensor(rays)).numpy(), mesh.ours.count_intersections(rays)


def explain(mesh, rays, ours, theirs, differing, kind):
    """Every ray for which the two name different triangles: what these share, and how far their t are apart."""
    which = np.nonzero(differing)[0]
    shared = {3: 0, 2: 0, 1: 0, 0: 0}
    my_t, my_least = mesh.distances(rays[which], ours["primitive_ids"][which])
    their_t, their_least = mesh.distances(rays[which], theirs["primitive_ids"][which])
    unexplained = 0
    for k, ray in enumerate(which):
        mine, other = ours["primitive_ids"][ray], theirs["primitive_ids"][ray]
        common = len(set(mesh.welded[mesh.faces[mine]]) & set(mesh.welded[mesh.faces[other]]))
        shared[common] += 1
        # Numbers of the size of the coordinates carry 24 bits.
        scale = np.abs(rays[ray, :3]).max() / np.linalg.norm(rays[ray, 3:]) + abs(my_t[k])
        apart = abs(my_t[k] - their_t[k]) / scale
        if apart > 1e-5 or min(my_least[k], their_least[k]) > 1e-3:
            unexplained += 1
        if k < 5 or apart > 1e-5:
            print(
                f"    ray {ray}: triangle {mine} at {my_t[k]:.9g}, Open3D {other} at {their_t[k]:.9g}, {apart:.0e} apart;"
                f" {common} common vertices; {my_least[k]:.0e} and {their_least[k]:.0e} inside"
            )
    print(
        f"    {len(which)} ties of {kind}: {shared[2]} at a common edge, {shared[1]} at a common vertex,"
        f" {shared[3]} of equal triangles, {shared[0]} without common vertices; {unexplained} unexplained"
    )


def explain_counts(mesh, rays, theirs, ours):
    """Compares counts that differ with one in float64, triangle by triangle."""
    which = np.nonzero(theirs != ours)[0]
    right = {"Open3D": 0, "oktett": 0}
    uncertain = 0
    triangles = np.arange(len(mesh.faces))
    for ray in which:
        t, least = mesh.distances(np.broadcast_to(rays[ray], (len(triangles), 6)), triangles)
        ahead = t > 0
        uncertain += bool(np.any(ahead & (np.abs(least) < 1e-12)))
        count = np.sum(ahead & (least >= 0))
        right["Open3D"] += theirs[ray] == count
        right["oktett"] += ours[ray] == count
    odd = f"; odd: {(theirs % 2).sum()} of Open3D, {(ours % 2).sum()} of oktett" if mesh.is_closed() else ""
    print(
        f"    counts of hits differ for {len(which)} rays: as in float64 are {right['Open3D']} of Open3D and"
        f" {right['oktett']} of oktett, {uncertain} uncertain{odd}"
    )


def race(what, theirs, ours, repeat):
    """Runs both in turns and prints the ratio of the medians."""
    times = {theirs: [], ours: []}
    for _ in range(repeat):
        for run in (theirs, ours):
            start = time.perf_counter()
            run()
            times[run].append(time.perf_counter() - start)
    a, b = (statistics.median(times[run]) for run in (theirs, ours))
    print(f"  {what:32s} Open3D {1e3 * a:8.1f} ms, oktett {1e3 * b:8.1f} ms, ratio {a / b:.2f}", flush=True)


def true_signs(mesh, axes):
    """Whether each point of a grid is inside a closed mesh, and whether that is certain: crossings of upright lines with
    the triangles, computed triangle by triangle in float64 and sorted."""
    x, y, z = axes
    columns = [[[] for _ in y] for _ in x]
    corners = mesh.vertices[mesh.faces].astype(float)
    low, high = corners.min(axis=1), corners.max(axis=1)
    certain = np.ones((len(x), len(y)), bool)
    ranges = [np.searchsorted(axis, side) for axis, k in ((x, 0), (y, 1)) for side in (low[:, k], high[:, k])]
    for triangle in np.nonzero((ranges[0] < ranges[1]) & (ranges[2] < ranges[3]))[0]:
        a, b, c = corners[triangle]
        u, v = b - a, c - a
        area = u[0] * v[1] - u[1] * v[0]
        px, py = np.meshgrid(
            x[ranges[0][triangle] : ranges[1][triangle]], y[ranges[2][triangle] : ranges[3][triangle]], indexing="ij"
        )
        if area == 0:
            continue
        second = ((px - a[0]) * v[1] - (py - a[1]) * v[0]) / area
        third = (u[0] * (py - a[1]) - u[1] * (px - a[0])) / area
        least = np.minimum(np.minimum(second, third), 1 - second - third)
        for i, j in zip(*np.nonzero(least >= 0)):
            height = a[2] + second[i, j] * u[2] + third[i, j] * v[2]
            columns[ranges[0][triangle] + i][ranges[2][triangle] + j].append(height)
        for i, j in zip(*np.nonzero(np.abs(least) < 1e-9)):
            certain[ranges[0][triangle] + i, ranges[2][triangle] + j] = False
    inside = np.zeros((len(x), len(y), len(z)), bool)
    sure = np.repeat(certain[:, :, None], len(z), axis=2)
    slack = 1e-6 * mesh.radius
    for i in range(len(x)):
        for j in range(len(y)):
            heights = np.sort(columns[i][j])
            inside[i, j] = (len(heights) - np.searchsorted(heights, z)) % 2 == 1
            for height in heights:
                sure[i, j] &= np.abs(z - height) > slack
            if len(heights) % 2:
                sure[i, j] = False
    return inside, sure


def compare_signs(mesh):
    side = 64
    pad = 0.1 * (mesh.high - mesh.low)
    # Lines of the grid do not pass through vertices, which often lie at round numbers.
    axes = [
        np.linspace(mesh.low[k] - pad[k], mesh.high[k] + 1.037 * pad[k], side).astype(np.float32).astype(float)
        for k in range(3)
    ]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).astype(np.float32)
    inside, sure = true_signs(mesh, axes)
    for name, run in (
        ("oktett", lambda: mesh.ours.compute_signed_distance(grid)),
        ("Open3D", lambda: mesh.theirs.compute_signed_distance(Tensor(grid)).numpy()),
    ):
        wrong = ((run() < 0) != inside) & sure
        print(f"  signs of {side}^3 points, {inside.sum()} inside, {(~sure).sum()} uncertain: {name} has {wrong.sum()} wrong")
    return grid


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", nargs="+", metavar="MESH.obj")
    parser.add_argument("--rays", type=int, default=1000000)
    parser.add_argument("--repeat", type=int, default=7)
    arguments = parser.parse_args()
    make_open3d_hit()
    for path in arguments.meshes:
        mesh = Mesh(path)
        closed = mesh.is_closed()
        print(f"{mesh.name}: {len(mesh.faces)} triangles, {'closed' if closed else 'not closed'}", flush=True)
        random = np.random.default_rng(1)
        batches = {
            "random rays": mesh.random_rays(arguments.rays, random),
            "camera rays": mesh.camera_rays(arguments.rays),
        }
        for kind, rays in batches.items():
            explain_counts(mesh, rays, *compare_hits(mesh, rays, kind))
        points = random.uniform(mesh.low, mesh.high, (arguments.rays // 4, 3)).astype(np.float32)
        grid = compare_signs(mesh) if closed else None
        for kind, rays in batches.items():
            tensor = Tensor(rays)
            race(f"cast_rays, {kind}", lambda: mesh.theirs.cast_rays(tensor), lambda: mesh.ours.cast_rays(rays), arguments.repeat)
            race(
                f"test_occlusions, {kind}",
                lambda: mesh.theirs.test_occlusions(tensor),
                lambda: mesh.ours.test_occlusions(rays),
                arguments.repeat,
            )
            race(
                f"count_intersections, {kind}",
                lambda: mesh.theirs.count_intersections(tensor),
                lambda: mesh.ours.count_intersections(rays),
                arguments.repeat,
            )
        tensor = Tensor(points)
        race(
            "compute_closest_points",
            lambda: mesh.theirs.compute_closest_points(tensor),
            lambda: mesh.ours.compute_closest_points(points),
            arguments.repeat,
        )
        if closed:
            tensor = Tensor(grid)
            race(
                "compute_signed_distance",
                lambda: mesh.theirs.compute_signed_distance(tensor),
                lambda: mesh.ours.compute_signed_distance(grid),
                arguments.repeat,
            )


if __name__ == "__main__":
    main()
