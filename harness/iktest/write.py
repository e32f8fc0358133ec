"""The report folder of a test: its numbers, and a picture of every example."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.iktest.report import IkFinding, IkReport
from harness.reporting.json_text import json_text
from harness.robot.chain import Chain
from harness.suite.discovery import UsageError

FILE = "ik_test.json"


def write_ik_report(report: IkReport, chain: Chain, folder: Path) -> IkReport:
    """Write a report; findings of an earlier one in the folder are replaced.

    Returns:
        The report, its findings with the names of their pictures.

    Raises:
        UsageError: The folder cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for old in folder.glob("finding-*.jpg"):
            old.unlink()
    except OSError as error:
        raise UsageError(f"cannot write '{error.filename}': {error.strerror}") from error
    findings = tuple(_with_picture(finding, chain, folder) for finding in report.findings)
    report = replace(report, findings=findings)
    (folder / FILE).write_text(json_text(report.facts()), encoding="utf-8")
    return report


def _with_picture(finding: IkFinding, chain: Chain, folder: Path) -> IkFinding:
    """Draw the arm where its answer puts it, translucent where the target is reached."""
    from harness.cameras.ik_comparison_picture import draw_ik_comparison

    target, answer = finding.target, finding.answer
    reached = answer if answer is not None and np.all(np.isfinite(answer)) else None
    if target.joint_positions is None and reached is None:
        reached = chain.home
    name = f"finding-{finding.number}-{finding.property}.jpg"
    draw_ik_comparison(
        chain.description,
        chain.link,
        target.pose,
        None if target.joint_positions is None else chain.whole(target.joint_positions),
        None if reached is None else chain.whole(reached),
        folder / name,
        f"{finding.kind}: {finding.detail}" if finding.detail else finding.kind,
    )
    return replace(finding, picture=name)
