"""Programs that the user allowed a scenario to start."""

from __future__ import annotations

import contextlib
import os
import shlex
import signal
import subprocess
import tempfile
from collections.abc import Mapping

from harness.core.errors import StepFailed

TAIL = 2000  # characters of a program's last output that are shown


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
        reason = (
            f"the command '{name}' is not allowed: give it with --node '{name}=COMMAND'{allowed}"
        )
    if reason:
        raise StepFailed("COMMUNICATION_FAILURE", reason)
    return Program(commands[name or known], domain) if commands else None


class Program:
    """A running program, with everything that it started.

    Attributes:
        output: The end of what it printed, once it is stopped.
    """

    def __init__(self, command: str, domain: int) -> None:
        """Start a command in the domain.

        Raises:
            StepFailed: COMMUNICATION_FAILURE; it cannot be started.
        """
        environment = dict(os.environ, ROS_DOMAIN_ID=str(domain), PYTHONUNBUFFERED="1")
        environment["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
        self.output, self._printed = "", tempfile.TemporaryFile()  # noqa: SIM115 - closed by `stop`
        try:
            self._process = subprocess.Popen(
                shlex.split(command),
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=self._printed,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        except (OSError, ValueError) as error:
            self._printed.close()
            reason = error.strerror if isinstance(error, OSError) else error
            reason = f"`{command}` cannot be started: {reason}"
            raise StepFailed("COMMUNICATION_FAILURE", reason) from error

    @property
    def exit_code(self) -> int | None:
        """The exit code; None while it runs."""
        return self._process.poll()

    def stop(self) -> None:
        """End the program and what it started: interrupt, then kill what still runs."""
        if self._printed.closed:
            return
        for number, patience in ((signal.SIGINT, 2.0), (signal.SIGKILL, 5.0)):
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, number)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(patience)
        self._printed.seek(max(0, self._printed.seek(0, os.SEEK_END) - TAIL))
        self.output = self._printed.read().decode("utf-8", "replace").strip()
        self._printed.close()
