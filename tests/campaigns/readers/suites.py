"""Readers of results of suites: shards, conditions, streams, documents and baselines."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from tests.campaigns import mutation
from tests.campaigns.mutation import Random
from tests.campaigns.reader import Read, Reader, of_file, put


@cache
def _suite(folder: Path) -> Path:
    """The report folder of a part of a suite, with its conditions."""
    from tests.damaged.front_door import outcome_of

    folder.mkdir(exist_ok=True)
    file = folder / "part.scenario.yaml"
    file.write_text(
        "scenario: a part\nrobot: open_manipulator_x\nparams: {angle: 0.1}\n"
        "randomize: {angle: {uniform: [0, 0.2]}}\nsamples: 3\n"
        "steps: [{move_to: {joints: {joint1: '${angle}'}}}]\n"
    )
    words = (
        "run",
        file,
        "--no-page",
        "--report-dir",
        folder / "part",
        "--shard",
        "1/1",
        "--in-process",
    )
    _, printed = outcome_of(*words)
    assert (folder / "part" / "results.jsonl").is_file(), printed
    return folder / "part"


def _shards(folder: Path) -> list[bytes]:
    part = _suite(folder / "suite")
    return [path.name.encode() + b":" + path.read_bytes() for path in sorted(part.glob("*.json*"))]


def _mutated_shard(corpus: Sequence[bytes], rng: Random) -> bytes:
    name, _, content = rng.choice(corpus).partition(b":")
    mutate = mutation.of_lines if name.endswith(b".jsonl") else mutation.of_json
    return name + b":" + mutate([content], rng)


def _begin_shard(folder: Path) -> Read:
    import shutil

    from harness.plugins.campaigns.merge import merge_parts

    whole, part = _suite(folder / "suite"), folder / "part"
    shutil.copytree(whole, part, dirs_exist_ok=True)

    def read(folder: Path, data: bytes) -> None:
        name, _, content = data.partition(b":")
        put(part, name.decode(), content)
        try:
            merge_parts([part], folder / "merged")
        finally:
            shutil.copy(whole / name.decode(), part / name.decode())
            shutil.rmtree(folder / "merged", ignore_errors=True)

    return read


def _conditions(folder: Path) -> list[bytes]:
    lines = [{"format": "armharness-conditions/1"}] + [
        {
            "file": "a/part", "name": f"sample={n}", "group": "", "sample": n,
            "overrides": {"params.angle": str(n / 10), "seed": str(n)}, "values": {"angle": n / 10},
        }
        for n in range(4)
    ]  # fmt: skip
    del folder
    return [b"".join(json.dumps(line).encode() + b"\n" for line in lines)]


def _load_conditions(path: Path) -> None:
    from harness.plugins.campaigns.conditions import read_conditions

    conditions = read_conditions(path)  # reads from its file as long as it lives
    list(conditions.cases(Path("a/part.scenario.yaml"), is_alone=True))


def _results(folder: Path) -> list[bytes]:
    part = _suite(folder / "suite")
    return [(part / "results.jsonl").read_bytes()]


def _query(path: Path) -> None:
    """What `harness results` prints and exports of a suite's stream."""
    from harness.plugins.campaigns.queries.database import DATABASE, open_campaign
    from harness.plugins.campaigns.queries.filters import Query
    from harness.plugins.campaigns.queries.table import rows, write_csv

    path.with_name(DATABASE).unlink(missing_ok=True)
    query = Query()
    with open_campaign(path.parent) as database:
        rows(database, query, 20, is_worst_first=True)
        write_csv(database, query, path.with_name("runs.csv"))


def _documents(folder: Path) -> list[bytes]:
    from tests.damaged.front_door import outcome_of

    outcome_of("merge", _suite(folder / "suite"), "--report-dir", folder / "merged")
    return [(folder / "merged/results.json").read_bytes()]


def _gate(path: Path) -> None:
    """What `harness gate` and the page of a suite make of the results of an earlier run."""
    from harness.plugins.ci.baseline import new_margins, shrunk_margins, updated
    from harness.plugins.ci.comment import comment_text
    from harness.plugins.ci.ctrf import ctrf_text
    from harness.plugins.ci.results import read_results
    from harness.reporting.suite.history import history_of

    history_of(path.parent)
    suite = read_results(path.parent)
    ctrf_text(suite, path.parent).encode()
    comment_text(suite, (), path.parent, "").encode()
    margins = updated(suite.cases, {})
    shrunk_margins(suite.cases, margins)
    new_margins(suite.cases, margins)


def _margins(folder: Path) -> list[bytes]:
    del folder
    margins = {"a.scenario.yaml [x=1]": {"always: within_limits": "0.04 rad", "never": "1 1"}}
    return [json.dumps({"format": "armharness-margins/1", "margins": margins}).encode()]


def _read_margins(path: Path) -> None:
    from harness.plugins.ci.baseline import read_baseline, shrunk_margins, write_baseline

    margins = read_baseline(path)
    [str(each) for each in shrunk_margins((), margins)]
    write_baseline(path.with_name("again.json"), margins)


READERS: dict[str, Reader] = {
    "results": Reader(_results, mutation.of_lines, of_file("results.jsonl", _query)),
    "suite": Reader(_documents, mutation.of_json, of_file("results.json", _gate)),
    "baseline": Reader(_margins, mutation.of_json, of_file("margins.json", _read_margins)),
    "shard": Reader(_shards, _mutated_shard, _begin_shard, is_named=True),
    "conditions": Reader(
        _conditions, mutation.of_lines, of_file("conditions.jsonl", _load_conditions)
    ),
}
