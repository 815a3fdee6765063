"""The adapter for users of trimesh: a table of cases, and an oracle."""

import numpy as np
import pytest

from oktett.trimesh import RayMeshIntersector
from oracle import CUBE_FACES, CUBE_VERTICES, ball, crossings, random_rays


class Mesh:
    def __init__(self, vertices, faces):
        self.vertices, self.faces = vertices, faces


@pytest.fixture
def cube():
    return RayMeshIntersector(Mesh(CUBE_VERTICES.astype(float), CUBE_FACES.astype(np.int64)))


# origin, direction, and the z, or else x, of all hits in order
CASES = {
    "a miss": ([5, 5, 5], [0, 0, 1], []),
    "away from the mesh": ([0.1, 0.2, 3], [0, 0, 1], []),
    "two hits in order": ([0.1, 0.2, 3], [0, 0, -1], [1, -1]),
    "two hits in the other order": ([0.1, 0.2, -3], [0, 0, 1], [-1, 1]),
    "from inside": ([0.1, 0.2, 0], [0, 0, -1], [-1]),
    "a direction of another length": ([0.1, 0.2, 3], [0, 0, -1000], [1, -1]),
    "a very short direction": ([0.1, 0.2, 3], [0, 0, -1e-30], [1, -1]),
    "the diagonal that two triangles share": ([0.25, 0.25, 3], [0, 0, -1], [1, -1]),
    "the middle, where diagonals meet": ([0, 0, 3], [0, 0, -1], [1, -1]),
    "from very far away": ([0.1, 0.2, 3e7], [0, 0, -1], [1, -1]),
    "a direction of zero": ([0.1, 0.2, 3], [0, 0, 0], []),
    "a NaN": ([0.1, np.nan, 3], [0, 0, -1], []),
    "grazing past a face": ([1.0000002, 0.2, 3], [0, 0, -1], []),
}


@pytest.mark.parametrize("name", CASES)
def test_each_case_of_the_table(cube, name):
    origin, direction, wanted = CASES[name]
    locations, index_ray, index_tri = cube.intersects_location([origin], [direction])
    assert locations.shape == (len(wanted), 3) and locations[:, 2].tolist() == wanted
    assert index_ray.tolist() == [0] * len(wanted) and index_ray.dtype.kind == index_tri.dtype.kind == "i"
    normals = np.cross(*(CUBE_VERTICES[CUBE_FACES[index_tri]][:, k] - CUBE_VERTICES[CUBE_FACES[index_tri]][:, 0] for k in (1, 2)))
    assert (normals[:, 2] / 4).tolist() == wanted
    once, ray, triangle = cube.intersects_location([origin], [direction], multiple_hits=False)
    assert once.tolist() == locations[:1].tolist() and triangle.tolist() == index_tri[:1].tolist()
    assert cube.intersects_first([origin], [direction]).tolist() == (index_tri[:1].tolist() or [-1])
    assert cube.intersects_any([origin], [direction]).tolist() == [bool(wanted)]


def test_an_edge_of_a_closed_mesh_counts_once():
    vertices, faces = ball(2)
    intersector = RayMeshIntersector(Mesh(vertices, faces))
    # From outside through the middle of each edge and through each vertex, to the middle of the ball and out.
    edges = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
    for targets in (vertices[edges].mean(axis=1), vertices):
        origins = 3.0 * targets
        _, index_ray, _ = intersector.intersects_location(origins, -origins)
        assert (np.bincount(index_ray, minlength=len(origins)) == 2).all()


