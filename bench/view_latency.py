#!/usr/bin/python3
"""How long after a drag `oktett view` shows a new picture in a headless Chromium: view_latency.py OKTETT SCENE [OPTIONS]."""
import statistics
import subprocess
import sys
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains

# From the first move of a drag to the first other picture, looked for every two milliseconds.
MEASURE = """
const canvas = document.getElementById("picture");
const picture = () => {
  const data = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  let sum = canvas.width;
  for (let i = 0; i < data.length; i += 41) sum = (sum * 31 + data[i]) | 0;
  return sum;
};
window.times = [];
let waiting = false;
document.addEventListener("pointermove", event => {
  if (event.buttons === 0 || waiting) return;
  waiting = true;
  const start = performance.now(), before = picture();
  const look = () => {
    if (picture() === before) return setTimeout(look, 2);
    window.times.push(performance.now() - start);
    waiting = false;
  };
  look();
}, true);
"""


def settle(page):
    while page.execute_script("return document.body.dataset.settled") != "true":
        time.sleep(0.1)


def main():
    viewer = subprocess.Popen([sys.argv[1], "view", *sys.argv[2:], "--no-open"], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True)
    options = webdriver.ChromeOptions()
    options.binary_location = "/usr/bin/chromium"
    for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--window-size=1000,700"):
        options.add_argument(word)
    page = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
    try:
        page.get(viewer.stdout.readline().strip())
        settle(page)
        page.execute_script(MEASURE)
        picture = page.find_element("id", "picture")
        for _ in range(20):
            drag = ActionChains(page, duration=10).move_to_element(picture).click_and_hold()
            drag.move_by_offset(25, 8).release().perform()
            time.sleep(0.3)
            settle(page)
        times = sorted(page.execute_script("return window.times"))
    finally:
        page.quit()
        viewer.terminate()
    print(f"{len(times)} drags: {times[0]:.0f} to {times[-1]:.0f} ms, median {statistics.median(times):.0f} ms")


if __name__ == "__main__":
    main()
