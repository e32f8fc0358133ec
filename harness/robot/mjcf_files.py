"""The XML of an MJCF robot and of all files it includes, held inside the given folders."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from harness.robot.packages import NotFoundError, PackagePath
from harness.spec.xml_file import XmlElement, read_xml

DEEPEST_INCLUDE = 20
ASSETS = {"mesh": "meshdir", "texture": "texturedir", "hfield": "meshdir", "skin": "meshdir"}
TEXTURE_SIDES = ("file", "fileright", "fileup", "fileleft", "filedown", "filefront", "fileback")


def read_tree(path: Path, packages: PackagePath) -> list[XmlElement]:
    """The root elements of a file and of what it includes, each once, the file's own first.

    Raises:
        SpecError: A file cannot be read, includes itself, is no MJCF, or names a file that is not
            there or outside the folders that may be read; at line and column.
    """
    roots = list(_included(path, packages, ()))
    top = roots[0]
    if top.tag != "mujoco":
        top.refuse(f"the root element is <{top.tag}>, an MJCF's is <mujoco>")
    for extension in (item for root in roots for item in root.findall("extension")):
        extension.refuse("plugins are not loaded", "remove the <extension>")
    folders = _folders(roots, path.parent)
    for root in roots:
        for item in root.walk():
            if item.tag in ASSETS or item.tag == "model":
                for key in TEXTURE_SIDES:
                    if item.get(key):
                        folder = folders[ASSETS.get(item.tag, "meshdir")]
                        _check(item, key, folder, packages)
    return roots


def _included(path: Path, packages: PackagePath, above: tuple[Path, ...]) -> Iterator[XmlElement]:
    root = read_xml(path)
    yield root
    for item in root.walk():
        if item.tag != "include":
            continue
        name = item.need("file")
        try:
            # MuJoCo starts every include at the folder of the first file.
            inside = packages.file(name, (above[0] if above else path).parent)
        except NotFoundError as error:
            item.refuse(str(error), at="file")
        files = (*above, path)
        if inside.resolve() in [each.resolve() for each in files]:
            circle = " - ".join(each.name for each in (*files, inside))
            item.refuse(f"files include each other in a circle: {circle}", at="file")
        if len(files) > DEEPEST_INCLUDE:
            item.refuse(f"files include each other more than {DEEPEST_INCLUDE} deep", at="file")
        yield from _included(inside, packages, files)


def _folders(roots: list[XmlElement], folder: Path) -> dict[str, Path]:
    """Where meshes and textures are, by the compiler's words for them."""
    found = {"meshdir": folder, "texturedir": folder}
    for compiler in (item for root in roots for item in root.findall("compiler")):
        for key in found:
            name = compiler.get(key) or compiler.get("assetdir")
            if name:
                found[key] = folder / name
    return found


def _check(item: XmlElement, key: str, folder: Path, packages: PackagePath) -> None:
    try:
        packages.file(item.get(key), folder)
    except NotFoundError as error:
        item.refuse(f"{item.tag} {error}", at=key)
