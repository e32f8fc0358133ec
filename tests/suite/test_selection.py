"""Expressions of `-k` that no person writes."""

import pytest

from harness.suite.discovery import UsageError
from harness.suite.header import ScenarioHeader
from harness.suite.selection import selects


@pytest.mark.parametrize("text", ["not " * 5000 + "a", "(" * 3000 + "a" + ")" * 3000])
def test_an_expression_that_is_nested_without_end_is_wrong_usage(text, tmp_path):
    with pytest.raises(UsageError, match="nested"):
        selects(text, tmp_path / "a", ScenarioHeader("a"))
