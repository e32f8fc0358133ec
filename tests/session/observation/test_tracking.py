"""Plan against physics, from recordings made by hand: every number is known."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.plugins.remarks.observers.physics import allowed_contacts, tracking_finding
from harness.session.observation.tracking import as_commanded, held_finding, plan_against_physics
from tests.approved import SAID, finding_text
from tests.judging.synthetic_run import (
    BOX,
    TABLE,
    attachment,
    changed,
    force,
    heights,
    lift_run,
    make_run,
    step,
)

N = 200


def none_nearer(_):
    """Planned distances of the samples: none are known."""
    return {}


def findings(run, kind, distances=none_nearer):
    differences = plan_against_physics(run, run.signals, run.signals, distances)
    every = (*differences, *tracking_finding(run), *allowed_contacts(run))
    SAID.extend(map(finding_text, every))
    return [each for each in every if each.kind == kind]


def test_the_joint_furthest_from_its_command_is_named_and_fingers_are_not():
    positions = np.tile([0.0, 0.02], (N, 1))
    positions[120] = (-0.03, 0.5)
    positions[50, 0] = 0.02
    [found] = findings(make_run(joint_positions=positions), "tracking")
    assert found.time == pytest.approx(1.2)
    assert found.values == {"joint": "shoulder", "error": pytest.approx(0.03), "unit": "rad"}
    sliding = replace(make_run().robot, gripper=None)
    [found] = findings(make_run(joint_positions=positions, robot=sliding), "tracking")
    assert found.values == {"joint": "finger", "error": pytest.approx(0.48), "unit": "m"}


@pytest.mark.parametrize("pair", [("arm_link", "box"), ("box", "arm_link")])
def test_an_allowed_contact_is_reported_with_its_time_and_force(pair):
    forces = {pair: force(N, (30, 40), (60, 65), value=2.0)}
    forces[pair][62] = 7.0
    run = make_run(contact_forces=forces, allowed_contacts=(("box", "arm_link"),))
    [found] = findings(replace(run, timestep=0.01), "allowed_contact")
    assert found.time == pytest.approx(0.3)
    assert found.values == {
        "pair": list(pair), "seconds": pytest.approx(0.15), "peak_force": 7.0
    }  # fmt: skip
    assert "as the SRDF allows" in found.message
    assert findings(make_run(contact_forces=forces), "allowed_contact") == []


@pytest.mark.parametrize(
    ("allowed", "counts"),
    [
        (["arm_link", "box"], True),
        (["box", "arm_link"], True),
        (["robot", "box"], True),
        (["box", "robot"], True),
        (["palm", "box"], False),
        (["box", "palm"], False),
        (["Table", "arm_link"], False),
        (["Table", "robot"], False),
        (["arm_link", "robot"], False),
        (["arm_link", "Table"], False),
        (["robot", "Table"], False),
    ],
)
def test_a_step_allows_contacts_of_its_pair_while_it_lasts(allowed, counts):
    """The step's samples are 40 to 59; its first and last one count, those next to it do not."""
    steps = (step("touch", 40, 60, "allow_collisions", result={"allowed_collisions": [allowed]}),)
    forces = {("arm_link", "box"): force(N, (10, 41), (59, 90))}
    run = replace(make_run(contact_forces=forces, steps=steps), timestep=0.01)
    found = findings(run, "allowed_contact")
    assert len(found) == counts
    for each in found:
        assert each.values["seconds"] == pytest.approx(0.02)
        assert each.time == pytest.approx(0.4)
        assert "step touch allows" in each.message


def moved(name, start, stop):
    return step(name, start, stop, trajectory=object())


def test_each_motion_is_compared_where_it_came_nearest_and_the_nearest_is_always_reported():
    near = np.full(N, 0.5)
    near[[20, 90]] = 0.05, 0.03
    run = make_run(
        steps=(moved("out", 0, 50), step("rest", 50, 80), moved("back", 80, 150)),
        clearances={("robot", "box"): near, ("robot", "Table"): near + 0.001},
    )
    rows = []

    def planned(signals, pairs):
        rows.append(signals.times)
        assert pairs == {("robot", "box")}
        return {("robot", "box"): np.array([0.0512, 0.0305])}

    back, out = findings(run, "clearance", planned)
    assert rows[0] == pytest.approx([0.2, 0.9])
    assert (back.step, out.step) == ("back", "out")
    assert back.values == {"pair": ["robot", "box"], "actual": 0.03, "planned": 0.0305}
    assert (back.time, out.time) == (pytest.approx(0.9), pytest.approx(0.2))
    assert "robot and box" in back.message

    def alike(*_):
        return {("robot", "box"): np.array([0.0509, 0.0305])}

    assert [each.step for each in findings(run, "clearance", alike)] == ["back"]


