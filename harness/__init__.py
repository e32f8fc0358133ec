"""armharness: a declarative scenario runner and test harness for robot arms."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path
    from typing import Any

    from harness.language.scenario import Scenario
    from harness.suite.api import ScenarioResult

__version__ = "0.1.0"
__all__ = ["__version__", "register", "run"]

P = TypeVar("P")


def register(plugin: P, *, kind: str = "", name: str = "") -> P:
    """Make a plug-in known: a step, an expectation, a planner and so on; works as a decorator too.

    An installed package need not call this for its steps and expectations: the entry-point group
    `harness.plugins` names its modules, whose classes are registered.

    Args:
        plugin: A class that states its kind and name, such as a step, or anything else.
        kind: One of `step`, `expectation`, `planner`, `ik_solver`, `controller`, `robot`,
            `world_format`, `reporter`, `command`, `run_mode`, `case_runner`; needed where the
            plug-in does not state it.
        name: Needed where the plug-in does not state it.

    Returns:
        The plug-in as it was given.

    Raises:
        PluginError: The kind or name is missing, or another package provides the name.
    """
    from harness.core import registry

    return registry.register(plugin, kind=kind, name=name)


def run(
    scenario: str | Path | Scenario,
    *,
    overrides: Mapping[str, Any] | None = None,
    seed: int | None = None,
    case: str = "",
    report_dir: str | Path | None = None,
) -> ScenarioResult:
    """Run one case of a scenario in this process.

    Args:
        scenario: A file, or the model of one, built in Python.
        overrides: Dotted path -> value, as `--set` has them: `{"robot.model": "ur5e"}`.
        seed: Instead of the scenario's.
        case: The name of the case, where the file is parametrised.
        report_dir: Where its report is written; None: nowhere.

    Returns:
        True when it passed; `str` of it says why it did not; `case` and `run` hold everything.

    Raises:
        UsageError: There is no such case, or one must be named.
    """
    from harness.suite.api import run_scenario

    return run_scenario(scenario, overrides=overrides, seed=seed, case=case, report_dir=report_dir)
