"""Resolves `package://` names, within the folders that may be read."""

from __future__ import annotations

import importlib.util
import os
import re
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

from harness.core.files import expanded, home_folder, is_dir, is_file, open_regular
from harness.core.inputs import is_there

SEARCH_VARIABLE = "HARNESS_PACKAGE_PATH"
"""Environment variable with additional folders to search, separated as in PATH."""

MANIFEST = "package.xml"
DEEPEST = 4  # levels of folders in which packages are sought
HIGHEST = 3
"""Levels above a robot's file at which a folder of a package's name is taken as the package."""
MOST_FOLDERS = 5_000  # below a path; more is no collection of packages
DESCRIPTIONS = ("urdf", "xacro", "robots")  # Usual folders of the descriptions in a package

LARGEST_MANIFEST = 200_000  # [bytes] of a package.xml that is read
NAME = re.compile(rb"<name>\s*([\w.-]+)\s*</name>")
SCHEMES = ("package://", "model://")


class NotFoundError(ValueError):
    """A file does not exist, or is outside the folders that may be read."""


@dataclass(frozen=True)
class PackagePath:
    """Folders that may contain a robot's files.

    Packages are searched in `given`, around `home`, and among the installed Python packages; their
    folders may be read too.

    Attributes:
        home: The folder of the robot's package, or of its file if there is no package.xml.
        given: Folders of the scenario, then of the environment.
        assumed: The folders that were read instead of packages that are nowhere, by their names.
    """

    home: Path
    given: tuple[Path, ...] = ()
    _found: dict[str, Path] = field(default_factory=dict[str, Path], repr=False, compare=False)
    assumed: dict[str, Path] = field(default_factory=dict[str, Path], repr=False, compare=False)

    @classmethod
    def of_file(cls, path: Path, given: Sequence[Path] = ()) -> PackagePath:
        """The search path of a robot's file."""
        folder = path.resolve().parent
        home = next(
            (each for each in (folder, *folder.parents) if is_file(each / MANIFEST)), folder
        )
        return cls(home, (*(each.resolve() for each in given), *environment_folders()))

    @property
    def notes(self) -> tuple[str, ...]:
        """What was assumed about packages that are nowhere."""
        return tuple(
            f"the package '{name}' is not found: {folder} is read instead"
            for name, folder in self.assumed.items()
        )

    def package(self, name: str, inside: str = "") -> Path:
        """The folder of a package.

        Files are often copied out of their package. So where a package is not found, the folder
        around the robot's file is read instead that has the required path, or the one whose folder
        of descriptions has the robot's file.

        Args:
            inside: The required path in it; empty for any.

        Raises:
            NotFoundError: The package is not found; the message has the searched places.
        """
        if name not in self._found:
            found = next(self._candidates(name), None)
            if found is None:
                found = next((each for each in self._above() if self._may_be(each, inside)), None)
                if found is not None:
                    self.assumed[name] = found.resolve()
            if found is None:
                raise NotFoundError(
                    f"the package '{name}' is not found; give the folder that holds it with "
                    f"--package-path, in `packages` of `robot:` or in {SEARCH_VARIABLE}, "
                    "or install it"
                )
            self._found[name] = found.resolve()
        return self._found[name]

    def file(self, name: str, folder: Path) -> Path:
        """The path of a file name in a robot's file.

        Args:
            name: `package://name/path`, `file:///path`, or a path.

        Raises:
            NotFoundError: It does not exist, or is not in a folder that may be read.
        """
        scheme = next((each for each in SCHEMES if name.startswith(each)), None)
        if scheme is not None:
            package, _, rest = name.removeprefix(scheme).partition("/")
            try:
                path = (self.package(package, rest) / rest).resolve()
            except NotFoundError as error:
                raise NotFoundError(f"'{name}': {error}") from error
        elif re.match(r"\w+://", name) and not name.startswith("file://"):
            raise NotFoundError(f"'{name}' is not a file: known are package:// and file://")
        else:
            path = (folder / name.removeprefix("file://")).resolve()
        if not self.may_read(path):
            raise NotFoundError(self.outside(name, path))
        if not is_file(path):
            raise NotFoundError(f"'{name}' is not there: {path} does not exist")
        return path

    def outside(self, name: str, path: Path) -> str:
        """The message on a file that may not be read, with the folder that would allow it."""
        if not is_dir(path.parent):
            return f"'{name}' is a path of another machine: {path.parent} does not exist here"
        around = Path(os.path.commonpath([self.home, path.parent]))
        folder = path.parent if _holds_home(around) else around
        return (
            f"'{name}' lies outside the robot's folder {self.home} and the given ones; if it may "
            f"be read, give --package-path {folder}, or add that folder to `packages` of `robot:`"
        )

    def may_read(self, path: Path) -> bool:
        """Whether a file lies in a folder that may be read."""
        folders = (self.home, *self.given, *self._found.values())
        resolved = path.resolve()
        return any(resolved.is_relative_to(folder) for folder in folders)

    def _candidates(self, name: str) -> Iterator[Path]:
        if not re.fullmatch(r"[\w.-]+", name) or name.strip(".") == "":
            return
        for folder in (self.home, *self.given):
            if _is_package(folder, name):
                yield folder
        for folder in (*self.given, *self._around()):
            yield from _inside(folder, name)
        for folder in self._above():
            yield from (each for each in (folder, folder / name) if _is_folder(each, name))
        yield from _installed(name)
        for folder in self.given:
            yield from (each for each in _packages_below(folder) if _is_package(each, name))

    def _above(self) -> Iterator[Path]:
        """Folders around the file of a robot without a package.xml, which its package may be.

        Wheels and archives often carry a ROS package without it. A user's home folder and what
        holds it are none.
        """
        if is_file(self.home / MANIFEST):
            return
        for folder in (self.home, *self.home.parents)[: HIGHEST + 1]:
            if _holds_home(folder) or folder == Path(folder.anchor):
                return
            yield folder

    def _may_be(self, folder: Path, inside: str) -> bool:
        """Whether a folder may be the package of which a file of the robot has a path."""
        if inside:
            return is_file(folder / inside)
        return any(self.home.is_relative_to(folder / each) for each in DESCRIPTIONS)

    def _around(self) -> Iterator[Path]:
        """Folders of adjacent packages: the parent folder, and install folders next to its own."""
        if is_file(self.home / MANIFEST):
            yield self.home.parent
            if self.home.parent.name == "share":
                yield self.home.parents[2]


