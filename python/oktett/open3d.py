"""Ray queries with the signatures and conventions of open3d.t.geometry.RaycastingScene.

    from oktett.open3d import RaycastingScene

Arrays may be numpy arrays or whatever has a method `numpy`, such as Open3D's tensors. Answers are numpy arrays.
"""

from typing import Any, Dict

import numpy as np
import numpy.typing as npt

from ._oktett import Scene

__all__ = ["RaycastingScene"]

Array = npt.NDArray[Any]


class RaycastingScene:
    """Triangle meshes to ask with rays and points.

    Rays are float32 of shape {.., 6}: origin and direction, which need not have length 1; distances count in
    its lengths. Points are float32 of shape {.., 3}. A miss has the distance inf, the ids INVALID_ID and zeros
    else. Other shapes raise ValueError.

    nthreads and device are accepted and ignored: oktett.set_threads limits the threads.
    """

    INVALID_ID = 0xFFFFFFFF

    def __init__(self, nthreads: int = 0, device: Any = None) -> None:
        self._scene = Scene()

    def add_triangles(self, vertex_positions: Any, triangle_indices: Any = None) -> int:
        """Adds a mesh and returns its geometry id: 0, 1, ... in order.

        Takes positions (n, 3) and triangles (m, 3), or one mesh: of Open3D, or with `vertices` and `faces`.
        """
        if triangle_indices is None:
            vertex_positions, triangle_indices = _arrays_of(vertex_positions)
        return self._scene.add_mesh(_array(vertex_positions), _array(triangle_indices))

    def cast_rays(self, rays: Any, nthreads: int = 0) -> Dict[str, Array]:
        """The nearest hit of each ray: a dict of

        t_hit              float32 {..}    distance
        geometry_ids       uint32  {..}
        primitive_ids      uint32  {..}    triangle
        primitive_uvs      float32 {.., 2} barycentric weights of its second and third corner
        primitive_normals  float32 {.., 3} of unit length
        """
        hits = self._scene.closest_hit(_array(rays))
        return {
            "t_hit": hits.t,
            "geometry_ids": hits.object,
            "primitive_ids": hits.primitive,
            "primitive_uvs": hits.uv,
            "primitive_normals": hits.normal,
        }

    def test_occlusions(
        self, rays: Any, tnear: float = 0.0, tfar: float = float("inf"), nthreads: int = 0
    ) -> Array:
        """Whether each ray hits anything between tnear and tfar: bool {..}."""
        return self._scene.any_hit(_array(rays), tnear, tfar)

    def count_intersections(self, rays: Any, nthreads: int = 0) -> Array:
        """How many triangles each ray meets: int32 {..}. A shared edge or vertex counts once."""
        return self._scene.count_hits(_array(rays)).astype(np.int32)

    def list_intersections(self, rays: Any, nthreads: int = 0) -> Dict[str, Array]:
        """All hits of all R rays, ray after ray, nearest first: a dict of

        ray_splits      int64   {R + 1}  the hits of ray i are ray_splits[i] to ray_splits[i + 1] - 1
        ray_ids         int64   {h}      the ray of each hit
        t_hit           float32 {h}
        geometry_ids    uint32  {h}
        primitive_ids   uint32  {h}
        primitive_uvs   float32 {h, 2}
        """
        hits = self._scene.all_hits(_array(rays), fields=["t", "object", "primitive", "uv"])
        return {
            "ray_splits": hits.splits,
            "ray_ids": hits.ray_ids,
            "t_hit": hits.t,
            "geometry_ids": hits.object,
            "primitive_ids": hits.primitive,
            "primitive_uvs": hits.uv,
        }

    def compute_closest_points(self, query_points: Any, nthreads: int = 0) -> Dict[str, Array]:
        """The nearest point of all triangles: a dict of

        points             float32 {.., 3}
        geometry_ids       uint32  {..}
        primitive_ids      uint32  {..}    triangle
        primitive_uvs      float32 {.., 2} barycentric weights of its second and third corner
        primitive_normals  float32 {.., 3} of unit length
        """
        nearest = self._scene.closest_point(
            _array(query_points), fields=["point", "object", "primitive", "uv", "normal"]
        )
        return {
            "points": nearest.point,
            "geometry_ids": nearest.object,
            "primitive_ids": nearest.primitive,
            "primitive_uvs": nearest.uv,
            "primitive_normals": nearest.normal,
        }

    def compute_distance(self, query_points: Any, nthreads: int = 0) -> Array:
        """The distance to the nearest triangle: float32 {..}."""
        return self._scene.closest_point(_array(query_points), fields=["distance"]).distance

    def compute_signed_distance(self, query_points: Any, nthreads: int = 0, nsamples: int = 1) -> Array:
        """The same, negative for points inside, see compute_occupancy: float32 {..}."""
        distance = self.compute_distance(query_points)
        return np.where(self._is_inside(_array(query_points)), -distance, distance)

    def compute_occupancy(self, query_points: Any, nthreads: int = 0, nsamples: int = 1) -> Array:
        """1 for points inside of closed meshes, else 0: float32 {..}.

        A ray from a point inside meets the meshes an odd number of times. Edges and vertices count once, so one
        ray is enough; nsamples is accepted and must be odd.
        """
        if nsamples < 1 or nsamples % 2 == 0:
            raise ValueError(f"nsamples: expected an odd number, found {nsamples}")
        return self._is_inside(_array(query_points)).astype(np.float32)

    def _is_inside(self, points: Array) -> Array:
        # One mesh in another is a hole in it, so all meshes count together.
        if points.ndim < 1 or points.shape[-1] != 3:
            raise ValueError(f"query_points: expected numbers of shape (..., 3), found the shape {points.shape}")
        rays = np.empty((*points.shape[:-1], 6), np.float32)
        rays[..., :3], rays[..., 3:] = points, (0.2390512, 0.4395064, 0.8658552)
        return self._scene.count_hits(rays) % 2 == 1

    @staticmethod
    def create_rays_pinhole(*args: Any, **kwargs: Any) -> Array:
        """Rays of a pinhole camera, float32 {height_px, width_px, 6}. Two forms:

        create_rays_pinhole(intrinsic_matrix, extrinsic_matrix, width_px, height_px)
            with a matrix (3, 3) from the camera to pixels and one (4, 4) from the world to the camera;
        create_rays_pinhole(fov_deg, center, eye, up, width_px, height_px)
            with the horizontal field of view in degrees.

        Directions have length 1 along the view axis, so that distances are depths.
        """
        names = set(kwargs)
        if "fov_deg" in names or "eye" in names or len(args) + len(kwargs) == 6:
            return _rays_of_view(*args, **kwargs)
        return _rays_of_matrices(*args, **kwargs)


