"""The bridge and a node over RTPS, in one process, with the real physics."""

import re

import cv2
import numpy as np
import pytest

from harness.plugins.ros.actions import CancelCode, Status, uuid_of
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.control.goals import Code
from harness.plugins.ros.endpoints import LATCHED
from harness.plugins.ros.handover import replay
from harness.plugins.ros.interfaces import CANCEL, TRAJECTORY
from harness.recording.read_run import read_run
from tests.plugins.ros.bridging import bridge, scenario
from tests.plugins.ros.nodes import ARM, duration, follow, grip, point, tolerance, trajectory
from tests.robot.models import robot

HOLD = "- external: {}"
END = [0.2, 0, 0, 0]


def test_a_node_moves_the_arm_and_the_recording_replays_to_the_same_digest(tmp_path):
    with bridge(scenario(tmp_path), waits=True, run={"report_dir": tmp_path / "run"}) as (
        node,
        results,
    ):
        states = node.listen("/joint_states", "sensor_msgs/msg/JointState")
        node.ready()
        goal = node.send(follow(point(0.4, END)))
        assert (goal.is_accepted, goal.status) == (True, Status.SUCCEEDED)
        assert goal.result.error_code == Code.SUCCESSFUL
        assert goal.feedback
        assert list(goal.feedback[0].joint_names) == list(ARM)
    [result] = results
    assert result.case.outcome == "passed"
    assert result.commands == 1
    assert states[-1].name[:4] == list(ARM)
    assert states[-1].position[0] == pytest.approx(0.2, abs=0.01)
    again = replay(tmp_path / "run")
    assert again.outcome == "passed"
    assert again.digest == result.case.digest


def test_invalid_goals_are_rejected_and_their_results_have_the_error_codes(tmp_path):
    with bridge(scenario(tmp_path, HOLD)) as (node, results):
        states = node.listen("/joint_states", "sensor_msgs/msg/JointState")
        node.ready()
        codes = {
            "no such joint": follow(point(0.1, END), joints=("joint1", "joint2", "elbow", "wrist")),
            "missing": follow(point(0.1, [0.1]), joints=("joint1",)),
            "not rising": follow(point(0.2, END), point(0.2, END)),
            "beyond the limits": follow(point(0.1, [9.0, 0, 0, 0])),
            "not a number": follow(point(0.1, [np.nan, 0, 0, 0])),
            "empty": follow(),
            "ragged": follow(point(0.1, END), point(0.2, [0.0])),
            "ends in motion": follow(point(0.1, END, [1.0, 0, 0, 0])),
        }
        ended = {name: node.send(goal) for name, goal in codes.items()}
        node.wait(lambda: states and states[-1].header.stamp.nanosec > 2e8)
        late = follow(point(0.1, END))
        late.trajectory.header.stamp.nanosec = 1
        ended["old"] = node.send(late)
    assert {name: Code(goal.result.error_code).name for name, goal in ended.items()} == {
        "no such joint": "INVALID_JOINTS",
        "missing": "INVALID_JOINTS",
        "not rising": "INVALID_GOAL",
        "beyond the limits": "INVALID_GOAL",
        "not a number": "INVALID_GOAL",
        "empty": "INVALID_GOAL",
        "ragged": "INVALID_GOAL",
        "ends in motion": "INVALID_GOAL",
        "old": "OLD_HEADER_TIMESTAMP",
    }
    assert all(goal.status is Status.UNKNOWN for goal in ended.values())
    assert not any(goal.is_accepted for goal in ended.values())
    assert "no joint 'elbow', 'wrist'" in ended["no such joint"].result.error_string
    assert results[0].case.outcome == "passed"


@pytest.mark.nightly
def test_only_tolerances_of_the_controllers_file_end_a_motion_that_is_blocked(tmp_path):
    """The OpenMANIPULATOR-X's file has none: the lesson's node presses, and lifts again."""
    assert robot(model="open_manipulator_x").controller_tolerances is None
    ur = robot(model="ur5e").controller_tolerances
    assert (ur.trajectory, ur.goal) == (0.2, 0.1)
    into_the_ground, back = [0, 1.4, 0.9, 0], [0, 0.5, 0, 0]
    with bridge(scenario(tmp_path, HOLD), factor=2.0) as (node, _):
        states = node.listen("/joint_states", "sensor_msgs/msg/JointState")
        node.ready()
        pressed = node.send(follow(point(1.5, into_the_ground)))
        assert abs(states[-1].position[1] - 1.4) > 0.2
        assert pressed.status is Status.SUCCEEDED
        assert node.send(follow(point(1.5, back))).status is Status.SUCCEEDED
        node.wait(lambda: abs(states[-1].position[1] - 0.5) < 0.02)


