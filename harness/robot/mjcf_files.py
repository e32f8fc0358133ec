"""The XML of an MJCF robot and of all files it includes, held inside the given folders."""

from __future__ import annotations

from pathlib import Path

from harness.robot.mesh_file import LARGEST_FILE
from harness.robot.mjcf_bounds import refuse_unbounded
from harness.robot.packages import NotFoundError, PackagePath
from harness.spec.xml_file import XmlElement, read_xml

DEEPEST_INCLUDE = 20
MOST_FILES = 200
ASSETS = {"mesh": "meshdir", "texture": "texturedir", "hfield": "meshdir", "skin": "meshdir"}
TEXTURE_SIDES = ("file", "fileright", "fileup", "fileleft", "filedown", "filefront", "fileback")


def read_tree(path: Path, packages: PackagePath) -> list[XmlElement]:
    """The root elements of a file and of what it includes, each once, the file's own first.

    Raises:
        SpecError: A file cannot be read, includes itself, is no MJCF, or names a file that is not
            there or outside the folders that may be read, or asks for more memory than a robot
            needs; at line and column.
    """
    roots: list[XmlElement] = []
    _include(path, packages, (), roots)
    top = roots[0]
    if top.tag != "mujoco":
        top.refuse(f"the root element is <{top.tag}>, an MJCF's is <mujoco>")
    refuse_unbounded(roots)
    folders = _folders(roots, path.parent)
    for root in roots:
        for item in root.walk():
            if item.tag in ASSETS:
                for key in TEXTURE_SIDES:
                    if item.get(key):
                        folder = folders[ASSETS[item.tag]]
                        _check(item, key, folder, packages)
    return roots


def _include(
    path: Path, packages: PackagePath, above: tuple[Path, ...], roots: list[XmlElement]
) -> None:
    """A file's root element, and those of what it includes, added to `roots`."""
    root = read_xml(path)
    roots.append(root)
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
        if len(roots) >= MOST_FILES:
            item.refuse(f"more than {MOST_FILES} files are included", at="file")
        _include(inside, packages, files, roots)


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
        path = packages.file(item.get(key), folder)
    except NotFoundError as error:
        item.refuse(f"{item.tag} {error}", at=key)
    size = path.stat().st_size
    if size > LARGEST_FILE:
        most = LARGEST_FILE / 1e6
        item.refuse(f"{path.name} has {size / 1e6:.0f} MB; at most {most:.0f} MB are read", at=key)
