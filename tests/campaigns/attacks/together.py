"""Two or three commands in one folder at the same time, with the same output."""

from __future__ import annotations

import random
import time
from pathlib import Path

from harness.recording.read_run import read_run
from tests.campaigns.attacks import trial
from tests.campaigns.attacks.workshop import COMMANDS, Command


def outputs(command: Command) -> set[str]:
    """What a command writes; a run that it reads, too, whose page may be written again."""
    return {word[1:] for word in command.words if word[:1] == ">" or word[:4] == "@run"}


def attack(rng: random.Random, master: Path, folder: Path) -> tuple[str, list[str]]:
    """Commands that share an output; what they were, and the findings."""
    first = rng.choice([each for each in COMMANDS if outputs(each)])
    sharing = [each for each in COMMANDS if outputs(each) & outputs(first)]
    commands = [first, *(rng.choice(sharing) for _ in range(rng.choice((1, 1, 2))))]
    place = trial.workplace(master, folder / "place")
    started: list[tuple[int, Path]] = []
    for number, command in enumerate(commands):
        said = folder / f"said{number}"
        started.append((trial.start(command.plain(), place, stdin=command.stdin, said=said), said))
        time.sleep(rng.choice((0.0, 0.0, 0.05, 0.3)))
    found: list[str] = []
    codes: list[int] = []
    for pid, said in started:
        ended = trial.finish(pid, said)
        codes.append(ended.code)
        wrong = trial.complaints(ended, codes=(0, 1, 2, 3))
        found += [f"{each} (exit code {ended.code})\n{ended.said[-1500:]}" for each in wrong]
    for pid, _ in started:
        found += trial.leftovers(place, pid)
    found += trial.damaged(place)
    for document in place.rglob("run.json"):
        try:
            read_run(document.parent)
        except Exception as error:  # noqa: BLE001 - a run of two commands
            found.append(f"{document.parent.relative_to(place)} cannot be read: {error}")
    return f"{' + '.join(each.name for each in commands)} {codes}", found
