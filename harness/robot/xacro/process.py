"""The process that renders one xacro file: request on stdin, text or error on stdout."""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import resource
import sys
from pathlib import Path
from typing import Any, NoReturn

from harness.core.errors import SpecError
from harness.language.files.xml_file import LARGEST_FILE, mark_places, read_bounded
from harness.robot.packages import NotFoundError, PackagePath

NOWHERE = "/package-that-is-not-found"
"""Folder in which a missing package is, until it is known whether the robot needs it."""

MEMORY = 1_000_000_000
"""Limit of the address space [bytes]."""

DEEPEST_INCLUDE = 40
MOST_BYTES_READ = 64_000_000

OTHERS = ("gazebo", "ros2_control", "transmission")
"""Elements of a robot that are for other programs."""

HARMLESS = frozenset(
    {
        "compile",
        "exec",
        "import",
        "marshal.loads",
        "object.__getattr__",
        "object.__setattr__",
        "os.listdir",
        "os.scandir",
        "glob.glob",
        "glob.glob/2",
        "sys._getframe",
        "builtins.id",
    }
)
"""Audit events that are allowed; files are checked one by one, all other events are refused."""


class RefusedError(Exception):
    """A file uses a feature that no robot description needs."""


class Guard:
    """Refuses forbidden actions for the rest of the process."""

    def __init__(self, packages: PackagePath) -> None:
        self._packages = packages
        self._own = tuple(Path(entry).resolve() for entry in sys.path if entry)
        self.is_on = False
        self.complaint = ""

    def __call__(self, event: str, arguments: tuple[Any, ...]) -> None:
        if not self.is_on or event in HARMLESS:
            return
        if event == "open":
            self._open(*arguments)
            return
        self._refuse(f"a xacro file may not do this: {event}")

    def _open(self, path: object, mode: object, flags: object) -> None:
        if not isinstance(path, (str, bytes)):
            return
        writes = isinstance(mode, str) and any(letter in mode for letter in "wax+")
        if writes or (isinstance(flags, int) and flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)):
            self._refuse(f"a xacro file may not write {os.fsdecode(path)}")
        self.is_on = False
        try:
            name = Path(os.fsdecode(path)).resolve()
            is_fine = self._packages.may_read(name) or (
                name.suffix in (".py", ".pyc", ".so")
                and any(name.is_relative_to(own) for own in self._own)
            )
        finally:
            self.is_on = True
        if not is_fine:
            self._refuse(self._packages.outside(os.fsdecode(path), name))

    def _refuse(self, message: str) -> NoReturn:
        self.complaint = self.complaint or message
        raise RefusedError(message)


def main() -> None:
    """Render the file of the request on stdin."""
    order = json.loads(sys.stdin.read())
    resource.setrlimit(resource.RLIMIT_CPU, (order["processor_time"], order["processor_time"]))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    packages = PackagePath(Path(order["home"]), tuple(Path(each) for each in order["given"]))
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        answer = _answer(order["file"], order["mappings"], packages)
    sys.stdout.write(json.dumps(answer))


def _answer(file: str, mappings: dict[str, str], packages: PackagePath) -> dict[str, Any]:
    import xacro
    import yaml  # noqa: F401 - imported before the guard is on: `load_yaml` uses it
    from xacro import substitution_args

    guard = Guard(packages)
    reader = _Reader(guard, packages)
    xacro.parse = reader.parse
    # without ROS, `$(find name)` has no hook of its own
    substitution_args._eval_find = reader.find  # noqa: SLF001
    substitution_args._eval_dict["find"] = reader.find  # noqa: SLF001
    sys.addaudithook(guard)
    try:
        guard.is_on = True
        document: Any = xacro.process_file(file, mappings=mappings)
        reader.refuse_missing_packages(document.documentElement)
        return _bounded(reader.restored(document.toxml()), file)
    except SpecError as error:
        problem = error.problems[0]
        return {"problem": {key: getattr(problem, key) for key in problem.__dataclass_fields__}}
    except RecursionError:
        message = "cannot be rendered: a macro, property or include runs in a circle"
        return _complaint(message, xacro.filestack, file)
    except MemoryError:
        return _complaint("cannot be rendered: it takes too much memory", xacro.filestack, file)
    except Exception as error:  # noqa: BLE001 - whatever an expression of the file raised
        message = guard.complaint or reader.missing_in(str(error)) or _message(error)
        if _is_of_memory(error):
            message = f"it takes too much memory {message}"
        complaint = _complaint(f"cannot be rendered: {message}", xacro.filestack, file)
        lacking = re.search(r"Undefined parameters \[([\w,]+)\]", message)
        if lacking and xacro.macrostack:
            name = xacro.macrostack[-1].body.getAttribute("name")
            complaint |= {"macro": f"xacro:{name}", "lacks": lacking[1].split(",")}
        return complaint
    finally:
        guard.is_on = False


