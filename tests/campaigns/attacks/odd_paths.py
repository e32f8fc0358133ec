"""Pipes, devices, sockets, folders and loops of links in place of what a command names."""

from __future__ import annotations

import os
import random
import shutil
import socket
from pathlib import Path

from tests.campaigns.attacks import trial
from tests.campaigns.attacks.workshop import COMMANDS

KINDS = (
    "pipe", "/dev/zero", "/dev/full", "/dev/null", "/dev/tty", "socket", "folder", "loop",
    "dangling", "empty", "bytes", "/proc/self/mem", "/proc/kmsg", "long name",
    "pipe inside", "file above",
)  # fmt: skip


def put(kind: str, path: Path, rng: random.Random) -> str:
    """Put something odd at a path; the word that names it."""
    if kind.startswith("/"):
        return kind
    if kind == "long name":
        return str(path.with_name("n" * 300))
    if kind == "file above":
        return f"a.scenario.yaml/{path.name}"
    if kind == "pipe inside" and path.is_dir():
        files = sorted(each for each in path.rglob("*") if each.is_file())
        inside = rng.choice(files)
        inside.unlink()
        os.mkfifo(inside)
        return str(path)
    suffix = path
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    path.unlink(missing_ok=True)
    path.parent.mkdir(parents=True, exist_ok=True)
    match kind:
        case "pipe" | "pipe inside":
            os.mkfifo(suffix)
        case "socket":
            with socket.socket(socket.AF_UNIX) as bound:
                here = Path.cwd()
                os.chdir(path.parent)
                bound.bind(path.name)
                os.chdir(here)
        case "folder":
            path.mkdir()
        case "loop":
            path.symlink_to(path.name)
        case "dangling":
            path.symlink_to("nowhere")
        case "empty":
            path.touch()
        case _:
            path.write_bytes(rng.randbytes(3000))
    return str(path)


def attack(rng: random.Random, master: Path, folder: Path) -> tuple[str, list[str]]:
    """One odd path for one command; what it was, and the findings."""
    command = rng.choice([each for each in COMMANDS if each.slots() and not each.serves])
    slot, kind = rng.choice(command.slots()), rng.choice(KINDS)
    place = trial.workplace(master, folder / "place")
    words = command.plain()
    plain, colon, function = words[slot].partition(":")
    words[slot] = put(kind, place / plain, rng).replace(f"{place}/", "") + colon + function
    about = f"{words[slot][:40]} is {kind}"
    pid = trial.start(words, place, stdin=command.stdin, prepare=bounded)
    ended = trial.finish(pid, place)
    found = trial.complaints(ended, codes=(0, 1, 2, 3))
    found += trial.leftovers(place, pid)
    return f"{command.name} [{about}]", [f"{each}\n{ended.said[-1500:]}" for each in found]


def bounded() -> None:
    """Let the command have 6 GB, so that an endless file ends it and not the machine."""
    import resource

    resource.setrlimit(resource.RLIMIT_AS, (6 * 2**30, 6 * 2**30))
