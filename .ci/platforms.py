"""Says while the package is installed on which platforms it cannot be: pip names a wheel alone."""

from __future__ import annotations

import os
import platform
import sys
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

ANYWHERE = "ARMHARNESS_ANY_PLATFORM"
WITH_WHEELS = (("linux", "x86_64"), ("linux", "aarch64"), ("darwin", "arm64"))


def refusal(system: str, machine: str, c_library: str) -> str:
    """Why the required packages cannot be installed, and what to do; empty where they can.

    Args:
        system: The name that `sys.platform` gives.
        machine: The processor that `platform.machine` gives.
        c_library: The name that `platform.libc_ver` gives; empty where it is not glibc.
    """
    if (system, machine) in WITH_WHEELS and (system != "linux" or c_library == "glibc"):
        return ""
    where, advice = (
        f"{system} on {machine}",
        "use Linux on x86_64 or aarch64, or a Mac with Apple silicon",
    )
    if system == "win32":
        where, advice = (
            "Windows",
            "install WSL 2 with `wsl --install`, and repeat this command in its Ubuntu",
        )
    elif system == "darwin":
        where, advice = (
            "Macs with Intel processors",
            "open the folder in its development container (.devcontainer)",
        )
    elif (system, machine) in WITH_WHEELS:
        where, advice = (
            "Linux without glibc",
            "use an image with glibc, python:3.12-slim in place of python:3.12-alpine",
        )
    return (
        "armharness cannot be installed here: OMPL and Pinocchio, which it requires, have no wheels"
        f" for {where}. What you can do: {advice}. Who has both from elsewhere sets {ANYWHERE}=1"
        " and adds --no-deps."
    )


class RefuseOtherPlatforms(MetadataHookInterface):
    """Ends an installation before pip looks for the required packages."""

    def update(self, metadata: dict[str, Any]) -> None:  # noqa: ARG002
        """Change nothing; the metadata is where an installation begins."""
        said = refusal(sys.platform, platform.machine(), platform.libc_ver()[0])
        if said and not os.environ.get(ANYWHERE):
            raise SystemExit(said)
