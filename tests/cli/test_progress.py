import io
import os
import pty
import re
import subprocess
import sys

from harness.cli.progress import ProgressLines
from harness.reporting.result import CaseResult, ProgressEvent
from harness.reporting.terminal import Style

SCENARIO = """\
scenario: Too short
robot: open_manipulator_x
steps:
  - wait: 0.3 s
  - wait: 0.1 s
    id: pause
expect:
  - duration: {at_least: 1 s}
"""
RUN = [sys.executable, "-m", "harness.cli", "run", "short.scenario.yaml", "--no-page"]


class Terminal(io.StringIO):
    encoding = "utf-8"

    def isatty(self):
        return True


def event(kind, sim_time, wall_time, index=0):
    return ProgressEvent(kind, index, 2, "pick", "passed", sim_time, "", wall_time)


def told(stream, *events):
    """Lines of progress of one case."""
    lines = ProgressLines(stream, ["a"], is_side_by_side=False, style=Style())
    for each in events:
        lines.step(0, each)
    lines.result(0, CaseResult("a", "", "Pick", "passed"))
    return stream.getvalue().splitlines()


def test_a_step_has_its_own_speed_also_around_steps_nested_in_it():
    lines = told(
        Terminal(),
        event("step_started", 10.0, 0.0),
        event("step_started", 10.0, 1.0, -1),
        event("step_finished", 12.0, 2.0, -1),
        event("step_finished", 20.0, 4.0),
    )
    assert lines[1].endswith("pick  t=12.00 s  2.0x real time")
    assert lines[2].endswith("1/2  pick  t=20.00 s  2.5x real time")


def test_piped_a_case_is_one_line():
    lines = told(io.StringIO(), event("step_started", 0.0, 0.0), event("step_finished", 1.0, 0.1))
    assert len(lines) == 1
    assert lines[0].startswith("a  passed  Pick")


def on_terminal(folder):
    """Exit code and everything that a run writes to a terminal of 100 columns."""
    ours, theirs = pty.openpty()
    with subprocess.Popen(
        RUN, cwd=folder, stdout=theirs, stderr=theirs, env={**os.environ, "TERM": "xterm"}
    ) as process:
        os.close(theirs)
        said = b""
        while True:
            try:
                said += os.read(ours, 65536)
            except OSError:  # Linux: the other end is gone
                break
    os.close(ours)
    return process.returncode, said.decode()


def test_a_terminal_sees_steps_and_both_see_failures_last(tmp_path, monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    (tmp_path / "short.scenario.yaml").write_text(SCENARIO)
    code, seen = on_terminal(tmp_path)
    assert code == 1
    assert "\x1b[2K    1/2  wait 0.3 s …  t=0.00 s" in seen, "the step that is under way"
    assert re.search(r"1/2  wait 0.3 s\S*  t=0.30 s\S*  \S*[\d.]+x real time", seen)
    assert float(re.search(r"([\d.]+)x real time", seen)[1]) < 1000, "as the run went, not the pipe"
    piped = subprocess.run(RUN, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert piped.returncode == 1
    assert piped.stderr == ""
    assert "1/2" not in piped.stdout
    assert "\x1b" not in piped.stdout
    lines = piped.stdout.splitlines()
    assert lines[0].startswith("short.scenario.yaml  failed  Too short  2 steps, 0.4 s simulated")
    assert lines[2] == "FAILED short.scenario.yaml: Too short"
    assert lines[3].startswith("  short.scenario.yaml:8: ")
    assert "failed by 0.6 s" in lines[3]
    again = "  again:  harness run short.scenario.yaml"
    report = "reports/short"
    for text in (lines, re.sub(r"\x1b\]8;;.*?\x1b\\|\x1b\[\d+m", "", seen).splitlines()):
        assert again in text
        assert any(line.startswith("  report: ") and report in line for line in text[-5:])
        assert text[-2].startswith("1 failed of 1 case in ")
