"""What the tests of the viewer share: a viewer that runs, and image files as lists of their parts."""
import http.client
import os
import pathlib
import signal
import struct
import subprocess
import tempfile
import unittest
import urllib.parse

SCENE = """oktett: 1
camera: {from: [0, 1.5, 5], at: [0, 0.5, 0], fov: 40}
film: {width: 96, height: 64}
integrator: {kind: whitted, samples: 4}
background: [0.3, 0.4, 0.5]
lights:
  - directional: {direction: [-0.5, -1, -0.6], color: [0.8, 0.8, 0.7]}
objects:
  - plane: {normal: [0, 1, 0], offset: 0}
  - sphere: {center: [0, 0.6, 0], radius: 0.6}
  - sphere: {center: [1.2, 0.3, 0.4], radius: 0.3}
"""
VIEW_TYPE = {"Content-Type": "application/x-oktett-view"}
# What a shell starts in the background ignores SIGINT and hands that on to the programs that it starts.
signal.signal(signal.SIGINT, signal.default_int_handler)


class ViewerTest(unittest.TestCase):
    """Tests that start viewers of scene files in a folder of their own."""

    OKTETT = ""  # the command
    viewer = None

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(self.end)
        self.scene = pathlib.Path(folder.name) / "scene.yaml"

    def start(self, scene=SCENE, *options, to_open=False, path=None):
        """Starts the viewer and waits for its address. `path` is searched for programs before all others."""
        self.end()
        self.scene.write_text(scene)
        folders = ([str(path)] if path else []) + [os.environ.get("PATH", "")]
        self.viewer = subprocess.Popen(
            [self.OKTETT, "view", self.scene, *([] if to_open else ["--no-open"]), *options],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            env={**os.environ, "PATH": ":".join(folders)})
        self.address = self.viewer.stdout.readline().strip()
        self.assertRegex(self.address, r"^http://127\.0\.0\.1:\d+/[0-9a-f]{32}/$")
        self.parts = urllib.parse.urlsplit(self.address)
        self.port, self.path = self.parts.port, self.parts.path

    def end(self):
        if self.viewer is None:
            return
        if self.viewer.poll() is None:
            self.viewer.kill()
        self.viewer.wait()
        self.viewer.stdout.close()
        self.viewer = None

    def fetch(self, path, method="GET", body=None, headers=None):
        """The status and the body of the answer."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
        try:
            connection.request(method, path, body=body, headers=headers or {})
            answer = connection.getresponse()
            return answer.status, answer.read()
        finally:
            connection.close()

    def ask(self, *request, **more):
        return self.fetch(*request, **more)[0]

    def view(self, lines):
        """Asks for another view; the status of the answer."""
        return self.ask(self.path + "view", "POST", lines, VIEW_TYPE)

    def render(self, name, scene=None, *options):
        """The bytes of the file that `oktett render` writes."""
        file, to = self.scene, self.scene.with_name(name)
        if scene is not None:
            file = self.scene.with_name("rendered.yaml")
            file.write_text(scene)
        subprocess.run([self.OKTETT, "render", file, "-o", to, *options], check=True, capture_output=True)
        return to.read_bytes()


def png_parts(data):
    """The chunks of a PNG file but those that tell how it was made."""
    parts, at = [], 8
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        if kind != b"tEXt":
            parts.append((kind, data[at + 8:at + 8 + size]))
        at += size + 12
    return parts


def exr_parts(data):
    """The attributes of an EXR file but those that tell how it was made, and the compressed pixels."""
    def word():
        nonlocal at
        start, at = at, data.index(b"\0", at) + 1
        return data[start:at - 1].decode()

    at, attributes = 8, {}
    while data[at] != 0:
        name, kind = word(), word()
        size, = struct.unpack_from("<I", data, at)
        attributes[name] = kind, data[at + 4:at + 4 + size]
        at += 4 + size
    # Behind the header stand the places of the chunks in the file, the first of which follows them.
    first, = struct.unpack_from("<Q", data, at + 1)
    for name in ("capDate", "commandLine", "renderSeconds", "scene"):
        attributes.pop(name, None)
    return attributes, data[first:]
