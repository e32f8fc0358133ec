"""Options that follow from the fields of a dataclass."""

from dataclasses import dataclass

import pytest

from harness.cli.arguments import Parser
from harness.cli.options import add_options, read_options
from harness.core.options import option


@dataclass(frozen=True)
class Order:
    """Options of every kind, and a field that is none."""

    table: str = "7"
    count: int = option("-n", default=1, text="how many")
    most: int | None = option("--most", default=None, text="at most so many")
    drinks: tuple[str, ...] = option("--drink", metavar="NAME", default=(), text="add a drink")
    is_hot: bool = option("--cold", default=True, text="serve it cold")
    size: str = option("--size", choices=("small", "large"), default="small", text="its size")


def order_of(*words, **given):
    parser = Parser()
    add_options(parser, Order)
    return read_options(parser.parse_args(words), Order, **given)


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ((), Order()),
        (("-n", "3", "--most", "5"), Order(count=3, most=5)),
        (("--drink", "tea", "--drink", "water"), Order(drinks=("tea", "water"))),
        (("--cold", "--size", "large"), Order(is_hot=False, size="large")),
    ],
)
def test_options_give_the_fields_that_declare_them(words, expected):
    assert order_of(*words) == expected


def test_a_given_value_takes_precedence_over_an_option():
    assert order_of("-n", "3", table="9", count=4) == Order(table="9", count=4)


@pytest.mark.parametrize("words", [("-n", "0"), ("--most", "few"), ("--size", "huge")])
def test_a_wrong_value_ends_with_exit_code_2(words, capsys):
    with pytest.raises(SystemExit) as ended:
        order_of(*words)
    assert ended.value.code == 2
    assert f"'{words[1]}' is not" in capsys.readouterr().err
