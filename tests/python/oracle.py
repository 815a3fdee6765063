"""Answers by other means, and things to ask about."""

import struct
import zlib

import numpy as np


def crossings(vertices, faces, rays):
    """All hits of each ray by the test of Möller and Trumbore in float64, each triangle on its own.

    Returns for each ray a list of (t, triangle, u, v), nearest first, and whether the ray passes so close to
    an edge, or so flat along a triangle, that its hits are a matter of rounding.
    """
    a, b, c = (np.asarray(vertices, np.float64)[np.asarray(faces)[:, k]] for k in range(3))
    lists, uncertain = [], []
    for ray in np.asarray(rays, np.float64):
        origin, direction = ray[:3], ray[3:]
        normal_part = np.cross(direction, c - a)
        determinant = ((b - a) * normal_part).sum(axis=1)
        with np.errstate(all="ignore"):
            s = origin - a
            u = (s * normal_part).sum(axis=1) / determinant
            q = np.cross(s, b - a)
            v = (q * direction).sum(axis=1) / determinant
            t = ((c - a) * q).sum(axis=1) / determinant
        inside = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0) & (determinant != 0)
        order = np.nonzero(inside)[0][np.argsort(t[inside], kind="stable")]
        lists.append([(t[k], k, u[k], v[k]) for k in order])
        least = np.minimum(np.minimum(u, v), 1 - u - v)
        uncertain.append(bool(np.any((np.abs(least) < 1e-5) & (t > -1e-5))))
    return lists, np.array(uncertain)


def nearest_on_triangles(vertices, faces, points):
    """Distance and nearest point of each point to all triangles, in float64: the best of the plane's foot where it is
    inside, of the three edges and of the corners."""
    corners = np.asarray(vertices, float)[faces]
    best, place = np.full(len(points), np.inf), np.zeros((len(points), 3))

    def consider(candidates, valid):
        distances = np.where(valid, np.linalg.norm(candidates - points[:, None], axis=2), np.inf)
        k = distances.argmin(axis=1)
        nearer = distances[np.arange(len(points)), k] < best
        best[nearer] = distances[nearer, k[nearer]]
        place[nearer] = candidates[nearer, k[nearer]]

    for k in range(3):
        a, b = corners[:, k], corners[:, (k + 1) % 3]
        along = ((points[:, None] - a) * (b - a)).sum(-1) / ((b - a) ** 2).sum(-1)
        consider(a + np.clip(along, 0, 1)[..., None] * (b - a), np.full(along.shape, True))
    a, u, v = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(u, v)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    foot = points[:, None] - ((points[:, None] - a) * normal).sum(-1)[..., None] * normal
    inside = np.full(foot.shape[:2], True)
    for k in range(3):
        p, q = corners[:, k], corners[:, (k + 1) % 3]
        inside &= (np.cross(q - p, foot - p) * normal).sum(-1) >= 0
    consider(foot, inside)
    return best, place


def random_rays(count, reach, seed):
    """Rays from around the origin to near it, with directions of various lengths."""
    random = np.random.default_rng(seed)
    origins = random.normal(size=(count, 3)) * 2 * reach
    targets = random.uniform(-reach, reach, (count, 3))
    directions = (targets - origins) * random.uniform(0.1, 4, (count, 1))
    return np.concatenate([origins, directions], axis=1).astype(np.float32)


CUBE_VERTICES = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
CUBE_FACES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
     [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]], np.uint32)  # fmt: skip


def ball(level=2):
    """A closed mesh close to the unit sphere: an octahedron that is divided `level` times."""
    vertices = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    for _ in range(level):
        middles, divided = {}, []

        def middle(i, j):
            key = (min(i, j), max(i, j))
            if key not in middles:
                point = np.add(vertices[i], vertices[j])
                vertices.append(tuple(point / np.linalg.norm(point)))
                middles[key] = len(vertices) - 1
            return middles[key]

        for i, j, k in faces:
            ij, jk, ki = middle(i, j), middle(j, k), middle(k, i)
            divided += [(i, ij, ki), (ij, j, jk), (ki, jk, k), (ij, jk, ki)]
        faces = divided
    return np.array(vertices, np.float32), np.array(faces, np.uint32)


def read_exr(path):
    """The planes of a scanline EXR file with ZIP compression, or none, as arrays by name."""
    data = open(path, "rb").read()
    assert data[:4] == b"\x76\x2f\x31\x01"
    place, attributes = 8, {}
    while data[place] != 0:
        name, kind, rest = data[place:].split(b"\0", 2)
        place += len(name) + len(kind) + 2
        (size,) = struct.unpack_from("<i", data, place)
        attributes[name.decode()] = data[place + 4 : place + 4 + size]
        place += 4 + size
    place += 1
    channels, text = [], attributes["channels"]
    while text[0] != 0:
        name, text = text.split(b"\0", 1)
        channels.append((name.decode(), {0: "<u4", 1: "<f2", 2: "<f4"}[struct.unpack_from("<i", text)[0]]))
        text = text[16:]
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    compression = attributes["compression"][0]
    block = {0: 1, 2: 1, 3: 16}[compression]
    planes = {name: np.empty((height, width), kind) for name, kind in channels}
    bytes_per_row = sum(width * np.dtype(kind).itemsize for _, kind in channels)
    count = (height + block - 1) // block
    for offset in struct.unpack_from(f"<{count}Q", data, place):
        y, size = struct.unpack_from("<ii", data, offset)
        chunk = data[offset + 8 : offset + 8 + size]
        rows = range(y - top, min(y - top + block, height))
        if compression != 0 and size < bytes_per_row * len(rows):
            coded = np.frombuffer(zlib.decompress(chunk), np.uint8).astype(np.int64)
            sums = (np.cumsum(coded) - 128 * np.arange(len(coded))).astype(np.uint8)
            half = (len(sums) + 1) // 2
            chunk = np.empty(len(sums), np.uint8)
            chunk[0::2], chunk[1::2] = sums[:half], sums[half:]
            chunk = chunk.tobytes()
        start = 0
        for row in rows:
            for name, kind in channels:
                planes[name][row] = np.frombuffer(chunk, kind, width, start)
                start += width * np.dtype(kind).itemsize
    return planes
