"""Scenarios drawn from the JSON Schema: any step and any expectation, with names that exist.

By hand, many of them: `python -m tests.campaigns.generated FIRST COUNT`.
"""

from __future__ import annotations

import json
import random
import sys
import tempfile
from collections import Counter
from functools import cache
from pathlib import Path
from typing import Any

from harness.core.errors import SpecError
from harness.core.resources import data_folder
from harness.language.reading.load import parse_scenario
from harness.recording.read_run import read_run
from harness.session.check import check_file
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest
from tests.campaigns.cells import CELLS, Cell
from tests.campaigns.invariants import assert_invariants
from tests.campaigns.records import count_scenarios

NUMBERS = (0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, -0.05, -0.1, 10)
LEFT_OUT = ("external", "include")
"""Steps that need nodes or files."""
SIZES = {"times": (1, 2), "seconds": (0.01,), "duration": (0.01, 0.02), "timeout": (0.05,)}
ROUNDS = 4  # checks, after each of which what is refused is left out
BEGUN = 0.6  # share of scenarios that begin with steps that make sense in their cell
TRIES = 60  # draws of a step until the language takes one
CODES = ("passed", "failed")


@cache
def schema() -> Any:
    """The schema of scenario files."""
    return json.loads((data_folder("scenarios") / "scenario.schema.json").read_text())


class Drawer:
    """Values of a part of the schema."""

    def __init__(self, rng: random.Random, cell: Cell) -> None:
        self._rng, self._cell = rng, cell

    def of(self, part: dict[str, Any], key: str = "", depth: int = 0) -> Any:
        """A value that a part of the schema allows, mostly."""
        rng = self._rng
        if "$ref" in part:
            return self.of(schema()["$defs"][part["$ref"].rpartition("/")[2]], key, depth)
        for word in ("allOf", "anyOf", "oneOf"):
            if word in part:
                options = [each for each in part[word] if "${" not in each.get("pattern", "")]
                options = [each for each in options if "pattern" not in each] or options
                return self.of(rng.choice(options or part[word]), key, depth)
        if "const" in part:
            return part["const"]
        if "enum" in part:
            return rng.choice(part["enum"])
        return getattr(self, f"_{part.get('type', 'null')}", self._null)(part, key, depth)

    def _object(self, part: dict[str, Any], key: str, depth: int) -> dict[str, Any]:
        rng, known = self._rng, part.get("properties", {})
        chosen = set(part.get("required", ()))
        share = 0.15 if depth > 1 else 0.3
        chosen |= {name for name in known if rng.random() < share}
        chosen -= {"expect", "expect_error", "steps"} if depth > 2 else set()
        if not chosen and known:
            chosen = {rng.choice(sorted(known))}
        if not known and isinstance(part.get("additionalProperties"), dict):
            name = rng.choice(self._names(key))
            return {name: self.of(part["additionalProperties"], name, depth + 1)}
        return {
            name: self.of(known[name], name, depth + 1) for name in sorted(chosen) if name in known
        }

    def _array(self, part: dict[str, Any], key: str, depth: int) -> list[Any]:
        least = part.get("minItems", 1)
        count = min(part.get("maxItems", 3), max(least, self._rng.choice((1, 1, 2))))
        items = part.get("prefixItems") or [part.get("items", {"type": "number"})]
        return [self.of(items[min(n, len(items) - 1)], key, depth + 1) for n in range(count)]

    def _number(self, part: dict[str, Any], key: str, depth: int) -> float:
        del depth
        low = part.get("minimum", part.get("exclusiveMinimum", -1e9))
        high = part.get("maximum", part.get("exclusiveMaximum", 1e9))
        fit = [n for n in SIZES.get(key, NUMBERS) if low <= n <= high] or [low]
        if "exclusiveMinimum" in part:
            fit = [n for n in fit if n > low] or [low + 0.01]
        return self._rng.choice(fit)

    def _integer(self, part: dict[str, Any], key: str, depth: int) -> int:
        return max(round(self._number(part, key, depth)), part.get("minimum", 0))

    def _string(self, part: dict[str, Any], key: str, depth: int) -> str:
        del part, depth
        return self._rng.choice(self._names(key))

    def _names(self, key: str) -> tuple[str, ...]:
        return self._cell.names.get(key, self._cell.any_name)

    def _boolean(self, *_: object) -> bool:
        return self._rng.random() < 0.5

    def _null(self, *_: object) -> None:
        return None


def _words(name: str) -> dict[str, Any]:
    """The steps or the expectations of the schema, by their words."""
    [part, *_] = schema()["$defs"][name]["anyOf"]
    common = {"id", "expect", "expect_error", "planning", "during", "points", "name"}
    return {
        word: about
        for word, about in part["properties"].items()
        if word not in (*common, *LEFT_OUT) and "allOf" in about
    }


