"""Conditions on runs: what `--where friction<0.4` and the other options of a query mean."""

from __future__ import annotations

import re
import sqlite3
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from harness.core.quantity import split_quantity
from harness.core.suggestion import did_you_mean
from harness.plugins.campaigns.conversion import conversion_factor
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
        try:
            clause, more = _condition(condition, connection)
        except ValueError as error:
            raise UsageError(f"--where '{condition}': {error}") from None
        clauses.append(clause)
        values += more
    return " AND ".join(clauses), values


def parameter_paths(connection: sqlite3.Connection) -> list[str]:
    """Every parameter that varies in some run."""
    return [
        row[0] for row in connection.execute("SELECT DISTINCT path FROM parameters ORDER BY path")
    ]


Clause = tuple[str, list[Any]]  # a part of a WHERE clause, and its values


def _condition(text: str, connection: sqlite3.Connection) -> Clause:
    """The clause of a condition.

    Raises:
        ValueError: It cannot be read, or names nothing that varies.
    """
    match = CONDITION.fullmatch(text)
    if match is None:
        raise ValueError("write NAME<VALUE, such as friction<0.4 or margin<0")
    name, operator, written = match.groups()
    if name not in COLUMNS:
        return _parameter_clause(name, operator, written, connection)
    number, unit = _number(written)
    if name == MARGIN and unit:
        return _margin_clause(operator, number, unit, connection)
    return f"{COLUMNS[name]} {operator} ?", [number]


def _number(written: str) -> tuple[float, str]:
    try:
        return split_quantity(written)
    except ValueError:
        raise ValueError(f"'{written}' is not a number") from None


def _parameter_clause(
    name: str, operator: str, written: str, connection: sqlite3.Connection
) -> Clause:
    """A condition on a parameter: a text that is equal or not, or a number in every unit of it."""
    paths = parameter_paths(connection)
    if name not in paths:
        hint = did_you_mean(name, [*paths, *COLUMNS], "names")
        raise ValueError(f"nothing called '{name}' varies; {hint}")
    inside = "key IN (SELECT key FROM parameters WHERE path = ? AND"
    try:
        number, unit = _number(written)
    except ValueError:
        if operator not in ("=", "!="):
            raise
        return f"{inside} text {operator} ?)", [name, written]
    found = connection.execute(
        "SELECT DISTINCT unit FROM parameters WHERE path = ? AND unit IS NOT NULL", (name,)
    )
    units = [row[0] for row in found]
    if not unit and len(units) > 1 and "" not in units:
        raise ValueError(f"'{name}' has the units {', '.join(units)}; name one")
    if not unit and len(units) == 1:
        unit = units[0]
    numbers: dict[str, float] = {}
    for stored in units:
        factor = conversion_factor(unit, stored)
        if factor is None:
            raise ValueError(f"'{name}' has the unit '{stored}'")
        numbers[stored] = float(f"{number * factor:.15g}")
    clause, values = _in_units("number", operator, numbers)
    return f"{inside} {clause})", [name, *values]


def _margin_clause(
    operator: str, number: float, unit: str, connection: sqlite3.Connection
) -> Clause:
    """A condition on margins of the same kind of unit; other margins do not fulfil it."""
    found = connection.execute("SELECT DISTINCT unit FROM runs WHERE unit IS NOT NULL")
    factors = {stored: conversion_factor(unit, stored) for (stored,) in found}
    numbers = {unit: number * factor for unit, factor in factors.items() if factor is not None}
    if not numbers:
        raise ValueError(f"no margin has a unit like '{unit}'")
    return _in_units("margin", operator, numbers)


def _in_units(column: str, operator: str, numbers: Mapping[str, float]) -> Clause:
    """A comparison with a number for each unit; it holds for none where there is no unit."""
    clauses = [f"(unit = ? AND {column} {operator} ?)"] * len(numbers)
    values = [value for pair in numbers.items() for value in pair]
    return f"({' OR '.join(clauses or ['0'])})", values
