"""Meshes in coordinates of a map: queries against an oracle in extended precision, and against the same near (0, 0, 0)."""

import pickle
import warnings

import numpy as np
import pytest

import oktett
from oktett.open3d import RaycastingScene
from oracle import ball, crossings, nearest_on_triangles

MAP = np.array([432100.0, 5411000.0, 300.0])
# What float32 rounds coordinates up to 1 by; in those of the map it would be 0.25.
STEP = 2.0**-24


@pytest.fixture(scope="module")
def scan():
    """A ball of a metre with vertices in float64 that no float32 holds, around the middle of the map and at (0, 0, 0)."""
    vertices, faces = ball(3)
    random = np.random.default_rng(1)
    vertices = 0.5 * vertices.astype(np.float64) * random.uniform(0.98, 1, (len(vertices), 1))
    return vertices, faces


def rays_at(count, seed):
    random = np.random.default_rng(seed)
    origins = random.normal(size=(count, 3))
    origins *= 2 / np.linalg.norm(origins, axis=1, keepdims=True)
    targets = random.uniform(-0.4, 0.4, (count, 3))
    return np.concatenate([origins, targets - origins], axis=1)


def far_rays(rays):
    return rays + np.concatenate([MAP, np.zeros(3)])


def test_hits_are_right_to_steps_of_the_extent(scan):
    vertices, faces = scan
    scene = oktett.Scene(MAP + vertices, faces)
    rays = rays_at(500, 2)
    fields = ["t", "primitive", "position"]
    hits = scene.closest_hit(far_rays(rays), fields=fields)
    lists = scene.all_hits(far_rays(rays), fields=fields)
    assert hits.position.dtype == lists.position.dtype == np.float64
    # The oracle counts in long double, and from the map's own origin.
    wide = np.longdouble
    corners = (MAP.astype(wide) + vertices)[faces]
    compared = 0
    for i, (wanted, uncertain) in enumerate(zip(*crossings(vertices, faces, rays))):
        if uncertain or not wanted:
            continue
        t, triangle, _, _ = wanted[0]
        assert hits.primitive[i] == triangle
        a, b, c = corners[triangle]
        normal = np.cross(b - a, c - a)
        origin, direction = far_rays(rays)[i, :3].astype(wide), rays[i, 3:].astype(wide)
        place = origin + direction * (np.dot(normal, a - origin) / np.dot(normal, direction))
        slope = abs(np.dot(normal, direction)) / np.linalg.norm(normal.astype(float)) / np.linalg.norm(rays[i, 3:])
        # Origins up to 2 away and vertices are rounded to float32, once each, and so is the place.
        assert np.abs(hits.position[i] - place).max() < 12 * STEP / float(slope)
        first = lists.splits[i]
        assert np.array_equal(lists.position[first], hits.position[i]) and lists.primitive[first] == triangle
        assert len(wanted) == lists.splits[i + 1] - first
        compared += 1
    assert compared > 300


def test_nearest_points_and_signs_are_right_to_steps_of_the_extent(scan):
    vertices, faces = scan
    scene = oktett.Scene(MAP + vertices, faces)
    points = np.random.default_rng(3).uniform(-0.8, 0.8, (400, 3))
    distance, place = nearest_on_triangles(vertices, faces, points)
    found = scene.closest_point(MAP + points)
    assert found.point.dtype == np.float64
    assert np.abs(found.distance - distance).max() < 8 * STEP
    # The nearest point itself may lie on either of two triangles that are equally near.
    assert np.abs(np.linalg.norm(found.point - (MAP + points), axis=1) - distance).max() < 8 * STEP
    assert np.median(np.abs(found.point - (MAP + place)).max(axis=1)) < 8 * STEP
    inside = np.linalg.norm(points, axis=1) < 0.47
    outside = np.linalg.norm(points, axis=1) > 0.51
    for rule in ("crossings", "winding"):
        assert scene.inside(MAP + points, rule=rule)[inside].all() and not scene.inside(MAP + points, rule=rule)[outside].any()
        signed = scene.signed_distance(MAP + points, sign=rule)
        assert np.abs(np.abs(signed) - distance).max() < 8 * STEP and (signed[inside] < 0).all()
    assert scene.winding_number(MAP + points)[inside] == pytest.approx(1, abs=2e-4)
    low, high = scene.bounds
    assert scene.bounds.dtype == np.float64
    assert np.abs(low - (MAP + vertices).min(axis=0)).max() < 2 * STEP
    assert np.abs(high - (MAP + vertices).max(axis=0)).max() < 2 * STEP


def everything(scene, rays, points):
    """All answers, as a list of arrays; places are the second half."""
    fields = ["t", "object", "primitive", "instance", "uv", "normal", "position"]
    hits, lists = scene.closest_hit(rays, fields=fields), scene.all_hits(rays, fields=fields)
    nearest = scene.closest_point(points)
    same = [*hits[:-1], *lists[:-1], scene.any_hit(rays, tmax=0.6), scene.count_hits(rays)]
    same += [nearest.distance, nearest.primitive, nearest.uv, nearest.normal, scene.inside(points)]
    same += [scene.winding_number(points), scene.signed_distance(points)]
    return same, [hits.position, lists.position, nearest.point, scene.bounds]


