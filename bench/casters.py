#!/usr/bin/python3
"""Counts the rays that slip through closed meshes at edges and corners, of Oktett and of other ray casters.

    PYTHONPATH=build/release/python bench/casters.py [--rays N] [MESH.obj ...]

Rays come from outside through random places of random edges, or through corners, where all triangles around face the
ray, and go on past the middle. Places are computed in double and rounded to float. Without meshes it takes an icosphere
of 20 480 triangles. Asked are Oktett and those that are installed (scripts/setup --bench): Embree by Open3D
(python3-open3d), VTK (python3-vtk9; it counts nothing), and CGAL's exact predicates (libcgal-dev, g++).

`past`: the first hit lies behind the place by more than a thousandth of the way. `none`: there is no hit. `odd`: the
number of triangles that a ray meets is odd, though it begins and ends outside. CGAL counts each triangle around an edge
or a corner that a ray meets exactly, so its counts need not be even there.
"""

import argparse
import os
import subprocess
import tempfile

import numpy as np

import oktett
from obj_file import read_obj


def icosphere(levels):
    """A ball of 20 * 4**levels triangles, wound outwards."""
    g = (1 + 5**0.5) / 2
    vertices = np.array([[0, s, t * g] for s in (-1, 1) for t in (-1, 1)], float)
    vertices = np.concatenate([vertices, vertices[:, [1, 2, 0]], vertices[:, [2, 0, 1]]])
    vertices /= np.linalg.norm(vertices[0])
    near = np.linalg.norm(vertices[:, None] - vertices, axis=2) < 1.06
    faces = [
        (a, b, c) if np.dot(np.cross(vertices[a], vertices[b]), vertices[c]) > 0 else (a, c, b)
        for a in range(12) for b in range(a + 1, 12) for c in range(b + 1, 12) if near[a, b] and near[a, c] and near[b, c]
    ]
    faces = np.array(faces, np.int64)
    for _ in range(levels):
        ends = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        edges, number = np.unique(ends, axis=0, return_inverse=True)
        middle = vertices[edges].sum(axis=1)
        middle /= np.linalg.norm(middle, axis=1, keepdims=True)
        ab, bc, ca = (len(vertices) + number.reshape(-1, 3)).T
        a, b, c = faces.T
        vertices = np.concatenate([vertices, middle])
        faces = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return vertices.astype(np.float32), faces


def around_vertices(faces, count):
    """The triangles around vertex v are around[begin[v]:begin[v + 1]]."""
    order = np.argsort(faces.ravel(), kind="stable")
    return order // 3, np.concatenate([[0], np.cumsum(np.bincount(faces.ravel(), minlength=count))])


def faces_ray(vertex, direction, normals, around, begin):
    """Whether all triangles around vertices face rays, a bool for each."""
    good = np.ones(len(vertex), bool)
    size = begin[vertex + 1] - begin[vertex]
    for k in range(size.max()):
        has = k < size
        n = normals[around[begin[vertex[has]] + k]]
        good[has] &= np.einsum("ij,ij->i", n, direction[has]) < -0.05
    return good


def rays_at(vertices, faces, corners, count, seed):
    """`count` rays (count, 6) in float32, and how far the places are that they are aimed at."""
    random = np.random.default_rng(seed)
    p = vertices.astype(float)
    normals = np.cross(p[faces[:, 1]] - p[faces[:, 0]], p[faces[:, 2]] - p[faces[:, 0]])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    around, begin = around_vertices(faces, len(vertices))
    low, high = p[faces.ravel()].min(axis=0), p[faces.ravel()].max(axis=0)
    radius = np.linalg.norm(high - low) / 2
    found, total = [], 0
    for _ in range(400):
        n = count
        triangle, k = random.integers(len(faces), size=n), random.integers(3, size=n)
        a, b = faces[triangle, k], faces[triangle, (k + 1) % 3]
        part = np.zeros((n, 1)) if corners else random.random((n, 1))
        target = p[a] * (1 - part) + p[b] * part
        to = (low + high) / 2 + (random.random((n, 3)) * 2 - 1) * 0.35 * radius
        d = to - target
        d /= np.linalg.norm(d, axis=1, keepdims=True)
        good = faces_ray(a, d, normals, around, begin)
        if not corners:
            good &= faces_ray(b, d, normals, around, begin)
        found.append(np.concatenate([target - d * 2.5 * radius, d], axis=1)[good].astype(np.float32))
        total += good.sum()
        if total >= count:
            break
    return np.concatenate(found)[:count], 2.5 * radius


def ask_oktett(vertices, faces, rays):
    scene = oktett.Scene(vertices, faces.astype(np.uint32))
    return scene.closest_hit(rays).t, scene.count_hits(rays)


def ask_open3d(vertices, faces, rays):
    import open3d

    tensor = open3d.core.Tensor
    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(tensor(vertices), tensor(faces.astype(np.uint32)))
    return scene.cast_rays(tensor(rays))["t_hit"].numpy(), scene.count_intersections(tensor(rays)).numpy()


