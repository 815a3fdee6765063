"""Tests of the pixels that the viewer shows and saves."""
import pathlib
import tempfile

from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select
from view_browser import BrowserTest
from view_support import SCENE, exr_parts, png_parts

LIT = """oktett: 1
camera: {from: [0, 1.5, 5], at: [0, 0.5, 0], fov: 40}
film: {width: 48, height: 32}
integrator: {kind: path, samples: 8}
background: [0, 0, 0]
lights:
  - point: {position: [-3, 4, 3], color: [12, 0, 0], light_group: left}
  - point: {position: [3, 4, 3], color: [0, 0, 12], light_group: right}
objects:
  - plane: {normal: [0, 1, 0], offset: 0}
  - sphere: {center: [0, 0.6, 0], radius: 0.6}
"""


class Pictures(BrowserTest):
    def test_settles_to_the_rendered_picture(self):
        self.open()
        self.assertEqual(self.shown()[:2], (96, 64))
        self.expect_rendered()
        self.assertEqual(self.complaints(), [])

    def test_exposure_and_tone_are_those_of_render(self):
        self.open()
        tone = Select(self.page.find_element("id", "tone"))
        self.assertEqual([option.text for option in tone.options], ["srgb", "filmic", "aces", "neutral", "raw"])
        slider = self.page.find_element("id", "exposure")
        self.do(lambda: slider.send_keys(Keys.ARROW_RIGHT * 3))
        self.wait(lambda: self.text("stops") == "0.75" and self.settled(), "the exposure")
        self.expect_rendered(None, "--exposure", "0.75")
        for name in ("filmic", "aces", "neutral"):
            self.do(lambda: tone.select_by_visible_text(name))
            self.expect_rendered(None, "--exposure", "0.75", "--tone", name)

    def test_layers_change_the_picture(self):
        self.open()
        seen = [self.shown()]
        names = self.script("return status.layers")
        self.assertEqual(names[0], "beauty")
        for name in names[1:] + ["beauty"]:
            self.do(lambda: self.page.find_element("css selector", f"[data-layer={name}]").click())
            self.assertEqual(self.script("return view.layer"), name)
            seen.append(self.shown())
        self.assertTrue(seen.pop() == seen[0], "beauty has changed")
        for k, picture in enumerate(seen):
            self.assertNotIn(picture, seen[:k], f"{names[k]} shows the same as another layer")

    def test_light_groups_have_layers(self):
        self.open(LIT)
        self.expect_rendered()
        totals = {}
        for name in ("light_left", "light_right", "light_default"):
            self.do(lambda: self.page.find_element("css selector", f"[data-layer={name}]").click())
            pixels = self.shown()[2]
            totals[name] = [sum(pixels[k::4]) for k in range(3)]
        # Each lamp gives a colour of its own to grey surfaces.
        self.assertGreater(totals["light_left"][0], 10000)
        self.assertEqual(totals["light_left"][1:], [0, 0])
        self.assertGreater(totals["light_right"][2], 10000)
        self.assertEqual(totals["light_right"][:2], [0, 0])
        self.assertEqual(totals["light_default"], [0, 0, 0])

    def test_denoised_pictures_are_those_of_render(self):
        self.open(LIT, "--denoise")
        self.expect_rendered(None, "--denoise")
        noisy = self.rendered()
        self.assertFalse(self.shown() == noisy, "nothing is denoised")

    def test_the_buttons_save_files(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.page.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": folder.name})
        self.open()
        for extension, parts in (("png", png_parts), ("exr", exr_parts)):
            self.click(extension)
            file = pathlib.Path(folder.name) / f"picture.{extension}"
            self.wait(lambda: file.exists() and file.stat().st_size > 0, "the file")
            self.assertTrue(parts(file.read_bytes()) == parts(self.render(file.name)), "the files differ")
