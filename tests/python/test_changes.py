"""Scenes whose objects change: the answers are those of scenes made afresh."""

import pickle

import numpy as np
import pytest

import oktett
from oracle import CUBE_FACES, CUBE_VERTICES, ball, random_rays

FIELDS = ["t", "object", "primitive", "instance", "uv", "normal", "position", "texcoord", "color"]
NONE = 0xFFFFFFFF


def described():
    """Objects that are read, two of them instances."""
    vertices, faces = ball(1)
    return {
        "define": {"bead": {"mesh": {"vertices": vertices, "faces": faces}}},
        "objects": [
            {"sphere": {"radius": 0.5, "center": [3, 0, 0]}, "name": "sphere"},
            {"instance": "bead", "transform": [{"translate": [-3, 0, 0]}], "name": "left"},
            {"mesh": {"vertices": CUBE_VERTICES, "faces": CUBE_FACES},
             "transform": [{"translate": [0, 0, 3]}], "name": "cube"},
            {"instance": "bead", "transform": [{"translate": [0, -3, 0]}], "name": "low"},
        ],
    }  # fmt: skip


def moved(x, y, z, scale=1.0):
    matrix = np.eye(4)
    matrix[:3, :3] *= scale
    matrix[:3, 3] = x, y, z
    return matrix


def answers(scene, rays, **more):
    hits = scene.closest_hit(rays, fields=FIELDS, **more)
    lists = scene.all_hits(rays, fields=FIELDS, **more)
    columns = [getattr(hits, name) for name in FIELDS] + [getattr(lists, name) for name in FIELDS]
    return columns + [scene.any_hit(rays, **more), scene.count_hits(rays, **more)]


def expect_same(a, b, rays, **more):
    for x, y in zip(answers(a, rays, **more), answers(b, rays, **more)):
        np.testing.assert_array_equal(x, y)


class Model:
    """What a scene should hold, and the same scene made afresh."""

    def __init__(self, with_description):
        self.with_description = with_description
        self.meshes = []  # vertices, faces, transform, state

    def base(self):
        return oktett.Scene.from_dict(described()) if self.with_description else oktett.Scene()

    def afresh(self):
        scene = self.base()
        for vertices, faces, transform, enabled in self.meshes:
            # The numbers of those that were removed are not given again.
            number = scene.add_mesh(vertices, faces, transform=transform)
            if enabled != "shown":
                scene.disable(number)
        return scene


