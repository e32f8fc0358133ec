"""A folder with everything that a repository of scenarios needs."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Callable
from importlib.metadata import Distribution
from pathlib import Path

from harness.cli.files import refusing_unwritable
from harness.core.extras import DISTRIBUTION
from harness.core.resources import data_folder
from harness.suite.discovery import UsageError

TEMPLATES = Path(__file__).parent / "templates" / "project"
SCHEMA = "scenario.schema.json"
SCENARIO = Path("scenarios/first.scenario.yaml")
PACKAGE = f"{DISTRIBUTION}[meshes]"
"""What a project installs: the arms that people bring have mesh files."""
PLACES = {
    "readme.md": "README.md",
    "pytest.ini": "pytest.ini",
    "margins.json": "margins.json",
    "gitignore": ".gitignore",
    "github.yml": ".github/workflows/scenarios.yml",
    "gitlab.yml": ".gitlab-ci.yml",
}
"""Where each template is in a project."""


def write_project(folder: Path, write_scenario: Callable[[Path], None]) -> None:
    """Write a project whole, or nothing.

    Args:
        folder: The path of the new folder.
        write_scenario: Writes the first scenario to a path.

    Raises:
        UsageError: The folder exists, or cannot be written.
    """
    if folder.exists():
        raise UsageError(f"'{folder}' exists already; name a folder that does not, which is made")
    with refusing_unwritable():
        folder.parent.mkdir(parents=True, exist_ok=True)
        part = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    try:
        with refusing_unwritable():
            part.chmod(0o755)
            for template, place in PLACES.items():
                _copy(TEMPLATES / template, part / place)
            _copy(data_folder("scenarios") / SCHEMA, part / SCHEMA)
            (part / "requirements.txt").write_text(requirement_lines(), encoding="utf-8")
            (part / SCENARIO).parent.mkdir()
        write_scenario(part / SCENARIO)
        with refusing_unwritable():
            part.rename(folder)
    finally:
        shutil.rmtree(part, ignore_errors=True)


def files_outside(folder: Path) -> list[str]:
    """The robot's files that are not in the project, as the first scenario names them."""
    from harness.language.reading.load import load_scenario  # not for `harness --help`

    robot = load_scenario(folder / SCENARIO).scenario.robot
    if robot is None:
        return []
    files = (robot.model, robot.urdf, robot.xacro, robot.mjcf, robot.sdf, robot.srdf, robot.gripper)
    named = [name for name in (*files, *robot.packages) if name]
    places = [(folder / SCENARIO).parent / name for name in named]
    return [
        name
        for name, place in zip(named, places, strict=True)
        if place.exists() and not place.resolve().is_relative_to(folder.resolve())
    ]


def requirement_lines() -> str:
    """The requirements file of a project: where this program was installed from."""
    extra = "# `meshes` reads mesh files of robots and objects; leave it out if there are none.\n"
    stated = Distribution.from_name(DISTRIBUTION).read_text("direct_url.json")
    origin = json.loads(stated) if stated else {}
    address = str(origin.get("url", ""))
    if "vcs_info" in origin:
        commit = origin["vcs_info"]["commit_id"]
        return f"{extra}{PACKAGE} @ {origin['vcs_info']['vcs']}+{address}@{commit}\n"
    hint = (
        f"# {DISTRIBUTION} is on no package index. Other machines need its repository's address,\n"
        f"# {PACKAGE} @ git+https://HOST/OWNER/{DISTRIBUTION}@REF, or of a wheel.\n"
    )
    return f"{hint}{extra}{PACKAGE}{f' @ {address}' if address else ''}\n"


def _copy(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, target)