def _holds_home(folder: Path) -> bool:
    """Whether a folder is the user's home folder, or holds it."""
    home = home_folder()
    return home is not None and home.is_relative_to(folder)


def environment_folders() -> tuple[Path, ...]:
    """Folders of the environment variable."""
    listed = os.environ.get(SEARCH_VARIABLE, "").split(os.pathsep)
    return tuple(expanded(each).resolve() for each in listed if each)


@contextmanager
def additional_package_folders(folders: Sequence[Path]) -> Iterator[None]:
    """Search additional folders, in this process and in processes that start meanwhile."""
    before = os.environ.get(SEARCH_VARIABLE)
    listed = [*(str(folder.resolve()) for folder in folders), *([before] if before else [])]
    if listed:
        os.environ[SEARCH_VARIABLE] = os.pathsep.join(listed)
    try:
        yield
    finally:
        if before is not None:
            os.environ[SEARCH_VARIABLE] = before
        else:
            os.environ.pop(SEARCH_VARIABLE, None)


def _is_folder(folder: Path, name: str) -> bool:
    return folder.name == name and is_there(folder) and is_dir(folder)


def _inside(folder: Path, name: str) -> Iterator[Path]:
    """The folder of a package in colcon's `src`, `install` and merged `install` layouts."""
    for path in (folder / name / "share" / name, folder / "share" / name, folder / name):
        if is_there(path) and is_dir(path):
            yield path


def _installed(name: str) -> Iterator[Path]:
    """A Python package, or the `share` folder of a wheel."""
    module = name.replace("-", "_")
    try:
        spec = importlib.util.find_spec(module) if module.isidentifier() else None
    except (ImportError, ValueError):
        spec = None
    for each in [Path(sys.prefix), *(Path(entry) / "cmeel.prefix" for entry in sys.path if entry)]:
        path = each / "share" / name
        if is_dir(path):
            yield path
    if spec is not None and spec.submodule_search_locations:
        yield Path(next(iter(spec.submodule_search_locations)))


@lru_cache(maxsize=16)
def _packages_below(folder: Path) -> tuple[Path, ...]:
    """Folders with a package.xml, at most DEEPEST levels down."""
    found: list[Path] = []
    level, seen = [folder], 0
    for _ in range(DEEPEST):
        below: list[Path] = []
        for each in level:
            try:
                inside = sorted(item for item in each.iterdir() if is_dir(item))
            except OSError:
                continue
            seen += len(inside)
            if seen > MOST_FOLDERS:
                return tuple(found)
            for item in inside:
                (found if is_file(item / MANIFEST) else below).append(item)
        level = below
    return tuple(found)


def _is_package(folder: Path, name: str) -> bool:
    """Whether a folder is the package of a name, by its package.xml."""
    if not is_there(folder / MANIFEST):
        return False
    try:
        with open_regular(folder / MANIFEST) as manifest:
            found = NAME.search(manifest.read(LARGEST_MANIFEST))
    except OSError:
        return False
    return found is not None and found[1].decode() == name
