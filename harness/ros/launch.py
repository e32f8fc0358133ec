"""Programs that the user allowed a scenario to start."""

from __future__ import annotations

import contextlib
import os
import shlex
import signal
import subprocess
import tempfile
from collections.abc import Iterable, Mapping

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


def start_program(commands: Mapping[str, str], name: str, domain: int) -> Program | None:
    """Start one of the allowed commands in a domain; None where none is named or allowed.

    Raises:
        StepFailed: COMMUNICATION_FAILURE; the user gave no such command, or it cannot start.
    """
    known, reason = ", ".join(commands), ""
    if not name and len(commands) > 1:
        reason = f"several commands are allowed ({known}); name one with `launch`"
    elif name and name not in commands:
        allowed = f"; allowed: {known}" if commands else ""
        reason = f"the command '{name}' is not allowed: give it with --node '{name}=COMMAND'"
        reason += allowed
    if reason:
        raise StepFailed("COMMUNICATION_FAILURE", reason)
    return Program(commands[name or known], domain) if commands else None


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
            said = f"`{command}` cannot be started: {reason}"
            raise StepFailed("COMMUNICATION_FAILURE", said) from error

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
        """End the program and what it started: interrupt, then kill what goes on."""
        self._signal(signal.SIGINT)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(2.0)
        self._signal(signal.SIGKILL)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(5.0)
        self._output.close()

    def _signal(self, number: int) -> None:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, number)
