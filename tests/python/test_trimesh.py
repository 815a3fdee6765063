"""The adapter for users of trimesh: a table of cases, and an oracle."""

import pickle
import sys
import types

import numpy as np
import pytest

from oktett import _mesh
from oktett import trimesh as adapter
from oktett.trimesh import (
    ProximityQuery,
    RayMeshIntersector,
    closest_point,
    contains_points,
    longest_ray,
    max_tangent_sphere,
    signed_distance,
    thickness,
)
from oracle import CUBE_FACES, CUBE_VERTICES, ball, crossings, nearest_on_triangles, random_rays


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


DOWN = ([[0.1, 0.2, 9.0]], [[0.0, 0, -1]])


def heights(intersector):
    return sorted(intersector.intersects_location(*DOWN)[0][:, 2].tolist())


def changes():
    """Ways to move a plain mesh one up, with new arrays and in place."""

    def replace(mesh):
        mesh.vertices = mesh.vertices + [0, 0, 1]

    def in_place(mesh):
        mesh.vertices[:, 2] += 1

    def one_face_less(mesh):
        mesh.vertices[:, 2] += 1
        mesh.faces = mesh.faces.copy()
        mesh.faces[0] = mesh.faces[1]

    return [replace, in_place, one_face_less]


@pytest.mark.parametrize("change", changes())
@pytest.mark.parametrize("kind", [Mesh, lambda v, f: types.SimpleNamespace(vertices=v, faces=f)], ids=["weak", "strong"])
def test_a_mesh_that_changed_is_built_again(change, kind):
    mesh = kind(CUBE_VERTICES.astype(float), CUBE_FACES.astype(np.int64))
    intersector, query = RayMeshIntersector(mesh), ProximityQuery(mesh)
    assert heights(intersector) == [-1, 1] and query.signed_distance([[0.1, 0.2, 1.5]]) == [-0.5]
    change(mesh)
    assert heights(intersector) == [0, 2]
    assert query.signed_distance([[0.1, 0.2, 1.5]]) == [0.5] and query.on_surface([[0.1, 0.2, 2.5]])[1] == [0.5]
    assert intersector.contains_points([[0.1, 0.2, 1.5]]).tolist() == [True]
    mesh.vertices = mesh.vertices[:0]
    mesh.faces = mesh.faces[:0]
    assert heights(intersector) == [] and query.on_surface([[0, 0, 0]])[2].tolist() == [-1]


@pytest.mark.parametrize("kind", [Mesh, lambda v, f: types.SimpleNamespace(vertices=v, faces=f)], ids=["weak", "strong"])
def test_a_mesh_that_did_not_change_is_built_once(monkeypatch, kind):
    built = []

    class Counted(_mesh.CenteredMesh):
        def __init__(self, *arguments):
            built.append(self)
            super().__init__(*arguments)

    monkeypatch.setattr(adapter, "CenteredMesh", Counted)
    vertices = CUBE_VERTICES.astype(float)
    vertices = np.concatenate([vertices, [[np.nan, 0, 0]]])
    mesh = kind(vertices, CUBE_FACES.astype(np.int64))
    intersector = RayMeshIntersector(mesh)
    assert built == []
    for _ in range(3):
        intersector.intersects_any(*DOWN), intersector.contains_points([[0, 0, 0]])
    assert len(built) == 1
    if kind is Mesh:
        RayMeshIntersector(mesh).intersects_first(*DOWN), ProximityQuery(mesh).on_surface([[0, 0, 0]])
        signed_distance(mesh, [[0, 0, 0]]), contains_points(mesh, [[0, 0, 0]])
        assert len(built) == 1


def test_what_was_built_goes_with_its_mesh():
    before = len(adapter._shared)
    mesh = Mesh(CUBE_VERTICES, CUBE_FACES)
    assert contains_points(mesh, [[0, 0, 0]]).tolist() == [True] and len(adapter._shared) == before + 1
    del mesh
    assert len(adapter._shared) == before