def ask_vtk(tolerance):
    def ask(vertices, faces, rays):
        import vtk
        from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

        points, cells, data = vtk.vtkPoints(), vtk.vtkCellArray(), vtk.vtkPolyData()
        points.SetData(numpy_to_vtk(vertices, deep=True))
        cells.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(faces.ravel(), np.int64), deep=True))
        data.SetPoints(points), data.SetPolys(cells)
        locator = vtk.vtkStaticCellLocator()
        locator.SetDataSet(data), locator.BuildLocator()
        far = 2 * np.abs(rays[:, :3]).max() + np.abs(vertices).max()
        t, x, pcoords, sub, cell = vtk.reference(0.0), [0.0] * 3, [0.0] * 3, vtk.reference(0), vtk.reference(0)
        found = np.full(len(rays), np.inf)
        for i, ray in enumerate(rays.astype(float)):
            if locator.IntersectWithLine(ray[:3], ray[:3] + far * ray[3:], tolerance, t, x, pcoords, sub, cell):
                found[i] = t.get() * far
        return found, None

    return ask


CGAL = r"""
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <cmath>
#include <cstdio>
#include <vector>
using K = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<K::Triangle_3>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<K, CGAL::AABB_triangle_primitive<K, Triangles::iterator>>>;
static std::vector<float> read(const char* path) {
  std::vector<float> all;
  std::FILE* file = std::fopen(path, "rb");
  float number;
  while (std::fread(&number, sizeof number, 1, file) == 1) all.push_back(number);
  std::fclose(file);
  return all;
}
int main(int, char** argv) {
  const std::vector<float> corners = read(argv[1]), rays = read(argv[2]);
  const auto point = [](const float* p) { return K::Point_3(p[0], p[1], p[2]); };
  Triangles triangles;
  for (std::size_t i = 0; i < corners.size(); i += 9)
    triangles.emplace_back(point(&corners[i]), point(&corners[i + 3]), point(&corners[i + 6]));
  Tree tree(triangles.begin(), triangles.end());
  for (std::size_t i = 0; i < rays.size(); i += 6) {
    const K::Ray_3 ray(point(&rays[i]), K::Vector_3(rays[i + 3], rays[i + 4], rays[i + 5]));
    const double count = static_cast<double>(tree.number_of_intersected_primitives(ray));
    double t = INFINITY;
    if (const auto hit = tree.first_intersection(ray))
      if (const K::Point_3* const p = boost::get<K::Point_3>(&hit->first))
        t = std::sqrt(CGAL::to_double((*p - ray.source()).squared_length() / ray.to_vector().squared_length()));
    std::fwrite(&t, sizeof t, 1, stdout), std::fwrite(&count, sizeof count, 1, stdout);
  }
}
"""


def ask_cgal(folder):
    program = os.path.join(folder, "cgal")

    def ask(vertices, faces, rays):
        if not os.path.exists(program):
            with open(program + ".cpp", "w") as file:
                file.write(CGAL)
            subprocess.run(["g++", "-O2", program + ".cpp", "-o", program, "-lgmp", "-lmpfr"], check=True)
        vertices[faces].astype(np.float32).tofile(program + ".mesh")
        rays.tofile(program + ".rays")
        answer = subprocess.run([program, program + ".mesh", program + ".rays"], check=True, stdout=subprocess.PIPE)
        t, count = np.frombuffer(answer.stdout, float).reshape(-1, 2).T
        return t, count.astype(np.int64)

    return ask


def installed(folder):
    """The casters that can be asked, by their names."""
    casters = {"Oktett": ask_oktett}
    try:
        import open3d

        casters[f"Open3D {open3d.__version__} (Embree robust)"] = ask_open3d
    except ImportError:
        print("Open3D is not installed")
    try:
        import vtk

        version = vtk.vtkVersion.GetVTKVersion()
        casters[f"VTK {version}, tolerance 0"] = ask_vtk(0.0)
        casters[f"VTK {version}, tolerance 1e-6"] = ask_vtk(1e-6)
    except ImportError:
        print("VTK is not installed")
    if os.path.exists("/usr/include/CGAL/AABB_tree.h"):
        casters["CGAL, exact predicates"] = ask_cgal(folder)
    else:
        print("CGAL is not installed")
    return casters


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rays", type=int, default=100000, help="rays at edges, and as many at corners (100000)")
    parser.add_argument("meshes", nargs="*", metavar="MESH.obj")
    options = parser.parse_args()
    try:
        from open3d_peer import make_open3d_hit

        make_open3d_hit()
    except ImportError:
        pass
    with tempfile.TemporaryDirectory() as folder:
        casters = installed(folder)
        print("| caster | mesh | at | rays | past | none | odd |\n|---|---|---|---|---|---|---|")
        for path in options.meshes or [None]:
            name = "icosphere" if path is None else os.path.splitext(os.path.basename(path))[0]
            vertices, faces = icosphere(5) if path is None else read_obj(path)
            for corners in (False, True):
                rays, reach = rays_at(vertices, faces, corners, options.rays, 1 + corners)
                for caster, ask in casters.items():
                    t, count = ask(vertices, faces, rays)
                    past, none = np.isfinite(t) & (t > reach * 1.001), ~np.isfinite(t)
                    odd = "-" if count is None else int((count % 2 != 0).sum())
                    print(f"| {caster} | {name} | {'corners' if corners else 'edges'} | {len(rays)} | {past.sum()} | "
                          f"{none.sum()} | {odd} |", flush=True)


if __name__ == "__main__":
    main()
