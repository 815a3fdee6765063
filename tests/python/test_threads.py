"""The interpreter's lock, threads, and Ctrl-C."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import oktett
from oracle import ball, random_rays


def test_other_threads_run_during_a_query():
    scene = oktett.Scene(*ball(4))
    rays = random_rays(400000, 1.0, seed=1)
    scene.build()
    oktett.set_threads(1)
    try:
        steps, ended = [], threading.Event()

        def count():
            while not ended.is_set():
                steps.append(time.perf_counter())
                time.sleep(0.0005)

        counter = threading.Thread(target=count)
        counter.start()
        begin = time.perf_counter()
        scene.all_hits(rays)
        end = time.perf_counter()
        ended.set()
        counter.join()
    finally:
        oktett.set_threads(0)
    assert sum(begin < step < end for step in steps) > 5


def test_threads_ask_one_scene_at_the_same_time():
    scene = oktett.Scene(*ball(3))
    rays = random_rays(50000, 1.0, seed=2)
    answers = [None] * 4

    def ask(k):
        answers[k] = scene.closest_hit(rays) if k else scene.closest_hit(rays[::-1])

    threads = [threading.Thread(target=ask, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert np.array_equal(answers[0].t[::-1], answers[1].t)
    assert np.array_equal(answers[1].t, answers[3].t) and np.isfinite(answers[1].t).any()


WORK = {
    "render": "scene.render(2000, 2000, samples=64)",
    "closest_hit": "[scene.closest_hit(rays) for _ in range(100)]",
    "one query": "scene.all_hits(np.tile(rays, (12, 1)))",
    "progress": "scene.render(2000, 2000, samples=64, progress=lambda part: 1 / 0)",
}


@pytest.mark.parametrize("work", WORK)
def test_ctrl_c_ends_long_work(work):
    program = f"""
import sys, numpy as np, oktett
from oracle import ball, random_rays
scene = oktett.Scene(*ball(3))
rays = random_rays(1000000, 1.0, seed=1)
scene.build()
print("ready", flush=True)
try:
    {WORK[work]}
except BaseException as error:
    print(type(error).__name__, flush=True)
    assert oktett.Scene(*ball(1)).any_hit([0, 0, 5, 0, 0, -1])
    sys.exit(5)
"""
    process = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, text=True, cwd=os.path.dirname(__file__)
    )
    assert process.stdout.readline() == "ready\n"
    if work != "progress":
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
    begin = time.perf_counter()
    output, _ = process.communicate(timeout=60)
    assert output == ("ZeroDivisionError\n" if work == "progress" else "KeyboardInterrupt\n")
    assert process.returncode == 5 and time.perf_counter() - begin < 20
