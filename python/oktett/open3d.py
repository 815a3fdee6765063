"""Ray and point queries with the signatures and conventions of open3d.t.geometry.RaycastingScene.

    from oktett.open3d import RaycastingScene

Arrays may be Open3D's tensors, numpy arrays, or what becomes one. Where anything of Open3D's is given, to the scene
before or to a query now, answers are Open3D's tensors. Else they are numpy arrays, with tensors' methods numpy and
cpu, so that code which was written for tensors runs. Open3D is imported only if something of it is given.
"""

import sys
from typing import Any, Dict

import numpy as np
import numpy.typing as npt

from ._oktett import Scene

__all__ = ["Array", "RaycastingScene"]

Numbers = npt.NDArray[Any]
Answer = Any  # an open3d.core.Tensor or an Array


class Array(np.ndarray):
    """A numpy array which has those methods of Open3D's tensors that read it."""

    def numpy(self) -> Numbers:
        """The same memory as a plain numpy array."""
        return self.view(np.ndarray)

    def cpu(self) -> "Array":
        """The array itself."""
        return self


class RaycastingScene:
    """Triangle meshes to ask with rays and points.

    Rays are of shape {.., 6}: origin and direction, which need not have length 1; distances count in its
    lengths. Points are of shape {.., 3}. Both are float32; other numbers are converted. Where the scene has an
    origin (Scene.origin), float64 is rounded after it is taken off, and points that come back are float64. A miss
    has the distance inf, the ids INVALID_ID and zeros else. Other shapes raise ValueError.

    nthreads is accepted and ignored: oktett.set_threads limits the threads.
    device: only the CPU; others raise ValueError. If it is an open3d.core.Device, answers are tensors.
    """

    INVALID_ID = 0xFFFFFFFF

    def __init__(self, nthreads: int = 0, device: Any = None) -> None:
        if device is not None and not str(device).upper().startswith("CPU"):
            raise ValueError(f"device: expected the CPU, found {device}")
        self._scene = Scene()
        self._has_tensors = _is_open3d(device)

    def add_triangles(self, vertex_positions: Any = None, triangle_indices: Any = None, *, mesh: Any = None) -> int:
        """Adds a mesh and returns its geometry id: 0, 1, ... in order.

        Takes positions (n, 3) and triangles (m, 3), or one mesh, by its place or as `mesh`: of Open3D, or with
        `vertices` and `faces`.
        """
        if mesh is not None:
            if vertex_positions is not None or triangle_indices is not None:
                raise TypeError("add_triangles: expected positions and triangles, or a mesh, found both")
            vertex_positions = mesh
        has_tensors = _is_open3d(vertex_positions) or _is_open3d(triangle_indices)
        if triangle_indices is None:
            vertex_positions, triangle_indices = _arrays_of(vertex_positions)
        number = self._scene.add_mesh(_array(vertex_positions), _array(triangle_indices))
        self._has_tensors |= has_tensors
        return number

    def cast_rays(self, rays: Any, nthreads: int = 0) -> Dict[str, Answer]:
        """The nearest hit of each ray: a dict of

        t_hit              float32 {..}    distance
        geometry_ids       uint32  {..}
        primitive_ids      uint32  {..}    triangle
        primitive_uvs      float32 {.., 2} barycentric weights of its second and third corner
        primitive_normals  float32 {.., 3} of unit length
        """
        hits = self._scene.closest_hit(_array(rays))
        return self._answers(
            rays,
            t_hit=hits.t,
            geometry_ids=hits.object,
            primitive_ids=hits.primitive,
            primitive_uvs=hits.uv,
            primitive_normals=hits.normal,
        )

    def test_occlusions(
        self, rays: Any, tnear: float = 0.0, tfar: float = float("inf"), nthreads: int = 0
    ) -> Answer:
        """Whether each ray hits anything between tnear and tfar: bool {..}. A tnear below 0 counts as 0."""
        return self._answer(rays, self._scene.any_hit(_array(rays), np.maximum(tnear, 0.0), tfar))

    def count_intersections(self, rays: Any, nthreads: int = 0) -> Answer:
        """How many triangles each ray meets: int32 {..}. A shared edge or vertex counts once."""
        return self._answer(rays, self._scene.count_hits(_array(rays)).astype(np.int32))

    def list_intersections(self, rays: Any, nthreads: int = 0) -> Dict[str, Answer]:
        """All hits of all R rays, ray after ray, nearest first: a dict of

        ray_splits      uint32  {R + 1}  the hits of ray i are ray_splits[i] to ray_splits[i + 1] - 1
        ray_ids         uint32  {h}      the ray of each hit
        t_hit           float32 {h}
        geometry_ids    uint32  {h}
        primitive_ids   uint32  {h}
        primitive_uvs   float32 {h, 2}
        """
        hits = self._scene.all_hits(_array(rays), fields=["t", "object", "primitive", "uv"])
        return self._answers(
            rays,
            ray_splits=hits.splits.astype(np.uint32),
            ray_ids=hits.ray_ids.astype(np.uint32),
            t_hit=hits.t,
            geometry_ids=hits.object,
            primitive_ids=hits.primitive,
            primitive_uvs=hits.uv,
        )

    def compute_closest_points(self, query_points: Any, nthreads: int = 0) -> Dict[str, Answer]:
        """The nearest point of all triangles: a dict of

        points             float32 {.., 3} the nearest point; float64 if the scene has an origin
        geometry_ids       uint32  {..}
        primitive_ids      uint32  {..}    triangle
        primitive_uvs      float32 {.., 2} barycentric weights of its second and third corner
        primitive_normals  float32 {.., 3} of unit length
        """
        nearest = self._scene.closest_point(
            _array(query_points), fields=["point", "object", "primitive", "uv", "normal"]
        )
        return self._answers(
            query_points,
            points=nearest.point,
            geometry_ids=nearest.object,
            primitive_ids=nearest.primitive,
            primitive_uvs=nearest.uv,
            primitive_normals=nearest.normal,
        )

    def compute_distance(self, query_points: Any, nthreads: int = 0) -> Answer:
        """The distance to the nearest triangle: float32 {..}; inf if there is none."""
        return self._answer(query_points, self._distance(_array(query_points)))

    def compute_signed_distance(self, query_points: Any, nthreads: int = 0, nsamples: int = 1) -> Answer:
        """The same, negative for points inside, see compute_occupancy: float32 {..}."""
        points = _array(query_points)
        inside = self._is_inside(points, nsamples)
        distance = self._distance(points)
        return self._answer(query_points, np.where(inside, -distance, distance))

    def compute_occupancy(self, query_points: Any, nthreads: int = 0, nsamples: int = 1) -> Answer:
        """1 for points inside of closed meshes, else 0: float32 {..}.

        A ray from a point inside meets the meshes an odd number of times. Edges and vertices count once, so one
        ray is enough; nsamples is accepted, and must be odd.
        """
        inside = self._is_inside(_array(query_points), nsamples)
        return self._answer(query_points, inside.astype(np.float32))

    def _distance(self, points: Numbers) -> Numbers:
        return self._scene.closest_point(points, fields=["distance"]).distance

    def _is_inside(self, points: Numbers, nsamples: int) -> Numbers:
        if nsamples < 1 or nsamples % 2 == 0:
            raise ValueError(f"nsamples: expected an odd number, found {nsamples}")
        # One mesh in another is a hole in it, so all meshes count together.
        if points.ndim < 1 or points.shape[-1] != 3:
            raise ValueError(f"query_points: expected numbers of shape (..., 3), found the shape {points.shape}")
        rays = np.empty((*points.shape[:-1], 6), np.float32 if points.dtype == np.float32 else np.float64)
        rays[..., :3], rays[..., 3:] = points, (0.2390512, 0.4395064, 0.8658552)
        return self._scene.count_hits(rays) % 2 == 1

    def _answer(self, asked: Any, array: Numbers) -> Answer:
        return _answer(array, self._has_tensors or _is_open3d(asked))

    def _answers(self, asked: Any, **arrays: Numbers) -> Dict[str, Answer]:
        return {name: self._answer(asked, array) for name, array in arrays.items()}

    @staticmethod
    def create_rays_pinhole(*args: Any, **kwargs: Any) -> Answer:
        """Rays of a pinhole camera, float32 {height_px, width_px, 6}; float64 if float32 moved the eye by 0.001.
        Two forms:

        create_rays_pinhole(intrinsic_matrix, extrinsic_matrix, width_px, height_px)
            with a matrix (3, 3) from the camera to pixels and one (4, 4) from the world to the camera;
        create_rays_pinhole(fov_deg, center, eye, up, width_px, height_px)
            with the horizontal field of view in degrees.

        Directions have length 1 along the view axis, so that distances are depths. The rays are a tensor if one
        of the arguments is.
        """
        names = set(kwargs)
        is_view = "fov_deg" in names or "eye" in names or len(args) + len(kwargs) == 6
        rays = _rays_of_view(*args, **kwargs) if is_view else _rays_of_matrices(*args, **kwargs)
        return _answer(rays, any(map(_is_open3d, (*args, *kwargs.values()))))


