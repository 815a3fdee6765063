"""One triangle mesh in float64, traced by a Scene in float32.

The scene holds the mesh around its middle and of a size close to 1, so a mesh far from the origin, or of any size,
loses nothing. What the scene finds, triangles and weights of corners, is computed again in float64.
"""

from typing import Any, NamedTuple, Optional, Tuple

import numpy as np
import numpy.typing as npt

from ._oktett import Scene

Array = npt.NDArray[Any]

# Along no axis, plane or diagonal that meshes are likely to follow.
_DIRECTIONS = (
    (0.4395064455, 0.617598629942, 0.652231566745),
    (-0.7306198621, 0.2389274105, 0.6396152947),
    (0.1892342873, -0.8914236719, 0.4117923564),
)

# Of a triangle's weights: where the least is smaller, float32 may have found a neighbour of the right triangle.
_NEAR_EDGE = 1e-4

# A point farther away than so many sizes of the mesh asks from there: what that changes is less than float32 rounds.
_FAR = 4096.0

# Pairs of points and triangles that are compared at once.
_PAIRS = 1 << 20


class MeshHits(NamedTuple):
    """Hits of rays, ray after ray, nearest first."""

    ray: Array  # int64 (h,)
    triangle: Array  # int64 (h,)
    location: Optional[Array]  # float64 (h, 3), if it was asked for


class Nearest(NamedTuple):
    """The nearest point of a mesh to each point."""

    point: Array  # float64 (n, 3); NaN where there is none
    distance: Array  # float64 (n,); inf where there is none
    triangle: Array  # int64 (n,); -1 where there is none
    weights: Array  # float64 (n, 3) of the corners: 0 is exact
    offset: Array  # float64 (n, 3) from the nearest point to the point that was asked


