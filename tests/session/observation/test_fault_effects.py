"""Whether a fault had an effect, from recordings made by hand: each at both sides of its limit."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.plugins.faults.observers.faults import COMMANDED, FaultsObserver
from harness.recording.faults import InjectedFault, InjectedFaults, faults_of
from tests.approved import SAID, finding_text
from tests.judging.synthetic_run import BOX, DT, ROBOT, TABLE, at, force, make_run, step

N = 100


def receipts(faults, run, more=()):
    """The faults of the first step with their receipts, and the findings."""
    first = step("first", 10, 20, "inject", result={"faults": [each.plain() for each in faults]})
    steps, findings = FaultsObserver().observe((first, *more), run.signals, ROBOT, run.objects)
    SAID.extend(map(finding_text, findings))
    return faults_of(steps[0]), findings


def receipt(fault, *, more=(), **signals):
    [answer], findings = receipts([fault], make_run(N, **signals), more)
    findings = [each for each in findings if each.step == "first"]
    assert len(findings) == (answer.receipt == "no_effect")
    if findings:
        assert (findings[0].kind, findings[0].step) == ("fault_without_effect", "first")
        assert findings[0].time == pytest.approx(0.1)
    return answer


def evidence(is_landed, fault, **options):
    """The evidence of a fault, which must have had an effect, or none."""
    answer = receipt(fault, **options)
    assert answer.receipt == ("landed" if is_landed else "no_effect")
    return answer.evidence


def ramp(column, by, start=30, stop=60, level=(0.0, 0.02)):
    """Two joints of which one moves by an amount over some samples, shape (N, 2)."""
    rows = np.tile(np.array(level), (N, 1))
    rows[:, column] += by * np.clip((np.arange(N) - start) / (stop - start), 0, 1)
    return rows


def going(speed, start=12, stop=18):
    """The box moves along x over some samples."""
    poses = at(N, (0, 0, 0.02))
    poses[:, 0] = speed * DT * np.clip(np.arange(N) - start, 0, stop - start)
    return poses


FRICTION = InjectedFault("friction", "box", 1.0, 0.1)
STALL = InjectedFault("joint_stall", "shoulder", False, True)
PUSH = InjectedFault("push", "box", (0, 0, 0), (1, 0, 0))
NOISE = InjectedFault("sensor_noise", "", 0.0, 0.01)
LATENCY = InjectedFault("command_latency", "", 0.0, 0.1)
EFFORT = InjectedFault("gripper_effort", "", 1.0, 0.4)


def test_a_fault_that_changes_nothing_has_no_effect():
    answer = receipt(InjectedFault("friction", "box", 0.5, 0.5))
    assert (answer.receipt, answer.evidence) == ("no_effect", "it was so already")


@pytest.mark.parametrize(("speed", "landed"), [(0.0011, True), (0.0009, False)])
def test_a_push_lands_where_the_object_gains_more_than_a_millimetre_a_second(speed, landed):
    answer = receipt(PUSH, object_poses={"box": going(speed)})
    assert (answer.receipt == "landed") is landed
    outside = receipt(PUSH, object_poses={"box": going(1.0, 25, 40)})
    assert outside.receipt == "no_effect", "what moves after the push's step was not pushed"
    before = receipt(PUSH, object_poses={"box": going(0.5, 0, 90)})
    assert before.receipt == "no_effect", "it moved as fast before"
    assert "250 mm/s" in receipt(PUSH, object_poses={"box": going(0.25)}).evidence


@pytest.mark.parametrize("direction", [(1, 0, 0), (0.3, -2, 0)])
def test_what_settles_while_it_is_pushed_from_the_side_is_not_moved_by_the_push(direction):
    """Objects fall by 0.1 mm at the start of a run."""
    settling = at(N, (0, 0, 0.02))
    settling[:, 2] -= 1e-4 * np.clip(np.arange(N) / 5, 0, 1)
    first = step("first", 0, 10, "inject", result={"faults": [PUSH.plain()]})
    push = InjectedFault("push", "box", (0, 0, 0), direction)
    first = replace(first, result=first.result.replaced(InjectedFaults((push,))))
    pushed = settling.copy()
    pushed[:, :3] += np.outer(0.01 * DT * np.arange(N), direction)
    for poses, receipt_of in ((settling, "no_effect"), (pushed, "landed")):
        run = make_run(N, object_poses={"box": poses})
        steps, _ = FaultsObserver().observe((first,), run.signals, ROBOT, (TABLE, BOX))
        assert faults_of(steps[0])[0].receipt == receipt_of


@pytest.mark.parametrize("start", [0, 10])
def test_a_push_of_one_sample_shows_in_the_motion_after_it(start):
    first = step("first", start, start + 1, "inject", result={"faults": [PUSH.plain()]})
    run = make_run(N, object_poses={"box": going(0.5, start, 60)})
    steps, _ = FaultsObserver().observe((first,), run.signals, ROBOT, (TABLE, BOX))
    assert faults_of(steps[0])[0].receipt == "landed"


@pytest.mark.parametrize(("by", "landed"), [(0.00011, True), (COMMANDED, False), (0.00009, False)])
def test_a_stall_lands_where_the_joint_is_commanded_to_move(by, landed):
    answer = receipt(STALL, joint_commands=ramp(0, by), joint_positions=ramp(0, 0.0))
    assert (answer.receipt == "landed") is landed
    moves = {"joint_commands": ramp(0, 0.5), "joint_positions": ramp(0, 0.25)}
    assert evidence(True, STALL, **moves) == "commanded to move by 0.5 rad, it moved by 0.25 rad"
    sliding = InjectedFault("joint_stall", "finger", False, True)
    moves = {"joint_commands": ramp(1, 0.01), "joint_positions": ramp(1, 0.005)}
    assert evidence(True, sliding, **moves) == "commanded to move by 0.01 m, it moved by 0.005 m"


def test_a_fault_counts_from_the_last_sample_of_its_step_until_it_is_set_again():
    """The fault's step ends at sample 20, the next one of the same fault begins at sample 40."""
    again = step(
        "again", 40, 50, "inject",
        result={"faults": [InjectedFault("joint_stall", "shoulder", True, False).plain()]},
    )  # fmt: skip
    other = step("other", 22, 24, "inject", result={"faults": [FRICTION.plain()]})
    for start, stop, landed in ((18, 19, False), (19, 20, True), (38, 39, True), (40, 41, False)):
        commands = ramp(0, 0.5, start, stop)
        answer = receipt(STALL, more=(other, again), joint_commands=commands)
        assert (answer.receipt == "landed") is landed, (start, stop)
    assert answer.evidence == "it was not commanded to move before it was set again"
    assert receipt(STALL).evidence == "it was not commanded to move afterwards"
    assert receipt(STALL, joint_commands=ramp(0, 0.5, 98, 99)).receipt == "landed"


