"""The samples of terminal output that pages show, made by running what they show."""

from __future__ import annotations

import contextlib
import io
import re
import tempfile
from functools import cache
from pathlib import Path

from docs import ROOT
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
SCENARIO = "scenarios/lessons/04_ur_pick_by_friction.scenario.yaml"
CHECK = "$ harness check typo.scenario.yaml\n"
RUN = f"$ harness run {SCENARIO} --set params.lift=0.05\n"


@cache
def refusal() -> str:
    """What `harness check` prints about a file with three mistakes."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "typo.scenario.yaml").write_text(TYPO, encoding="utf-8")
        return _printed(Path(folder), CHECK)


@cache
def failure() -> str:
    """What `harness run` prints about an expectation that fails, without the times it took.

    Measured values have three digits: further ones differ between processors.
    """
    printed = _printed(ROOT, RUN, "--no-report")
    printed = printed[printed.index("FAILED") : printed.index("\n1 failed")]
    return re.sub(r"\d+\.\d+(?= [mN] )", lambda value: f"{float(value[0]):.3g}", printed)


def with_samples(page: str) -> str:
    """The text of a page with every sample as the program prints it now."""
    for command, sample in ((CHECK, refusal), (RUN, failure)):
        block = re.compile(rf"(?ms)^```text\n{re.escape(command)}.*?^```$")
        if block.search(page):
            text = f"```text\n{command}{sample()}```"
            page = block.sub(lambda _, text=text: text, page)
    content = (ROOT / SCENARIO).read_text(encoding="utf-8")
    first, _, _ = content.partition("\n")
    shown = re.compile(rf"(?ms)(?<=^```yaml\n){re.escape(first)}\n.*?(?=^```$)")
    return shown.sub(lambda _: content, page)


def _printed(folder: Path, command: str, *options: str) -> str:
    """What a command prints into a pipe, run in a folder."""
    printed = io.StringIO()
    with contextlib.chdir(folder), contextlib.redirect_stdout(printed):
        main([*command.split()[2:], *options])
    return printed.getvalue()
