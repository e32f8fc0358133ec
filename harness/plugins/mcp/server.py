"""The tools of the server."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from mcp.server.mcpserver import Image, MCPServer
from mcp.server.mcpserver.exceptions import ToolError

from harness import __version__
from harness.core.errors import HarnessError
from harness.plugins.mcp.answers import case_facts, schema_of
from harness.plugins.mcp.workspace import RefusedError, Workspace, shortened

INSTRUCTIONS = """\
Scenarios of robot arms, as YAML. `list` and `schema` say what may be written, `write` saves a file
and checks it, `describe` says what stands where and what can be reached, `run` plans, simulates and
judges, and `picture` shows a moment of a run. Lengths are in m and angles in rad unless a unit is
written."""

P = ParamSpec("P")
R = TypeVar("R")


def server_of(workspace: Workspace) -> MCPServer[Any]:
    """The server of a folder; no tool of it moves hardware or runs code of a file."""
    server: MCPServer[Any] = MCPServer("armharness", instructions=INSTRUCTIONS, version=__version__)
    tools = Tools(workspace)
    for tool in (
        tools.list, tools.schema, tools.read, tools.write, tools.check,
        tools.describe, tools.explain, tools.run, tools.picture, tools.search,
    ):  # fmt: skip
        server.add_tool(tool, structured_output=False)
    return server


def _answering(tool: Callable[P, R]) -> Callable[P, R]:
    """The tool, whose refusals become the answers of failed calls."""

    @wraps(tool)
    def answered(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return tool(*args, **kwargs)
        except HarnessError as error:
            raise ToolError(str(error)) from error

    return answered


class Tools:
    """What an assistant may do in a folder. The docstrings are the descriptions that it reads."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace

    @_answering
    def list(self, kind: str = "") -> str:
        """List robots, worlds, scenarios, steps and so on; without a kind, list the kinds."""
        return self._workspace.listing(kind)

    @_answering
    def schema(self, name: str = "") -> str:
        """JSON Schema of a step, an expectation or a key, such as `pick` or `objects`.

        Without a name: the keys of a scenario and their descriptions.
        """
        return json.dumps(schema_of(json.loads(self._workspace.command("schema")), name))

    @_answering
    def read(self, file: str) -> str:
        """The text of a scenario file of the folder, or of a bundled scenario by its name."""
        return self._workspace.read(file)

    @_answering
    def write(self, file: str, text: str) -> str:
        """Write a YAML file; for a scenario (NAME.scenario.yaml) return the answer of `check`."""
        self._workspace.write(file, text)
        return self.check(file) if file.endswith(".scenario.yaml") else f"{file} is written"

    @_answering
    def check(self, file: str) -> str:
        """Problems of a scenario that are found without physics, with line, column and advice."""
        [*cases] = self._workspace.document("check", self._workspace.scenario(file))["files"]
        return json.dumps(cases)

    @_answering
    def describe(self, file: str) -> str:
        """What stands where in a scenario's cell: sizes, reach, clearances, graspable widths."""
        return json.dumps(self._workspace.document("describe", self._workspace.scenario(file)))

    @_answering
    def explain(self, file: str) -> str:
        """The program that a scenario becomes: each step with what it expands into."""
        return shortened(self._workspace.command("explain", self._workspace.scenario(file)))

    @_answering
    def run(self, file: str, case: str = "", seed: int | None = None) -> str:
        """Plan, simulate and judge a scenario; return outcome, reasons, margins, report folder."""
        words = ["run", self._workspace.scenario(file)]
        words += [f"--case={case}"] if case else []
        words += [f"--seed={seed}"] if seed is not None else []
        return json.dumps([case_facts(each) for each in self._workspace.document(*words)["cases"]])

    @_answering
    def picture(self, report: str, step: str = "") -> Image:
        """The picture of a step of a run, by the step's id; without it, of the last step.

        `report` is the folder that `run` names as `report_dir`.
        """
        folder = self._workspace.inside(report) / "images"
        ending = step.replace(".", "-").replace("[", "-").replace("]", "")
        pictures = sorted(folder.glob("*.jpg"))
        fitting = [each for each in pictures if each.stem.partition("-")[2] == ending]
        if not (chosen := fitting or ([] if step else pictures)):
            names = ", ".join(each.stem.partition("-")[2] for each in pictures) or "none"
            raise RefusedError(f"there is no picture of '{step}' in '{report}'; pictures: {names}")
        return Image(path=chosen[-1])

    @_answering
    def search(self, file: str, runs: int = 20) -> str:
        """Search the values of a scenario's `randomize` for a failure, and shrink it."""
        scenario = self._workspace.scenario(file)
        return json.dumps(self._workspace.document("search", scenario, f"--runs={runs}"))
