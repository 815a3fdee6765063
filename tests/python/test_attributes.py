"""What meshes carry: normals, texture coordinates, colours and other numbers, given and found again."""

import pickle

import numpy as np
import pytest

import oktett
from oracle import ball, random_rays

VERTICES, FACES = ball(2)
RANDOM = np.random.default_rng(5)


def weighted(at_corners, uv):
    """Values at hits of triangles with these values at their corners, (n, 3, k)."""
    u, v = uv[:, :1].astype(np.longdouble), uv[:, 1:].astype(np.longdouble)
    corners = at_corners.astype(np.longdouble)
    return corners[:, 0] * (1 - u - v) + corners[:, 1] * u + corners[:, 2] * v


def linear(part):
    part = np.asarray(part, np.longdouble)
    return np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)


def shot(scene, fields):
    hits = scene.closest_hit(random_rays(4000, 1.0, seed=3), fields=["primitive", "uv", *fields])
    hit = hits.primitive != 0xFFFFFFFF
    assert 500 < hit.sum() < 3900
    return hits, hit


def expect_close(found, expected):
    assert found.dtype == np.float32 and found.shape == expected.shape
    # Half a unit in the last place, and what the sum in double may be off by.
    assert (np.abs(found - expected) <= np.spacing(np.abs(expected).astype(np.float32)) * 0.5001 + 1e-14).all()


@pytest.mark.parametrize("where", ["vertices", "faces", "corners"])
@pytest.mark.parametrize("size", [0, 1, 2, 3, 4])
def test_attributes_are_interpolated(where, size):
    shape = {"vertices": (len(VERTICES),), "faces": (len(FACES),), "corners": (len(FACES), 3)}[where]
    if where == "corners" and size == 0:
        size = 1
    values = RANDOM.normal(size=shape + ((size,) if size else ())).astype(np.float32)
    scene = oktett.Scene(VERTICES, FACES, attributes={"flow": values, "other": np.zeros(len(FACES))})
    hits, hit = shot(scene, ["attribute:flow", "attribute:other"])
    found = hits.attributes["flow"]
    assert found.shape == (4000,) + ((size,) if size > 1 else ())
    triangles = hits.primitive[hit]
    rows = values.reshape(shape + (max(size, 1),))
    corners = {"vertices": lambda: rows[FACES[triangles]], "corners": lambda: rows[triangles],
               "faces": lambda: np.repeat(rows[triangles][:, None], 3, axis=1)}[where]()
    expect_close(found[hit].reshape(len(triangles), -1), weighted(corners, hits.uv[hit]))
    assert np.isnan(found[~hit]).all() and (hits.attributes["other"][hit] == 0).all()


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.float32, np.float64])
def test_colors_are_linear(kind):
    colors = RANDOM.random((len(VERTICES), 4)).astype(kind) if kind in (np.float32, np.float64) else \
        RANDOM.integers(0, np.iinfo(kind).max + 1, (len(VERTICES), 4)).astype(kind)
    most = np.iinfo(kind).max if colors.dtype.kind == "u" else 1
    expected = (linear(colors / most) if most > 1 else colors).astype(np.float32)
    scene = oktett.Scene(VERTICES, FACES, colors=colors[:, :3])
    hits, hit = shot(scene, ["color"])
    assert hits.color.shape == (4000, 3) and np.isnan(hits.color[~hit]).all()
    exact = weighted(expected[FACES[hits.primitive[hit]]][..., :3], hits.uv[hit])
    assert hits.color[hit] == pytest.approx(exact.astype(float), rel=2e-7, abs=1e-9)
    with_alpha = oktett.Scene(VERTICES, FACES, colors=colors)
    assert shot(with_alpha, ["attribute:color"])[0].attributes["color"].shape == (4000, 4)


def test_normals_and_texture_coordinates():
    normals = VERTICES * np.float32(3)
    uvs = RANDOM.random((len(FACES), 3, 2)).astype(np.float32)
    scene = oktett.Scene(VERTICES, FACES, normals=normals, uvs=uvs)
    hits, hit = shot(scene, ["texcoord"])
    expect_close(hits.texcoord[hit], weighted(uvs[hits.primitive[hit]], hits.uv[hit]))
    bare = oktett.Scene(VERTICES, FACES)
    assert np.isnan(shot(bare, ["texcoord"])[0].texcoord).all()
    # Smooth: the pictures of normals differ.
    view = dict(integrator="normal", camera={"from": [0, 0, 4], "at": [0, 0, 0]}, planes=["R", "A"])
    smooth, flat = scene.render(64, 64, **view), bare.render(64, 64, **view)
    assert (smooth["R"] != flat["R"])[smooth["A"] > 0].mean() > 0.9
    at_corners = oktett.Scene(VERTICES, FACES, normals=normals[FACES])
    assert np.array_equal(at_corners.render(64, 64, **view)["R"], smooth["R"])


def test_all_queries_know_them():
    scene = oktett.Scene(VERTICES, FACES, colors=np.ones((len(VERTICES), 3)), attributes={"q": np.arange(len(FACES))})
    rays = random_rays(500, 1.0, seed=4)
    fields = ["primitive", "uv", "color", "attribute:q", "texcoord"]
    lists = scene.all_hits(rays, fields=fields)
    assert (lists.attributes["q"] == lists.primitive).all() and (lists.color == 1).all()
    assert lists.color.shape == (len(lists.primitive), 3)
    nearest = scene.closest_point(rays[:, :3], fields=fields)
    assert (nearest.attributes["q"] == nearest.primitive).all() and nearest.color.shape == (500, 3)
    assert scene.closest_hit(rays, fields=["t"]).attributes is None