def is_read(document: dict[str, Any]) -> bool:
    """Whether the language takes a scenario."""
    try:
        parse_scenario(json.dumps(document), Path("drawn.scenario.yaml"))
    except SpecError:
        return False
    return True


def cell_of(seed: int) -> Cell:
    """The cell of a drawn scenario."""
    return list(CELLS.values())[seed % len(CELLS)]


def drawn_scenario(seed: int) -> dict[str, Any]:
    """A scenario of one to six steps and up to two expectations that the language takes."""
    rng, cell = random.Random(seed), cell_of(seed)
    drawer = Drawer(rng, cell)
    chosen: list[Any] = list(rng.choice(cell.begins)) if rng.random() < BEGUN else []
    steps = _words("Step")
    for verb in rng.sample(sorted(steps), rng.randint(1, 4)):
        for _ in range(TRIES):
            step = {verb: drawer.of(steps[verb], verb)}
            if "robots" in cell.head and rng.random() < 0.5:
                step["robot"] = rng.choice(cell.names["robot"])
            if is_read({**cell.head, "steps": [*chosen, step]}):
                chosen.append(step)
                break
    document = {**cell.head, "steps": chosen or [{"wait": 0.01}]}
    predicates = _words("Expectation")
    expected: list[Any] = []
    for word in rng.sample(sorted(predicates), 2):
        for _ in range(TRIES):
            one = {word: drawer.of(predicates[word], word)}
            if is_read({**document, "expect": [*expected, one]}):
                expected.append(one)
                break
    return {**document, **({"expect": expected} if expected else {})}


def written(document: dict[str, Any], file: Path) -> dict[int, tuple[str, int]]:
    """Write a scenario with a line for each step and expectation; which line is whose."""
    head = {key: value for key, value in document.items() if key not in ("steps", "expect")}
    lines = [f"{key}: {json.dumps(value)}" for key, value in head.items()]
    places: dict[int, tuple[str, int]] = {}
    for part in ("steps", "expect"):
        items = document.get(part) or []
        lines.append(f"{part}:" if items else f"{part}: []")
        for number, item in enumerate(items):
            lines.append(f"  - {json.dumps(item)}")
            places[len(lines)] = part, number
    file.write_text("\n".join(lines) + "\n")
    return places


def accepted(document: dict[str, Any], file: Path) -> dict[str, Any] | None:
    """Write a scenario without what `check` refuses; None where something is refused again."""
    for _ in range(ROUNDS):
        lines = written(document, file)
        problems = check_file(file).problems
        assert all(problem.path and problem.message for problem in problems)
        wrong = {lines.get(problem.line) for problem in problems}
        if not wrong:
            return document
        for part in ("steps", "expect"):
            kept = [each for n, each in enumerate(document.get(part, ())) if (part, n) not in wrong]
            document[part] = kept or [{"wait": 0.01}] if part == "steps" else kept
    return None


def ends_well(seed: int, folder: Path) -> tuple[str, set[str]]:
    """How a drawn scenario ends, and its words; one that is run is run twice.

    Raises:
        AssertionError: It ended in an error, an invariant does not hold, or the second run has
            another digest.
    """
    file, report = folder / f"{seed}.scenario.yaml", folder / f"{seed}"
    document = accepted(drawn_scenario(seed), file)
    if document is None:
        return "refused", set()
    words = {
        word for part in ("steps", "expect") for each in document.get(part, ()) for word in each
    }
    first, second = (
        run_case(RunRequest(file, page=False, stills=False, report_dir=place))
        for place in (report, None)
    )
    assert first.outcome in CODES, (seed, first.message, document)
    assert_invariants(read_run(report).run)
    assert first.digest == second.digest, (seed, document)
    return first.outcome, words


def run_many(first: int, count: int) -> int:
    """Print how many drawn scenarios ended how, and every bad end."""
    ends: Counter[str] = Counter()
    seen: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as place:
        for seed in range(first, first + count):
            try:
                end, words = ends_well(seed, Path(place))
            except Exception as error:  # noqa: BLE001 - every kind of bad end is counted
                end, words = "bad", set()
                sys.stdout.write(f"=== {seed}: {type(error).__name__}: {error}\n")
                sys.stdout.flush()
            ends[end] += 1
            if end in CODES:
                seen.update(words)
    sys.stdout.write(f"{dict(ends)}\nwords that were run: {dict(seen)}\n")
    count_scenarios(ends)
    return ends["bad"]


if __name__ == "__main__":
    sys.exit(run_many(int(sys.argv[1]), int(sys.argv[2])) > 0)
