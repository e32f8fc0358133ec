"""Signals at random moments in every command, and the end of one of its processes."""

from __future__ import annotations

import os
import random
import signal
from contextlib import suppress
from pathlib import Path

from tests.campaigns.attacks import trial
from tests.campaigns.attacks.workshop import COMMANDS

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
KINDS = ("one", "one", "one", "group", "twice", "pipe", "kill", "kill worker", "kill worker")


def attack(rng: random.Random, master: Path, folder: Path) -> tuple[str, list[str]]:
    """One or two signals for one command; what it was, and the findings."""
    command, kind = rng.choice(COMMANDS), rng.choice(KINDS)
    number = rng.choice(ENDING)
    delay = 10 ** rng.uniform(-3, 0.7)
    place = trial.workplace(master, folder / "place")
    pid = trial.start(command.plain(), place, stdin=command.stdin)
    moments = [(delay, number)]
    match kind:
        case "twice":
            moments.append((delay + rng.choice((0.0, 0.01, 0.3)), rng.choice(ENDING)))
        case "pipe":
            moments = [(delay, signal.SIGPIPE)]
        case "kill" | "kill worker":
            moments = [(delay, signal.SIGKILL)]
        case _:
            pass
    if command.serves and kind in ("pipe", "kill worker"):
        moments.append((delay + 1.0, signal.SIGTERM))
    hit: list[int] = []

    def act(seconds: float) -> bool:
        while moments and seconds >= moments[0][0]:
            _, sent = moments.pop(0)
            target = trial.subprocess_of(pid, rng) if kind == "kill worker" and not hit else pid
            hit.append(target)
            with suppress(OSError):
                (os.killpg if kind == "group" else os.kill)(target, sent)
        return bool(moments)

    ended = trial.finish(pid, place, act=act)
    is_killed = kind == "kill" or (kind == "kill worker" and hit[:1] == [pid])
    codes = [*trial.CODES, 128 + number, -signal.SIGKILL if is_killed else 130]
    if not ended.said:  # the program had not begun
        codes += [-number]
    if kind == "kill worker":  # its parent says what ended it
        codes += [128 + signal.SIGKILL]
    found = trial.complaints(ended, codes=codes)
    left = trial.leftovers(place, pid)
    if not is_killed:  # what a killed command leaves, the next one removes
        found += left
    found += trial.damaged(place)
    return f"{command.name} [{kind} {number.name} after {delay:.3f} s]", [
        f"{each} (exit code {ended.code})\n{ended.said[-1500:]}" for each in found
    ]
