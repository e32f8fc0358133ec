"""Reads the XML of an MJCF robot and of its includes, within the given folders."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from harness.core.errors import SpecError
from harness.core.limits import MESH_FILE, MJCF_COPIES, MJCF_FILES
from harness.language.files.xml_file import XmlElement, read_xml
from harness.robot.packages import NotFoundError, PackagePath

DEEPEST_INCLUDE = 20
ASSETS = ("mesh", "hfield")

USER_DATA = ("body", "jnt", "geom", "site", "cam", "tendon", "actuator", "sensor")
MOST: Mapping[str, Mapping[str, int]] = {
    "texture": {"width": 8192, "height": 8192 * 6},
    "hfield": {"nrow": 2048, "ncol": 2048},
    "mesh": {"params": 100},
    "size": dict.fromkeys(
        ("nkey", "nuserdata", *(f"nuser_{kind}" for kind in USER_DATA)),
        1000,
    ),
}
"""Largest numbers in attributes, by element; MuJoCo would allocate any amount of memory for them.

The height of a cube's texture covers six sides.
"""

NAMES = ("name", "class", "childclass", "model", "body", "mesh", "joint", "material")
"""Attributes that are names, so that `nan` is one."""

UNUSED = {
    "composite": "deformable bodies are not read",
    "flexcomp": "deformable bodies are not read",
    "extension": "plugins are not loaded",
    "model": "models of other files are not attached",
}


def read_tree(path: Path, packages: PackagePath) -> list[XmlElement]:
    """The root elements of a file and of its includes, each once, the file's own first.

    Raises:
        SpecError: A file cannot be read, includes itself, is not MJCF, or needs too much memory;
            at line and column.
    """
    roots: list[XmlElement] = []
    _include(path, packages, (), roots)
    top = roots[0]
    if top.tag != "mujoco":
        hint = "name the file that includes this one" if top.tag == "mujocoinclude" else ""
        top.refuse(f"the root element is <{top.tag}>, an MJCF's is <mujoco>", hint)
    _refuse_unbounded(roots)
    return roots


def missing_meshes(
    roots: Sequence[XmlElement], folder: Path, packages: PackagePath
) -> dict[str, SpecError]:
    """Why meshes cannot be read, by their names: their file is not there, too large or outside.

    Raises:
        SpecError: A height field cannot be read; at its file.
    """
    found: dict[str, SpecError] = {}
    for item in (item for root in roots for item in root.walk()):
        if item.tag not in ASSETS or not item.get("file"):
            continue
        try:
            _check(item, "file", folder, packages)
        except SpecError as error:
            if item.tag != "mesh":
                raise
            found[item.get("name") or Path(item.get("file")).stem] = error
    return found


def _include(
    path: Path, packages: PackagePath, above: tuple[Path, ...], roots: list[XmlElement]
) -> None:
    """Add a file's root element, and those of its includes, to `roots`."""
    root = read_xml(path)
    roots.append(root)
    for item in root.walk():
        if item.tag != "include":
            continue
        name = item.need("file")
        try:
            # MuJoCo resolves every include from the folder of the first file.
            inside = packages.file(name, (above[0] if above else path).parent)
        except NotFoundError as error:
            item.refuse(str(error), at="file")
        files = (*above, path)
        if inside.resolve() in [each.resolve() for each in files]:
            circle = " - ".join(each.name for each in (*files, inside))
            item.refuse(f"files include each other in a circle: {circle}", at="file")
        if len(files) > DEEPEST_INCLUDE:
            item.refuse(f"files include each other more than {DEEPEST_INCLUDE} deep", at="file")
        if len(roots) >= MJCF_FILES:
            item.refuse(f"more than {MJCF_FILES} files are included", at="file")
        _include(inside, packages, files, roots)


def _check(item: XmlElement, key: str, folder: Path, packages: PackagePath) -> None:
    try:
        path = packages.file(item.get(key), folder)
    except NotFoundError as error:
        item.refuse(f"{item.tag} {error}", at=key)
    size = path.stat().st_size
    if size > MESH_FILE:
        most = MESH_FILE / 1e6
        item.refuse(f"{path.name} has {size / 1e6:.0f} MB; at most {most:.0f} MB are read", at=key)


def _refuse_unbounded(roots: Sequence[XmlElement]) -> None:
    """Refuse elements that are not read, numbers above their limits, and NaN.

    MuJoCo writes a log into the current folder for a NaN, and takes it as left out.

    Raises:
        SpecError: An element or number is refused; at the element or its attribute.
    """
    copies = 1.0
    for item in (item for root in roots for item in root.walk()):
        if item.tag in UNUSED:
            item.refuse(UNUSED[item.tag], f"remove the <{item.tag}>")
        for name, text in item.attributes.items():
            words = (word.lstrip("+-") for word in text.lower().split())
            if name not in NAMES and "nan" in words:
                item.refuse(f"{name} of <{item.tag}> is not a number: `{text[:40]}`", at=name)
        for name, most in MOST.get(item.tag, {}).items():
            if max(_numbers(item.get(name)), default=0.0) > most:
                item.refuse(f"<{item.tag}> has a {name} above {most}", at=name)
        if item.tag == "replicate":
            copies *= max(_numbers(item.get("count")), default=1.0)
            if copies > MJCF_COPIES:
                item.refuse(f"more than {MJCF_COPIES} copies are made", at="count")


def _numbers(text: str) -> list[float]:
    """The numbers of an attribute; text that is not a number counts as infinite."""
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        return [math.inf]
    return [math.inf if math.isnan(value) else value for value in values]
