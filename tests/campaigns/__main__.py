"""All campaigns: every reader, drawn scenarios, and the tests of the promises, long ones included.

python -m tests.campaigns [PATH ...] [--minutes N] [--scenarios N] [--seed S] [--default]

With `--minutes 0 --scenarios 0` only the promises are tested, or those of them at the paths; with
`--default` by the tests that run before each change alone.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree import ElementTree

from docs.generators.reliability import PROMISES
from tests.campaigns import fuzz, generated
from tests.campaigns.records import count_tests


def main() -> int:
    """Run the campaigns one after another; 0 where none has a finding."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("paths", nargs="*", metavar="PATH", help="tests of promises; else all")
    parser.add_argument("--minutes", type=float, default=1.0, help="time for each reader")
    parser.add_argument("--scenarios", type=int, default=200, help="number of drawn scenarios")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--default", action="store_true", help="leave out exhaustive tests")
    arguments = parser.parse_args()
    found = 0
    if arguments.minutes:
        found += fuzz.main(["--minutes", str(arguments.minutes), "--seed", str(arguments.seed)])
    found += generated.run_many(1000 * arguments.seed, arguments.scenarios)
    known = dict.fromkeys(path for _, paths in PROMISES for path in paths)
    if unknown := [path for path in arguments.paths if path not in known]:
        parser.error(f"{unknown[0]} holds no promise; there are {', '.join(known)}")
    paths = arguments.paths or list(known)
    return int(bool(found + keep_promises(paths, is_exhaustive=not arguments.default)))


def keep_promises(paths: Sequence[str], *, is_exhaustive: bool) -> int:
    """Test promises, record how each test ended, and return the exit code of pytest."""
    marked = "nightly or not nightly" if is_exhaustive else "not nightly and not benchmark"
    with TemporaryDirectory() as folder:
        report = Path(folder, "tests.xml")
        done = subprocess.run(
            [sys.executable, "-m", "pytest", "-q", "-m", marked, f"--junitxml={report}", *paths],
            check=False,
        )
        ends = [*_ends(report)] if report.exists() else []
    if done.returncode in (0, 1):  # it was not interrupted
        for path in paths:
            own = Counter(end for file, end in ends if f"{file}/".startswith(f"{path}/"))
            count_tests(path, own, is_exhaustive=is_exhaustive)
    return done.returncode


def _ends(report: Path) -> Iterator[tuple[str, str]]:
    """File and end of each test of a report in JUnit's XML."""
    for case in ElementTree.parse(report).iter("testcase"):
        parts = {part.tag for part in case}
        words = case.get("classname", "").split(".")
        names = [at for at, word in enumerate(words) if word.startswith("test_")]
        file = "/".join(words[: names[0] + 1]) + ".py" if names else "/".join(words)
        end = "failed" if parts & {"failure", "error"} else "skipped" if "skipped" in parts else ""
        yield file, end or "passed"


if __name__ == "__main__":
    sys.exit(main())