@pytest.mark.parametrize("kind", [Mesh, types.SimpleNamespace], ids=["weak", "strong"])
def test_intersectors_can_be_pickled(kind):
    mesh = kind(vertices=CUBE_VERTICES, faces=CUBE_FACES)
    for asked in (RayMeshIntersector(mesh), ProximityQuery(mesh)):
        for answer in (lambda a: heights(a) if hasattr(a, "mesh") else a.on_surface([[0, 0, 3]])[1].tolist(),):
            first = answer(asked)
            assert answer(pickle.loads(pickle.dumps(asked))) == first


def test_a_mesh_may_be_empty_or_incomplete_when_the_intersector_is_made():
    class Later:
        pass

    mesh = Later()
    intersector, query = RayMeshIntersector(mesh=mesh), ProximityQuery(mesh)
    mesh.vertices, mesh.faces = np.zeros((0, 3)), np.zeros((0, 3), np.int64)
    assert heights(intersector) == [] and intersector.intersects_first(*DOWN).tolist() == [-1]
    point, distance, triangle = query.on_surface([[1, 2, 3]])
    assert np.isnan(point).all() and distance.tolist() == [np.inf] and triangle.tolist() == [-1]
    assert query.signed_distance([[1, 2, 3]]).tolist() == [-np.inf]
    assert longest_ray(mesh, *DOWN).tolist() == [np.inf]
    centers, radii = max_tangent_sphere(mesh, [[0, 0, 0]], normals=[[0, 0, 1]])
    assert np.isnan(centers).all() and radii.tolist() == [np.inf]
    cube = Mesh(CUBE_VERTICES, CUBE_FACES)
    for method in ("ray", "max_sphere"):
        assert thickness(mesh, [[0, 0, 0]], method=method).tolist() == [np.inf]
        assert thickness(cube, [[0, 0, 1], [np.nan, 0, 0]], method=method) == pytest.approx([2, np.inf], rel=1e-4)
    for arguments in ({}, {"geometry": mesh, "mesh": mesh}):
        with pytest.raises(TypeError, match="expected one mesh"):
            RayMeshIntersector(**arguments)


class OldRay:
    """Stands for what trimesh puts into mesh.ray."""


@pytest.mark.parametrize("without_embree", [False, True])
def test_the_third_argument_is_that_of_the_meshs_own_trimesh(without_embree, monkeypatch):
    mesh = Mesh(CUBE_VERTICES, CUBE_FACES)
    mesh.ray = OldRay()
    monkeypatch.setattr(OldRay, "__module__", "trimesh.ray.ray_" + ("triangle" if without_embree else "pyembree"))
    intersector = RayMeshIntersector(mesh)
    # The module decides where the mesh does not.
    monkeypatch.setitem(sys.modules, "trimesh.ray", types.SimpleNamespace(has_embree=not without_embree))
    other = RayMeshIntersector(Mesh(CUBE_VERTICES, CUBE_FACES))
    for asked in (intersector, other):
        if without_embree:
            assert len(asked.intersects_id(*DOWN, True)) == 3 and len(asked.intersects_id(*DOWN, False)) == 2
            assert len(asked.intersects_id(*DOWN, False, False)[0]) == 1
            assert len(asked.intersects_id(*DOWN, unknown=3)[0]) == 2
            assert len(asked.intersects_location(*DOWN, unknown=3)[0]) == 2
            assert asked.intersects_any(*DOWN, unknown=3).tolist() == [True]
            assert len(asked.intersects_first(*DOWN, unknown=3)) == 1
            continue
        assert len(asked.intersects_id(*DOWN, False)[0]) == 1 and len(asked.intersects_id(*DOWN, True)[0]) == 2
        assert len(asked.intersects_id(*DOWN, True, 1)[0]) == 1 and len(asked.intersects_id(*DOWN, True, 9, True)) == 3
        for query in (asked.intersects_id, asked.intersects_location, asked.intersects_any, asked.intersects_first):
            with pytest.raises(TypeError, match="unexpected keyword argument 'unknown'"):
                query(*DOWN, unknown=3)
    for asked in (intersector, other):
        assert len(asked.intersects_id(*DOWN, return_locations=True, multiple_hits=False, max_hits=5)) == 3
        with pytest.raises(TypeError, match="expected at most"):
            asked.intersects_id(*DOWN, True, True, True, True)
        with pytest.raises(TypeError, match="given twice"):
            asked.intersects_id(*DOWN, True, return_locations=True, multiple_hits=True)


