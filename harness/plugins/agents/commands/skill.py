"""`harness skill`: the page that a language model reads first."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import ClassVar

from harness.cli.command import SETUP, Command
from harness.cli.output import say, say_text

SKILL = Path(__file__).parents[1] / "SKILL.md"


class SkillCommand(Command):
    """Print SKILL.md, instructions for language-model agents."""

    name: ClassVar[str] = "skill"
    group: ClassVar[str] = SETUP

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness skill`."""
        text = "print the path of the file instead of its text"
        command.add_argument("--path", action="store_true", help=text)

    def run(self, arguments: argparse.Namespace) -> int:
        """Print the skill, or its path."""
        if arguments.path:
            say(str(SKILL))
        else:
            say_text(SKILL.read_text(encoding="utf-8").rstrip())
        return 0
