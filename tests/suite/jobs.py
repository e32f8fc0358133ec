"""What the suite's tests let children do instead of running a scenario."""

import ctypes
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

from harness.reporting.progress_events import StepStarted
from harness.reporting.result import CaseResult


def started(job):
    return StepStarted(2, 5, f"move_to {job.file.stem}", 1.0)


def passes(job, notify):
    notify(started(job))
    return CaseResult(str(job.file), "", "t", "passed", digest=f"pid {os.getpid()}")


def passes_when_its_file_exists(job, _notify):
    while not job.file.exists():
        time.sleep(0.01)
    return CaseResult(str(job.file), "", "t", "passed")


def raises(_job, _notify):
    raise ZeroDivisionError("one by nothing")


def segfaults(job, notify):
    notify(started(job))
    os.write(1, b"last words\n")
    ctypes.string_at(0)


def kills_itself(_job, _notify):
    os.kill(os.getpid(), signal.SIGKILL)


def leaves_without_a_result(_job, _notify):
    os._exit(0)


def never_returns_from_native_code(job, notify):
    notify(started(job))
    ctypes.PyDLL(None).sleep(6000)  # unlike a function of CDLL, it lets no other thread run


def computes_on_a_busy_processor(job, _notify):
    """Half a second of processor time, next to other programs on the same processor."""
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    while time.process_time() < 0.5:
        pass
    return CaseResult(str(job.file), "", "t", "passed")


def computes_without_end(_job, _notify):
    while True:
        pass


def leaves_a_process_running(job, _notify):
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    Path(job.file).write_text(str(child.pid))
    return CaseResult(str(job.file), "", "t", "passed")


def leaves_a_session_running(job, _notify):
    """Unlike a process of `subprocess`, it inherits every descriptor that may be inherited."""
    command = [sys.executable, "-c", "import time; time.sleep(600)"]
    child = os.posix_spawn(sys.executable, command, os.environ, setsid=True)
    Path(job.file).write_text(str(child))
    return CaseResult(str(job.file), "", "t", "passed")


def reports_its_pid_and_sleeps(job, _notify):
    Path(job.file).write_text(str(os.getpid()))
    time.sleep(600)


def prints(job, _notify):
    os.system("echo from a native library")
    sys.stdout.write("from Python")
    return CaseResult(str(job.file), "", sys.stdin.read(), "passed")


def counts_threads(job, _notify):
    threads = re.search(r"Threads:\s+(\d+)", Path("/proc/self/status").read_text())
    server = re.search(r"Threads:\s+(\d+)", Path(f"/proc/{os.getppid()}/status").read_text())
    return CaseResult(str(job.file), "", f"{threads[1]} {server[1]}", "passed")


REMEMBERED = []


def remember(word):
    REMEMBERED.append(word)


def forget_by_mistake():
    REMEMBERED.clear()
    raise ZeroDivisionError("what is prepared may fail")


def reports_what_is_remembered(job, _notify):
    return CaseResult(str(job.file), "", " ".join(REMEMBERED), "passed")


def reports_robots_already_read(job, _notify):
    from harness.robot.load import _bundled

    return CaseResult(str(job.file), "", str(_bundled.cache_info().currsize), "passed")


def reports_models_already_built(job, _notify):
    from harness.language.scenario import Scenario
    from harness.steps import Gripper, MoveTo

    built = [each.__name__ for each in (Scenario, Gripper, MoveTo) if each.__pydantic_complete__]
    return CaseResult(str(job.file), "", " ".join(built), "passed")
