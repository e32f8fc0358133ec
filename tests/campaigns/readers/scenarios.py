"""Readers of scenarios, worlds, overrides, and of the texts that they are made of."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from harness.core.errors import HarnessError, SpecError
from tests.campaigns import mutation
from tests.campaigns.mutation import Random
from tests.campaigns.reader import Read, Reader, bundled, of_data, of_file, text_of


def _short(kind: str, pattern: str) -> list[bytes]:
    """The bundled files that are read fastest, still with nearly every word of the language."""
    return sorted(bundled(kind, pattern), key=len)[:20]


def _load_scenario(path: Path) -> None:
    from harness.language.reading.load import load_scenario

    load_scenario(path)


def _prepare_scenario(path: Path) -> None:
    from harness.session.check import check_file

    for problem in check_file(path).problems:
        assert problem.path, problem


def _header(path: Path) -> None:
    from harness.suite.header import read_header

    header = read_header(path)
    for number, _ in enumerate(header.variation.parametrized()):
        if number > 50:
            break


def _world(path: Path) -> None:
    from harness.language.reading.load import load_world

    load_world(str(path), path.parent)


def _small_scenarios(folder: Path) -> list[bytes]:
    from tests.damaged.test_damaged_bags_and_models import NUMBERS
    from tests.damaged.trials import TINY

    del folder
    return [TINY.encode(), NUMBERS.encode()]


def _overrides(folder: Path) -> list[bytes]:
    del folder
    pairs = [
        ("seed", "3"), ("steps.0.move_to.joints.joint1", "0.1"), ("robot.model", "ur3e"),
        ("expect.1.clearance.at_least", "5 cm"), ("steps.near", "{wait: 1 s}"),
        ("objects.block.mass", "0.2"), ("planning.planner_id", "RRTConnect"),
        ("steps", "[wait: 1 s]"),
    ]  # fmt: skip
    return ["=".join(pair).encode() for pair in pairs]


def _begin_overrides(folder: Path) -> Read:
    from harness.language.reading.load import parse_scenario
    from tests.damaged.trials import TINY

    del folder

    def read(folder: Path, data: bytes) -> None:
        text = data.decode("utf-8", errors="replace")
        path, _, value = text.partition("=")
        parse_scenario(TINY, folder / "tiny.scenario.yaml", {path: value})

    return read


def _mutated_pair(corpus: Sequence[bytes], rng: Random) -> bytes:
    """A path and a value, of which one may be of another pair, or changed."""
    path, value = (rng.choice(corpus).partition(b"=")[part] for part in (0, 2))
    if rng.random() < 0.3:
        path = mutation.of_text([path], rng)
    if rng.random() < 0.7:
        value = mutation.of_text([value], rng)
    return path + b"=" + value


def _begin_paths(_: Path) -> Read:
    """What finds the place of an override in a scenario, and reads its value."""
    from harness.language.files.source import Source
    from harness.language.files.yaml_file import parse_yaml
    from harness.language.reading.overrides import apply_overrides, from_options
    from tests.damaged.trials import TINY

    root = parse_yaml(TINY, Source.of_text("tiny", TINY))

    def read(_: Path, data: bytes) -> None:
        path, _, value = text_of(data).partition("=")
        problems = []
        apply_overrides(root, from_options({path: value}, problems), problems)
        if problems:
            raise SpecError(problems)

    return read


QUANTITIES = (
    "5 cm", "-1.5e-3 m", "90 deg", "pi/2", "2*(pi - 1)", "10 N*m", "0.5 m/s**2", "90 %", "100 rpm",
    "1 rad/s^2", "3 kg", "20 Hz", "1.2 turn", "7 ms", "9.81 m s^-2", "tau", "4 µm", "1 kN",
)  # fmt: skip


def _read_quantity(data: bytes) -> None:
    from harness.language.files.mistakes import MistakeError
    from harness.language.units import MEANINGS, in_si

    text = text_of(data)
    try:
        in_si(text, (sorted(MEANINGS)[len(text) % len(MEANINGS)],))
    except MistakeError as error:
        raise HarnessError(f"{error.message} {error.hint}") from error


def _read_yaml(data: bytes) -> None:
    from harness.language.files.source import Source
    from harness.language.files.yaml_file import parse_yaml

    text = text_of(data)
    parse_yaml(text, Source.of_text("a.yaml", text))


READERS: dict[str, Reader] = {
    "scenario": Reader(
        lambda _: _short("scenarios", "*.scenario.yaml"),
        mutation.of_yaml,
        of_file("a.scenario.yaml", _load_scenario),
    ),
    "check": Reader(
        _small_scenarios, mutation.of_yaml, of_file("a.scenario.yaml", _prepare_scenario)
    ),
    "variation": Reader(
        lambda _: _short("scenarios", "*.scenario.yaml"),
        mutation.of_yaml,
        of_file("a.scenario.yaml", _header),
    ),
    "set": Reader(_overrides, _mutated_pair, _begin_overrides),
    "set path": Reader(_overrides, _mutated_pair, _begin_paths),
    "world": Reader(
        lambda _: bundled("worlds", "*.yaml"), mutation.of_yaml, of_file("a.yaml", _world)
    ),
    "yaml": Reader(_small_scenarios, mutation.of_text, of_data(_read_yaml)),
    "quantity": Reader(
        lambda _: [text.encode() for text in QUANTITIES], mutation.of_text, of_data(_read_quantity)
    ),
}