def _is_open3d(value: Any) -> bool:
    return type(value).__module__.partition(".")[0] == "open3d"


def _answer(array: Numbers, as_tensor: bool) -> Answer:
    # Operations with arrays of no dimensions give scalars.
    array = np.asarray(array)
    if not as_tensor:
        return array.view(Array)
    # Who gave something of Open3D's has imported it. The tensor shares the memory.
    return sys.modules["open3d"].core.Tensor.from_numpy(array)


def _array(value: Any) -> Numbers:
    """`value` in memory of the CPU."""
    if isinstance(value, np.ndarray):
        return value
    if hasattr(value, "cpu"):
        value = value.cpu()
    return value.numpy() if hasattr(value, "numpy") else np.asarray(value)


def _arrays_of(mesh: Any) -> Any:
    """Positions and triangles of a mesh of Open3D, old or new, or with vertices and faces."""
    if hasattr(mesh, "vertex") and hasattr(mesh, "triangle"):
        # A mesh that was just made has none.
        if _is_open3d(mesh) and len(mesh.triangle) == 0:
            return np.zeros((0, 3), np.float32), np.zeros((0, 3), np.uint32)
        positions = mesh.vertex["positions"] if "positions" in mesh.vertex else mesh.vertex["vertices"]
        triangles = mesh.triangle["indices"] if "indices" in mesh.triangle else mesh.triangle["triangles"]
        return positions, triangles
    for faces in ("faces", "triangles"):
        if hasattr(mesh, "vertices") and hasattr(mesh, faces):
            return mesh.vertices, getattr(mesh, faces)
    raise ValueError(f"expected positions and triangles, or a mesh, found {type(mesh).__name__}")


