#!/usr/bin/python3
"""Compares points inside by winding numbers with VTK's vtkSelectEnclosedPoints: answers and times.

    PYTHONPATH=build/release/python bench/vtk_peer.py [--points N] [--repeat N] [--threads 1,2] [MESH.obj ...]

Needs python3-vtk9. Without meshes it takes balls with waves of 8 192, 131 072 and 2 097 152 triangles, whole and with
eight holes. Points are random in the bounds. Programs take turns; medians and quartiles of their
ratios are printed: 5.0 means that VTK takes five times as long. `whole` is from arrays to answers, `query` without what
is made of the mesh before, for VTK measured with a single point. `wrong`: answers on the other side than the winding number, where that tells.
"""

import argparse
import os
import statistics
import time

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

import oktett
from obj_file import read_obj


def ball(levels):
    """A subdivided octahedron with waves, wound outwards."""
    vertices = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
    faces = np.array(
        [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]], np.int64
    )
    for _ in range(levels):
        edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unique, which = np.unique(edges, axis=0, return_inverse=True)
        middle = len(vertices) + which.reshape(-1, 3)
        vertices = np.concatenate([vertices, vertices[unique].sum(axis=1) / 2])
        vertices /= np.linalg.norm(vertices, axis=1)[:, None]
        a, b, c = faces.T
        ab, bc, ca = middle.T
        faces = np.concatenate([np.stack(t, 1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    x, y, z = vertices.T
    return (vertices * (1 + 0.2 * np.sin(5 * x) * np.cos(7 * y + z))[:, None]).astype(np.float32), faces


class Theirs:
    def __init__(self, vertices, faces):
        self.surface = vtk.vtkPolyData()
        points = vtk.vtkPoints()
        points.SetData(numpy_to_vtk(vertices, deep=True))
        self.surface.SetPoints(points)
        cells = vtk.vtkCellArray()
        cells.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(faces).ravel(), deep=True))
        self.surface.SetPolys(cells)

    def time(self, points):
        asked = vtk.vtkPolyData()
        rows = vtk.vtkPoints()
        rows.SetData(numpy_to_vtk(points, deep=True))
        asked.SetPoints(rows)
        test = vtk.vtkSelectEnclosedPoints()
        test.SetInputData(asked)
        test.SetSurfaceData(self.surface)
        begin = time.perf_counter()
        test.Update()
        spent = time.perf_counter() - begin
        if len(points) == 1:
            return spent
        whole, query = spent, spent - self.time(points[:1])
        return whole, query, vtk_to_numpy(test.GetOutput().GetPointData().GetArray("SelectedPoints")) != 0


class Ours:
    def __init__(self, vertices, faces):
        self.given = vertices, faces.astype(np.uint32)

    def time(self, points):
        begin = time.perf_counter()
        scene = oktett.Scene(*self.given)
        answers = scene.inside(points, rule="winding")
        whole = time.perf_counter() - begin
        begin = time.perf_counter()
        scene.inside(points, rule="winding")
        return whole, time.perf_counter() - begin, answers


def compare(name, vertices, faces, options):
    random = np.random.default_rng(1)
    used = vertices[faces.ravel()]
    points = random.uniform(used.min(axis=0), used.max(axis=0), (options.points, 3)).astype(np.float32)
    programs = Ours(vertices, faces), Theirs(vertices, faces)
    number = np.abs(oktett.Scene(vertices, faces.astype(np.uint32)).winding_number(points).astype(float))
    sure = np.abs(number - 0.5) > 2e-4
    wrong = [0, 0]
    for threads in options.threads:
        oktett.set_threads(threads)
        vtk.vtkSMPTools.Initialize(threads)
        whole, query, spent = [], [], []
        for _ in range(options.repeat):
            times = []
            for k, program in enumerate(programs):
                *spans, answers = program.time(points)
                wrong[k] = int(((number > 0.5) != answers)[sure].sum())
                times.append(spans)
            whole.append(times[1][0] / times[0][0])
            query.append(times[1][1] / times[0][1])
            spent.append(times[0][1] / len(points))
        print(
            f"{name}: {len(faces)} triangles, {threads} threads: whole {ratio(whole)}, query {ratio(query)};"
            f" {statistics.median(spent) * 1e9:.0f} ns a point; wrong: oktett {wrong[0]}, VTK {wrong[1]}",
            flush=True,
        )


def ratio(values):
    low, middle, high = np.quantile(values, [0.25, 0.5, 0.75])
    return f"{middle:.1f} ({low:.1f} to {high:.1f})"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=100000)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--threads", type=lambda text: [int(word) for word in text.split(",")], default=[1, 2])
    parser.add_argument("mesh", nargs="*")
    options = parser.parse_args()
    print(f"VTK {vtk.vtkVersion().GetVTKVersion()}, {vtk.vtkSMPTools.GetBackend()}; oktett {oktett.isa()}")
    if options.mesh:
        for path in options.mesh:
            compare(os.path.basename(path), *read_obj(path), options)
        return
    for levels in (5, 7, 9):
        vertices, faces = ball(levels)
        compare("ball", vertices, faces, options)
        centers = np.random.default_rng(2).choice(vertices, 8)
        away = np.linalg.norm(vertices[faces].mean(axis=1)[:, None] - centers, axis=2).min(axis=1) > 0.2
        compare("ball with holes", vertices, faces[away], options)


main()