def _array(value: Any) -> Array:
    return value.numpy() if hasattr(value, "numpy") else np.asarray(value)


def _arrays_of(mesh: Any) -> Any:
    """Positions and triangles of a mesh of Open3D, old or new, or with vertices and faces."""
    if hasattr(mesh, "vertex") and hasattr(mesh, "triangle"):
        positions = mesh.vertex["positions"] if "positions" in mesh.vertex else mesh.vertex["vertices"]
        triangles = mesh.triangle["indices"] if "indices" in mesh.triangle else mesh.triangle["triangles"]
        return positions, triangles
    for faces in ("faces", "triangles"):
        if hasattr(mesh, "vertices") and hasattr(mesh, faces):
            return mesh.vertices, getattr(mesh, faces)
    raise ValueError(f"expected positions and triangles, or a mesh, found {type(mesh).__name__}")


def _matrix(value: Any, name: str, shape: Any) -> Array:
    matrix = _array(value)
    if matrix.shape != shape:
        raise ValueError(f"{name}: expected the shape {shape}, found {matrix.shape}")
    return matrix.astype(np.float64)


def _rays_of_matrices(intrinsic_matrix: Any, extrinsic_matrix: Any, width_px: int, height_px: int) -> Array:
    intrinsic = _matrix(intrinsic_matrix, "intrinsic_matrix", (3, 3))
    extrinsic = _matrix(extrinsic_matrix, "extrinsic_matrix", (4, 4))
    rotation, translation = extrinsic[:3, :3], extrinsic[:3, 3]
    rays = np.empty((height_px, width_px, 6), np.float32)
    rays[:, :, :3] = -rotation.T @ translation
    pixels = np.ones((height_px, width_px, 3))
    pixels[:, :, 0] = np.arange(width_px) + 0.5
    pixels[:, :, 1] = (np.arange(height_px) + 0.5)[:, None]
    rays[:, :, 3:] = pixels @ (rotation.T @ np.linalg.inv(intrinsic)).T
    return rays


def _rays_of_view(
    fov_deg: float, center: Any, eye: Any, up: Any, width_px: int, height_px: int
) -> Array:
    center, eye, up = (
        _matrix(value, name, (3,)) for value, name in ((center, "center"), (eye, "eye"), (up, "up"))
    )
    focal_length = 0.5 * width_px / np.tan(0.5 * np.deg2rad(fov_deg))
    intrinsic = np.array([[focal_length, 0, 0.5 * width_px], [0, focal_length, 0.5 * height_px], [0, 0, 1]])
    rotation = np.empty((3, 3))
    rotation[1] = up / np.linalg.norm(up)
    rotation[2] = (center - eye) / np.linalg.norm(center - eye)
    rotation[0] = np.cross(rotation[1], rotation[2])
    rotation[0] /= np.linalg.norm(rotation[0])
    rotation[1] = np.cross(rotation[2], rotation[0])
    extrinsic = np.eye(4)
    extrinsic[:3, :3] = rotation
    extrinsic[:3, 3] = -rotation @ eye
    return _rays_of_matrices(intrinsic, extrinsic, width_px, height_px)