class CenteredMesh:
    """The mesh of `vertices` (n, 3) and `faces` (m, 3). Both are copied."""

    def __init__(self, vertices: Any, faces: Any) -> None:
        self.vertices = points_of(vertices, "vertices").copy()
        self.faces = np.array(faces)
        if self.faces.size == 0:
            self.faces = np.zeros((0, 3), np.int64)
        used = self._used()
        low, high = (used.min(axis=0), used.max(axis=0)) if len(used) else (np.zeros(3), np.zeros(3))
        self.bounds = np.array([low, high])
        # Halves first: the sum of two large numbers may overflow.
        self._center = low / 2 + high / 2
        extent = float(np.max(high / 2 - low / 2))
        # A power of two rounds nothing; the limit keeps points that are far from a tiny mesh finite.
        self._scale = float(np.ldexp(1.0, min(-int(np.frexp(extent)[1]), 1000))) if extent > 0 else 1.0
        local = self._local(self.vertices)
        self._radius = float(np.linalg.norm(self._local(high)))
        with np.errstate(over="ignore"):
            self._scene = Scene(local.astype(np.float32), self.faces)
        self._merged = np.zeros(0, np.int64)
        self._rings: Optional[Tuple[Array, Array]] = None
        self._features: Optional[Tuple[Array, Array, Array]] = None

    def _used(self) -> Array:
        """The vertices of triangles, without those that are not finite."""
        indices = self.faces.ravel()
        used = np.isfinite(self.vertices).all(axis=1)
        # Others are an error, which the scene reports.
        if indices.dtype.kind in "iu" and len(indices) and 0 <= indices.min() and indices.max() < len(used):
            of_triangles = np.zeros(len(used), bool)
            of_triangles[indices] = True
            used &= of_triangles
        return self.vertices[used]

    def holds(self, vertices: Any, faces: Any) -> bool:
        """Whether these are the vertices and faces that were copied."""
        return _same(points_of(vertices, "vertices"), self.vertices) and _same(np.asarray(faces), self.faces)

    def hits(
        self, origins: Any, directions: Any, multiple: bool, most: Optional[int] = None, locate: bool = True
    ) -> MeshHits:
        """All hits of each ray, at most `most`; or only the nearest, if not `multiple`."""
        origins, directions, rays = self._rays(origins, directions)
        if multiple:
            found = self._scene.all_hits(rays, fields=["primitive", "uv"])
            ray, triangle, uv = found.ray_ids, found.primitive, found.uv
            if most is not None:
                kept = np.arange(len(ray)) - found.splits[ray] < most
                ray, triangle, uv = ray[kept], triangle[kept], uv[kept]
        else:
            first = self._scene.closest_hit(rays, fields=["t", "primitive", "uv"])
            ray = np.nonzero(np.isfinite(first.t))[0]
            triangle, uv = first.primitive[ray], first.uv[ray]
        triangle = triangle.astype(np.int64)
        location = self._locations(origins[ray], directions[ray], triangle, uv) if locate else None
        return MeshHits(ray, triangle, location)

    def first_triangles(self, origins: Any, directions: Any) -> Array:
        """The nearest triangle of each ray, int64 (n,); -1 for a miss."""
        hits = self._scene.closest_hit(self._rays(origins, directions)[2], fields=["t", "primitive"])
        return np.where(np.isfinite(hits.t), hits.primitive.astype(np.int64), -1)

    def any_hit(self, origins: Any, directions: Any) -> Array:
        """Whether each ray meets the mesh, bool (n,)."""
        return self._scene.any_hit(self._rays(origins, directions)[2])

    def contains(self, points: Any) -> Array:
        """Whether each point is inside, bool (n,).

        A ray from a point outside of a closed mesh meets it an even number of times. Both ways along one line
        are counted. Where they disagree, which takes a mesh with holes, two more lines are asked, and most of
        the three decide.
        """
        given = points_of(points, "points")
        inside = np.zeros(len(given), bool)
        if len(self.faces) == 0:
            return inside
        with np.errstate(invalid="ignore"):
            near = np.nonzero(((given >= self.bounds[0]) & (given <= self.bounds[1])).all(axis=1))[0]
        forward, backward = self._odd(given[near], _DIRECTIONS[0])
        inside[near] = forward & backward
        open_ones = near[forward != backward]
        if len(open_ones):
            votes = np.ones(len(open_ones), int)
            for direction in _DIRECTIONS[1:]:
                votes += sum(ways.astype(int) for ways in self._odd(given[open_ones], direction))
            inside[open_ones] = votes > 3
        return inside

    def nearest(self, points: Any, slack: float = 4e-15) -> Nearest:
        """The nearest point of all triangles. Of triangles that share it, the one that faces the point most.

        slack: what part of the distance another triangle may be farther away and still be equally near.
        """
        given = points_of(points, "points")
        count = len(given)
        asked = self._local(given)
        with np.errstate(all="ignore"):
            away = np.abs(asked).max(axis=1, initial=0.0)
            closer = np.where((away > _FAR)[:, None], asked / away[:, None] * _FAR, asked)
            found = self._scene.closest_point(closer.astype(np.float32), fields=["distance", "primitive"])
            # Float64 still tells the corners of the mesh apart from there.
            exact = np.where((away > 1e8)[:, None], asked / away[:, None] * 1e8, asked)
        triangle = np.where(np.isfinite(found.distance), found.primitive.astype(np.int64), -1)
        offset, weights = np.full((count, 3), np.nan), np.full((count, 3), np.nan)
        there = np.nonzero(triangle >= 0)[0]
        for begin in range(0, len(there), _PAIRS):
            part = there[begin : begin + _PAIRS]
            offset[part], weights[part] = _to_triangles(exact[part], self._corners(triangle[part]))
        at_edge = there[weights[there].min(axis=1) < _NEAR_EDGE]
        self._choose_in_rings(exact, at_edge, triangle, offset, weights, slack)
        point, distance = np.full((count, 3), np.nan), np.full(count, np.inf)
        # Exact at corners, and next to the triangle for points far away: offsets of those round to nothing.
        local = (self._corners(triangle[there]) * weights[there][:, :, None]).sum(axis=1)
        point[there] = local / self._scale + self._center
        offset[there] += asked[there] - exact[there]
        largest = np.abs(offset[there]).max(axis=1, initial=1e-300, keepdims=True)
        distance[there] = np.linalg.norm(offset[there] / largest, axis=1) * (largest[:, 0] / self._scale)
        return Nearest(point, distance, triangle, weights, offset / self._scale)

    def normals(self, triangles: Array) -> Array:
        """Of unit length, by the order of corners; 0 where a triangle has no area."""
        corners = self._corners(triangles)
        return _unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))

    def is_behind(self, nearest: Nearest) -> Array:
        """Whether the points of `nearest` are behind the surface, bool (n,): inside of a closed mesh.

        Normals of edges and vertices are sums of those of their triangles, weighted by angles (Baerentzen 2005), so
        the sign is right for every closed mesh, and defined for an open one.
        """
        of_faces, of_edges, of_vertices = self._normals_of_features()
        there = np.nonzero(nearest.triangle >= 0)[0]
        behind = np.zeros(len(nearest.triangle), bool)
        triangle, zero = nearest.triangle[there], nearest.weights[there] == 0
        normal = of_faces[triangle]
        zeros = zero.sum(axis=1)
        edge, vertex = zeros == 1, zeros == 2
        # The edge lies opposite the corner that has no weight, the vertex is the corner that has all.
        normal[edge] = of_edges[triangle[edge], zero[edge].argmax(axis=1)]
        normal[vertex] = of_vertices[triangle[vertex], (~zero[vertex]).argmax(axis=1)]
        behind[there] = (normal * nearest.offset[there]).sum(axis=1) < 0
        return behind

    def _local(self, points: Array) -> Array:
        with np.errstate(over="ignore", invalid="ignore"):
            return (points - self._center) * self._scale

    def _corners(self, triangles: Array) -> Array:
        return self._local(self.vertices[self.faces[triangles]])

    def _odd(self, points: Array, direction: Tuple[float, float, float]) -> Tuple[Array, Array]:
        """Whether the rays from `points` along a direction and against it meet the mesh an odd number of times."""
        rays = np.empty((2, len(points), 6), np.float32)
        rays[:, :, :3] = self._local(points)
        rays[0, :, 3:] = direction
        rays[1, :, 3:] = -np.asarray(direction)
        odd = self._scene.count_hits(rays) % 2 == 1
        return odd[0], odd[1]

    def _rays(self, ray_origins: Any, ray_directions: Any) -> Tuple[Array, Array, Array]:
        """Both in float64 around the middle of the mesh, and as rays (n, 6) of the scene."""
        origins = self._local(points_of(ray_origins, "ray_origins"))
        directions = points_of(ray_directions, "ray_directions")
        if len(origins) != len(directions):
            raise ValueError(
                f"expected as many directions as origins, found {len(directions)} and {len(origins)}"
            )
        with np.errstate(all="ignore"):
            length = np.abs(directions).max(axis=1, initial=0.0)
            unit = directions / length[:, None]
            unit /= np.linalg.norm(unit, axis=1)[:, None]
            # An origin far away moves close to the sphere around the mesh before it is rounded.
            ahead = np.maximum(-(origins * unit).sum(axis=1) - 1.01 * self._radius, 0.0)
            near = np.where(ahead[:, None] > 0, origins + ahead[:, None] * unit, origins)
            rays = np.concatenate([near, unit], axis=1).astype(np.float32)
        return origins, unit, rays

    def _locations(self, origins: Array, directions: Array, triangles: Array, uv: Array) -> Array:
        """Where rays meet the planes of triangles."""
        corners = self._corners(triangles)
        edges = corners[:, 1:] - corners[:, :1]
        weighted = corners[:, 0] + (edges * uv[:, :, None].astype(np.float64)).sum(axis=1)
        with np.errstate(all="ignore"):
            normal = np.cross(edges[:, 0], edges[:, 1])
            slope = (normal * directions).sum(axis=1)
            t = (normal * (corners[:, 0] - origins)).sum(axis=1) / slope
            on_plane = origins + t[:, None] * directions
            # A line close to the plane meets it at no certain place; the weights of the corners still tell.
            steep = np.abs(slope) > 1e-6 * np.linalg.norm(normal, axis=1)
        return np.where(steep[:, None], on_plane, weighted) / self._scale + self._center

    def _choose_in_rings(
        self, asked: Array, which: Array, triangle: Array, offset: Array, weights: Array, slack: float
    ) -> None:
        """Compares the triangles around the heaviest corner of what was found for the points `which`."""
        if len(which) == 0:
            return
        begins, around = self._triangles_around()
        corner = self._merged[self.faces[triangle[which], weights[which].argmax(axis=1)]]
        counts = begins[corner + 1] - begins[corner]
        # As many points at once as have about _PAIRS triangles.
        for some in np.split(np.arange(len(which)), _cuts(counts)):
            size = counts[some]
            first = np.cumsum(size) - size
            candidates = around[
                np.repeat(begins[corner[some]] - first, size) + np.arange(int(size.sum()))
            ]
            to, weight = _to_triangles(np.repeat(asked[which[some]], size, axis=0), self._corners(candidates))
            distance = np.nan_to_num(np.linalg.norm(to, axis=1), nan=np.inf)
            least = np.minimum.reduceat(distance, first)
            with np.errstate(all="ignore"):
                facing = (self.normals(candidates) * to).sum(axis=1) / distance
            tied = distance <= np.repeat(least, size) * (1 + slack) + 1e-15
            rank = np.where(tied, np.nan_to_num(facing), -2.0)
            leading = np.nonzero(rank == np.repeat(np.maximum.reduceat(rank, first), size))[0]
            best = leading[np.searchsorted(leading, first)]
            into = which[some]
            triangle[into], offset[into], weights[into] = candidates[best], to[best], weight[best]

    def _triangles_around(self) -> Tuple[Array, Array]:
        """The triangles of each vertex: those of vertex i are around[begins[i]:begins[i + 1]]."""
        if self._rings is None:
            self._merged = _merge(self.vertices)
            corners = self._merged[self.faces].ravel()
            order = np.argsort(corners, kind="stable")
            begins = np.zeros(len(self.vertices) + 1, np.int64)
            np.cumsum(np.bincount(corners, minlength=len(self.vertices)), out=begins[1:])
            self._rings = begins, order // 3
        return self._rings

    def _normals_of_features(self) -> Tuple[Array, Array, Array]:
        """Normals of triangles (m, 3), of their edges opposite each corner and of their corners (m, 3, 3)."""
        if self._features is not None:
            return self._features
        self._triangles_around()
        every, size = np.arange(len(self.faces)), len(self.vertices)
        corners, merged = self._corners(every), self._merged[self.faces]
        normals = np.nan_to_num(self.normals(every))
        keys, of_vertices = np.empty((len(every), 3), np.int64), np.zeros((size, 3))
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            keys[:, k] = np.minimum(merged[:, i], merged[:, j]) * size + np.maximum(merged[:, i], merged[:, j])
            one, other = _unit(corners[:, i] - corners[:, k]), _unit(corners[:, j] - corners[:, k])
            angle = np.arctan2(np.linalg.norm(np.cross(one, other), axis=1), (one * other).sum(axis=1))
            weighted = normals * np.nan_to_num(angle)[:, None]
            for axis in range(3):
                of_vertices[:, axis] += np.bincount(merged[:, k], weighted[:, axis], size)
        edges, which = np.unique(keys, return_inverse=True)
        which = which.reshape(-1, 3)
        of_edges = np.zeros((len(edges), 3))
        for k in range(3):
            for axis in range(3):
                of_edges[:, axis] += np.bincount(which[:, k], normals[:, axis], len(edges))
        self._features = normals, of_edges[which], of_vertices[merged]
        return self._features


