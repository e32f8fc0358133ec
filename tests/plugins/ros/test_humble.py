"""Clients of ROS 2 Humble, whose messages of MoveIt have fewer fields."""

import time
from contextlib import closing

import pytest

from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.domain import free_domain
from harness.plugins.ros.endpoints import Qos
from harness.plugins.ros.interfaces import (
    LATER_THAN_HUMBLE,
    decoded,
    encoded,
    register_move_group,
)
from harness.plugins.ros.moveit.values import NUMBERS
from harness.plugins.ros.rtps import wire
from harness.plugins.ros.rtps.graph import DISCOVERY, INFO, SERVICE_QOS, Graph, dds_type
from harness.plugins.ros.rtps.participant import Participant
from tests.plugins.ros.bridging import bridge, scenario
from tests.plugins.ros.move_group_client import GROUP, UR, moveit, pose, stamped
from tests.waiting import wait_for

IK, PATH = "moveit_msgs/srv/GetPositionIK", "moveit_msgs/srv/GetCartesianPath"


class HumbleClient:
    """Calls services as rmw_fastrtps of Humble does: its vendor, and no type hash."""

    def __init__(self, domain, monkeypatch):
        with monkeypatch.context() as patch:
            patch.setattr(wire, "VENDOR", wire.FAST_DDS)
            self.participant = Participant(domain, name="humble")
        self.close = self.participant.close

    def call(self, node, name, kind, request):
        """The response, read as Humble reads it, and its bytes."""
        answers = []
        reader = self.participant.reader(
            f"rr/{name}Reply", dds_type(f"{kind}_Response"), SERVICE_QOS, answers.append
        )
        writer = self.participant.writer(
            f"rq/{name}Request", dds_type(f"{kind}_Request"), SERVICE_QOS
        )
        self.wait(node, lambda: writer.matched and reader.matched)
        identity = reader.endpoint.guid + wire.sequence_number(1)
        inline = wire.parameters((wire.PID_RELATED, identity), (wire.PID_RELATED_OLD, identity))
        writer.write(encoded(request, f"{kind}_Request", for_humble=True), inline)
        self.wait(node, lambda: answers)
        return decoded(answers[0].payload, f"{kind}_Response", of_humble=True), answers[0].payload

    def wait(self, node, holds):
        def spun():
            self.participant.spin(time.monotonic())
            return holds()

        node.wait(spun)


def test_humble_has_fewer_fields_and_is_not_read_as_a_later_one():
    register_move_group()
    code = message("moveit_msgs/msg/MoveItErrorCodes", val=-31, message="no", source="s")
    response = message(f"{IK}_Response", error_code=code)
    new, old = (encoded(response, f"{IK}_Response", for_humble=is_old) for is_old in (False, True))
    assert len(old) < len(new)
    assert decoded(old, f"{IK}_Response", of_humble=True).error_code.val == -31
    assert decoded(new, f"{IK}_Response").error_code.message == "no"
    request = message(f"{PATH}_Request", group_name="arm", waypoints=[pose((1, 2, 3))])
    old = encoded(request, f"{PATH}_Request", for_humble=True)
    assert decoded(old, f"{PATH}_Request") is None
    read = decoded(old, f"{PATH}_Request", of_humble=True)
    assert read.group_name == "arm"
    assert not any(getattr(read, name) for name in LATER_THAN_HUMBLE[f"{PATH}_Request"])


def test_a_client_of_humble_is_answered_in_its_own_messages(tmp_path, monkeypatch):
    with bridge(scenario(tmp_path, "- external: {}", robot=UR)) as (node, _):
        client = HumbleClient(node.graph.participant.domain, monkeypatch)
        with closing(client):
            requested = moveit(
                "PositionIKRequest", group_name=GROUP, pose_stamped=stamped(pose((9, 0, 0)))
            )
            request = message(f"{IK}_Request", ik_request=requested)
            found, payload = client.call(node, "compute_ik", IK, request)
            assert found.error_code.val == NUMBERS["NO_IK_SOLUTION"]
            assert b"armharness" not in payload
            path = message(
                f"{PATH}_Request",
                group_name=GROUP,
                waypoints=[pose((0.4, 0.1, 0.4))],
                max_step=0.01,
            )
            found, _ = client.call(node, "compute_cartesian_path", PATH, path)
            assert found.error_code.val == 1
            assert found.solution.joint_trajectory is not None


@pytest.mark.parametrize("is_humble", [True, False])
def test_nodes_are_introduced_by_identifiers_of_the_length_that_a_distribution_reads(
    is_humble, monkeypatch
):
    """With 16 bytes for 24, Humble reads lengths of lists from identifiers.

    RMW_GID_STORAGE_SIZE of rmw's branches humble and iron; rmw_fastrtps of Humble copies its GUID
    of 16 bytes to the beginning of one that is zero (create_rmw_gid.cpp).
    """
    introductions, size = [], 24 if is_humble else 16
    kind = f"rmw_dds_common{'_of_humble' * is_humble}/msg/ParticipantEntitiesInfo"
    with free_domain() as domain, closing(Graph(domain, node="bridge")) as graph:
        graph.advertise("/numbers", "std_msgs/msg/String")
        with monkeypatch.context() as patch:
            if is_humble:
                patch.setattr(wire, "VENDOR", wire.FAST_DDS)
            other = Participant(domain, name="other")
        with closing(other):
            qos = Qos(is_latched=True, depth=1)
            other.reader(DISCOVERY, dds_type(INFO), qos, introductions.append)

            def is_introduced():
                graph.spin(time.monotonic() + 0.002)
                other.spin(time.monotonic() + 0.002)
                return introductions

            wait_for(is_introduced)
    assert len({each.writer for each in introductions}) == 1
    read = decoded(introductions[-1].payload, kind)
    [node] = read.node_entities_info_seq
    assert node.node_name == "bridge"
    assert bytes(read.gid.data) == graph.participant.guid.ljust(size, b"\0")
    assert len(node.writer_gid_seq) == 1
    assert encoded(read, kind) == introductions[-1].payload
