#!/usr/bin/python3
"""The viewer in a browser: view_test.py OKTETT. Ends with 77 where no browser can be driven."""
import base64
import http.client
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.parse

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
except ImportError:
    print("skipped: python3-selenium is not installed")
    sys.exit(77)

BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
if BROWSER is None or DRIVER is None:
    print("skipped: chromium or chromium-driver is not installed")
    sys.exit(77)

OKTETT = sys.argv.pop(1)
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
# The pixels of an image file, as the page's own canvas would hold them.
DECODE = """
const done = arguments[1], image = new Image();
image.onload = () => {
  const canvas = document.createElement("canvas");
  canvas.width = image.width, canvas.height = image.height;
  const paper = canvas.getContext("2d");
  paper.drawImage(image, 0, 0);
  done([canvas.width, canvas.height, ...paper.getImageData(0, 0, canvas.width, canvas.height).data]);
};
image.onerror = () => done(null);
image.src = "data:image/png;base64," + arguments[0];
"""
SHOWN = """
const c = document.getElementById("picture");
return [c.width, c.height, ...c.getContext("2d").getImageData(0, 0, c.width, c.height).data];
"""


class Viewer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        options = webdriver.ChromeOptions()
        options.binary_location = BROWSER
        for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                     "--window-size=900,700"):
            options.add_argument(word)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        cls.page = webdriver.Chrome(options=options, service=Service(DRIVER))
        cls.page.set_script_timeout(10)

    @classmethod
    def tearDownClass(cls):
        cls.page.quit()

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.scene = pathlib.Path(folder.name) / "scene.yaml"
        self.scene.write_text(SCENE)
        self.viewer = subprocess.Popen([OKTETT, "view", self.scene, "--no-open"], stdout=subprocess.PIPE,
                                       stderr=subprocess.STDOUT, text=True)
        self.addCleanup(self.end)
        self.address = self.viewer.stdout.readline().strip()
        self.assertRegex(self.address, r"^http://127\.0\.0\.1:\d+/[0-9a-f]{32}/$")
        self.parts = urllib.parse.urlsplit(self.address)

    def end(self):
        if self.viewer.poll() is None:
            self.viewer.kill()
        self.viewer.wait()
        self.viewer.stdout.close()

    def wait(self, condition, what):
        for _ in range(100):
            if condition():
                return
            time.sleep(0.1)
        self.fail("in vain waited for " + what)

    def settled(self):
        return self.page.execute_script("return document.body.dataset.settled") == "true"

    def open(self):
        self.page.get("about:blank")  # the page of the last test complains that its viewer has ended
        self.page.get_log("browser")
        self.page.get(self.address)
        self.wait(self.settled, "the finished picture")

    def shown(self):
        return self.page.execute_script(SHOWN)

    def rendered(self):
        file = self.scene.with_name("picture.png")
        subprocess.run([OKTETT, "render", self.scene, "-o", file], check=True, capture_output=True)
        return self.page.execute_async_script(DECODE, base64.b64encode(file.read_bytes()).decode())

    def text(self, name):
        return self.page.find_element("id", name).text

    def ask(self, path, method="GET", body=None, headers=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.parts.port, timeout=10)
        try:
            connection.request(method, path, body=body, headers=headers or {})
            return connection.getresponse().status
        finally:
            connection.close()

    def test_settles_to_the_rendered_picture(self):
        self.open()
        expected = self.rendered()
        self.assertEqual(expected[:2], [96, 64])
        self.assertGreater(len(set(expected)), 20)
        self.assertTrue(self.shown() == expected, "the pixels differ")
        self.assertEqual(self.page.get_log("browser"), [])

    def test_dragging_keys_and_layers_change_the_picture(self):
        self.open()
        canvas = self.page.find_element("id", "picture")
        before = self.shown()
        for act in (lambda: ActionChains(self.page).drag_and_drop_by_offset(canvas, 60, 20).perform(),
                    lambda: canvas.send_keys("+"),
                    lambda: self.page.find_element("css selector", "[data-layer=normal]").click()):
            act()
            self.wait(self.settled, "the picture of the new view")
            after = self.shown()
            self.assertFalse(after == before, "the picture is the same")
            before = after

    def test_saved_files_and_the_camera(self):
        for name in ("picture.png", "picture.exr", "camera"):
            self.assertEqual(self.ask(self.parts.path + name), 200, name)
        self.open()
        self.page.find_element("id", "camera").click()
        self.wait(lambda: "from: [0, 1.5, 5]" in self.text("yaml"), "the camera")

    def test_a_click_tells_what_lies_there(self):
        self.open()
        self.page.find_element("id", "picture").click()
        self.wait(lambda: "sphere" in self.text("pick"), "the sphere's name")

    def test_edits_are_shown_and_faults_named(self):
        self.open()
        before = self.shown()
        self.scene.write_text(SCENE.replace("radius: 0.6", "radius: 0.9"))
        edits = "return document.body.dataset.edits"
        self.wait(lambda: self.page.execute_script(edits) == "2" and self.settled(), "the edit")
        after = self.shown()
        self.assertFalse(after == before, "the edit is not shown")
        self.assertTrue(after == self.rendered(), "the pixels differ")
        self.scene.write_text(SCENE.replace("radius: 0.3", "radios: 0.3"))
        self.wait(lambda: "scene.yaml:11" in self.text("error"), "the line of the fault")
        self.assertTrue(self.shown() == after, "the last good picture is gone")
        self.scene.write_text(SCENE)
        self.wait(lambda: self.text("error") == "" and self.settled(), "the repair")
        self.assertTrue(self.shown() == before, "the repaired scene looks different")

    def test_strangers_are_refused(self):
        path = self.parts.path
        kind = {"Content-Type": "application/x-oktett-view"}
        self.assertEqual(self.ask(path), 200)
        self.assertEqual(self.ask(path + "view", "POST", "exposure=1", kind), 200)
        self.assertEqual(self.ask("/"), 404)
        self.assertEqual(self.ask("/" + "0" * 32 + "/"), 404)
        self.assertEqual(self.ask(path + "no-such-file"), 404)
        self.assertEqual(self.ask(path, headers={"Host": "example.org"}), 403)
        self.assertEqual(self.ask(path, headers={"Origin": "http://example.org"}), 403)
        self.assertEqual(self.ask(path + "view", "POST", "exposure=1", {"Content-Type": "text/plain"}), 415)
        self.assertEqual(self.ask(path + "view", "POST", "x" * 5000, kind), 413)
        for lines in ("exposure=1e9", "from=nan 0 0", "fov=180", "layer=none", "nonsense"):
            self.assertEqual(self.ask(path + "view", "POST", lines, kind), 400, lines)
        self.assertEqual(self.ask(path + "pick?x=96&y=0"), 400)

    def test_an_interrupt_ends_it(self):
        self.viewer.send_signal(signal.SIGINT)
        self.assertEqual(self.viewer.wait(10), 0)


if __name__ == "__main__":
    unittest.main()
