"""The two forms in which robots call the states of a gripper."""

from __future__ import annotations

from collections.abc import Container

FORMS = (("open", "opened"), ("close", "closed"))


def stated_name(word: str, names: Container[str]) -> str:
    """A word as a name that there is: `closed` for `close` where there is no `close`, and so on."""
    if word in names:
        return word
    others = {first: second for pair in FORMS for first, second in (pair, pair[::-1])}
    other = others.get(word, word)
    return other if other in names else word
