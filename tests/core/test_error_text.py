"""What is said of an exception that no part of the program expects."""

import numpy as np
import pytest

from harness.cli.output import guarded
from harness.core.error_text import error_text


def test_memory_that_is_not_there_is_no_traceback(capsys):
    with pytest.raises(MemoryError) as raised:
        np.zeros(2**50)
    assert error_text(raised.value) == "harness: there is not enough memory"
    assert guarded(lambda: len(bytearray(2**50)), ticks=False) == 3
    assert capsys.readouterr().err == "harness: there is not enough memory\n"


def test_a_mistake_of_the_program_has_its_traceback():
    with pytest.raises(ZeroDivisionError) as raised:
        divmod(1, 0)
    assert "ZeroDivisionError: integer division or modulo by zero" in error_text(raised.value)
    assert "test_error_text.py" in error_text(raised.value)
