"""Queries with rays against an oracle, and what they refuse."""

import numpy as np
import pytest

import oktett
from oracle import CUBE_FACES, CUBE_VERTICES, ball, crossings, random_rays

MISS = 0xFFFFFFFF
MESHES = {"cube": (CUBE_VERTICES, CUBE_FACES), "ball": ball(2)}


@pytest.fixture(params=MESHES)
def mesh(request):
    return MESHES[request.param]


def test_rays_hit_what_the_oracle_says(mesh):
    vertices, faces = mesh
    scene = oktett.Scene(vertices, faces)
    rays = random_rays(3000, 1.0, seed=1)
    expected, uncertain = crossings(vertices, faces, rays)
    hits = scene.closest_hit(rays, fields=["t", "object", "primitive", "instance", "uv", "normal", "position"])
    lists = scene.all_hits(rays)
    counts = scene.count_hits(rays)
    occluded = scene.any_hit(rays)
    assert uncertain.mean() < 0.05
    compared = 0
    for i in np.nonzero(~uncertain)[0]:
        wanted = expected[i]
        assert counts[i] == len(wanted) and occluded[i] == bool(wanted)
        mine = slice(lists.splits[i], lists.splits[i + 1])
        assert lists.primitive[mine].tolist() == [k for _, k, _, _ in wanted]
        assert lists.t[mine] == pytest.approx([t for t, _, _, _ in wanted], rel=2e-5)
        if not wanted:
            assert hits.t[i] == np.inf and hits.object[i] == hits.primitive[i] == hits.instance[i] == MISS
            assert not hits.uv[i].any() and not hits.normal[i].any() and not hits.position[i].any()
            continue
        t, triangle, u, v = wanted[0]
        compared += 1
        assert hits.primitive[i] == triangle and hits.object[i] == 0
        assert hits.t[i] == pytest.approx(t, rel=2e-5)
        assert hits.uv[i] == pytest.approx([u, v], abs=2e-5)
        assert hits.position[i] == pytest.approx(rays[i, :3] + t * rays[i, 3:].astype(float), abs=2e-5)
        a, b, c = vertices[faces[triangle]].astype(float)
        normal = np.cross(b - a, c - a)
        assert hits.normal[i] == pytest.approx(normal / np.linalg.norm(normal), abs=1e-6)
    assert compared > 1000
    assert (lists.ray_ids == np.repeat(np.arange(len(rays)), counts)).all()


def test_answers_do_not_depend_on_the_batch(mesh):
    scene = oktett.Scene(*mesh)
    rays = random_rays(70000, 1.0, seed=2)
    whole = scene.closest_hit(rays)
    for i in (0, 1, 4095, 4096, 69999):
        alone = scene.closest_hit(rays[i])
        assert alone.t.shape == () and alone.uv.shape == (2,)
        assert all(np.array_equal(a, b[i]) for a, b in zip(alone, whole) if a is not None)
    lists, counts = scene.all_hits(rays), scene.count_hits(rays)
    assert np.array_equal(np.diff(lists.splits), counts)
    first = lists.splits[:-1][counts > 0]
    assert np.array_equal(lists.t[first], whole.t[counts > 0])
    assert np.array_equal(scene.any_hit(rays), counts > 0)


def pinhole(width, height):
    """Rays of the pixels of a camera, row after row, from outside the unit ball."""
    y, x = np.mgrid[0:height, 0:width] + 0.5
    size = max(width, height)
    directions = np.stack([(x - width / 2) / size, (y - height / 2) / size, -np.ones(x.shape)], axis=-1)
    return np.concatenate([np.broadcast_to([0.1, 0.2, 3], directions.shape), directions], axis=-1).astype(np.float32)


