"""Random cells of two arms: what was planned as free is free in the physics.

Each seed draws the models, the distance and the turn of the bases, boxes in the way, and six
motions: of each arm alone, of both to a pose each, and of both at once. Motions without a plan are
refused with a code of MoveIt and left out; the others are carried out, and the whole run is judged.
"""

import numpy as np
import pytest

from harness.recording.read_run import read_run
from harness.session.check import check_file
from tests.running import run_case

SEEDS = (*range(50), 7100)  # 7100: 0.02 mm between arms without padding
REFUSED = {
    "NO_IK_SOLUTION", "GOAL_IN_COLLISION", "PLANNING_FAILED", "INVALID_MOTION_PLAN",
    "GOAL_STATE_INVALID", "START_STATE_IN_COLLISION",
}  # fmt: skip


def random_cell(seed):
    """The text of a cell before its steps, the steps, and the text after them."""
    rng = np.random.default_rng(seed)
    reach = 0.45
    apart, turn = rng.uniform(0.45, 0.8), rng.uniform(-180, 180)
    models = rng.choice(["ur3", "ur3e"], 2)
    bases = {"left": (apart / 2, 0.0), "right": (-apart / 2, turn)}
    robots = "".join(
        f"  {arm}: {{model: {model}, gripper: rh_p12_rn_a,"
        f" base: {{xyz: [0, {y:.3f}, 0], rpy: [0, 0, {rpy:.1f} deg]}}}}\n"
        for model, (arm, (y, rpy)) in zip(models, bases.items(), strict=True)
    )
    boxes = ""
    for number in range(3):
        x, y = rng.choice([-1, 1]) * rng.uniform(0.35, 0.5), rng.uniform(-0.3, 0.3)
        height = rng.uniform(0.05, 0.4)
        boxes += (
            f"  - {{name: box_{number}, box: {{size: [0.08, 0.08, {height:.3f}]}}, static: true,"
            f" pose: {{xyz: [{x:.3f}, {y:.3f}, {height / 2:.3f}]}}}}\n"
        )

    def pose(arm):
        angle, away = rng.uniform(-np.pi, np.pi), rng.uniform(0.2, reach)
        x, y = away * np.cos(angle), bases[arm][0] + away * np.sin(angle)
        tilt = rng.uniform(-0.6, 0.6, 2)
        rpy = f"[{np.pi + tilt[0]:.3f}, {tilt[1]:.3f}, {rng.uniform(-3, 3):.3f}]"
        return f"{{xyz: [{x:.3f}, {y:.3f}, {rng.uniform(0.15, 0.4):.3f}], rpy: {rpy}}}"

    def joints(arm):
        names = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
        values = rng.uniform([-3, -2.5, -2.2, -3, -3, -3], [3, -0.6, 2.2, 3, 3, 3])
        pairs = zip(names, values, strict=True)
        return "{" + ", ".join(f"{arm}_{name}_joint: {value:.3f}" for name, value in pairs) + "}"

    steps = [f"  - move_to: {{pose: {pose(arm)}}}\n    robot: {arm}\n" for arm in bases]
    both = ", ".join(f"{arm}: {pose(arm)}" for arm in bases)
    steps.append(f"  - move_to: {{poses: {{{both}}}}}\n")
    for _ in range(3):
        inner = (
            f"      - move_to: {{joints: {joints(arm)}}}\n        robot: {arm}\n" for arm in bases
        )
        steps.append("  - parallel:\n" + "".join(inner))
    head = f"scenario: random cell {seed}\nrobots:\n{robots}objects:\n{boxes}steps:\n"
    rest = (
        "expect:\n  - never: collision\n  - within_limits\n"
        "  - clearance: {between: [left, right], at_least: 1.9 mm}\n"
    )
    return head, steps, rest


@pytest.mark.parametrize("seed", [pytest.param(seed, marks=pytest.mark.nightly) for seed in SEEDS])
def test_no_motion_that_was_planned_as_free_collides(seed, tmp_path):
    path, (head, steps, rest) = tmp_path / "a.scenario.yaml", random_cell(seed)
    path.write_text(head + "".join(steps) + rest, encoding="utf-8")
    refused = {problem.line for problem in check_file(path).problems}
    first = head.count("\n") + 1
    kept = []
    for step in steps:
        if refused.isdisjoint(range(first, first + step.count("\n"))):
            kept.append(step)
        first += step.count("\n")
    while kept:  # a goal that can be reached may have no motion to it
        path.write_text(head + "".join(kept) + rest, encoding="utf-8")
        run_case(path, report_dir=tmp_path / "run", stills=False, page=False)
        stored = read_run(tmp_path / "run")
        failed = [step for step in stored.run.steps if step.status == "failed"]
        if not failed:
            break
        assert {step.error_code for step in failed} <= REFUSED
        del kept[int(failed[0].path.removeprefix("steps[").partition("]")[0])]
    assert kept, "every motion was refused: draw other cells"
    assert [verdict.status for verdict in stored.verdicts] == ["passed"] * 3, stored.verdicts
