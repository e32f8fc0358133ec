"""Exceptions that the program raises.

HarnessError
├── SpecError          a file has mistakes (exit code 2)
├── RobotError         a robot's or world's files cannot be used (exit code 2)
│   └── RobotOptionError with the key of the scenario's `robot` that does not fit
├── ModelRefused       the physics cannot be built from a robot and a world (exit code 2)
├── StepFailed         a step cannot be carried out; ends the run, named by a MoveIt error code
│   └── PlanningFailed with the planner's explanation
└── SimulationDiverged the physics produced numbers that are not finite (exit code 3)
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

from harness.core.details import Detail, Details
from harness.core.printable import columns_of, printable

Item = TypeVar("Item")
Found = TypeVar("Found")

ErrorCode = Literal[
    "PLANNING_FAILED",
    "INVALID_MOTION_PLAN",
    "MOTION_PLAN_INVALIDATED_BY_ENVIRONMENT_CHANGE",
    "CONTROL_FAILED",
    "UNABLE_TO_AQUIRE_SENSOR_DATA",
    "TIMED_OUT",
    "PREEMPTED",
    "START_STATE_IN_COLLISION",
    "START_STATE_VIOLATES_PATH_CONSTRAINTS",
    "START_STATE_INVALID",
    "GOAL_IN_COLLISION",
    "GOAL_VIOLATES_PATH_CONSTRAINTS",
    "GOAL_CONSTRAINTS_VIOLATED",
    "GOAL_STATE_INVALID",
    "UNRECOGNIZED_GOAL_TYPE",
    "INVALID_GROUP_NAME",
    "INVALID_GOAL_CONSTRAINTS",
    "INVALID_ROBOT_STATE",
    "INVALID_LINK_NAME",
    "INVALID_OBJECT_NAME",
    "FRAME_TRANSFORM_FAILURE",
    "COLLISION_CHECKING_UNAVAILABLE",
    "ROBOT_STATE_STALE",
    "SENSOR_INFO_STALE",
    "COMMUNICATION_FAILURE",
    "CRASH",
    "ABORT",
    "NO_IK_SOLUTION",
    "FAILURE",
]
"""Names of moveit_msgs/MoveItErrorCodes, spelled as there (UNABLE_TO_AQUIRE_SENSOR_DATA too)."""


EXCERPT_WIDTH = 70  # characters of a source line, and of a hint: with margins, 80 columns
TAB = "    "  # replaces a tab in a source line


class HarnessError(Exception):
    """Base class of the program's exceptions."""


@dataclass(frozen=True)
class Problem:
    """One located mistake in a file.

    Attributes:
        path: The file, as the user named it.
        line: Line number from 1; 0 when the problem concerns the whole file.
        column: Column from 1 of the value, or of the key when the key itself is wrong.
        message: The mistake in a roboticist's words, with the offending value.
        hint: Advice: the nearest valid value, then all others. May be empty.
        source_line: Text of the line, for the excerpt; empty when there is none.
        length: Number of characters that the caret underlines.
    """

    path: str
    line: int
    column: int
    message: str
    hint: str = ""
    source_line: str = ""
    length: int = 1

    @property
    def sentence(self) -> str:
        """The mistake and the advice."""
        return f"{self.message}: {self.hint}" if self.hint else self.message

    def __str__(self) -> str:
        place = f"{self.path}:{self.line}:{self.column}" if self.line else self.path
        text = printable(f"{place}: {self.message}")
        if not self.source_line:
            return f"{text}\n  {printable(self.hint)}" if self.hint else text
        return "\n".join([text, *self._excerpt()])

    def _excerpt(self) -> list[str]:
        """The source line with a caret under the place, and the hint, wrapped."""
        start, line = 0, self.source_line
        if len(line) > EXCERPT_WIDTH:
            start = max(0, self.column - 1 - EXCERPT_WIDTH // 2)
            line = line[start : start + EXCERPT_WIDTH]
        before, rest = line[: self.column - 1 - start], line[self.column - 1 - start :]
        under, hint = rest[: self.length], printable(self.hint)
        caret = f"{' ' * _width(before)}{'^' * max(1, _width(under))}"
        annotation = f"{caret} {hint}".rstrip()
        margin = f"{'':>5} | "
        if len(annotation) <= EXCERPT_WIDTH:
            below = [annotation]
        else:
            lines = textwrap.wrap(
                hint, EXCERPT_WIDTH, break_long_words=False, break_on_hyphens=False
            )
            below = [caret, *lines]
        return [f"{self.line:>5} | {_shown(line)}", *(margin + each for each in below)]


def _shown(source: str) -> str:
    return printable(source.replace("\t", TAB))


def _width(source: str) -> int:
    """Columns of a part of a source line as it is shown."""
    return columns_of(_shown(source))


class SpecError(HarnessError):
    """A file has mistakes; `problems` holds all of them, in file order."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = sorted(
            problems, key=lambda problem: (problem.path, problem.line, problem.column)
        )
        super().__init__("\n".join(map(str, self.problems)))


def collected(
    read: Callable[[Item], Found], items: Iterable[Item], kind: type[SpecError] = SpecError
) -> list[Found]:
    """What is read from each item.

    Raises:
        SpecError: Items have mistakes: those of all items together if they are of the kind, else
            the first. Of a place that several items have, as in a macro, there is one.
    """
    found: list[Found] = []
    problems: dict[tuple[str, int, int], Problem] = {}
    for item in items:
        try:
            found.append(read(item))
        except kind as error:
            for each in error.problems:
                problems.setdefault((each.path, each.line, each.column), each)
    if problems:
        raise kind(problems.values())
    return found


class RobotError(HarnessError):
    """A robot's description, or a file it names, cannot be used."""


class MissingPackage(RobotError):
    """A mesh file needs a package that is not installed; the message has the command for it."""


class RobotOptionError(RobotError):
    """A key of a scenario's `robot` does not fit the robot, or names what does not exist.

    Attributes:
        key: Dotted path below `robot`, such as `joint_limits.wrist_1_joint.max_velocity`; below
            `robots` it begins with the name of an arm.
        reason: Why the value cannot be used.
        below: The key of the scenario that has it, `robot` or `robots`.
    """

    def __init__(self, key: str, reason: str, below: str = "robot") -> None:
        self.key, self.reason, self.below = key, reason, below
        super().__init__(f"{below}.{key}: {reason}")


class ModelRefused(HarnessError):
    """The physics cannot be built.

    Attributes:
        body: Name of the link or object that causes the failure; empty when it is unknown.
        reason: Why the model is refused.
    """

    def __init__(self, body: str, reason: str) -> None:
        self.body, self.reason = body, reason
        super().__init__(f"{body}: {reason}" if body else reason)


class StepFailed(HarnessError):
    """A step could not be carried out.

    Attributes:
        code: Name of the failure in moveit_msgs/MoveItErrorCodes.
        details: Typed records that explain the failure.
    """

    def __init__(self, code: ErrorCode, message: str, *details: Detail) -> None:
        self.code: ErrorCode = code
        self.message = message
        self.details = Details(details)
        super().__init__(code, message, *details)  # so that it can be pickled

    def __str__(self) -> str:
        return f"{self.code}: {self.message}"

    @property
    def facts(self) -> dict[str, Any]:
        """The details as plain data for the step's record."""
        return self.details.plain()


class PlanningFailed(StepFailed):
    """The planner found no verified motion; `details` explain why."""


class SimulationDiverged(HarnessError):
    """The physics produced numbers that are not finite."""
