"""Evaluates the expressions of xacro files: a part of Python's syntax, without Python's objects.

Values are numbers, texts, lists and dictionaries. The syntax tree is interpreted here, so that an
expression reaches nothing but these values and the functions in `functions.py`.
"""

from __future__ import annotations

import ast
import operator
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Protocol, runtime_checkable

from harness.core.suggestion import did_you_mean
from harness.plugins.formats.xacro.functions import (
    METHODS,
    method_of,
    power,
    product,
    remainder,
    shifted,
)
from harness.plugins.formats.xacro.values import (
    Budget,
    ExpressionError,
    Function,
    YamlDict,
    bounded,
    checked_key,
)

LONGEST_EXPRESSION = 4000  # characters; Python's parser needs a stack for nested ones


def inverted(operand: Any) -> Any:
    """`~operand`; of a truth value as of 0 or 1, which Python from 3.12 on does with a warning."""
    return operator.invert(int(operand) if isinstance(operand, bool) else operand)


UNARY: dict[type[ast.unaryop], Callable[[Any], Any]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Not: operator.not_,
    ast.Invert: inverted,
}
BINARY: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: product,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: remainder,
    ast.Pow: power,
    ast.LShift: shifted,
    ast.RShift: operator.rshift,
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.BitXor: operator.xor,
}
COMPARISONS: dict[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
    ast.In: lambda item, items: item in items,
    ast.NotIn: lambda item, items: item not in items,
}
REFUSED: dict[type[ast.expr], str] = {
    ast.Lambda: "`lambda`",
    ast.SetComp: "a set",
    ast.DictComp: "a dictionary comprehension",
    ast.NamedExpr: "`:=`",
    ast.JoinedStr: "an f-string",
    ast.Set: "a set",
    ast.Starred: "`*`",
    ast.Await: "`await`",
    ast.Yield: "`yield`",
    ast.YieldFrom: "`yield`",
}
ALLOWED = (
    "expressions have numbers, text, lists, dictionaries, operators, `a if b else c`, "
    "indices, slices, and calls of functions"
)
UNUSABLE = ("complex", "frozenset", "hash", "isinstance", "issubclass", "set", "type", "vars")
"""Names in xacro's namespace `python` that have no meaning here."""


@runtime_checkable
class Names(Protocol):
    """Names that an expression may use; a namespace is one of their values."""

    def __getitem__(self, name: str) -> Any: ...
    def __contains__(self, name: str) -> bool: ...
    def names(self) -> list[str]:
        """All names."""
        ...


@dataclass(frozen=True)
class Namespace:
    """Functions and constants of xacro itself, such as `math`."""

    contents: Mapping[str, Any]

    def __getitem__(self, name: str) -> Any:
        return self.contents[name]

    def __contains__(self, name: str) -> bool:
        return name in self.contents

    def names(self) -> list[str]:
        """All names."""
        return list(self.contents)


def evaluate(text: str, names: Names, budget: Budget) -> Any:
    """The value of an expression.

    Args:
        text: The expression, without `${` and `}`.
        names: Values of names: properties, functions, constants.
        budget: The steps that are left of the rendering.

    Raises:
        ExpressionError: It has no value; says where, and what is allowed.
        Exhausted: No steps are left.
    """
    budget.spend(len(text))
    stripped = text.strip()
    offset = len(text) - len(text.lstrip())
    try:
        return _Evaluation(names, budget, stripped).value(_parsed(stripped))
    except ExpressionError as error:
        error.start += offset
        raise


@lru_cache(maxsize=4096)
def _parsed(text: str) -> ast.expr:
    if len(text) > LONGEST_EXPRESSION:
        raise ExpressionError(f"an expression has at most {LONGEST_EXPRESSION} characters")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(text, mode="eval").body
    except SyntaxError as error:
        start = max((error.offset or 1) - 1, 0) if error.lineno == 1 else 0
        message = f"not an expression: {error.msg}"
        raise ExpressionError(message, min(start, len(text)), 1) from error
    except (ValueError, MemoryError, RecursionError) as error:
        raise ExpressionError("not an expression that can be read") from error


