"""Ray and proximity queries with the signatures and conventions of trimesh.ray and trimesh.proximity.

    from oktett.trimesh import ProximityQuery, RayMeshIntersector
    mesh.ray, mesh.nearest = RayMeshIntersector(mesh), ProximityQuery(mesh)

A mesh is a trimesh.Trimesh, or anything with `vertices` (n, 3) and `faces` (m, 3). What is built of it is shared by
all that is asked about it, and built again by the first query after the mesh has changed.
"""

import sys
import weakref
from typing import Any, Dict, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from ._mesh import CenteredMesh, points_of

__all__ = [
    "ProximityQuery",
    "RayMeshIntersector",
    "closest_point",
    "contains_points",
    "longest_ray",
    "max_tangent_sphere",
    "signed_distance",
    "thickness",
]

Array = npt.NDArray[Any]

# Distances that trimesh.constants.tol calls merge and planar.
_MERGE, _PLANAR = 1e-8, 1e-5


class RayMeshIntersector:
    """Answers rays against one mesh.

    geometry, or mesh: see above.
    scale_to_box: accepted and ignored; a mesh is always traced around its middle and at a size close to 1.

    Origins and directions have the shape (n, 3); directions need not have length 1. Only hits in front of the
    origin count. An edge or vertex that triangles share counts once. The hits of a ray are ordered by
    distance, and those of the first ray come first. A ray that is not finite, or has no direction, hits
    nothing. Other shapes raise ValueError.

    trimesh has two classes of this name, one for Embree and one without. Where they differ, in what the third
    argument of intersects_id is and in whether unknown keywords are ignored, this one is like that of
    `geometry.ray` or else of the trimesh that was imported; without trimesh it is like that for Embree.
    """

    def __init__(self, geometry: Any = None, scale_to_box: bool = True, *, mesh: Any = None) -> None:
        if (geometry is None) == (mesh is None):
            raise TypeError("RayMeshIntersector: expected one mesh")
        self.mesh = mesh if geometry is None else geometry
        self._without_embree = _is_without_embree(self.mesh)

    def intersects_location(
        self, ray_origins: npt.ArrayLike, ray_directions: npt.ArrayLike, multiple_hits: bool = True, **unknown: Any
    ) -> Tuple[Array, Array, Array]:
        """Where rays meet the mesh: locations (h, 3) float64, index_ray (h,) and index_tri (h,) int64.

        multiple_hits: all hits, else only the nearest of each ray.
        """
        self._ignore(unknown, "max_hits")
        hits = _built(self.mesh, self).hits(ray_origins, ray_directions, multiple_hits, unknown.get("max_hits"))
        return hits.location, hits.ray, hits.triangle

    def intersects_id(
        self, ray_origins: npt.ArrayLike, ray_directions: npt.ArrayLike, *options: Any, **named: Any
    ) -> Union[Tuple[Array, Array], Tuple[Array, Array, Array]]:
        """Which triangles rays meet: index_tri (h,), index_ray (h,) int64 and, if asked for, locations (h, 3).

        Options, by name or in the order multiple_hits, max_hits, return_locations (without Embree:
        return_locations, multiple_hits):
            multiple_hits = True      all hits, else only the nearest of each ray
            max_hits = None           how many hits of a ray count if multiple_hits, the nearest first; None: all
            return_locations = False  whether locations are wanted
        """
        order = ("return_locations", "multiple_hits") if self._without_embree else _EMBREE_ORDER
        if len(options) > len(order):
            raise TypeError(f"intersects_id: expected at most {2 + len(order)} arguments, found {2 + len(options)}")
        for name, value in zip(order, options):
            if name in named:
                raise TypeError(f"intersects_id: {name} is given twice")
            named[name] = value
        self._ignore(named, *_EMBREE_ORDER)
        locate = bool(named.get("return_locations", False))
        hits = _built(self.mesh, self).hits(
            ray_origins, ray_directions, named.get("multiple_hits", True), named.get("max_hits"), locate
        )
        return (hits.triangle, hits.ray, hits.location) if locate else (hits.triangle, hits.ray)

    def intersects_first(
        self, ray_origins: npt.ArrayLike, ray_directions: npt.ArrayLike, **unknown: Any
    ) -> Array:
        """The nearest triangle of each ray, (n,) int64; -1 for a miss."""
        self._ignore(unknown)
        return _built(self.mesh, self).first_triangles(ray_origins, ray_directions)

    def intersects_any(
        self, ray_origins: npt.ArrayLike, ray_directions: npt.ArrayLike, **unknown: Any
    ) -> Array:
        """Whether each ray meets the mesh, (n,) bool."""
        self._ignore(unknown)
        return _built(self.mesh, self).any_hit(ray_origins, ray_directions)

    def contains_points(self, points: npt.ArrayLike) -> Array:
        """Whether each point, shape (n, 3), is inside the mesh, which should be closed: (n,) bool.

        Rays are counted, see contains_points of this module.
        """
        return _built(self.mesh, self).contains(points)

    def _ignore(self, named: Dict[str, Any], *known: str) -> None:
        """Unknown keywords are an error, but not where trimesh works without Embree."""
        unknown = [name for name in named if name not in known]
        if unknown and not self._without_embree:
            raise TypeError(f"unexpected keyword argument '{unknown[0]}'")


