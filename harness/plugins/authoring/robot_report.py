"""What a check of a robot found, and the page that shows it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from harness.core.printable import counted
from harness.reporting.terminal import Style
from harness.robot.mechanism import Joint


@dataclass(frozen=True)
class GroupLine:
    """A planning group.

    Attributes:
        joints: Its active joints, base to tip.
        span: The first and the last link; empty for groups of joints.
    """

    name: str
    joints: tuple[str, ...]
    span: str
    states: tuple[str, ...]


@dataclass(frozen=True)
class RobotFinding:
    """The result of one check.

    Attributes:
        about: `forward kinematics`, `masses`, ...
        is_good: Whether a person need do nothing.
        details: The lines below it.
        values: Its numbers, for machines.
    """

    about: str
    text: str
    is_good: bool = True
    details: tuple[str, ...] = ()
    values: Mapping[str, object] = field(default_factory=dict[str, object])


@dataclass(frozen=True)
class ArmLine:
    """One of several arms, its TCP, and its gripper in one line; empty when it has none."""

    name: str
    tcp_link: str
    gripper: str


@dataclass(frozen=True)
class RobotReport:
    """Everything a check of a robot found.

    Attributes:
        source: The file or name that was given.
        joints: Movable joints, mimic ones included.
        followers: What mimic joints follow, by joint: `finger_left times -1`.
        effort_sources: Where effort limits are from, each once.
        arm_group: The one that motions are of by default.
        tcp_link: The link whose pose is the TCP.
        gripper: The gripper in one line; empty when there is none.
        notes: What of the robot's files was left out or assumed.
        arms: The arms of a robot that has several.
        proposal: Pairs that need not be checked, by reason; where no file says which.
    """

    name: str
    source: str
    joints: tuple[Joint, ...]
    followers: Mapping[str, str]
    effort_sources: tuple[str, ...]
    groups: tuple[GroupLine, ...]
    arm_group: str
    tcp_link: str
    gripper: str
    findings: tuple[RobotFinding, ...]
    arms: tuple[ArmLine, ...] = ()
    notes: tuple[str, ...] = ()
    proposal: Mapping[str, tuple[tuple[str, str], ...]] = field(
        default_factory=dict[str, tuple[tuple[str, str], ...]]
    )

    @property
    def is_good(self) -> bool:
        """Whether nothing is wrong."""
        return all(finding.is_good for finding in self.findings)


def page(report: RobotReport, style: Style) -> list[str]:
    """The report as lines of text."""
    lines = [style.strong(report.name), ""]
    lines += _joints(report, style)
    lines += _groups(report, style)
    lines += ["", style.strong("checks")]
    for finding in report.findings:
        lines.append(f"  {style.mark(finding.is_good)} {finding.about}: {finding.text}")
        lines += [f"      {detail}" for detail in finding.details]
    if report.proposal:
        lines += ["", style.strong("pairs that need not be checked, proposed")]
        lines += _proposal(report.proposal)
    if report.notes:
        lines += ["", style.strong("left out or assumed")]
        lines += [f"  {note}" for note in report.notes]
    return lines


def _joints(report: RobotReport, style: Style) -> Iterator[str]:
    head = ("joint", "kind", "from", "to", "velocity", "acceleration", "effort")
    rows = [
        (
            joint.name,
            joint.kind,
            _number(joint.lower),
            _number(joint.upper),
            _number(joint.velocity),
            _number(joint.acceleration),
            report.followers.get(joint.name) or _number(joint.effort),
        )
        for joint in report.joints
    ]
    widths = [max(len(row[column]) for row in (head, *rows)) for column in range(len(head))]
    for number, row in enumerate((head, *rows)):
        cells = [
            text.ljust(width) if column < 2 or text.startswith("follows") else text.rjust(width)
            for column, (text, width) in enumerate(zip(row, widths, strict=True))
        ]
        line = "  ".join(cells).rstrip()
        yield style.strong(line) if number == 0 else line
    yield "rad, rad/s, rad/s^2, N m; prismatic: m, m/s, m/s^2, N"
    for source in report.effort_sources:
        yield f"efforts: {source}"


def _groups(report: RobotReport, style: Style) -> Iterator[str]:
    yield ""
    yield style.strong("groups")
    for group in report.groups:
        span = f", {group.span}" if group.span else ""
        arm = " (the arm)" if group.name == report.arm_group else ""
        yield f"  {group.name}{arm}: {counted(len(group.joints), 'joint')}{span}"
        yield f"      states: {', '.join(group.states) or 'none'}"
    for arm in report.arms or (ArmLine("", report.tcp_link, report.gripper),):
        begin = f"  {arm.name}, " if arm.name else "  "
        yield f"{begin}TCP: {arm.tcp_link or 'none'}"
        yield f"{begin}gripper: {arm.gripper or 'none'}"


def _proposal(proposal: Mapping[str, tuple[tuple[str, str], ...]]) -> Iterator[str]:
    for reason, pairs in proposal.items():
        named = [f"{first} - {second}" for first, second in pairs]
        shown = ", ".join(named[:4])
        more = f", and {len(named) - 4} more" if len(named) > 4 else ""
        yield f"  {reason.lower()}: {len(named)}: {shown}{more}"


def _number(value: float) -> str:
    return f"{value:.4g}" if math.isfinite(value) else "none"
