"""Deeply nested JSON is a mistake of the text wherever a command reads JSON."""

import pytest

from harness.core.untrusted_json import parse_json
from harness.language.reading.load import read_scenario
from harness.reporting.suite.history import history_of

DEEP = 100_000
ENDLESS = ("[" * DEEP, "[" * DEEP + "]" * DEEP, '{"a":' * DEEP + "1" + "}" * DEEP)


@pytest.mark.parametrize("text", [*ENDLESS, ENDLESS[0].encode()])
def test_deep_nesting_is_a_value_error(text):
    with pytest.raises(ValueError, match="nested too deeply"):
        parse_json(text)


def test_other_texts_are_read_as_json_reads_them():
    assert parse_json('{"a": [1, 2.5, null]}') == {"a": [1, 2.5, None]}
    assert parse_json(b'"\xc3\xa4"') == "\xe4"
    for text in ("", "[1,", b"\xff"):
        with pytest.raises(ValueError, match=r"."):
            parse_json(text)


@pytest.mark.parametrize(
    "text",
    [
        *ENDLESS,
        '{"format": "%s", "cases": [{"file": "a", "case": "", "worst_margin": {"share": "x"}}]}',
        '{"format": "%s", "cases": [{"file": [], "case": ""}]}',
        '{"format": "%s", "cases": 5}',
        "[]",
    ],
)
def test_damaged_results_of_earlier_runs_are_left_out(tmp_path, text):
    from harness.reporting.suite.record import FORMAT

    (tmp_path / "a.json").write_text(text.replace("%s", FORMAT))
    case = '{"file": "a", "case": "", "worst_margin": {"share": 0.5}}'
    (tmp_path / "b.json").write_text(f'{{"format": "{FORMAT}", "cases": [{case}]}}')
    assert history_of(tmp_path) == {("a", ""): [0.5]}


@pytest.mark.parametrize("value", ENDLESS[:2])
def test_a_deep_value_of_what_is_drawn_is_a_mistake_at_its_option(tmp_path, value):
    file = tmp_path / "a.scenario.yaml"
    file.write_text(
        "scenario: a\nrobot: open_manipulator_x\nsteps: [{wait: 0.1}]\nsamples: 2\n"
        'randomize: {"steps[0].wait": {uniform: [0.1, 0.2]}}\n'
    )
    report = read_scenario(file, {"steps[0].wait": value}, None, None)
    assert report.problems
