"""The page on solvers of Python packages. Run as a script, it tests them and writes the page."""

from __future__ import annotations

from importlib.metadata import version

from docs import ROOT
from harness.plugins.iktest import IkReport, IkTest, run_ik_test
from harness.plugins.iktest.properties import BRANCHES, PROPERTIES
from harness.plugins.iktest.text import finding_lines

PAGE = ROOT / "docs/reference/ik_packages.md"
SOLVERS = ROOT / "scenarios/ik_test/packages.py"

TRIED: dict[str, tuple[str, int, bool, str]] = {
    # function: distribution, examples, whether it claims to return every solution, its design
    "eaik": (
        "eaik",
        100,
        True,
        "Closed forms from the axes of the joints (subproblem decomposition), which know no joint "
        "limits: the caller has to drop answers beyond them (here 0.15 rad less than half a turn "
        "for four joints). An answer marked as a least-squares approximation counts as a refusal.",
    ),
    "pytracik": (
        "pytracik",
        60,
        False,
        "TRAC-IK: two numeric searches in parallel, 5 ms of wall time and 1e-5 by default, one "
        "answer. The result depends on the machine and differs from run to run.",
    ),
    "ikpy": (
        "ikpy",
        25,
        False,
        "A least-squares optimum from one seed. By design it always answers: the caller has to "
        "check whether the optimum is at the target.",
    ),
    "ikpy_checked": (
        "ikpy",
        25,
        False,
        "The same solver with that check: an optimum off by more than 1e-4 is refused. One search "
        "from one seed finds a solution close to the seed; restarts are up to the caller.",
    ),
}

HEAD = """# Inverse kinematics of other packages

[`harness ik-test`](../guides/ik_test.md) tries the solvers of three Python packages on a UR3e. Each
is called as its own examples call it ([packages.py](../../scenarios/ik_test/packages.py)), with
tolerances of 0.1 mm and 1 mrad. To measure again:

```sh
pip install -e '.[ik-packages]' && python -m docs.generators.ik_packages
```

A third of the targets are at singularities or close to them, and another third have joints at their
limits; in `reaches` and `answers` it is a quarter each, and another quarter is at round values. It
is harder for numeric solvers than random poses, and a finding is not a verdict on a
package; its section states what the solver is designed for. The numbers are cases that show a flaw,
of all cases tried. The times are from one machine with other load. Examples are shrunk towards the
`home` state of this arm, which points straight up: elbow and wrist are singular there.
"""


def report_of(name: str) -> IkReport:
    """The report on one solver."""
    _, examples, claims_all, _ = TRIED[name]
    solver = f"{SOLVERS}:{name}"
    return run_ik_test(IkTest(solver, "ur3e", examples=examples, branches=claims_all))


def page() -> str:
    """The page as Markdown."""
    reports = {name: report_of(name) for name in TRIED}
    titles = [f"{name} ({version(TRIED[name][0])})" for name in TRIED]
    lines = [HEAD, f"| property | {' | '.join(titles)} |", f"| --- |{' --- |' * len(titles)}"]
    for each in (*PROPERTIES, BRANCHES):
        cells = [cell(report, each.name) for report in reports.values()]
        lines.append(f"| {each.name} | {' | '.join(cells)} |")
    speeds = [report.speed for report in reports.values()]
    times = ["" if speed is None else f"{1e3 * speed.median:.2g} ms" for speed in speeds]
    lines.append(f"| median time of a call | {' | '.join(times)} |")
    for name, report in reports.items():
        lines += ["", f"## {name}", "", TRIED[name][3]]
        for finding in report.findings:
            shown = [line.replace(f"{SOLVERS}:", "") for line in finding_lines(report, finding)]
            lines += ["", "```text", *shown, "```"]
        if not report.findings:
            lines += ["", "Nothing was found."]
    return "\n".join(lines) + "\n"


def cell(report: IkReport, name: str) -> str:
    """The table cell of a property."""
    for result in report.properties:
        if result.name == name:
            flawed, tried = result.flawed, result.tried
            return f"**{flawed} of {tried}**" if flawed else f"ok, {tried}"
    return "not claimed"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
