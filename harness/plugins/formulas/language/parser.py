"""Reads a formula's text into its nodes by precedence climbing."""

from __future__ import annotations

from typing import Literal

from harness.core.suggestion import did_you_mean
from harness.language.base import LARGEST_NUMBER
from harness.plugins.formulas.language.formula import (
    FUNCTIONS,
    SIGNALS,
    UNITS,
    WHOLE,
    Arithmetic,
    Comparison,
    Const,
    Interval,
    Kind,
    Logic,
    Node,
    Number,
    Signal,
    Temporal,
    mixed_units,
)
from harness.plugins.formulas.language.text import WORDS, FormulaError, Token, tokens_of

LONGEST = 2000
DEEPEST = 60
BINDING = {
    **{"implies": 1, "or": 2, "and": 3, "until": 4},
    **dict.fromkeys(("<", "<=", ">", ">="), 6),
    **{"+": 7, "-": 7, "*": 8, "/": 8},
}
PREFIX = 5
SIGN = 9
SAME_KIND = "both sides must be of one kind"
_CONNECT = "join formulas with and, or, implies, until"
_LISTED = f"signals: {', '.join(SIGNALS)}"


def parse_formula(text: str) -> Node:
    """The formula of a text.

    Raises:
        FormulaError: With the place in the text, what is wrong and what to do.
    """
    if len(text) > LONGEST:
        raise FormulaError(
            0, 1, f"a formula has {LONGEST} characters at most; this has {len(text)}"
        )
    return _Parser(text).whole()


def readable(text: str) -> str:
    """The same text, if it is a formula; for models.

    Raises:
        FormulaError: It is none.
    """
    parse_formula(text)
    return text