def test_set_points_carry_what_is_attached_and_fingers_stay():
    class Straight:
        """The palm is as high as the shoulder's number."""

        def link_poses(self, positions, links):
            assert links == ["palm"]
            return heights(positions[:, 0])[:, None]

    commands = np.tile([0.7, 0.01], (N, 1))
    commands[150:, 0] = np.nan
    held = attachment("box", 50, 100, pose=SE3.from_xyz_rpy((0, 0, -0.1)))
    run = make_run(joint_commands=commands, attachments=[held])
    signals = as_commanded(run, Straight())
    assert signals.joint_positions[:150, 0].tolist() == [0.7] * 150
    assert signals.joint_positions[150:, 0].tolist() == [0.0] * 50, "unknown: as it was"
    assert signals.joint_positions[:, 1].tolist() == [0.02] * N
    box = signals.object_poses["box"][:, 2]
    assert box[50:101] == pytest.approx([0.6] * 51)
    assert box[[49, 101]] == pytest.approx([0.02] * 2)
    assert run.signals.object_poses["box"][60, 2] == pytest.approx(0.02), "the record is kept"


def slid(by, after=150):
    """A lift after which the box slides down in the hand."""
    run = lift_run(attachments=[attachment("box", 60, N)])
    poses = run.signals.object_poses["box"].copy()
    poses[after:, 2] -= by
    return changed(run, object_poses={**run.signals.object_poses, "box": poses})


def test_a_held_object_is_reported_with_its_largest_drift():
    run = slid(0.002)
    found = held_finding(run, run.attachments[0])
    assert found.values["held"] is True
    assert found.values["drift"] == pytest.approx(0.002)
    assert "moved 2.0 mm" in found.message


@pytest.mark.parametrize(
    ("drift", "last_grip", "is_lost"),
    [(0.0035, 140, True), (0.0025, 140, False), (0.0035, 194, False)],
)
def test_an_object_is_lost_that_drifts_by_more_than_3_mm_and_left_the_fingers(
    drift, last_grip, is_lost
):
    """Fingers that touch it less than 50 ms before the end of the hold still held it."""
    run = slid(drift)
    forces = dict(run.signals.contact_forces)
    for finger in ("left_finger", "right_finger"):
        forces[finger, "box"] = force(N, (50, last_grip), value=2.0)
    run = changed(run, contact_forces=forces)
    found = held_finding(run, run.attachments[0])
    assert found.values["held"] is not is_lost
    assert ("lost it" in found.message) is is_lost


def test_an_object_that_the_fingers_never_held_is_a_belief():
    [belief] = findings(make_run(attachments=[attachment("box", 20, 80)]), "held")
    assert belief.values == {"object": "box", "believed": True, "held": False}
    assert belief.time == pytest.approx(0.2)
    assert "from 0.20 s to 0.80 s; the fingers did not meanwhile" in belief.message
    planner_only = replace(BOX, in_simulation=False)
    run = make_run(objects=(TABLE, planner_only), attachments=[attachment("box", 20, 80)])
    assert findings(run, "held") == []


def test_an_attachment_that_lasts_no_time_is_no_belief():
    assert findings(make_run(attachments=[attachment("box", 20, 20)]), "held") == []
    assert findings(make_run(attachments=[attachment("box", 100, 100)]), "held") == []


def test_a_pair_without_distances_in_a_motion_does_not_hide_the_next_one():
    absent, near = np.full(N, np.nan), np.full(N, 0.5)
    near[77] = 0.04
    clearances = {("robot", "absent"): absent, ("robot", "box"): near, ("box", "Table"): near - 0.3}
    run = make_run(steps=(step("rest", 0, 70), moved("go", 70, 101)), clearances=clearances)
    [found] = findings(run, "clearance", lambda *_: {("robot", "box"): np.array([0.04])})
    assert (found.time, found.values["actual"]) == (pytest.approx(0.77), 0.04)
    assert findings(run, "clearance", lambda *_: {}) == [], "the set points' is not known"
