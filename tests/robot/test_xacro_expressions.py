"""Expressions of xacro files have the values that Python gives them, or a located error."""

import builtins
import math
import re
import warnings
from types import SimpleNamespace

import pytest
from hypothesis import strategies as st

from harness.plugins.formats.xacro.expression import Namespace, evaluate
from harness.plugins.formats.xacro.functions import BUILTINS, MATH, PYTHON
from harness.plugins.formats.xacro.values import (
    Budget,
    Exhausted,
    ExpressionError,
    Function,
    YamlDict,
)
from tests.lanes import property_test

VALUES = {
    "x": 3,
    "y": -2.5,
    "flag": True,
    "nothing": None,
    "text": "0.1 0.2 0.3",
    "items": [1, 2, 3],
    "pair": (1, "a"),
    "table": {"k": 1, "far": [0.1, 0.2]},
}
NAMES = Namespace(
    {**BUILTINS, **MATH, "python": Namespace(PYTHON), "math": Namespace(MATH), **VALUES}
)
IN_PYTHON = {
    **{name: getattr(math, name) for name in MATH},
    "python": SimpleNamespace(**{name: getattr(builtins, name) for name in PYTHON}),
    "math": math,
    **VALUES,
}
DATA = (int, float, str, list, tuple, dict, range, type(None))


def words(text):
    """One of the words of a text."""
    return st.sampled_from(text.split())


OPERATORS = words("+ - * / // % < <= > >= == != and or in & | ^") | st.just("not in")
FUNCTIONS = words(
    "len str float int bool min max round list sorted python.abs python.all python.any "
    "python.tuple python.sum python.repr python.divmod python.reversed math.sin math.sqrt "
    "math.floor math.hypot math.radians math.isclose math.gcd"
)
METHODS = words(
    "upper split strip title count index find startswith replace join keys values get copy"
)
SMALL = st.integers(0, 3).map(str)  # exponents and shifts, for Python's sake
PIECES = (
    words("( ) [ ] { } , : . = := * ** ~ - + / % < == ! @ ; \\ ' \" f' b' # lambda for in if else")
    | words("not is yield await async class import __class__ __builtins__ _ x y text items table")
    | words("math python map list str len range format gi_frame 0 1 9 1e5 1j 9**9 ... None True")
    | st.text(max_size=3)
)

literals = st.one_of(
    st.integers(0, 20).map(str),
    st.floats(0, 100).map(repr),
    st.sampled_from(["True", "False", "None", "'a'", "'a b'", "''", "'%s'", "'%.2f'", "[]", "()"]),
    st.sampled_from(list(VALUES)),
)


def filled(template, *parts):
    """Texts of a template, with parts that are drawn."""
    return st.tuples(*parts).map(lambda each: template.format(*each))


def compound(inner):
    """Expressions of smaller ones."""
    some = st.lists(inner, max_size=2).map(", ".join)
    return st.one_of(
        filled("({} {} {})", inner, OPERATORS, inner),
        filled("({} {} {})", inner, words("** << >>"), SMALL),
        filled("({}{})", st.sampled_from(["-", "+", "not ", "~"]), inner),
        filled("({} if {} else {})", inner, inner, inner),
        filled("{}[{}]", inner, inner),
        filled("{}[{}:{}]", inner, inner, inner),
        filled("[{}]", some),
        filled("({}, {})", inner, inner),
        filled("{}({})", FUNCTIONS, some),
        filled("({}).{}({})", inner, METHODS, some),
        filled("[{} for x in {} if {}]", inner, inner, inner),
        filled("[({}, a) for a, b in {}]", inner, inner),
    )


