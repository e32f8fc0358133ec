"""Few open files, little memory, full and read-only disks, no home: in every command."""

from __future__ import annotations

import os
import random
import resource
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

from tests.campaigns.attacks import trial
from tests.campaigns.attacks.workshop import COMMANDS

KINDS = (
    "open files", "memory", "file size", "file size", "disk", "disk", "read only", "no home",
    "stdout full", "no temporary folder",
)  # fmt: skip
MB = 2**20


def attack(rng: random.Random, master: Path, folder: Path) -> tuple[str, list[str]]:
    """One limit for one command; what it was, and the findings."""
    command = rng.choice([each for each in COMMANDS if not each.serves])
    kind, place = rng.choice(KINDS), folder / "place"
    about, prepare, environment = kind, None, dict[str, str]()
    if kind == "disk":
        used = sum(each.stat().st_size + 4096 for each in master.rglob("*")) + 100_000
        left = rng.choice((0, 20_000, 100_000, 400_000, 1_500_000))
        mount(place, f"size={used + left}")
        about = f"{left / 1000:g} kB left"
        shutil.copytree(master, place, dirs_exist_ok=True)
        (place / ".tmp").mkdir()
    else:
        trial.workplace(master, place)
    said = folder / ".said"
    match kind:
        case "open files":
            number = rng.randint(4, 40)
            about, prepare = f"{number} files", trial.limit(resource.RLIMIT_NOFILE, number)
        case "memory":
            more = rng.choice((1, 10, 50, 200, 500)) * MB
            about, prepare = f"{more // MB} MB more", more_memory(more)
        case "file size":
            most = rng.choice((0, 50, 1000, 20_000, 200_000))
            about, prepare = f"files of {most}", trial.limit(resource.RLIMIT_FSIZE, most)
        case "read only":
            mount(place, "bind", str(place))
            subprocess.run(["mount", "-o", "remount,bind,ro", str(place)], check=True)
            environment["TMPDIR"] = str(folder)
        case "no home":
            home = rng.choice(("", "/nonexistent", "/dev/null", "relative"))
            environment |= {"HOME": home, "XDG_CACHE_HOME": home}
            about = f"no home but {home!r}"
        case "stdout full":
            prepare = full_output
        case "no temporary folder":
            environment["TMPDIR"] = "/nonexistent"
        case _:
            pass
    pid = trial.start(
        command.plain(), place, stdin=command.stdin, prepare=prepare, environment=environment,
        said=said,
    )  # fmt: skip
    ended = trial.finish(pid, said)
    found = trial.complaints(ended, codes=(0, 1, 2, 3))
    found += trial.leftovers(place, pid) + trial.damaged(place)
    return f"{command.name} [{about}]", [
        f"{each} (exit code {ended.code})\n{ended.said[-1500:]}" for each in found
    ]


def more_memory(size: int) -> Callable[[], None]:
    """What lets the process have that many bytes more than it has."""

    def apply() -> None:
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        most = pages * os.sysconf("SC_PAGE_SIZE") + size
        resource.setrlimit(resource.RLIMIT_AS, (most, most))

    return apply


def full_output() -> None:
    """Lead standard output into a full device."""
    os.dup2(os.open("/dev/full", os.O_WRONLY), 1)


def mount(place: Path, options: str, source: str = "none") -> None:
    """Mount a memory disk, or a folder on itself, for the processes of this campaign alone."""
    place.mkdir(parents=True, exist_ok=True)
    kind = ["-t", "tmpfs"] if source == "none" else []
    subprocess.run(["mount", *kind, "-o", options, source, str(place)], check=True)


def clean(folder: Path) -> None:
    """Unmount what an attack has mounted."""
    for _ in range(2):
        subprocess.run(["umount", "-l", str(folder / "place")], check=False, capture_output=True)