# The box around the ball is exactly as large on both sides, so the middle of the map is the place that is taken off.
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_the_bits_are_those_near_the_origin(dtype):
    step = 2.0**-1 if dtype == np.float32 else 2.0**-20  # what the type holds in coordinates of the map
    scale = 64.0 if dtype == np.float32 else 1.0
    vertices, faces = ball(2)
    vertices = np.round(vertices.astype(np.float64) * scale / step) * step
    middle = np.array([432128.0, 5411072.0, 3072.0])
    assert ((middle + vertices).astype(dtype) == middle + vertices).all()
    random = np.random.default_rng(4)
    rays = np.round(rays_at(3000, 5) * 2 * scale * 2.0**10) / 2.0**10
    rays[7] = np.nan
    points = np.round(random.uniform(-2, 2, (500, 3)) * scale * 2.0**10) / 2.0**10
    near, far = oktett.Scene(vertices, faces), oktett.Scene((middle + vertices).astype(dtype), faces)
    assert not near.origin.any() and np.array_equal(far.origin, middle)
    same, places = everything(near, rays, points)
    moved = rays + np.concatenate([middle, np.zeros(3)])
    far_same, far_places = everything(far, moved, middle + points)
    assert all(np.array_equal(a, b, equal_nan=a.dtype.kind == "f") for a, b in zip(same, far_same))
    found = same[0] < np.inf
    assert 1000 < found.sum() < 3000
    assert np.array_equal(far_places[0][found], middle + places[0][found]) and not far_places[0][~found].any()
    for a, b in zip(places[1:], far_places[1:]):
        assert a.dtype == np.float32 and b.dtype == np.float64 and np.array_equal(b, middle + a)


def test_meshes_near_the_origin_stay_float32():
    vertices, faces = ball(1)
    scene = oktett.Scene(vertices.astype(np.float64) + 100, faces)
    assert scene.bounds.dtype == np.float32 and not scene.origin.any()
    assert scene.closest_hit([[100, 100, 105, 0, 0, -1]], fields=["position"]).position.dtype == np.float32
    # What is not finite tells nothing of where a mesh lies.
    vertices = np.concatenate([vertices.astype(np.float64), [[np.inf, 0, 0], [np.nan, 0, 0]]])
    assert not oktett.Scene(vertices, faces).origin.any()
    assert np.abs(oktett.Scene(MAP + vertices, faces).origin - MAP).max() <= 2


def test_transforms_are_applied_in_float64(scan):
    vertices, faces = scan
    rays = rays_at(500, 6)
    plain = oktett.Scene(MAP + vertices, faces).closest_hit(far_rays(rays), fields=["t", "position"])
    turn = np.array([[0.0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0]])
    back = np.linalg.inv(turn[:, :3])
    turned = oktett.Scene((MAP + vertices) @ back.T, faces, transform=turn)
    placed = oktett.Scene(vertices, faces, transform=np.concatenate([np.eye(3), MAP[:, None]], axis=1))
    for scene in (turned, placed):
        assert scene.origin.any()
        found = scene.closest_hit(far_rays(rays), fields=["t", "position"])
        hit = np.isfinite(plain.t)
        assert (np.isfinite(found.t) == hit).mean() > 0.99
        hit &= np.isfinite(found.t)
        assert np.median(np.abs(found.position - plain.position)[hit]) < 16 * STEP
    # Moved to (0, 0, 0) nothing is far.
    home = oktett.Scene(MAP + vertices, faces, transform=np.concatenate([np.eye(3), -MAP[:, None]], axis=1))
    assert not home.origin.any() and home.bounds.dtype == np.float32
    assert np.abs(home.bounds - [vertices.min(axis=0), vertices.max(axis=0)]).max() < 2 * STEP


def test_scenes_count_from_the_first_far_mesh(scan):
    vertices, faces = scan
    aside = np.array([4000.0, 0, 0])
    rays = np.concatenate([far_rays(rays_at(200, 7)), far_rays(rays_at(200, 8)) + np.concatenate([aside, np.zeros(3)])])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene = oktett.Scene(MAP + vertices, faces)
        assert scene.closest_hit(rays).object[:200].min() == 0
        assert scene.add_mesh(MAP + aside + vertices, faces) == 1
        hits = scene.closest_hit(rays, fields=["object", "position"])
    assert np.abs(scene.origin - MAP).max() <= 1
    for half, number in ((slice(0, 200), 0), (slice(200, 400), 1)):
        found = hits.object[half] == number
        assert found.mean() > 0.7 and (hits.object[half][~found] == 0xFFFFFFFF).all()
        middle = MAP + number * aside
        radius = np.linalg.norm(hits.position[half][found] - middle, axis=1)
        # Four kilometres away float32 rounds to a quarter of a millimetre.
        assert radius.min() > 0.47 and radius.max() < 0.5 + 4e-4


