"""Cyclone DDS, the middleware of many ROS 2 installations, against the bridge."""

import time
from functools import partial

import pytest

from harness.plugins.ros.actions import Status
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.domain import free_domain
from harness.plugins.ros.interfaces import CANCEL
from harness.plugins.ros.rtps.graph import Graph
from tests.plugins.ros.bridging import bridge, scenario
from tests.waiting import HANG, wait_for

pytestmark = pytest.mark.needs_ros
WITHOUT_MULTICAST = """<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32
</MaxAutoParticipantIndex><Peers><Peer address="localhost"/></Peers></Discovery></Domain>
</CycloneDDS>"""
"""What its ROS middleware sets where ROS_AUTOMATIC_DISCOVERY_RANGE is LOCALHOST."""


@pytest.mark.parametrize("settings", ["", WITHOUT_MULTICAST])
def test_goals_results_and_cancellation_reach_a_client_on_cyclone_dds(
    tmp_path, monkeypatch, settings
):
    monkeypatch.setenv("CYCLONEDDS_URI", settings)
    from tests.plugins.ros.cyclone import GripperClient

    with bridge(scenario(tmp_path, "- external: {}")) as (node, _):
        node.ready()
        client = GripperClient(node.graph.participant.domain, "/gripper_controller/gripper_cmd")
        wait_for(partial(getattr, client, "is_ready"))
        goal, accepted = client.send(0.015)
        assert accepted
        assert client.result(goal).reached_goal
        goal, accepted = client.send(-0.005)
        assert client.cancel(goal).return_code == 0
        assert client.result(goal).status == Status.CANCELED
        assert client.send(0.5)[1] is False
        del client


def test_a_server_on_cyclone_dds_answers_our_client():
    from tests.plugins.ros.cyclone import CancelServer

    responses, name = [], "/arm/_action/cancel_goal"
    with free_domain() as domain:
        server, graph = CancelServer(domain, name), Graph(domain, node="test")
        client, end = graph.client(name, CANCEL), time.monotonic() + HANG
        next_call = 0.0
        while not responses and time.monotonic() < end:
            graph.spin(time.monotonic() + 0.02)
            if client.is_ready() and time.monotonic() > next_call:
                # the first response is lost where the server has not discovered the reader yet
                client.call(message(f"{CANCEL}_Request"), responses.append)
                next_call = time.monotonic() + 3
            server.answer(3)
        graph.close()
    assert {response.return_code for response in responses} == {3}
