"""Queries with points against oracles."""

import numpy as np
import pytest

import oktett
from oktett.open3d import RaycastingScene
from oracle import CUBE_FACES, CUBE_VERTICES, ball, nearest_on_triangles

MISS = 0xFFFFFFFF
FIELDS = ["distance", "point", "object", "primitive", "instance", "uv", "normal"]


@pytest.fixture
def points():
    return np.random.default_rng(1).uniform(-2, 2, (1500, 3)).astype(np.float32)


@pytest.mark.parametrize("mesh", [(CUBE_VERTICES, CUBE_FACES), ball(2)], ids=["cube", "ball"])
def test_nearest_points_are_those_of_the_oracle(mesh, points):
    vertices, faces = mesh
    scene = oktett.Scene(vertices, faces)
    found = scene.closest_point(points, fields=FIELDS)
    distance, place = nearest_on_triangles(vertices, faces, points.astype(float))
    assert found.distance == pytest.approx(distance, abs=2e-6)
    # Inside, several points may be equally near.
    outside = ~scene.inside(points)
    assert found.point[outside] == pytest.approx(place[outside], abs=3e-5)
    a, b, c = (vertices[faces[found.primitive]][:, k].astype(float) for k in range(3))
    u, v = found.uv.T[:, :, None]
    assert found.point == pytest.approx(a * (1 - u - v) + b * u + c * v, abs=2e-6)
    normal = np.cross(b - a, c - a)
    assert found.normal == pytest.approx(normal / np.linalg.norm(normal, axis=1)[:, None], abs=1e-6)
    assert (found.object == 0).all() and (found.instance == MISS).all()
    signed = scene.signed_distance(points)
    assert np.array_equal(np.abs(signed), found.distance) and np.array_equal(signed < 0, ~outside)
    if len(faces) == 12:
        assert np.array_equal(outside, ~(np.abs(points) < 1).all(axis=1))
    grid = scene.closest_point(points.reshape(30, 50, 3).astype(float))
    assert grid.point.shape == (30, 50, 3) and np.array_equal(grid.distance.ravel(), found.distance)
    assert scene.closest_point(points[3]).distance == found.distance[3]


def test_exact_surfaces_answer_by_their_formulas(points):
    scene = oktett.Scene.from_dict(
        {
            "define": {"ball": {"sphere": {"radius": 0.5}}},
            "objects": [
                {"sphere": {"center": [1, 0, 0], "radius": 0.7}},
                {"instance": "ball", "transform": [{"translate": [-1, 0, 0]}]},
            ],
        }
    )
    distances = np.stack([np.linalg.norm(points - [x, 0, 0], axis=1) - r for x, r in ((1, 0.7), (-1, 0.5))])
    found = scene.closest_point(points, fields=FIELDS)
    assert found.distance == pytest.approx(np.abs(distances).min(axis=0), abs=2e-6)
    assert np.array_equal(found.instance == MISS, np.abs(distances[0]) < np.abs(distances[1]))
    assert scene.signed_distance(points) == pytest.approx(
        np.where((distances < 0).any(axis=0), -1, 1) * np.abs(distances).min(axis=0), abs=2e-6
    )
    assert not found.uv.any()
    combination = oktett.Scene.from_dict({"objects": [{"difference": [{"box": {}}, {"sphere": {"radius": 1.2}}]}]})
    inside = (np.abs(points) < 1).all(axis=1) & (np.linalg.norm(points, axis=1) > 1.2)
    assert np.array_equal(combination.inside(points), inside)
    for query in (combination.closest_point, combination.signed_distance):
        with pytest.raises(ValueError):
            query(points)


def test_misses_and_other_shapes(points):
    nothing = oktett.Scene()
    found = nothing.closest_point(points[:5], fields=FIELDS)
    assert np.isinf(found.distance).all() and (found.object == MISS).all() and (found.instance == MISS).all()
    assert not found.point.any() and not found.normal.any() and not nothing.inside(points).any()
    scene = oktett.Scene(CUBE_VERTICES, CUBE_FACES)
    bad = scene.closest_point([[np.nan, 0, 0], [np.inf, 0, 0], [0, 0, 3]])
    assert bad.distance.tolist() == [np.inf, np.inf, 2] and bad.primitive[0] == MISS
    assert scene.inside([[np.nan, 0, 0], [0, 0, 0]]).tolist() == [False, True]
    assert scene.closest_point(np.zeros((0, 3))).point.shape == (0, 3)
    assert scene.signed_distance(np.zeros((2, 0, 3))).shape == (2, 0)
    for query in (scene.closest_point, scene.inside, scene.signed_distance):
        with pytest.raises(ValueError, match=r"points: expected .* \(\.\.\., 3\), found the shape \(3, 6\)"):
            query(np.zeros((3, 6)))
    with pytest.raises(ValueError, match="fields: there is no field 't'; expected distance, point"):
        scene.closest_point(points, fields=["t"])


