"""`harness completion`: completion of commands, options and names in a shell."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from glob import escape, glob
from pathlib import Path
from typing import Any, ClassVar

from harness.cli.arguments import CommandParser, Parser
from harness.cli.command import SETUP, Command
from harness.cli.main import parser_of
from harness.cli.output import output, say
from harness.suite.discovery import UsageError, bundled_scenarios

SCRIPTS = {
    "bash": """\
_harness() {
    local IFS=$'\\n'
    COMPREPLY=($(harness completion --for-words "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null))
    if [[ ${COMPREPLY[0]} == */ ]]; then compopt -o nospace; fi
}
complete -o default -F _harness harness
""",
    "zsh": """\
_harness() {
    local -a found
    found=(${(f)"$(harness completion --for-words "${(@)words[2,CURRENT]}" 2>/dev/null)"})
    if (( $#found )); then compadd -- $found; else _files; fi
}
compdef _harness harness
""",
    "fish": """\
function __harness_words
    set -l words (commandline -opc) (commandline -ct)
    harness completion --for-words $words[2..-1] 2>/dev/null
end
complete -c harness -a '(__harness_words)'
""",
}
"""The code for a shell; it runs this command, which prints the words that fit."""
HELP = (
    "print the code with which this shell completes commands; ~/.bashrc or ~/.zshrc can run it as"
    ' `eval "$(harness completion bash)"`, fish as `harness completion fish | source`'
)


class CompletionCommand(Command):
    """Complete commands, options and names in bash, zsh or fish."""

    name: ClassVar[str] = "completion"
    group: ClassVar[str] = SETUP

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness completion`."""
        which = command.add_mutually_exclusive_group()
        which.add_argument("shell", nargs="?", choices=tuple(SCRIPTS), help=HELP)
        text = "print what can stand for the last of these words; the code of a shell runs this"
        which.add_argument("--for-words", metavar="WORD", nargs=argparse.REMAINDER, help=text)

    def run(self, arguments: argparse.Namespace) -> int:
        """Print the code for a shell, or the words that fit."""
        if arguments.shell:
            output().document(SCRIPTS[arguments.shell])
        elif arguments.for_words is None:
            raise UsageError(f"name a shell: {', '.join(SCRIPTS)}")
        else:
            *before, last = arguments.for_words or [""]
            say(*(word for word in _words(before, last) if word.startswith(last)))
        return 0


def _words(before: Sequence[str], last: str) -> Iterator[str]:
    """Words that can follow others, whatever their beginning is."""
    parser: Parser = parser_of(before[:1])
    for word in before:
        parser = parser.commands().get(word, parser)
        if isinstance(parser, CommandParser):
            parser.learn()
    arguments = parser.arguments()
    options = {name: each for each in arguments for name in each.option_strings}
    taken = options.get(before[-1]) if before else None
    if taken is not None and taken.nargs != 0:
        yield from _choices(taken)
    elif last.startswith("-"):
        yield from (name for name in options if name.startswith("--"))
    else:
        for argument in arguments:
            if not argument.option_strings:
                yield from _choices(argument)
        if last:
            found = glob(f"{escape(last)}*")  # noqa: PTH207 - paths as they are written
            yield from (f"{path}/" if Path(path).is_dir() else path for path in found)


def _choices(argument: argparse.Action) -> Iterator[str]:
    choices: Any = argument.choices or ()
    yield from map(str, choices)
    if argument.dest in ("paths", "scenario"):
        yield from bundled_scenarios()