def _message(error: Exception) -> str:
    """What an exception says; xacro repeats the message of one that it wraps."""
    text = " ".join(str(error).split()) or type(error).__name__
    wrapped = " ".join(str(getattr(error, "exc", None) or "").split())
    if wrapped and text.count(wrapped) > 1:
        text = "".join(text.rpartition(wrapped)[::2]).strip()
    return re.sub(r"<class '(?:\w+\.)*(\w+)'>", r"\1", text).removeprefix("RefusedError: ")


def _is_of_memory(error: object) -> bool:
    """Whether a MemoryError caused xacro's exception, whose message is empty."""
    while error is not None and not isinstance(error, MemoryError):
        error = getattr(error, "exc", None)
    return error is not None


def _bounded(text: str, file: str) -> dict[str, Any]:
    if len(text) > LARGEST_FILE:
        return {"message": f"renders to {len(text) / 1e6:.0f} MB", "file": file}
    return {"text": text}


def _complaint(message: str, stack: list[str | None] | None, file: str) -> dict[str, Any]:
    """The message, its file, and words that may be at the place."""
    named = next((each for each in reversed(stack or []) if each), file)
    quoted = re.findall(r"['\"]([^'\"]+)['\"]", message)
    bare = re.findall(r"\b\w+:\w+\b", message)
    bare += re.findall(r"(?:symbol|parameter|attribute|arg|argument):?\s+([\w.]+)", message)
    quoted += [Path(word).name for word in quoted if "/" in word]
    return {"message": message, "file": named, "words": [*reversed(quoted), *bare]}


class _Reader:
    """Reads the files of one rendering, each element marked with its place."""

    def __init__(self, guard: Guard, packages: PackagePath) -> None:
        self._guard = guard
        self._packages = packages
        self._read = 0
        self._missing: dict[str, str] = {}

    def parse(self, inp: object, filename: str | None = None) -> Any:
        """Like `xacro.parse` for files, with size limits and a check for cycles."""
        from xml.dom import minidom

        import xacro

        if filename is None:
            if isinstance(inp, str):
                return minidom.parseString(inp)
            return inp
        above = [os.path.realpath(each) for each in (xacro.filestack or [])[:-1] if each]
        here = os.path.realpath(filename)
        if here in above:
            circle = " includes ".join(
                f"'{Path(each).name}'" for each in [*above[above.index(here) :], here]
            )
            xacro.filestack.pop()
            raise RefusedError(f"files include each other in a circle: {circle}")
        if len(above) > DEEPEST_INCLUDE:
            raise RefusedError(f"files include each other more than {DEEPEST_INCLUDE} deep")
        missing_package = self.missing_in(filename)
        if missing_package:
            xacro.filestack.pop()
            raise RefusedError(missing_package)
        if not self._packages.may_read(Path(filename)):
            xacro.filestack.pop()
            path = Path(filename).resolve()
            raise RefusedError(self._packages.outside(filename, path))
        if not Path(filename).is_file():
            xacro.filestack.pop()
            missing = FileNotFoundError(f"there is no file '{filename}'")
            raise xacro.XacroException(exc=missing)
        content = read_bounded(Path(filename))
        self._read += len(content)
        if self._read > MOST_BYTES_READ:
            raise RefusedError(f"reads more than {MOST_BYTES_READ / 1e6:.0f} MB")
        return minidom.parseString(mark_places(content, filename, skip="xacro:"))

    def find(self, name: str) -> str:
        """The folder of `$(find name)`; a place without files for a package that is not found.

        Only what is read requires its packages: not the parameters of a `<gazebo>` element.
        """
        self._guard.is_on = False
        try:
            return str(self._packages.package(name))
        except NotFoundError as error:
            self._missing[name] = str(error)
            return f"{NOWHERE}/{name}"
        finally:
            self._guard.is_on = True

    def missing_in(self, text: str) -> str:
        """Why the first missing package that a text names is missing; empty if there is none."""
        names = re.findall(rf"{NOWHERE}/([\w.-]+)", text)
        return next((self._missing[name] for name in names if name in self._missing), "")

    def refuse_missing_packages(self, robot: Any) -> None:
        """Refuse missing packages in what is read of a rendered robot."""
        for child in robot.childNodes if self._missing else ():
            if child.nodeName not in OTHERS and (message := self.missing_in(child.toxml())):
                raise RefusedError(message)

    def restored(self, text: str) -> str:
        """The text with `$(find name)` where a package is missing."""
        return re.sub(rf"{NOWHERE}/([\w.-]+)", r"$(find \1)", text) if self._missing else text


if __name__ == "__main__":
    main()
