"""Every reader of what others write: good files of it, and the call that reads a changed one."""

from __future__ import annotations

import io
import json
import tarfile
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import count
from pathlib import Path

from harness.core.resources import data_folder
from tests.campaigns import mutation
from tests.campaigns.mutation import Mutate

Read = Callable[[Path, bytes], None]
"""Reads a changed file in a folder; raises a HarnessError where it refuses it."""


@dataclass(frozen=True)
class Reader:
    """One kind of input.

    Attributes:
        corpus: Gives good files; called once, in an empty folder.
        mutate: Changes one.
        begin: Makes what reads a changed file; called once, in the process that reads.
    """

    corpus: Callable[[Path], Sequence[bytes]]
    mutate: Mutate
    begin: Callable[[Path], Read]


def _bundled(kind: str, pattern: str) -> list[bytes]:
    found = [path.read_bytes() for path in sorted(data_folder(kind).rglob(pattern))]
    assert found, (kind, pattern)
    return found


def _short(kind: str, pattern: str) -> list[bytes]:
    """The bundled files that are read fastest, still with nearly every word of the language."""
    return sorted(_bundled(kind, pattern), key=len)[:20]


def _put(folder: Path, name: str, data: bytes) -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


def _of_file(name: str, read: Callable[[Path], object]) -> Callable[[Path], Read]:
    """What reads one file of a name."""

    def begin(folder: Path) -> Read:
        del folder

        def read_changed(folder: Path, data: bytes) -> None:
            read(_put(folder, name, data))

        return read_changed

    return begin


# -- scenarios and worlds ---------------------------------------------------------------------


def _load_scenario(path: Path) -> None:
    from harness.language.reading.load import load_scenario

    load_scenario(path)


def _prepare_scenario(path: Path) -> None:
    from harness.session.check import check_file

    for problem in check_file(path).problems:
        assert problem.path, problem


def _header(path: Path) -> None:
    from harness.suite.header import read_header

    header = read_header(path)
    for number, _ in enumerate(header.variation.parametrized()):
        if number > 50:
            break


def _world(path: Path) -> None:
    from harness.language.reading.load import load_world

    load_world(str(path), path.parent)


def _small_scenarios(folder: Path) -> list[bytes]:
    from tests.damaged.test_damaged_bags_and_models import NUMBERS
    from tests.damaged.trials import TINY

    del folder
    return [TINY.encode(), NUMBERS.encode()]


def _overrides(folder: Path) -> list[bytes]:
    del folder
    pairs = [
        ("seed", "3"), ("steps.0.move_to.joints.joint1", "0.1"), ("robot.model", "ur3e"),
        ("expect.1.clearance.at_least", "5 cm"), ("steps.near", "{wait: 1 s}"),
        ("objects.block.mass", "0.2"), ("planning.planner_id", "RRTConnect"),
        ("steps", "[wait: 1 s]"),
    ]  # fmt: skip
    return ["=".join(pair).encode() for pair in pairs]


def _begin_overrides(folder: Path) -> Read:
    from harness.language.reading.load import parse_scenario
    from tests.damaged.trials import TINY

    del folder

    def read(folder: Path, data: bytes) -> None:
        text = data.decode("utf-8", errors="replace")
        path, _, value = text.partition("=")
        parse_scenario(TINY, folder / "tiny.scenario.yaml", {path: value})

    return read


# -- robots -----------------------------------------------------------------------------------


def _robot_yaml(folder: Path) -> Read:
    import shutil

    from harness.language.scenario import RobotSpec
    from harness.robot.load import load_robot

    robots = data_folder("robots")
    for name in ("open_manipulator_x", "rh_p12_rn_a"):
        shutil.copytree(robots / name, folder / name, dirs_exist_ok=True)

    def read(folder: Path, data: bytes) -> None:
        name = "rh_p12_rn_a" if b"rh_p12" in data else "open_manipulator_x"
        _put(folder / name, "robot.yaml", data)
        words = (
            {"model": "ur3e", "gripper": f"./{name}"} if name[0] == "r" else {"model": f"./{name}"}
        )
        load_robot(RobotSpec.model_validate(words), folder)

    return read


