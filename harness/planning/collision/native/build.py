"""Compiles the check of motions while the package is built; run as a script, in the source tree.

The system's C compiler does it, or the one named by the variable CC; where there is none, Zig's
from PyPI, which is a build dependency then.
"""

from __future__ import annotations

import os
import runpy
import shlex
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

FOLDER = Path(__file__).parent
# No fused multiply-add and no instructions of the builder's own processor: the same answers on all.
# Square roots without errno are single instructions, which is 10 to 30 % faster.
FLAGS = ["-std=c11", "-O3", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math"]
SHARED = ["-fPIC", "-shared"]
ZIG = [sys.executable, "-m", "ziglang", "cc", "-mcpu=baseline"]


def system_compiler() -> list[str] | None:
    """The command of the C compiler of this machine, if it has one."""
    if command := shlex.split(os.environ.get("CC", "")):
        return command
    return next(([name] for name in ("cc", "gcc", "clang") if shutil.which(name)), None)


def compile_library() -> Path:
    """Compile the sources and return the library; libraries of other sources are removed.

    It is compiled under a temporary name and renamed: no process loads half of it.

    Raises:
        CalledProcessError: The compiler rejects the sources.
    """
    # The package itself cannot be imported yet: its dependencies are not installed.
    path: Path = runpy.run_path(str(FOLDER / "sources.py"))["library_path"]()
    unfinished = path.with_suffix(f".{os.getpid()}.so")
    sources = [*map(str, sorted(FOLDER.glob("*.c"))), "-o", str(unfinished), "-lm"]
    try:
        subprocess.run([*(system_compiler() or ZIG), *FLAGS, *SHARED, *sources], check=True)
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)
    for old in {*FOLDER.glob("certify-*.so")} - {path}:
        old.unlink(missing_ok=True)
    return path


class NativeCheck(BuildHookInterface[Any]):
    """Adds the compiled check to the wheel, which is for one platform and any Python then."""

    def dependencies(self) -> list[str]:
        """What the build needs in addition to hatchling."""
        return [] if system_compiler() else ["ziglang"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:  # noqa: ARG002
        """Compile before the files of the wheel are collected."""
        if self.target_name != "wheel":
            return
        path = compile_library()
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{platform}"
        build_data["artifacts"].append(path.relative_to(self.root).as_posix())


if __name__ == "__main__":
    sys.stdout.write(f"{compile_library()}\n")
