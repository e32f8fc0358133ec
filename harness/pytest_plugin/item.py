"""A scenario as a pytest item."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from harness.reporting.result import CaseResult
from harness.reporting.terminal import causes
from harness.suite.cases import CaseJob, run_here, run_isolated
from harness.suite.folders import report_folders
from harness.suite.header import Header, read_header, source_lines
from harness.suite.warm import ServerStartError, WarmServer

SERVER = pytest.StashKey[WarmServer]()
PYTEST_MARKS = frozenset(
    ("skip", "skipif", "xfail", "parametrize", "parameterize", "parametrise", "parameterise",
     "usefixtures", "filterwarnings", "tryfirst", "trylast")
)  # fmt: skip
"""Marks that change what a verdict means, or that pytest refuses: no tag becomes one of them."""


class ScenarioNotPassed(Exception):
    """A scenario failed, is invalid, or broke; says why, with every number."""

    def __init__(self, result: CaseResult) -> None:
        told = causes(result, source_lines(Path(result.file)))
        if result.report_dir:
            told.append(f"report: {result.report_dir}")
        super().__init__("\n".join(told))


class ScenarioFile(pytest.File):
    """A scenario file with its one case."""

    def collect(self) -> Iterable[ScenarioItem]:
        header = read_header(self.path)
        name = header.title.replace("::", ":")
        yield ScenarioItem.from_parent(self, name=name, header=header)


class ScenarioItem(pytest.Item):
    """One case of a scenario."""

    def __init__(self, *, header: Header, **keywords: Any) -> None:
        super().__init__(**keywords)
        self._header = header
        self.extra_keyword_matches.add(self.path.name)
        for tag in header.tags:
            self.extra_keyword_matches.add(tag)
            if tag not in PYTEST_MARKS and not tag.startswith("_"):
                self.config.addinivalue_line("markers", f"{tag}: a scenario's tag")
                self.add_marker(getattr(pytest.mark, tag))

    def runtest(self) -> None:
        result = self._run()
        self._tell(result)
        if result.outcome != "passed":
            raise ScenarioNotPassed(result)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        if isinstance(excinfo.value, ScenarioNotPassed | ServerStartError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int, str]:
        return self.path, self._header.line - 1, self.name

    def _run(self) -> CaseResult:
        job = CaseJob(_shown(self.path), report_dir=self._report_dir())
        if self.config.getoption("--harness-in-process"):
            results = run_here([job])
        else:
            cap = self.config.getini("harness_hard_cap")
            results = run_isolated(
                [job], _server(self.config), hard_cap=float(cap) if cap else None
            )
        [(_index, result)] = results
        return result

    def _report_dir(self) -> Path | None:
        if self.config.getoption("--harness-no-report"):
            return None
        asked = self.config.getoption("--harness-report-dir")
        root = (
            Path(asked)
            if asked
            else self.config.rootpath / self.config.getini("harness_report_dir")
        )
        return report_folders([self.path], root)[0]

    def _tell(self, result: CaseResult) -> None:
        """Put what a later reader needs beside the test's outcome."""
        self.user_properties += [("seed", result.seed), ("digest", result.digest)]
        if result.report_dir:
            self.user_properties.append(("report", result.report_dir))
        for note in result.notes:
            self.add_report_section("call", "scenario", note)


def _server(config: pytest.Config) -> WarmServer:
    """The fork server of this pytest process; it ends with pytest."""
    if SERVER not in config.stash:
        config.stash[SERVER] = server = WarmServer()
        config.add_cleanup(server.close)
    return config.stash[SERVER]


def _shown(path: Path) -> Path:
    """A path as a person would write it."""
    here = Path.cwd()
    return path.relative_to(here) if path.is_relative_to(here) else path
