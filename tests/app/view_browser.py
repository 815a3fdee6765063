"""A browser that shows the viewer's page. Ends the program with 77 where no browser can be driven."""
import base64
import shutil
import sys
import time

from view_support import SCENE, ViewerTest

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
except ImportError:
    print("skipped: python3-selenium is not installed")
    sys.exit(77)

BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
if BROWSER is None or DRIVER is None:
    print("skipped: chromium or chromium-driver is not installed")
    sys.exit(77)

TEXT_OF = "const text_of = (bytes) => btoa(Array.from(bytes, (b) => String.fromCharCode(b)).join(''));"
# The pixels of an image file, as the page's own canvas would hold them.
DECODE = """
const done = arguments[1], image = new Image();
image.onload = () => {
  const canvas = document.createElement("canvas");
  canvas.width = image.width, canvas.height = image.height;
  const paper = canvas.getContext("2d");
  paper.drawImage(image, 0, 0);
  done([canvas.width, canvas.height, text_of(paper.getImageData(0, 0, canvas.width, canvas.height).data)]);
};
image.onerror = () => done(null);
image.src = "data:image/png;base64," + arguments[0];
"""
SHOWN = """
const c = document.getElementById("picture");
return [c.width, c.height, text_of(c.getContext("2d").getImageData(0, 0, c.width, c.height).data)];
"""


class BrowserTest(ViewerTest):
    """All tests share one browser, which takes longer to start than a viewer does."""

    page = None

    @classmethod
    def setUpClass(cls):
        if BrowserTest.page is not None:
            return
        options = webdriver.ChromeOptions()
        options.binary_location = BROWSER
        for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                     "--window-size=900,700"):
            options.add_argument(word)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        BrowserTest.page = webdriver.Chrome(options=options, service=Service(DRIVER))
        BrowserTest.page.set_script_timeout(20)

    def wait(self, condition, what):
        for _ in range(400):
            if condition():
                return
            time.sleep(0.05)
        self.fail("in vain waited for " + what)

    def script(self, text, *arguments):
        return self.page.execute_script(text, *arguments)

    def settled(self):
        return self.script("return document.body.dataset.settled") == "true"

    def open(self, scene=SCENE, *options):
        """Starts a viewer, and shows its page up to the finished picture."""
        self.start(scene, *options)
        self.page.get("about:blank")  # the page of the last test complains that its viewer has ended
        self.page.get_log("browser")
        self.page.get(self.address)
        self.wait(self.settled, "the finished picture")
        self.canvas = self.page.find_element("id", "picture")

    def do(self, action):
        """Does what changes the view, and waits for the picture of the new one."""
        before = self.script("return document.body.dataset.view")
        action()
        self.wait(lambda: self.settled() and self.script("return document.body.dataset.view") != before,
                  "the picture of the new view")

    def state(self):
        """The view that the page shows, as a dictionary."""
        return self.script("return view")

    def complaints(self):
        """Errors of the page's scripts and requests. Reading a canvas as often as tests do earns a warning."""
        return [entry for entry in self.page.get_log("browser") if entry["level"] == "SEVERE"]

    def click(self, name):
        self.page.find_element("id", name).click()

    def text(self, name):
        return self.page.find_element("id", name).text

    def shown(self):
        """Width, height and the bytes of the picture on the page, four a pixel."""
        return self.decoded(self.script(TEXT_OF + SHOWN))

    def decoded(self, picture):
        width, height, text = picture
        return width, height, base64.b64decode(text)

    def rendered(self, scene=None, *options):
        """The same of the picture that `oktett render` makes."""
        data = self.render("picture.png", scene, *options)
        return self.decoded(self.page.execute_async_script(TEXT_OF + DECODE, base64.b64encode(data).decode()))

    def expect_rendered(self, scene=None, *options):
        expected = self.rendered(scene, *options)
        self.assertGreater(len(set(expected[2])), 8, "the picture is empty")
        self.assertTrue(self.shown() == expected, "the pixels differ")
