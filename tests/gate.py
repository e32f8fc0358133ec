"""Commands that stand still where a test looks at them: in a step, or in the report of a case."""

import os
from pathlib import Path

from tests.waiting import wait_for

PLUGIN = ["--plugin", "gate_plugins.py"]
"""The options of a command that knows the step, in the folder of a gate."""

CODE = '''\
import time
from pathlib import Path
from typing import ClassVar

from harness.reporting.reporter import Reporter
from harness.steps import Cell, Step


def arrive(gate):
    """Wait until the file of a gate has as many bytes as cases have arrived."""
    with gate.with_name("arrived").open("ab", buffering=0) as arrived:
        arrived.write(b".")
        number = arrived.tell()
    while gate.stat().st_size < number:
        time.sleep(0.01)


class Hold(Step):
    """Wait at the gate of a folder."""

    verb: ClassVar[str] = "hold"
    short: ClassVar[str] = "gate"

    gate: str

    def summary(self) -> str:
        return "at the gate"

    def execute(self, cell: Cell) -> None:
        arrive(Path(self.gate))


class Gate(Reporter):
    """Wait at a gate."""

    name = "gate"

    def write(self, folder, stored):
        arrive(Path(self.argument))
'''


class Gate:
    """A gate, closed at the beginning, for a command that runs in `folder`.

    Attributes:
        reporter: The options of a command whose cases wait in their reports.
        step: The step of a scenario that waits.
    """

    def __init__(self, folder: Path) -> None:
        self._file, self._arrived = folder / "gate", folder / "arrived"
        for file in (self._file, self._arrived):
            file.touch()
        (folder / "gate_plugins.py").write_text(CODE, encoding="utf-8")
        self.reporter = [*PLUGIN, "--reporter", f"gate={self._file}"]
        self.step = f"hold: {self._file}"

    def let_pass(self, cases: int) -> None:
        """Let that many cases pass in all."""
        os.truncate(self._file, cases)

    @property
    def arrived(self) -> int:
        """How many cases have arrived, those that passed included."""
        return self._arrived.stat().st_size

    def wait(self) -> None:
        """Wait until a case stands at the gate."""
        wait_for(lambda: self.arrived > self._file.stat().st_size)
