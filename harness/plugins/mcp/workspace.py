"""The one folder that the server works in, and the commands that it runs there."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from io import TextIOWrapper
from pathlib import Path
from threading import BoundedSemaphore
from typing import Any

from harness.core.errors import HarnessError
from harness.core.files import open_regular, replaced
from harness.core.limits import MCP_COMMANDS, MCP_TEXT
from harness.suite.discovery import bundled_scenarios

YAML = (".yaml", ".yml")
_RUNNING = BoundedSemaphore(MCP_COMMANDS)


class RefusedError(HarnessError):
    """A request that the server does not serve."""


@dataclass(frozen=True)
class Workspace:
    """A folder; no file outside it is read, written or run, but for the bundled scenarios.

    Every request is a command of `harness` in a process of its own, so that a crash or a hang of
    one costs nothing else, and the errors are those of the command line.
    """

    root: Path

    def inside(self, name: str) -> Path:
        """The path of a name in the folder; links are followed before it is compared.

        Raises:
            RefusedError: It lies outside.
        """
        try:
            path = (self.root / name).resolve()
        except (OSError, ValueError) as error:
            raise RefusedError(f"{name!r} cannot be a file: {error}") from error
        if not path.is_relative_to(self.root):
            raise RefusedError(f"'{name}' is outside the folder of this server; name a file in it")
        return path

    def scenario(self, name: str) -> str:
        """A scenario file as the command line may have it: in the folder, or a bundled one's name.

        Raises:
            RefusedError: It lies outside, or does not exist.
        """
        path = self.inside(name)
        if path.exists():
            return f"./{path.relative_to(self.root)}"  # no option, whatever its name is
        if name in bundled_scenarios():
            return name
        raise RefusedError(
            f"there is no file '{name}'; `list` with kind `scenarios` has the bundled ones"
        )

    def read(self, name: str) -> str:
        """The text of a YAML file of the folder, or of a bundled scenario.

        Raises:
            RefusedError: It lies outside, is no YAML file, or cannot be read.
        """
        path = bundled_scenarios().get(name) or self.inside(name)
        if path.suffix not in YAML:
            raise RefusedError(f"'{name}': only .yaml files are read")
        try:
            with TextIOWrapper(open_regular(path), encoding="utf-8") as stream:
                return shortened(stream.read(MCP_TEXT + 1))
        except (OSError, UnicodeDecodeError) as error:
            raise RefusedError(f"cannot read '{name}': {error}") from error

    def write(self, name: str, text: str) -> None:
        """Write a YAML file, with its folders; the file is replaced when everything is written.

        Raises:
            RefusedError: It is outside, is not YAML by its name, is too long, or cannot be written.
        """
        path = self.inside(name)
        if path.suffix not in YAML:
            raise RefusedError(f"'{name}': only .yaml files are written")
        if len(text) > MCP_TEXT:
            raise RefusedError(f"the text has {len(text)} characters; at most {MCP_TEXT}")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with replaced(path) as stream:
                stream.write(text.encode("utf-8"))
        except (OSError, UnicodeEncodeError) as error:
            raise RefusedError(f"cannot write '{name}': {error}") from error

    def listing(self, kind: str) -> str:
        """What `harness list` prints of a kind; without one, the kinds.

        Raises:
            RefusedError: There is no such kind; or it is an option, which could load a plug-in.
        """
        if kind.startswith("-"):
            raise RefusedError(f"'{kind}' is no kind; `list` without a kind has them")
        return self.command("list", *filter(None, [kind]))

    def command(self, *words: str) -> str:
        """What a command of `harness` prints.

        Raises:
            RefusedError: It ended with 2 (its problems are the text) or with an internal error.
        """
        done = self._run(words)
        if done.returncode not in (0, 1):
            raise RefusedError(shortened((done.stdout + done.stderr).strip()))
        return done.stdout

    def document(self, *words: str) -> Any:
        """The JSON document that a command prints; of a file with problems, too.

        Raises:
            RefusedError: It printed none.
        """
        done = self._run((*words, "--json"))
        try:
            return json.loads(done.stdout)
        except ValueError:
            raise RefusedError(shortened((done.stdout + done.stderr).strip())) from None

    def _run(self, words: Sequence[str]) -> subprocess.CompletedProcess[str]:
        # -P: a folder of strangers may hold a yaml.py, which Python would import from there.
        with _RUNNING:
            return subprocess.run(
                [sys.executable, "-P", "-m", "harness.cli", *words],
                cwd=self.root, stdin=subprocess.DEVNULL, capture_output=True,
                text=True, encoding="utf-8", errors="replace", check=False,
            )  # fmt: skip


def shortened(text: str) -> str:
    """The text, cut where it is longer than an answer may be."""
    return text if len(text) <= MCP_TEXT else text[:MCP_TEXT] + "\n..."