@pytest.mark.parametrize("size", [1e-30, 1e-12, 1e12, 1e30, 1e100])
def test_meshes_of_any_size_are_traced(size):
    vertices, faces = ball(2)
    vertices = vertices.astype(float) * size
    mesh = Mesh(vertices, faces)
    random = np.random.default_rng(2)
    origins, directions = random.normal(size=(500, 3)) * 2, random.normal(size=(500, 3))
    wanted = RayMeshIntersector(Mesh(vertices / size, faces)).intersects_location(origins, directions)
    found = RayMeshIntersector(mesh).intersects_location(origins * size, directions)
    assert len(found[0]) > 50 and found[0] == pytest.approx(wanted[0] * size, abs=1e-6 * size)
    points = random.uniform(-1.2, 1.2, (500, 3))
    distance, _ = nearest_on_triangles(vertices / size, faces, points)
    assert closest_point(mesh, points * size)[1] == pytest.approx(distance * size, abs=2e-7 * size)
    assert np.array_equal(contains_points(mesh, points * size), contains_points(Mesh(vertices / size, faces), points))


@pytest.mark.parametrize("shift", [(0, 0, 0), (4e6, -3e6, 1e6)], ids=["near", "far"])
@pytest.mark.parametrize("shape", [(CUBE_VERTICES, CUBE_FACES), ball(3)], ids=["cube", "ball"])
def test_nearest_points_are_those_of_the_oracle(shape, shift):
    vertices, faces = shape[0].astype(float), shape[1].astype(np.int64)
    random = np.random.default_rng(3)
    points = np.concatenate([random.uniform(-1.5, 1.5, (800, 3)), random.normal(size=(50, 3)) * 1e5])
    query = ProximityQuery(Mesh(vertices + shift, faces))
    point, distance, triangle = query.on_surface(points + shift)
    assert (point.dtype, distance.dtype, triangle.dtype) == (np.float64, np.float64, np.int64)
    best, _ = nearest_on_triangles(vertices, faces, points)
    rounding = 2e-15 * np.linalg.norm(shift)
    # float32 may choose another triangle whose distance differs by its rounding.
    assert (distance >= best - 4 * rounding - 1e-12 * best).all()
    assert distance == pytest.approx(best, rel=2e-7, abs=2e-7)
    assert np.median(np.abs(distance - best)[:800]) < 1e-14 + 2 * rounding
    assert np.linalg.norm(point - shift - points, axis=1) == pytest.approx(distance, abs=1e-12 + 4 * rounding, rel=1e-9)
    # The point lies in the triangle that is named.
    for k in range(0, 850, 17):
        own, _ = nearest_on_triangles(vertices, faces[triangle[k]][None], (point[k] - shift)[None])
        assert own[0] < 1e-12 + 4 * rounding


def test_vertices_of_no_triangle_do_not_count():
    vertices = np.concatenate([CUBE_VERTICES.astype(float), [[1e30, 0, 0], [0, -1e30, 3]]])
    mesh = Mesh(vertices, CUBE_FACES)
    assert heights(RayMeshIntersector(mesh)) == [-1, 1]
    assert signed_distance(mesh, [[0.1, 0.2, 0.7], [0.1, 0.2, 3]]) == pytest.approx([0.3, -2], abs=1e-14)


def test_small_meshes_and_points_far_away_are_answered():
    cube = Mesh(CUBE_VERTICES.astype(float), CUBE_FACES)
    for far in (1e5, 1e30, 1e200, 1e300):
        assert closest_point(cube, [[far, -far, 0]])[1] == pytest.approx([far * 2**0.5], rel=1e-4)
        assert closest_point(cube, [[far, far, far]])[0].tolist() == [[1, 1, 1]]
    tiny = Mesh(CUBE_VERTICES.astype(float) * 1e-305, CUBE_FACES)
    assert closest_point(tiny, [[0, 0, 1]])[1] == [1]
    assert contains_points(tiny, [[0, 0, 1], [0, 0, 0]]).tolist() == [False, True]


