"""Commands of programs outside, in the list of steps of a run's page."""

from dataclasses import replace

from harness.recording.commands import CommandRecord
from harness.recording.stored_run import StoredRun
from harness.reporting.html.story import command_rows
from harness.reporting.html.write import Page
from tests.judging.synthetic_run import lift_run, step

HOSTILE = "<img src=x onerror=alert(1)>"


def command(time, summary, goal="", **fields):
    fields = {"controller": "arm", "answer": "accepted", "summary": summary, **fields}
    return CommandRecord(round(500 * time), time, "trajectory", goal=goal, **fields)


STEPS = [
    step("first", 0, 60, "external"),
    step("plan", 60, 90),
    step("second", 90, 200, "external"),
]
COMMANDS = (
    command(0.02, "jog"),
    command(0.04, "jog"),
    command(0.05, "jog"),
    command(0.06, "jog", goal="a1", result="succeeded, t=0.10 s"),
    command(0.08, "jog"),
    command(1.0, "throw", answer=f"refused {HOSTILE}", has_failed=True),
    command(1.2, ""),
)


def commanded_run():
    return replace(lift_run(), steps=tuple(STEPS), commands=COMMANDS)


def test_each_command_is_a_row_of_its_step_and_topics_repeat():
    run = commanded_run()
    first, plan, second = (command_rows(run, each) for each in run.steps)
    assert [(row["what"], row["count"], row["time"], row["until"]) for row in first] == [
        ("arm jog", 3, 0.02, 0.05),
        ("arm jog", 1, 0.06, None),
        ("arm jog", 1, 0.08, None),
    ]
    assert [row["answer"] for row in first] == ["accepted", "succeeded, t=0.10 s", "accepted"]
    assert plan == []
    assert [(row["what"], row["isBad"]) for row in second] == [
        ("arm throw", True),
        ("arm trajectory", False),  # of a run that was recorded without summaries
    ]


def test_commands_unfold_and_lead_to_their_moment(tmp_path, visit):
    file = tmp_path / "report.html"
    stored = StoredRun(commanded_run(), (), "passed", "0" * 64, {})
    file.write_text(Page(stored.run, ()).html(stored))
    opened = visit(file)
    lists = opened.page.locator("#steps .commands")
    assert lists.locator("summary").all_inner_texts() == [
        "5 commands",
        "2 commands, 1 without success",
    ]
    assert not lists.locator("div").first.is_visible()
    lists.last.locator("summary").click()
    row = lists.last.locator("div").first
    assert f"arm throw refused {HOSTILE}" in row.inner_text()
    row.locator("button").click()
    assert opened.time() == 1.0
