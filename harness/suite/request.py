"""What is requested of one suite: the options of `harness run`, declared once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from harness.core.options import option
from harness.session.run_request import RunOptions
from harness.suite.hooks import NO_HOOKS, SuiteHooks


@dataclass(frozen=True)
class SuiteSelection(RunOptions):
    """What selects the cases of a suite, and what their results follow from besides files.

    Attributes:
        overrides: Dotted path -> value as YAML; they take precedence over a case's own values.
        seed: Seed that replaces the files' seeds.
    """

    overrides: Mapping[str, str] = field(default_factory=dict[str, str])
    seed: int | None = None
    expression: str = option(
        "-k",
        metavar="EXPR",
        default="",
        text="run only scenarios whose path, title or tags match: 'pick and not ur5e'",
    )
    cases: tuple[str, ...] = option(
        "--case",
        metavar="NAME",
        default=(),
        text="run only the case of this name, or the cases whose names match a pattern: 'ur5e-*'",
    )
    samples: int | None = option(
        "--samples",
        metavar="N",
        default=None,
        text="draw this many samples, instead of the number in the file",
    )

    def words(self) -> list[str]:
        """The options of `harness run` on which the result of a case depends."""
        words = [
            word for path, value in self.overrides.items() for word in ("--set", f"{path}={value}")
        ]
        words += ["--seed", str(self.seed)] if self.seed is not None else []
        words += ["--samples", str(self.samples)] if self.samples is not None else []
        words += [
            word for name, text in self.nodes.items() for word in ("--node", f"{name}={text}")
        ]
        return [*words, *["--strict"] * self.strict]


@dataclass(frozen=True)
class SuiteRequest(SuiteSelection):
    """Which cases a command runs, how, and what it writes.

    Attributes:
        report_root: Folder for the reports; None writes no reports.
        loading: Options that find packages and load plug-ins, as words of the command.
        hard_cap: Wall time that a case may take [s]; None takes the program's own.
    """

    workers: int = option("-j", metavar="N", default=1, text="run N scenarios side by side")
    repeat: int = option(
        "--repeat",
        metavar="N",
        default=1,
        text="run each case N times and report whether all digests are equal",
    )
    keep: str = option(
        "--keep",
        choices=("all", "failed"),
        default="",
        text="write the reports of all cases, or only of those that failed (default: all; of"
        " samples, those that failed)",
    )
    resume: bool = option(
        "--resume",
        default=False,
        text="continue where the same command was interrupted, and keep the results that exist",
    )
    bag: bool = option("--bag", default=False, text="write a rosbag2 into the report too")
    in_process: bool = option(
        "--in-process", default=False, text="run all cases in this process, for a debugger"
    )
    report_root: Path | None = None
    loading: tuple[str, ...] = ()
    page: bool = True
    hard_cap: float | None = None
    hooks: SuiteHooks = NO_HOOKS

    @property
    def is_part(self) -> bool:
        """Whether the command runs one part of a suite, whose rates are decided after a merge."""
        return self.hooks.part is not None

    @property
    def options(self) -> tuple[str, ...]:
        """The words of a command that runs a case again, besides file and case."""
        return *self.loading, *self.words()
