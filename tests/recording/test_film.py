"""Films are the same bytes for the same pictures."""

import subprocess
import sys

import numpy as np
import pytest

from harness.recording.film import encoded_film
from tests.waiting import HANG

SIZES = [(130, 98), (132, 98), (146, 98), (150, 102), (160, 98), (34, 18)]


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(("width", "height"), SIZES)
def test_pictures_of_any_size_are_encoded_to_the_same_bytes_each_time(width, height):
    rng = np.random.default_rng(1)
    frames = [rng.integers(0, 255, (height, width, 3), dtype=np.uint8) for _ in range(8)]
    assert len({encoded_film(frames, 15, (width, height)) for _ in range(12)}) == 1


FORK = """
import os, sys, threading
import numpy as np
from harness.recording.film import decoded_film, encoded_film

pictures = [np.zeros((480, 640, 3), np.uint8)] * 2
assert len([*decoded_film(encoded_film(pictures, 10.0, (320, 240)))]) == 2

def fork():
    process = os.fork()
    if process == 0:
        os._exit(7)
    sys.stdout.write(str(os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])))

thread = threading.Thread(target=fork)
thread.start()
thread.join()
"""


def test_another_thread_can_fork_after_a_film():
    """av 19, which needs Python 3.12, keeps threads for each thread that used its shortcut."""
    words = [sys.executable, "-W", "ignore", "-c", FORK]
    done = subprocess.run(words, capture_output=True, text=True, timeout=HANG, check=True)
    assert done.stdout == "7"