def test_friction_matters_where_the_hand_grips_or_the_object_slides():
    gripped = {("left_finger", "box"): force(N, (50, 60))}
    said = evidence(True, FRICTION, contact_forces=gripped)
    assert said == "it was gripped, or slid in contact, for 0.10 s afterwards"
    early = {("left_finger", "box"): force(N, (5, 15))}
    assert evidence(False, FRICTION, contact_forces=early)
    table = {("Table", "box"): force(N, (0, N))}
    said = evidence(False, FRICTION, contact_forces=table)
    assert said == "nothing pulled at it afterwards"
    for speed, is_landed in ((0.0011, True), (0.0009, False)):
        sliding = {"box": going(speed, 40, 60)}
        assert evidence(is_landed, FRICTION, contact_forces=table, object_poses=sliding)
        assert evidence(False, FRICTION, object_poses=sliding), "it touches nothing"
    reverse = {("box", "Table"): force(N, (0, N))}
    poses = {"box": going(0.1, 40, 60)}
    assert "for 0.20 s" in evidence(True, FRICTION, contact_forces=reverse, object_poses=poses)


def test_the_gripper_s_effort_matters_while_fingers_press_something():
    pressed = {("box", "right_finger"): force(N, (40, 65))}
    said = evidence(True, EFFORT, contact_forces=pressed)
    assert said == "the gripper pressed for 0.25 s with 40% of its effort"
    idle = {("arm_link", "box"): force(N, (40, 65))}
    said = evidence(False, EFFORT, contact_forces=idle)
    assert said == "the gripper pressed on nothing afterwards"


