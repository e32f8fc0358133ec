"""The process that loads a function under test and answers calls until the caller hangs up."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import signal
import socket
import sys
import traceback
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from types import ModuleType
from typing import Any

from harness.core.errors import HarnessError
from harness.core.registry import broken_plugins, registry
from harness.core.resources import existing_or_bundled
from harness.core.suggestion import did_you_mean
from harness.plugins.iktest.calls import call
from harness.plugins.iktest.contract import UnusableSolver, parameter_words
from harness.robot.robot_source import RobotSource

OWN = "own"  # in place of a function's name: the solver that this program plans with
SOLVERS = "ik_solver"  # the kind of plug-in whose names are solvers too


def is_solver(name: str) -> bool:
    """Whether a word is `own`, or names a registered inverse kinematics solver."""
    return name == OWN or name in registry(SOLVERS)


def find_function(name: str) -> Callable[..., Any]:
    """Import a function.

    Args:
        name: `module:function` or `file.py:function`; `module:Class.method` too.

    Raises:
        UnusableSolver: There is no such file, module or function, or importing fails.
    """
    place, colon, attribute = name.rpartition(":")
    if not colon or not place or not attribute:
        known = ", ".join([OWN, *registry(SOLVERS)])
        raise UnusableSolver(
            f"'{name}' is not module:function or file.py:function, and no solver has that name; "
            f"solvers: {'; '.join([known, *broken_plugins()])}"
        )
    file = existing_or_bundled(Path(place))
    module = _from_file(file) if place.endswith(".py") else _from_name(place)
    found: Any = module
    for part in attribute.split("."):
        if not hasattr(found, part):
            offers = _offers(module, part)
            raise UnusableSolver(f"'{place}' has no function '{attribute}'; {offers}")
        found = getattr(found, part)
    if not callable(found):
        raise UnusableSolver(f"'{name}' is a {type(found).__name__}, not a function")
    return found


def _from_file(path: Path) -> ModuleType:
    if not path.is_file():
        raise UnusableSolver(f"no such file: '{path}'")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules.setdefault(path.stem, module)
    sys.path.insert(0, str(path.parent.resolve()))
    with _ImportErrorsReported(str(path)):
        spec.loader.exec_module(module)
    return module


def _from_name(name: str) -> ModuleType:
    try:
        missing = importlib.util.find_spec(name) is None
    except (ImportError, ValueError):
        missing = True
    if missing:
        raise UnusableSolver(
            f"no module '{name}' in this folder or among the installed packages; "
            "a file is named with its ending: my_ik.py:ik"
        )
    with _ImportErrorsReported(name):
        return importlib.import_module(name)


class _ImportErrorsReported:
    """Report whatever an import raises as the import's failure."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __enter__(self) -> None: ...

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if error is None or isinstance(error, KeyboardInterrupt):
            return
        last = traceback.extract_tb(error.__traceback__)[-1]
        at = f"{last.filename}:{last.lineno}"
        if isinstance(error, SyntaxError):
            at = f"{error.filename}:{error.lineno}"
        words = error.msg if isinstance(error, SyntaxError) else str(error)
        raise UnusableSolver(
            f"'{self._name}' cannot be imported: {at}: {type(error).__name__}: {words}"
        ) from error


def _offers(module: ModuleType, name: str) -> str:
    names = [name for name, value in vars(module).items()
             if inspect.isfunction(value) and value.__module__ == module.__name__]  # fmt: skip
    return did_you_mean(name, names, "functions there")


def serve(
    name: str,
    robot: RobotSource,
    tip: str,
    dof: int,
    patience: float,
    address: str,
    _notify: object,
) -> bool:
    """Load a function, then call it with whatever arguments come.

    Sends ("unusable", why) or ("ready", parameter words), then an `Outcome` for each mapping of
    arguments that it receives. A call that takes too long ends the process with SIGPROF.

    Args:
        name: The name as `find_function` takes it, that of a registered solver, or `own`.
        patience: Processor time that a call may take [s].
        address: The address of the caller's Unix socket.
    """
    link = socket.socket(socket.AF_UNIX)
    link.connect(address)
    with Connection(link.detach()) as connection:
        try:
            function = load_solver(name, robot, tip)
            words = parameter_words(function)
        except (UnusableSolver, HarnessError) as error:
            connection.send(("unusable", str(error)))
            return True
        connection.send(("ready", words))
        while True:
            try:
                arguments = connection.recv()
            except EOFError:
                return True
            signal.setitimer(signal.ITIMER_PROF, patience)
            outcome = call(function, arguments, dof)
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            connection.send(outcome)


def load_solver(name: str, robot: RobotSource, tip: str) -> Callable[..., Any]:
    """The function of a name, or a function that calls a registered solver."""
    if ":" in name or not is_solver(name):
        return find_function(name)
    from harness.plugins.iktest.builtin_ik import own_solver, plugin_solver

    return own_solver(robot, tip) if name == OWN else plugin_solver(name, robot, tip)
