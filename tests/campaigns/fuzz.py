"""Changed files for every reader, as long as there is time; nothing but located errors may come.

    python -m tests.campaigns.fuzz [READER ...] --minutes N --seed S

Each reader is a process of its own, so that a native crash or a hang is a finding and the search
continues. Hypothesis chooses what is changed in good files (see mutation.py). The counts go into
`counts.json`, from which docs/explanation/reliability.md is made.
"""

from __future__ import annotations

import argparse
import fcntl
import hashlib
import json
import multiprocessing
import os
import random
import resource
import signal
import sys
import tempfile
import time
import traceback
import warnings
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import seed as seeded
from hypothesis import strategies as st

from harness.core.errors import HarnessError, SpecError
from tests.campaigns.readers import READERS, Read

MEMORY_DISK = "/dev/shm" if Path("/dev/shm").is_dir() else None
COUNTS = Path(__file__).with_name("counts.json")
EACH = 20  # executions of one example of Hypothesis, which takes 5 ms of its own
FEW = 50  # executions between two counts that are written, and the fewest of a campaign
LONGEST = 120.0  # wall time of one execution that counts as a hang [s]
MEMORY = 8 * 2**30  # address space of a process that reads [bytes]


@dataclass
class Outcome:
    """What the campaign of one reader gave.

    Attributes:
        refused: Executions that ended in a located error.
        findings: Kinds of bad ends, by the place in the program that raised.
    """

    executions: int = 0
    refused: int = 0
    seconds: float = 0.0
    peak_megabytes: int = 0
    findings: dict[str, str] = field(default_factory=dict[str, str])


def run_reader(name: str, folder: Path, seed: int, outcome: Outcome, seconds: float) -> None:
    """Read changed files in this process, a few and for some seconds at least.

    The outcome is written to the folder as it grows, and each file before it is read.
    """
    reader = READERS[name]
    corpus = list(reader.corpus(folder))
    place = folder / "changed"
    place.mkdir(exist_ok=True)
    read = reader.begin(place)
    corpus = [data for data in corpus if is_good(read, place, data)]
    assert corpus, f"no file of {name} is read as it is"
    last = os.open(folder / "last", os.O_CREAT | os.O_RDWR)
    begin, number = time.monotonic(), 0

    def execute(rng: random.Random) -> None:
        data = reader.mutate(corpus, rng)
        os.pwrite(last, data, 0)
        os.ftruncate(last, len(data))
        outcome.executions += 1
        try:
            read_or_refuse(read, place, data, outcome)
        except Exception as error:  # noqa: BLE001 - each other end is a finding
            key = place_of(error)
            if key not in outcome.findings:
                outcome.findings[key] = f"{type(error).__name__}: {error}"[:300]
                keep(folder, key, data, "".join(traceback.format_exception(error)[-12:]))
        if outcome.executions % FEW == 0:
            save(folder, outcome, begin)

    def trial(rng: random.Random) -> None:
        for _ in range(EACH):
            if outcome.executions < FEW or time.monotonic() < begin + seconds:
                execute(rng)

    while outcome.executions < FEW or time.monotonic() < begin + seconds:
        number += 1
        batch = settings(
            max_examples=10,
            deadline=None,
            database=None,
            suppress_health_check=list(HealthCheck),
            phases=(Phase.generate,),
            report_multiple_bugs=False,
        )
        seeded(seed * 10_000 + number)(batch(given(st.randoms(use_true_random=True))(trial)))()
    os.close(last)
    save(folder, outcome, begin)


def read_or_refuse(read: Read, place: Path, data: bytes, outcome: Outcome) -> None:
    """Read a changed file; one that is refused says where the mistake is."""
    try:
        read(place, data)
    except HarnessError as error:
        outcome.refused += 1
        problems = error.problems if isinstance(error, SpecError) else []
        if not str(error) or not all(each.path and str(each) for each in problems):
            raise RuntimeError(f"not located: {error}") from error


def is_good(read: Read, place: Path, data: bytes) -> bool:
    """Whether a file is read before it is changed; some lack files next to them."""
    try:
        read(place, data)
    except HarnessError:
        return False
    return True


