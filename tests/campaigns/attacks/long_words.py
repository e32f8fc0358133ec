"""Brackets 10,000 deep, huge numbers, very long and odd texts as the value of every option."""

from __future__ import annotations

import argparse
import random
from pathlib import Path

from tests.campaigns.attacks import trial
from tests.campaigns.attacks.workshop import COMMANDS

DEEP = 10_000
VALUES = (
    "(" * DEEP, "[" * DEEP, "{" * DEEP, "[[" * DEEP, "(" * DEEP + ")" * DEEP,
    "[" * DEEP + "]" * DEEP, "{a: " * DEEP, "x=" + "[" * DEEP, "x=" + "(" * DEEP, "*[" * DEEP,
    "not " * DEEP + "a", "a and " * DEEP + "a", "*a" * DEEP, "?" * DEEP, "a" * 100_000,
    "9" * 5000, "x=" + "9" * 5000, "-" + "9" * 5000, "1e999", "-1", "0", "nan", "inf", "-inf",
    "1e-320", "1/0", "0/5", "99999999999999999999", "1_0", "x<1e999", "x<nan", "x<" + "9" * 5000,
    "", " ", "=", "==", "x=", "=x", ",", ":", "::", "\n", "\udc80", "%s", "{0}", "${x}", "\x1b[31m",
    "é" * 5000, "x=" + "a" * 100_000, "..", "/", "~", "~no_such_user", "-", "--", "\u202e",
)  # fmt: skip


def attack(rng: random.Random, master: Path, folder: Path) -> tuple[str, list[str]]:
    """One odd value for one option of a command; what it was, and the findings."""
    from harness.cli.main import parser_of

    command = rng.choice([each for each in COMMANDS if not each.serves])
    words = command.plain()
    parser = parser_of(words).commands()[words[0]]
    parser.learn()
    if parser.commands():
        parser = parser.commands().get(words[1], parser)
    options = [each for each in parser.arguments() if each.option_strings and takes_a_word(each)]
    value = rng.choice(VALUES)
    if options and rng.random() < 0.85:
        option = rng.choice(options).option_strings[-1]
        words += [f"{option}={value}" if option.startswith("--") else f"{option}{value}"]
    else:
        option = "an argument"
        words[rng.randrange(1, len(words)) if len(words) > 1 else 0] = value
    place = trial.workplace(master, folder / "place")
    pid = trial.start(words, place, stdin=command.stdin)
    ended = trial.finish(pid, place)
    about = f"{command.name} [{option} {value[:12]!r} of {len(value)}]"
    found = trial.complaints(ended, codes=(0, 1, 2, 3))
    found += trial.leftovers(place, pid)
    return about, [f"{each}\n{ended.said[:700]}...{ended.said[-700:]}" for each in found]


def takes_a_word(action: argparse.Action) -> bool:
    """Whether an option has a value."""
    return action.nargs is None or action.nargs == "?" or action.nargs == "+"
