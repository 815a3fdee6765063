"""Scenes from files, texts and dicts: what is hit, what is rendered, what survives pickling."""

import os
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import oktett
from oracle import CUBE_FACES, CUBE_VERTICES, ball, random_rays, read_exr

SOURCE = Path(os.environ.get("OKTETT_SOURCE_DIR", Path(__file__).parents[2]))
COMMAND = os.environ.get("OKTETT_COMMAND")
SANITIZED = "asan" in os.environ.get("LD_PRELOAD", "")


def mixed():
    """Exact surfaces, a combination, prototypes and a mesh of arrays in all places where one may stand."""
    vertices, faces = ball(1)
    mesh = {"mesh": {"vertices": vertices, "faces": faces}}
    return {
        "define": {"bead": mesh},
        "objects": [
            {"sphere": {"radius": 1.5, "center": [4, 0, 0]}, "name": "sphere"},
            {"torus": {"major": 2, "minor": 0.5}, "transform": [{"translate": [0, 4, 0]}], "name": "torus"},
            {"difference": [{"box": {}}, {**mesh, "transform": [{"scale": 1.2}]}], "name": "dented"},
            {"instance": "bead", "transform": [{"translate": [-4, 0, 0]}], "name": "left"},
            {"instance": "bead", "transform": [{"scale": 2}, {"translate": [0, -4, 0]}], "name": "low"},
            {"mesh": {"vertices": CUBE_VERTICES, "faces": CUBE_FACES, "smooth": False},
             "transform": [{"translate": [0, 0, np.float64(5)]}], "name": "cube"},
        ],
    }  # fmt: skip


def same(a, b):
    return all(np.array_equal(x, y) for x, y in zip(a, b) if x is not None)


def test_exact_surfaces_are_hit_where_their_equations_are_zero():
    scene = oktett.Scene.from_dict(mixed())
    rays = random_rays(20000, 5.0, seed=1)
    hits = scene.closest_hit(rays, fields=["t", "object", "instance", "normal", "position", "uv"])
    names = np.array(scene.objects + ["miss"])[np.minimum(hits.object, len(scene.objects))]
    p = rays[:, :3] + hits.t[:, None].astype(float) * rays[:, 3:]
    on = {name: p[names == name] for name in ("sphere", "torus")}
    assert all(len(points) > 200 for points in on.values())
    assert np.linalg.norm(on["sphere"] - [4, 0, 0], axis=1) == pytest.approx(1.5, abs=2e-5)
    x, y, z = (on["torus"] - [0, 4, 0]).T
    tube = min((np.hypot(np.hypot(x, y) - 2, z), np.hypot(np.hypot(x, z) - 2, y)), key=lambda d: np.ptp(d))
    assert tube == pytest.approx(0.5, abs=5e-5)
    sphere = names == "sphere"
    assert hits.normal[sphere] == pytest.approx((on["sphere"] - [4, 0, 0]) / 1.5, abs=2e-5)
    assert not hits.uv[sphere].any()
    inside_box = np.all(np.abs(p) < 1.001, axis=1) & np.isfinite(hits.t)
    assert inside_box.sum() > 100 and (hits.instance[names == "sphere"] == 0xFFFFFFFF).all()
    found = hits.instance[np.isfinite(hits.t) & ~np.isin(names, ["sphere", "torus", "cube"])]
    assert (found != 0xFFFFFFFF).all()