def place_of(error: BaseException) -> str:
    """The kind of an error: its type, and the innermost line of the program."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [each for each in frames if f"{os.sep}harness{os.sep}" in each.filename]
    last = (own or frames)[-1]
    return f"{type(error).__name__} at {Path(last.filename).name}:{last.lineno} in {last.name}"


def keep(folder: Path, key: str, data: bytes, shown: str) -> None:
    """Write an input that ended badly next to its traceback."""
    name = hashlib.sha256(key.encode()).hexdigest()[:12]
    (folder / f"finding-{name}").write_bytes(data)
    (folder / f"finding-{name}.txt").write_text(f"{key}\n{shown}", errors="replace")


def save(folder: Path, outcome: Outcome, begin: float) -> None:
    """Write the counts so far."""
    outcome.seconds = round(time.monotonic() - begin, 1)
    outcome.peak_megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
    part = folder / "outcome.part"
    part.write_text(json.dumps(asdict(outcome)))
    part.replace(folder / "outcome.json")


def _process(name: str, folder: Path, seed: int, seconds: float, outcome: Outcome) -> None:
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    warnings.simplefilter("error", RuntimeWarning)  # NumPy's, which a user would see
    nothing = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nothing, stream)
    status = 0
    try:
        run_reader(name, folder, seed, outcome, seconds)
    except BaseException as error:  # noqa: BLE001 - the campaign itself is broken
        (folder / "broken.txt").write_text("".join(traceback.format_exception(error)))
        status = 9
    os._exit(status)


def campaign(name: str, folder: Path, seed: int, seconds: float) -> Outcome:
    """The campaign of one reader, in processes that may crash or hang."""
    folder.mkdir(parents=True, exist_ok=True)
    outcome, end = Outcome(), time.monotonic() + seconds
    while True:
        seed, left = seed + 1, max(0.0, end - time.monotonic())
        before = outcome.seconds
        process = multiprocessing.get_context("fork").Process(
            target=_process, args=(name, folder, seed, left, outcome)
        )
        process.start()
        is_hanging = _wait(process, folder / "last")
        if (folder / "broken.txt").exists():
            raise RuntimeError((folder / "broken.txt").read_text())
        if (folder / "outcome.json").exists():
            outcome = Outcome(**json.loads((folder / "outcome.json").read_text()))
            outcome.seconds = round(before + outcome.seconds, 1)
        if process.exitcode == 0:
            return outcome
        key = "it hangs" if is_hanging else f"native crash: {_signal(process.exitcode)}"
        data = (folder / "last").read_bytes()
        key = f"{key} {hashlib.sha256(data).hexdigest()[:6]}"
        keep(folder, key, data, key)
        outcome.findings[key] = key
        if time.monotonic() > end:
            return outcome


def _signal(code: int | None) -> str:
    try:
        return signal.Signals(-(code or 0)).name
    except ValueError:
        return f"exit code {code}"


def _wait(process: Any, last: Path) -> bool:
    """Wait for the end of a process; whether it had to be ended, as one input took too long."""
    while process.is_alive():
        process.join(1.0)
        if last.exists() and time.time() - last.stat().st_mtime > LONGEST:
            process.kill()
            process.join()
            return True
    return False


def count(name: str, found: Outcome, seed: int) -> None:
    """Write the counts of a campaign next to those of the other readers."""
    with COUNTS.open("a+") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        file.seek(0)
        known = json.loads(file.read() or "{}")
        earlier = known.get(name, {}).get("all_executions", 0)
        known[name] = {
            "executions": found.executions,
            "refused": found.refused,
            "seconds": round(found.seconds),
            "peak_megabytes": found.peak_megabytes,
            "seed": seed,
            "findings": len(found.findings),
            "all_executions": earlier + found.executions,
        }
        file.truncate(0)
        file.write(json.dumps(known, indent=1, sort_keys=True) + "\n")


def main() -> int:
    """Run the campaigns, print their counts and write them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("readers", nargs="*", metavar="READER", help=f"of {', '.join(READERS)}")
    parser.add_argument("--minutes", type=float, default=1.0, help="time for each reader")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--folder", type=Path, help="keeps the inputs that ended badly")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.readers if name not in READERS]
    if unknown:
        parser.error(f"no reader is called {unknown[0]}; there are {', '.join(READERS)}")
    folder = arguments.folder or Path(tempfile.mkdtemp(prefix="campaign-", dir=MEMORY_DISK))
    worst = 0
    for name in arguments.readers or READERS:
        found = campaign(name, folder / name, arguments.seed * 1000, 60 * arguments.minutes)
        count(name, found, arguments.seed)
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
