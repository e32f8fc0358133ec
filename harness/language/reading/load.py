"""Loads scenarios and worlds: every mistake of a file at once, each at its place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Generic, TypeVar, cast

from pydantic import ValidationError

from harness.core.errors import Problem, SpecError
from harness.core.files import expanded
from harness.core.registry import plugin_hints, registry
from harness.core.resources import data_folder
from harness.core.suggestion import did_you_mean
from harness.language.base import SpecModel
from harness.language.files.source import Loc, Located, Source, SourceMap
from harness.language.files.yaml_file import parse_yaml, read_text, require_key
from harness.language.reading.expansion import with_expansions
from harness.language.reading.overrides import apply_overrides, from_options
from harness.language.reading.params import substitute
from harness.language.reading.partial import PartialReader, Prerequisite
from harness.language.reading.short_forms import models_shape
from harness.language.reading.varied_paths import check_variation, unread_parameters, values_of_case
from harness.language.reading.wording import is_follow_up, problems_of
from harness.language.scenario import Scenario
from harness.language.world import WorldSpec

M = TypeVar("M", bound=SpecModel)

WORLD_SUFFIXES = (".yaml", ".yml")
SDF_SUFFIXES = (".sdf", ".world")
SCENE_SUFFIX = ".scene"


@dataclass(frozen=True, eq=False)
class Loaded(Generic[M]):
    """A file's model, and the way back to the file.

    Attributes:
        lines: The line and column of each field of the model.
        written: The file's values in its own short forms, parameters and overrides applied.
        notes: What the file may say and probably does not intend.
    """

    model: M
    path: Path
    text: str
    lines: SourceMap
    written: Located
    notes: tuple[Problem, ...] = ()


class LoadedScenario(Loaded[Scenario]):
    """A scenario file."""

    @property
    def scenario(self) -> Scenario:
        return self.model

    @property
    def resolved(self) -> dict[str, object]:
        """The file as plain data, parameters and overrides applied."""
        plain = self.written.plain()
        return dict(plain) if isinstance(plain, dict) else {}


@dataclass(frozen=True, eq=False)
class Reading:
    """The result of reading a scenario file.

    Attributes:
        loaded: The scenario; with problems, what remains of it; None when that is too little.
        doubtful: Words of what was left out; a mistake that names one may follow from another.
        missing: `robot` or `world`, where something else stands in for what cannot be read; `arms`,
            where a key of `robot` is unknown, which may have named them.
    """

    loaded: LoadedScenario | None
    problems: tuple[Problem, ...] = ()
    doubtful: frozenset[str] = frozenset()
    missing: frozenset[Prerequisite] = frozenset()


def read_scenario(
    path: Path,
    overrides: Mapping[str, str] | None = None,
    seed: int | None = None,
    text: str | Source | None = None,
) -> Reading:
    """A scenario file with its mistakes, for callers that find more.

    Args:
        overrides: Dotted path -> YAML value, as given with `--set`.
        seed: Taken in place of the file's.
        text: What would stand in the file, or the source of it; None: what does.

    Raises:
        SpecError: The file is not YAML.
    """
    given = dict(overrides or {})
    if seed is not None:
        given["seed"] = str(seed)
    text = read_text(path) if text is None else text
    source = text if isinstance(text, Source) else Source.of_text(str(path), text)
    text = "\n".join(source.own_lines()) if isinstance(text, Source) else text
    problems: list[Problem] = []
    whole = "\n".join(source.lines) if source.others else text
    root = parse_yaml(whole, source, problems)
    of_file = values_of_case(root, given)
    options = {key: value for key, value in given.items() if key not in of_file}
    root = apply_overrides(root, [*of_file.values(), *from_options(options, problems)], problems)
    check_variation(root, given, lambda varied: _problems_of(varied, path), problems)
    notes = unread_parameters(root)
    written = substitute(with_expansions(root, path, problems), problems)
    try:
        model, lines = _model(written, Scenario, problems, notes)
    except _BrokenError as error:
        if error.remains is None:
            return Reading(None, tuple(error.problems))
        loaded = LoadedScenario(error.remains, path, text, error.lines, written, tuple(notes))
        reader = error.reader
        return Reading(
            loaded, tuple(error.problems), frozenset(reader.words), frozenset(reader.missing)
        )
    loaded = LoadedScenario(model, path, text, lines, written, tuple(notes))
    return Reading(loaded, tuple(_unknown_expectation(model, lines)))


def _unknown_expectation(scenario: Scenario, lines: SourceMap) -> Iterator[Problem]:
    """The mistake that `search` names an expectation that does not exist."""
    names = scenario.expectation_names()
    field, name = (scenario.search and scenario.search.expectation()) or ("", "")
    if field and name not in names:
        yield lines.problem(
            ("search", field),
            f"no expectation has the name '{name}'",
            did_you_mean(name, names, "names"),
        )


def _problems_of(root: Located, path: Path) -> list[Problem]:
    """The mistakes of a scenario's values."""
    problems: list[Problem] = []
    written = substitute(with_expansions(root, path, problems), problems)
    try:
        _model(written, Scenario, problems)
    except SpecError as error:
        return error.problems
    return []


