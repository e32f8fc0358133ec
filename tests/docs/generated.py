"""Files that follow from the code: schemas, reference pages, samples. As a script, writes them."""

from pathlib import Path

from harness.language.expectations_reference import expectations_reference
from harness.language.reference import scenario_reference, steps_reference
from harness.language.schema import schema_text, world_schema_text
from harness.world.sdf.reference import formats_page
from tests.docs.readme_samples import with_samples
from tests.docs.robot_formats import robot_formats_page
from tests.docs.robot_yaml_page import robot_yaml_page

ROOT = Path(__file__).parents[2]
RENEW = "python tests/docs/generated.py"


def generated():
    """Path in the repository -> what its file must hold."""
    return {
        "scenarios/scenario.schema.json": schema_text(),
        "scenarios/world.schema.json": world_schema_text(),
        "scenarios/SCENARIO.md": scenario_reference(),
        "scenarios/STEPS.md": steps_reference(),
        "scenarios/EXPECTATIONS.md": expectations_reference(),
        "worlds/FORMATS.md": formats_page(),
        "robots/FORMATS.md": robot_formats_page(),
        "robots/ROBOT_YAML.md": robot_yaml_page(),
        "README.md": with_samples((ROOT / "README.md").read_text(encoding="utf-8")),
    }


if __name__ == "__main__":
    for name, text in generated().items():
        (ROOT / name).write_text(text, encoding="utf-8")