def test_the_closest_sphere_is_that_of_a_formula():
    spheres = np.random.default_rng(2).uniform(-3, 3, (20, 3))
    scene = oktett.Scene.from_dict({"objects": [{"sphere": {"center": c, "radius": 0.5}} for c in spheres]})
    rays = random_rays(5000, 3.0, seed=3)
    o, d = rays[:, None, :3].astype(float), rays[:, None, 3:].astype(float)
    a, b, c = (d * d).sum(-1), (d * (o - spheres)).sum(-1), ((o - spheres) ** 2).sum(-1) - 0.25
    with np.errstate(invalid="ignore"):
        root = np.sqrt(b * b - a * c)
        t = np.where((-b - root) / a > 0, (-b - root) / a, (-b + root) / a)
    t = np.where(t > 0, t, np.inf)
    sure = (np.abs(b * b - a * c) > 1e-4 * a).all(axis=1)
    hits = scene.closest_hit(rays)
    assert hits.t[sure] == pytest.approx(t.min(axis=1)[sure], rel=1e-4)
    struck = sure & np.isfinite(t.min(axis=1))
    assert struck.sum() > 1000 and (hits.object[struck] == t.argmin(axis=1)[struck]).all()


def test_objects_are_numbered_as_their_names_stand():
    scene = oktett.Scene.from_dict(mixed())
    assert scene.objects == ["", "sphere", "torus", "dented", "dented", "dented", "left", "low", "cube"]
    # A mesh that is added has the next number.
    assert scene.add_mesh(CUBE_VERTICES + np.float32([0, 0, 9]), CUBE_FACES, name="late") == 9
    assert scene.objects[9] == "late" and scene.closest_hit([0.1, 0.2, 20, 0, 0, -1]).object == 9


def test_arrays_in_a_dict_are_the_meshes_they_say():
    vertices, faces = ball(2)
    rays = random_rays(2000, 1.0, seed=4)
    direct = oktett.Scene(vertices, faces).closest_hit(rays)
    for kind in (np.float64, np.float32):
        scene = oktett.Scene.from_dict({"objects": [{"mesh": {"vertices": vertices.astype(kind), "faces": faces.tolist()}}]})
        assert same(direct, scene.closest_hit(rays))
    for mesh, message in (
        ({"vertices": vertices}, "both vertices and faces"),
        ({"vertices": vertices, "faces": faces, "file": "a.obj"}, "both vertices and faces, or a file"),
        ({"vertices": vertices[:, :2], "faces": faces}, r"vertices: .*\(n, 3\)"),
        ({"vertices": vertices, "faces": faces + 0.5}, r"faces: .*\(m, 3\)"),
        ({"vertices": vertices, "faces": faces - 1}, "faces: expected indices of vertices"),
        ({"vertices": vertices, "faces": faces, "smoth": True}, r"<dict>.yaml:\d+:\d+: .*did you mean 'smooth'"),
    ):
        with pytest.raises(ValueError, match=message):
            oktett.Scene.from_dict({"objects": [{"mesh": mesh}]})
    for bad in (None, [], {"objects": [object()]}, {"objects": [{"sphere": {"radius": float("nan")}}]}):
        with pytest.raises(ValueError):
            oktett.Scene.from_dict(bad)


def test_texts_are_scene_files_with_files_of_their_own(tmp_path):
    obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    text = "oktett: 1\nobjects:\n  - mesh: {file: part/a.obj}\n  - sphere: {radius: '${r}', center: [5, 0, 0]}\n"
    scene = oktett.Scene.from_text(text, files={"part/a.obj": obj}, definitions={"r": "0.5"})
    rays = [[0.2, 0.2, 1, 0, 0, -1], [5, 0, 9, 0, 0, -1]]
    assert scene.closest_hit(rays).t.tolist() == [1, 8.5]
    # The same with files on the disk: those that are given come first.
    (tmp_path / "part").mkdir()
    (tmp_path / "part/a.obj").write_bytes(obj.replace(b"0 0 0", b"0 0 9"))
    there = oktett.Scene.from_text(text, name=str(tmp_path / "x.yaml"), definitions={"r": "0.5"})
    assert there.closest_hit(rays[0]).t == np.inf
    given = oktett.Scene.from_text(text, name=str(tmp_path / "x.yaml"), files={"part/a.obj": obj}, definitions={"r": "0.5"})
    assert given.closest_hit(rays[0]).t == 1
    with pytest.raises(ValueError, match=r"^<text>.yaml:3:18: 'part/a.obj': no such file$"):
        oktett.Scene.from_text(text, definitions={"r": "1"})
    with pytest.raises(ValueError, match=r"^<text>.yaml:1:1: "):
        oktett.Scene.from_text("objects: []\n")
    with pytest.raises(ValueError, match=r"^a.yaml:2:1: unknown key 'objcts' in a scene; did you mean 'objects'\?$"):
        oktett.Scene.from_text("oktett: 1\nobjcts: []\n", name="a.yaml")


