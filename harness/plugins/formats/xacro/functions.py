"""Functions and methods that expressions of xacro files may call, with bounded results."""

from __future__ import annotations

import math
import re
import string
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

from harness.plugins.formats.xacro.values import (
    LONGEST_TEXT,
    MOST_BITS,
    MOST_ITEMS,
    Function,
    YamlDict,
    bounded,
    checked_key,
    refuse_large,
)

MOST_COMBINED = 300  # the largest argument of `factorial`: it has 2041 bits
MOST_DIGITS = 400  # of `round`; a float has at most 324 after the point


def power(base: Any, exponent: Any) -> Any:
    """`base ** exponent`."""
    if isinstance(base, int) and isinstance(exponent, int) and exponent > 0:
        refuse_large((base.bit_length() - 1) * exponent, MOST_BITS, "bits")
    return base**exponent


def product(left: Any, right: Any) -> Any:
    """`left * right`, also of a list or text and a number."""
    for item, count in ((left, right), (right, left)):
        if isinstance(item, str | list | tuple) and isinstance(count, int):
            refuse_large(len(item) * count, MOST_ITEMS, "items")
    return left * right


def shifted(number: Any, bits: Any) -> Any:
    """`number << bits`."""
    if isinstance(number, int) and isinstance(bits, int):
        refuse_large(number.bit_length() + bits, MOST_BITS, "bits")
    return number << bits


def remainder(left: Any, right: Any) -> Any:
    """`left % right`; of a text, its placeholders filled in."""
    if isinstance(left, str):
        _refuse_wide(left, left.count("%"), right)
    return left % right


def _format(template: str, *values: Any, **named: Any) -> str:
    """`template.format(...)`; placeholders name a value, and none of its attributes or items."""
    _refuse_wide(template, template.count("{"), (values, named))
    for _, field, spec, _ in string.Formatter().parse(template):
        if not re.fullmatch(r"\w*", field or "") or "{" in (spec or ""):
            raise ValueError(f"'{{{field}}}' in a format: a placeholder is a number or a name")
    return template.format(*values, **named)


def _refuse_wide(template: str, placeholders: int, values: Any) -> None:
    """Refuse a format whose widths, or whose values in all placeholders, make a long text."""
    if "*" in template or re.search(r"\d{4}", template):
        raise ValueError("a format has widths of at most 999 characters, written in it")
    widest = max(map(int, re.findall(r"\d+", template)), default=0)
    refuse_large(placeholders * (widest + len(repr(values))), 10 * LONGEST_TEXT, "characters")


def _replace(text: str, old: str, new: str, count: int = -1) -> str:
    refuse_large(len(text) + text.count(old) * len(new), LONGEST_TEXT, "characters")
    return text.replace(old, new, count)


def _join(separator: str, items: Iterable[str]) -> str:
    texts = list(items)
    total = len(separator) * len(texts) + sum(map(len, texts))
    refuse_large(total, LONGEST_TEXT, "characters")
    return separator.join(texts)


def _padded(method: Callable[..., str], text: str, width: int, *fill: str) -> str:
    refuse_large(width, LONGEST_TEXT, "characters")
    return method(text, width, *fill)


def _range(*bounds: int) -> range:
    return bounded(range(*bounds))


def _round(number: Any, digits: int | None = None) -> Any:
    if digits is not None and abs(digits) > MOST_DIGITS:
        raise ValueError(f"round takes at most {MOST_DIGITS} digits")
    return round(number, digits)


def _dict(pairs: Any = (), /, **named: Any) -> dict[Any, Any]:
    items = pairs.items() if isinstance(pairs, Mapping) else pairs
    return {checked_key(key): value for key, value in items} | named


def _sum(items: Iterable[Any], start: Any = 0) -> Any:
    return _folded(items, start, lambda left, right: left + right)


def _product(items: Iterable[Any], *, start: Any = 1) -> Any:
    return _folded(items, start, product)


def _folded(items: Iterable[Any], value: Any, operation: Callable[[Any, Any], Any]) -> Any:
    if not all(isinstance(item, int | float) for item in (value, *items)):
        raise TypeError("only numbers are added or multiplied here")
    for item in items:
        value = bounded(operation(value, item))
    return value


