"""Options that follow from the fields of a dataclass."""

from dataclasses import dataclass

import pytest

from harness.cli.arguments import Parser
from harness.cli.options import add_options, read_options
from harness.core.options import option
from tests.running import exit_code


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


@pytest.mark.parametrize("option", ["--set", "--seed", "--plugin", "--format"])
def test_two_hyphens_are_no_value_of_an_option(option, capsys):
    """Until Python 3.12 argparse drops them, and gives an empty list."""
    assert exit_code("check", "a.scenario.yaml", f"{option}=--") == 2
    said = capsys.readouterr().err
    assert f"argument {option}: '--' is no value" in said
    assert "Traceback" not in said


@pytest.mark.parametrize("pattern", ["[" * 10_000, "[a" * 5000, "*[" * 5000])
def test_a_pattern_of_cases_is_bounded(pattern, capsys, tmp_path):
    """Reading brackets takes the square of their number."""
    (tmp_path / "a.scenario.yaml").write_text("scenario: A\nrobot: ur3e\nsteps: [{wait: 5 ms}]\n")
    words = ["run", tmp_path / "a.scenario.yaml", "--no-report", "--case", pattern]
    assert exit_code(*words) == 2
    assert (
        capsys.readouterr().err == "harness: --case: a pattern may have 2000 characters at most\n"
    )


@pytest.mark.parametrize("option", ["--group", "--tcp-link", "--args"])
@pytest.mark.parametrize("name", ["a" * 101, "\udc80"])
def test_a_word_that_is_no_name_of_a_robot_is_wrong_usage(option, name, capsys):
    value = f"{name}=1" if option == "--args" else name
    assert exit_code("robot", "check", "ur3e", f"{option}={value}") == 2
    said = capsys.readouterr().err
    assert "Traceback" not in said
    assert said.startswith("harness: robot `")
