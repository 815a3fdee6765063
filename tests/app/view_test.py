#!/usr/bin/python3
"""The viewer in a browser: view_test.py OKTETT. Ends with 77 where no browser can be driven."""
import pathlib
import signal
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from view_support import SCENE, ViewerTest

ViewerTest.OKTETT = sys.argv.pop(1)
from view_browser import BrowserTest
from view_moves import Moves
from view_pictures import Pictures


class Page(BrowserTest):
    def test_a_click_tells_what_lies_there(self):
        self.open()
        self.canvas.click()
        self.wait(lambda: "sphere" in self.text("pick"), "the sphere's name")

    def test_the_page_of_the_desktop_leads_to_the_viewer(self):
        self.start()
        page = self.scene.with_name("open.html")
        page.write_text(f'<!doctype html><meta http-equiv="refresh" content="0; url={self.address}">')
        self.page.get(page.as_uri())
        self.wait(lambda: self.page.current_url == self.address and self.settled(), "the viewer's page")

    def test_edits_are_shown_and_faults_named(self):
        self.open()
        before = self.shown()
        self.scene.write_text(SCENE.replace("radius: 0.6", "radius: 0.9"))
        edits = "return document.body.dataset.edits"
        self.wait(lambda: self.script(edits) == "2" and self.settled(), "the edit")
        after = self.shown()
        self.assertFalse(after == before, "the edit is not shown")
        self.assertTrue(after == self.rendered(), "the pixels differ")
        self.scene.write_text(SCENE.replace("radius: 0.3", "radios: 0.3"))
        self.wait(lambda: "scene.yaml:11" in self.text("error"), "the line of the fault")
        self.assertTrue(self.shown() == after, "the last good picture is gone")
        self.scene.write_text(SCENE)
        self.wait(lambda: self.text("error") == "" and self.settled(), "the repair")
        self.assertTrue(self.shown() == before, "the repaired scene looks different")

    def test_an_interrupt_ends_it(self):
        self.start()
        self.viewer.send_signal(signal.SIGINT)
        self.assertEqual(self.viewer.wait(10), 0)


if __name__ == "__main__":
    try:
        unittest.main()
    finally:
        if BrowserTest.page is not None:
            BrowserTest.page.quit()
