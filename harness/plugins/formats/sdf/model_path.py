"""Search path for SDF models and meshes: the folders that the user named, and no others."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from harness.core.errors import Problem, SpecError
from harness.core.files import expanded, is_file
from harness.core.inputs import is_there
from harness.core.resources import data_folder
from harness.language.files.xml_file import XmlElement, read_xml

VARIABLES = ("GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "SDF_PATH", "GAZEBO_MODEL_PATH")
"""Gazebo's environment variables: lists of folders of model folders, separated by colons."""

FUEL_CACHE = "GZ_FUEL_CACHE_PATH"  # Gazebo's variable: the folder of Fuel's downloads

FUEL = re.compile(r"https?://(?P<host>[^/]+)/(?:[\d.]+/)?(?P<owner>[^/]+)/models/(?P<name>[^/]+)")

HINT = (
    "name its folder in `world: {name: ..., model_path: [...]}` or `packages` of `robot:`, in"
    " GZ_SIM_RESOURCE_PATH, or with --model-path or --package-path"
)


class MissingFileError(SpecError):
    """A file or folder of an SDF does not exist."""


class ModelPath:
    """Folders that files may be read from.

    Attributes:
        folders: Searched in this order for `model://name`.
        roots: Those that may be read.
    """

    def __init__(
        self, world_folder: Path, named: Sequence[Path], environment: Mapping[str, str] = os.environ
    ) -> None:
        """Collect the folders of a world file.

        Args:
            world_folder: The file's folder; everything below it may be read.
            named: Folders of the scenario or the command line; searched first.
            environment: Source of `VARIABLES` and of Gazebo's cache of Fuel models.
        """
        listed = os.pathsep.join(environment.get(each, "") for each in VARIABLES).split(os.pathsep)
        self.folders = [
            *named,
            world_folder,
            world_folder / "models",
            *(expanded(folder) for folder in listed if folder),
            data_folder("worlds") / "models",
        ]
        self._nearby = (world_folder.parent / "models", world_folder.parent)  # of most packages
        home = expanded(environment.get("HOME", "~"))
        self._cache = Path(environment.get(FUEL_CACHE) or home / ".gz" / "fuel")
        self.roots = [folder.resolve() for folder in (*self.folders, self._cache)]

    def find(self, uri: str, element: XmlElement, base_folder: Path) -> Path:
        """The file or folder of a URI.

        Args:
            uri: `model://name/...`, `file://...`, a path, or a Fuel address.
            base_folder: Folder of the element's file; relative paths start there.

        Raises:
            MissingFileError: It does not exist.
            SpecError: It is in none of the folders, or is no path.
        """
        scheme, separator, rest = uri.partition("://")
        if not uri.isprintable() or not uri:
            element.refuse(f"{uri!r} is not a path")
        if not separator:
            candidates = [base_folder / uri, *(folder / uri for folder in self.folders)]
        elif scheme in ("model", "package"):
            name, _, inside = rest.partition("/")
            itself = [each / inside for each in (base_folder, *self.folders) if each.name == name]
            candidates = [*(folder / rest for folder in self.folders), *itself]
        elif scheme == "file":
            candidates = [base_folder / rest, *(folder / rest for folder in self.folders)]
        elif scheme in ("http", "https"):
            candidates = self._cached(uri)
        else:
            element.refuse(
                f"`{scheme}://` is not supported", "supported: model://, file://, a path"
            )
        is_outside = False
        for path in filter(is_there, candidates):
            if any(path.resolve().is_relative_to(root) for root in self.roots):
                return path
            is_outside = True
        if is_outside:
            element.refuse(f"`{uri}` is outside the folders that may be read", HINT)
        if scheme in ("http", "https"):
            hint = "nothing is downloaded: get the model with `gz fuel download -u ADDRESS`"
            raise MissingFileError([element.problem(f"`{uri}` is not in Gazebo's cache", hint)])
        near = [each for each in self._nearby if separator and (each / rest).exists()]
        hint = f"it is in {near[0]}; {HINT}" if near else HINT
        raise MissingFileError([element.problem(f"`{uri}` is not found", hint)])

    def _cached(self, uri: str) -> list[Path]:
        """Candidates for a Fuel model: the newest version in Gazebo's cache, or the bundled one."""
        found = FUEL.match(uri)
        if found is None or ".." in found.groups():
            return []
        host, owner, name = (found[key].lower() for key in ("host", "owner", "name"))
        folder = self._cache / host / owner / "models" / name.replace("%20", " ")
        is_there(folder / "*")  # a version that is downloaded later is newer
        versions = [path for path in folder.glob("*") if path.name.isdigit()]
        newest = sorted(versions, key=lambda path: int(path.name))[-1:]
        is_bundled = owner == "openrobotics"
        plain = name.replace("%20", "_").replace(" ", "_")
        return [*newest, *[data_folder("worlds") / "models" / plain] * is_bundled]


def model_file(folder: Path, element: XmlElement) -> Path:
    """The SDF file of a model's folder: the newest one of its model.config.

    Raises:
        SpecError: The folder has no such file.
    """
    config = folder / "model.config"
    if not is_there(config):
        if is_file(folder / "model.sdf"):
            return folder / "model.sdf"
        element.refuse(f"the folder '{folder}' has neither model.config nor model.sdf")
    listed = [(_version(item.get("version")), item) for item in read_xml(config).findall("sdf")]
    if not listed:
        raise SpecError([Problem(str(config), 1, 1, "it lacks an <sdf> with the model's file")])
    name = max(listed, key=lambda pair: pair[0])[1]
    path = folder / name.text.strip()
    if not path.resolve().is_relative_to(folder.resolve()):
        name.refuse("the file is outside the model's folder")
    if not is_file(path):
        name.refuse(f"there is no file '{path}'")
    return path


def _version(text: str) -> tuple[int, ...]:
    return tuple(int(part) for part in text.split(".") if part.isdigit())