class _Evaluation:
    """One evaluation of a syntax tree."""

    def __init__(self, names: Names, budget: Budget, text: str) -> None:
        self._names = names
        self._budget = budget
        self._text = text
        self._variables: dict[str, Any] = {}

    def value(self, node: ast.expr) -> Any:
        """The value of a part of the expression; a mistake is located at the smallest part."""
        self._budget.spend(1)
        try:
            return bounded(self._value(node))
        except (ArithmeticError, TypeError, ValueError, LookupError) as error:
            raise self._error(node, str(error) or type(error).__name__) from error

    def _value(self, node: ast.expr) -> Any:
        match node:
            case ast.Constant(value=None | bool() | int() | float() | str() as value):
                return value
            case ast.Name(id=name):
                return self._named(node, name)
            case ast.UnaryOp(op=operation, operand=operand):
                return UNARY[type(operation)](self._data(operand))
            case ast.BinOp(left=left, op=operation, right=right) if type(operation) in BINARY:
                return BINARY[type(operation)](self._data(left), self._data(right))
            case ast.BoolOp(op=operation, values=parts):
                return self._either(parts, is_or=isinstance(operation, ast.Or))
            case ast.Compare(left=left, ops=operations, comparators=others):
                return self._compare(self._data(left), operations, others)
            case ast.IfExp(test=test, body=body, orelse=otherwise):
                return self.value(body if self._data(test) else otherwise)
            case ast.List(elts=items):
                return [self._data(item) for item in items]
            case ast.Tuple(elts=items):
                return tuple(self._data(item) for item in items)
            case ast.Dict(keys=keys, values=values) if None not in keys:
                pairs = zip(keys, values, strict=True)
                return {checked_key(self._data(k)): self._data(v) for k, v in pairs if k}
            case (
                ast.ListComp(elt=item, generators=loops)
                | ast.GeneratorExp(elt=item, generators=loops)
            ):
                return list(self._items(item, loops))
            case ast.Subscript(value=items, slice=index):
                return self._item(items, index)
            case ast.Attribute(value=owner, attr=name):
                return self._attribute(node, self.value(owner), name)
            case ast.Call(func=function, args=arguments, keywords=keywords):
                return self._call(node, self.value(function), arguments, keywords)
            case _:
                word = REFUSED.get(type(node), "this")
                raise self._error(node, f"{word} is not part of xacro's expressions here", ALLOWED)

    def _data(self, node: ast.expr) -> Any:
        """A value that is data, for an operation that goes through all of it."""
        value = self.value(node)
        self._budget.weigh(value)
        return value

    def _named(self, node: ast.expr, name: str) -> Any:
        if name in self._variables:
            return self._variables[name]
        if name in self._names:
            return self._names[name]
        hint = did_you_mean(name, self._names.names(), "names")
        if "python" in self._names and name in self._names["python"]:
            hint = f"write `python.{name}`"
        raise self._error(node, f"name '{name}' is not defined", hint)

    def _items(self, item: ast.expr, loops: list[ast.comprehension]) -> Iterator[Any]:
        """The items of a comprehension; its variables are known in it alone."""
        if not loops:
            yield self._data(item)
            return
        loop, *inner = loops
        if loop.is_async:
            raise self._error(loop.iter, "`async` is not part of xacro's expressions", ALLOWED)
        before = self._variables
        for value in self._data(loop.iter):
            self._variables = {**before, **self._bound(loop.target, value)}
            if all(self._data(test) for test in loop.ifs):
                yield from self._items(item, inner)
        self._variables = before

    def _bound(self, target: ast.expr, value: Any) -> dict[str, Any]:
        """The variables of a loop, which is `for name in` or `for name, name in`."""
        match target:
            case ast.Name(id=name):
                return {name: value}
            case ast.Tuple(elts=parts):
                pairs = zip(parts, value, strict=True)
                return {k: v for part, each in pairs for k, v in self._bound(part, each).items()}
            case _:
                raise self._error(target, "a loop has names for its variables", ALLOWED)

    def _either(self, parts: list[ast.expr], *, is_or: bool) -> Any:
        value: Any = None
        for part in parts:
            value = self._data(part)
            if bool(value) == is_or:
                break
        return value

    def _compare(self, left: Any, operations: list[ast.cmpop], others: list[ast.expr]) -> Any:
        result: Any = True
        for operation, other in zip(operations, others, strict=True):
            right = self._data(other)
            result = COMPARISONS[type(operation)](left, right)
            if not result:
                break
            left = right
        return result

    def _item(self, items: ast.expr, index: ast.expr) -> Any:
        found = self.value(items)
        if isinstance(index, ast.Slice):
            bounds = (index.lower, index.upper, index.step)
            return found[slice(*(None if each is None else self._data(each) for each in bounds))]
        key = self._data(index)
        if isinstance(found, dict):
            if isinstance(found, YamlDict) and isinstance(key, int):
                key = str(key)  # keys of YAML files are text
            if key not in found:
                hint = did_you_mean(str(key), map(str, found), "keys")
                raise self._error(index, f"there is no key '{key}'", hint)
        return found[key]

    def _attribute(self, node: ast.expr, owner: Any, name: str) -> Any:
        if isinstance(owner, Names):
            return self._member(node, owner, name)
        method = method_of(owner, name)
        if method is not None:
            return method
        if isinstance(owner, YamlDict):
            if name in owner:
                return owner[name]
            hint = did_you_mean(name, owner, "keys")
            raise self._error(node, f"the YAML mapping has no key '{name}'", hint)
        known = next((names for kind, names in METHODS.items() if isinstance(owner, kind)), {})
        hint = f"write ['{name}']" if isinstance(owner, dict) else ""
        hint = hint or (did_you_mean(name, known, "methods") if known else "")
        raise self._error(node, f"there is no attribute '{name}' here", hint)

    def _member(self, node: ast.expr, owner: Names, name: str) -> Any:
        if name in owner:
            return owner[name]
        if name in UNUSABLE:
            raise self._error(node, f"'{name}' is not part of xacro's expressions here", ALLOWED)
        hint = did_you_mean(name, owner.names(), "names")
        raise self._error(node, f"name '{name}' is not defined in this namespace", hint)

    def _call(
        self,
        node: ast.expr,
        function: Any,
        arguments: list[ast.expr],
        keywords: list[ast.keyword],
    ) -> Any:
        if not isinstance(function, Function):
            raise self._error(node, "this is called, and is not a function", ALLOWED)
        values = [self._argument(function, each) for each in arguments]
        named = {str(each.arg): self._argument(function, each.value) for each in keywords}
        if any(each.arg is None for each in keywords):
            raise self._error(node, "`**` is not part of xacro's expressions here", ALLOWED)
        try:
            return function.call(*values, **named)
        except ExpressionError as error:
            raise self._error(node, error.message, error.hint) from error

    def _argument(self, function: Function, node: ast.expr) -> Any:
        value = self.value(node)
        if isinstance(value, Function) and function.takes_functions:
            return lambda *values: bounded(value.call(*values))
        self._budget.weigh(value)
        return value

    def _error(self, node: ast.expr, message: str, hint: str = "") -> ExpressionError:
        if node.lineno > 1:
            return ExpressionError(message, hint=hint)
        written = self._text.encode()
        start = len(written[: node.col_offset].decode())
        end = node.end_col_offset if node.end_lineno == 1 else len(written)
        return ExpressionError(message, start, len(written[:end].decode()) - start, hint)
