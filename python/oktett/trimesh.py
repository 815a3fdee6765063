"""Ray queries with the signatures and conventions of trimesh.ray.

    from oktett.trimesh import RayMeshIntersector
    mesh.ray = RayMeshIntersector(mesh)
"""

from typing import Any, Tuple, Union

import numpy as np
import numpy.typing as npt

from ._oktett import Scene

__all__ = ["RayMeshIntersector"]

Array = npt.NDArray[Any]

# Along no axis, plane or diagonal that meshes are likely to follow.
_DIRECTIONS = (
    (0.4395064455, 0.617598629942, 0.652231566745),
    (-0.7306198621, 0.2389274105, 0.6396152947),
    (0.1892342873, -0.8914236719, 0.4117923564),
)


class RayMeshIntersector:
    """Answers rays against one mesh.

    geometry: anything with `vertices` (n, 3) and `faces` (m, 3). Both are copied: a mesh that changes needs a
        new object.
    scale_to_box: accepted and ignored; coordinates are always taken relative to the middle of the mesh.

    Origins and directions have the shape (n, 3); directions need not have length 1. Only hits in front of the
    origin count. An edge or vertex that triangles share counts once. The hits of a ray are ordered by
    distance, and those of the first ray come first. A ray that is not finite, or has no direction, hits
    nothing. Other shapes raise ValueError.
    """

    def __init__(self, geometry: Any, scale_to_box: bool = True) -> None:
        self.mesh = geometry
        vertices = _points(geometry.vertices, "vertices")
        self._faces = np.asarray(geometry.faces)
        used = vertices[np.isfinite(vertices).all(axis=1)]
        low, high = (used.min(axis=0), used.max(axis=0)) if len(used) else (np.zeros(3), np.zeros(3))
        # Differences of coordinates fit a float32 better than the coordinates do.
        self._center = (low + high) / 2
        self._radius = 0.5 * float(np.linalg.norm(high - low))
        self._bounds = np.array([low, high])
        self._vertices = vertices - self._center
        self._scene = Scene(self._vertices, self._faces)

    def intersects_location(
        self, ray_origins: npt.ArrayLike, ray_directions: npt.ArrayLike, multiple_hits: bool = True
    ) -> Tuple[Array, Array, Array]:
        """Where rays meet the mesh: locations (h, 3) float64, index_ray (h,) and index_tri (h,) int64.

        multiple_hits: all hits, else only the nearest of each ray.
        """
        index_tri, index_ray, locations = self.intersects_id(
            ray_origins, ray_directions, multiple_hits, max_hits=None, return_locations=True
        )
        return locations, index_ray, index_tri

    def intersects_id(
        self,
        ray_origins: npt.ArrayLike,
        ray_directions: npt.ArrayLike,
        multiple_hits: bool = True,
        max_hits: Union[int, None] = 100,
        return_locations: bool = False,
    ) -> Union[Tuple[Array, Array], Tuple[Array, Array, Array]]:
        """Which triangles rays meet: index_tri (h,), index_ray (h,) int64 and, if asked for, locations (h, 3).

        max_hits: how many hits of a ray count if multiple_hits, the nearest first; None: all.
        """
        origins, directions, rays = self._rays(ray_origins, ray_directions)
        if multiple_hits:
            hits = self._scene.all_hits(rays, fields=["primitive", "uv"])
            index_ray = hits.ray_ids
            index_tri, uv = hits.primitive, hits.uv
            if max_hits is not None:
                rank = np.arange(len(index_ray)) - hits.splits[index_ray]
                kept = rank < max_hits
                index_ray, index_tri, uv = index_ray[kept], index_tri[kept], uv[kept]
        else:
            first = self._scene.closest_hit(rays, fields=["t", "primitive", "uv"])
            index_ray = np.nonzero(np.isfinite(first.t))[0]
            index_tri, uv = first.primitive[index_ray], first.uv[index_ray]
        index_tri = index_tri.astype(np.int64)
        if not return_locations:
            return index_tri, index_ray
        return index_tri, index_ray, self._locations(origins[index_ray], directions[index_ray], index_tri, uv)

    def intersects_first(self, ray_origins: npt.ArrayLike, ray_directions: npt.ArrayLike) -> Array:
        """The nearest triangle of each ray, (n,) int64; -1 for a miss."""
        rays = self._rays(ray_origins, ray_directions)[2]
        hits = self._scene.closest_hit(rays, fields=["t", "primitive"])
        return np.where(np.isfinite(hits.t), hits.primitive.astype(np.int64), -1)

    def intersects_any(self, ray_origins: npt.ArrayLike, ray_directions: npt.ArrayLike) -> Array:
        """Whether each ray meets the mesh, (n,) bool."""
        return self._scene.any_hit(self._rays(ray_origins, ray_directions)[2])

    def contains_points(self, points: npt.ArrayLike) -> Array:
        """Whether each point, shape (n, 3), is inside the mesh, which should be closed: (n,) bool.

        A ray from a point outside of a closed mesh meets it an even number of times. Both ways along one line
        are counted. Where they disagree, which takes a mesh with holes, two more lines are asked, and most of
        the three decide.
        """
        given = _points(points, "points")
        inside = np.zeros(len(given), bool)
        with np.errstate(invalid="ignore"):
            near = np.nonzero(((given >= self._bounds[0]) & (given <= self._bounds[1])).all(axis=1))[0]
        forward, backward = self._odd(given[near], _DIRECTIONS[0])
        inside[near] = forward & backward
        open_ones = near[forward != backward]
        if len(open_ones):
            votes = np.ones(len(open_ones), int)
            for direction in _DIRECTIONS[1:]:
                votes += sum(ways.astype(int) for ways in self._odd(given[open_ones], direction))
            inside[open_ones] = votes > 3
        return inside

    def _odd(self, points: Array, direction: Tuple[float, float, float]) -> Tuple[Array, Array]:
        """Whether the rays from `points` along a direction and against it meet the mesh an odd number of times."""
        rays = np.empty((2, len(points), 6), np.float32)
        rays[:, :, :3] = points - self._center
        rays[0, :, 3:] = direction
        rays[1, :, 3:] = -np.asarray(direction)
        odd = self._scene.count_hits(rays) % 2 == 1
        return odd[0], odd[1]

    def _rays(self, ray_origins: npt.ArrayLike, ray_directions: npt.ArrayLike) -> Tuple[Array, Array, Array]:
        """Both in float64 relative to the middle of the mesh, and as rays (n, 6) of the scene."""
        origins = _points(ray_origins, "ray_origins") - self._center
        directions = _points(ray_directions, "ray_directions")
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
        return origins, directions, rays

    def _locations(self, origins: Array, directions: Array, index_tri: Array, uv: Array) -> Array:
        """Where rays meet the planes of triangles, computed in float64 from the vertices as they were given."""
        corners = self._vertices[self._faces[index_tri]]
        edges = corners[:, 1:] - corners[:, :1]
        weighted = corners[:, 0] + (edges * uv[:, :, None].astype(np.float64)).sum(axis=1)
        with np.errstate(all="ignore"):
            normal = np.cross(edges[:, 0], edges[:, 1])
            slope = (normal * directions).sum(axis=1)
            t = (normal * (corners[:, 0] - origins)).sum(axis=1) / slope
            on_plane = origins + t[:, None] * directions
            # A line close to the plane meets it at no certain place; the weights of the corners still tell.
            steep = np.abs(slope) > 1e-6 * np.linalg.norm(normal, axis=1) * np.linalg.norm(directions, axis=1)
        return np.where(steep[:, None], on_plane, weighted) + self._center


def _points(value: npt.ArrayLike, name: str) -> Array:
    array = np.asarray(value)
    if array.size == 0:
        array = array.reshape(-1, 3).astype(np.float64)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "fiu":
        raise ValueError(
            f"{name}: expected numbers of shape (n, 3), found {array.dtype} of the shape {array.shape}"
        )
    return array.astype(np.float64)