def test_rays_have_the_answers_of_the_oracle():
    vertices, faces = ball(2)
    # Far from the origin, where a float32 has few digits left.
    shift = np.array([3e5, -2e5, 1e5])
    intersector = RayMeshIntersector(Mesh(vertices + shift, faces))
    rays = random_rays(2000, 1.0, seed=1)
    expected, uncertain = crossings(vertices, faces, rays)
    origins, directions = rays[:, :3] + shift, rays[:, 3:]
    locations, index_ray, index_tri = intersector.intersects_location(origins, directions)
    ids, id_rays, same = intersector.intersects_id(origins, directions, return_locations=True)
    assert np.array_equal(ids, index_tri) and np.array_equal(id_rays, index_ray) and np.array_equal(same, locations)
    first, any_hit = intersector.intersects_first(origins, directions), intersector.intersects_any(origins, directions)
    for i in np.nonzero(~uncertain)[0]:
        mine = index_ray == i
        assert index_tri[mine].tolist() == [k for _, k, _, _ in expected[i]]
        for place, (t, _, _, _) in zip(locations[mine], expected[i]):
            assert place - shift == pytest.approx(rays[i, :3] + t * rays[i, 3:].astype(float), abs=1e-9)
        assert first[i] == (expected[i][0][1] if expected[i] else -1) and any_hit[i] == bool(expected[i])
    assert (np.diff(index_ray) >= 0).all()


def test_at_most_so_many_hits_are_given():
    layers = np.concatenate([CUBE_VERTICES * np.float32(s) for s in (1, 2, 3)])
    intersector = RayMeshIntersector(Mesh(layers, np.concatenate([CUBE_FACES + 8 * k for k in range(3)])))
    origins, directions = np.tile([0.1, 0.2, 9.0], (2, 1)), np.tile([0.0, 0, -1], (2, 1))
    for most, wanted in ((1, [3]), (4, [3, 2, 1, -1]), (100, [3, 2, 1, -1, -2, -3])):
        triangles, rays, places = intersector.intersects_id(origins, directions, max_hits=most, return_locations=True)
        assert places[:, 2].tolist() == wanted * 2 and rays.tolist() == [0] * len(wanted) + [1] * len(wanted)
    assert len(intersector.intersects_id(origins, directions)) == 2


def test_points_inside_are_those_of_the_formula(cube):
    points = np.random.default_rng(1).uniform(-1.5, 1.5, (5000, 3))
    inside = (np.abs(points) < 1).all(axis=1)
    assert np.array_equal(cube.contains_points(points), inside)
    corners = cube.contains_points([[0, 0, 0], [0.5, 0.5, 0.5], [np.nan, 0, 0], [1e30, 0, 0], [np.inf, 0, 0]])
    assert corners.tolist() == [True, True, False, False, False]
    # Without one triangle most of the points keep their answer.
    holed = RayMeshIntersector(Mesh(CUBE_VERTICES, CUBE_FACES[1:]))
    assert (holed.contains_points(points) == inside).mean() > 0.95


def test_nothing_in_nothing_out(cube):
    empty = np.zeros((0, 3))
    assert [a.shape for a in cube.intersects_location(empty, empty)] == [(0, 3), (0,), (0,)]
    assert cube.intersects_first(empty, empty).shape == cube.contains_points(empty).shape == (0,)
    nothing = RayMeshIntersector(Mesh(empty, np.zeros((0, 3), int)))
    assert nothing.intersects_any([[0, 0, 0]], [[0, 0, 1]]).tolist() == [False]
    assert nothing.contains_points([[0, 0, 0]]).tolist() == [False]


@pytest.mark.parametrize(
    "origins, directions, message",
    [
        ([0, 0, 0], [0, 0, 1], r"ray_origins: expected numbers of shape \(n, 3\), found int64 of the shape \(3,\)"),
        ([[0, 0]], [[0, 0, 1]], "ray_origins"),
        ([[0, 0, 0]], [[0, 1]], "ray_directions"),
        ([[0, 0, 0]], [[0, 0, 1], [0, 0, 1]], "expected as many directions as origins, found 2 and 1"),
        ([["a", "b", "c"]], [[0, 0, 1]], "ray_origins"),
    ],
)
def test_shapes_that_do_not_fit_are_refused(cube, origins, directions, message):
    for query in (cube.intersects_location, cube.intersects_id, cube.intersects_first, cube.intersects_any):
        with pytest.raises(ValueError, match=message):
            query(origins, directions)
    with pytest.raises(ValueError, match="points"):
        cube.contains_points([[1, 2]])
