"""All campaigns: every reader, drawn scenarios, and the long tests of the promises.

python -m tests.campaigns [--minutes N] [--scenarios N] [--seed S]
"""

from __future__ import annotations

import argparse
import subprocess
import sys

from docs.generators.reliability import PROMISES
from tests.campaigns import fuzz, generated


def main() -> int:
    """Run the campaigns one after another; 0 where none has a finding."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=1.0, help="time for each reader")
    parser.add_argument("--scenarios", type=int, default=200, help="number of drawn scenarios")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    found = fuzz.main(["--minutes", str(arguments.minutes), "--seed", str(arguments.seed)])
    found += generated.run_many(1000 * arguments.seed, arguments.scenarios)
    tests = dict.fromkeys(path for _, paths in PROMISES for path in paths)
    both = "nightly or not nightly"
    done = subprocess.run([sys.executable, "-m", "pytest", "-q", "-m", both, *tests], check=False)
    return int(bool(found or done.returncode))


if __name__ == "__main__":
    sys.exit(main())
