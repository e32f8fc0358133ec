"""Commands on damaged input: how they end, and what they print."""

from __future__ import annotations

import contextlib
import io

from harness.cli.main import main


def outcome_of(*arguments: object) -> tuple[int, str]:
    """The exit code of a command, and everything that it prints."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        try:
            code = main([str(argument) for argument in arguments])
        except SystemExit as error:
            code = int(error.code or 0)
    printed.getvalue().encode()
    return code, printed.getvalue()


def assert_ends_well(*arguments: object) -> int:
    """A command passes, fails or refuses its input; it never ends in an error of the program."""
    code, printed = outcome_of(*arguments)
    assert code in (0, 1, 2), f"{arguments}: exit code {code}\n{printed}"
    assert "Traceback" not in printed, f"{arguments}\n{printed}"
    return code
