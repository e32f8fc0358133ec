"""Files that follow from the code: schemas, reference pages, samples. As a script, writes them."""

from docs import ROOT
from docs.generators.expectations import expectations_reference
from docs.generators.readme_samples import with_samples
from docs.generators.reference import scenario_reference, steps_reference
from docs.generators.robot_formats import robot_formats_page
from docs.generators.world_formats import formats_page
from harness.language.schema import schema_text, world_schema_text

RENEW = "python -m docs.generate"


def generated() -> dict[str, str]:
    """The text that each generated file must have, by its path in the repository."""
    return {
        "scenarios/scenario.schema.json": schema_text(),
        "scenarios/world.schema.json": world_schema_text(),
        "docs/reference/scenario.md": scenario_reference(),
        "docs/reference/steps.md": steps_reference(),
        "docs/reference/expectations.md": expectations_reference(),
        "docs/reference/world_formats.md": formats_page(),
        "docs/reference/robot_formats.md": robot_formats_page(),
        "README.md": with_samples((ROOT / "README.md").read_text(encoding="utf-8")),
    }


if __name__ == "__main__":
    for name, text in generated().items():
        (ROOT / name).write_text(text, encoding="utf-8")
