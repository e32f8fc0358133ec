"""Readers of results of suites: shards and conditions."""

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


READERS: dict[str, Reader] = {
    "shard": Reader(_shards, _mutated_shard, _begin_shard, is_named=True),
    "conditions": Reader(
        _conditions, mutation.of_lines, of_file("conditions.jsonl", _load_conditions)
    ),
}