def load_scenario(
    path: Path, overrides: Mapping[str, str] | None = None, seed: int | None = None
) -> LoadedScenario:
    """A scenario file, checked as far as it can be without robot and world.

    Args:
        overrides: Dotted path -> YAML value, as given with `--set`.
        seed: Taken in place of the file's.

    Raises:
        SpecError: With every problem of the file and of the overrides.
    """
    return _whole(read_scenario(path, overrides, seed))


def parse_scenario(
    text: str, path: Path, overrides: Mapping[str, str] | None = None
) -> LoadedScenario:
    """Load a scenario as `load_scenario` does, from the text of its file."""
    return _whole(read_scenario(path, overrides, text=text))


def _whole(reading: Reading) -> LoadedScenario:
    if reading.problems or reading.loaded is None:
        raise SpecError(reading.problems)
    return reading.loaded


def load_world(name_or_path: str, base_dir: Path) -> Loaded[WorldSpec]:
    """A bundled world by its name, or a harness world file.

    Args:
        name_or_path: The name or path in a scenario's `world`.
        base_dir: Folder of the scenario file; relative paths begin here.

    Raises:
        SpecError: No such world, or with every problem of its file.
    """
    path = world_path(name_or_path, base_dir)
    try:
        return _read_world(path, read_text(path))
    except _BrokenError:
        raise
    except SpecError as error:
        raise SpecError(_of_world(problem, name_or_path) for problem in error.problems) from error


@lru_cache(maxsize=8)
def _read_world(path: Path, text: str) -> Loaded[WorldSpec]:
    """The world in a text; cases that are forked by this process find the one that it has read."""
    problems: list[Problem] = []
    require_key(text, ("world",), str(path), "world file")
    written = parse_yaml(text, Source.of_text(str(path), text), problems)
    model, lines = _model(written, WorldSpec, problems)
    return Loaded(model, path, text, lines, written)


def bundled_worlds() -> tuple[str, ...]:
    """Names of the worlds that come with the program, sorted."""
    return tuple(sorted(path.stem for path in data_folder("worlds").glob("*.yaml")))


def world_path(name_or_path: str, base_dir: Path) -> Path:
    """The file of a world.

    Raises:
        SpecError: No such world; the problem has no line, which the scenario knows.
    """
    suffix = Path(name_or_path).suffix.lower()
    if suffix == SCENE_SUFFIX:
        hint = f"`harness import scene {name_or_path}` writes it as a world file"
        raise _no_world(name_or_path, "a MoveIt scene is no world yet", hint)
    if suffix in WORLD_SUFFIXES or is_foreign_world(name_or_path):
        return file_path(name_or_path, base_dir)
    names = bundled_worlds()
    if name_or_path in names:
        return data_folder("worlds") / f"{name_or_path}.yaml"
    known, *of_plugin = plugin_hints(name_or_path, names, "world format", "worlds")
    hints = [known, "or the path of a .yaml, .sdf or .xml file", *(of_plugin if suffix else ())]
    raise _no_world(name_or_path, f"no world is called `{name_or_path}`", "; ".join(hints))


