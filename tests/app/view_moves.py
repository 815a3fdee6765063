"""Tests of what turns, moves and focuses the viewer's camera."""
import json
import math

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
from selenium.webdriver.common.keys import Keys
from view_browser import BrowserTest
from view_support import SCENE

CAMERA = "from: [0, 1.5, 5], at: [0, 0.5, 0], fov: 40"


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def arm(view):
    return minus(view["from"], view["at"])


class Moves(BrowserTest):
    def moved(self, action):
        """The views before and after."""
        before = self.state()
        self.do(action)
        return before, self.state()

    def check_near(self, a, b, what, digits=9):
        for x, y in zip(a, b, strict=True):
            self.assertAlmostEqual(x, y, digits, what)

    def check_orbit(self, action):
        """The camera turns about what it looks at."""
        old, new = self.moved(action)
        self.assertEqual(new["at"], old["at"])
        self.assertNotEqual(new["from"], old["from"])
        self.assertAlmostEqual(math.hypot(*arm(new)), math.hypot(*arm(old)), 9)
        return minus(new["from"], old["from"])

    def check_pan(self, action):
        """Camera and target move alike, across the direction of view."""
        old, new = self.moved(action)
        move = minus(new["at"], old["at"])
        self.check_near(minus(new["from"], old["from"]), move, "camera and target move differently")
        self.assertGreater(math.hypot(*move), 1e-3)
        self.assertAlmostEqual(dot(move, arm(old)), 0, 9)
        return move

    def check_zoom(self, action):
        """The camera moves on the line to its target. Returns the new distance over the old one."""
        old, new = self.moved(action)
        self.assertEqual(new["at"], old["at"])
        factor = math.hypot(*arm(new)) / math.hypot(*arm(old))
        self.check_near(arm(new), [x * factor for x in arm(old)], "the camera leaves the line")
        return factor

    def drag(self, x, y, button=0):
        chain = ActionChains(self.page, duration=20)
        mouse = chain.w3c_actions.pointer_action
        mouse.move_to(self.canvas)
        mouse.pointer_down(button=button)
        mouse.move_by(x // 2, y // 2)
        mouse.move_by(x - x // 2, y - y // 2)
        mouse.pointer_up(button=button)
        chain.perform()

    def keys(self, *keys):
        chain = ActionChains(self.page)
        for key in keys:
            chain.key_down(key)
        for key in reversed(keys):
            chain.key_up(key)
        chain.perform()

    def touch(self, kind, *points):
        box = self.canvas.rect
        middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        self.page.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [
            {"x": middle[0] + x, "y": middle[1] + y, "id": k} for k, (x, y) in enumerate(points)]})

    def pinch(self, first, last):
        """Two fingers that far apart, with steps between."""
        self.touch("touchStart", (-first / 2, 0), (first / 2, 0))
        for k in range(1, 5):
            gap = first + (last - first) * k / 4
            self.touch("touchMove", (-gap / 2, 0), (gap / 2, 0))
        self.touch("touchEnd")

    def swipe(self, x, y):
        """Two fingers side by side, which move alike."""
        self.touch("touchStart", (-40, 0), (40, 0))
        for k in range(1, 5):
            self.touch("touchMove", (-40 + x * k / 4, y * k / 4), (40 + x * k / 4, y * k / 4))
        self.touch("touchEnd")

    def test_the_pointer_moves_the_camera(self):
        self.open()
        shown = self.shown()
        # What is dragged follows: to the right, so the camera goes to the left.
        self.assertLess(self.check_orbit(lambda: self.drag(20, 0))[0], 0)
        self.assertFalse(self.shown() == shown, "the picture is the same")
        self.assertGreater(self.check_orbit(lambda: self.drag(0, 12))[1], 0)
        self.do(lambda: self.click("home"))
        self.assertLess(self.check_pan(lambda: self.drag(20, 0, button=2))[0], 0)
        self.assertGreater(self.check_pan(lambda: self.drag(0, 12, button=2))[1], 0)
        ActionChains(self.page).key_down(Keys.SHIFT).perform()
        self.assertLess(self.check_pan(lambda: self.drag(20, 0))[0], 0)
        ActionChains(self.page).key_up(Keys.SHIFT).perform()
        origin = ScrollOrigin.from_element(self.canvas)
        for pixels in (100, -100):
            factor = self.check_zoom(lambda: ActionChains(self.page).scroll_from_origin(origin, 0, pixels).perform())
            self.assertAlmostEqual(factor, math.exp(0.0012 * pixels), 9)
        self.assertEqual(self.complaints(), [])

    def test_fingers_move_the_camera(self):
        self.open()
        box = self.canvas.rect
        # What lies at the middle stays there while the fingers move apart to twice the gap: half the distance.
        old, new = self.moved(lambda: self.pinch(80, 160))
        self.assertAlmostEqual(math.hypot(*arm(new)) / math.hypot(*arm(old)), 0.5, 6)
        height = 2 * math.hypot(*arm(old)) * math.tan(math.radians(20))
        self.assertLess(math.hypot(*minus(new["at"], old["at"])), 0.1 * height)
        self.do(lambda: self.click("home"))
        # The scene follows two fingers that move alike.
        old, new = self.moved(lambda: self.swipe(0.25 * box["height"], 0))
        move = minus(new["at"], old["at"])
        self.assertAlmostEqual(move[0] / height, -0.25, delta=0.02)
        self.assertAlmostEqual(move[1], 0, 6)
        self.do(lambda: self.click("home"))
        # One finger turns.
        self.assertLess(self.check_orbit(lambda: (self.touch("touchStart", (0, 0)), self.touch("touchMove", (10, 0)),
                                                  self.touch("touchMove", (20, 0)), self.touch("touchEnd")))[0], 0)

    def test_keys_move_the_camera(self):
        self.open()
        self.script("arguments[0].focus()", self.canvas)
        self.assertLess(self.check_orbit(lambda: self.keys(Keys.ARROW_LEFT))[0], 0)
        self.assertGreater(self.check_orbit(lambda: self.keys(Keys.ARROW_RIGHT))[0], 0)
        self.assertGreater(self.check_orbit(lambda: self.keys(Keys.ARROW_UP))[1], 0)
        self.assertLess(self.check_orbit(lambda: self.keys(Keys.ARROW_DOWN))[1], 0)
        for key, axis, sign in ((Keys.ARROW_LEFT, 0, -1), (Keys.ARROW_RIGHT, 0, 1), (Keys.ARROW_UP, 1, 1),
                                (Keys.ARROW_DOWN, 1, -1)):
            self.assertGreater(sign * self.check_pan(lambda: self.keys(Keys.SHIFT, key))[axis], 0)
        self.assertAlmostEqual(self.check_zoom(lambda: self.keys("+")), 0.9, 9)
        self.assertAlmostEqual(self.check_zoom(lambda: self.keys("-")), 1 / 0.9, 9)
        old, new = self.moved(lambda: self.keys("f"))
        self.assertNotEqual(new["at"], old["at"])
        self.do(lambda: self.keys("h"))
        self.assertEqual([self.state()[name] for name in ("from", "at", "up", "fov")],
                         [[0, 1.5, 5], [0, 0.5, 0], [0, 1, 0], 40])

    def test_a_double_click_looks_at_a_point_and_focuses(self):
        self.open(SCENE.replace("fov: 40", "fov: 40, aperture: 0.2, focus: 1"))
        # A place on the small sphere.
        def place():
            return ActionChains(self.page, duration=20).move_to_element_with_offset(self.canvas, 22, 5)

        place().click().perform()
        self.wait(lambda: "sphere" in self.text("pick"), "what lies there")
        x, y = self.text("pick").split("\n")[1].split(", ")
        pick = json.loads(self.fetch(self.path + f"pick?x={x}&y={y}")[1])
        self.assertEqual(pick["object"], 2)
        self.do(lambda: place().double_click().perform())
        self.assertEqual(self.state()["at"], pick["point"])
        camera = self.fetch(self.path + "camera")[1].decode()
        self.assertIn(f"focus: {pick['depth']}\n".replace(".0\n", "\n"), camera)
        self.expect_rendered(self.with_camera(camera))

    def with_camera(self, camera):
        lines = SCENE.splitlines(keepends=True)
        return lines[0] + camera + "".join(lines[2:])

    def test_a_copied_camera_gives_the_same_picture(self):
        self.page.execute_cdp_cmd("Browser.grantPermissions",
                                  {"permissions": ["clipboardReadWrite", "clipboardSanitizedWrite"]})
        for camera in (CAMERA, "from: [1, 2, 4], at: [0.1, 0.3, 0], up: [0.1, 1, 0], projection: orthographic, height: 3",
                       CAMERA + ", aperture: 0.3, focus: [0, 0.6, 0.6]", CAMERA + ", f_number: 0.01, focus: 4"):
            with self.subTest(camera):
                self.open(SCENE.replace(CAMERA, camera))
                self.expect_rendered()
                self.do(lambda: self.drag(50, 20))
                self.do(lambda: self.drag(10, 20, button=2))
                self.click("camera")
                self.wait(lambda: "Copied" in self.text("message"), "the copy")
                copied = self.page.execute_async_script("navigator.clipboard.readText().then(arguments[0])")
                self.assertTrue(copied.startswith("camera:\n  from: ["), copied)
                self.assertEqual(copied.strip(), self.text("yaml").strip())
                self.expect_rendered(self.with_camera(copied))

    def test_an_orthographic_camera_zooms_by_its_height(self):
        self.open(SCENE.replace("fov: 40", "projection: orthographic, height: 3"))
        self.script("arguments[0].focus()", self.canvas)
        old, new = self.moved(lambda: self.keys("+"))
        self.assertEqual([new["from"], new["at"]], [old["from"], old["at"]])
        self.assertAlmostEqual(new["height"], 2.7, 9)
        move = self.check_pan(lambda: self.drag(round(self.canvas.rect["height"] / 4), 0, button=2))
        self.assertAlmostEqual(move[0], -2.7 / 4, 2)
        self.do(lambda: self.keys("h"))
        self.assertEqual(self.state()["height"], 3)
