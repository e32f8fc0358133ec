"""What a text without quotes means: the core schema of YAML 1.2, finite numbers only."""

from __future__ import annotations

import math
import re

from harness.language.files.source import Scalar

LONGEST_NUMBER = 300  # characters

INTEGER = re.compile(r"[-+]?[0-9]+")
BASED = re.compile(r"0o[0-7]+|0x[0-9a-fA-F]+")
FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
BEGINNINGS = frozenset("-+.0123456789")  # of whatever the four match
CONSTANTS: dict[str, Scalar] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}


def is_plain_text(text: str) -> bool:
    """Whether a text without quotes is text: no number, boolean or null."""
    if text in CONSTANTS:
        return False
    patterns = (INTEGER, FLOAT, BASED, NOT_FINITE)
    return text[0] not in BEGINNINGS or not any(each.fullmatch(text) for each in patterns)


def scalar_of(text: str) -> Scalar:
    """The value of a text without quotes.

    Raises:
        OverflowError: A number that is not finite, or has too many digits.
    """
    if is_plain_text(text):
        return text
    if text in CONSTANTS:
        return CONSTANTS[text]
    if NOT_FINITE.fullmatch(text) or len(text) > LONGEST_NUMBER:
        raise OverflowError(text)
    if INTEGER.fullmatch(text):
        return int(text)
    number = int(text, 0) if BASED.fullmatch(text) else float(text)
    if not math.isfinite(number):
        raise OverflowError(text)
    return number
