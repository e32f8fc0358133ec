"""Values that another process computes: the same as here, errors and progress included."""

import os
import subprocess
import sys
import threading

from harness.core.activity import unobserved
from harness.session.background import Background
from tests.waiting import HANG


def in_a_process_without_threads(code):
    """The lines that a fresh interpreter prints, in which `Background` forks."""
    head = (
        "import os, sys, time; from harness.session.background import Background\n"
        "from harness.core.activity import unobserved\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", head + code],
        capture_output=True, text=True, check=False, timeout=HANG,
    )  # fmt: skip
    assert done.stderr == ""
    return done.stdout.split()


def test_another_process_computes_the_value():
    here, there, value = in_a_process_without_threads(
        "value = Background(lambda _: (os.getpid(), 'x' * 100_000)).result(unobserved)\n"
        "print(os.getpid(), *value)"
    )
    assert here != there
    assert value == "x" * 100_000


def test_its_progress_is_reported_and_what_it_raises_is_raised():
    assert in_a_process_without_threads(
        "def work(activity):\n"
        "    activity('drawing', 1, 3)\n"
        "    raise ValueError('no colour')\n"
        "try: Background(work).result(lambda *event: print(*event))\n"
        "except ValueError as error: print(error)"
    ) == ["drawing", "1", "3", "no", "colour"]


def test_a_process_that_crashes_is_an_error_of_the_case():
    assert in_a_process_without_threads(
        "from harness.core.errors import HarnessError\n"
        "try: Background(lambda _: os.kill(os.getpid(), 11)).result(unobserved)\n"
        "except HarnessError as error: print(error)"
    ) == ["the", "process", "in", "the", "background", "ended", "with", "code", "-11"]


def test_a_process_that_has_sent_its_value_is_waited_for_when_it_is_closed():
    assert in_a_process_without_threads(
        "background = Background(lambda _: 1); pid = background._pid\n"
        "print(background.result(unobserved), os.path.exists(f'/proc/{pid}'))\n"
        "background.close(); background.close()\n"
        "print(os.path.exists(f'/proc/{pid}'))"
    ) == ["1", "True", "False"]


def test_a_process_that_is_closed_ends_at_once():
    assert in_a_process_without_threads(
        "background = Background(lambda _: time.sleep(6000))\n"
        "background.close(); background.close()\n"
        "print('closed')"
    ) == ["closed"]


def test_a_process_with_threads_computes_the_value_itself():
    end = threading.Event()
    thread = threading.Thread(target=end.wait)
    thread.start()
    try:
        assert Background(lambda _: os.getpid()).result(unobserved) == os.getpid()
    finally:
        end.set()
        thread.join()
