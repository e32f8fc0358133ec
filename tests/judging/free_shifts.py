"""Shifts that no predicate may notice, by its definition; every other one must be noticed."""

from tests.judging.evidence import collected

FREE = tuple(free for evidence in collected() for free in evidence.free_shifts)


def free_shifts(case, place):
    """Direction and course of the shifts of an array that this case need not notice."""
    field, key = place
    bodies = key if isinstance(key, tuple) else (key,)
    names = {field, *(f"{field} {body}" for body in bodies)}
    return {
        (sign + column.replace("_", " "), course)
        for free in FREE
        if case in free.cases.split(", ") and names & set(free.signals.split(", "))
        for word in free.directions.split()
        for column in [word.lstrip("+-")]
        for sign in word[: len(word) - len(column)]
        for course in free.courses
    }
