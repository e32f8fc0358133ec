"""Garbage, clients that die, many points, several bridges: nothing of it ends the bridge."""

import os
import socket
import struct
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import rosless

from harness.core.limits import RTPS_MEMORY, RTPS_PARTIAL, RTPS_PEERS, RTPS_SAMPLE
from harness.plugins.ros.actions import Status
from harness.plugins.ros.domain import free_domain
from harness.plugins.ros.endpoints import DEFAULT, LATCHED, Qos
from harness.plugins.ros.interfaces import decoded, encoded
from harness.plugins.ros.rtps import wire
from harness.plugins.ros.rtps.discovery import Endpoint, announcement
from harness.plugins.ros.rtps.participant import Participant
from harness.plugins.ros.rtps.reader import Reader
from harness.plugins.ros.rtps.sockets import Sockets
from harness.plugins.ros.rtps.wire import Sample
from tests.plugins.ros.bridging import bridge, scenario
from tests.plugins.ros.nodes import ARM, Node, follow, point
from tests.waiting import HANG

HOLD = "- external: {}"
END = [0.2, 0, 0, 0]
DYING = """
import os
from tests.plugins.ros.nodes import Node, follow, point
node = Node(int(os.environ["ROS_DOMAIN_ID"]))
node.ready()
goal = node.arm.send(follow(point(1.0, [0.2, 0, 0, 0])))
node.wait(lambda: goal.is_accepted)
os._exit(9)
"""


def test_garbage_on_the_ports_and_topics_is_ignored(tmp_path):
    rng = np.random.default_rng(0)
    with bridge(scenario(tmp_path, HOLD)) as (node, _):
        trajectory = node.graph.participant.writer(
            "rt/arm_controller/joint_trajectory",
            "trajectory_msgs::msg::dds_::JointTrajectory_",
            DEFAULT,
        )
        node.ready()
        node.wait(lambda: trajectory.matched)
        [address] = {reader.address for reader in trajectory.matched.values()}
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            for size in range(0, 400, 2):
                head = wire.header(node.graph.participant.prefix) if size % 4 else b""
                out.sendto(head + rng.bytes(size), address)
        for size in range(0, 60, 3):
            trajectory.write(b"\0\1\0\0" + rng.bytes(size))
            trajectory.write(b"\0\1\0\0" + struct.pack("<I", 2**31) * 5)
        assert node.send(follow(point(0.1, END))).status is Status.SUCCEEDED


def test_datagrams_that_get_lost_are_sent_again(monkeypatch):
    """A fifth of everything is lost, discovery and fragments of large samples included."""
    rng, send, arrived = np.random.default_rng(0), Sockets.send, []

    def lossy(sockets, datagram, address):
        if rng.random() > 0.2:
            send(sockets, datagram, address)

    monkeypatch.setattr(Sockets, "send", lossy)
    sent = [rng.bytes(4 * int(size)) for size in rng.choice([1, 100, 60_000], 60)]
    with free_domain() as domain:
        one, other = (Participant(domain, name=name) for name in ("one", "other"))
        other.reader("rt/data", "Data_", DEFAULT, lambda sample: arrived.append(sample.payload))
        writer = one.writer("rt/data", "Data_", Qos(depth=100))
        end, left = time.monotonic() + HANG, list(sent)
        while len(arrived) < len(sent) and time.monotonic() < end:
            if writer.matched and left:
                writer.write(left.pop(0))
            one.spin(time.monotonic() + 0.002)
            other.spin(time.monotonic() + 0.002)
        one.close()
        other.close()
    assert [payload[4:] for payload in arrived] == [payload[4:] for payload in sent]


def test_bytes_after_a_message_do_not_count():
    """The serialisation of rclpy leaves some for each point of a trajectory."""
    goal = follow(*(point(0.1 * number, END) for number in range(1, 70)))
    kind = "control_msgs/action/FollowJointTrajectory_Goal"
    again = decoded(encoded(goal, kind) + bytes(280), kind)
    assert encoded(again, kind) == encoded(goal, kind)


@pytest.mark.nightly
def test_ten_thousand_points_are_followed(tmp_path):
    times = np.linspace(1e-4, 0.5, 10_000)
    points = [point(t, [0.4 * t, 0, 0, 0], [0.4 * (t < 0.5), 0, 0, 0]) for t in times]
    with bridge(scenario(tmp_path, HOLD)) as (node, _):
        node.ready()
        assert node.send(follow(*points)).status is Status.SUCCEEDED


@pytest.mark.nightly
def test_a_goal_goes_on_when_its_client_dies(tmp_path):
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[3])}
    with bridge(scenario(tmp_path, HOLD)) as (node, _):
        states = node.listen("/joint_states", "sensor_msgs/msg/JointState")
        environment["ROS_DOMAIN_ID"] = str(node.graph.participant.domain)
        died = subprocess.run([sys.executable, "-c", DYING], env=environment, check=False)
        assert died.returncode == 9
        node.wait(lambda: states and abs(states[-1].position[0] - 0.2) < 0.01)


