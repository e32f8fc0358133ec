"""A report as lines for people."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from harness.core.printable import counted
from harness.core.types import FloatArray
from harness.plugins.iktest.report import IkFinding, IkReport, PropertyResult, Speed

NAME_WIDTH = 13


def report_lines(report: IkReport, folder: Path = Path()) -> list[str]:
    """What was tried, and what was found; pictures are in the folder."""
    lines = [
        f"{report.solver} on {report.robot}: {report.task} of {report.link}, "
        f"{len(report.joint_names)} joints, seed {report.seed}"
    ]
    outcomes = [_outcome(each) for each in report.properties]
    width = max(map(len, outcomes), default=0)
    for each, outcome in zip(report.properties, outcomes, strict=True):
        says = "" if each.note else f"   {each.says}"
        lines.append(f"  {each.name:<{NAME_WIDTH}}{outcome:<{width}}{says}")
    lines.append(f"  {'speed':<{NAME_WIDTH}}{_speed_text(report.speed)}")
    for finding in report.findings:
        lines += ["", *finding_lines(report, finding, folder)]
    count = len(report.findings)
    count_text = counted(count, "finding") if count else "nothing found"
    return [*lines, "", f"{count_text} in {report.seconds:.1f} s"]


def _outcome(result: PropertyResult) -> str:
    """The outcome of a property in one column."""
    if result.note:
        return result.note
    if result.flawed:
        noun = "finding" if len(result.findings) == 1 else "findings"
        numbers = ", ".join(map(str, result.findings))
        return f"FAILED in {result.flawed} of {result.tried}: {noun} {numbers}"
    if not result.observed:
        return f"NOT OBSERVED, {result.tried} tried"
    if result.observed < result.tried:
        return f"ok, {result.observed} of {result.tried} observed"
    return f"ok, {result.tried} tried"


def finding_lines(report: IkReport, finding: IkFinding, folder: Path = Path()) -> list[str]:
    """A finding with its smallest example."""
    name = report.solver.rpartition(":")[2]
    lines = [f"{finding.number}. {finding.property}: {name} {finding.kind} "
             f"({finding.shown} of {finding.tried}). The smallest:"]  # fmt: skip
    rows = [("call", finding.call)]
    way = finding.target.joint_positions
    if way is not None:
        rows.append(("reached by", positions_text(report.joint_names, way, report.home)))
    if finding.answer is not None:
        rows.append(("answer", positions_text(report.joint_names, finding.answer, None)))
    if finding.reached is not None and np.all(np.isfinite(finding.reached)):
        x, y, z = (float(f"{value:.6g}") + 0.0 for value in finding.reached[:3])
        rows.append(("which is at", f"x={x}, y={y}, z={z}"))
    if finding.detail:
        rows.append(("so", finding.detail))
    if finding.picture:
        rows.append(("picture", str(folder / finding.picture)))
    return [*lines, *(f"     {word:<12}{text}" for word, text in rows)]


def positions_text(names: tuple[str, ...], positions: FloatArray, home: FloatArray | None) -> str:
    """Joint positions by name; against home, only what differs from it."""
    pairs = [(name, float(f"{value:.5g}") + 0.0)
             for name, value in zip(names, positions, strict=True)]  # fmt: skip
    if home is None:
        return ", ".join(f"{name} {value:g}" for name, value in pairs)
    moved = np.abs(positions - home) > 1e-12
    offsets = ", ".join(
        f"{name} {value:g}" for (name, value), is_off in zip(pairs, moved, strict=True) if is_off
    )
    return f"home, but {offsets}" if offsets else "home"


def _speed_text(speed: Speed | None) -> str:
    if speed is None:
        return "no answer to time"
    return (
        f"{_time(speed.median)} median, {_time(speed.slow)} in 95 %, {_time(speed.slowest)} at "
        f"most ({speed.calls} calls, wall time)"
    )


def _time(seconds: float) -> str:
    return f"{1e6 * seconds:.0f} us" if seconds < 1e-3 else f"{1e3 * seconds:.3g} ms"
