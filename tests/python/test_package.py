"""The package as such: what queries load, what notebooks show, the documents' notebook, and how wheels are made."""

import ast
import base64
import csv
import hashlib
import importlib.util
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import tarfile
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest

import oktett
from oracle import CUBE_FACES, CUBE_VERTICES

SOURCE = Path(os.environ.get("OKTETT_SOURCE_DIR", Path(__file__).parents[2]))
TORUS = "oktett: 1\nobjects: [{torus: {major: 2, minor: 0.5}}]"

MAPPED = """
import numpy as np, re
import oktett
def loaded():
    names = re.findall(r"/([^/\\n]+)$", open("/proc/self/maps").read(), re.M)
    return sorted({name for name in names if re.match("_files|lib(oktett|OpenImageIO|yaml|OpenEXR|Imath|png|draco|meshopt)", name)})
scene = oktett.Scene(np.eye(3, dtype=np.float32), np.array([[0, 1, 2]], np.uint32))
scene.closest_hit(np.ones((4, 6), np.float32)), scene.closest_point(np.ones((4, 3), np.float32))
scene.render(8, 8)
print(loaded())
oktett.Scene.from_text("oktett: 1\\nobjects: [{sphere: {}}]")
print(loaded())
"""


def test_queries_load_no_library_for_files():
    done = subprocess.run([sys.executable, "-c", MAPPED], check=True, capture_output=True, text=True)
    queries, files = (ast.literal_eval(line) for line in done.stdout.splitlines())
    assert queries == []
    assert any(name.startswith("_files") for name in files) and any("yaml" in name for name in files)
    assert not any("OpenImageIO" in name for name in files)


def decode_png(data):
    """The pixels of an 8-bit PNG file (height, width, channels)."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length :][:4])[0] == zlib.crc32(kind + body)
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
            assert depth == 8
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    channels = {2: 3, 6: 4}[colour]
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + width * channels)
    above, pixels = [0] * (width * channels), []
    for kind, row in zip(rows[:, 0].tolist(), rows[:, 1:].tolist()):
        done = []
        for x, value in enumerate(row):
            a, c = (done[x - channels], above[x - channels]) if x >= channels else (0, 0)
            b = above[x]
            paeth = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2] if kind == 4 else 0
            done.append((value + (0, a, b, (a + b) // 2, paeth)[kind]) % 256)
        pixels.append(done)
        above = done
    return np.array(pixels, np.uint8).reshape(height, width, channels)


def test_notebooks_show_the_picture_of_a_scene():
    scene = oktett.Scene.from_text(TORUS + "\nfilm: {width: 96, height: 64}")
    pixels = decode_png(scene._repr_png_())
    assert pixels.shape[:2] == (64, 96)
    alpha = scene.render(planes=["A"])["A"]
    shown = pixels[..., :3].max(axis=-1) > 0
    assert 0.05 < (alpha == 1).mean() < 0.9 and shown[alpha == 1].mean() > 0.95
    large = scene.from_text(TORUS + "\nfilm: {width: 4000, height: 1000}\nintegrator: {samples: 900}")._repr_png_()
    assert struct.unpack(">II", large[16:24]) == (480, 120)


def test_notebooks_show_scenes_of_arrays_and_empty_ones():
    cube = decode_png(oktett.Scene(CUBE_VERTICES, CUBE_FACES)._repr_png_())
    assert max(cube.shape) == 480 and len(np.unique(cube.reshape(-1, cube.shape[2]), axis=0)) > 2
    assert decode_png(oktett.Scene()._repr_png_()).shape[1] == 480


def test_the_notebook_runs():
    notebook = json.loads((SOURCE / "docs/notebook.ipynb").read_text())
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert notebook["nbformat"] == 4 and len(cells) > 3
    names, pictures = {}, 0
    for number, cell in enumerate(cells):
        assert cell["outputs"] == [] and cell["execution_count"] is None
        body = ast.parse("".join(cell["source"]), f"cell {number}").body
        # As in a notebook, the value of the last expression is shown.
        last = ast.Expression(body.pop().value) if isinstance(body[-1], ast.Expr) else None
        exec(compile(ast.Module(body, []), f"cell {number}", "exec"), names)
        shown = eval(compile(last, f"cell {number}", "eval"), names) if last else None
        if hasattr(shown, "_repr_png_"):
            assert decode_png(shown._repr_png_()).max() > 0
            pictures += 1
    assert pictures > 0


@pytest.fixture(scope="module")
def backend():
    file = SOURCE / "python/backend.py"
    if not file.exists():
        pytest.skip("these are the tests alone, without the sources")
    if sys.version_info < (3, 11):
        pytest.skip("the build backend needs tomllib of Python 3.11")
    spec = importlib.util.spec_from_file_location("backend", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_wheels_are_for_the_machine_of_their_modules(backend, tmp_path):
    (tmp_path / "oktett").mkdir()
    header = b"\x7fELF\x02\x01\x01".ljust(16, b"\0") + struct.pack("<HH", 3, 183)
    (tmp_path / "oktett/_oktett.cpython-313-aarch64-linux-gnu.so").write_bytes(header)
    (tmp_path / "oktett/__init__.py").write_text("")
    python, system = backend.tags(tmp_path, "manylinux_2_41")
    assert (python, system) == ("cp313-cp313", "manylinux_2_41_aarch64")
    name = backend.write_wheel(tmp_path, tmp_path, "oktett", python, system, backend.metadata(), {"x/copyright": "of x"})
    assert name == f"oktett-{oktett.__version__}-cp313-cp313-manylinux_2_41_aarch64.whl"
    with zipfile.ZipFile(tmp_path / name) as wheel:
        information = f"oktett-{oktett.__version__}.dist-info"
        rows = list(csv.reader(wheel.read(f"{information}/RECORD").decode().splitlines()))
        assert {row[0] for row in rows} == set(wheel.namelist()) >= {f"{information}/licenses/x/copyright"}
        for path, digest, size in rows:
            if path != f"{information}/RECORD":
                content = wheel.read(path)
                expected = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")
                assert (digest, int(size)) == (f"sha256={expected}", len(content))
        assert "Tag: cp313-cp313-manylinux_2_41_aarch64" in wheel.read(f"{information}/WHEEL").decode()


def test_libraries_of_the_system_stay_outside_of_wheels(backend):
    outside = ["libc.so.6", "libm.so.6", "libstdc++.so.6", "libgcc_s.so.1", "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"]
    inside = ["libcurl.so.4", "libmount.so.1", "libtbb.so.12", "libz.so.1", "librtmp.so.1", "libcrypt.so.1"]
    assert [name for name in outside + inside if backend.SYSTEM.match(name)] == outside


def test_the_source_distribution_has_what_builds_it(backend, tmp_path):
    if not (SOURCE / ".git").exists() or shutil.which("git") is None:
        pytest.skip("not a clone, or no git")
    with tarfile.open(tmp_path / backend.build_sdist(tmp_path)) as archive:
        names = set(archive.getnames())
        top = f"oktett-{oktett.__version__}"
        text = archive.extractfile(f"{top}/PKG-INFO").read().decode()
    assert {f"{top}/{name}" for name in ("pyproject.toml", "CMakeLists.txt", "python/backend.py", "core/error.cpp")} <= names
    assert re.search(r"^Name: oktett$", text, re.M) and re.search(rf"^Version: {re.escape(oktett.__version__)}$", text, re.M)