@pytest.mark.nightly
def test_two_bridges_side_by_side_do_not_hear_each_other(tmp_path):
    (tmp_path / "b").mkdir()
    with (
        bridge(scenario(tmp_path, HOLD)) as (first, one),
        bridge(scenario(tmp_path / "b", HOLD)) as (second, two),
    ):
        first.ready()
        second.ready()
        assert first.graph.participant.domain != second.graph.participant.domain
        assert first.send(follow(point(0.1, END))).status is Status.SUCCEEDED
    assert (one[0].commands, two[0].commands) == (1, 0)


def test_another_implementation_of_the_protocol_reads_the_joints_and_commands_them(tmp_path):
    """rosless is written in Rust on RustDDS; like rclpy, it is not of this program."""
    last = {"positions": END, "time_from_start": {"sec": 0, "nanosec": 10**8}}
    with bridge(scenario(tmp_path), waits=True) as (node, results):
        other = rosless.Node(node.graph.participant.domain)
        topic = other.subscribe("/joint_states", "sensor_msgs/msg/JointState")
        message, end = None, time.monotonic() + HANG
        while message is None and time.monotonic() < end:
            node.sleep(0.05)
            message = topic.read(timeout=0.2)
        topic.close()
        command = "/arm_controller/joint_trajectory"
        publisher = other.advertise(command, "trajectory_msgs/msg/JointTrajectory")
        while not results and time.monotonic() < end:
            publisher.send({"joint_names": ARM, "points": [last]})
            node.sleep(0.5)
    assert results[0].case.outcome == "passed"
    assert message.name[:4] == list(ARM)
    assert len(message.position) == len(message.velocity) == len(message.name)


@pytest.mark.nightly
def test_a_node_that_comes_later_gets_what_is_latched(tmp_path):
    camera = "cameras: [{name: 2nd view, pose: {xyz: [0.5, 0, 0.5]}, look_at: [0, 0, 0]}]"
    with bridge(scenario(tmp_path, HOLD, camera)) as (node, _):
        node.ready()
        late = Node(node.graph.participant.domain)
        description = late.listen("/robot_description", "std_msgs/msg/String", LATCHED)
        static = late.listen("/tf_static", "tf2_msgs/msg/TFMessage", LATCHED)
        moving = late.listen("/tf", "tf2_msgs/msg/TFMessage")
        late.wait(lambda: description and static and moving)
        served = {use.topic for use in late.graph.uses()[1]}
        late.graph.close()
    assert "/_2nd_view/image" in served, "ROS takes no spaces and no digit first"
    assert description[0].data.startswith("<?xml")
    edges = {each.child_frame_id: each.header.frame_id for each in moving[0].transforms}
    assert edges["link2"] == "link1"
    stamps = [each.header.stamp.sec for each in (*static[0].transforms, *moving[0].transforms)]
    assert max(stamps) < 60, "frames have the time of /clock, which begins at 0"
    fixed = {each.child_frame_id: each.header.frame_id for each in static[0].transforms}
    assert fixed["2nd view_optical_frame"] == "world"
    assert {fixed[name] for name in fixed} <= {"world", *fixed, *edges}, "one tree"


def test_participants_beyond_the_ports_of_a_domain_are_not_kept():
    """Programs that announce themselves under a new name each time fill no memory."""
    with free_domain() as domain:
        participant = Participant(domain, name="watched")
        for number in range(3 * RTPS_PEERS):
            prefix = wire.VENDOR + number.to_bytes(10, "big")
            said = announcement(prefix + wire.PARTICIPANT, domain, "x", [("127.0.0.1", 9)])
            participant._receive(wire.header(prefix) + said)  # noqa: SLF001 - as from the network
        assert len(participant._peers) == RTPS_PEERS  # noqa: SLF001 - what is bounded
        participant.close()


def test_samples_that_wait_for_others_are_bounded_in_bytes_and_fragments():
    """A writer that never sends the first sample, and fragments of many samples."""
    heard = []
    own = Endpoint(bytes(15) + b"\x04", "rt/x", "t", DEFAULT)
    guid = bytes(15) + b"\x03"
    reader = Reader(own, lambda *_: None, heard.append)
    reader.match(Endpoint(guid, "rt/x", "t", DEFAULT), ("127.0.0.1", 9))
    whole = bytes(2**20)
    for number in range(2, 2 * RTPS_MEMORY // 2**20):
        reader.take(Sample(own.guid[12:], guid, number, {}, whole))
    [proxy] = reader.matched.values()
    assert proxy.bytes_waiting() <= RTPS_MEMORY
    for number in range(10**6, 10**6 + 100):
        part = Sample(own.guid[12:], guid, number, {}, bytes(8), 1, 8, RTPS_SAMPLE)
        reader.take(part)
    assert len(proxy.partial) == RTPS_PARTIAL
    reader.take(Sample(own.guid[12:], guid, 1, {}, b"first"))
    reader.heartbeat(guid, 1, 1, is_final=True)
    assert heard[0].payload == b"first", "what was sent in order is delivered"