def _arm(changed: str, **words: str) -> Callable[[Path], Read]:
    """An arm of a URDF and an SRDF with one changed file."""

    def begin(_: Path) -> Read:
        from tests.robot.arm_files import load_arm, write_arm

        def read(folder: Path, data: bytes) -> None:
            write_arm(folder)
            _put(folder, changed, data)
            load_arm(folder, **words)

        return read

    return begin


def _urdfs(folder: Path) -> list[bytes]:
    from tests.robot.arm_files import URDF

    del folder
    return [URDF.encode(), *_bundled("robots", "*.urdf")]


def _srdfs(folder: Path) -> list[bytes]:
    from tests.robot.arm_files import SRDF

    del folder
    return [SRDF.encode()] * 2 + _bundled("robots", "*.srdf")


def _xacros(folder: Path) -> list[bytes]:
    from tests.robot.test_xacro import ARM, LIMB

    del folder
    inline = ARM.replace(ARM[ARM.index("  <xacro:include") : ARM.index('  <link name="base')], "")
    macro = LIMB[LIMB.index("  <xacro:macro") : LIMB.index("</robot>")]
    whole = inline.replace('  <link name="base', f'{macro}  <link name="base', 1)
    more = """  <xacro:property name="length_of" value="$(arg length)"/>
  <xacro:property name="a" value="${pi / 2}"/>
  <xacro:property name="b" value="${[1, 2.5, 'x'] + list(range(3))}"/>
  <xacro:if value="${a > 1 and len(b) == 6}">
    <xacro:property name="c" value="${dict(d=1)}"/>
  </xacro:if>
  <xacro:unless value="${length_of == 0.2}">
    <link name="${'-'.join(b[2:3])}_${c['d']}"/>
  </xacro:unless>
"""
    return [whole.encode(), whole.replace("  <xacro:limb", f"{more}  <xacro:limb", 1).encode()]


def _mjcfs(folder: Path) -> list[bytes]:
    from tests.robot.mjcf_arm import MJCF

    del folder
    return [MJCF.encode()]


def _begin_mjcf(folder: Path) -> Read:
    from harness.language.scenario import RobotSpec
    from harness.robot.load import load_robot
    from tests.robot.mjcf_arm import TIP

    (folder / "assets").mkdir(exist_ok=True)
    _put(folder / "assets", "t.obj", TIP.encode())

    def read(folder: Path, data: bytes) -> None:
        _put(folder, "arm.xml", data)
        load_robot(RobotSpec.model_validate({"mjcf": "arm.xml"}), folder)

    return read


JOINT_LIMITS = b"""\
default_velocity_scaling_factor: 0.1
joint_limits:
  turn: {has_velocity_limits: true, max_velocity: 1.5, max_acceleration: 4.0}
  bend: {has_position_limits: true, min_position: -1.5, max_position: !degrees 80.0}
  reach: {has_effort_limits: true, max_effort: 20, has_jerk_limits: false}
"""


def _begin_joint_limits(folder: Path) -> Read:
    from tests.robot.arm_files import load_arm, write_arm

    write_arm(folder)

    def read(folder: Path, data: bytes) -> None:
        _put(folder, "joint_limits.yaml", data)
        load_arm(folder, moveit={"joint_limits": "joint_limits.yaml"})

    return read


# -- worlds of other formats ------------------------------------------------------------------


def _sdfs(folder: Path) -> list[bytes]:
    from tests.damaged.trials import SDF_WORLDS

    del folder
    frames = Path(__file__).parents[1] / "world" / "files" / "frames.sdf"
    return [*(text.encode() for text in SDF_WORLDS), frames.read_bytes()]


def _scenes(folder: Path) -> list[bytes]:
    from tests.world.test_scene import NEW, OLD

    del folder
    return [NEW.encode(), OLD.encode()]


