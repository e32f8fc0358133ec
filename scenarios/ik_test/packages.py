"""Solvers of Python packages on a UR3e, as functions that `harness ik-test` calls.

They are used as their own examples use them, with their default tolerances. A package is imported
where its function is first called, so that each works without the others.
"""

import tempfile
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.types import FloatArray
from harness.iktest import IkReport, IkTest, run_ik_test
from harness.iktest.properties import BRANCHES, PROPERTIES
from harness.iktest.text import finding_lines
from harness.robot.chain import Chain
from harness.strategies import load_chain


@lru_cache(maxsize=1)
def ur3e() -> Chain:
    """The arm that all of them solve."""
    return load_chain("ur3e")


@lru_cache(maxsize=1)
def urdf_file() -> str:
    """The arm's URDF as a file."""
    path = Path(tempfile.mkdtemp()) / "ur3e.urdf"
    path.write_text(ur3e().description.urdf, encoding="utf-8")
    return str(path)


@lru_cache(maxsize=1)
def eaik_robot() -> tuple[Any, FloatArray]:
    """EAIK's robot from the axes of the joints at zero, and the tool's rotation there."""
    from eaik.IK_HP import HPRobot

    zero = np.zeros(6)
    chain = ur3e()
    tip = chain.link_pose(zero)
    axes, points = [], [np.zeros(3)]
    pose = np.eye(4)
    for before, axis in zip(chain.before, chain.axes, strict=True):
        pose = pose @ before.matrix()
        axes.append(pose[:3, :3] @ axis)
        points.append(pose[:3, 3])
    points.append(tip.translation)
    return HPRobot(np.array(axes), np.diff(np.array(points), axis=0)), tip.rotation


def eaik(matrix: FloatArray) -> list[FloatArray]:
    """EAIK: every solution that it does not call a least-squares approximation."""
    robot, tool = eaik_robot()
    target = np.array(matrix)
    target[:3, :3] = matrix[:3, :3] @ tool.T  # its tool is turned as the base
    found = robot.IK(target)
    return [q for q, is_approximate in zip(found.Q, found.is_LS, strict=True) if not is_approximate]


@lru_cache(maxsize=1)
def tracik_solver() -> Any:
    """TRAC-IK with the timeout and the tolerance of its own default."""
    from trac_ik import TracIK

    return TracIK("world", "tool0", urdf_file())


def pytracik(position: FloatArray, rotation: FloatArray, seed: FloatArray) -> FloatArray | None:
    """TRAC-IK: one solution near a seed, or None after 5 ms."""
    return tracik_solver().ik(position, rotation, seed_jnt_values=seed)


@lru_cache(maxsize=1)
def ikpy_chain() -> tuple[Any, list[int]]:
    """IKPy's chain, and which of its links are the arm's joints."""
    from ikpy.chain import Chain as IkpyChain

    way = ur3e().way
    elements = ["world", *(name for joint in way for name in (joint.name, joint.child))]
    moving = [False, *(joint.is_movable for joint in way)]  # its first link is the base
    chain = IkpyChain.from_urdf_file(urdf_file(), base_elements=elements, active_links_mask=moving)
    return chain, [number for number, moves in enumerate(moving) if moves]


def ikpy(matrix: FloatArray, seed: FloatArray) -> FloatArray:
    """IKPy: the least-squares optimum from a seed, with the whole orientation."""
    chain, joints = ikpy_chain()
    start = np.zeros(len(chain.links))
    start[joints] = seed
    found = chain.inverse_kinematics_frame(matrix, initial_position=start, orientation_mode="all")
    return np.asarray(found)[joints]


def ikpy_checked(matrix: FloatArray, seed: FloatArray) -> FloatArray | None:
    """IKPy, as its callers must use it: an optimum that is not at the target is refused."""
    answer = ikpy(matrix, seed)
    chain, joints = ikpy_chain()
    whole = np.zeros(len(chain.links))
    whole[joints] = answer
    return answer if np.abs(chain.forward_kinematics(whole) - matrix).max() < 1e-4 else None


PAGE = Path(__file__).with_name("PACKAGES.md")

TRIED: dict[str, tuple[str, int, bool, str]] = {
    # function: distribution, examples, whether it claims every way, what is to be known of it
    "eaik": (
        "eaik",
        100,
        True,
        "Closed forms from the axes of the joints (subproblem decomposition), which know no joint "
        "limits: dropping answers beyond them (here 0.15 rad within a half turn for four joints) "
        "is the caller's. What it marks as a least-squares approximation is taken as a refusal.",
    ),
    "pytracik": (
        "pytracik",
        60,
        False,
        "TRAC-IK: two numeric searches side by side, 5 ms of wall time and 1e-5 by default, one "
        "answer. What it finds in that time depends on the machine and differs from run to run.",
    ),
    "ikpy": (
        "ikpy",
        25,
        False,
        "A least-squares optimum from one seed. By design it always answers: whoever calls it must "
        "look whether the optimum is at the target.",
    ),
    "ikpy_checked": (
        "ikpy",
        25,
        False,
        "The same, with that look: an optimum off by more than 1e-4 is refused. One search from "
        "one seed finds what is near; restarts are the caller's.",
    ),
}

HEAD = """# Solvers of packages under these tests

What `harness ik-test` finds on a UR3e in the solvers of three Python packages, each used as its own
examples use it, with the tolerances of the [page on testing](README.md): 0.1 mm and 1 mrad. Made
anew by

```sh
pip install 'armharness[ik-packages]' && python scenarios/ik_test/packages.py
```

A third of the targets stands at singularities or next to them, another has joints at their limits:
numeric solvers are measured harder here than on random poses, and a finding is no verdict on a
package. What each sets out to do stands with it. Numbers are cases that show a flaw, of cases
tried; times are of one machine that had other work to do. Examples are shrunk towards this arm's
`home`, which is straight up: elbow and wrist are singular there.
"""


def report_of(name: str) -> IkReport:
    """One solver, tested."""
    _, examples, claims_all, _ = TRIED[name]
    solver = f"{Path(__file__).resolve()}:{name}"
    return run_ik_test(IkTest(solver, "ur3e", examples=examples, branches=claims_all))


def page() -> str:
    """What was found, as Markdown."""
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
            printed = [line.replace(f"{Path(__file__).resolve()}:", "") for line in
                    finding_lines(report, finding)]  # fmt: skip
            lines += ["", "```text", *printed, "```"]
        if not report.findings:
            lines += ["", "Nothing was found."]
    return "\n".join(lines) + "\n"


def cell(report: IkReport, name: str) -> str:
    """What the table says of a property."""
    for result in report.properties:
        if result.name == name:
            flawed, tried = result.flawed, result.tried
            return f"**{flawed} of {tried}**" if flawed else f"ok, {tried}"
    return "not claimed"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