def points_of(value: Any, name: str) -> Array:
    """`value` as float64 of shape (n, 3), or ValueError."""
    array = np.asarray(value)
    if array.size == 0:
        array = array.reshape(-1, 3).astype(np.float64)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "fiu":
        raise ValueError(
            f"{name}: expected numbers of shape (n, 3), found {array.dtype} of the shape {array.shape}"
        )
    return array.astype(np.float64, copy=False)


def _same(one: Array, other: Array) -> bool:
    # Not by their values: a NaN is the same as itself here.
    return (one.shape == other.shape or one.size == other.size == 0) and bool(
        np.all((one == other) | (one != one) & (other != other))
    )


def _unit(vectors: Array) -> Array:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0)


def _merge(vertices: Array) -> Array:
    """For each vertex the first one at the same place."""
    if len(vertices) == 0:
        return np.zeros(0, np.int64)
    order = np.lexsort(vertices.T)
    placed = vertices[order]
    new = np.concatenate([[True], (placed[1:] != placed[:-1]).any(axis=1)])
    merged = np.empty(len(vertices), np.int64)
    # The order is stable, so the first of a group is that of the lowest number.
    merged[order] = order[new][np.cumsum(new) - 1]
    return merged


def _to_triangles(points: Array, corners: Array) -> Tuple[Array, Array]:
    """From the nearest point of each triangle (n, 3, 3) to its point, and that point's weights of the corners."""
    count = len(points)
    best, offset, weights = np.full(count, np.inf), np.zeros((count, 3)), np.zeros((count, 3))
    every = np.arange(count)
    with np.errstate(all="ignore"):
        for i, j in ((0, 1), (1, 2), (2, 0)):
            edge, start = corners[:, j] - corners[:, i], points - corners[:, i]
            along = (start * edge).sum(axis=1) / (edge * edge).sum(axis=1)
            along = np.clip(np.nan_to_num(along), 0.0, 1.0)
            # The end is subtracted itself, so that it is met exactly.
            to = np.where((along == 1)[:, None], points - corners[:, j], start - along[:, None] * edge)
            squared = (to * to).sum(axis=1)
            nearer = np.nonzero(squared < best)[0]
            best[nearer], offset[nearer], weights[nearer] = squared[nearer], to[nearer], 0.0
            weights[nearer, i], weights[nearer, j] = 1 - along[nearer], along[nearer]
        ab, ac, ap = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], points - corners[:, 0]
        normal = np.cross(ab, ac)
        squared = (normal * normal).sum(axis=1)
        v = (np.cross(ap, ac) * normal).sum(axis=1) / squared
        w = (np.cross(ab, ap) * normal).sum(axis=1) / squared
        # Of a triangle whose height is lost in rounding the edges are all.
        solid = squared > 1e-24 * (ab * ab).sum(axis=1) * (ac * ac).sum(axis=1)
        over = np.nonzero(solid & (v >= 0) & (w >= 0) & (v + w <= 1))[0]
        height = (ap[over] * normal[over]).sum(axis=1) / squared[over]
    offset[over] = normal[over] * height[:, None]
    weights[over] = np.stack([1 - v[over] - w[over], v[over], w[over]], axis=1)
    unknown = every[~np.isfinite(best)]
    offset[unknown] = weights[unknown] = np.nan
    return offset, weights


def _cuts(sizes: Array) -> Array:
    """Where to cut, so that the sizes between two cuts sum up to about _PAIRS."""
    return np.nonzero(np.diff(np.cumsum(sizes) // _PAIRS))[0] + 1
