"""Conditions on runs: what `--where friction<0.4` and the other options of a query mean."""

from __future__ import annotations

import re
import sqlite3
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from harness.core.quantity import split_quantity
from harness.core.suggestion import did_you_mean
from harness.language.units import conversion_factor
from harness.suite.discovery import UsageError

CONDITION = re.compile(r"\s*(.+?)\s*(<=|>=|!=|<|>|=)\s*(.+?)\s*")
MARGIN = "margin"
COLUMNS = {"margin": "margin", "share": "share", "seed": "seed", "sim_time": "sim_time"}
"""Numbers of a run itself that a condition may name, and their columns."""


@dataclass(frozen=True)
class Query:
    """Which runs are selected.

    Attributes:
        outcome: The outcome of the runs; empty for every outcome.
        tags: Tags that the runs have.
        cause: Part of the cause of a failure; empty for every cause.
        conditions: Conditions such as `friction<0.4` or `margin<1 mm`, which all hold.
    """

    outcome: str = ""
    tags: Sequence[str] = ()
    cause: str = ""
    conditions: Sequence[str] = ()


def sql_of(query: Query, connection: sqlite3.Connection) -> tuple[str, list[Any]]:
    """The WHERE clause over `runs`, with its values.

    Raises:
        UsageError: A condition cannot be read, or names a parameter or tag that no run has.
    """
    clauses, values = ["1"], list[Any]()
    if query.outcome:
        clauses.append("outcome = ?")
        values.append(query.outcome)
    for tag in query.tags:
        known = [row[0] for row in connection.execute("SELECT DISTINCT tag FROM tags")]
        if tag not in known:
            raise UsageError(f"--tag '{tag}': no run has it; {did_you_mean(tag, known, 'tags')}")
        clauses.append("key IN (SELECT key FROM tags WHERE tag = ?)")
        values.append(tag)
    if query.cause:
        clauses.append("instr(lower(cause || ' ' || reason), lower(?)) > 0")
        values.append(query.cause)
    for condition in query.conditions:
        clause, more = _condition(condition, connection)
        clauses.append(clause)
        values += more
    return " AND ".join(clauses), values


def parameter_paths(connection: sqlite3.Connection) -> list[str]:
    """Every parameter that varies in some run."""
    return [
        row[0] for row in connection.execute("SELECT DISTINCT path FROM parameters ORDER BY path")
    ]


def _condition(text: str, connection: sqlite3.Connection) -> tuple[str, list[Any]]:
    match = CONDITION.fullmatch(text)
    if match is None:
        raise UsageError(f"--where '{text}': write NAME<VALUE, such as friction<0.4 or margin<0")
    name, operator, written = match.groups()
    try:
        number, unit = split_quantity(written)
    except ValueError:
        number, unit = None, ""
    if name in COLUMNS:
        if number is None:
            raise UsageError(f"--where '{text}': '{written}' is not a number")
        if name == MARGIN and unit:
            return _margin_condition(text, operator, number, unit, connection)
        return f"{COLUMNS[name]} {operator} ?", [number]
    paths = parameter_paths(connection)
    if name not in paths:
        hint = did_you_mean(name, [*paths, *COLUMNS], "names")
        raise UsageError(f"--where '{text}': nothing called '{name}' varies; {hint}")
    inside = "key IN (SELECT key FROM parameters WHERE path = ? AND"
    if number is None:
        if operator not in ("=", "!="):
            raise UsageError(f"--where '{text}': '{written}' is not a number")
        return f"{inside} text {operator} ?)", [name, written]
    clauses, values = list[str](), list[Any]()
    found = connection.execute(
        "SELECT DISTINCT unit FROM parameters WHERE path = ? AND unit IS NOT NULL", (name,)
    )
    units = [row[0] for row in found]
    if not unit and len(units) > 1 and "" not in units:
        raise UsageError(f"--where '{text}': '{name}' has the units {', '.join(units)}; name one")
    for stored in units:
        is_own_unit = not unit and len(units) == 1
        factor = 1.0 if is_own_unit else conversion_factor(unit, stored)
        if factor is None:
            raise UsageError(f"--where '{text}': '{name}' has the unit '{stored}'")
        clauses.append(f"(unit = ? AND number {operator} ?)")
        values += [stored, float(f"{number * factor:.15g}")]
    return f"{inside} ({' OR '.join(clauses or ['0'])}))", [name, *values]


def _margin_condition(
    text: str, operator: str, number: float, unit: str, connection: sqlite3.Connection
) -> tuple[str, list[Any]]:
    """A condition on margins of the same kind of unit; other margins do not fulfil it."""
    clauses, values = list[str](), list[Any]()
    for (stored,) in connection.execute("SELECT DISTINCT unit FROM runs WHERE unit IS NOT NULL"):
        factor = conversion_factor(unit, stored)
        if factor is not None:
            clauses.append(f"(unit = ? AND margin {operator} ?)")
            values += [stored, number * factor]
    if not clauses:
        raise UsageError(f"--where '{text}': no margin has a unit like '{unit}'")
    return f"({' OR '.join(clauses)})", values