def is_foreign_world(name_or_path: str) -> bool:
    """Whether a world is a file of another program: SDF, or of a plug-in's format."""
    suffix = Path(name_or_path).suffix.lower()
    if not suffix or suffix in (*WORLD_SUFFIXES, SCENE_SUFFIX):
        return False
    if suffix in SDF_SUFFIXES:
        return True
    formats = registry("world_format")
    return any(suffix in formats[name].suffixes for name in formats)


def file_path(text: str, base_dir: Path) -> Path:
    """The file that a scenario names, relative to its folder.

    Raises:
        SpecError: A URL, or not a path at all; whether the file is there shows on reading.
    """
    if "://" in text:
        raise _no_world(
            text, f"`{text}` is a URL; only files are read", "save the file next to this one"
        )
    if not text.isprintable():
        raise _no_world(text, f"{text!r} is not a path", "")
    return base_dir / expanded(text) if text.startswith("~") else base_dir / text


class _BrokenError(SpecError):
    """A file has mistakes; carries what remains of it besides.

    Attributes:
        lines: The line and column of each field of the model.
        remains: A model of what could be read; None of a file that is no scenario.
        reader: Knows what was left out of it and replaced.
    """

    def __init__(
        self, problems: list[Problem], lines: SourceMap, remains: Any, reader: PartialReader
    ) -> None:
        super().__init__(problems)
        self.lines, self.remains, self.reader = lines, remains, reader


def _model(
    written: Located, model: type[M], problems: list[Problem], notes: list[Problem] | None = None
) -> tuple[M, SourceMap]:
    """The model of a file's values.

    Raises:
        SpecError: With the problems found before and all that are found here.
    """
    guessed: set[tuple[str, int, int]] = set()
    reader, remains = PartialReader(), None
    lines = SourceMap(models_shape(written, model, problems, notes, guessed, reader))
    data = lines.root.plain()
    try:
        loaded = model.model_validate(data)
    except ValidationError as error:
        known = {(problem.path, problem.line, problem.column) for problem in problems}
        errors = [each for each in error.errors(include_url=False) if not is_follow_up(each)]
        if model is Scenario and isinstance(data, dict):
            places = [each["loc"] for each in errors]
            remains = reader.scenario(cast("dict[str, Any]", data), places)
        errors += reader.broken_rules
        independent = [each for each in errors if not _contains(lines, each["loc"], known)]
        problems += (
            problem
            for problem in problems_of(independent, lines)
            if (problem.path, problem.line, problem.column) not in known | guessed
        )
        raise _BrokenError(problems, lines, remains, reader) from None
    if problems:
        raise _BrokenError(problems, lines, loaded, reader)
    return loaded, lines


def _contains(lines: SourceMap, loc: Loc, known: set[tuple[str, int, int]]) -> bool:
    """Whether a value, or what it is directly made of, has a mistake that is known already."""
    found = lines.find(loc)
    nearby = [found.item]
    for _ in range(2 if found.is_whole else 0):
        nearby += [entry.value for item in nearby for entry in item.mapping().values()]
        nearby += [child for item in nearby for child in item.items()]
    places = [item.place for item in nearby]
    return any((place.source.path, place.line, place.column) in known for place in places)


def _of_world(problem: Problem, name: str) -> Problem:
    """A problem without a line, worded so that it can stand in the scenario's."""
    if problem.line:
        return problem
    return replace(problem, message=f"world `{name}`: {problem.message}")


def _no_world(name: str, message: str, hint: str) -> SpecError:
    return SpecError([Problem(name, 0, 0, message, hint)])
