"""The search of a reader that coverage guides, with Atheris (libFuzzer for Python).

What is changed is chosen by the mutations of the campaign and those of libFuzzer; inputs that reach
new lines of the readers are changed further. It needs `pip install atheris`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import NoReturn

import atheris

from tests.campaigns.execution import Execution

OWN = 0.5  # share of inputs that the campaign's own mutations change


def search(begin: Callable[[], Execution], folder: Path, seed: int, seconds: float) -> NoReturn:
    """Read inputs until the time is over; libFuzzer ends the process.

    Args:
        begin: Makes the execution; the modules that it imports are instrumented.
        folder: Keeps the inputs that reached something new, from one search to the next.
    """
    with atheris.instrument_imports(include=["harness", "tests.campaigns.readers"]):
        execution = begin()
        found = folder / "reached"
        found.mkdir(exist_ok=True)
        for number, data in enumerate(execution.corpus):
            (found / f"good-{number}").write_bytes(data)

        def mutate(data: bytes, largest: int, chosen: int) -> bytes:
            rng = Random(chosen)
            if rng.random() > OWN or not data:
                name = execution.name_of(data)
                return name + atheris.Mutate(data[len(name) :], largest - len(name))
            others = rng.choices(execution.corpus, k=2)
            return execution.changed([data, data, *others], rng)[:largest]

        size = max(4096, 2 * max(map(len, execution.corpus)))
        options = [f"-max_total_time={max(1, round(seconds))}", f"-seed={seed % 2**31 or 1}"]
        options += [f"-max_len={size}", "-rss_limit_mb=0", "-timeout=86400", "-reload=0"]
        options.append(f"-artifact_prefix={folder}/")
        atheris.Setup([sys.argv[0], *options, str(found)], execution.execute, custom_mutator=mutate)
        atheris.Fuzz()
    raise SystemExit
