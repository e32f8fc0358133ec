"""Commands in processes of their own, forked from one that has imported the libraries."""

import atexit
import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from harness.suite.cases import read_ahead
from harness.suite.warm import REPORT_MODULES, RUN_MODULES, Ended, WarmServer

ROBOTS = frozenset({"open_manipulator_x"})
"""Bundled robots that most scenarios of tests name."""


@cache
def server() -> WarmServer:
    made = WarmServer(["harness.cli.main", *RUN_MODULES, *REPORT_MODULES, "tests.commands"])
    made.prepare(read_ahead, ROBOTS)
    atexit.register(made.close)
    return made


def forked(function, *arguments) -> Ended:
    """The end of a process that calls a function, which has the name of a module's."""
    job = server().start(function, *arguments)
    while True:
        for event in server().wait(None):
            if isinstance(event, Ended) and event.job == job:
                return event


def harness(*words, cwd, **environment) -> subprocess.CompletedProcess[str]:
    """A command that ended; its modules come from the paths of `PYTHONPATH` first."""
    words = [str(word) for word in words]
    with TemporaryDirectory() as folder:
        out, err = Path(folder, "out"), Path(folder, "err")
        end = forked(_command, words, str(cwd), {**os.environ, **environment}, out, err)
        assert server().pid is not None, "the server ended"
        text = [file.read_text(encoding="utf-8") for file in (out, err)]
    return subprocess.CompletedProcess(words, end.code or 0, *text)


def _command(words, cwd, environment, out, err, _notify):
    from harness.cli.main import entry

    for file, number in ((out, 1), (err, 2)):
        with file.open("wb") as stream:
            os.dup2(stream.fileno(), number)
    os.chdir(cwd)
    os.environ.clear()
    os.environ.update(environment)
    paths = environment.get("PYTHONPATH", "").split(os.pathsep)
    sys.path[:0] = [cwd, *filter(None, paths)]
    sys.argv[:] = ["harness", *words]
    entry()