def test_points_on_the_surface_have_no_distance():
    vertices, faces = ball(3)
    vertices, faces = vertices.astype(float), faces.astype(np.int64)
    random = np.random.default_rng(4)
    weights = random.dirichlet([0.3] * 3, 4000)
    weights[:500] = np.eye(3)[random.integers(0, 3, 500)]
    weights[500:1000, 0] = 0
    weights /= weights.sum(axis=1)[:, None]
    which = random.integers(0, len(faces), 4000)
    points = (vertices[faces[which]] * weights[:, :, None]).sum(axis=1)
    _, distance, _ = closest_point(Mesh(vertices, faces), points)
    assert distance.max() < 1e-14
    assert (signed_distance(Mesh(vertices, faces), points) >= 0).all()


def test_of_triangles_that_share_the_nearest_point_the_one_that_faces_it_counts():
    # A roof: beside its ridge, high above, the ridge is nearest to all.
    mesh = Mesh(np.array([[0, -1, 0], [0, 1, 0], [-1, 0, -4], [1, 0, -0.1]], float), np.array([[0, 2, 1], [0, 1, 3]]))
    normals = np.cross(*(mesh.vertices[mesh.faces][:, k] - mesh.vertices[mesh.faces][:, 0] for k in (1, 2)))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    for to in ([-0.5, 0, 1], [0.02, 0, 1], [-3, 0, 1]):
        point, _, triangle = closest_point(mesh, [to])
        assert point[0] == pytest.approx([0, 0, 0], abs=1e-12)
        assert triangle[0] == (normals @ to).argmax()
    # Both are equally near but for rounding, in places of their own.
    hinge = Mesh(np.array([[0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, 0, -1]], float), np.array([[0, 1, 2], [0, 1, 3]]))
    for x, wanted in ((-0.25 - 1e-10, 1), (-0.25 - 1e-6, 0), (-0.24, 1)):
        assert closest_point(hinge, [[x, 0, -0.25]])[2] == [wanted]


def test_distances_are_positive_inside_and_negative_outside():
    random = np.random.default_rng(5)
    points = random.uniform(-2, 2, (4000, 3))
    outside = np.linalg.norm(np.maximum(np.abs(points) - 1, 0), axis=1)
    formula = np.where(outside > 0, -outside, 1 - np.abs(points).max(axis=1))
    cube = Mesh(CUBE_VERTICES.astype(float), CUBE_FACES)
    assert signed_distance(cube, points) == pytest.approx(formula, abs=1e-13)
    assert ProximityQuery(cube).signed_distance(points) == pytest.approx(formula, abs=1e-13)
    shift = np.array([1e7, 1e7, -1e7])
    assert signed_distance(Mesh(CUBE_VERTICES + shift, CUBE_FACES), points + shift) == pytest.approx(formula, abs=1e-8)
    special = signed_distance(cube, [[0, 0, 0], [np.nan, 0, 0], [1e30, 0, 0], [np.inf, 0, 0], [1, 1, 1]])
    assert special.tolist() == [1, -np.inf, pytest.approx(-1e30), -np.inf, 0]
    # Of an open surface the normal tells the side, in front of and behind its triangles.
    square = Mesh(np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float), np.array([[0, 1, 2], [0, 2, 3]]))
    assert signed_distance(square, [[0.2, 0.1, 0.5], [0.2, 0.1, -0.5], [3, 0.5, 0]]).tolist() == [-0.5, 0.5, -2]


def test_degenerate_triangles_do_no_harm():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0], [5, 5, 5], [np.nan, 0, 0]], float)
    # A proper one, one of no height, a point, an edge twice, and one with a NaN.
    faces = np.array([[0, 1, 2], [0, 1, 3], [4, 4, 4], [3, 3, 1], [0, 1, 5]])
    mesh = Mesh(vertices, faces)
    point, distance, triangle = closest_point(mesh, [[0.2, 0.2, 1], [1.6, 0, 1], [5, 0, 0], [0.5, -1, 0]])
    # The one that is a point does not count.
    assert point == pytest.approx(np.array([[0.2, 0.2, 0], [1.6, 0, 0], [2, 0, 0], [0.5, 0, 0]]), abs=1e-15)
    assert distance == pytest.approx([1, 1, 3, 1]) and triangle[0] == 0 and triangle[2] in (1, 3)
    assert np.isfinite(signed_distance(mesh, [[0.2, 0.2, 1], [1.6, 0, 1], [5, 5, 7]])).all()
    assert RayMeshIntersector(mesh).intersects_first([[0.2, 0.2, 1]], [[0, 0, -1]]).tolist() == [0]
    assert np.isfinite(thickness(mesh, [[0.2, 0.2, 0]], method="ray")).tolist() == [False]


