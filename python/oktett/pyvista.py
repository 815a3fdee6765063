"""Queries of PyVista's datasets and surfaces with its signatures, results and errors.

    import oktett.pyvista
    points, rays, cells = oktett.pyvista.multi_ray_trace(surface, origins, directions)

As methods of PyVista's classes they take the place of its own:

    pyvista.PolyData.multi_ray_trace = oktett.pyvista.multi_ray_trace
    pyvista.DataSet.select_enclosed_points = oktett.pyvista.select_enclosed_points
    pyvista.DataSet.compute_implicit_distance = oktett.pyvista.compute_implicit_distance
"""

from typing import Any, Tuple

import numpy as np
import numpy.typing as npt

from ._mesh import CenteredMesh

__all__ = ["compute_implicit_distance", "multi_ray_trace", "select_enclosed_points"]

Array = npt.NDArray[Any]


def multi_ray_trace(
    surface: Any,
    origins: npt.ArrayLike,
    directions: npt.ArrayLike,
    first_point: bool = False,
    retry: bool = False,
) -> Tuple[Array, Array, Array]:
    """Where rays meet a surface, a pyvista.PolyData of triangles.

    origins, directions: shape (n, 3); directions need not have length 1.
    first_point: only the nearest point of each ray.
    retry: accepted and ignored; no ray that meets the surface is missed.

    Returns intersection_points (h, 3) float64, intersection_rays (h,) and intersection_cells (h,) int64, ray
    after ray, nearest first. An edge or vertex that triangles share counts once. Raises NotAllTrianglesError of
    PyVista for cells that are no triangles, and ValueError for other shapes of arrays.
    """
    if not surface.is_all_triangles:
        from pyvista.core.errors import NotAllTrianglesError

        raise NotAllTrianglesError("multi_ray_trace: expected a surface of triangles")
    hits = _mesh_of(surface).hits(origins, directions, multiple=not first_point)
    return hits.location, hits.ray, hits.triangle


def select_enclosed_points(
    dataset: Any,
    surface: Any,
    tolerance: float = 0.001,
    inside_out: bool = False,
    check_surface: bool = True,
    progress_bar: bool = False,
) -> Any:
    """Which points of a dataset are inside of a closed surface, a pyvista.PolyData.

    tolerance, progress_bar: accepted and ignored; rays are counted without a tolerance. Points nearer to the
        surface than float32 rounds, about 1e-7 of its size, may count as either.
    inside_out: selects the points outside instead.
    check_surface: raises RuntimeError if the surface has open edges. If it has and this is False, most of
        several rays decide.

    Returns a copy of the dataset with the point data 'SelectedPoints', uint8: 1 for those selected. Raises
    TypeError if the surface is no pyvista.PolyData.
    """
    _check_surface(surface)
    if check_surface and surface.n_open_edges > 0:
        raise RuntimeError("surface: expected a closed one, found open edges; check_surface=False accepts it")
    inside = _mesh_of(surface).contains(dataset.points)
    result = dataset.copy()
    result.point_data["SelectedPoints"] = (inside != bool(inside_out)).astype(np.uint8)
    return result


def compute_implicit_distance(dataset: Any, surface: Any, inplace: bool = False) -> Any:
    """The distance of each point of a dataset to a surface, a pyvista.PolyData: negative inside or behind it.

    inplace: changes the dataset and returns it, else a copy.

    The result has the point data 'implicit_distance', float64. What is behind is told by normals, by the order
    of corners; at edges and vertices by sums of the normals around them. Raises TypeError if the surface is no
    pyvista.PolyData, and ValueError if it has no faces.
    """
    _check_surface(surface)
    mesh = _mesh_of(surface)
    if len(mesh.faces) == 0:
        raise ValueError("surface: expected faces, found none")
    nearest = mesh.nearest(dataset.points)
    result = dataset if inplace else dataset.copy()
    result.point_data["implicit_distance"] = np.where(
        mesh.is_behind(nearest), -nearest.distance, nearest.distance
    )
    return result


def _check_surface(surface: Any) -> None:
    import pyvista

    if not isinstance(surface, pyvista.PolyData):
        raise TypeError(f"surface: expected a pyvista.PolyData, found {type(surface).__name__}")


def _mesh_of(surface: Any) -> CenteredMesh:
    """The surface in triangles."""
    if not surface.is_all_triangles:
        surface = surface.triangulate()
    return CenteredMesh(surface.points, surface.faces.reshape(-1, 4)[:, 1:])