def _load_sdf(path: Path) -> None:
    from harness.plugins.formats.sdf.world import load_sdf

    load_sdf(path)


def _load_scene(path: Path) -> None:
    from harness.plugins.formats.moveit_scene.scene import load_scene

    load_scene(path)


def _messages(folder: Path) -> list[bytes]:
    from tests.cli.test_import_moveit import LISTS, MAPPINGS, REQUEST

    del folder
    return [text.encode() for text in (LISTS, MAPPINGS, REQUEST)]


def _load_message(path: Path) -> None:
    from harness.plugins.formats.moveit_messages.request import read_request
    from harness.plugins.formats.moveit_messages.scene import read_scene
    from harness.robot.packages import PackagePath

    if "goal_constraints" in path.read_text(encoding="utf-8", errors="replace"):
        read_request(path)
    else:
        read_scene(path, {"base_link"}, PackagePath.of_file(path))


# -- meshes -----------------------------------------------------------------------------------

MESHES = ("stl", "obj", "dae", "ply", "glb")


def _meshes(folder: Path) -> list[bytes]:
    import trimesh

    del folder
    solids = (trimesh.creation.box((0.1, 0.2, 0.3)), trimesh.creation.icosphere(1, 0.1))
    found: list[bytes] = []
    for kind in MESHES:
        for solid in solids:
            content = solid.export(file_type=kind)
            found.append(
                kind.encode() + b":" + (content if isinstance(content, bytes) else content.encode())
            )
    return found


def _mutated_mesh(corpus: Sequence[bytes], rng: object) -> bytes:
    """A mesh with changed content; its kind stays."""
    kind, _, content = rng.choice(corpus).partition(b":")
    mutate = (
        mutation.of_text if kind in (b"obj", b"dae") and rng.random() < 0.7 else mutation.of_bytes
    )
    return kind + b":" + mutate([content], rng)


def _begin_mesh(folder: Path) -> Read:
    from harness.cameras.meshes import mesh_parts
    from harness.core.geometry import Mesh
    from harness.robot.mesh_file import convex_hull

    numbers = count()  # what was read of a path is kept as long as the process lives
    del folder

    def read(folder: Path, data: bytes) -> None:
        kind, _, content = data.partition(b":")
        path = _put(folder, f"{next(numbers)}.{kind.decode()}", content)
        try:
            mesh_parts(Mesh(path, (1.0, 1.0, 1.0)))
            convex_hull(Mesh(path, (1.0, 1.0, 1.0), collision="hull"))
        finally:
            path.unlink()

    return read


# -- recordings, runs and results of suites ---------------------------------------------------


@cache
def _tiny(folder: Path) -> Path:
    """A run, its bags and its scenario."""
    from tests.damaged.trials import tiny_run

    folder.mkdir(exist_ok=True)
    tiny_run(folder)
    return folder


def _bags(folder: Path) -> list[bytes]:
    tiny = _tiny(folder / "tiny")
    files = [
        next((tiny / kind).glob(f"*{end}"))
        for kind, end in (("mcap", ".mcap"), ("sqlite3", ".db3"))
    ]
    return [
        *(path.suffix.encode() + b":" + path.read_bytes() for path in files),
        b".bag:" + _ros1(folder),
    ]


def _ros1(folder: Path) -> bytes:
    from rosbags.rosbag1 import Writer

    from tests.plugins.grading.hand_made import JOINTS
    from tests.plugins.grading.test_ros1_bags import ROS1, joints

    path = folder / "old.bag"
    with Writer(path) as writer:
        kind = "sensor_msgs/msg/JointState"
        topic = writer.add_connection("/joint_states", kind, typestore=ROS1)
        for number in range(20):
            data = ROS1.serialize_ros1(joints(number / 10, list(JOINTS)), kind)
            writer.write(topic, 1_700_000_000 * 10**9 + number * 10**8, data)
    return path.read_bytes()


