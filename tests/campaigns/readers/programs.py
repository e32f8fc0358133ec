"""Readers of what other programs send: ROS 2 nodes and pages of the studio."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from tests.campaigns import mutation
from tests.campaigns.mutation import Random
from tests.campaigns.reader import Read, Reader


def _datagrams(folder: Path) -> list[bytes]:
    """What two participants send each other."""
    from harness.plugins.ros.domain import free_domain
    from harness.plugins.ros.endpoints import DEFAULT, LATCHED
    from harness.plugins.ros.rtps.participant import Participant
    from harness.plugins.ros.rtps.sockets import Sockets

    del folder
    sent: list[bytes] = []
    send = Sockets.send

    def noted(self: Sockets, datagram: bytes, address: object) -> None:
        sent.append(datagram)
        send(self, datagram, address)

    Sockets.send = noted
    try:
        with free_domain() as domain:
            both = [Participant(domain, name=name) for name in ("a", "b")]
            writer = both[0].writer("rt/x", "std_msgs::msg::dds_::String_", LATCHED)
            both[1].reader("rt/x", "std_msgs::msg::dds_::String_", DEFAULT, lambda _: None)
            for size in (10, 10, 200_000):
                writer.write(b"\0\1\0\0" + bytes(size))
                for _ in range(15):
                    for each in both:
                        each.spin(0.0)
            for each in both:
                each.close()
    finally:
        Sockets.send = send
    short = [each for each in sent if len(each) < 4000]
    kinds = {(each[20], len(each)): each for each in short}
    return list(kinds.values())


def _begin_datagrams(folder: Path) -> Read:
    from harness.plugins.ros.domain import free_domain
    from harness.plugins.ros.endpoints import DEFAULT, LATCHED
    from harness.plugins.ros.rtps.participant import Participant

    del folder
    domain = free_domain().__enter__()
    heard: list[object] = []

    def joined() -> Participant:
        made = Participant(domain, name="fuzzed")
        made.reader("rt/x", "std_msgs::msg::dds_::String_", DEFAULT, heard.append)
        made.writer("rt/y", "std_msgs::msg::dds_::String_", LATCHED).write(b"\0\1\0\0" + bytes(9))
        return made

    participants = [joined()]

    def read(folder: Path, data: bytes) -> None:
        del folder
        participant = participants[0]
        participant._receive(data)  # noqa: SLF001 - the network is too slow for a million of them
        if len(participant._peers) > 200:  # noqa: SLF001
            participant.close()
            participants[0] = joined()
            heard.clear()

    return read


def _requests(folder: Path) -> list[bytes]:
    del folder
    from harness.plugins.ros.bag.messages import TYPESTORE, message
    from harness.plugins.ros.interfaces import FOLLOW, GRIPPER, encoded, register_move_group

    register_move_group()
    kinds = (
        f"{FOLLOW}_SendGoal_Request", f"{GRIPPER}_SendGoal_Request",
        "trajectory_msgs/msg/JointTrajectory", "moveit_msgs/msg/PlanningScene",
        "moveit_msgs/msg/CollisionObject", "moveit_msgs/srv/GetPositionIK_Request",
        "moveit_msgs/action/MoveGroup_SendGoal_Request",
    )  # fmt: skip
    known = [kind for kind in kinds if kind in TYPESTORE.fielddefs]
    return [kind.encode() + b":" + encoded(message(kind), kind) for kind in known]


def _begin_requests(folder: Path) -> Read:
    from harness.plugins.ros.interfaces import decoded, register_move_group

    del folder
    register_move_group()

    def read(folder: Path, data: bytes) -> None:
        del folder
        kind, _, content = data.partition(b":")
        decoded(content, kind.decode())

    return read


def _mutated_request(corpus: Sequence[bytes], rng: Random) -> bytes:
    kind, _, content = rng.choice(corpus).partition(b":")
    return kind + b":" + mutation.of_bytes([content + bytes(rng.randrange(60))], rng)


ACTIONS = (
    {"do": "jog", "joint": "joint1", "value": 0.1}, {"do": "follow", "on": True},
    {"do": "goal", "xyz": [0.2, 0, 0.1], "rpy": [0, 90, 0], "unit": "deg", "frame": "world"},
    {"do": "goal", "here": True}, {"do": "choose", "way": 0}, {"do": "share", "value": 0.5},
    {"do": "plan", "verb": "move_to", "here": True}, {"do": "advance", "seconds": 0.01},
    {"do": "plan", "verb": "ptp", "joints": {"joint1": 0.1}, "planner": "RRTConnect"},
    {"do": "reset"}, {"do": "execute", "step": "wait: 1 ms", "record": True}, {"do": "undo"},
    {"do": "add_object", "kind": "box", "name": "a", "size": [0.1, 0.1, 0.1], "xyz": [1, 0, 0]},
    {"do": "delete_object", "name": "a"}, {"do": "world", "name": "empty"}, {"do": "back"},
    {"do": "handle", "name": "a"}, {"do": "camera", "name": "eye"}, {"do": "expect_seen"},
    {"do": "complete", "line": 3, "column": 2, "text": "scenario: x\nrobot: ur3e\nst"},
    {"do": "hover", "line": 1, "column": 2, "text": "scenario: x\nrobot: ur3e\n"},
    {"do": "edit", "text": "scenario: x\nrobot: open_manipulator_x\nsteps: []\n"},
    {"do": "run", "until": 3}, {"do": "expect", "texts": ["never: collision"]},
    {"do": "save", "name": "b.scenario.yaml"}, {"do": "control", "word": "request"},
)  # fmt: skip


def _actions(folder: Path) -> list[bytes]:
    del folder
    return [json.dumps(action).encode() for action in ACTIONS]


def _begin_studio(folder: Path) -> Read:
    from harness.core.untrusted_json import parse_json
    from harness.plugins.studio.document import new_text
    from tests.plugins.studio.conftest import Served

    around = {each.name for each in folder.parent.iterdir()} | {"outcome.json", "outcome.part"}
    served = Served(folder, new_text("by hand", {"model": "open_manipulator_x"}, "empty"))

    def read(folder: Path, data: bytes) -> None:
        try:
            message = parse_json(data)
        except ValueError:
            return
        if not isinstance(message, dict):
            return
        defects: list[str] = []
        served.studio.session.on_defect = lambda: defects.append("a defect")
        name = str(message.get("do", ""))
        answer = served.reply_to(name, **{str(k): v for k, v in message.items() if k != "action"})
        assert isinstance(answer, dict)
        assert not defects
        assert {each.name for each in folder.parent.iterdir()} <= around | {"last"}

    return read


READERS: dict[str, Reader] = {
    "rtps": Reader(_datagrams, mutation.of_bytes, _begin_datagrams),
    "bridge": Reader(_requests, _mutated_request, _begin_requests, is_named=True),
    "studio": Reader(_actions, mutation.of_json, _begin_studio),
}
