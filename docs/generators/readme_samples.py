"""The samples of terminal output that README shows, made by running what they show."""

import contextlib
import io
import re
import tempfile
from functools import cache
from pathlib import Path

from harness.cli.main import main

TYPO = """scenario: x
robot: {model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 1.02]}}
world: lesson_ur
steps:
  - move_to: mogi_hom
  - grip: open
expect:
  - lifted: {object: green_cylinder, above: 5 kg}
"""
"""A file with a misspelt state, a verb that does not exist and a wrong unit."""

CHECK = "$ harness check typo.scenario.yaml\n"


@cache
def refusal() -> str:
    """What `harness check` prints about a file with three mistakes."""
    printed = io.StringIO()
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        Path("typo.scenario.yaml").write_text(TYPO, encoding="utf-8")
        with contextlib.redirect_stdout(printed):
            main(["check", "typo.scenario.yaml"])
    return printed.getvalue()


def with_samples(readme: str) -> str:
    """The text of README with every sample as the program prints it now."""
    block = re.compile(rf"(?ms)^```text\n{re.escape(CHECK)}.*?^```$")
    return block.sub(lambda _: f"```text\n{CHECK}{refusal()}```", readme)