def test_files_that_cannot_be_read_are_errors_of_the_system(tmp_path):
    with pytest.raises(OSError, match="no such file"):
        oktett.Scene.from_file(tmp_path / "none.obj")
    (tmp_path / "a.txt").write_text("")
    with pytest.raises(ValueError, match="unknown kind of file"):
        oktett.Scene.from_file(tmp_path / "a.txt")
    (tmp_path / "bad.obj").write_text("v 0 0 0\nf 1 2 3\n")
    with pytest.raises(ValueError, match=r"bad.obj:2"):
        oktett.Scene.from_file(str(tmp_path / "bad.obj"))
    with pytest.raises(ValueError, match="quality"):
        oktett.Scene.from_file(tmp_path / "bad.obj", quality="good")
    with pytest.raises(TypeError):
        oktett.Scene.from_file(3)


def test_a_pickle_holds_all_files(tmp_path):
    vertices, faces = ball(1)
    lines = [f"v {x} {y} {z}" for x, y, z in vertices] + [f"f {i} {j} {k}" for i, j, k in faces + 1]
    obj, scene_file, heights = tmp_path / "ball.obj", tmp_path / "scene.yaml", tmp_path / "h.ppm"
    obj.write_text("\n".join(lines) + "\n")
    heights.write_bytes(b"P5\n4 4\n255\n" + bytes(range(0, 256, 16)))
    # One by a relative path, one by an absolute one.
    scene_file.write_text(
        "oktett: 1\n"
        f"objects:\n  - mesh: {{file: ball.obj}}\n  - mesh: {{file: {obj}}}\n    transform: [{{translate: [3, 0, 0]}}]\n"
        f"  - height_field: {{file: {heights}}}\n    transform: [{{translate: [0, 3, 0]}}]\n"
    )
    scene = oktett.Scene.from_file(scene_file)
    scene.add_mesh(CUBE_VERTICES, CUBE_FACES, transform=np.eye(4)[:3] + [0, 0, 0, 6], name="cube")
    rays = random_rays(20000, 4.0, seed=5)
    before = scene.closest_hit(rays, fields=["t", "object", "primitive", "instance", "uv", "normal", "position"])
    picture = scene.render(32, 24, samples=1)
    assert len(np.unique(before.object)) == 5
    data = pickle.dumps(scene)
    for path in (obj, scene_file, heights):
        path.unlink()
    again = pickle.loads(data)
    assert same(before, again.closest_hit(rays, fields=before._fields))
    assert again.objects == scene.objects and again.source == scene.source
    repeated = again.render(32, 24, samples=1)
    assert all(np.array_equal(picture[name], repeated[name]) for name in picture)
    # A pickle of the copy needs no files either.
    assert same(before, pickle.loads(pickle.dumps(again)).closest_hit(rays, fields=before._fields))
    with pytest.raises(OSError, match="has changed since the scene was read"):
        pickle.dumps(scene)


@pytest.mark.parametrize("make", [lambda: oktett.Scene(*ball(2), quality="best"), lambda: oktett.Scene.from_dict(mixed()), oktett.Scene])
def test_a_pickle_gives_the_same_bits(make):
    scene = make()
    rays = random_rays(20000, 4.0, seed=6)
    again = pickle.loads(pickle.dumps(scene))
    assert same(scene.closest_hit(rays), again.closest_hit(rays))
    assert same(scene.all_hits(rays), again.all_hits(rays))
    state = list(scene.__reduce_ex__(2)[2])
    state[0] = 99
    with pytest.raises(ValueError, match="another version"):
        oktett.Scene.__new__(oktett.Scene).__setstate__(tuple(state))