_EMBREE_ORDER = ("multiple_hits", "max_hits", "return_locations")


class ProximityQuery:
    """Answers which point of one mesh is nearest. Points have the shape (n, 3). Other shapes raise ValueError."""

    def __init__(self, mesh: Any) -> None:
        self._mesh = mesh

    def on_surface(self, points: npt.ArrayLike) -> Tuple[Array, Array, Array]:
        """closest_point of this mesh."""
        return _closest(_built(self._mesh, self), points)

    def vertex(self, points: npt.ArrayLike) -> Tuple[Array, Array]:
        """The nearest vertex of each point: distance (n,) float64 and vertex_id (n,) int64.

        Asks the tree of vertices that the mesh has, `kdtree`, or else one of SciPy, which must be installed.
        """
        tree = getattr(self._mesh, "kdtree", None)
        if tree is None:
            from scipy.spatial import cKDTree

            tree = cKDTree(points_of(self._mesh.vertices, "vertices"))
        return tree.query(points)

    def signed_distance(self, points: npt.ArrayLike) -> Array:
        """signed_distance of this mesh."""
        return _signed(_built(self._mesh, self), points)


def contains_points(mesh: Any, points: npt.ArrayLike) -> Array:
    """Whether each point, shape (n, 3), is inside the mesh, which should be closed: (n,) bool.

    A ray from a point outside of a closed mesh meets it an even number of times. Both ways along one line are
    counted. Where they disagree, which takes a mesh with holes, two more lines are asked, and most of the three
    decide.
    """
    return _built(mesh).contains(points)


def closest_point(mesh: Any, points: npt.ArrayLike) -> Tuple[Array, Array, Array]:
    """The nearest point of all triangles to each point, shape (n, 3).

    Returns closest (n, 3) float64, distance (n,) float64 and triangle_id (n,) int64: of triangles that are
    equally near, to 1e-8 of the distance, the one that faces the point most. If the mesh has no triangles, or the
    point is not finite, they are NaN, inf and -1. A triangle whose corners are all in one place does not count.
    """
    return _closest(_built(mesh), points)


def signed_distance(mesh: Any, points: npt.ArrayLike) -> Array:
    """The distance of each point, shape (n, 3), to the mesh: (n,) float64, positive inside and negative outside.

    Points within 1e-8 of the surface count as inside. Where the nearest point lies in a triangle, its normal
    tells the side; where it lies on an edge or a vertex, contains_points does.
    """
    return _signed(_built(mesh), points)


def longest_ray(mesh: Any, points: npt.ArrayLike, directions: npt.ArrayLike) -> Array:
    """How far one can go from each point in a direction, both of shape (n, 3), before the mesh is met.

    Returns lengths (n,) float64; inf if the mesh is not met. The surface within 1e-5 of a point is not counted.
    """
    origins = points_of(points, "points")
    hits = _built(mesh).hits(origins, directions, multiple=True)
    lengths = np.linalg.norm(hits.location - origins[hits.ray], axis=1)
    counted = lengths > _PLANAR
    result = np.full(len(origins), np.inf)
    np.minimum.at(result, hits.ray[counted], lengths[counted])
    return result


def max_tangent_sphere(
    mesh: Any,
    points: npt.ArrayLike,
    inwards: bool = True,
    normals: Optional[npt.ArrayLike] = None,
    threshold: float = 1e-6,
    max_iter: int = 100,
) -> Tuple[Array, Array]:
    """The largest spheres that touch the surface at each point, shape (n, 3), and do not cross it.

    inwards: the spheres lie inside of the mesh, else outside.
    normals: outward normals at the points, shape (n, 3); None: those of the nearest triangles.
    threshold, max_iter: a sphere shrinks until its radius changes by less than `threshold` diagonals of the
        bounds, at most so many times.

    Returns centers (n, 3) and radii (n,) float64; NaN and inf where no sphere is too large.
    The spheres shrink as in Inui 2016.
    """
    built = _built(mesh)
    start = points_of(points, "points")
    inward = _normals_at(built, start, normals) * (-1.0 if inwards else 1.0)
    radii = longest_ray(mesh, start, inward) / 2
    for i in np.nonzero(np.isinf(radii))[0]:
        radii[i] = _tangent_radii(built.vertices - start[i], inward[i]).min(initial=np.inf)
    small = threshold * float(np.linalg.norm(built.bounds[1] - built.bounds[0]))
    moving = np.nonzero(np.isfinite(radii))[0]
    for _ in range(max_iter):
        if len(moving) == 0:
            break
        centers = start[moving] + inward[moving] * radii[moving, None]
        nearest = built.nearest(centers)
        shrunk = _tangent_radii(nearest.point - start[moving], inward[moving])
        # What is nearest may be the start itself.
        crossed = (nearest.distance < radii[moving] - _PLANAR) & (shrunk < radii[moving])
        change = radii[moving] - shrunk
        radii[moving[crossed]] = shrunk[crossed]
        moving = moving[crossed & (change >= small)]
    centers = start + inward * np.where(np.isfinite(radii), radii, np.nan)[:, None]
    return centers, radii


