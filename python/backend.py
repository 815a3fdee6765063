"""Builds the Python package of Oktett as a wheel and as a source distribution.

pyproject.toml names this module as the build backend (PEP 517), so pip calls it. It needs the standard library alone: neither
scikit-build-core nor PyPI. The wheels that pip makes use the libraries of the machine.

As a program it makes wheels that hold these libraries, of a build folder, and the source distribution, see
`scripts/package --wheel`:

    python3 python/backend.py BUILD FOLDER
"""

import base64
import functools
import hashlib
import io
import os
import platform
import re
import shlex
import shutil
import struct
import subprocess
import sys
import tarfile
import tempfile
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
VERSION = re.search(r"project\(oktett VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]
# The package of a wheel of its own: what OpenImageIO brings is thirty times all else.
IMAGES = "oktett_images"
# The folders of shared libraries in site-packages.
LIBRARIES, IMAGE_LIBRARIES = "oktett.libs", f"{IMAGES}.libs"


# What pip calls.


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    if shutil.which("cmake") is None:
        sys.exit("oktett: building needs CMake, a compiler and libraries, see docs/building.md")
    build = ROOT / "build/wheel"
    options = {
        "CMAKE_BUILD_TYPE": "Release",
        "CMAKE_INSTALL_LIBDIR": LIBRARIES,
        "OKTETT_BUILD_APP": "OFF",
        "OKTETT_BUILD_TESTS": "OFF",
        "OKTETT_BUILD_BENCH": "OFF",
        "OKTETT_BUILD_PYTHON": "ON",
        "OKTETT_PYTHON_DIR": ".",
        "Python3_EXECUTABLE": sys.executable,
    }
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    given = shlex.split(os.environ.get("CMAKE_ARGS", ""))
    run("cmake", "-S", ROOT, "-B", build, *generator, *(f"-D{name}={value}" for name, value in options.items()), *given)
    run("cmake", "--build", build, "--target", "oktett_python_files", "oktett_images", "--parallel", os.cpu_count())
    with tempfile.TemporaryDirectory() as folder:
        stage = Path(folder)
        install(build, stage)
        return write_wheel(Path(wheel_directory), stage, "oktett", *tags(stage, "linux"), metadata())


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    folder = Path(metadata_directory) / f"oktett-{VERSION}.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text(metadata())
    return folder.name


def build_sdist(sdist_directory, config_settings=None):
    top = f"oktett-{VERSION}"
    try:
        listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True)
        files = [name for name in listed.stdout.split("\0") if name and (ROOT / name).is_file()]
    except (OSError, subprocess.CalledProcessError):
        sys.exit("oktett: a source distribution can only be made of a clone by git")
    with tarfile.open(Path(sdist_directory) / f"{top}.tar.gz", "w:gz") as archive:
        for name in sorted(files):
            archive.add(ROOT / name, f"{top}/{name}", filter=as_root)
        information = tarfile.TarInfo(f"{top}/PKG-INFO")
        content = metadata().encode()
        information.size = len(content)
        archive.addfile(information, io.BytesIO(content))
    return f"{top}.tar.gz"


def as_root(entry):
    entry.uid = entry.gid = 0
    entry.uname = entry.gname = "root"
    return entry


# What both ways share.


def install(build, stage):
    """Installs the package of a build folder to the folder `stage`, as it lies in site-packages."""
    with tempfile.TemporaryDirectory() as prefix:
        run("cmake", "--install", build, "--prefix", prefix, "--component", "python", "--strip")
        (module,) = Path(prefix).rglob("_oktett.*.so")
        shutil.move(module.parent, stage / "oktett")
    (stage / LIBRARIES).mkdir()
    images = f"liboktett_images.so.{VERSION}"
    shutil.copyfile(build / "lib" / images, stage / LIBRARIES / images)


def run(*command):
    # What programs print goes where pip expects it, and the names of wheels stay alone on the standard output.
    subprocess.run([str(word) for word in command], check=True, stdout=sys.stderr)


def output_of(*command):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout


def machine_of(library):
    """The processor that an ELF file is for, as `uname -m` calls it."""
    number = struct.unpack_from("<H", library.read_bytes(), 18)[0]
    return {62: "x86_64", 183: "aarch64"}.get(number) or sys.exit(f"oktett: {library}: unknown machine {number}")