def _mutated_bag(corpus: Sequence[bytes], rng: object) -> bytes:
    suffix, _, content = rng.choice(corpus).partition(b":")
    return suffix + b":" + mutation.of_bytes([content], rng)


def _begin_bag(folder: Path) -> Read:
    from harness.plugins.grading.bag.content import BagTopics
    from harness.plugins.grading.bag.reader import read_bag

    del folder

    def read(folder: Path, data: bytes) -> None:
        suffix, _, content = data.partition(b":")
        read_bag(_put(folder, f"changed{suffix.decode()}", content), BagTopics())

    return read


def _begin_grade(folder: Path) -> Read:
    from harness.plugins.grading.grade import grade_bag

    tiny = _tiny(folder / "tiny")

    def read(folder: Path, data: bytes) -> None:
        suffix, _, content = data.partition(b":")
        file = _put(folder, f"changed{suffix.decode()}", content)
        grade_bag(tiny / "tiny.scenario.yaml", file)

    return read


def _tables(folder: Path) -> list[bytes]:
    del folder
    rows = "".join(f"{n / 10},{n / 50},0,0.1,-0.2\n" for n in range(30))
    names = "time,joint1,joint2,joint3,joint4\n"
    return [text.encode() for text in (names + rows, rows, (names + rows).replace(",", ";"))]


def _begin_table(folder: Path) -> Read:
    from harness.plugins.grading.bag.content import BagTopics
    from harness.plugins.grading.bag.joint_csv import read_joint_csv

    del folder
    names = [f"joint{n}" for n in range(1, 5)]

    def read(folder: Path, data: bytes) -> None:
        read_joint_csv(_put(folder, "changed.csv", data), BagTopics(), names, [*names, "finger"])

    return read


RUN_FILES = ("run.json", "signals.npz", "visuals.npz", "scenario.resolved.yaml")


def _runs(folder: Path) -> list[bytes]:
    run = _tiny(folder / "tiny") / "run"
    return [name.encode() + b":" + (run / name).read_bytes() for name in RUN_FILES]


def _mutated_run(corpus: Sequence[bytes], rng: object) -> bytes:
    import numpy as np

    from tests.damaged.mutants import damaged_arrays, npz_bytes

    name, _, content = rng.choice((corpus[0], corpus[0], *corpus)).partition(b":")
    if name.endswith(b".json"):
        changed = mutation.of_json([content], rng)
    elif name.endswith(b".npz") and rng.random() < 0.7:
        with np.load(io.BytesIO(content)) as file:
            arrays = dict(file)
        changed = npz_bytes(damaged_arrays(arrays, rng)) if arrays else content[:-1]
    elif name.endswith(b".npz"):
        changed = mutation.of_bytes([content], rng)
    else:
        changed = mutation.of_yaml([content], rng)
    return name + b":" + changed


def _begin_run(folder: Path) -> Read:
    import shutil

    from harness.recording.read_run import read_run

    whole = _tiny(folder / "tiny") / "run"
    run = folder / "run"
    shutil.copytree(whole, run, dirs_exist_ok=True)

    def read(_: Path, data: bytes) -> None:
        name, _, content = data.partition(b":")
        changed = _put(run, name.decode(), content)
        try:
            stored = read_run(run)
            stored.changes()
        finally:
            shutil.copy(whole / changed.name, changed)

    return read


@cache
def _suite(folder: Path) -> Path:
    """The report folder of a part of a suite, with its conditions."""
    from tests.damaged.front_door import outcome_of

    folder.mkdir(exist_ok=True)
    file = folder / "part.scenario.yaml"
    file.write_text(
        "scenario: a part\nrobot: open_manipulator_x\nparams: {angle: 0.1}\n"
        "randomize: {angle: {uniform: [0, 0.2]}}\nsamples: 3\n"
        "steps: [{move_to: {joints: {joint1: '${angle}'}}}]\n"
    )
    words = (
        "run",
        file,
        "--no-page",
        "--report-dir",
        folder / "part",
        "--shard",
        "1/1",
        "--in-process",
    )
    _, printed = outcome_of(*words)
    assert (folder / "part" / "results.jsonl").is_file(), printed
    return folder / "part"


