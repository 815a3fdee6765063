"""The adapter for users of Open3D: names, shapes, types and values of answers."""

import subprocess
import sys
import types

import numpy as np
import pytest

from oktett.open3d import RaycastingScene
from oracle import CUBE_FACES, CUBE_VERTICES, ball, crossings, random_rays

INVALID = RaycastingScene.INVALID_ID


class Tensor:
    """As much of a tensor as the adapter needs."""

    def __init__(self, array):
        self.array = array

    def numpy(self):
        return self.array


@pytest.fixture
def scene():
    made = RaycastingScene(nthreads=2)
    assert made.add_triangles(CUBE_VERTICES, CUBE_FACES) == 0
    assert made.add_triangles(Tensor(CUBE_VERTICES + np.float32([4, 0, 0])), Tensor(CUBE_FACES)) == 1
    return made


def test_rays_have_the_answers_of_the_oracle(scene):
    vertices = np.concatenate([CUBE_VERTICES, CUBE_VERTICES + np.float32([4, 0, 0])])
    faces = np.concatenate([CUBE_FACES, CUBE_FACES + 8])
    rays = random_rays(2000, 3.0, seed=1).reshape(20, 100, 6)
    answers = scene.cast_rays(Tensor(rays), nthreads=1)
    kinds = {"t_hit": "f4", "geometry_ids": "u4", "primitive_ids": "u4", "primitive_uvs": "f4", "primitive_normals": "f4"}
    assert {name: array.dtype for name, array in answers.items()} == {k: np.dtype(v) for k, v in kinds.items()}
    assert [answers[k].shape for k in kinds] == [(20, 100)] * 3 + [(20, 100, 2), (20, 100, 3)]
    counts = scene.count_intersections(rays)
    assert counts.dtype == np.int32 and counts.shape == (20, 100)
    occluded = scene.test_occlusions(rays)
    assert occluded.dtype == bool and np.array_equal(occluded, counts > 0)
    lists = scene.list_intersections(rays)
    assert list(lists) == ["ray_splits", "ray_ids", "t_hit", "geometry_ids", "primitive_ids", "primitive_uvs"]
    splits = lists["ray_splits"]
    assert splits.shape == (2001,) and splits.dtype == lists["ray_ids"].dtype == np.uint32
    assert splits[-1] == len(lists["t_hit"])
    assert np.array_equal(np.bincount(lists["ray_ids"], minlength=2000), counts.ravel())
    expected, uncertain = crossings(vertices, faces, rays.reshape(-1, 6))
    struck = 0
    for i, wanted in enumerate(expected):
        if uncertain[i]:
            continue
        one = {name: array.reshape(2000, *array.shape[2:])[i] for name, array in answers.items()}
        assert counts.ravel()[i] == len(wanted)
        part = slice(splits[i], splits[i + 1])
        assert lists["t_hit"][part] == pytest.approx([t for t, _, _, _ in wanted], rel=2e-5)
        assert (lists["geometry_ids"][part] * 12 + lists["primitive_ids"][part]).tolist() == [k for _, k, _, _ in wanted]
        if not wanted:
            assert one["t_hit"] == np.inf and one["geometry_ids"] == one["primitive_ids"] == INVALID
            assert not one["primitive_uvs"].any() and not one["primitive_normals"].any()
            continue
        struck += 1
        t, k, u, v = wanted[0]
        assert one["t_hit"] == pytest.approx(t, rel=2e-5)
        assert (one["geometry_ids"], one["primitive_ids"]) == (k // 12, k % 12)
        assert one["primitive_uvs"] == pytest.approx([u, v], abs=2e-5)
        a, b, c = vertices[faces[k]].astype(float)
        assert one["primitive_normals"] == pytest.approx(np.cross(b - a, c - a) / 4, abs=1e-6)
    assert struck > 500


def test_occlusion_is_tested_between_tnear_and_tfar(scene):
    rays = np.float32([[0.1, 0.2, 5, 0, 0, -2]])
    cases = {(0, np.inf): True, (0, 1.9): False, (2.1, 2.9): False, (2.1, 3.1): True, (3.1, 9): False}
    for (near, far), wanted in cases.items():
        assert scene.test_occlusions(rays, tnear=near, tfar=far)[0] == wanted
    assert scene.cast_rays(rays)["t_hit"].tolist() == [2]


def test_meshes_of_other_packages_are_added():
    class Legacy:
        vertices, triangles = CUBE_VERTICES.astype(float), CUBE_FACES.astype(np.int32)

    class New:
        vertex, triangle = {"positions": Tensor(CUBE_VERTICES)}, {"indices": Tensor(CUBE_FACES.astype(np.int64))}

    class Trimesh:
        vertices, faces = CUBE_VERTICES, CUBE_FACES

    ray = np.float32([[0.1, 0.2, 5, 0, 0, -1]])
    for mesh in (Legacy, New, Trimesh):
        made = RaycastingScene()
        assert made.add_triangles(mesh()) == 0 and made.add_triangles(mesh=mesh()) == 1
        assert made.cast_rays(ray)["t_hit"] == [4]
    by_names = RaycastingScene()
    assert by_names.add_triangles(triangle_indices=CUBE_FACES, vertex_positions=CUBE_VERTICES) == 0
    assert by_names.cast_rays(rays=ray, nthreads=0)["t_hit"] == [4]
    with pytest.raises(ValueError, match="expected positions and triangles, or a mesh, found int"):
        RaycastingScene().add_triangles(3)
    with pytest.raises(ValueError, match="expected positions and triangles, or a mesh, found NoneType"):
        RaycastingScene().add_triangles()
    with pytest.raises(TypeError, match="found both"):
        RaycastingScene().add_triangles(CUBE_VERTICES, CUBE_FACES, mesh=Legacy())


def test_a_tnear_below_zero_counts_as_zero(scene):
    behind, ahead = np.float32([[0.1, 0.2, -5, 0, 0, -1]]), np.float32([[0.1, 0.2, 5, 0, 0, -1]])
    assert not scene.test_occlusions(behind, tnear=-100)[0] and scene.test_occlusions(ahead, tnear=-1e30)[0]
    assert not scene.test_occlusions(ahead, tnear=-9, tfar=-1)[0]
    assert not scene.test_occlusions(ahead, tnear=float("nan"))[0]


def test_answers_to_arrays_are_arrays_that_have_a_tensors_methods(scene):
    points = np.zeros((4, 3), np.float32)
    rays = RaycastingScene.create_rays_pinhole(60, [0, 0, 0], [0, 0, 5], [0, 1, 0], 4, 3)
    answers = [rays, scene.test_occlusions(rays), scene.count_intersections(rays), scene.compute_distance(points)]
    answers += [scene.compute_occupancy(points), scene.compute_signed_distance(points)]
    for made in (scene.cast_rays(rays), scene.list_intersections(rays), scene.compute_closest_points(points)):
        answers += made.values()
    for answer in answers:
        assert isinstance(answer, np.ndarray) and type(answer.cpu().numpy()) is np.ndarray
        assert np.array_equal(answer.numpy(), answer) and np.shares_memory(answer.numpy(), answer)


def test_a_single_ray_or_point_has_a_single_answer(scene):
    ray, point = np.float32([0.1, 0.2, 5, 0, 0, -1]), np.float32([0, 0, 0.5])
    assert scene.cast_rays(ray)["t_hit"].numpy() == 4 and scene.count_intersections(ray).numpy() == 2
    assert scene.test_occlusions(ray).cpu().shape == scene.compute_occupancy(point).cpu().shape == ()
    assert scene.compute_signed_distance(point).numpy() == -0.5 and scene.compute_distance(point).numpy() == 0.5
    assert scene.list_intersections(ray)["ray_splits"].tolist() == [0, 2]


def test_even_numbers_of_samples_are_refused(scene):
    points = np.zeros((1, 3), np.float32)
    for query in (scene.compute_occupancy, scene.compute_signed_distance):
        assert query(points, nsamples=3) == query(points, 0, 1)
        for nsamples in (2, 0, -1):
            with pytest.raises(ValueError, match=f"nsamples: expected an odd number, found {nsamples}"):
                query(points, nsamples=nsamples)


def test_only_the_cpu_is_a_device():
    for device in (None, "CPU:0", "cpu"):
        RaycastingScene(0, device)
    with pytest.raises(ValueError, match="device: expected the CPU, found CUDA:0"):
        RaycastingScene(device="CUDA:0")


def test_open3d_is_not_imported():
    code = """
import sys, numpy as np, oktett.open3d as o
s = o.RaycastingScene()
s.add_triangles(np.eye(3, dtype=np.float32), np.uint32([[0, 1, 2]]))
s.cast_rays(s.create_rays_pinhole(60, [0, 0, 0], [2, 2, 2], [0, 0, 1], 4, 4))
assert "open3d" not in sys.modules
"""
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_what_is_given_decides_what_answers_are(monkeypatch):
    """With a module that stands for Open3D: a tensor in the scene or in the query gives tensors."""

    class Tensor:
        def __init__(self, array):
            self.array = array

        from_numpy = classmethod(lambda cls, array: cls(array))

        def cpu(self):
            return Tensor(self.array)

        def numpy(self):
            return self.array

    class Device:
        def __str__(self):
            return "CPU:0"

    for kind in (Tensor, Device):
        kind.__module__ = "open3d.cpu.pybind.core"
    monkeypatch.setitem(sys.modules, "open3d", types.SimpleNamespace(core=types.SimpleNamespace(Tensor=Tensor)))
    rays, points = np.ones((2, 6), np.float32), np.ones((2, 3), np.float32)

    def kinds(scene, given):
        answers = [scene.test_occlusions(given(rays)), scene.count_intersections(given(rays))]
        answers += [scene.compute_distance(given(points)), scene.compute_signed_distance(given(points))]
        answers.append(scene.compute_occupancy(given(points)))
        for made in (scene.cast_rays(given(rays)), scene.list_intersections(given(rays)), scene.compute_closest_points(given(points))):
            answers += made.values()
        return {isinstance(answer, Tensor) for answer in answers}

    plain, filled, placed = RaycastingScene(), RaycastingScene(), RaycastingScene(device=Device())
    plain.add_triangles(CUBE_VERTICES, CUBE_FACES)
    filled.add_triangles(CUBE_VERTICES, Tensor(CUBE_FACES))
    assert kinds(plain, Tensor) == kinds(filled, np.asarray) == kinds(placed, np.asarray) == {True}
    assert kinds(plain, np.asarray) == {False}
    view = ([0, 0, 0], [0, 0, 5], [0, 1, 0])
    assert isinstance(RaycastingScene.create_rays_pinhole(60, Tensor(np.zeros(3)), *view[1:], 2, 2), Tensor)
    assert isinstance(RaycastingScene.create_rays_pinhole(60, *view, 2, 2), np.ndarray)
    assert isinstance(RaycastingScene.create_rays_pinhole(intrinsic_matrix=Tensor(np.eye(3)), extrinsic_matrix=np.eye(4), width_px=2, height_px=2), Tensor)


def test_an_empty_scene_has_no_hits():
    answers = RaycastingScene().cast_rays(np.ones((2, 3, 6), np.float32))
    assert (answers["geometry_ids"] == INVALID).all() and np.isinf(answers["t_hit"]).all()


def test_other_shapes_are_refused(scene):
    for query in (scene.cast_rays, scene.test_occlusions, scene.count_intersections, scene.list_intersections):
        with pytest.raises(ValueError, match=r"\(\.\.\., 6\), found the shape \(3, 5\)"):
            query(np.zeros((3, 5), np.float32))


def test_pinhole_rays_pass_the_pixels_of_their_matrices():
    intrinsic = np.array([[100, 0, 8.5], [0, 120, 6], [0, 0, 1]])
    angle = 0.7
    rotation = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    extrinsic = np.eye(4)
    extrinsic[:3, :3], extrinsic[:3, 3] = rotation, [1, 2, 3]
    rays = RaycastingScene.create_rays_pinhole(Tensor(intrinsic), extrinsic, 17, 12)
    assert rays.shape == (12, 17, 6) and rays.dtype == np.float32
    # Projected by the matrices, a point of the ray of a pixel is its middle.
    points = rays[..., :3] + 3.7 * rays[..., 3:].astype(float)
    camera = points @ rotation.T + [1, 2, 3]
    assert camera[..., 2] == pytest.approx(3.7, abs=1e-5)
    pixels = camera @ intrinsic.T / camera[..., 2:]
    assert pixels[..., 0] == pytest.approx(np.tile(np.arange(17) + 0.5, (12, 1)), abs=1e-3)
    assert pixels[..., 1] == pytest.approx(np.tile((np.arange(12) + 0.5)[:, None], (1, 17)), abs=1e-3)
    assert (rays[..., :3] == rays[0, 0, :3]).all()


def test_pinhole_rays_of_a_view_span_its_angle():
    # These numbers are Open3D's 0.16.1: the up direction counts as that of growing rows.
    rays = RaycastingScene.create_rays_pinhole(
        fov_deg=90, center=[0, 0, 0], eye=[0, 0, 5], up=[0, 1, 0], width_px=4, height_px=2
    )
    assert (rays[..., :3] == [0, 0, 5]).all()
    assert rays[0, :, 3:] == pytest.approx(np.array([[x, -0.25, -1] for x in (0.75, 0.25, -0.25, -0.75)]), abs=1e-6)
    assert rays[1, :, 3:] == pytest.approx(np.array([[x, 0.25, -1] for x in (0.75, 0.25, -0.25, -0.75)]), abs=1e-6)
    tilted = RaycastingScene.create_rays_pinhole(60, [1, 0, 0], [1, 2, 3], [0, 5, 0], 101, 51)
    middle = tilted[25, 50, 3:]
    assert middle == pytest.approx(np.array([0, -2, -3]) / np.sqrt(13), abs=1e-6)
    left, right = tilted[25, 0, 3:].astype(float), tilted[25, 100, 3:].astype(float)
    angle = np.degrees(np.arccos(left @ right / np.linalg.norm(left) / np.linalg.norm(right)))
    assert angle == pytest.approx(60, abs=0.7)
    with pytest.raises(ValueError, match="intrinsic_matrix"):
        RaycastingScene.create_rays_pinhole(np.eye(4), np.eye(4), 4, 2)


class TestBesideOpen3d:
    """Where Open3D is installed its tensors and meshes are given, and its own answers compared."""

    @pytest.fixture(autouse=True)
    def has_open3d(self):
        self.open3d = pytest.importorskip("open3d", reason="Open3D is not installed")
        self.theirs = self.open3d.t.geometry.RaycastingScene
        self.tensor = self.open3d.core.Tensor

    def test_cameras_are_the_same(self):
        for arguments in ((60, [1, 0, 0.5], [1, 2, 3], [0.1, 5, 0], 31, 21), (np.diag([9.0, 8, 1]), np.eye(4), 5, 4)):
            tensors = [self.tensor(np.asarray(a, float)) if np.ndim(a) else a for a in arguments]
            wanted = self.theirs.create_rays_pinhole(*tensors).numpy()
            assert RaycastingScene.create_rays_pinhole(*arguments) == pytest.approx(wanted, abs=1e-6)
            made = RaycastingScene.create_rays_pinhole(*tensors)
            assert isinstance(made, self.tensor) and made.numpy() == pytest.approx(wanted, abs=1e-6)

    def test_answers_to_tensors_are_tensors_of_the_same_types_and_shapes(self):
        vertices, faces = ball(2)
        rays, points = random_rays(400, 1.0, seed=3).reshape(2, 200, 6), random_rays(300, 1.0, seed=4)[:, :3].copy()
        mine, theirs = RaycastingScene(), self.theirs()
        for scene in (mine, theirs):
            assert scene.add_triangles(self.tensor(vertices), self.tensor(faces)) == 0
        for name in ("cast_rays", "test_occlusions", "count_intersections", "list_intersections"):
            self.compare(getattr(mine, name), getattr(theirs, name, None), rays)
        for name in ("compute_closest_points", "compute_distance", "compute_signed_distance", "compute_occupancy"):
            self.compare(getattr(mine, name), getattr(theirs, name), points)

    def compare(self, mine, theirs, given):
        answers = [mine(self.tensor(given)), mine(given)]
        if theirs is not None:
            answers.append(theirs(self.tensor(given)))
        described = []
        for answer in answers:
            parts = answer if isinstance(answer, dict) else {"": answer}
            assert all(isinstance(part, self.tensor) for part in parts.values())
            # Which hits a ray has is compared elsewhere: here their number would hide the types.
            described.append({key: (str(part.dtype), len(part.shape)) for key, part in parts.items()})
        assert all(other == described[0] for other in described)

    def test_tensors_share_the_memory_of_answers_that_are_gone(self):
        scene = RaycastingScene()
        scene.add_triangles(self.tensor(CUBE_VERTICES), self.tensor(CUBE_FACES))
        hits = [scene.cast_rays(np.float32([[0.1, 0.2, 5 + k, 0, 0, -1]] * 1000))["t_hit"] for k in range(20)]
        assert [hit.numpy().tolist() for hit in hits] == [[4.0 + k] * 1000 for k in range(20)]
        assert scene.cast_rays(np.zeros((0, 6)))["primitive_uvs"].numpy().shape == (0, 2)
        assert scene.compute_signed_distance(self.tensor(np.float32([0, 0, 0.5]))).item() == -0.5

    def test_its_meshes_are_added(self):
        legacy = self.open3d.geometry.TriangleMesh.create_box()
        new = self.open3d.t.geometry.TriangleMesh.from_legacy(legacy)
        for mesh in (legacy, new):
            scene = RaycastingScene()
            assert scene.add_triangles(mesh) == 0 and scene.add_triangles(mesh=mesh) == 1
            found = scene.count_intersections(np.float32([[0.4, 0.3, -1, 0, 0, 1]]))
            assert isinstance(found, self.tensor) and found.numpy().tolist() == [4]
        empty = RaycastingScene()
        assert empty.add_triangles(self.open3d.t.geometry.TriangleMesh()) == 0
        assert np.isinf(empty.compute_distance(np.float32([[0, 0, 0]])).numpy()).all()