def _matrix(value: Any, name: str, shape: Any) -> Numbers:
    matrix = _array(value)
    if matrix.shape != shape:
        raise ValueError(f"{name}: expected the shape {shape}, found {matrix.shape}")
    return matrix.astype(np.float64)


def _rays_of_matrices(intrinsic_matrix: Any, extrinsic_matrix: Any, width_px: int, height_px: int) -> Numbers:
    intrinsic = _matrix(intrinsic_matrix, "intrinsic_matrix", (3, 3))
    extrinsic = _matrix(extrinsic_matrix, "extrinsic_matrix", (4, 4))
    rotation, translation = extrinsic[:3, :3], extrinsic[:3, 3]
    eye = -rotation.T @ translation
    moved = np.abs(eye.astype(np.float32) - eye).max()
    rays = np.empty((height_px, width_px, 6), np.float32 if moved < 0.001 else np.float64)
    rays[:, :, :3] = eye
    pixels = np.ones((height_px, width_px, 3))
    pixels[:, :, 0] = np.arange(width_px) + 0.5
    pixels[:, :, 1] = (np.arange(height_px) + 0.5)[:, None]
    rays[:, :, 3:] = pixels @ (rotation.T @ np.linalg.inv(intrinsic)).T
    return rays


def _rays_of_view(
    fov_deg: float, center: Any, eye: Any, up: Any, width_px: int, height_px: int
) -> Numbers:
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
