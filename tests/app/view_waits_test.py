#!/usr/bin/python3
"""No request waits without end: view_waits_test.py OKTETT."""
import pathlib
import socket
import sys
import time
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from view_support import SCENE, ViewerTest

ViewerTest.OKTETT = sys.argv.pop(1)
CODE = pathlib.Path(ViewerTest.OKTETT).read_bytes()
SANITIZED = b"__asan_init" in CODE or b"__tsan_init" in CODE
SIZE = "width: 96, height: 64"
ENDLESS = SCENE.replace("samples: 4", "samples: 65536").replace(SIZE, "width: 1024, height: 1024")
VAST = SCENE.replace(SIZE, "width: 8192, height: 8192")


class Waits(ViewerTest):
    def picture(self, extension="png"):
        return self.fetch(self.path + "picture." + extension)

    def begin(self, name):
        """Sends a request for a picture and does not wait for the answer."""
        connection = socket.create_connection(("127.0.0.1", self.port), timeout=30)
        self.addCleanup(connection.close)
        connection.sendall(f"GET {self.path}{name} HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n\r\n".encode())
        return connection

    def status_line(self, connection):
        return connection.recv(65536).split(b"\r\n")[0]

    @unittest.skipIf(SANITIZED, "sanitizers need terabytes of address space")
    def test_a_picture_that_cannot_be_rendered_is_answered(self):
        self.start(VAST, "--max-memory", "400M")
        for extension in ("png", "exr"):
            status, text = self.picture(extension)
            self.assertEqual((status, text.decode()), (500, "cannot render: out of memory\n"))
        # The page is told, until the scene is another one.
        self.assertIn(b'"error": "out of memory"', self.fetch(self.path + "frame?since=0")[1])
        self.scene.write_text(SCENE)
        for _ in range(100):
            status, data = self.picture()
            if status == 200:
                break
            time.sleep(0.1)
        self.assertTrue(data.startswith(b"\x89PNG"), data[:80])
        self.assertNotIn(b'"error"', self.fetch(self.path + "frame?since=0")[1])

    def test_an_edit_that_is_wrong_leaves_the_picture_to_be_finished(self):
        scene = SCENE.replace("samples: 4", "samples: 512")
        self.start(scene)
        self.scene.write_text(scene.replace("radius: 0.3", "radios: 0.3"))
        for _ in range(300):
            if b'"error"' in self.fetch(self.path + "frame?since=0")[1]:
                break
            time.sleep(0.05)
        else:
            self.fail("the error was not reported")
        for extension in ("png", "exr"):
            self.assertEqual(self.picture(extension)[0], 200)

    def test_clients_that_have_gone_leave_room_for_others(self):
        self.start(ENDLESS)
        for _ in range(2):
            gone = [self.begin("picture.png") for _ in range(24)]
            time.sleep(0.3)
            for connection in gone:
                connection.close()
        self.assertEqual(self.ask(self.path), 200)

    def test_the_end_of_the_viewer_answers_those_who_wait(self):
        self.start(ENDLESS)
        waiting = [self.begin("picture.png"), self.begin("picture.exr")]
        time.sleep(0.3)
        self.viewer.terminate()
        for connection in waiting:
            self.assertIn(b" 400 ", self.status_line(connection))
        self.assertEqual(self.viewer.wait(30), 0)

    def test_another_view_answers_those_who_wait(self):
        self.start(ENDLESS)
        waiting = self.begin("picture.exr")
        time.sleep(0.3)
        self.assertEqual(self.view("exposure=1"), 200)
        self.assertIn(b" 400 ", self.status_line(waiting))


if __name__ == "__main__":
    unittest.main()