def test_nearest_vertices_are_found():
    pytest.importorskip("scipy")
    vertices, faces = ball(2)
    points = np.random.default_rng(6).normal(size=(50, 3))
    distance, index = ProximityQuery(Mesh(vertices, faces)).vertex(points)
    every = np.linalg.norm(points[:, None] - vertices.astype(float), axis=2)
    assert index.tolist() == every.argmin(axis=1).tolist() and distance == pytest.approx(every.min(axis=1))


def test_rays_are_as_long_as_the_way_to_the_surface():
    cube = Mesh(CUBE_VERTICES.astype(float), CUBE_FACES)
    points = [[0.1, 0.2, 0], [0.1, 0.2, 1], [0.1, 0.2, 1], [0.1, 0.2, 1 + 1e-9], [0.1, 0.2, 3], [5, 5, 5]]
    directions = [[0, 0, 7], [0, 0, -1], [0, 0, 1], [0, 0, -0.1], [0, 0, -1], [0, 0, -1]]
    assert longest_ray(cube, points, directions) == pytest.approx([1, 2, np.inf, 2, 2, np.inf])
    assert longest_ray(cube, np.zeros((0, 3)), np.zeros((0, 3))).shape == (0,)
    for arguments in (([[0, 0]], [[0, 0, 1]]), ([[0, 0, 0]], [[0, 1]]), ([[0, 0, 0]], [[0, 0, 1]] * 2)):
        with pytest.raises(ValueError):
            longest_ray(cube, *arguments)


def test_spheres_touch_the_surface_and_do_not_cross_it():
    vertices = CUBE_VERTICES * [3.0, 2.0, 1.0]
    box = Mesh(vertices, CUBE_FACES)
    points = np.array([[0.5, 0.3, 1], [2.5, 0.1, 1], [3, 0.2, 0.1], [0.2, 2, 0.3]])
    # A sphere inside that touches a side there is as large as the nearest of the sides across and beside allows.
    radii = [1, 0.5, 0.9, 0.7]
    normals = np.array([[0, 0, 1], [0, 0, 1], [1, 0, 0], [0, 1, 0]], float)
    centers, found = max_tangent_sphere(box, points, threshold=1e-9)
    assert found == pytest.approx(radii, rel=1e-5) and centers == pytest.approx(points - normals * found[:, None])
    assert thickness(box, points) == pytest.approx(2 * np.array(radii), rel=1e-4)
    assert thickness(box, points, method="ray") == pytest.approx([2, 2, 6, 4])
    assert thickness(box, points, exterior=True).tolist() == [np.inf] * 4
    assert thickness(box, points, exterior=True, method="ray").tolist() == [np.inf] * 4
    round_vertices, round_faces = ball(4)
    corners = round_vertices.astype(float)[round_faces]
    middles = corners.mean(axis=1)
    many_sided = Mesh(round_vertices.astype(float), round_faces)
    centers, found = max_tangent_sphere(many_sided, middles[::50])
    assert closest_point(many_sided, centers)[1] == pytest.approx(found, abs=1e-4)
    # One that is larger, and touches the same point, crosses the surface.
    larger = middles[::50] + 1.05 * (centers - middles[::50])
    assert (closest_point(many_sided, larger)[1] < 1.05 * found - 1e-4).all()
    # Between two plates that face each other the outside is as wide as their distance.
    plates = np.concatenate([CUBE_VERTICES * [9, 9, 0.5], CUBE_VERTICES * [9, 9, 0.5] + [0, 0, 4]])
    pair = Mesh(plates, np.concatenate([CUBE_FACES, CUBE_FACES + 8]))
    for method in ("max_sphere", "ray"):
        assert thickness(pair, [[0.1, 0.2, 0.5]], exterior=True, method=method) == pytest.approx(3, rel=1e-5)
    given = max_tangent_sphere(box, points[:1], normals=[[0, 0, -1]], inwards=False)
    assert given[1] == pytest.approx([1]) and given[0] == pytest.approx(np.array([[0.5, 0.3, 0]]))
    for call in (
        lambda: thickness(box, points, method="guess"),
        lambda: thickness(box, points, normals=normals[:2]),
        lambda: max_tangent_sphere(box, [[0, 0]]),
    ):
        with pytest.raises(ValueError, match="expected"):
            call()