def _shards(folder: Path) -> list[bytes]:
    part = _suite(folder / "suite")
    return [path.name.encode() + b":" + path.read_bytes() for path in sorted(part.glob("*.json*"))]


def _mutated_shard(corpus: Sequence[bytes], rng: object) -> bytes:
    name, _, content = rng.choice(corpus).partition(b":")
    mutate = mutation.of_lines if name.endswith(b".jsonl") else mutation.of_json
    return name + b":" + mutate([content], rng)


def _begin_shard(folder: Path) -> Read:
    import shutil

    from harness.plugins.campaigns.merge import merge_parts

    whole, part = _suite(folder / "suite"), folder / "part"
    shutil.copytree(whole, part, dirs_exist_ok=True)

    def read(folder: Path, data: bytes) -> None:
        name, _, content = data.partition(b":")
        _put(part, name.decode(), content)
        try:
            merge_parts([part], folder / "merged")
        finally:
            shutil.copy(whole / name.decode(), part / name.decode())
            shutil.rmtree(folder / "merged", ignore_errors=True)

    return read


def _conditions(folder: Path) -> list[bytes]:
    lines = [{"format": "armharness-conditions/1"}] + [
        {
            "file": "a/part", "name": f"sample={n}", "group": "", "sample": n,
            "overrides": {"params.angle": str(n / 10), "seed": str(n)}, "values": {"angle": n / 10},
        }
        for n in range(4)
    ]  # fmt: skip
    del folder
    return [b"".join(json.dumps(line).encode() + b"\n" for line in lines)]


def _load_conditions(path: Path) -> None:
    from harness.plugins.campaigns.conditions import read_conditions

    conditions = read_conditions(path)  # reads from its file as long as it lives
    list(conditions.cases(Path("a/part.scenario.yaml"), is_alone=True))


# -- submissions ------------------------------------------------------------------------------


def _archives(folder: Path) -> list[bytes]:
    del folder
    files = {
        "work/pick.scenario.yaml": b"scenario: x\n",
        "work/ik.py": b"def ik(): pass\n",
        "a.csv": b"1",
    }
    found: list[bytes] = []
    for method in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w", method) as archive:
            for name, content in files.items():
                archive.writestr(name, content)
        found.append(b".zip:" + stream.getvalue())
    for kind in ("", "gz", "xz", "bz2"):
        stream = io.BytesIO()
        with tarfile.open(fileobj=stream, mode=f"w:{kind}") as archive:
            for name, content in files.items():
                about = tarfile.TarInfo(name)
                about.size = len(content)
                archive.addfile(about, io.BytesIO(content))
        found.append(f".tar{'.' * bool(kind)}{kind}:".encode() + stream.getvalue())
    return found


def _begin_archive(folder: Path) -> Read:
    import shutil

    from harness.plugins.grading.classroom.submissions import one_submission, unpack

    del folder

    def read(folder: Path, data: bytes) -> None:
        suffix, _, content = data.partition(b":")
        path = _put(folder, f"work{suffix.decode()}", content)
        try:
            unpack(one_submission(path), folder / "unpacked", 1)
        finally:
            path.unlink()
            outside = [each.name for each in folder.iterdir() if each.name != "unpacked"]
            shutil.rmtree(folder / "unpacked", ignore_errors=True)
        assert not outside, outside

    return read


ASSIGNMENT = b"""\
assignment: Reach
description: Move to three places.
scenario: reach.scenario.yaml
takes: [steps]
points: 10
hidden:
  - {seed: 4}
  - {set: {objects.block.pose.xyz: [0.2, 0, 0.02]}}
limits: {processor_time: 30 s, memory: 1000, processes: 20, files: 100}
"""


