"""The files that follow from the code: schemas, reference pages, samples, pictures of the floors.

Run as a script, it writes them; arguments name some of them.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import partial

from docs import ROOT
from docs.generators.expectations import expectations_reference
from docs.generators.floors import floors_picture
from docs.generators.readme_samples import with_samples
from docs.generators.reference import scenario_reference, steps_reference
from docs.generators.reliability import reliability_page
from docs.generators.robot_formats import robot_formats_page
from docs.generators.robot_yaml import robot_yaml_page
from docs.generators.world_formats import formats_page
from harness.plugins.authoring.scenario_schema import schema_text, world_schema_text

RENEW = "python -m docs.generate"


def _with_samples(name: str) -> str:
    return with_samples((ROOT / name).read_text(encoding="utf-8"))


GENERATED: dict[str, Callable[[], str]] = {
    "scenarios/scenario.schema.json": schema_text,
    "scenarios/world.schema.json": world_schema_text,
    "docs/reference/scenario.md": scenario_reference,
    "docs/reference/steps.md": steps_reference,
    "docs/reference/expectations.md": expectations_reference,
    "docs/reference/world_formats.md": formats_page,
    "docs/reference/robot_formats.md": robot_formats_page,
    "docs/reference/robot_yaml.md": robot_yaml_page,
    "docs/explanation/reliability.md": reliability_page,
    "docs/pictures/floors.svg": partial(floors_picture, "harness"),
    "docs/pictures/planning_floors.svg": partial(floors_picture, "harness.planning"),
    "docs/reference/commands.md": partial(_with_samples, "docs/reference/commands.md"),
    "README.md": partial(_with_samples, "README.md"),
}
"""What writes the text of each generated file, by the file's path in the repository."""


def main(names: list[str]) -> None:
    """Write these files, or all."""
    for name in names or GENERATED:
        (ROOT / name).write_text(GENERATED[name](), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