def test_noise_and_latency_say_by_how_much_and_zero_sets_them_back():
    positions = ramp(0, 0.0)
    positions[50, 0] = -0.04
    positions[19, 0] = 0.5
    said = evidence(True, NOISE, joint_positions=positions)
    assert said == "joints were up to 2.3 deg off their set points"
    for fault in (NOISE, LATENCY):
        back = InjectedFault(fault.fault, "", 0.1, 0.0)
        assert evidence(True, back) == "set back"
    assert evidence(False, LATENCY) == "no joint was commanded to move afterwards"
    moves = {"joint_commands": ramp(0, 0.3), "joint_positions": ramp(0, 0.0)}
    assert (
        evidence(True, LATENCY, **moves) == "joints lagged up to 17.2 deg behind their set points"
    )
    for by, is_landed in ((0.00011, True), (COMMANDED, False), (0.00009, False)):
        assert evidence(is_landed, LATENCY, joint_commands=ramp(0, by))


def test_noise_of_the_last_sample_alone_is_not_seen():
    last = step("first", 90, N, "inject", result={"faults": [NOISE.plain()]})
    steps, findings = FaultsObserver().observe((last,), make_run(N).signals, ROBOT, (TABLE, BOX))
    assert faults_of(steps[0])[0].evidence == "no time passed afterwards"
    assert len(findings) == 1


def test_steps_without_faults_stay_as_they_are_and_each_fault_has_its_receipt():
    plain = step("plain", 30, 40)
    first = step("first", 10, 20, "inject", result={"faults": [STALL.plain(), PUSH.plain()]})
    run = make_run(N, joint_commands=ramp(0, 0.5))
    steps, findings = FaultsObserver().observe((first, plain), run.signals, ROBOT, (TABLE, BOX))
    assert steps[1] is plain
    assert [each.receipt for each in faults_of(steps[0])] == ["landed", "no_effect"]
    [found] = findings
    assert found.message == f"push of box had no effect: {faults_of(steps[0])[1].evidence}"


def test_a_fault_that_is_set_again_in_the_next_step_ends_there():
    again = step("again", 40, 50, "inject", result={"faults": [STALL.plain()]})
    assert receipt(STALL, more=(again,), joint_commands=ramp(0, 0.5, 60, 70)).receipt == "no_effect"


@pytest.mark.parametrize(("start", "landed"), [(19, False), (20, False), (21, True)])
def test_a_fault_that_is_set_again_at_once_lasts_for_no_time(start, landed):
    """The fault counts from sample 19 on; the joint is commanded to move from there to 20."""
    again = step("again", start, 50, "inject", result={"faults": [STALL.plain()]})
    answer = receipt(STALL, more=(again,), joint_commands=ramp(0, 0.5, 19, 20))
    assert (answer.receipt == "landed") is landed


def test_a_push_that_took_no_time_moved_nothing():
    first = step("first", 20, 20, "inject", result={"faults": [PUSH.plain()]})
    run = make_run(N, object_poses={"box": going(1.0, 20, 60)})
    steps, _ = FaultsObserver().observe((first,), run.signals, ROBOT, (TABLE, BOX))
    [answer] = faults_of(steps[0])
    assert (answer.receipt, answer.evidence) == (
        "no_effect",
        "it did not move: friction or a hand held it",
    )


def test_a_push_that_only_turns_an_object_lands_and_a_step_that_puts_it_elsewhere_does_not():
    """The corners of the cube are 35 mm from its middle; a turn of 0.001 rad is 3.5 mm/s."""
    turning, put = at(N), at(N)
    for row in range(12, N):
        turning[row, 3:] = SE3.from_xyz_rpy(rpy=(0, 0, 0.001 * (row - 12))).quat_wxyz
    put[13:, 0] = 0.5
    assert receipt(PUSH, object_poses={"box": turning}).receipt == "landed"
    there = replace(BOX, present=((0.0, 0.12), (0.12, 1e9)))
    run = make_run(N, objects=(TABLE, there), object_poses={"box": put})
    [fault], _ = receipts([PUSH], run)
    assert fault.receipt == "no_effect"