def of_python(expression):
    """The value that Python has, and the error where it has none."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # such as that a number is called
            return eval(expression, {**IN_PYTHON}), None
    except Exception as error:  # noqa: BLE001 - whatever an operation raises
        return None, error


def of_harness(expression):
    """The value that the interpreter has, and the error where it has none."""
    try:
        return evaluate(expression, NAMES, Budget()), None
    except (ExpressionError, Exhausted, RecursionError) as error:
        return None, error


@property_test(st.recursive(literals, compound, max_leaves=8), few=75, many=600)
def test_an_expression_has_the_value_that_python_gives_it(expression):
    """Views and iterators of Python are lists here, and complex numbers are refused."""
    expected, of_eval = of_python(expression)
    value, error = of_harness(expression)
    has_views = re.search("keys|values|reversed", expression)
    is_data = of_eval is None and isinstance(expected, DATA)
    if is_data and error is None:
        assert type(value) is type(expected)
        assert repr(value) == repr(expected) or has_views
    else:
        assert has_views or (error is not None and not is_data), (value, error, expected, of_eval)


@property_test(st.lists(PIECES, max_size=20), st.sampled_from(["", " "]), few=40, many=1000)
def test_any_text_has_a_value_or_a_located_error(pieces, separator):
    text = separator.join(pieces)
    value, error = of_harness(text)
    if isinstance(error, ExpressionError):
        assert error.message
        assert 0 <= error.start <= len(text)
    elif error is None:
        assert isinstance(value, (*DATA, Function, Namespace))


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("1 < 2 < 3 != 4", True),
        ("[~True, ~(1 > 2), ~4]", [-2, -1, -5]),
        ("'%05.2f|%-4s|%d' % (1.5, 'a', 3)", "01.50|a   |3"),
        ("'%(k)s' % table", "1"),
        ("list(map(float, text.split()))", [0.1, 0.2, 0.3]),
        ("python.list(python.filter(python.bool, [0, 1, 2]))", [1, 2]),
        ("' '.join([str(2 * v) for v in items if v > 1])", "4 6"),
        ("[(a, b) for a in items for b in items if a < b]", [(1, 2), (1, 3), (2, 3)]),
        ("[x for x in items] + [x]", [1, 2, 3, 3]),
        ("python.sum(v for v in items)", 6),
        ("max(items, default=0) + max([], default=7)", 10),
        ("dict(a=1, b=2)['b']", 2),
        ("dict([['a', 1]]).get('b', 5)", 5),
        ("python.zip(items, text)", [(1, "0"), (2, "."), (3, "1")]),
        ("python.enumerate(items, 1)", [(1, 1), (2, 2), (3, 3)]),
        ("python.enumerate(items, start=2)", [(2, 1), (3, 2), (4, 3)]),
        ("items[::-1] + items[-1:]", [3, 2, 1, 3]),
        ("radians(180) == pi", True),
        ("math.factorial(5) * math.prod(items)", 720),
        ("not x or y and nothing", None),
        ("config.joints.elbow.max", 2.5),
        ("config['joints']['elbow'].max", 2.5),
        ("config.list[1].name", "b"),
        ("config[7]", "seven"),
    ],
)
def test_values_of_usual_expressions(expression, value):
    config = YamlDict(
        joints=YamlDict(elbow=YamlDict(max=2.5)),
        list=[YamlDict(name="a"), YamlDict(name="b")],
        **{"7": "seven"},
    )
    names = Namespace({**NAMES.contents, "config": config})
    assert evaluate(expression, names, Budget()) == value


@pytest.mark.parametrize(
    ("expression", "start", "length", "words"),
    [
        ("x + z", 4, 1, "name 'z' is not defined"),
        ("  x + z", 6, 1, "name 'z' is not defined"),
        ("'é' + text + zz", 13, 2, "name 'zz' is not defined"),
        ("x + table['kk']", 10, 4, "there is no key 'kk'"),
        ("x + table.k", 4, 7, "there is no attribute 'k' here"),
        ("x + math.sine(1)", 4, 9, "name 'sine' is not defined in this namespace"),
        ("text.uper()", 0, 9, "there is no attribute 'uper' here"),
        ("x / (3 - x)", 0, 11, "division by zero"),
        ("sqrt(-x)", 0, 8, "math domain error"),
        ("(-x) ** 0.5", 0, 11, "complex"),
        ("items[5]", 0, 8, "list index out of range"),
        ("x + (lambda: 1)()", 5, 9, "`lambda` is not part of xacro's expressions"),
    ],
)
def test_an_error_is_located_in_the_expression(expression, start, length, words):
    with pytest.raises(ExpressionError) as caught:
        evaluate(expression, NAMES, Budget())
    assert (caught.value.start, caught.value.length) == (start, length)
    assert words in caught.value.message


@pytest.mark.parametrize(
    ("expression", "hint"),
    [
        ("text.uper()", "did you mean `upper`?"),
        ("table['farr']", "did you mean `far`?"),
        ("table.far", "write ['far']"),
        ("math.sine(1)", "did you mean `sin`?"),
        ("abs(x)", "write `python.abs`"),
        ("f'{x}'", "expressions have numbers"),
    ],
)
def test_an_error_says_what_is_allowed(expression, hint):
    with pytest.raises(ExpressionError) as caught:
        evaluate(expression, NAMES, Budget())
    assert hint in caught.value.hint