@pytest.mark.parametrize("width, height", [(8, 16), (64, 48), (97, 61), (513, 37), (1100, 23), (20, 300)])
def test_rays_of_pictures_have_the_hits_that_they_have_in_any_order(mesh, width, height):
    scene = oktett.Scene(*mesh)
    picture = pinhole(width, height)
    # The last row of the second array is not whole.
    for rays in (picture, picture.reshape(-1, 6)[: -width // 3]):
        flat = rays.reshape(-1, 6)
        order = np.random.default_rng(5).permutation(len(flat))
        fields = ["t", "object", "primitive", "instance", "uv", "normal", "position"]
        hits, mixed = scene.closest_hit(rays, fields=fields), scene.closest_hit(flat[order], fields=fields)
        assert 0.1 < np.isfinite(hits.t).mean() < 1
        for a, b in zip(hits, mixed):
            assert np.array_equal(a.reshape(len(flat), -1)[order].ravel(), b.ravel())
        assert np.array_equal(scene.any_hit(rays).ravel()[order], scene.any_hit(flat[order]))
        assert np.array_equal(scene.count_hits(rays).ravel()[order], scene.count_hits(flat[order]))
        tmax = np.linspace(1, 4, len(flat), dtype=np.float32)
        cut = scene.closest_hit(flat, tmin=tmax / 2, tmax=tmax)
        assert np.array_equal(cut.t[order], scene.closest_hit(flat[order], tmin=tmax[order] / 2, tmax=tmax[order]).t)


def test_arrays_of_any_layout_and_type_give_the_same_hits(mesh):
    scene = oktett.Scene(*mesh)
    rays = random_rays(1000, 1.0, seed=3)
    expected = scene.closest_hit(rays)
    spread = np.zeros((1000, 12), np.float32)
    spread[:, ::2] = rays
    for same in (rays.astype(np.float64), np.asfortranarray(rays), spread[:, ::2], rays.astype(">f4"), rays.tolist()):
        got = scene.closest_hit(same)
        assert all(np.array_equal(a, b) for a, b in zip(expected, got) if a is not None)
    backwards = scene.closest_hit(rays[::-1])
    assert np.array_equal(backwards.t[::-1], expected.t)
    grid = scene.closest_hit(rays.reshape(10, 100, 6))
    assert grid.t.shape == (10, 100) and grid.normal.shape == (10, 100, 3)
    assert np.array_equal(grid.t.ravel(), expected.t)


def test_intervals_of_rays_are_open_below_and_closed_above():
    scene = oktett.Scene(CUBE_VERTICES, CUBE_FACES)
    ray = [0.1, 0.2, -3, 0, 0, 1]
    assert scene.closest_hit(ray).t == 2
    assert scene.closest_hit(ray, tmin=2).t == 4
    assert scene.closest_hit(ray, tmax=2).t == 2
    assert scene.closest_hit(ray, tmax=np.float32(1.9999999)).t == np.inf
    rays = np.tile(ray, (4, 1))
    assert scene.closest_hit(rays, tmin=[0, 2, 4, 0], tmax=[9, 9, 9, 1]).t.tolist() == [2, 4, np.inf, np.inf]
    assert scene.count_hits(rays, tmin=[0, 2, 4, 0]).tolist() == [2, 1, 0, 2]
    assert scene.any_hit(rays, tmin=[0, 2, 4, 0], tmax=3).tolist() == [True, False, False, True]


def test_rays_that_are_none_hit_nothing():
    scene = oktett.Scene(CUBE_VERTICES, CUBE_FACES)
    good = [0, 0.1, -3, 0, 0, 1]
    rays = np.tile(np.float32(good), (8, 1))
    for k in range(6):
        rays[k, k] = np.nan
    rays[6, 3:] = 0
    assert scene.count_hits(rays).tolist() == [0] * 7 + [2]
    assert scene.closest_hit(np.inf * np.ones(6)).t == np.inf


def test_no_rays_and_empty_scenes_are_answered():
    scene = oktett.Scene(CUBE_VERTICES, CUBE_FACES)
    hits = scene.closest_hit(np.zeros((0, 6)))
    assert hits.t.shape == (0,) and hits.normal.shape == (0, 3)
    assert scene.all_hits(np.zeros((0, 6))).splits.tolist() == [0]
    assert scene.closest_hit(np.zeros((2, 0, 6))).uv.shape == (2, 0, 2)
    assert scene.any_hit(np.zeros((0, 6))).shape == (0,)
    nothing = oktett.Scene()
    assert nothing.closest_hit(np.ones((3, 6))).t.tolist() == [np.inf] * 3
    assert nothing.bounds is None and nothing.objects == [] and nothing.primitive_count == 0
    assert oktett.Scene(np.zeros((0, 3)), np.zeros((0, 3), int)).count_hits(np.ones((2, 6))).tolist() == [0, 0]


@pytest.mark.parametrize(
    "rays, found",
    [
        (np.zeros((3, 5)), "the shape (3, 5)"),
        (np.zeros(7), "the shape (7,)"),
        (np.float32(1), "the shape ()"),
        ("rays", "elements of type <U4"),
        (np.zeros((2, 6), complex), "elements of type complex128"),
        (np.zeros((2, 6), bool), "elements of type bool"),
        ([[1, 2, 3, 4, 5, 6], [1]], "elements of type object|an object of type list"),
        (None, "elements of type object|an object of type NoneType"),
        (np.ma.masked_array(np.ones((2, 6)), mask=np.eye(2, 6)), "a masked array"),
    ],
)
def test_other_arrays_of_rays_are_refused(rays, found):
    scene = oktett.Scene(CUBE_VERTICES, CUBE_FACES)
    for query in (scene.closest_hit, scene.any_hit, scene.count_hits, scene.all_hits):
        with pytest.raises(ValueError) as error:
            query(rays)
        assert "rays: expected an array of numbers of shape (..., 6), found" in str(error.value)
        assert any(text in str(error.value) for text in found.split("|")), error.value


def test_other_arguments_are_refused():
    scene = oktett.Scene(CUBE_VERTICES, CUBE_FACES)
    rays = np.zeros((4, 6), np.float32)
    for arguments, message in (
        ({"tmin": [1, 2]}, r"tmin: expected a number or an array of shape \(4,\), found the shape \(2,\)"),
        ({"tmax": "far"}, "tmax: expected a number"),
        ({"tmin": -0.25e-7}, "tmin: expected no negative numbers, found -2.5"),
        ({"fields": ["t", "colour"]}, "fields: there is no field 'colour'"),
    ):
        with pytest.raises(ValueError, match=message):
            scene.closest_hit(rays, **arguments)


@pytest.mark.parametrize(
    "vertices, faces, message",
    [
        (np.zeros((3, 2)), [[0, 1, 2]], r"vertices: .*\(\.\.\., 3\), found the shape \(3, 2\)"),
        (np.zeros((1, 3, 3)), [[0, 1, 2]], r"vertices: .*\(n, 3\), found the shape \(1, 3, 3\)"),
        (np.zeros((3, 3)), [[0, 1, 3]], r"faces: row 0 names vertex 3, expected 0 to 3 - 1"),
        (np.zeros((3, 3)), [[0, 1, 2], [0, -1, 2]], r"faces: row 1 names vertex -1"),
        (np.zeros((3, 3)), np.array([[0, 1, 2**64 - 1]], np.uint64), r"faces: row 0 names vertex"),
        (np.zeros((3, 3)), np.array([[0, 1, 3]], np.uint32), r"faces: row 0 names vertex 3"),
        (np.zeros((3, 3)), [[0, 1]], r"faces: .*\(m, 3\), found the shape \(1, 2\)"),
        (np.zeros((3, 3)), [[0.0, 1.0, 2.0]], r"faces: .* found elements of type float64"),
        (np.zeros((3, 3)), None, "both vertices and faces"),
    ],
)
def test_other_meshes_are_refused(vertices, faces, message):
    with pytest.raises(ValueError, match=message):
        oktett.Scene(vertices, faces)


def test_meshes_of_any_type_of_indices_are_the_same():
    rays = random_rays(100, 1.0, seed=4)
    expected = oktett.Scene(CUBE_VERTICES, CUBE_FACES).closest_hit(rays).t
    for kind in (np.int8, np.uint16, np.int32, np.int64, np.uint64):
        assert np.array_equal(oktett.Scene(CUBE_VERTICES, CUBE_FACES.astype(kind)).closest_hit(rays).t, expected)
    bad = np.concatenate([CUBE_VERTICES, [[np.nan, 0, 0], [np.inf, 0, 0]]])
    more = np.concatenate([CUBE_FACES, [[0, 1, 8], [0, 1, 9], [0, 0, 1]]])
    assert np.array_equal(oktett.Scene(bad, more).closest_hit(rays).t, expected)


def test_several_meshes_are_objects_with_transforms():
    scene = oktett.Scene()
    scene.add_mesh(CUBE_VERTICES, CUBE_FACES, name="first")
    move = np.eye(4)
    move[:3, :3] *= 0.5
    move[:3, 3] = [4, 0, 0]
    assert scene.add_mesh(CUBE_VERTICES, CUBE_FACES, transform=move, name="second") == 1
    rays = [[0.1, 0.2, 5, 0, 0, -1], [4.1, 0.2, 5, 0, 0, -1]]
    hits = scene.closest_hit(rays)
    assert hits.t.tolist() == [4, 4.5] and hits.object.tolist() == [0, 1]
    assert scene.objects == ["first", "second"]
    assert scene.bounds.tolist() == [[-1, -1, -1], [4.5, 1, 1]]
    # A mesh that is added later is seen by the next query.
    assert scene.closest_hit([8, 0.2, 5, 0, 0, -1]).t == np.inf
    move[0, 3] = 8
    scene.add_mesh(CUBE_VERTICES, CUBE_FACES, transform=move[:3])
    assert scene.closest_hit([8, 0.2, 5, 0, 0, -1]).object == 2
    for bad in (np.zeros((4, 4)), np.eye(3), np.diag([1, 1, 1, 2])):
        with pytest.raises(ValueError, match="transform"):
            scene.add_mesh(CUBE_VERTICES, CUBE_FACES, transform=bad)