def _small(function: Callable[..., int], *numbers: int) -> int:
    if max(map(abs, numbers), default=0) > MOST_COMBINED:
        raise ValueError(f"{function.__name__} takes numbers up to {MOST_COMBINED}")
    return function(*numbers)


def dotted(value: Any) -> Any:
    """A value whose dictionaries, at all depths, are read with dots too."""
    if isinstance(value, dict):
        return YamlDict({key: dotted(item) for key, item in value.items()})
    return [dotted(item) for item in value] if isinstance(value, list) else value


def _tokenize(text: str, sep: str = ",; ", skip_empty: bool = True) -> list[str]:
    items = re.split(f"[{re.escape(sep)}]", text) if sep else [text]
    return [item for item in items if item or not skip_empty]


def _named(functions: Mapping[str, Callable[..., Any]]) -> dict[str, Any]:
    return {name: Function(name, function) for name, function in functions.items()}


def _methods(owner: object, names: str) -> dict[str, Callable[..., Any]]:
    return {name: getattr(owner, name) for name in names.split()}


def _lists(function: Callable[..., Iterable[Any]], /, *items: Any, **named: Any) -> list[Any]:
    return list(function(*items, **named))


BUILTINS: dict[str, Any] = {
    **_named(
        {
            "list": list,
            "dict": _dict,
            "len": len,
            "str": str,
            "float": float,
            "int": int,
            "bool": bool,
            "min": min,
            "max": max,
            "round": _round,
            "sorted": sorted,
            "range": _range,
        }
    ),
    "map": Function("map", partial(_lists, map), takes_functions=True),
}
"""Functions of Python that xacro has without a namespace."""

PYTHON: dict[str, Any] = {
    **BUILTINS,
    **_named(
        {
            "abs": abs,
            "all": all,
            "any": any,
            "divmod": divmod,
            "enumerate": partial(_lists, enumerate),
            "ord": ord,
            "repr": repr,
            "reversed": partial(_lists, reversed),
            "sum": _sum,
            "tuple": tuple,
            "zip": partial(_lists, zip),
        }
    ),
    "filter": Function("filter", partial(_lists, filter), takes_functions=True),
}
"""Functions of the namespace `python`."""

MATH: dict[str, Any] = {
    **{name: getattr(math, name) for name in ("e", "inf", "nan", "pi", "tau")},
    **_named(
        {
            **_methods(
                math,
                "acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh degrees dist "
                "erf erfc exp exp2 expm1 fabs floor fmod frexp fsum gamma gcd hypot isclose "
                "isfinite isinf isnan isqrt ldexp lgamma log log10 log1p log2 modf nextafter pow "
                "radians remainder sin sinh sqrt tan tanh trunc ulp",
            ),
            **{
                name: partial(_small, function)
                for name, function in _methods(math, "comb factorial perm").items()
            },
            "prod": _product,
        }
    ),
}
"""Functions and constants of the namespace `math`."""

TEXT_TOOLS = _named({"dotify": dotted, "tokenize": _tokenize})
"""Functions of the namespace `xacro` that need no file."""


METHODS: dict[type, dict[str, Callable[..., Any]]] = {
    str: {
        **_methods(
            str,
            "capitalize casefold count endswith find index isalnum isalpha isdecimal isdigit "
            "isidentifier islower isnumeric isspace istitle isupper lower lstrip partition "
            "removeprefix removesuffix rfind rindex rpartition rsplit rstrip split splitlines "
            "startswith strip swapcase title upper",
        ),
        **{
            name: partial(_padded, method)
            for name, method in _methods(str, "center ljust rjust zfill").items()
        },
        "format": _format,
        "join": _join,
        "replace": _replace,
    },
    dict: {
        **_methods(dict, "copy get"),
        "items": lambda each: list(each.items()),
        "keys": list,
        "values": lambda each: list(each.values()),
    },
    list: _methods(list, "copy count index"),
    tuple: _methods(tuple, "count index"),
    float: _methods(float, "is_integer"),
}
"""Methods that expressions may call, by the type of the value."""


def method_of(value: Any, name: str) -> Function | None:
    """A method of a value; None if there is none that expressions may call."""
    kind = next((kind for kind in METHODS if isinstance(value, kind)), None)
    if kind is None or name not in METHODS[kind]:
        return None
    return Function(name, partial(METHODS[kind][name], value))