def thickness(
    mesh: Any,
    points: npt.ArrayLike,
    exterior: bool = False,
    normals: Optional[npt.ArrayLike] = None,
    method: str = "max_sphere",
) -> Array:
    """How thick the mesh is at each point, shape (n, 3), of its surface: (n,) float64.

    exterior: how wide the space outside is instead.
    normals: outward normals at the points, shape (n, 3); None: those of the nearest triangles.
    method: "max_sphere" for the diameter of max_tangent_sphere, "ray" for longest_ray along the normal.
    """
    if method == "max_sphere":
        return 2 * max_tangent_sphere(mesh, points, inwards=not exterior, normals=normals)[1]
    if method == "ray":
        outward = _normals_at(_built(mesh), points_of(points, "points"), normals)
        return longest_ray(mesh, points, outward if exterior else -outward)
    raise ValueError(f"method: expected 'max_sphere' or 'ray', found {method!r}")


def _closest(built: CenteredMesh, points: npt.ArrayLike) -> Tuple[Array, Array, Array]:
    nearest = built.nearest(points, slack=_MERGE)
    return nearest.point, nearest.distance, nearest.triangle


def _signed(built: CenteredMesh, points: npt.ArrayLike) -> Array:
    nearest = built.nearest(points)
    distance = nearest.distance.copy()
    off = distance > _MERGE
    over = off & (nearest.triangle >= 0) & (nearest.weights > 0).all(axis=1)
    behind = (built.normals(nearest.triangle[over]) * nearest.offset[over]).sum(axis=1) < 0
    distance[over] *= np.where(behind, 1.0, -1.0)
    at_edge = off & ~over
    if at_edge.any():
        distance[at_edge] *= np.where(built.contains(points_of(points, "points")[at_edge]), 1.0, -1.0)
    return distance


def _normals_at(built: CenteredMesh, points: Array, normals: Optional[npt.ArrayLike]) -> Array:
    if normals is None:
        triangle = built.nearest(points, slack=_MERGE).triangle
        result = np.zeros((len(triangle), 3))
        result[triangle >= 0] = built.normals(triangle[triangle >= 0])
        return result
    given = points_of(normals, "normals")
    if len(given) != len(points):
        raise ValueError(f"expected as many normals as points, found {len(given)} and {len(points)}")
    return given


def _tangent_radii(to: Array, normals: Array) -> Array:
    """Of spheres that touch a plane with these normals at 0 and pass through the points `to`; inf if none do."""
    ahead = (to * normals).sum(axis=-1)
    result = np.full(len(to), np.inf)
    np.divide((to * to).sum(axis=-1), 2 * ahead, out=result, where=ahead > 0)
    return result


def _is_without_embree(mesh: Any) -> bool:
    module = type(getattr(mesh, "ray", None)).__module__
    if module in ("trimesh.ray.ray_triangle", "trimesh.ray.ray_pyembree"):
        return module == "trimesh.ray.ray_triangle"
    return not getattr(sys.modules.get("trimesh.ray"), "has_embree", True)


# What was built of meshes, with the hash that trimesh gave them then: by their ids, and who they were.
_shared: Dict[int, Tuple[Any, Optional[int], CenteredMesh]] = {}


def _built(mesh: Any, asker: Any = None) -> CenteredMesh:
    """What was built of the mesh as it is now. `asker` keeps that of a mesh that cannot be referred to weakly."""
    # trimesh notices when an array changes, and hashes it then; of other arrays all numbers are compared.
    geometry = getattr(sys.modules.get("trimesh.parent"), "Geometry", None)
    state = hash(mesh) if geometry is not None and isinstance(mesh, geometry) else None
    key = id(mesh)
    who, before, built = _shared.get(key) or getattr(asker, "_kept", (None, None, None))
    if isinstance(who, weakref.ref):
        who = who()
    if who is mesh and before == state and (state is not None or built.holds(mesh.vertices, mesh.faces)):
        return built
    built = CenteredMesh(mesh.vertices, mesh.faces)
    try:
        _shared[key] = weakref.ref(mesh, lambda _, shared=_shared: shared.pop(key, None)), state, built
    except TypeError:
        if asker is not None:
            asker._kept = mesh, state, built
    return built
