"""The page of naive against our verdicts, from real runs. Run as a script, it renews the page."""

import re
import sys
import tempfile
from pathlib import Path

from harness.recording.store import read_run
from tests.adversarial.scenes import SCENES, WEIGHTLESS
from tests.running import run_case

PAGE = Path(__file__).parents[2] / "docs/reference/verdicts.md"
RENEW = "python -m tests.adversarial.table"
HEAD = """# Verdicts that cannot lie

The test suite runs each of these scenes in the physics (`tests/adversarial`). The naive check is
common in success functions, and it passes in every scene; the expectation, judged from the same
recording, does not. The last column lists expectations that hold in the same run, so that no scene
is simply rejected as a whole. `python -m tests.adversarial.table` writes this page from the runs.

| scene | naive check: passes | expectation: does not pass | holds |
| --- | --- | --- | --- |
"""
CORRUPTED = """
Recordings can be wrong as well. `tests/assertions/test_mutations.py` traces the signals that each
predicate reads; it shifts, freezes and drops each of them and fills it with NaN. No corrupted
recording may pass (`pytest -m mutation`).
"""


def run_scene(scene, folder):
    """The case's result and its recorded run."""
    (folder / "weightless.yaml").write_text(WEIGHTLESS)
    path = folder / "scene.scenario.yaml"
    path.write_text(scene.scenario("weightless.yaml"))
    result = run_case(path, report_dir=folder / "report", stills=False)
    assert result.outcome == "failed", (result.outcome, result.problems, result.message)
    return result, read_run(folder / "report").run


def row_of(scene, result):
    """A scene's line of the table."""
    refuted, kept = result.verdicts[: len(scene.expect)], result.verdicts[len(scene.expect) :]
    ours = "<br>".join(f"`{v.expectation}`: {v.status}: {v.reason}" for v in refuted)
    holds = "<br>".join(f"`{verdict.expectation}`" for verdict in kept)
    return f"| **{scene.title}**: {scene.happens} | {scene.naive} | {ours} | {holds} |"


def without_numbers(text):
    """A page without its numbers: they may differ in the last place from machine to machine."""
    return re.sub(r"-?\d+(\.\d+)?", "#", text)


def page(rows):
    """The whole page."""
    return HEAD + "\n".join(rows) + "\n" + CORRUPTED


def main():
    """Run every scene and write the page."""
    rows = []
    for scene in SCENES:
        with tempfile.TemporaryDirectory() as folder:
            result, _ = run_scene(scene, Path(folder))
        rows.append(row_of(scene, result))
    PAGE.write_text(page(rows), encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