@pytest.mark.parametrize("with_description", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_changed_scenes_answer_as_fresh_ones(with_description, seed):
    random = np.random.default_rng(seed)
    model = Model(with_description)
    scene = model.base()
    numbers = []

    def add():
        vertices, faces = ball(int(random.integers(0, 3)))
        transform = moved(*random.normal(size=3) * 2, random.uniform(0.5, 1.5)) if random.random() < 0.6 else None
        numbers.append(scene.add_mesh(vertices, faces, transform=transform))
        model.meshes.append([vertices, faces, transform, "shown"])

    add()
    for step in range(14):
        k = int(random.integers(len(numbers)))
        what = random.integers(6)
        mesh = model.meshes[k]
        if mesh[3] == "removed" or what == 0:
            add()
        elif what == 1:
            mesh[3] = "hidden" if mesh[3] == "shown" else "shown"
            (scene.enable if mesh[3] == "shown" else scene.disable)(numbers[k])
        elif what == 2 and len(numbers) > 2:
            mesh[3] = "removed"
            scene.remove(numbers[k])
        elif what == 3:
            mesh[2] = moved(*random.normal(size=3) * 2, random.uniform(0.5, 1.5))
            scene.set_transform(numbers[k], mesh[2])
        else:
            first = int(random.integers(len(mesh[0])))
            part = mesh[0][first:] + random.normal(size=(len(mesh[0]) - first, 3)) * random.choice([0.01, 0.5])
            mesh[0] = np.concatenate([mesh[0][:first], part])
            scene.set_vertices(numbers[k], part, first)
        if random.random() < 0.7:
            expect_same(scene, model.afresh(), random_rays(2000, 4.0, seed=step))
    expect_same(scene, model.afresh(), random_rays(2000, 4.0, seed=99))
    np.testing.assert_array_equal(scene.bounds, model.afresh().bounds)
    points = random.normal(size=(300, 3)) * 3
    fresh = model.afresh()
    np.testing.assert_array_equal(scene.inside(points), fresh.inside(points))
    np.testing.assert_array_equal(scene.closest_point(points).distance, fresh.closest_point(points).distance)
    expect_same(pickle.loads(pickle.dumps(scene)), scene, random_rays(2000, 4.0, seed=5))


def test_objects_that_were_read_are_moved_hidden_and_removed():
    scene = oktett.Scene.from_dict(described())
    rays = random_rays(4000, 4.0, seed=3)
    names = scene.objects
    numbers = {name: names.index(name) for name in ("sphere", "left", "cube", "low")}
    seen = set(scene.closest_hit(rays).object)
    assert {numbers["sphere"], numbers["cube"]} <= seen
    scene.set_transform(numbers["sphere"], moved(0, 0, 1))
    scene.set_transform(numbers["left"], moved(-2, 1, 0))
    scene.disable(numbers["cube"])
    scene.remove(numbers["low"])
    fresh = described()
    fresh["objects"][0]["transform"] = [{"translate": [0, 0, 1]}]
    fresh["objects"][1]["transform"] = [{"translate": [-2, 1, 0]}]
    del fresh["objects"][2:]
    a, b = scene.closest_hit(rays), oktett.Scene.from_dict(fresh).closest_hit(rays)
    np.testing.assert_array_equal(a.t, b.t)
    assert np.isfinite(a.t).any() and not np.isin([numbers["cube"], numbers["low"]], a.object).any()
    scene.enable(numbers["cube"])
    assert (scene.closest_hit(rays).object == numbers["cube"]).any()
    copy = pickle.loads(pickle.dumps(scene))
    expect_same(copy, scene, rays)
    picture = {"width": 24, "height": 24, "samples": 1, "planes": ["Z"], "integrator": "normal"}
    camera = {"from": [0, 0, 9], "at": [0, 0, 0]}
    before = scene.render(camera=camera, **picture)["Z"]
    scene.disable(numbers["cube"])
    assert not np.array_equal(before, scene.render(camera=camera, **picture)["Z"])


def test_masks_tell_what_rays_meet():
    vertices, faces = ball(1)
    scene = oktett.Scene.from_dict(described())
    near = scene.add_mesh(vertices, faces, transform=moved(0, 0, 6))
    far = scene.add_mesh(vertices, faces, transform=moved(0, 0, -6))
    ray = [[0, 0.01, 9, 0, 0, -1]]
    scene.set_mask(near, 1), scene.set_mask(far, 2)
    cube = scene.objects.index("cube")
    assert scene.closest_hit(ray).object[0] == near
    assert scene.closest_hit(ray, mask=1).object[0] == near
    assert scene.closest_hit(ray, mask=2).object[0] == cube
    assert scene.count_hits(ray)[0] == scene.count_hits(ray, mask=1)[0] + 2
    # What was read has all bits, but no ray without bits meets anything.
    assert scene.any_hit(ray, mask=4).all() and not scene.any_hit(ray, mask=0).any()
    assert set(scene.all_hits(ray, mask=2).object) == {cube, far}
    copy = pickle.loads(pickle.dumps(scene))
    assert copy.closest_hit(ray, mask=2).object[0] == cube
    # One for each ray.
    rays = np.repeat(np.reshape(random_rays(3000, 4.0, seed=2), (3000, 1, 6)), 2, axis=1)
    masks = np.random.default_rng(1).integers(0, 8, size=(3000, 2))
    hits, any_hit, counts = (
        scene.closest_hit(rays, fields=["t", "object", "primitive"], mask=masks),
        scene.any_hit(rays, mask=masks),
        scene.count_hits(rays, mask=masks.astype(np.uint32)),
    )
    for mask in range(8):
        own = masks == mask
        for name in ("t", "object", "primitive"):
            alone = getattr(scene.closest_hit(rays, fields=[name], mask=mask), name)
            np.testing.assert_array_equal(getattr(hits, name)[own], alone[own])
        np.testing.assert_array_equal(any_hit[own], scene.any_hit(rays, mask=mask)[own])
        np.testing.assert_array_equal(counts[own], scene.count_hits(rays, mask=mask)[own])
    for wrong in (-1, 2**32, 1.5, masks[:5], masks * 1.0, masks - 9, masks + 2**32):
        with pytest.raises((ValueError, TypeError), match="mask"):
            scene.any_hit(rays, mask=wrong)
    with pytest.raises(ValueError, match="was read: only meshes that were added have masks"):
        scene.set_mask(cube, 1)


def test_many_masks_that_see_different_things_are_refused():
    vertices, faces = ball(0)
    scene = oktett.Scene()
    for k in range(8):
        scene.set_mask(scene.add_mesh(vertices, faces, transform=moved(3 * k, 0, 0)), 1 << k)
    rays = random_rays(256, 4.0, seed=1)
    with pytest.raises(ValueError, match="256 masks that see different things; expected at most 64"):
        scene.any_hit(rays, mask=np.arange(256))
    assert scene.any_hit(rays, mask=np.arange(256) << 20).sum() == 0
    with pytest.raises(ValueError, match="a mask needs at least one bit"):
        scene.set_mask(0, 0)


def test_what_counts_from_elsewhere_is_not_misplaced():
    vertices, faces = ball(0)
    far = np.array([1e6, 2e6, 300.0])
    mesh = {"mesh": {"vertices": vertices + far, "faces": faces}}
    scene = oktett.Scene.from_dict({"objects": [{"union": [mesh, {**mesh, "transform": [{"translate": [0, 0, 1]}]}],
                                                 "name": "both"}]})  # fmt: skip
    with pytest.raises(ValueError, match="is a combination or an instance of what lies far"):
        scene.set_transform(scene.objects.index("both"), np.eye(4))
    # The vertices that stay keep digits that floats lack.
    place = np.array([432100.0, 5411000.0, 300.0])
    small = vertices.astype(float) * 0.01 + place
    scene = oktett.Scene(small, faces)
    ray = [[place[0] + 0.001, place[1] + 0.002, place[2] + 3, 0, 0, -1]]
    before = scene.closest_hit(ray).t
    scene.set_vertices(0, small[:1].astype(np.float32))
    scene.set_vertices(0, small[:1])
    np.testing.assert_array_equal(scene.closest_hit(ray).t, before)


def test_vertices_that_move_far_count_from_elsewhere():
    vertices, faces = ball(2)
    place = np.array([432100.25, 5411000.5, 300])
    scene = oktett.Scene(vertices, faces)
    scene.any_hit([[0, 0, 5, 0, 0, -1]])
    for shift in (place, place * 2, place * 0):
        scene.set_vertices(0, vertices + shift)
        fresh = oktett.Scene(vertices + shift, faces)
        rays = random_rays(500, 2.0, seed=1).astype(np.float64)
        rays[:, :3] += shift
        np.testing.assert_array_equal(scene.origin, fresh.origin)
        expect_same(scene, fresh, rays)


def test_normals_move_with_vertices():
    vertices, faces = ball(1)
    normals = vertices / np.linalg.norm(vertices, axis=1)[:, None]
    scene = oktett.Scene(vertices, faces, normals=normals)
    picture = {"width": 24, "height": 24, "samples": 1, "planes": ["N.X", "N.Y", "N.Z"], "integrator": "normal"}
    scene.render(**picture)
    scene.set_vertices(0, vertices * 2, normals=-normals)
    fresh = oktett.Scene(vertices * 2, faces, normals=-normals)
    a, b = scene.render(**picture), fresh.render(**picture)
    for name in picture["planes"]:
        np.testing.assert_array_equal(a[name], b[name])
    # Some vertices have none, before or after.
    lacking = np.where(np.arange(len(normals))[:, None] % 3 == 0, 0, normals)
    for first, second in ((0 * normals, normals), (normals, lacking), (lacking, normals)):
        scene = oktett.Scene(vertices, faces, normals=first)
        scene.render(**picture)
        scene.set_vertices(0, vertices, normals=second)
        a, b = scene.render(**picture), oktett.Scene(vertices, faces, normals=second).render(**picture)
        for name in picture["planes"]:
            np.testing.assert_array_equal(a[name], b[name])
    soup = vertices[np.ravel(faces)]
    scene = oktett.Scene(soup, np.arange(len(soup)).reshape(-1, 3), normals=np.reshape(soup, (-1, 3, 3)))
    scene.set_vertices(0, soup * 2, normals=soup)


def test_wrong_changes_are_errors():
    vertices, faces = ball(0)
    scene = oktett.Scene.from_dict(described())
    number = scene.add_mesh(vertices, faces)
    bead = 0  # stands in the prototype
    for call, message in (
        (lambda: scene.remove(99), "object 99 does not exist"),
        (lambda: scene.disable(bead), "object 0 stands in a prototype or a combination"),
        (lambda: scene.set_transform(number, np.zeros((3, 4))), "transform: the matrix has no inverse"),
        (lambda: scene.set_vertices(number, vertices, 1), "6 vertices; 6 from number 1 on were given"),
        (lambda: scene.set_vertices(number, [[1, 2]]), r"vertices: expected an array of numbers of shape"),
        (lambda: scene.set_vertices(number, vertices, normals=vertices), "has no normals of vertices"),
        (lambda: scene.set_vertices(number, vertices, normals=vertices[:3]), r"normals: expected an array of shape \(6, 3\)"),
        (lambda: scene.set_vertices(1, vertices), "was read: only meshes that were added have vertices"),
    ):
        with pytest.raises(ValueError, match=message):
            call()
    scene.remove(number)
    assert len(pickle.dumps(scene)) < 10000
    with pytest.raises(ValueError, match=f"object {number} was removed"):
        scene.enable(number)


def test_ignored_primitives_are_passed():
    scene = oktett.Scene()
    rng = np.random.default_rng(7)
    meshes = []
    for _ in range(3):
        vertices = rng.uniform(-1, 1, (60, 3)).astype(np.float32)
        faces = rng.permutation(60).reshape(20, 3).astype(np.uint32)
        meshes.append(scene.add_mesh(vertices, faces))
    rays = np.concatenate([rng.uniform(-2, 2, (2000, 3)), rng.normal(size=(2000, 3))], axis=1)
    flags = {meshes[0]: rng.random(20) < 0.5, meshes[2]: np.ones(12, bool)}
    lists = scene.all_hits(rays)
    ignored = np.zeros(len(lists.t), bool)
    for number, of_object in flags.items():
        inside = (lists.object == number) & (lists.primitive < len(of_object))
        ignored[inside] = of_object[lists.primitive[inside]]
    assert ignored.any() and not ignored.all()
    ray = np.repeat(np.arange(2000), np.diff(lists.splits))
    counts = np.bincount(ray[~ignored], minlength=2000)
    np.testing.assert_array_equal(scene.count_hits(rays, ignore=flags), counts)
    np.testing.assert_array_equal(scene.any_hit(rays, ignore=flags), counts > 0)
    kept = scene.all_hits(rays, ignore=flags)
    for name in ("t", "object", "primitive"):
        np.testing.assert_array_equal(getattr(kept, name), getattr(lists, name)[~ignored])
    np.testing.assert_array_equal(np.diff(kept.splits), counts)
    nearest = scene.closest_hit(rays, ignore=flags)
    first = kept.splits[:-1][counts > 0]
    np.testing.assert_array_equal(nearest.t[counts > 0], kept.t[first])
    np.testing.assert_array_equal(nearest.primitive[counts > 0], kept.primitive[first])
    assert np.isinf(nearest.t[counts == 0]).all()
    for wrong in ([1], {0: [1.0]}, {0: [[True]]}, {-1: [True]}, {"a": [True]}):
        with pytest.raises(ValueError, match="ignore"):
            scene.any_hit(rays, ignore=wrong)
