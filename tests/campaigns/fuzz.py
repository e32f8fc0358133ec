"""Changed files for every reader, as long as there is time; nothing but located errors may come.

    python -m tests.campaigns.fuzz [READER ...] --minutes N --seed S [--guided] [--total MINUTES]

With `--total`, the reader with the least time in the record is next, again and again.
Each reader is a process of its own, which reads one changed file after another; a native crash or a
hang ends it, is a finding, and the search continues in the next process. The counts go into
`records.json`, from which docs/explanation/reliability.md is made.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import multiprocessing
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from tests.campaigns.execution import Execution, LastInput, Outcome, keep
from tests.campaigns.readers import READERS
from tests.campaigns.records import count, read_records

MEMORY_DISK = "/dev/shm" if Path("/dev/shm").is_dir() else None
LONGEST = 120.0  # processor time of one execution that counts as a hang [s]
LONGEST_WAIT = 3600.0  # wall time, for what waits without an end; a busy machine takes less [s]
PROCESS_CLOCK = 2  # of the clocks of a process in Linux: user and system time together
MEMORY = 8 * 2**30  # address space of a process that reads [bytes]


def _process(
    name: str, folder: Path, seed: int, seconds: float, outcome: Outcome, is_guided: bool
) -> None:
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    warnings.simplefilter("error", RuntimeWarning)  # NumPy's, which a user would see
    nothing = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nothing, stream)
    status = 0

    def begin() -> Execution:
        return Execution(READERS[name], folder, outcome)

    try:
        if is_guided:
            from tests.campaigns import guided  # needs a package that the others do not

            guided.search(begin, folder, seed, seconds)
        begin().search(seed, seconds)
    except BaseException as error:  # noqa: BLE001 - the campaign itself is broken
        (folder / "broken.txt").write_text("".join(traceback.format_exception(error)))
        status = 9
    os._exit(status)


def campaign(
    name: str, folder: Path, seed: int, seconds: float, *, is_guided: bool = False
) -> Outcome:
    """The campaign of one reader, in processes that may crash or hang."""
    folder.mkdir(parents=True, exist_ok=True)
    for earlier in ("last", "outcome.json"):
        (folder / earlier).unlink(missing_ok=True)
    outcome, end = Outcome(), time.monotonic() + seconds
    last = LastInput(folder / "last")
    while True:
        seed, left = seed + 1, max(0.0, end - time.monotonic())
        before = outcome.seconds
        process = multiprocessing.get_context("fork").Process(
            target=_process, args=(name, folder, seed, left, outcome, is_guided)
        )
        process.start()
        is_hanging = _wait(process, last)
        if (folder / "broken.txt").exists():
            raise RuntimeError((folder / "broken.txt").read_text())
        if (folder / "outcome.json").exists():
            outcome = Outcome(**json.loads((folder / "outcome.json").read_text()))
            outcome.seconds = round(before + outcome.seconds, 1)
        if process.exitcode == 0:
            return outcome
        key = "it hangs" if is_hanging else f"native crash: {_signal(process.exitcode)}"
        data = last.data()
        key = f"{key} {hashlib.sha256(data).hexdigest()[:6]}"
        keep(folder, key, data, key)
        outcome.findings[key] = key
        outcome.executions = max(outcome.executions, last.number())
        if time.monotonic() > end:
            return outcome


def _processor_time(pid: int) -> float:
    """Processor time of a process, by its own clock in Linux; 0 where it has ended [s]."""
    try:
        return time.clock_gettime((~pid << 3) | PROCESS_CLOCK)
    except OSError:
        return 0.0


def _signal(code: int | None) -> str:
    try:
        return signal.Signals(-(code or 0)).name
    except ValueError:
        return f"exit code {code}"


def _wait(process: Any, last: LastInput) -> bool:
    """Wait for the end of a process; whether it had to be ended, as one input took too long."""
    number, used, since = -1, 0.0, 0.0
    while process.is_alive():
        if last.number() != number:
            number, used, since = last.number(), _processor_time(process.pid), time.monotonic()
        process.join(1.0)
        has_worked = _processor_time(process.pid) > used + LONGEST
        if last.number() == number and (has_worked or time.monotonic() > since + LONGEST_WAIT):
            process.kill()
            process.join()
            return True
    return False


def least_time_first(names: Sequence[str], seconds: float) -> Iterator[str]:
    """The reader with the least time in the record, again and again, until the time is over."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        known = read_records()["readers"]
        yield min(names, key=lambda name: known.get(name, {}).get("seconds", 0))


def main(words: Sequence[str] | None = None) -> int:
    """Run the campaigns, print their counts and write them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("readers", nargs="*", metavar="READER", help=f"of {', '.join(READERS)}")
    parser.add_argument("--minutes", type=float, default=1.0, help="time for each reader")
    parser.add_argument("--total", type=float, help="time for all readers together, in minutes")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--guided", action="store_true", help="by coverage (pip install atheris)")
    parser.add_argument("--folder", type=Path, help="keeps the inputs that ended badly")
    arguments = parser.parse_args(words)
    unknown = [name for name in arguments.readers if name not in READERS]
    if unknown:
        parser.error(f"no reader is called {unknown[0]}; there are {', '.join(READERS)}")
    folder = arguments.folder or Path(tempfile.mkdtemp(prefix="campaign-", dir=MEMORY_DISK))
    worst = 0
    names = arguments.readers or [*READERS]
    order = names if arguments.total is None else least_time_first(names, 60 * arguments.total)
    for number, name in enumerate(order):
        found = campaign(
            name, folder / name, 1000 * (1000 * arguments.seed + number),
            60 * arguments.minutes, is_guided=arguments.guided,
        )  # fmt: skip
        count(name, found, arguments.seed, is_guided=arguments.guided)
        line = f"{name:14} {found.executions:8} executions {found.refused:8} refused"
        line += (
            f" {found.seconds:7.0f} s {found.peak_megabytes:6} MB {len(found.findings):3} findings"
        )
        sys.stdout.write(
            f"{line}\n" + "".join(f"    {key}: {text}\n" for key, text in found.findings.items())
        )
        sys.stdout.flush()
        worst = max(worst, len(found.findings))
    sys.stdout.write(f"inputs that ended badly are in {folder}\n" if worst else "")
    return 1 if worst else 0


if __name__ == "__main__":
    sys.exit(main())
