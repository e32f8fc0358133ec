"""The check of motions is compiled once, by another process where no command has to wait for it."""

import fcntl
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from harness.core.user_cache import cache_folder, cached, store
from harness.planning.collision import compiled
from harness.planning.collision.compilation import code_file
from harness.planning.collision.compiled import COMPILING_PAYS_LATER, COMPILING_PAYS_NOW

CHECKS = """
import sys, time
from harness.planning.collision import compilation, compiled
compilation.DELAY = 0.0
states = int(sys.argv[1])
print("begins", flush=True)
found = compiled.compiled_check(states)
while "waits" in sys.argv and found is None:
    time.sleep(0.2)
    found = compiled.compiled_check(1000)
print("compiled" if found else "not compiled", "numba" in sys.modules)
"""
COMPILER = [sys.executable, "-m", "harness.planning.collision.compilation", "0"]


@pytest.fixture(autouse=True)
def empty_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


@pytest.fixture(scope="module")
def code(tmp_path_factory):
    """Machine code that another process compiled, for one that waited for it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        assert checked(COMPILING_PAYS_LATER, "waits") == "compiled False"
        return cached(code_file())


def process(states, *words):
    command = [sys.executable, "-c", CHECKS, str(states), *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def checked(states, *words):
    """What a process says that checks a number of states."""
    with process(states, *words) as one:
        output, _ = one.communicate(timeout=300)
    assert one.returncode == 0
    return output.removeprefix("begins\n").strip()


def lock_file() -> Path:
    file = cache_folder() / "machine_code/lock"
    file.parent.mkdir(parents=True, exist_ok=True)
    return file


def test_who_checks_much_uses_what_another_process_compiled_meanwhile(code):
    store(code_file(), code)
    assert checked(1) == "compiled False"


def test_who_reads_the_output_does_not_wait_for_the_compiler():
    os.mkfifo(lock_file())  # the compiler stops at it
    assert checked(COMPILING_PAYS_LATER) == "not compiled False"
    store(code_file(), b"leaves it nothing to do")
    with lock_file().open("r"):  # opens when the compiler has opened it for writing
        pass


def test_a_second_process_does_not_compile_at_the_same_time():
    with lock_file().open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        subprocess.run(COMPILER, check=True, timeout=300)
    assert cached(code_file()) is None


def test_who_checks_very_much_waits_for_the_compiler(code):
    """It would have loaded numba if it had compiled itself."""
    with lock_file().open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with process(COMPILING_PAYS_NOW, "waits") as one:
            assert one.stdout is not None
            assert one.stdout.readline() == "begins\n"
            time.sleep(1.0)
            assert one.poll() is None
            store(code_file(), code)
            fcntl.flock(lock, fcntl.LOCK_UN)
            assert one.communicate(timeout=300)[0] == "compiled False\n"


def test_few_states_start_no_compiler(monkeypatch):
    started = []
    monkeypatch.setattr(compiled, "compile_in_background", lambda: started.append(True))
    for name, value in (("_check", None), ("_states", 0), ("_next_look", 0)):
        monkeypatch.setattr(compiled, name, value)
    assert compiled.compiled_check(COMPILING_PAYS_LATER - 1) is None
    assert not started
    assert compiled.compiled_check(1) is None
    assert compiled.compiled_check(1) is None
    assert started == [True]


def test_without_a_lock_nothing_is_compiled():
    lock_file().mkdir()
    with process(COMPILING_PAYS_NOW, "waits") as one:
        assert one.stdout is not None
        assert one.stdout.readline() == "begins\n"
        with pytest.raises(subprocess.TimeoutExpired):
            one.wait(2.0)
        one.kill()
    assert cached(code_file()) is None


@pytest.mark.parametrize("states", [COMPILING_PAYS_LATER, COMPILING_PAYS_NOW])
def test_without_a_cache_nothing_is_compiled(states, tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert checked(states) == "not compiled False"
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