def test_open3d_has_the_same_by_its_names(points):
    vertices, faces = ball(2)
    scene = RaycastingScene()
    scene.add_triangles(vertices, faces)
    # A hole in the ball: in Open3D all meshes count together.
    assert scene.add_triangles(CUBE_VERTICES * np.float32(0.3), CUBE_FACES) == 1
    all_vertices = np.concatenate([vertices, CUBE_VERTICES * np.float32(0.3)])
    all_faces = np.concatenate([faces, CUBE_FACES + len(vertices)])
    distance, _ = nearest_on_triangles(all_vertices, all_faces, points.astype(float))
    found = scene.compute_closest_points(points)
    assert list(found) == ["points", "geometry_ids", "primitive_ids", "primitive_uvs", "primitive_normals"]
    assert np.linalg.norm(found["points"] - points, axis=1) == pytest.approx(distance, abs=2e-6)
    near = np.where(found["geometry_ids"] == 0, 0, len(faces)) + found["primitive_ids"]
    a, b, c = (all_vertices[all_faces[near]][:, k] for k in range(3))
    u, v = found["primitive_uvs"].T[:, :, None]
    assert found["points"] == pytest.approx(a * (1 - u - v) + b * u + c * v, abs=2e-6)
    assert scene.compute_distance(points) == pytest.approx(distance, abs=2e-6)
    in_ball = oktett.Scene(vertices, faces).inside(points)
    inside = in_ball & ~(np.abs(points) < 0.3).all(axis=1)
    assert np.array_equal(scene.compute_occupancy(points), inside.astype(np.float32))
    assert scene.compute_occupancy(points, nsamples=3).dtype == np.float32
    signed = scene.compute_signed_distance(points.reshape(30, 50, 3))
    assert signed.dtype == np.float32 and np.array_equal(signed.ravel() < 0, inside)
    assert np.abs(signed).ravel() == pytest.approx(distance, abs=2e-6)
    with pytest.raises(ValueError, match="nsamples"):
        scene.compute_occupancy(points, nsamples=2)
    for query in (scene.compute_closest_points, scene.compute_distance, scene.compute_signed_distance, scene.compute_occupancy):
        with pytest.raises(ValueError, match=r"\(\.\.\., 3\)"):
            query(np.zeros((4, 2)))


def solid_angles(vertices, faces, points):
    """The winding number of each point, in float64 (van Oosterom and Strackee 1983)."""
    turns = np.zeros(len(points))
    for face in faces:
        a, b, c = (vertices[k].astype(float) - points for k in face)
        la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        x = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
        turns += np.arctan2((a * np.cross(b, c)).sum(1), x) / (2 * np.pi)
    return turns


def test_winding_numbers_of_open_and_damaged_meshes(points):
    vertices, faces = ball(2)
    random = np.random.default_rng(4)
    broken = faces[random.random(len(faces)) > 0.15]
    broken = np.concatenate([broken, faces[:20], faces[30:40, ::-1]])
    scene = oktett.Scene(vertices, broken)
    expected = solid_angles(vertices, broken, points.astype(float))
    for error in (1e-2, 1e-4, 1e-6):
        numbers = scene.winding_number(points, error=error)
        assert numbers.dtype == np.float32 and np.abs(numbers - expected).max() <= error + 1e-6
    assert scene.winding_number(points) == pytest.approx(expected, abs=1.01e-4)
    inside = scene.inside(points, rule="winding")
    assert np.array_equal(inside, np.abs(expected) > 0.5) and inside.any() and not inside.all()
    distance = scene.closest_point(points).distance
    assert np.array_equal(scene.signed_distance(points, sign="winding"), np.where(inside, -distance, distance))
    grid = scene.winding_number(points.reshape(30, 50, 3).astype(float))
    assert grid.shape == (30, 50) and np.array_equal(grid.ravel(), scene.winding_number(points))
    whole = oktett.Scene(vertices, faces)
    assert np.array_equal(whole.inside(points, rule="winding"), whole.inside(points))
    assert np.isnan(whole.winding_number([[np.nan, 0, 0]])).all()
    assert oktett.Scene().winding_number(points[:3]).tolist() == [0, 0, 0]
    with pytest.raises(ValueError, match="rule: expected 'crossings' or 'winding', not 'rays'"):
        scene.inside(points, rule="rays")
    with pytest.raises(ValueError, match="sign: expected 'crossings' or 'winding', not ''"):
        scene.signed_distance(points, sign="")
    for error in (0, -1, float("nan")):
        with pytest.raises(ValueError, match="error: expected a number of at least"):
            scene.winding_number(points, error=error)
    with pytest.raises(ValueError, match=r"points: expected .* \(\.\.\., 3\), found the shape \(3, 6\)"):
        scene.winding_number(np.zeros((3, 6)))