def test_several_meshes():
    scene = oktett.Scene(VERTICES, FACES, attributes={"q": np.ones(len(VERTICES))})
    scene.add_mesh(VERTICES + np.float32(5), FACES, attributes={"q": np.full((len(VERTICES), 2), 2.0)})
    scene.add_mesh(VERTICES - np.float32(5), FACES)
    rays = np.array([[x, x, x + 3, 0.01, 0, -1] for x in (0, 5, -5)], np.float32)
    found = scene.closest_hit(rays, fields=["object", "attribute:q"])
    assert found.object.tolist() == [0, 1, 2]
    assert found.attributes["q"][:2, 0].tolist() == [1, 2] and np.isnan(found.attributes["q"][2]).all()


def picture(scene):
    return scene.render(32, 32, integrator="whitted", camera={"from": [0, 0, 4], "at": [0, 0, 0]})


def test_materials():
    colors = np.zeros((len(FACES), 3))
    colors[:, 1] = 1
    shown = picture(oktett.Scene(VERTICES, FACES, colors=colors))
    inside = shown["A"] == 1
    assert shown["Albedo.G"][inside].min() > 0 and shown["Albedo.R"][inside].max() == 0
    red = picture(oktett.Scene(VERTICES, FACES, colors=colors, material={"emission": [1, 0, 0], "color": [0, 0, 0]}))
    assert red["R"][inside].min() > 0 and red["G"][inside].max() == 0
    glow = {"color": [0, 0, 0], "emission": {"attribute": "heat"}}
    hot = picture(oktett.Scene(VERTICES, FACES, attributes={"heat": np.full(len(FACES), 0.25)}, material=glow))
    assert (hot["R"][inside] == 0.25).all()
    named = oktett.Scene.from_dict({"materials": {"gold": {"emission": [1, 0.5, 0], "color": [0, 0, 0]}}})
    named.add_mesh(VERTICES, FACES, material="gold")
    assert (picture(named)["G"][inside] == 0.5).all()
    with pytest.raises(ValueError, match="no material 'golf'; did you mean 'gold'"):
        named.add_mesh(VERTICES, FACES, material="golf")
    with pytest.raises(ValueError, match="colour"):
        named.add_mesh(VERTICES, FACES, material={"colour": 1})


def test_pickles_and_dicts_hold_them():
    given = dict(
        normals=VERTICES, uvs=RANDOM.random((len(VERTICES), 2)), colors=RANDOM.integers(0, 256, (len(FACES), 3), np.uint8),
        attributes={"flow": RANDOM.random((len(VERTICES), 3)), "label": np.arange(len(FACES))})
    scene = oktett.Scene(VERTICES, FACES, material={"emission": {"attribute": "flow"}}, **given)
    again = pickle.loads(pickle.dumps(scene))
    described = oktett.Scene.from_dict({"objects": [{"mesh": {"vertices": VERTICES, "faces": FACES, **given}}]})
    fields = ["primitive", "uv", "texcoord", "color", "attribute:flow", "attribute:label"]
    rays = random_rays(300, 1.0, seed=6)
    wanted = scene.closest_hit(rays, fields=fields)
    for other in (again, described):
        found = other.closest_hit(rays, fields=fields)
        for name in ("primitive", "uv", "texcoord", "color"):
            assert np.array_equal(getattr(found, name), getattr(wanted, name), equal_nan=True), name
        for name in ("flow", "label"):
            assert np.array_equal(found.attributes[name], wanted.attributes[name], equal_nan=True), name
    assert np.array_equal(picture(scene)["R"], picture(again)["R"])
    wedges = oktett.Scene.from_dict({"objects": [{"mesh": {
        "vertices": VERTICES, "faces": FACES, "uvs": RANDOM.random((len(FACES), 3, 2)), "attributes": given["attributes"]}}]})
    assert np.array_equal(wedges.closest_hit(rays, fields=fields).attributes["flow"], wanted.attributes["flow"],
                          equal_nan=True)


@pytest.mark.parametrize("given, message", [
    (dict(normals=np.ones((3, 2))), r"normals: expected an array of numbers of shape \(\.\.\., 3\)"),
    (dict(normals=np.ones((len(FACES), 3))), r"normals: expected an array of shape \(n, 3\) or \(m, 3, 3\)"),
    (dict(uvs=np.full((len(VERTICES), 2), np.nan)), "uvs: expected finite numbers"),
    (dict(colors=np.ones(len(VERTICES))), "colors: expected an array of shape"),
    (dict(colors=np.ones((len(VERTICES), 3), int)), "colors: expected floats, uint8 or uint16, found elements of type int64"),
    (dict(attributes=[1]), "attributes: expected a dict of arrays"),
    (dict(attributes={"a": np.ones(7)}), r"attributes\['a'\]: expected an array of shape"),
    (dict(attributes={"a": np.array(["x"] * len(VERTICES))}), r"attributes\['a'\]: expected numbers"),
    (dict(attributes={"": np.ones(len(VERTICES))}), "attributes: expected names"),
    (dict(attributes={"color": np.ones(len(VERTICES))}, colors=np.ones((len(VERTICES), 3))), "'colors' gives this attribute"),
    (dict(material=3), "material: expected a dict with the keys of a material, or a name"),
])
def test_errors_say_what_is_wrong(given, message):
    with pytest.raises(ValueError, match=message):
        oktett.Scene(VERTICES, FACES, **given)


def test_unknown_attributes_are_told():
    scene = oktett.Scene(VERTICES, FACES, attributes={"quality": np.ones(len(VERTICES))})
    with pytest.raises(ValueError, match="no mesh has an attribute 'qualty'; did you mean 'quality'"):
        scene.closest_hit(np.zeros((1, 6)), fields=["attribute:qualty"])
    assert np.isnan(scene.closest_hit(np.zeros((1, 6)), fields=["color"]).color).all()
