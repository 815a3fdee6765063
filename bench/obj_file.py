"""Reads the vertices and faces of OBJ files, for comparisons with other programs."""

import numpy as np


def read_obj(path):
    """Positions (float32) and triangles (int64) of a file; faces of more corners are cut into fans."""
    vertices, faces = [], []
    for line in open(path):
        if line.startswith("v "):
            vertices.append([float(word) for word in line.split()[1:4]])
        elif line.startswith("f "):
            corners = [int(word.split("/")[0]) for word in line.split()[1:]]
            corners = [c - 1 if c > 0 else len(vertices) + c for c in corners]
            faces += [[corners[0], corners[k], corners[k + 1]] for k in range(1, len(corners) - 1)]
    return np.array(vertices, np.float32), np.array(faces, np.int64)
