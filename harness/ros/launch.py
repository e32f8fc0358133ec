"""Programs that the user allowed a scenario to start."""

from __future__ import annotations

import contextlib
import os
import shlex
import signal
import subprocess
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from harness.core.errors import Problem, SpecError, StepFailed

TAIL = 2000
"""Characters of a program's last output that are shown."""


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


@dataclass(frozen=True)
class Allowed:
    """Commands by name; a scenario can start nothing else.

    Attributes:
        commands: Command lines; `node` is the name of one that the user gave none.
        domain: The ROS_DOMAIN_ID of the programs.
    """

    commands: Mapping[str, str]
    domain: int

    def start(self, name: str) -> Program | None:
        """Start a command; None where the step names none and none was given.

        Raises:
            StepFailed: COMMUNICATION_FAILURE; the user gave no such command, or it cannot start.
        """
        if not name and not self.commands:
            return None
        if not name and len(self.commands) > 1:
            raise StepFailed(
                "COMMUNICATION_FAILURE",
                f"several commands are allowed ({', '.join(self.commands)}); name one with"
                " `launch`",
            )
        name = name or next(iter(self.commands))
        if name not in self.commands:
            known = f"; allowed: {', '.join(self.commands)}" if self.commands else ""
            raise StepFailed(
                "COMMUNICATION_FAILURE",
                f"the command '{name}' is not allowed: give it with --node '{name}=COMMAND'{known}",
            )
        return Program(self.commands[name], self.domain)


class Program:
    """A running program, with everything that it started."""

    def __init__(self, command: str, domain: int) -> None:
        """Start a command in the domain.

        Raises:
            StepFailed: COMMUNICATION_FAILURE; it cannot be started.
        """
        environment = {
            **os.environ,
            "ROS_DOMAIN_ID": str(domain),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "PYTHONUNBUFFERED": "1",
        }
        self._output = tempfile.TemporaryFile()  # noqa: SIM115 - closed by `stop`
        try:
            self._process = subprocess.Popen(
                shlex.split(command),
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=self._output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        except (OSError, ValueError) as error:
            self._output.close()
            reason = error.strerror if isinstance(error, OSError) else error
            raise StepFailed(
                "COMMUNICATION_FAILURE", f"`{command}` cannot be started: {reason}"
            ) from error

    @property
    def exit_code(self) -> int | None:
        """The exit code; None while it runs."""
        return self._process.poll()

    def output(self) -> str:
        """The end of what it printed."""
        size = self._output.seek(0, os.SEEK_END)
        self._output.seek(max(0, size - TAIL))
        return self._output.read().decode("utf-8", "replace").strip()

    def stop(self) -> None:
        """End the program and what it started: interrupt, then kill."""
        for number, patience in ((signal.SIGINT, 2.0), (signal.SIGKILL, 5.0)):
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, number)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(patience)
                break
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)  # what it started and left running
        self._output.close()
