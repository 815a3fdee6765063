#!/usr/bin/python3
"""What strangers may do to the viewer's server: view_server_test.py OKTETT. Each request is answered by a
status, and afterwards the server still answers others."""
import json
import math
import pathlib
import signal
import socket
import stat
import struct
import sys
import tempfile
import time
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from view_support import SCENE, VIEW_TYPE, ViewerTest, exr_parts, png_parts

ViewerTest.OKTETT = sys.argv.pop(1)
EVER = 30  # seconds after which something that hangs has failed


class Server(ViewerTest):
    def setUp(self):
        super().setUp()
        self.start()

    def connect(self):
        connection = socket.create_connection(("127.0.0.1", self.port), timeout=EVER)
        self.addCleanup(connection.close)
        return connection

    def answers(self, connection):
        """All that the server still sends, up to the end of the connection."""
        data = b""
        try:
            while piece := connection.recv(65536):
                data += piece
        except ConnectionError:
            pass
        return data

    def raw(self, text):
        """The status of the first answer to these bytes; 0 if there is none."""
        connection = self.connect()
        try:
            connection.sendall(text if isinstance(text, bytes) else text.encode())
        except ConnectionError:
            pass  # it has refused what was sent so far
        data = b""
        try:
            while b"\r\n\r\n" not in data and (piece := connection.recv(65536)):
                data += piece
        except ConnectionError:
            pass
        connection.close()
        return int(data.split()[1]) if data.startswith(b"HTTP/1.1 ") else 0

    def is_well(self):
        self.assertEqual(self.ask(self.path), 200)
        self.assertIsNone(self.viewer.poll(), "the viewer has ended")

    def check(self, requests):
        """`requests`: lists of what is sent and the statuses that are right."""
        for name, text, *right in requests:
            with self.subTest(name):
                self.assertIn(self.raw(text), right)
        self.is_well()

    def get(self, path="", headers="", version="HTTP/1.1", method="GET"):
        return f"{method} {self.path}{path} {version}\r\nHost: 127.0.0.1:{self.port}\r\n{headers}\r\n"

    def post(self, body, headers="", length=None):
        size = len(body) if length is None else length
        return self.get("view", f"Content-Type: application/x-oktett-view\r\nContent-Length: {size}\r\n{headers}",
                        method="POST") + body

    def test_the_page_is_answered(self):
        self.check([["page", self.get(), 200], ["a view", self.post("exposure=1"), 200],
                    ["an old client", self.get(version="HTTP/1.0"), 200]])

    def test_what_is_too_long_is_refused(self):
        many = "".join(f"name{k}: value\r\n" for k in range(10000))
        self.check([
            ["line", self.get("x" * 9000), 414],
            ["line of 30 kB", self.get("x" * 30000), 414, 431],
            ["line of 1 MB", self.get("x" * 1000000), 414, 431],
            ["line without end", "x" * 1000000, 414, 431],
            ["query", self.get("pick?x=" + "1" * 6000 + "&y=0"), 400],
            ["header", self.get(headers=f"Name: {'x' * 10000}\r\n"), 400, 431],
            ["many headers", self.get(headers=many), 400, 431],
            ["body", self.post("x" * 5000), 413],
            ["body of 1 MB", self.post("x" * 1000000), 413],
            ["length", self.post("", length="9" * 30), 413],
        ])

    def test_requests_that_are_none_are_refused(self):
        host = f"Host: 127.0.0.1:{self.port}\r\n"
        self.check([
            ["nothing", "\r\n\r\n", 400],
            ["no version", f"GET {self.path}\r\n\r\n", 400],
            ["another version", self.get(version="HTTP/3.1"), 400],
            ["HTTP/2", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", 400],
            ["random bytes", bytes(range(256)) * 200, 400, 414, 431],
            ["chunks", self.get("view", "Content-Type: application/x-oktett-view\r\n"
                                "Transfer-Encoding: chunked\r\n", method="POST") + "a\r\nexposure=1\r\n0\r\n\r\n", 400],
            ["two lengths", self.post("exposure=1", "Content-Length: 11\r\n"), 400],
            ["length below 0", self.post("", length=-1), 400, 411, 413],
            ["no length", self.get("view", "Content-Type: application/x-oktett-view\r\n", method="POST"), 411],
            ["a body for GET", self.get(headers="Content-Length: 10\r\n") + "exposure=1", 400],
            ["a body on demand", self.post("", "Expect: 100-continue\r\n", length=10), 400],
            ["a part", self.get(headers="Range: bytes=0-1\r\n"), 400],
            ["websocket", self.get(headers="Upgrade: websocket\r\nConnection: Upgrade\r\n"
                                   "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: eA==\r\n"), 400],
            *[[method, self.get(method=method), 405] for method in ("HEAD", "PUT", "DELETE", "OPTIONS", "TRACE")],
            ["a proxy's address", f"GET http://127.0.0.1:{self.port}{self.path} HTTP/1.1\r\n{host}\r\n", 404],
        ])

    def test_other_sites_are_refused(self):
        def named(host, version="HTTP/1.1"):
            return f"GET {self.path} {version}\r\n{host}\r\n"
        own = f"Host: 127.0.0.1:{self.port}\r\n"
        self.check([
            ["no host", named(""), 400],
            ["no host, HTTP/1.0", named("", "HTTP/1.0"), 400],
            ["two hosts", named(own + "Host: example.org\r\n"), 400],
            ["the same host twice", named(own + own), 400],
            ["another port", named("Host: 127.0.0.1:1\r\n"), 403],
            ["no port", named("Host: 127.0.0.1\r\n"), 403],
            ["another name of this machine", named(f"Host: 127.0.0.1.example.org:{self.port}\r\n"), 403],
            ["by name", named(f"Host: localhost:{self.port}\r\n"), 200],
            ["a file's page", named(own + "Origin: null\r\n"), 403],
            ["another page", named(own + "Origin: http://example.org\r\n"), 403],
            ["a page of another port", named(own + "Origin: http://127.0.0.1:1\r\n"), 403],
            ["two pages", named(own + f"Origin: http://127.0.0.1:{self.port}\r\nOrigin: http://example.org\r\n"), 400],
            ["its own page", named(own + f"Origin: http://127.0.0.1:{self.port}\r\n"), 200],
        ])

    def test_types_of_other_pages_are_refused(self):
        for kind in ("text/plain", "application/json", "application/x-www-form-urlencoded",
                     "multipart/form-data; boundary=x", "application/x-oktett-view; charset=utf-8", ""):
            self.assertEqual(self.ask(self.path + "view", "POST", "exposure=1", {"Content-Type": kind}), 415, kind)
        self.check([["two types", self.post("exposure=1", "Content-Type: text/plain\r\n"), 400]])

    def test_addresses_lead_to_no_files(self):
        self.assertEqual(self.ask("/"), 404)
        self.assertEqual(self.ask("/" + "0" * 32 + "/"), 404)
        for name in ("no-such-file", "../../etc/passwd", "%2e%2e/%2e%2e/etc/passwd", "..%2f..%2fetc%2fpasswd",
                     "//etc/passwd", "page.js%00", "page.js/", "./page.js", "view", "picture.jpg", "%"):
            self.assertEqual(self.ask(self.path + name), 404, name)
        self.is_well()

    def test_views_that_make_no_sense_are_refused(self):
        for lines in ("nonsense", "=", "from", "key=1", "from=", "from=1 2", "from=1 2 3 4", "from=1  2 3", "at=1,2,3",
                      "from=nan 0 0", "from=inf 0 0", "from=1e999 0 0", "from=1e16 0 0", "from=0x1 0 0", "from=[1,2,3]",
                      "up=0 0 0", "from=0 0.5 0", "up=0 -1 -5", "fov=0", "fov=-1", "fov=180", "fov=nan", "height=0",
                      "height=1e999", "focus=0", "exposure=1e9", "exposure=nan", "tone=none", "tone=", "layer=none",
                      "layer=../x", "[" * 4000, '{"from": NaN}', "\0", "exposure=1\0", "\xff\xfe=1", "\n" * 4000):
            self.assertEqual(self.view(lines.encode("latin-1")), 400, lines[:20])
        for query in ("pick", "pick?x=1", "pick?x=-1&y=0", "pick?x=96&y=0", "pick?x=0&y=64", "pick?x=nan&y=0",
                      "pick?x=1e1&y=0", "pick?x=4294967296&y=0", "pick?x=99999999999999999999&y=0", "pick?x=+1&y=0",
                      "frame", "frame?since=", "frame?since=-1", "frame?since=1e999", "frame?since=0x1"):
            self.assertEqual(self.ask(self.path + query), 400, query)
        self.is_well()

    def test_extreme_views_are_rendered(self):
        for lines in ("fov=5e-324", "fov=179.999", "from=1e15 1e15 1e15", "from=1e-300 0 0\nat=0 0 0",
                      "from=1e15 0 0\nat=-1e15 0 0\nup=0 1e-300 0", "focus=1e-300", "exposure=-8\ntone=aces"):
            self.assertEqual(self.view("from=0 1.5 5\nat=0 0.5 0\nup=0 1 0\nfov=40\n" + lines), 200, lines)
            self.assertEqual(self.ask(self.path + "picture.png"), 200, lines)
            self.assertEqual(self.ask(self.path + "pick?x=48&y=32"), 200, lines)

    def test_slow_and_idle_clients_keep_nobody_out(self):
        begun = self.get().encode()
        begins = b"", begun[:7], begun[:-2], self.post("expos", length=20).encode()
        slow = [self.connect() for _ in range(60)]
        for number, connection in enumerate(slow):
            connection.sendall(begins[number % 4])
        for k in range(6):
            self.assertEqual(self.ask(self.path), 200)
            self.assertEqual(self.view(f"exposure={k}"), 200)
            for connection in slow[-12:]:
                try:
                    connection.sendall(b"x")
                except ConnectionError:
                    pass
        # Those that made room were ended before their time, at which they would have been told so.
        self.assertGreaterEqual(sum(self.is_ended(connection) for connection in slow), 60 - 24)
        self.is_well()

    def is_ended(self, connection):
        """Whether the server has ended a connection without a word."""
        connection.setblocking(False)
        try:
            return connection.recv(1) == b""
        except BlockingIOError:
            return False
        except ConnectionError:
            return True

    def test_a_request_that_takes_too_long_is_refused(self):
        connections = []
        for text in ("GET /", self.get()[:-2], self.post("expos", length=20)):
            connections.append(self.connect())
            connections[-1].sendall(text.encode())
        for connection in connections:
            self.assertRegex(self.answers(connection), rb"^HTTP/1.1 (408|400) ")
        self.is_well()

    def test_nothing_behind_a_refused_request_is_answered(self):
        connection = self.connect()
        hidden = self.get()
        connection.sendall(self.get("view", f"Content-Type: text/plain\r\nContent-Length: {len(hidden)}\r\n",
                                    method="POST").encode() + hidden.encode())
        data = self.answers(connection)
        self.assertTrue(data.startswith(b"HTTP/1.1 415 "), data[:40])
        self.assertEqual(data.count(b"HTTP/1.1 "), 1)
        self.is_well()


class Frames(ViewerTest):
    def frame(self, is_wanted):
        """Waits for a finished picture whose status `is_wanted`. Gives the status and the tiles, each as its
        place, size and bytes."""
        for _ in range(10 * EVER):
            data = self.fetch(self.path + "frame?since=0")[1]
            size, = struct.unpack_from("<I", data)
            status, at, tiles = json.loads(data[4:4 + size]), 4 + size, []
            if status["settled"] and status["view"] == status["shown"] and is_wanted(status):
                break
            time.sleep(0.1)
        else:
            self.fail("in vain waited for the finished picture")
        for x, y, width, height, coarse in status["tiles"]:
            if not coarse:
                tiles.append((x, y, width, height, data[at:at + 4 * width * height]))
            at += 4 * width * height
        return status, tiles

    def pixel(self, tiles, x, y):
        for left, top, width, height, data in reversed(tiles):
            if left <= x < left + width and top <= y < top + height:
                at = 4 * ((y - top) * width + x - left)
                return list(data[at:at + 4])
        self.fail(f"no tile holds pixel {x}, {y}")

    def test_depths_span_the_scene(self):
        # All that is seen lies far from the origin, with its centre 5 away from the camera.
        self.start("""oktett: 1
camera: {from: [10, 20, 35], at: [10, 20, 30], fov: 40}
film: {width: 96, height: 64}
integrator: {kind: whitted, samples: 4}
objects:
  - sphere: {center: [10, 20, 30], radius: 1}
""")
        self.assertEqual(self.view("layer=depth"), 200)
        status, tiles = self.frame(lambda status: status["state"]["layer"] == "depth")
        # The bounds are a cube of edge 2.
        radius = math.sqrt(3)
        for a, b in zip(status["center"], (10, 20, 30), strict=True):
            self.assertAlmostEqual(a, b, 5)
        self.assertAlmostEqual(status["radius"], radius, 5)
        for x, y in ((48, 32), (42, 32), (48, 24)):
            depth = json.loads(self.fetch(self.path + f"pick?x={x}&y={y}")[1])["depth"]
            self.assertTrue(4 <= depth < 4.5, depth)
            red, green, blue, alpha = self.pixel(tiles, x, y)
            self.assertAlmostEqual(red, 255 * (5 + radius - depth) / (2 * radius), delta=3)
            self.assertEqual([green, blue, alpha], [red, red, 255])
        self.assertEqual(self.pixel(tiles, 2, 2), [0, 0, 0, 0])

    def test_an_edit_is_shown_without_another_one(self):
        self.start()
        before = self.frame(lambda status: status["edits"] == 1)[1]
        # Replaced at once, so that the file changes but once.
        edited = self.scene.with_name("edited.yaml")
        edited.write_text(SCENE.replace("radius: 0.6", "radius: 0.9"))
        edited.replace(self.scene)
        after = self.frame(lambda status: status["edits"] == 2)[1]
        self.assertNotEqual(self.pixel(before, 48, 20), self.pixel(after, 48, 20))


class Files(ViewerTest):
    def test_saved_pictures_are_those_of_render(self):
        self.start(SCENE, "--exposure", "0.5")
        for extension, parts in (("png", png_parts), ("exr", exr_parts)):
            status, data = self.fetch(self.path + "picture." + extension)
            self.assertEqual(status, 200)
            expected = self.render("picture." + extension, None, "--exposure", "0.5")
            self.assertTrue(parts(data) == parts(expected), extension)
        # The view is another one.
        self.assertEqual(self.view("from=2 1.5 4\nexposure=1\ntone=aces"), 200)
        camera = self.fetch(self.path + "camera")[1].decode()
        lines = SCENE.splitlines(keepends=True)
        scene = lines[0] + camera + "".join(lines[2:])
        for extension, parts in (("png", png_parts), ("exr", exr_parts)):
            data = self.fetch(self.path + "picture." + extension)[1]
            expected = self.render("picture." + extension, scene, "--exposure", "1", "--tone", "aces")
            self.assertTrue(parts(data) == parts(expected), extension + " of the other view")

    def test_programs_that_run_do_not_show_the_address(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        opener, words = pathlib.Path(folder.name) / "xdg-open", pathlib.Path(folder.name) / "words"
        opener.write_text(f'#!/bin/sh\necho "$@" > {words}.new\nmv {words}.new {words}\n')
        opener.chmod(0o700)
        self.start(SCENE, to_open=True, path=folder.name)
        for _ in range(100):
            if words.exists():
                break
            time.sleep(0.1)
        page = pathlib.Path(words.read_text().strip())
        token = self.path.strip("/")
        self.assertNotIn(token, str(page))
        self.assertIn(f"url={self.address}\"", page.read_text())
        self.assertEqual(stat.S_IMODE(page.stat().st_mode), 0o600)
        self.assertEqual(stat.S_IMODE(page.parent.stat().st_mode), 0o700)
        for process in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
            try:
                self.assertNotIn(token.encode(), process.read_bytes())
            except OSError:
                pass  # it has ended meanwhile
        self.viewer.send_signal(signal.SIGINT)
        self.assertEqual(self.viewer.wait(EVER), 0)
        self.assertFalse(page.parent.exists(), "the page is still there")


if __name__ == "__main__":
    unittest.main()
