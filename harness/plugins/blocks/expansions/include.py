"""Steps from other files: `- include: {file: approach.steps.yaml, params: {height: 0.1}}`.

An included file has `steps`, and `params` with their defaults; it knows no parameters but its own.
Its steps take the place of the `include`, as a `repeat` of one time; with an `id`, theirs get that
name and a dot in front, so that a file can be included more than once.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar, NamedTuple

from harness.core.errors import Problem, SpecError
from harness.core.limits import YAML_VALUES
from harness.core.suggestion import did_you_mean
from harness.language.files.source import Entry, Located, Place, Source, walk
from harness.language.files.yaml_file import parse_yaml, read_text
from harness.language.language import PLACEHOLDER_VERB
from harness.language.reading.expansion import Expansion
from harness.language.reading.params import PARAMS, escaped, filled, mapped
from harness.language.reading.paths import paths_from

INCLUDE = "include"
KEYS = ("description", PARAMS, "steps")
DEEPEST = 10  # levels of files that include each other
PROJECT_MARKS = (".git", "pyproject.toml", "package.xml")  # what a project's folder has one of


class _Context(NamedTuple):
    """Where an include stands: folder of its file, its parameters, the files around it."""

    folder: Path
    params: Mapping[str, Entry]
    around: tuple[Path, ...]

    @property
    def root(self) -> Path:
        """The nearest folder around the file that marks a project, or the file's own."""
        folder = self.around[0].parent.resolve()
        marked = (
            each
            for each in (folder, *folder.parents)
            if any((each / mark).exists() for mark in PROJECT_MARKS)
        )
        return next(marked, folder)


class Include(Expansion):
    """The steps of included files in place of every `include`."""

    name: ClassVar[str] = INCLUDE

    def expand(self, root: Located, path: Path, problems: list[Problem]) -> Located:
        """Read the files that are included.

        Raises:
            SpecError: The files hold more values than a file may have.
        """
        steps = root.mapping().get("steps")
        if steps is None or not any(INCLUDE in item.mapping() for _, item in walk(steps.value)):
            return root
        params = root.mapping().get(PARAMS)
        context = _Context(path.parent, params.value.mapping() if params else {}, (path.resolve(),))
        expander = _Expander(problems)
        expanded = Entry(steps.key, expander.expand(steps.value, context))
        return Located({**root.mapping(), "steps": expanded}, root.place)


class _Expander:
    def __init__(self, problems: list[Problem]) -> None:
        self.problems = problems
        self.count = 0

    def expand(self, item: Located, context: _Context) -> Located:
        if INCLUDE in item.mapping():
            return self._block(item, item.mapping()[INCLUDE], context)
        return mapped(item, lambda child: self.expand(child, context))

    def _block(self, item: Located, include: Entry, context: _Context) -> Located:
        """The step as `repeat: {times: 1, steps: ...}`; the keys next to it stay."""
        place = include.key
        steps = self._steps(filled(include.value, context.params, self.problems), place, context)
        own_id = item.mapping().get("id")
        if own_id is not None and isinstance(own_id.value.value, str):
            steps = _with_prefix(steps, f"{own_id.value.value}.")
        times = Entry(place, Located(1, place))
        block = Located({"times": times, "steps": Entry(place, steps)}, place)
        siblings = {key: entry for key, entry in item.mapping().items() if key != INCLUDE}
        if "name" not in siblings:
            siblings["name"] = Entry(place, Located(_file_of(include.value), place))
        return Located({"repeat": Entry(place, block), **siblings}, item.place)

    def _steps(self, include: Located, place: Place, context: _Context) -> Located:
        """The steps of the file; a stand-in, and a problem, where they cannot be had."""
        nothing = Located([Located(PLACEHOLDER_VERB, place)], place)
        named = include.mapping().get("file") if isinstance(include.value, dict) else None
        file = named.value if named is not None else include
        if not isinstance(file.value, str) or "://" in file.value or not file.value.isprintable():
            message = "`include` names a file: a path from this file"
            self.problems.append(file.place.problem(message, "include: approach.steps.yaml"))
            return nothing
        path = context.folder / file.value
        if not path.resolve().is_relative_to(context.root):
            message = f"'{file.value}' is outside '{context.root}' and is not read"
            hint = "included files stand in the scenario's folder, in its project, or below"
            self.problems.append(file.place.problem(message, hint))
            return nothing
        around = " in ".join(f"'{each.name}'" for each in reversed(context.around))
        if path.resolve() in context.around or len(context.around) > DEEPEST:
            message = f"'{file.value}' is included in itself: it is here in {around}"
            self.problems.append(file.place.problem(message))
            return nothing
        try:
            text = read_text(path)
            root = parse_yaml(text, Source.of_text(str(path), text), self.problems)
        except SpecError as error:
            self.problems += [
                problem
                if problem.line
                else file.place.problem(f"'{file.value}': {problem.message}")
                for problem in error.problems
            ]
            return nothing
        given = include.mapping().get("params")
        params = self._params(root, given.value if given is not None else None, path)
        steps = self._steps_of(root, file)
        if steps is None:
            return nothing
        self._bound(steps, file)
        inner = _Context(path.parent, params, (*context.around, path.resolve()))
        ready = escaped(filled(self.expand(steps, inner), params, self.problems))
        return paths_from(ready, path.parent, context.folder)

    def _steps_of(self, root: Located, file: Located) -> Located | None:
        for key, entry in root.mapping().items():
            if key not in KEYS:
                hint = did_you_mean(key, KEYS, "keys")
                if key == "scenario":
                    hint = "an included file has steps alone: no robot, no world"
                self.problems.append(entry.key.problem(f"unknown key `{key}`", hint))
        steps = root.mapping().get("steps")
        if steps is None or not steps.value.items():
            message = f"'{file.value}' has no list of `steps`"
            self.problems.append(file.place.problem(message))
            return None
        return steps.value

    def _params(self, root: Located, given: Located | None, path: Path) -> dict[str, Entry]:
        own = root.mapping().get(PARAMS)
        params = dict(own.value.mapping()) if own is not None else {}
        for name, entry in (given.mapping() if given is not None else {}).items():
            if name not in params:
                message = f"'{path.name}' has no parameter `{name}`"
                hint = did_you_mean(name, params, "its params")
                self.problems.append(entry.key.problem(message, hint))
            else:
                params[name] = entry
        return params

    def _bound(self, steps: Located, file: Located) -> None:
        self.count += sum(1 for _ in walk(steps))
        if self.count > YAML_VALUES:
            message = f"the included files hold more than {YAML_VALUES} values"
            raise SpecError([file.place.problem(message)])


def _file_of(include: Located) -> str:
    """What the include calls its file, for people."""
    file = include.mapping().get("file")
    return str((file.value if file is not None else include).value)


def _with_prefix(steps: Located, prefix: str) -> Located:
    """The steps with longer ids, and what refers to them under `during` alike."""
    ids = {
        item.value
        for loc, item in walk(steps)
        if loc and loc[-1] == "id" and isinstance(item.value, str)
    }

    def renamed(item: Located, key: str) -> Located:
        if isinstance(item.value, list):
            return Located([renamed(each, "") for each in item.value], item.place)
        if isinstance(item.value, dict):
            entries = {
                name: Entry(entry.key, renamed(entry.value, name))
                for name, entry in item.value.items()
            }
            return Located(entries, item.place)
        if key in ("id", "during") and item.value in ids:
            return Located(f"{prefix}{item.value}", item.place)
        return item

    return renamed(steps, "")