@pytest.mark.skipif(COMMAND is None, reason="the command is not built")
@pytest.mark.parametrize("name", ["csg.yaml", "instances.yaml"])
def test_a_picture_has_the_bits_of_the_command(name, tmp_path):
    path = next(SOURCE.glob("scenes/**/" + name))
    scene = oktett.Scene.from_file(path)
    planes = scene.render(64, 48, samples=2, seed=3)
    subprocess.run(
        [COMMAND, "render", path, "--size", "64x48", "--spp", "2", "--seed", "3", "--quiet", "-o", tmp_path / "a.exr"],
        check=True,
        # The command has the runtime of a sanitizer in it.
        env={name: value for name, value in os.environ.items() if name != "LD_PRELOAD"},
    )
    expected = read_exr(tmp_path / "a.exr")
    assert set(planes) == set(expected) and expected["A"].any()
    with np.errstate(over="ignore"):
        for plane, values in expected.items():
            assert planes[plane].shape == (48, 64)
            assert np.array_equal(planes[plane].astype(values.dtype), values, equal_nan=values.dtype.kind == "f"), plane


def test_arguments_of_pictures_change_them():
    scene = oktett.Scene(*ball(2))
    colours = scene.render(40, 30, planes=["R", "A"])
    assert list(colours) == ["R", "A"] and colours["R"].dtype == np.float32 and colours["R"].shape == (30, 40)
    depth = scene.render(41, 41, planes=["Z"], camera={"from": [0, 0, 6], "at": [0, 0, 0], "fov": 30}, samples=1)["Z"]
    assert depth[20, 20] == pytest.approx(5, abs=0.05) and depth[0, 0] > 1e3 or np.isinf(depth[0, 0]) or depth[0, 0] == 0
    normals = scene.render(16, 16, integrator="normal", seed=1, depth=0)
    assert not np.array_equal(normals["R"], scene.render(16, 16, seed=1)["R"])
    seen = []
    scene.render(200, 200, samples=64, progress=seen.append)
    assert all(0 <= part <= 1 for part in seen) and seen == sorted(seen)
    for arguments, message in (
        ({"width": 0}, "width: expected 1 to 65536, found 0"),
        ({"samples": 10**12}, "samples"),
        ({"integrator": "magic"}, "integrator: there is no 'magic'; expected whitted, path"),
        ({"planes": ["Q"]}, "planes: the picture has no 'Q'; it has R, G, B, A"),
        ({"camera": {"form": [0, 0, 1]}}, "camera: there is no key 'form'"),
        ({"camera": {"from": [0, 0]}}, "camera"),
        ({"camera": {"fov": 180}}, "camera"),
    ):
        with pytest.raises(ValueError, match=message):
            scene.render(**{"width": 8, "height": 8, **arguments})


def test_planes_outlive_the_scene():
    planes = oktett.Scene(*ball(1)).render(32, 32, samples=1)
    total = planes["A"].sum()
    del planes["R"]
    assert planes["A"].sum() == total > 0


@pytest.mark.skipif(SANITIZED, reason="a sanitizer takes all addresses there are")
def test_memory_that_cannot_be_had_is_a_memory_error():
    program = """
import resource, sys, oktett
from oracle import ball
scene = oktett.Scene(*ball(1))
scene.build()
resource.setrlimit(resource.RLIMIT_AS, (3 << 30, 3 << 30))
try:
    scene.render(65536, 65536, samples=1)
except MemoryError:
    sys.exit(5)
"""
    assert subprocess.run([sys.executable, "-c", program], cwd=Path(__file__).parent).returncode == 5


def test_what_was_skipped_is_told():
    scene = oktett.Scene.from_text("oktett: 1\nobjects:\n  - sphere: {radius: 0}\n  - box: {}\n")
    assert len(scene.warnings) == 1 and scene.warnings[0].startswith("<text>.yaml:3:")
