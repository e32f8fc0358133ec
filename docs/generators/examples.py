"""The examples of pages: files and commands that are carried out in an empty folder, in order.

A fenced block below a line with a name of a file in backticks and a colon is written to that file.
Every line of an `sh` block is run and has to succeed. A `text` block that begins with `$ command`
shows what the command prints; run as a script, this module prints it into the page again.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from docs import ROOT
from harness.core.printable import fitted

RENEW = "python -m docs.generators.examples"
PAGES = (
    ROOT / "docs/start.md",
    *sorted((ROOT / "docs/howto").glob("*.md")),
    *sorted((ROOT / "docs/explanation").glob("*.md")),
    ROOT / "docs/guides/grade_class.md",
    ROOT / "harness/plugins/agents/SKILL.md",
)
"""The pages whose every block is an example."""

COLUMNS = 88
"""Width to which printed lines are broken, as a terminal does: that of a code block on the site."""

BLOCK = re.compile(r"(?ms)^(?:`(?P<file>[\w./-]+)`:\n\n)?```(?P<language>\w+)\n(?P<text>.*?)^```$")
TIMES = re.compile(r"(?: at [\d.]+x real time)|(?: in [\d.]+ ?s$)", re.MULTILINE)
VARYING = re.compile(r"\d+\.\d+|digest:? [0-9a-f]+")


def printed_again(page: str, folder: Path) -> str:
    """Carry out a page in a folder; returns it with what its commands print now.

    Raises:
        RuntimeError: A command of an `sh` block failed; the text has its output.
    """
    parts, last = list[str](), 0
    for block in BLOCK.finditer(page):
        text = block["text"]
        if block["file"]:
            file = folder / block["file"]
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
        elif block["language"] == "sh":
            for command in commands(text):
                done = _run(command, folder)
                if done.returncode:
                    raise RuntimeError(f"$ {command}\n{done.stdout}")
        elif block["language"] == "text" and text.startswith("$ "):
            text = "".join(
                f"$ {command}\n{_shown(_run(command, folder).stdout)}" for command in shown(text)
            )
        parts += [page[last : block.start("text")], text]
        last = block.end("text")
    return "".join((*parts, page[last:]))


def commands(text: str) -> Iterator[str]:
    """The commands of an `sh` block; one that ends in a backslash continues in the next line."""
    for line in text.replace("\\\n", " ").splitlines():
        if line.strip() and not line.startswith("#"):
            yield line


def shown(text: str) -> list[str]:
    """The commands of which a `text` block shows the output."""
    return re.findall(r"(?m)^\$ (.*)$", text)


def comparable(text: str) -> str:
    """A text without what differs between processor families: decimals, digests, line breaks."""
    return VARYING.sub("#", " ".join(text.split()))


def _run(command: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """A command of the shell, with the programs of this environment; both streams as one.

    Raises:
        RuntimeError: A program crashed; the text has its output.
    """
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    done = subprocess.run(
        ["bash", "-c", command],
        cwd=folder,
        env={**os.environ, "PATH": path},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if "Traceback (most recent call last)" in done.stdout:
        raise RuntimeError(f"$ {command}\n{done.stdout}")
    return done


def _shown(printed: str) -> str:
    """What a page shows of an output: no wall times, no folder of this machine, short lines."""
    text = TIMES.sub("", printed).replace(f"{ROOT}/", "")
    lines = (part for line in text.splitlines() for part in fitted(line, COLUMNS) or [""])
    return "".join(f"{line.rstrip()}\n" for line in lines)


def main(names: list[str]) -> None:
    """Print the outputs of these pages again, or of all."""
    for page in [ROOT / name for name in names] or PAGES:
        with tempfile.TemporaryDirectory() as folder:
            text = printed_again(page.read_text(encoding="utf-8"), Path(folder))
        page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