def test_lost_digits_are_a_warning_once(scan):
    vertices, faces = scan
    scene = oktett.Scene(vertices, faces)
    scene.add_mesh(MAP + vertices, faces, name="tower")
    rays = far_rays(rays_at(50, 9))
    with pytest.warns(UserWarning, match="details are lost") as caught:
        hits = scene.closest_hit(rays)
    assert len(caught) == 1 and "5.41e+06" in str(caught[0].message)
    # The mesh far away keeps its digits; that near (0, 0, 0) is the one that loses them.
    assert set(hits.object) <= {1, 0xFFFFFFFF} and (hits.object == 1).mean() > 0.7 and np.abs(scene.origin - MAP).max() <= 1
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene.add_mesh(MAP + 3 + vertices, faces)
        scene.closest_hit(rays), scene.render(4, 4, samples=1)
    with pytest.warns(UserWarning, match="details are lost"):
        fresh = oktett.Scene(vertices, faces)
        fresh.add_mesh(MAP + vertices, faces)
        fresh.render(4, 4, samples=1)


def test_positions_in_pictures_count_from_zero(scan):
    vertices, faces = scan
    scene = oktett.Scene(MAP + vertices, faces)
    camera = {"from": MAP + [0, 0, 3], "at": MAP, "up": [0, 1, 0], "fov": 40}
    planes = scene.render(32, 32, samples=1, camera=camera)
    near = oktett.Scene(vertices, faces).render(32, 32, samples=1, camera={**camera, "from": [0, 0, 3], "at": [0, 0, 0]})
    seen = np.isfinite(planes["Z"])
    assert 0.1 < seen.mean() < 0.9 and (seen == np.isfinite(near["Z"])).mean() > 0.99
    place = np.stack([planes[f"P.{axis}"] for axis in "XYZ"], axis=-1)
    assert place.dtype == np.float64 and not place[~seen].any()
    radius = np.linalg.norm(place[seen] - MAP, axis=1)
    assert radius.min() > 0.47 and radius.max() < 0.5 + 1e-6
    both = seen & np.isfinite(near["Z"])
    for k, axis in enumerate("XYZ"):
        assert near[f"P.{axis}"].dtype == np.float32
        assert np.median(np.abs(planes[f"P.{axis}"] - MAP[k] - near[f"P.{axis}"])[both]) < 16 * STEP
    assert scene.render(8, 8, samples=1, camera=camera, planes=["P.Y"])["P.Y"].dtype == np.float64


def test_dicts_and_pickles_keep_the_digits(scan):
    vertices, faces = scan
    rays = far_rays(rays_at(300, 10))
    scene = oktett.Scene(MAP + vertices, faces)
    described = oktett.Scene.from_dict({"objects": [{"mesh": {"vertices": MAP + vertices, "faces": faces}}]})
    wanted = scene.closest_hit(rays, fields=["t", "position"])
    for other in (described, pickle.loads(pickle.dumps(scene)), pickle.loads(pickle.dumps(described))):
        found = other.closest_hit(rays, fields=["t", "position"])
        assert np.array_equal(found.t, wanted.t) and np.array_equal(found.position, wanted.position)
    # What is added to a scene that was read lies where it is said to lie.
    number = described.add_mesh(MAP + [5, 0, 0] + vertices, faces)
    hit = described.closest_hit([*(MAP + [5, 0, 3]), 0, 0, -1], fields=["object", "position"])
    assert hit.object == number and np.abs(hit.position[:2] - MAP[:2] - [5, 0]).max() < 1e-5


def test_the_adapter_of_open3d_keeps_the_digits(scan):
    vertices, faces = scan
    casting = RaycastingScene()
    casting.add_triangles(MAP + vertices, faces)
    points = np.random.default_rng(11).uniform(-0.8, 0.8, (300, 3))
    distance, _ = nearest_on_triangles(vertices, faces, points)
    found = casting.compute_closest_points(MAP + points)["points"].numpy()
    assert np.abs(np.linalg.norm(found - MAP - points, axis=1) - distance).max() < 8 * STEP
    inside = np.linalg.norm(points, axis=1) < 0.47
    assert casting.compute_occupancy(MAP + points).numpy()[inside].all()
    assert (casting.compute_signed_distance(MAP + points).numpy()[inside] < 0).all()
    view = RaycastingScene.create_rays_pinhole(
        fov_deg=30, center=MAP, eye=MAP + [0.125, 0.3, 3], up=[0, 1, 0], width_px=32, height_px=32
    )
    assert view.dtype == np.float64
    t = casting.cast_rays(view)["t_hit"].numpy()
    near = RaycastingScene()
    near.add_triangles(vertices, faces)
    near_view = RaycastingScene.create_rays_pinhole(
        fov_deg=30, center=[0, 0, 0], eye=[0.125, 0.3, 3], up=[0, 1, 0], width_px=32, height_px=32
    )
    assert near_view.dtype == np.float32
    near_t = near.cast_rays(near_view)["t_hit"].numpy()
    both = np.isfinite(t) & np.isfinite(near_t)
    assert both.sum() > 100 and np.median(np.abs(t - near_t)[both]) < 16 * STEP