def tags(stage, system):
    """The tags of Python and of the platform of the modules in `stage`, which may be made for another machine."""
    (module,) = stage.glob("oktett/_oktett.*.so")
    python = "cp" + re.search(r"\.cpython-(\d+)", module.name)[1]
    return f"{python}-{python}", f"{system}_{machine_of(module)}"


def metadata(name="oktett", summary=PROJECT["description"], requires=(*PROJECT["dependencies"],), text=True):
    lines = [
        "Metadata-Version: 2.1",
        f"Name: {name.replace('_', '-')}",
        f"Version: {VERSION}",
        f"Summary: {summary}",
        f"License: {PROJECT['license']['text']}",
        f"Requires-Python: {PROJECT['requires-python']}",
        *(f"Requires-Dist: {requirement}" for requirement in requires),
        *(["Description-Content-Type: text/markdown", "", (ROOT / PROJECT["readme"]).read_text()] if text else []),
    ]
    return "\n".join(lines) + "\n"


def write_wheel(folder, stage, name, python, system, text, licences=None):
    """Writes the files of `stage` as a wheel and returns its file name. `licences` are texts by their paths."""
    information = f"{name}-{VERSION}.dist-info"
    texts = {
        f"{information}/METADATA": text,
        f"{information}/WHEEL": f"Wheel-Version: 1.0\nGenerator: oktett\nRoot-Is-Purelib: false\nTag: {python}-{system}\n",
        f"{information}/licenses/LICENSE": (ROOT / "LICENSE").read_text(),
        **{f"{information}/licenses/{path}": licence for path, licence in (licences or {}).items()},
    }
    contents = {file.relative_to(stage).as_posix(): file for file in sorted(stage.rglob("*")) if file.is_file()}
    contents |= {path: text.encode() for path, text in texts.items()}
    wheel = f"{name}-{VERSION}-{python}-{system}.whl"
    record = []
    with zipfile.ZipFile(folder / wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for path, content in contents.items():
            content = content if isinstance(content, bytes) else content.read_bytes()
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")
            record.append(f"{path},sha256={digest},{len(content)}\n")
            write_entry(archive, path, content)
        record.append(f"{information}/RECORD,,\n")
        write_entry(archive, f"{information}/RECORD", "".join(record).encode())
    return wheel


def write_entry(archive, path, content):
    # The time is always the same, so that the same files make the same wheel.
    entry = zipfile.ZipInfo(path, (1980, 1, 1, 0, 0, 0))
    entry.external_attr = (0o100755 if ".so" in Path(path).suffixes else 0o100644) << 16
    entry.compress_type = zipfile.ZIP_DEFLATED
    archive.writestr(entry, content)


# Wheels that hold the libraries that they need.

# Every system that has the C library of the wheel's tag, or a later one, has these: the C library itself, and the runtime
# of GCC, of which a process must have only one.
SYSTEM = re.compile(
    r"(ld-linux.*|lib(c|m|mvec|pthread|dl|rt|util|resolv|anl|stdc\+\+|gcc_s))\.so(\.\d+)*$"
)
# What libraries load by name from the folder that they lie in.
LOADED = {"libtbb.so.12": "libtbbmalloc.so.2"}


def needed(library):
    return [name for name in output_of("patchelf", "--print-needed", library).split() if not SYSTEM.match(name)]


def find(name, user):
    """The file of the library `name` that the ELF file `user` needs."""
    places = output_of("patchelf", "--print-rpath", user).strip().split(":")
    places = [place.replace("$ORIGIN", str(user.parent)) for place in places if place]
    machine = machine_of(user)
    for place in (*places, f"/usr/lib/{machine}-linux-gnu", f"/lib/{machine}-linux-gnu", "/usr/lib64", "/usr/lib"):
        file = (Path(place) / name).resolve()
        if file.is_file() and machine_of(file) == machine:
            return file
    sys.exit(f"oktett: {user} needs {name}, which is not found")


def closure(users):
    """The files of all libraries that the ELF files `users` need, by their names."""
    found, queue = {}, list(users)
    while queue:
        user = queue.pop()
        for name in needed(user):
            if name not in found and not any(user.name == name for user in users):
                found[name] = find(name, user)
                queue.append(found[name])
    return found


def patch(file, names, rpath, soname=None):
    """Makes `file` look for libraries in the folders of `rpath`, under their new `names`."""
    # One change at a time: patchelf 0.14 mixes up the texts of several.
    run("patchelf", "--set-rpath", rpath, file)
    if soname:
        run("patchelf", "--set-soname", soname, file)
    if words := [word for old in needed(file) if old in names for word in ("--replace-needed", old, names[old])]:
        run("patchelf", *words, file)
    wrong = [name for name in needed(file) if name in names]
    if wrong or output_of("patchelf", "--print-rpath", file).strip() != rpath:
        sys.exit(f"oktett: patchelf has damaged {file}")


@functools.cache
def package_of(file):
    """The Debian package that a file belongs to. Packages may name folders below / that are links to those in /usr."""
    for path in (str(file), str(file).removeprefix("/usr")):
        found = subprocess.run(["dpkg", "-S", path], capture_output=True, text=True)
        if found.returncode == 0:
            return found.stdout.split(":")[0]
    sys.exit(f"oktett: no Debian package has {file}; its licence is unknown")


def licences_of(files):
    """What Debian says of the authors and licences of the packages of `files`, and the texts of common licences."""
    texts = {}
    for package in sorted({package_of(file) for file in files}):
        texts[f"{package}/copyright"] = Path(f"/usr/share/doc/{package}/copyright").read_text(errors="replace")
    for name in sorted({name for text in texts.values() for name in re.findall(r"/usr/share/common-licenses/([\w.-]*\w)", text)}):
        if (text := Path("/usr/share/common-licenses") / name).is_file():
            texts[f"common-licenses/{name}"] = text.read_text()
    return texts


def build_bundled_wheels(build, folder):
    """Makes the wheels oktett and oktett_images of a build folder in `folder` and returns their names."""
    with tempfile.TemporaryDirectory() as temporary:
        stage, images = Path(temporary) / "oktett", Path(temporary) / IMAGES
        stage.mkdir()
        install(build, stage)
        (images / IMAGE_LIBRARIES).mkdir(parents=True)
        (loaded,) = (stage / LIBRARIES).iterdir()
        loaded = loaded.rename(images / IMAGE_LIBRARIES / loaded.name)
        modules = list(stage.glob("oktett/*.so"))
        own = closure(modules)
        own |= {name: find(name, own[user]) for user, name in LOADED.items() if user in own}
        of_images = {name: file for name, file in closure([loaded]).items() if name not in own}
        # Under names of their own, so that a process may also have other versions of the same libraries.
        names = {
            name: re.sub(r"\.so", f"-{hashlib.sha256(file.read_bytes()).hexdigest()[:8]}.so", name, count=1)
            for name, file in (own | of_images).items()
            if name not in LOADED.values()
        }
        for module in modules:
            patch(module, names, f"$ORIGIN:$ORIGIN/../{LIBRARIES}:$ORIGIN/../{IMAGE_LIBRARIES}")
        patch(loaded, names, f"$ORIGIN:$ORIGIN/../{LIBRARIES}")
        for target, files in ((stage / LIBRARIES, own), (images / IMAGE_LIBRARIES, of_images)):
            for name, file in files.items():
                new = names.get(name, name)
                patch(shutil.copyfile(file, target / new), names, f"$ORIGIN:$ORIGIN/../{LIBRARIES}", new)
        python, system = tags(stage, "manylinux_" + platform.libc_ver()[1].replace(".", "_"))
        folder.mkdir(parents=True, exist_ok=True)
        about_images = metadata(
            IMAGES, "What the package oktett reads images with: OpenImageIO and the libraries that it needs",
            [f"oktett == {VERSION}"], text=False,
        )  # fmt: skip
        return [
            write_wheel(folder, stage, "oktett", python, system, metadata(), licences_of(own.values())),
            write_wheel(folder, images, IMAGES, "py3-none", system, about_images, licences_of(of_images.values())),
        ]


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    if shutil.which("patchelf") is None:
        sys.exit("oktett: needs patchelf; scripts/setup --package installs it")
    print(*build_bundled_wheels(Path(sys.argv[1]), Path(sys.argv[2])), build_sdist(sys.argv[2]), sep="\n")
