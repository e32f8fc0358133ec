"""A scenario as a pytest item; collecting files imports no planner and no physics."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from harness.core.printable import printable, terminal_text
from harness.suite.header import ScenarioHeader, read_header

PYTEST_MARKS = frozenset(
    (
        "skip",
        "skipif",
        "xfail",
        "parametrize",
        "parameterize",
        "parametrise",
        "parameterise",
        "usefixtures",
        "filterwarnings",
        "tryfirst",
        "trylast",
    )
)
"""Marks that change the meaning of a verdict, or that pytest refuses. No tag adds one of them."""


class ScenarioFile(pytest.File):
    """A scenario file with its cases; all random samples of a case are one item."""

    def collect(self) -> Iterable[ScenarioItem]:
        header = read_header(self.path)
        title = printable(header.title).replace("::", ":")
        for number, case in enumerate(header.variation.parametrized()):
            name = f"{title}[{printable(case.name)}]" if case.name else title
            yield ScenarioItem.from_parent(
                self, name=name, header=header, case=case.name, number=number
            )


class ScenarioItem(pytest.Item):
    """One case of a scenario, or all samples of it.

    Attributes:
        case: Name of the case; for samples, the name that they share.
        number: Position of the case in its file, from 0.
    """

    def __init__(
        self,
        *,
        name: str,
        parent: pytest.Collector,
        header: ScenarioHeader,
        case: str,
        number: int,
        **keywords: Any,
    ) -> None:
        # as a text, which pytest takes apart in the same way as the ids in its cache
        nodeid = f"{parent.nodeid}::{name}"
        super().__init__(name=name, parent=parent, nodeid=nodeid, **keywords)
        self.header = header
        self.case = case
        self.number = number
        self.extra_keyword_matches.add(self.path.name)
        for tag in header.tags:
            self.extra_keyword_matches.add(tag)
            if tag not in PYTEST_MARKS and not tag.startswith("_"):
                self.config.addinivalue_line("markers", f"{printable(tag)}: a scenario's tag")
                self.add_marker(getattr(pytest.mark, tag))

    def runtest(self) -> None:
        from harness.pytest_plugin.running import run_item  # imports the rest of the harness

        run_item(self, self.header, self.case, self.number)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        from harness.pytest_plugin.running import SELF_EXPLANATORY_ERRORS

        if isinstance(excinfo.value, SELF_EXPLANATORY_ERRORS):
            return "\n".join(map(terminal_text, str(excinfo.value).split("\n")))
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int, str]:
        return self.path, self.header.line - 1, self.name
