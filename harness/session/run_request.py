"""What is requested of one run of a scenario."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from harness.core.errors import Problem, SpecError
from harness.core.limits import LONGEST_RUN
from harness.core.options import option
from harness.language.files.source import Source


class Draw(Protocol):
    """The values of a random sample.

    Attributes:
        overrides: Dotted path in the file -> new value, as YAML text.
        values: What varies, for tables: path -> value.
    """

    @property
    def overrides(self) -> Mapping[str, str]: ...

    @property
    def values(self) -> Mapping[str, Any]: ...


STRICT = "fail where a verdict has a warning, such as `already true at the start`"


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """What a command requests alike of each of its cases, besides what it writes.

    Attributes:
        nodes: Commands by name that steps may start as ROS 2 nodes.
    """

    nodes: Mapping[str, str] = field(default_factory=dict[str, str])
    strict: bool = option("--strict", default=False, text=STRICT)
    reporters: tuple[str, ...] = option(
        "--reporter",
        metavar="NAME",
        default=(),
        text="let a reporter of `harness list reporters` write into the report too; repeatable",
    )


@dataclass(frozen=True)
class RunRequest(RunOptions):
    """One case of a scenario file, how it is run and what is written of it.

    Attributes:
        overrides: Dotted path in the file -> new value, as YAML text.
        seed: Seed that replaces the file's seed.
        report_dir: Folder of the report; None writes no report.
        stills: Whether the report gets a picture of every step.
        case: Name of the case; empty when the file has one case.
        only_failed: Whether a report is written only where the case does not pass.
        text: Content that is read in place of the file's; None reads the file.
        source: Takes the place of both and names the file of each line; relative paths begin at
            `file` nevertheless.
        redraw: Gives the sample of a further draw, from 1, while objects overlap at the start;
            None draws it once.
        live: The Unix socket to which the case sends its poses while it runs; empty sends none.
        longest: The most simulated time of the run [s]; a step that would exceed it fails.
        options: Words of a command that runs it again, besides file and case, as `--seed`, `7`.
    """

    file: Path
    overrides: Mapping[str, str] = field(default_factory=dict[str, str])
    seed: int | None = None
    report_dir: Path | None = None
    stills: bool = True
    page: bool = True
    bag: bool = False
    case: str = ""
    only_failed: bool = False
    text: str | None = None
    source: Source | None = None
    redraw: Callable[[int], Draw] | None = None
    live: str = ""
    longest: float = LONGEST_RUN
    options: tuple[str, ...] = ()

    @property
    def shown_file(self) -> str:
        """The file that reports and messages name."""
        return str(self.file) if self.source is None else self.source.path


def named_commands(given: Iterable[str]) -> dict[str, str]:
    """Commands by name, from `NAME=COMMAND` or `COMMAND`.

    Raises:
        SpecError: A command is empty, or two have the same name.
    """
    commands: dict[str, str] = {}
    for text in given:
        name, equals, command = text.partition("=")
        if not (equals and name.isidentifier()):
            name, command = "node", text
        reason = "" if command.strip() else "it has no command"
        if name in commands:
            reason = f"two commands are called '{name}'; write NAME=COMMAND"
        if reason:
            raise SpecError([Problem(f"the node '{text}'", 0, 0, reason)])
        commands[name] = command
    return commands
