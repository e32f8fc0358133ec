"""Renders xacro files: bundled ones in this process, others in a restricted process."""

from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

from harness.core.errors import Problem, RobotError, RobotOptionError, SpecError
from harness.core.user_cache import cached, store
from harness.language.files.source import Source
from harness.language.files.xml_file import XmlElement, read_bounded, read_xml
from harness.robot.packages import PackagePath
from harness.robot.xacro.process import OTHERS

XACRO_PREFIX = "xacro:"
XACRO_ARG = "xacro:arg"
SUBSTITUTION = re.compile(r"\$\([^)]*\)|\$\{[^}]*\}")
PROCESSOR_TIME = 8
"""CPU time limit of a rendering [s]."""

WALL_TIME = 60.0
"""Time limit of a rendering that uses less CPU time [s]."""


def is_xacro(root: XmlElement) -> bool:
    """Whether a document has parts that xacro replaces."""
    return next(xacro_parts(root), None) is not None


def xacro_parts(root: XmlElement) -> Iterator[tuple[XmlElement, str, str]]:
    """What xacro replaces in a robot's document: the element, its attribute if any, and the text.

    Attributes in elements for other programs, such as `<gazebo>`, do not count.
    """
    for item in root.walk():
        if item.tag.startswith(XACRO_PREFIX):
            yield item, "", f"<{item.tag}>"
    for item in (item for each in root.children if each.tag not in OTHERS for item in each.walk()):
        for key, value in item.attributes.items():
            if found := SUBSTITUTION.search(value):
                yield item, key, found[0]


def arguments_of(root: XmlElement) -> frozenset[str]:
    """Names that a xacro document declares as arguments."""
    return frozenset(item.get("name") for item in root.walk() if item.tag == XACRO_ARG)


def refuse_unknown_arguments(args: Mapping[str, Any], paths: Sequence[Path]) -> None:
    """Refuse arguments that none of a robot's files declares; included files may declare them.

    Raises:
        SpecError: A file is not XML.
        RobotError: No file takes one of the arguments.
    """
    roots = {path: root for path in paths if args and is_xacro(root := read_xml(path))}
    if args and not roots:
        raise RobotOptionError("args", "only a xacro file takes arguments, and none is given")
    declared = {name for root in roots.values() for name in arguments_of(root)}
    includes = any(item.tag == "xacro:include" for root in roots.values() for item in root.walk())
    unknown = [key for key in args if key not in declared]
    if unknown and not includes:
        names = " and ".join(path.name for path in roots)
        raise RobotOptionError(
            "args",
            f"{names} takes no argument '{unknown[0]}'; "
            f"known are {', '.join(sorted(declared)) or 'none'}",
        )


def render_bundled(path: Path, mappings: Mapping[str, str]) -> str:
    """The URDF text of a bundled file, which the user's cache directory keeps.

    The key holds everything that the text depends on: all files of the robot's folder, the
    arguments, and the version of xacro.

    Raises:
        RobotError: It cannot be rendered with these arguments.
    """
    key = hashlib.sha256(repr((version("xacro"), str(path), sorted(mappings.items()))).encode())
    for each in sorted(each for each in path.parent.rglob("*") if each.is_file()):
        key.update(each.read_bytes())
    name = f"rendered/{key.hexdigest()}.urdf"
    stored = cached(name)
    if stored is None:
        stored = _rendered_bundled(path, mappings).encode()
        store(name, stored)
    return stored.decode()


def _rendered_bundled(path: Path, mappings: Mapping[str, str]) -> str:
    import xacro  # here: parsing plain URDFs does not need it

    xacro.__dict__["open"] = partial(
        open, encoding="utf-8"
    )  # it would read with the locale's encoding
    try:
        document: Any = xacro.process_file(str(path), mappings=dict(mappings))
    except (xacro.XacroException, OSError) as error:
        raise RobotError(f"{path}: cannot be rendered: {error}") from error
    return str(document.toxml())


def render(path: Path, args: Mapping[str, Any], packages: PackagePath) -> str:
    """The URDF text of a xacro file, each element marked with its source place.

    Expressions of a xacro file are Python. A separate process evaluates them: it may read only the
    given folders, may not start processes, and has limited memory and CPU time.

    Raises:
        SpecError: The file, or one that it includes, cannot be rendered.
    """
    order = {
        "file": str(path),
        "mappings": {key: _text(value) for key, value in args.items()},
        "home": str(packages.home),
        "given": [str(each) for each in packages.given],
        "processor_time": PROCESSOR_TIME,
    }
    answer = _request(order, path)
    if "text" in answer:
        return str(answer["text"])
    raise SpecError([_problem(answer, path, packages)])


def _text(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _request(order: Mapping[str, Any], path: Path) -> dict[str, Any]:
    environment = {"PYTHONPATH": os.pathsep.join(each for each in sys.path if each)}
    command = [sys.executable, "-X", "utf8", "-m", "harness.robot.xacro.process"]
    try:
        done = subprocess.run(
            command,
            input=json.dumps(order),
            capture_output=True,
            text=True,
            encoding="utf-8",
            errors="replace",
            timeout=WALL_TIME,
            env=environment,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        raise SpecError([_endless(path)]) from error
    if done.returncode < 0:
        raise SpecError([_endless(path)])
    try:
        return dict(json.loads(done.stdout))
    except ValueError as error:
        last = (done.stderr.strip().splitlines() or ["no reason given"])[-1]
        message = f"cannot be rendered: {last}"
        raise SpecError([Problem(str(path), 0, 0, message)]) from error


def _endless(path: Path) -> Problem:
    message = "cannot be rendered: it takes more time or memory than any robot does"
    return Problem(str(path), 1, 1, message, "look for a macro or expression without an end")


def _problem(answer: Mapping[str, Any], path: Path, packages: PackagePath) -> Problem:
    """The process's message, at the text in the file that it refers to."""
    if "problem" in answer:
        return Problem(**answer["problem"])
    named = str(answer.get("file") or path)
    if not packages.may_read(Path(named)):
        named = str(path)
    message, words = str(answer["message"]), [str(word) for word in answer.get("words", [])]
    try:
        lines = read_bounded(Path(named)).decode("utf-8", errors="replace").splitlines()
    except SpecError:
        return Problem(named, 0, 0, message)
    source = Source(named, tuple(lines))
    if "macro" in answer:
        call = _call_without(lines, str(answer["macro"]), [str(name) for name in answer["lacks"]])
        if call is not None:
            number, column = call
            return Problem(named, number, column, message, "", source.line(number))
    for word in words:
        for number, line in enumerate(lines, 1):
            column = line.find(word)
            if word and column >= 0:
                text = source.line(number)
                return Problem(named, number, column + 1, message, "", text, len(word))
    return Problem(named, 1, 1, message, "", source.line(1))


def _call_without(
    lines: Sequence[str], macro: str, parameters: Sequence[str]
) -> tuple[int, int] | None:
    """Line and column of the first call of a macro that lacks parameters."""
    text = "\n".join(lines)
    for call in re.finditer(rf"<{re.escape(macro)}\b[^>]*", text):
        if not any(re.search(rf"\b{re.escape(name)}\s*=", call[0]) for name in parameters):
            before = text[: call.start()]
            return before.count("\n") + 1, call.start() - before.rfind("\n")
    return None
