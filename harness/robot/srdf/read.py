"""Reads an SRDF from its file, which may be xacro."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from harness.language.files.xml_file import parse_xml
from harness.robot.packages import PackagePath
from harness.robot.robot_format import render_xacro
from harness.robot.srdf.srdf import Srdf, parse_srdf
from harness.robot.xacro_file import is_xacro


def read_srdf(
    path: Path, text: str | bytes, args: Mapping[str, Any], packages: PackagePath
) -> Srdf:
    """The SRDF of a file; xacro is rendered with the arguments that the file declares.

    Args:
        args: Arguments of the scenario's `robot:` for xacro.
        packages: Search path for `$(find ...)`, and the folders that may be read.

    Raises:
        SpecError: It cannot be rendered, or is not an SRDF; at line and column.
    """
    root = parse_xml(text, str(path))
    if not is_xacro(root):
        return parse_srdf(text, str(path))
    srdf = parse_srdf(render_xacro(path, args, packages), str(path))
    macros = [item.get("name") for item in root.walk() if item.tag == "xacro:macro"]
    if srdf.groups or not macros:
        return srdf
    note = f"SRDF: {path.name} defines {', '.join(macros)}; the file that calls the macro is needed"
    return replace(srdf, notes=(*srdf.notes, note))
