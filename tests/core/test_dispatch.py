from dataclasses import dataclass

import pytest

from harness.core.dispatch import Dispatch


@dataclass
class Open:
    width: float


@dataclass
class Close:
    pass


def test_a_handler_is_found_by_the_models_type():
    act: Dispatch[str, str] = Dispatch()

    @act.handles(Open)
    def _open(spec, context):
        return f"{context} opens {spec.width}"

    assert act(Open(0.1), "hand") == "hand opens 0.1"
    assert Open in act
    assert Close not in act
    assert list(act) == [Open]


def test_a_second_handler_for_a_model_is_refused():
    act: Dispatch[None, None] = Dispatch()
    act.handles(Open)(lambda _spec, _context: None)
    with pytest.raises(ValueError, match="Open already has a handler"):
        act.handles(Open)(lambda _spec, _context: None)


def test_a_model_without_handler_is_an_error_of_the_program():
    with pytest.raises(KeyError):
        Dispatch()(Close(), None)