def _begin_assignment(folder: Path) -> Read:
    from harness.plugins.grading.assignment import read_assignment
    from tests.damaged.trials import TINY

    _put(folder, "reach.scenario.yaml", TINY.encode())

    def read(folder: Path, data: bytes) -> None:
        _put(folder, "assignment.yaml", data)
        read_assignment(folder)

    return read


# -- programs that speak with this one --------------------------------------------------------


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
    from harness.plugins.ros.interfaces import FOLLOW, GRIPPER, encoded, register_move_group
    from harness.reporting.rosbag.messages import TYPESTORE, message

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


def _mutated_request(corpus: Sequence[bytes], rng: object) -> bytes:
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


def _mutated_archive(corpus: Sequence[bytes], rng: object) -> bytes:
    return _mutated_bag(corpus, rng)


def _mutated_pair(corpus: Sequence[bytes], rng: object) -> bytes:
    """A path and a value, of which one may be of another pair, or changed."""
    path, value = (rng.choice(corpus).split(b"=", 1)[part] for part in (0, 1))
    if rng.random() < 0.3:
        path = mutation.of_text([path], rng)
    if rng.random() < 0.7:
        value = mutation.of_text([value], rng)
    return path + b"=" + value


READERS: dict[str, Reader] = {
    "scenario": Reader(
        lambda _: _short("scenarios", "*.scenario.yaml"),
        mutation.of_yaml,
        _of_file("a.scenario.yaml", _load_scenario),
    ),
    "check": Reader(
        _small_scenarios, mutation.of_yaml, _of_file("a.scenario.yaml", _prepare_scenario)
    ),
    "variation": Reader(
        lambda _: _short("scenarios", "*.scenario.yaml"),
        mutation.of_yaml,
        _of_file("a.scenario.yaml", _header),
    ),
    "set": Reader(_overrides, _mutated_pair, _begin_overrides),
    "world": Reader(
        lambda _: _bundled("worlds", "*.yaml"), mutation.of_yaml, _of_file("a.yaml", _world)
    ),
    "robot.yaml": Reader(lambda _: _bundled("robots", "robot.yaml"), mutation.of_yaml, _robot_yaml),
    "urdf": Reader(_urdfs, mutation.of_xml, _arm("arm.urdf")),
    "srdf": Reader(_srdfs, mutation.of_xml, _arm("arm.srdf")),
    "xacro": Reader(
        _xacros, mutation.of_xml, _arm("arm.xacro", urdf=None, srdf=None, xacro="arm.xacro")
    ),
    "mjcf": Reader(_mjcfs, mutation.of_xml, _begin_mjcf),
    "sdf": Reader(_sdfs, mutation.of_xml, _of_file("a.sdf", _load_sdf)),
    "scene": Reader(_scenes, mutation.of_text, _of_file("a.scene", _load_scene)),
    "messages": Reader(_messages, mutation.of_yaml, _of_file("a.yaml", _load_message)),
    "joint_limits": Reader(lambda _: [JOINT_LIMITS], mutation.of_text, _begin_joint_limits),
    "mesh": Reader(_meshes, _mutated_mesh, _begin_mesh),
    "bag": Reader(_bags, _mutated_bag, _begin_bag),
    "grade": Reader(_bags, _mutated_bag, _begin_grade),
    "csv": Reader(_tables, mutation.of_text, _begin_table),
    "run": Reader(_runs, _mutated_run, _begin_run),
    "shard": Reader(_shards, _mutated_shard, _begin_shard),
    "conditions": Reader(
        _conditions, mutation.of_lines, _of_file("conditions.jsonl", _load_conditions)
    ),
    "submission": Reader(_archives, _mutated_archive, _begin_archive),
    "assignment": Reader(lambda _: [ASSIGNMENT], mutation.of_yaml, _begin_assignment),
    "rtps": Reader(_datagrams, mutation.of_bytes, _begin_datagrams),
    "bridge": Reader(_requests, _mutated_request, _begin_requests),
    "studio": Reader(_actions, mutation.of_json, _begin_studio),
}
"""Readers by the names that the command takes."""
