"""Where objects that only the planner knows stood, and what is measured to them."""

import numpy as np

from tests.session.front_door import failures, run

ROBOT = "{model: ur3e, base: {xyz: [0, 0, 0.5]}}"
BOX = "box: {size: [0.1, 0.1, 0.1]}, static: true, in: planning"


def test_a_moved_object_of_the_planner_alone_stood_where_it_stood_before(tmp_path):
    """Were it taken to stand at its last place all the time, it would never have come near."""
    result, record = run(
        tmp_path,
        f"""
        - add_object: {{name: ghost, {BOX}, pose: {{frame: wrist_3_link, xyz: [0, 0, 0.2]}}}}
        - wait: 0.05 s
          id: near
          expect: [{{clearance: {{between: [robot, ghost], at_least: 30 cm}}}}]
        - move_object: {{object: ghost, pose: {{xyz: [3, 0, 0.5]}}}}
        - wait: 0.05 s
          expect: [{{clearance: {{between: [robot, ghost], at_least: 30 cm}}}}]
        - remove_object: ghost
        - wait: 0.05 s
        """,
        robot=ROBOT,
    )
    (failure,) = failures(result)
    assert "30" in failure
    assert next(v for v in result.verdicts if v.status == "failed").step == "near"
    poses = record.signals.object_poses["ghost"]
    assert len(poses) == 151
    assert np.isfinite(poses[:101]).all()
    assert np.isnan(poses[101:]).all()
    np.testing.assert_allclose(poses[60:101, 0], 3.0)
    assert np.abs(poses[:50, 0]).max() < 1.0


def test_what_was_carried_stays_where_the_planner_let_it_go(tmp_path):
    result, record = run(
        tmp_path,
        f"""
        - attach_object:
            object: {{name: ghost, {BOX}, pose: {{frame: wrist_3_link, xyz: [0, 0, 0.2]}}}}
            link: wrist_3_link
            touch_links: [wrist_3_link, wrist_2_link]
        - ptp: {{joints: {{wrist_1_joint: -1.0}}}}
          id: carried
        - detach_object: ghost
        - ptp: {{joints: {{wrist_1_joint: -1.5, shoulder_pan_joint: 0.5}}}}
        """,
        robot=ROBOT,
    )
    assert result.outcome == "passed"
    poses = record.signals.object_poses["ghost"]
    carried = next(step for step in record.steps if step.id == "carried")
    assert np.linalg.norm(poses[carried.end_index - 1, :3] - poses[0, :3]) > 0.04
    np.testing.assert_array_equal(
        poses[carried.end_index :], np.broadcast_to(poses[-1], poses[carried.end_index :].shape)
    )
