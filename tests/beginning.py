"""Every test finds the process as it was before any test, and so does what tests share.

Whichever test is the first of its process, all have the same environment and folder.
"""

import os
import signal
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import pytest

from docs import ROOT
from harness.core.registry import BUILT_IN, OWN_PACKAGE, registry

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@dataclass(frozen=True)
class State:
    """What a process has once, and a test may change."""

    environment: dict[str, str]
    folder: Path
    path: list[str]
    handlers: list[object]
    temporary: str | None
    umask: int

    @classmethod
    def now(cls) -> "State":
        os.umask(umask := os.umask(0))
        folder = ROOT
        with suppress(FileNotFoundError):  # a test may have removed the folder it stands in
            folder = Path.cwd()
        handlers = [signal.getsignal(number) for number in SIGNALS]
        return cls(
            dict(os.environ), folder, list(sys.path), handlers, tempfile.tempdir, umask
        )  # fmt: skip

    def put_back(self) -> None:
        if dict(os.environ) != self.environment:
            for name in os.environ.keys() - self.environment.keys():
                del os.environ[name]
            os.environ.update(self.environment)
        os.chdir(self.folder)
        sys.path[:] = self.path
        for number, handler in zip(SIGNALS, self.handlers, strict=True):
            if signal.getsignal(number) != handler:
                signal.signal(number, handler)
        tempfile.tempdir = self.temporary
        os.umask(self.umask)


tempfile.gettempdir()  # Python looks for it once: a test may have another one in its environment
BEGINNING = State.now()


@pytest.fixture(scope="session")
def registered_plugins() -> set[str]:
    """The modules of plug-ins that are registered in this process before its first test."""
    return registered()


def registered() -> set[str]:
    """The modules of plug-ins that are registered now, without the built-in ones."""
    known = [registry(kind)._plugins.values() for kind in BUILT_IN]  # noqa: SLF001
    others = (each for plugins in known for each, package in plugins if package != OWN_PACKAGE)
    return {getattr(each, "__module__", "") for each in others}


@pytest.fixture(autouse=True)
def _put_back(registered_plugins):
    """Let no test change what the tests after it find."""
    before = State.now()
    yield
    before.put_back()
    left = registered() - registered_plugins
    registered_plugins |= left
    assert not left, f"{sorted(left)} stay registered; load them in a process of their own"


@contextmanager
def as_before_tests() -> Iterator[None]:
    """Have the process as it was at its beginning, for a while."""
    now = State.now()
    BEGINNING.put_back()
    try:
        yield
    finally:
        now.put_back()
