import math

import pytest

from harness.language.files.mistakes import MistakeError
from harness.language.units import COMMON, quantity


@pytest.mark.parametrize(
    ("text", "units", "value"),
    [
        ("90 deg", ("rad",), math.pi / 2),
        ("90deg", ("rad", "m"), math.pi / 2),
        ("5 cm", ("rad", "m"), 0.05),
        ("-1.5e2 mm", ("m",), -0.15),
        ("1 in", ("m",), 0.0254),
        ("30 deg/s", ("rad/s",), math.pi / 6),
        ("10 rpm", ("rad/s",), 2 * math.pi / 6),
        ("200 ms", ("s",), 0.2),
        ("3 min", ("s",), 180.0),
        ("10 N", ("N*m", "N"), 10.0),
        ("2 N*m", ("N*m", "N"), 2.0),
        ("2 Nm", ("N*m",), 2.0),
        ("0.3 kg", ("kg",), 0.3),
        ("300 g", ("kg",), 0.3),
        ("9.8 m/s^2", ("m/s**2",), 9.8),
    ],
)
def test_text_with_a_unit_becomes_an_si_number(text, units, value):
    assert quantity(*units)(text) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("target", "unit"), [(target, unit) for target, factors in COMMON.items() for unit in factors]
)
def test_a_common_unit_is_to_the_bit_what_pint_says(target, unit, monkeypatch):
    texts = [f"{number} {unit}" for number in ("1", "0.1", "3", "12.7", "-1e-3")]
    quick = [quantity(target)(text) for text in texts]
    monkeypatch.setattr("harness.language.units.COMMON", {})
    assert quick == [quantity(target)(text) for text in texts]


@pytest.mark.parametrize("number", [0, 5, -2.5, 1e-9])
def test_a_number_passes_as_it_is(number):
    assert quantity("m")(number) == number


@pytest.mark.parametrize(
    ("value", "units", "message", "hint"),
    [
        ("5 s", ("rad", "m"), "`5 s` is a time; an angle or a length is expected", "rad, deg, m"),
        ("120 milimeter", ("m",), "no unit is called `milimeter`", "units: m, cm, mm"),
        ("5 CM", ("m",), "no unit is called `CM`", "did you mean `5 cm`"),
        ("5", ("m",), "`5` is text without a unit", "write 5 without quotes"),
        ("half", ("m",), "a length is a number, not `half`", "cm"),
        ("5 m**4", ("m",), "`5 m**4` is something else", "cm"),
        ("5 __class__", ("m",), "no unit is called `__class__`", "cm"),
        (True, ("m",), "a length is a number, not `true`", "cm"),
        (None, ("s",), "a time is a number, not nothing", "ms"),
        ([1], ("kg",), "a mass is a number, not a list", "g"),
        ("9**9**9**9", ("m",), "a length is a number, not `9**9**9**9`", "cm"),
    ],
)
def test_what_is_no_such_quantity_is_refused_in_plain_words(value, units, message, hint):
    with pytest.raises(MistakeError) as caught:
        quantity(*units)(value)
    assert message in caught.value.message
    assert hint in caught.value.hint


@pytest.mark.parametrize(
    ("value", "units"),
    [
        ("50 mn", ("m",)),
        ("5 nm2", ("m",)),
        ("3 secnd", ("m",)),
        ("5 kq", ("kg",)),
        ("2 ml", ("s",)),
    ],
)
def test_no_unit_of_another_dimension_is_suggested(value, units):
    with pytest.raises(MistakeError) as caught:
        quantity(*units)(value)
    assert caught.value.hint.startswith("units: ")


@pytest.mark.parametrize(
    "text",
    [
        "10 " + "m" * 55 + "!",
        "10 " + "m " * 27 + "!",
        "10 " + "m*" * 27 + "!",
        "10 m^4^4^4^4^4",
        "10 m**4**4**4**4",
        "10 m^4 4 4 4 4 4^4^4^4",
        "10 " + "m4 " * 18,
    ],
)
def test_a_text_like_a_unit_is_refused_without_long_work(text):
    """It took minutes to see that the first is none, and all memory to compute the powers."""
    with pytest.raises(MistakeError, match="10 m"):
        quantity("m")(text)
