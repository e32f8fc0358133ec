"""Attacks on commands, drawn one after another, and what they found.

    python -m tests.campaigns.attacks [ATTACK ...] --count N --seed S [--minutes N]

The counts go into `records.json`, from which docs/explanation/reliability.md is made; `--dry`
leaves it as it is.
"""

from __future__ import annotations

import argparse
import ctypes
import gc
import importlib
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tests.campaigns.attacks import workshop
from tests.campaigns.records import count_attacks

NEW_MOUNTS = 0x20000  # CLONE_NEWNS of Linux
ATTACKS = ("odd_paths", "long_words", "signals", "limits", "clocks", "together", "servers")


def campaign(
    name: str, seed: int, count: int, seconds: float, master: Path
) -> tuple[int, float, list[str]]:
    """The tries, the processor time and the findings of an attack."""
    module: Any = importlib.import_module(f"tests.campaigns.attacks.{name}")
    findings: list[str] = []
    begin, used, tries = time.monotonic(), processor_time(), 0
    while tries < count and (not tries or time.monotonic() < begin + seconds):
        folder = Path(tempfile.mkdtemp(prefix="attack-", dir=master.parent))
        try:
            about, found = module.attack(random.Random(f"{seed} {tries}"), master, folder)
        except Exception:  # noqa: BLE001 - the attack itself is broken
            about, found = "the attack", [traceback.format_exc()]
        finally:
            getattr(module, "clean", void)(folder)
            shutil.rmtree(folder, ignore_errors=True)
        for each in found:
            sys.stdout.write(f"--- {name}, seed {seed}, try {tries}: {about}\n    {each}\n")
            sys.stdout.flush()
        findings += found[:1]  # one for each try
        tries += 1
    return tries, processor_time() - used, findings


def private_mounts() -> None:
    """Let no other process see what this one mounts, so that it vanishes with this one."""
    if os.geteuid() == 0 and not ctypes.CDLL(None).unshare(NEW_MOUNTS):
        subprocess.run(["mount", "--make-rprivate", "/"], check=True)


def void(_: object) -> None:
    """Nothing."""


def processor_time() -> float:
    """Processor time of this process and of those that it has ended [s]."""
    return sum(os.times()[:4])


def main(words: Sequence[str] | None = None) -> int:
    """Run attacks, print their findings and write their counts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("attacks", nargs="*", metavar="ATTACK", help=f"of {', '.join(ATTACKS)}")
    parser.add_argument("--count", type=int, default=50, help="tries of each")
    parser.add_argument("--minutes", type=float, default=1e6, help="most time for each")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--dry", action="store_true", help="do not write the counts")
    parser.add_argument("--workshop", type=Path, help="keeps the files that commands read")
    arguments = parser.parse_args(words)
    if unknown := [each for each in arguments.attacks if each not in ATTACKS]:
        parser.error(f"no attack is called {unknown[0]}; there are {', '.join(ATTACKS)}")
    from harness.suite.server import preload
    from harness.suite.warm import REPORT_MODULES, RUN_MODULES

    worst = 0
    private_mounts()
    with tempfile.TemporaryDirectory(prefix="attacks-") as place:
        os.environ["XDG_CACHE_HOME"] = f"{place}/cache"
        master = Path(place, "master")
        made = arguments.workshop or Path(place, "made")
        preload(["harness.cli.main", *RUN_MODULES, *REPORT_MODULES, "tests.commands"])
        if not made.exists():
            workshop.build(made)
        shutil.copytree(made, master)
        gc.freeze()
        for name in arguments.attacks or ATTACKS:
            tries, seconds, found = campaign(
                name, arguments.seed, arguments.count, 60 * arguments.minutes, master
            )
            sys.stdout.write(
                f"{name:12} {tries:6} tries {seconds:7.0f} s {len(found):3} findings\n"
            )
            sys.stdout.flush()
            if not arguments.dry:
                count_attacks(name, tries, seconds, len(found))
            worst += len(found)
    return 1 if worst else 0


if __name__ == "__main__":
    sys.exit(main())