def test_tolerances_cancel_and_preemption(tmp_path):
    with bridge(scenario(tmp_path, HOLD)) as (node, _):
        node.ready()
        tight = [tolerance("joint1", 1e-6)]
        strayed = node.send(follow(point(0.2, [0.5, 0, 0, 0]), path_tolerance=tight))
        assert strayed.result.error_code == Code.PATH_TOLERANCE_VIOLATED
        assert "'joint1' is off by" in strayed.result.error_string
        missed = node.send(
            follow(
                point(0.2, [0.0, 0, 0, 0]),
                goal_tolerance=[tolerance("joint1", 1e-9)],
                goal_time_tolerance=duration(0.05),
            )
        )
        assert missed.result.error_code == Code.GOAL_TOLERANCE_VIOLATED
        first = node.arm.send(follow(point(5.0, END)))
        node.wait(lambda: first.is_accepted)
        second = node.arm.send(follow(point(5.0, END)))
        node.wait(lambda: first.is_over)
        assert (first.status, first.result.error_code) == (Status.ABORTED, Code.INVALID_GOAL)
        assert "newer command" in first.result.error_string
        node.arm.cancel(second)
        node.wait(lambda: second.is_over)
        assert second.status is Status.CANCELED
        cancel, codes = node.graph.client(f"{node.arm.name}/_action/cancel_goal", CANCEL), []
        node.wait(cancel.is_ready)
        for identifier in (second.identifier, "ab" * 16):
            info = message("action_msgs/msg/GoalInfo", goal_id=uuid_of(identifier))
            request = message(f"{CANCEL}_Request", goal_info=info)
            cancel.call(request, lambda response: codes.append(response.return_code))
        node.wait(lambda: len(codes) == 2)
        assert codes == [CancelCode.TERMINATED, CancelCode.UNKNOWN_GOAL]


def test_the_command_topic_moves_the_arm_and_what_it_cannot_follow_is_ignored(tmp_path):
    said = []
    with bridge(scenario(tmp_path), waits=True, say=said.append) as (node, results):
        publisher = node.graph.advertise("/arm_controller/joint_trajectory", TRAJECTORY)
        node.ready()
        node.wait(lambda: publisher.subscribers)
        for _ in range(3):
            publisher.publish(trajectory(point(0.3, END), joints=("knee",) * 4))
        publisher.publish(trajectory(point(0.3, END)))
    assert results[0].case.outcome == "passed"
    assert results[0].commands == 4
    [note] = said
    assert "this controller has no joint 'knee'" in note


@pytest.mark.nightly
def test_publishers_of_a_topic_hear_of_an_abort_and_its_reason(tmp_path):
    """UR's controllers have tolerances, and the arm cannot jump by half a turn in 10 ms."""
    said = []
    with bridge(scenario(tmp_path, HOLD, robot="{model: ur5e}"), say=said.append) as (node, _):
        log = node.listen("/rosout", "rcl_interfaces/msg/Log", LATCHED)
        topic = "/joint_trajectory_controller/joint_trajectory"
        publisher = node.graph.advertise(topic, TRAJECTORY)
        node.wait(lambda: publisher.subscribers)
        names = [joint.name for joint in robot(model="ur5e").movable_joints[:6]]
        rows = [point(0.01, [1.5, -1.5, 0, 0, 0, 0]), point(2.0, [0.0] * 6)]
        publisher.publish(trajectory(*rows, joints=names))
        node.wait(lambda: said and log)
    assert "a trajectory from a topic is aborted: path tolerance: '" in said[0]
    assert log[0].msg == said[0]


@pytest.mark.nightly
def test_the_path_of_the_tcp_is_published_as_by_the_course_s_trajectory_server(tmp_path):
    with bridge(scenario(tmp_path, HOLD)) as (node, _):
        paths = node.listen("/trajectory", "nav_msgs/msg/Path")
        node.ready()
        node.send(follow(point(2.0, [1.0, 0, 0, 0])))
        node.wait(lambda: paths and len(paths[-1].poses) > 4)
    places = np.array([(p.pose.position.x, p.pose.position.y) for p in paths[-1].poses])
    assert (np.linalg.norm(np.diff(places, axis=0), axis=1) >= 0.02).all()
    assert paths[-1].header.frame_id == "world"


@pytest.mark.nightly
def test_a_sensor_of_force_and_torque_is_published(tmp_path):
    arm = "{model: open_manipulator_x, wrench_sensors: {hand: link5}}"
    with bridge(scenario(tmp_path, HOLD, robot=arm)) as (node, _):
        wrenches = node.listen("/hand/wrench", "geometry_msgs/msg/WrenchStamped")
        node.wait(lambda: len(wrenches) > 5)
    force = wrenches[-1].wrench.force
    links = {link.name: link for link in robot(model="open_manipulator_x").links}
    carried = ("link5", "gripper_left_link", "gripper_right_link")
    weight = 9.8 * sum(links[name].inertial.mass for name in carried)
    assert np.linalg.norm([force.x, force.y, force.z]) == pytest.approx(weight, rel=0.01)
    assert wrenches[-1].header.frame_id == "link5"
    assert wrenches[-1].header.stamp.sec < 60, "the clock of the bridge begins at 0"


