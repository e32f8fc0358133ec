"""One-operator mutants of the code that decides a verdict, drawn at random."""

from __future__ import annotations

import ast
import difflib
import random
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

# What a verdict depends on: the predicates and what they share, what is measured on a finished run,
# the verification of motions, the digest, and the engine that executes the steps.
SCOPE = (
    "harness/judging",
    "harness/expectations",
    "harness/session/observation",
    "harness/planning/verification",
    "harness/recording/digest.py",
    "harness/session",
    "harness/plugins/arms",
    "harness/plugins/cameras/expectations",
    "harness/plugins/faults/observers",
    "harness/plugins/objects",
    "harness/plugins/paths",
    "harness/plugins/remarks",
)


@dataclass(frozen=True)
class Mutant:
    """A module in which one operator, number, name or keyword is another one."""

    module: str
    line: int
    operator: str
    source: str

    def difference(self, original: str) -> tuple[str, str]:
        """The line as it is and as it is mutated, without leading spaces."""
        changed = difflib.ndiff(original.splitlines(), self.source.splitlines())
        lines = [line for line in changed if line[:2] in ("- ", "+ ") and line[2:].strip()]
        before = next((line[2:].strip() for line in lines if line[0] == "-"), "")
        after = next((line[2:].strip() for line in lines if line[0] == "+"), "")
        return before, after


def modules(root: Path) -> list[Path]:
    """Every module of the scope."""
    found = []
    for entry in SCOPE:
        path = root / entry
        found += [path] if path.is_file() else sorted(path.rglob("*.py"))
    return found


def draw(root: Path, count: int, seed: int) -> list[Mutant]:
    """Random mutants, each at a place of its own; every place is equally likely."""
    places = [place for module in modules(root) for place in places_of(module)]
    source = random.Random(seed)
    drawn = source.sample(places, min(count, len(places)))
    return [made(root, *place, source) for place in drawn]


def places_of(module: Path) -> list[tuple[Path, int, tuple]]:
    """The places of a module where a mutation is possible, with the mutations possible there.

    Docstrings and what `idle_spans` lists are left out.
    """
    from cosmic_ray import plugins
    from cosmic_ray.ast import ast_nodes, get_ast_from_path

    idle = idle_spans(module.read_text(encoding="utf-8"))
    nodes = list(ast_nodes(get_ast_from_path(module)))
    found = defaultdict(list)
    for name in plugins.operator_names():
        kind = plugins.get_operator(name)
        if kind.arguments():
            continue
        positions = [start for node in nodes for start, _ in kind().mutation_positions(node)]
        for occurrence, start in enumerate(positions):
            if not any(first <= start <= last for first, last in idle):
                found[start].append((name, occurrence))
    return [(module, start[0], tuple(those)) for start, those in sorted(found.items())]


def idle_spans(source: str) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Spans that decide nothing, (line, column) of their first and last character.

    Nothing executes annotations. `strict`, `frozen` and `eq` forbid what no caller does: to join
    rows of different lengths, to change a record, to compare two.
    """
    nodes: list[ast.AST | None] = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.AnnAssign | ast.arg):
            nodes.append(node.annotation)
        elif isinstance(node, ast.FunctionDef):
            nodes.append(node.returns)
        elif isinstance(node, ast.keyword) and node.arg in ("strict", "frozen", "eq"):
            nodes.append(node.value)
        elif isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING":
            nodes.append(node)
    return [
        ((node.lineno, node.col_offset), (node.end_lineno, node.end_col_offset))
        for node in nodes
        if node is not None
    ]


def made(root: Path, module: Path, line: int, possible: tuple, source: random.Random) -> Mutant:
    """One of the mutations that are possible at a place."""
    from cosmic_ray import mutating, plugins

    name, occurrence = source.choice(possible)
    text = module.read_text(encoding="utf-8")
    mutated = mutating.mutate_code(text, plugins.get_operator(name)(), occurrence)
    return Mutant(str(module.relative_to(root)), line, name, mutated)