class TestBesideTrimesh:
    """Where trimesh is installed its own meshes are asked, and its own answers compared."""

    @pytest.fixture(autouse=True)
    def has_trimesh(self):
        self.trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")

    def test_its_meshes_are_built_again_when_they_change(self):
        mesh = self.trimesh.Trimesh(CUBE_VERTICES.astype(float), CUBE_FACES, process=False)
        intersector, query = RayMeshIntersector(mesh), ProximityQuery(mesh)
        assert heights(intersector) == [-1, 1]
        mesh.apply_translation([0, 0, 1])
        assert heights(intersector) == [0, 2] and query.signed_distance([[0.1, 0.2, 1.5]]) == [0.5]
        mesh.vertices[:, 2] += 1
        assert heights(intersector) == [1, 3]
        mesh.vertices[0] += 0
        mesh.faces = mesh.faces[:0]
        assert heights(intersector) == []

    def test_its_primitives_and_empty_meshes_are_asked(self):
        ball = self.trimesh.primitives.Sphere(radius=2)
        intersector = RayMeshIntersector(ball)
        assert heights(intersector) == pytest.approx([-2, 2], abs=0.05)
        ball.primitive.radius = 4
        assert heights(intersector) == pytest.approx([-4, 4], abs=0.1)
        assert heights(RayMeshIntersector(self.trimesh.Trimesh())) == []

    def test_its_own_answers_are_the_same(self):
        pytest.importorskip("rtree", reason="trimesh needs rtree")
        mesh = self.trimesh.creation.annulus(r_min=0.5, r_max=1, height=1)
        points = np.random.default_rng(7).uniform(-1.2, 1.2, (400, 3))
        proximity = self.trimesh.proximity
        assert signed_distance(mesh, points) == pytest.approx(proximity.signed_distance(mesh, points), abs=1e-7)
        mine, theirs = closest_point(mesh, points), proximity.closest_point(mesh, points)
        assert mine[1] == pytest.approx(theirs[1], abs=1e-7)
        assert np.array_equal(contains_points(mesh, points), mesh.contains(points))
        surface, _ = self.trimesh.sample.sample_surface(mesh, 100, seed=8)
        for method in ("ray", "max_sphere"):
            theirs = proximity.thickness(mesh, surface, method=method)
            assert thickness(mesh, surface, method=method) == pytest.approx(theirs, abs=1e-3)
        distance, index = ProximityQuery(mesh).vertex(points)
        assert np.array_equal(index, proximity.ProximityQuery(mesh).vertex(points)[1])
        rays = random_rays(300, 1.0, seed=9)
        mesh_ray = self.trimesh.ray.ray_triangle.RayMeshIntersector(mesh)
        mine = RayMeshIntersector(mesh)
        assert np.array_equal(mine.intersects_any(rays[:, :3], rays[:, 3:]), mesh_ray.intersects_any(rays[:, :3], rays[:, 3:]))
        # On the closed mesh no random ray meets an edge, so the places agree, sorted.
        ours, theirs = (i.intersects_location(rays[:, :3], rays[:, 3:]) for i in (mine, mesh_ray))
        assert np.array_equal(np.bincount(ours[1], minlength=300), np.bincount(theirs[1], minlength=300))
        for k in range(300):
            one, other = (np.sort(a[0][a[1] == k][:, 2]) for a in (ours, theirs))
            assert one == pytest.approx(other, abs=1e-7)