@pytest.mark.nightly
def test_cameras_send_pictures_while_someone_watches(tmp_path):
    with bridge(scenario(tmp_path)) as (node, _):
        images = node.listen("/gripper_camera/image", "sensor_msgs/msg/Image")
        small = node.listen("/gripper_camera/image/compressed", "sensor_msgs/msg/CompressedImage")
        info = node.listen("/gripper_camera/image/camera_info", "sensor_msgs/msg/CameraInfo")
        node.wait(lambda: images and small and info)
        node.send(follow(point(0.1, END)))
    picture = images[0].data.reshape(480, 640, 3)
    assert (images[0].encoding, images[0].step) == ("rgb8", 640 * 3)
    assert images[0].header.frame_id == "gripper_camera_link_optical"
    decoded = cv2.imdecode(small[0].data, cv2.IMREAD_COLOR_RGB)
    assert np.abs(decoded.astype(int) - picture).mean() < 12
    assert info[0].k[2] == 320


@pytest.mark.nightly
def test_a_camera_that_is_drawn_more_slowly_than_its_rate_is_said(tmp_path):
    camera = (
        "cameras:\n  - {name: wide, image: {width: 1280, height: 960}, update_rate: 100,"
        " pose: {xyz: [1, 0, 1]}, look_at: [0, 0, 0]}\n"
    )
    with bridge(scenario(tmp_path, HOLD, camera)) as (node, results):
        images = node.listen("/wide/image", "sensor_msgs/msg/Image")
        node.wait(lambda: len(images) > 1)
    [said] = [each for each in results[0].remarks if "pictures of 'wide'" in each]
    sent, requested = map(int, re.findall(r"\d+", said)[:2])
    assert 2 <= sent < requested
    assert "s late in simulated time" in said


def test_a_gripper_stalls_on_an_object(tmp_path):
    steps = HOLD
    box = """objects:
  - name: block
    box: {size: [0.02, 0.04, 0.04]}
    mass: 10 g
    static: true
    pose: {frame: end_effector_link}
"""
    with bridge(scenario(tmp_path, steps, box)) as (node, _):
        node.ready()
        opened = node.send(grip(0.015), node.gripper)
        assert (opened.result.reached_goal, opened.result.stalled) == (True, False)
        assert 0 < max(each.position for each in opened.feedback) <= 0.016
        closed = node.send(grip(-0.005), node.gripper)
        assert (closed.result.reached_goal, closed.result.stalled) == (False, True)
        refused = node.send(grip(0.5), node.gripper)
        assert refused.is_accepted is False


@pytest.mark.nightly
def test_twenty_recorded_sessions_replay_to_their_digests(tmp_path):
    """Each session has commands at other moments: the wall clock chose them."""
    digests = {}
    for number in range(20):
        folder = tmp_path / str(number)
        folder.mkdir()
        run = {"report_dir": folder / "run"}
        with bridge(scenario(folder), waits=True, run=run) as (node, results):
            node.ready()
            first = node.arm.send(follow(point(0.5, [0.1, 0.1, 0, 0])))
            node.sleep(0.01 * number)
            node.arm.cancel(first)
            node.gripper.send(grip(0.001 * number))
            node.send(follow(point(0.4, END)))
        digests[number] = results[0].case.digest
        assert replay(folder / "run").digest == digests[number]
    assert len(set(digests.values())) > 10


@pytest.mark.nightly
def test_a_step_takes_the_time_of_a_position_interface_and_is_repeated_by_a_replay(tmp_path):
    """The course's keyboard node sends 0.05 rad with a time_from_start of 0."""
    folder = tmp_path / "run"
    with bridge(scenario(tmp_path, HOLD), run={"report_dir": folder}) as (node, results):
        publisher = node.graph.advertise("/arm_controller/joint_trajectory", TRAJECTORY)
        node.ready()
        node.wait(lambda: publisher.subscribers)
        states = node.listen("/joint_states", "sensor_msgs/msg/JointState")
        node.wait(lambda: states)
        publisher.publish(trajectory(point(0.0, [0.05, 0, 0, 0])))
        node.wait(lambda: abs(states[-1].position[0] - 0.05) < 1e-3)
    run = read_run(folder).run
    begin = run.commands[0].time
    times, positions = run.signals.times, run.signals.joint_positions[:, 0]
    done = times[np.argmax(positions > 0.05 * (1 - np.exp(-1)))] - begin
    assert 0.05 < done < 0.2
    assert np.abs(run.signals.joint_velocities[:, 0]).max() < 0.6
    assert positions.max() < 0.055
    assert replay(folder).digest == results[0].case.digest