class _Parser:
    """Goes over the tokens once; every node knows whether it is a number or a formula."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = tokens_of(text)
        self.place = 0
        self.depth = 0

    @property
    def token(self) -> Token:
        return self.tokens[self.place]

    def at(self, *texts: str) -> bool:
        return self.token.kind in ("symbol", "word") and self.token.text in texts

    def take(self) -> Token:
        token = self.token
        self.place += token.kind != "end"
        return token

    def whole(self) -> Node:
        node = self.formula(self.expression(0), self.tokens[0])
        if self.token.kind != "end":
            raise self.wrong(self.token, f"`{self.token.source}` cannot stand here", _CONNECT)
        for start, left, right in mixed_units(node, {}):
            raise FormulaError(start, 1, f"the formula joins {left} and {right}", SAME_KIND)
        return node

    def wrong(self, token: Token, message: str, hint: str = "") -> FormulaError:
        if token.kind == "end":
            message = f"the formula ends too early: {message}"
        return FormulaError(token.start, len(token.source), message, hint)

    def expect(self, symbol: str, why: str) -> Token:
        if not self.at(symbol):
            raise self.wrong(self.token, f"`{symbol}` is missing {why}")
        return self.take()

    def formula(self, node: Node | Number, token: Token) -> Node:
        if isinstance(node, Const | Signal | Arithmetic):
            raise FormulaError(
                node.start, len(token.source), "here is a number; a formula is needed",
                "compare it with another number: `z(box) > 5 cm`",
            )  # fmt: skip
        return node

    def number(self, node: Node | Number, token: Token) -> Number:
        if isinstance(node, Comparison | Logic | Temporal):
            raise self.wrong(token, "here is a formula; a number is needed")
        return node

    # -- expressions --------------------------------------------------------------------------

    def expression(self, least: int) -> Node | Number:
        self.depth += 1
        if self.depth > DEEPEST:
            raise self.wrong(
                self.token, f"nested more than {DEEPEST} deep", "say less in one formula"
            )
        first = self.token
        node = self.operand()
        while BINDING.get(self.token.text, -1) >= least and self.token.kind in ("symbol", "word"):
            node = self.joined(node, first)
        self.depth -= 1
        return node

    def joined(self, left: Node | Number, first: Token) -> Node | Number:
        operator = self.take()
        binding = BINDING[operator.text]
        interval = self.interval() if operator.text == "until" else WHOLE
        second = self.token
        right = self.expression(binding + (operator.text != "implies"))
        match operator.text:
            case "and" | "or" | "implies" as word:
                operands = (self.formula(left, first), self.formula(right, second))
                return Logic(word, operands, operator.start)
            case "until":
                operands = (self.formula(left, first), self.formula(right, second))
                return Temporal("until", operands, interval, operator.start)
            case "<" | "<=" | ">" | ">=" as sign:
                numbers = self.number(left, first), self.number(right, second)
                return self.comparison(numbers[0], sign, numbers[1], first)
            case sign:
                numbers = self.number(left, first), self.number(right, second)
                return Arithmetic(sign, numbers, first.start)

    def comparison(
        self,
        left: Number,
        sign: Literal["<", "<=", ">", ">="],
        right: Number,
        first: Token,
    ) -> Comparison:
        if self.at("<", "<=", ">", ">="):
            raise self.wrong(
                self.token, "one comparison at a time", "join two with `and`: `1 < x and x < 2`"
            )
        end = self.tokens[self.place - 1]
        text = self.text[first.start : end.start + len(end.source)]
        return Comparison(left, sign, right, first.start, " ".join(text.split()))

    def operand(self) -> Node | Number:
        token = self.take()
        match token.kind, token.text:
            case "word", "always" | "eventually" as word:
                interval = self.interval()
                inner = self.token
                operand = self.formula(self.expression(PREFIX), inner)
                return Temporal(word, (operand,), interval, token.start)
            case "word" | "symbol", "not":
                inner = self.token
                operand = self.formula(self.expression(PREFIX), inner)
                return Logic("not", (operand,), token.start)
            case "symbol", "(":
                node = self.expression(0)
                self.expect(")", "to close the one that was opened")
                return node
            case "symbol", "-":
                inner = self.token
                operand = self.number(self.expression(SIGN), inner)
                if isinstance(operand, Const):
                    return Const(-operand.value, operand.unit, token.start)
                return Arithmetic("neg", (operand,), token.start)
            case "number", _:
                return self.constant(token)
            case "name", name if name in FUNCTIONS:
                return self.function(token)
            case "name", _:
                return self.signal(token)
            case _:
                raise self.wrong(token, f"a signal or a number is needed{_not(token)}", _LISTED)

    def constant(self, token: Token) -> Const:
        value = float(token.text)
        if value > LARGEST_NUMBER:
            raise self.wrong(token, f"{token.text} is too large", f"at most {LARGEST_NUMBER:g}")
        if self.token.kind == "name" and self.token.text not in (*SIGNALS, *FUNCTIONS):
            unit = self.take()
            text = unit.text
            following = "".join(each.text for each in self.tokens[self.place : self.place + 2])
            if self.at("/", "*") and text + following in UNITS:  # cm/s, N*m
                text += following
                self.place += 2
            if text not in UNITS:
                raise self.wrong(
                    unit, f"no unit is called `{text}`", did_you_mean(text, UNITS, "units")
                )
            name, factor = UNITS[text]
            return Const(value * factor, name, token.start)
        return Const(value, "", token.start)

    def function(self, token: Token) -> Arithmetic:
        count = FUNCTIONS[token.text]
        self.expect("(", f"after `{token.text}`")
        operands: list[Number] = []
        for index in range(count):
            if index:
                self.expect(",", f"between the numbers of `{token.text}`")
            inner = self.token
            operands.append(self.number(self.expression(0), inner))
        self.expect(")", f"after the last number of `{token.text}`")
        return Arithmetic(token.text, tuple(operands), token.start)

    def signal(self, token: Token) -> Signal:
        if token.text not in SIGNALS:
            known = (*SIGNALS, *FUNCTIONS, *WORDS)
            hint = did_you_mean(token.text, known, "words")
            raise self.wrong(token, f"no signal is called `{token.text}`", hint)
        kinds, _, _ = SIGNALS[token.text]
        if not kinds:
            return Signal(token.text, (), (), token.start)
        usage = f"write `{token.text}({', '.join(kinds)})`"
        if not self.at("("):
            raise self.wrong(token, f"`{token.text}` is of {_count(kinds)}", usage)
        self.take()
        names: list[Token] = []
        while True:
            name = self.take()
            if name.kind not in ("name", "quoted", "word"):
                raise self.wrong(name, f"the name of a {kinds[0]} is needed{_not(name)}", usage)
            names.append(name)
            if not self.at(","):
                break
            self.take()
        self.expect(")", f"after the names of `{token.text}`")
        if len(names) != len(kinds):
            raise self.wrong(
                names[-1], f"`{token.text}` is of {_count(kinds)}, not {len(names)}", usage
            )
        arguments = tuple(n.source[1:-1] if n.kind == "quoted" else n.source for n in names)
        return Signal(token.text, arguments, tuple(name.start for name in names), token.start)

    def interval(self) -> Interval:
        if not self.at("["):
            return WHOLE
        opening = self.take()
        first = self.seconds()
        self.expect(",", "between the ends of an interval")
        last = self.seconds()
        self.expect("]", "at the end of an interval")
        if last < first:
            raise self.wrong(opening, "an interval ends before it begins", "write `[from, to]`")
        return Interval(first, last)

    def seconds(self) -> float:
        token = self.take()
        if token.kind != "number":
            raise self.wrong(
                token, f"a time in seconds is needed{_not(token)}", "`[0, 2]`, `[0, 200 ms]`"
            )
        constant = self.constant(token)
        if constant.unit not in ("", "s"):
            raise self.wrong(token, "an interval is of seconds", "`[0, 2]`, `[0, 200 ms]`")
        return constant.value


def _count(kinds: tuple[Kind, ...]) -> str:
    return "one name" if len(kinds) == 1 else f"{len(kinds)} names"


def _not(token: Token) -> str:
    return "" if token.kind == "end" else f", not `{token.source}`"
