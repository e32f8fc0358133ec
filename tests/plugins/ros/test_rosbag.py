"""The bag of a run: read back by readers that are not the writer's, and compared with the run."""

import json
import sqlite3
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml
from mcap.reader import make_reader

from harness.cli.main import main
from harness.plugins.ros.bag.write import BagOptions, write_bag
from harness.recording.read_run import read_run
from tests.plugins.ros.bag_runs import decoded, everything
from tests.running import exit_code

RELIABLE, BEST_EFFORT, TRANSIENT_LOCAL, VOLATILE = 1, 2, 1, 2
"""Of rmw's enumerations, which rosbag2 writes as numbers up to Jazzy."""

CUBE, DELETE_ALL = 1, 3
"""Of visualization_msgs/Marker."""

LATCHED = {
    "/robot_description",
    "/tf_static",
    "/planned_trajectory",
    "/display_planned_path",
    "/scene_markers",
}
TOPICS = LATCHED | {
    "/clock",
    "/tf",
    "/joint_states",
    "/joint_commands",
    "/tcp_path",
    "/armharness/events",
    "/rosout",
    "/ft/wrench",
    "/over_view/image/compressed",
    "/over_view/camera_info",
    "/wrist/image",
    "/wrist/image/compressed",
    "/wrist/camera_info",
    "/wrist/depth/image",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A run, with its bag."""
    return everything(tmp_path_factory.mktemp("everything"), bag=True)


@pytest.fixture(scope="module")
def stored(folder):
    return read_run(folder)


@pytest.fixture(scope="module")
def messages(folder):
    return decoded(folder / "bag")


def test_a_sensor_of_force_and_torque_is_published_as_wrenches_in_its_frame(stored, messages):
    sensor = stored.run.robot.wrench_sensors["ft"]
    recorded = stored.run.signals.wrenches["ft"]
    for time, each in messages["/ft/wrench"]:
        force, torque = each.wrench.force, each.wrench.torque
        read = [force.x, force.y, force.z, torque.x, torque.y, torque.z]
        row = round(time / stored.run.timestep)
        assert read == recorded[row].tolist()
        assert each.header.frame_id == "ft_wrench_frame"
    frames = [each for _, found in messages["/tf_static"] for each in found.transforms]
    frame = next(each for each in frames if each.child_frame_id == "ft_wrench_frame")
    assert frame.header.frame_id == "rh_p12_rn_base"
    assert matrix(frame.transform) == pytest.approx(sensor.pose.matrix())


def matrix(transform):
    """T_parent_child of a message's Transform, written down anew."""
    t, r = transform.translation, transform.rotation
    x, y, z, w = r.x, r.y, r.z, r.w
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), t.x],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), t.y],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), t.z],
            [0, 0, 0, 1],
        ]
    )


def test_every_topic_is_there_and_every_message_is_decoded_with_sound_checksums(folder, messages):
    assert set(messages) == TOPICS
    with (folder / "bag/bag.mcap").open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        summary = reader.get_summary()
        assert {schema.encoding for schema in summary.schemas.values()} == {"ros2msg"}
        assert summary.statistics.message_count == sum(map(len, messages.values()))
        assert sum(1 for _ in reader.iter_messages()) == summary.statistics.message_count


def test_metadata_is_of_version_8_with_the_numbers_that_humble_reads(folder, messages):
    text = (folder / "bag/metadata.yaml").read_text()
    about = yaml.safe_load(text)["rosbag2_bagfile_information"]
    assert (about["version"], about["storage_identifier"]) == (8, "mcap")
    assert about["compression_format"] == ""
    for topic in about["topics_with_message_count"]:
        name = topic["topic_metadata"]["name"]
        assert topic["message_count"] == len(messages[name])
        [qos] = yaml.safe_load(topic["topic_metadata"]["offered_qos_profiles"])
        is_latched = name in LATCHED
        assert qos["durability"] == (TRANSIENT_LOCAL if is_latched else VOLATILE), name
        is_lossy = name == "/clock" or name.endswith(("/image", "compressed"))
        assert qos["reliability"] == (BEST_EFFORT if is_lossy else RELIABLE), name
        assert topic["topic_metadata"]["type_description_hash"].startswith("RIHS01_")


def test_joints_are_those_that_were_recorded_a_hundred_times_a_second(stored, messages):
    run = stored.run
    times = np.array([time for time, _ in messages["/joint_states"]])
    assert np.diff(times)[:-1] == pytest.approx(0.01, abs=1e-6)
    assert times[-1] == pytest.approx(run.signals.times[-1])
    for time, message in messages["/joint_states"][::97]:
        row = int(np.argmin(np.abs(run.signals.times - time)))
        assert message.name == list(run.robot.joint_names)
        assert np.array_equal(message.position, run.signals.joint_positions[row])
        assert np.array_equal(message.velocity, run.signals.joint_velocities[row])
        assert np.array_equal(message.effort, run.signals.joint_efforts[row])
        stamp = message.header.stamp
        assert stamp.sec + stamp.nanosec * 1e-9 - 1_800_000_000 == pytest.approx(time, abs=1e-6)


def test_commands_leave_out_joints_that_only_follow_another(stored, messages):
    followers = {joint.name for joint in stored.run.robot.movable_joints if joint.is_mimic}
    columns = {joint.name: column for column, joint in enumerate(stored.run.robot.movable_joints)}
    assert followers
    for time, message in messages["/joint_commands"][::97]:
        row = int(np.argmin(np.abs(stored.run.signals.times - time)))
        assert not followers & set(message.name)
        expected = stored.run.signals.joint_commands[row, [columns[name] for name in message.name]]
        assert np.array_equal(message.position, expected)


def test_every_frame_has_one_parent_and_a_way_to_the_world(messages, stored):
    parents = {}
    for topic in ("/tf_static", "/tf"):
        for _, message in messages[topic]:
            for edge in message.transforms:
                parents.setdefault(edge.child_frame_id, set()).add(edge.header.frame_id)
    assert {len(those) for those in parents.values()} == {1}
    for frame in (*stored.run.robot.link_names, "red_box", "shelf", "over_view_optical_frame"):
        passed = []
        while frame != "world":
            passed.append(frame)
            assert len(passed) < 50
            [frame] = parents[frame]


def test_walking_the_tree_ends_where_the_physics_had_the_tcp(messages, stored):
    run = stored.run
    static = {edge.child_frame_id: edge for edge in messages["/tf_static"][0][1].transforms}
    for time, message in messages["/tf"][::61]:
        edges = static | {edge.child_frame_id: edge for edge in message.transforms}
        pose, frame = np.eye(4), run.robot.tcp_link
        while frame != "world":
            pose = matrix(edges[frame].transform) @ pose
            frame = edges[frame].header.frame_id
        row = int(np.argmin(np.abs(run.signals.times - time)))
        x, y, z, qw, qx, qy, qz = run.signals.tcp_pose[row]
        assert pose[:3, 3] == pytest.approx([x, y, z], abs=1e-9)
        first_column = [1 - 2 * (qy**2 + qz**2), 2 * (qx * qy + qw * qz), 2 * (qx * qz - qw * qy)]
        assert pose[:3, 0] == pytest.approx(first_column, abs=1e-9)


def test_an_object_has_a_frame_and_a_marker_only_while_it_is_there(messages, stored):
    [(begin, end)] = next(o for o in stored.run.objects if o.name == "shelf").present
    assert 0 < begin < end < stored.run.signals.times[-1]
    framed = [
        time
        for time, message in messages["/tf"]
        if any(edge.child_frame_id == "shelf" for edge in message.transforms)
    ]
    assert begin - 0.011 <= framed[0] <= begin + 0.011
    assert end - 0.011 <= framed[-1] <= end + 0.011
    for time, message in messages["/scene_markers"]:
        first, *others = message.markers
        assert first.action == DELETE_ALL
        shelves = [marker for marker in others if marker.ns == "shelf"]
        assert len(shelves) == (begin <= time < round(end, 9))
        for marker in shelves:
            assert (marker.header.frame_id, marker.frame_locked) == ("shelf", True)
            assert (marker.scale.x, marker.scale.y, marker.scale.z) == (0.1, 0.2, 0.02)
            assert marker.type == CUBE
        tables = [marker for marker in others if marker.ns == "Table"]
        assert {marker.header.frame_id for marker in tables} == {"world"}


def test_planned_trajectories_are_those_of_the_steps(messages, stored):
    planned = [step for step in stored.run.steps if step.trajectory is not None]
    assert [step.id for step in planned] == ["home", "swing"]
    for step, (time, message), (_, shown) in zip(
        planned, messages["/planned_trajectory"], messages["/display_planned_path"], strict=True
    ):
        assert time == pytest.approx(step.start_time)
        assert message.joint_names == list(step.trajectory.joint_names)
        rows = np.array([point.positions for point in message.points])
        assert np.array_equal(rows, step.trajectory.positions)
        last = message.points[-1].time_from_start
        seconds = last.sec + last.nanosec * 1e-9
        assert seconds == pytest.approx(step.trajectory.times[-1], abs=1e-8)
        [trajectory] = shown.trajectory
        assert len(trajectory.joint_trajectory.points) == len(rows)
        start = dict(
            zip(
                shown.trajectory_start.joint_state.name,
                shown.trajectory_start.joint_state.position,
                strict=True,
            )
        )
        assert [start[name] for name in message.joint_names] == pytest.approx(rows[0], abs=0.01)


def test_the_tcp_path_grows_as_the_trajectory_server_of_the_course_makes_it(messages, stored):
    looks = np.arange(0, stored.run.signals.times[-1], 0.2)
    rows = np.searchsorted(stored.run.signals.times, looks - 1e-9)
    expected = [stored.run.signals.tcp_pose[rows[0], :3]]
    for place in stored.run.signals.tcp_pose[rows, :3]:
        if np.linalg.norm(place - expected[-1]) >= 0.02:
            expected.append(place)
    paths = [message for _, message in messages["/tcp_path"]]
    kept = [[(p.pose.position.x, p.pose.position.y, p.pose.position.z) for p in path.poses]
            for path in paths]  # fmt: skip
    assert len(expected) > 10
    assert np.allclose(kept[-1][: len(expected)], expected)
    assert len(kept[-1]) - len(expected) <= 1
    for before, after in pairwise(kept):
        assert after[: len(before)] == before
    assert {path.header.frame_id for path in paths} == {"world"}


def test_pictures_are_the_recorded_ones_with_the_camera_s_calibration(messages, stored):
    video = stored.drawings.videos[0]
    shown = messages["/over_view/image/compressed"]
    assert [time for time, _ in shown] == pytest.approx(video.times)
    for (_, message), (_, info) in zip(shown, messages["/over_view/camera_info"], strict=True):
        assert message.format == "rgb8; jpeg compressed bgr8"
        picture = cv2.imdecode(np.frombuffer(message.data, np.uint8), cv2.IMREAD_UNCHANGED)
        assert picture.shape == (48, 64, 3)
        assert message.header.frame_id == info.header.frame_id == "over_view_optical_frame"
        focal = 32 / np.tan(1.0471975511965976 / 2)
        assert info.k[0] == info.k[4] == pytest.approx(focal)
        assert (info.width, info.height, info.k[2], info.k[5]) == (64, 48, 32, 24)


def test_a_captured_picture_is_there_raw_compressed_and_with_its_depth(messages, stored):
    [(time, raw)] = messages["/wrist/image"]
    [(_, small)] = messages["/wrist/image/compressed"]
    [(_, deep)] = messages["/wrist/depth/image"]
    assert time == pytest.approx(stored.run.captures[0].time)
    assert (raw.encoding, raw.step, raw.height, raw.width) == ("mono8", 32, 24, 32)
    content = np.frombuffer(bytes(small.data), np.uint8)
    decoded_again = cv2.imdecode(content, cv2.IMREAD_GRAYSCALE)
    assert bytes(raw.data) == decoded_again.tobytes()
    assert (deep.encoding, deep.step) == ("32FC1", 128)
    depth = np.frombuffer(bytes(deep.data), "<f4").reshape(24, 32)
    assert 0.01 < np.min(depth) < 5


def test_events_report_steps_and_verdicts_in_the_order_in_which_they_came(messages, stored):
    reported = [
        (time, json.loads(message.data)) for time, message in messages["/armharness/events"]
    ]
    assert [time for time, _ in reported] == sorted(time for time, _ in reported)
    assert reported[0][1] == {
        "event": "run_started", "scenario": "Something for every topic", "case": "", "seed": 3
    }  # fmt: skip
    assert reported[-1][1]["digest"] == stored.digest
    assert reported[-1][1]["outcome"] == "failed"
    steps = [(e["event"], e["step"]) for _, e in reported if e["event"].startswith("step")]
    ids = [step.id for step in stored.run.steps]
    reached = ids[:-1]
    expected = [(word, name) for name in reached for word in ("step_started", "step_finished")]
    assert steps == [*expected, ("step_not_reached", ids[-1])]
    failed = next(e for _, e in reported if e.get("step") == "too_far" and "status" in e)
    assert (failed["status"], failed["error_code"]) == ("failed", "NO_IK_SOLUTION")
    verdicts = {e["expectation"]: e["status"] for _, e in reported if e["event"] == "verdict"}
    assert verdicts == {v.expectation: v.status for v in stored.verdicts}
    logged = [(message.level, message.msg) for _, message in messages["/rosout"]]
    assert len(logged) == len(reported)
    assert any(level == 40 and "too_far: failed: NO_IK_SOLUTION" in said for level, said in logged)


@pytest.mark.nightly
def test_equal_runs_leave_equal_bytes(folder, tmp_path):
    again = everything(tmp_path, bag=True)
    for name in ("bag.mcap", "metadata.yaml", "robot.urdf", "view.rviz", "foxglove.json"):
        assert (folder / "bag" / name).read_bytes() == (again / "bag" / name).read_bytes(), name
    for run, place in ((folder, tmp_path / "one"), (again, tmp_path / "two")):
        write_bag(place / "lite", read_run(run), BagOptions(storage="sqlite3"))
    for name in ("lite.db3", "metadata.yaml"):
        one, two = (tmp_path / place / "lite" / name for place in ("one", "two"))
        assert one.read_bytes() == two.read_bytes(), name


def test_sqlite3_holds_the_same_messages_for_any_reader_of_databases(folder, tmp_path):
    write_bag(tmp_path / "lite", read_run(folder), BagOptions(storage="sqlite3"))
    database = sqlite3.connect(tmp_path / "lite/lite.db3")
    rows = database.execute(
        "SELECT topics.name, timestamp, data FROM messages"
        " JOIN topics ON topics.id = topic_id ORDER BY messages.id"
    ).fetchall()
    database.close()
    with (folder / "bag/bag.mcap").open("rb") as file:
        packed = [
            (channel.topic, message.log_time, message.data)
            for _, channel, message in make_reader(file).iter_messages(log_time_order=False)
        ]
    assert rows == packed


def test_the_viewers_files_name_topics_of_the_bag_and_no_others(folder):
    rviz = yaml.safe_load((folder / "bag/view.rviz").read_text())["Visualization Manager"]
    named = set()
    for display in rviz["Displays"]:
        for key in ("Topic", "Description Topic"):
            if key in display:
                name = display[key]["Value"]
                named.add(name)
                is_latched = display[key]["Durability Policy"] == "Transient Local"
                assert is_latched == (name in LATCHED)
    assert {"/robot_description", "/scene_markers", "/tcp_path"} < named <= TOPICS
    assert "/over_view/image/compressed" in named
    assert rviz["Global Options"]["Fixed Frame"] == "world"

    layout = json.loads((folder / "bag/foxglove.json").read_text())
    panels = []

    def walk(node):
        if isinstance(node, str):
            panels.append(node)
        else:
            assert 0 < node["splitPercentage"] < 100
            walk(node["first"])
            walk(node["second"])

    walk(layout["layout"])
    assert sorted(panels) == sorted(layout["configById"])
    scene = next(value for name, value in layout["configById"].items() if name.startswith("3D!"))
    assert scene["topics"]["/robot_description"] == {"visible": True}
    assert set(scene["topics"]) <= TOPICS


EXPORT = """
import sys
class Closed:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {"mujoco", "ompl", "pinocchio", "coal"}:
            raise ImportError(f"{name} is not needed to export a run")
sys.meta_path.insert(0, Closed())
from harness.cli.main import main
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.nightly
def test_export_needs_neither_planner_nor_physics_and_writes_the_same_bag(folder, tmp_path):
    words = ["export", str(folder), "--bag", str(tmp_path / "bag"), "--urdf", str(tmp_path / "r")]
    done = subprocess.run(
        [sys.executable, "-c", EXPORT, *words], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    for file in (folder / "bag").iterdir():
        assert (tmp_path / "bag" / file.name).read_bytes() == file.read_bytes()
    assert (tmp_path / "r").read_text() == read_run(folder).run.robot.urdf


def test_mesh_addresses_become_files_that_are_there_when_requested(folder, tmp_path):
    assert main(["export", str(folder), "--urdf", str(tmp_path / "r"), "--meshes", "file"]) == 0
    text = (tmp_path / "r").read_text()
    assert "package://" in read_run(folder).run.robot.urdf
    addresses = [part.split('"')[0] for part in text.split('filename="file://')[1:]]
    assert len(addresses) >= 7
    assert all(Path(address).is_file() for address in addresses)


@pytest.mark.nightly
def test_frames_are_published_raw_too_when_requested(folder, tmp_path):
    place = tmp_path / "raw"
    assert main(["export", str(folder), "--bag", str(place), "--raw-images", "--rate", "20"]) == 0
    messages = decoded(place)
    raw = messages["/over_view/image"]
    assert len(raw) == len(messages["/over_view/image/compressed"])
    assert {(m.encoding, m.step, len(m.data)) for _, m in raw} == {("rgb8", 192, 9216)}
    spacing = np.diff([time for time, _ in messages["/joint_states"]])
    assert spacing[:-1] == pytest.approx(0.05, abs=1e-6)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["{run}"], "nothing to export: say --bag DIR, --urdf FILE, or both"),
        (["{run}/nowhere", "--bag", "{tmp}/bag"], "is not the folder of a run: it has no run.json"),
        (["{run}", "--bag", "{run}/bag"], "exists already; nothing was written (--force"),
        (["{run}", "--bag", "{run}", "--force"], "is a folder and no bag; it is not replaced"),
        (["{run}", "--bag", "/proc/nowhere/bag"], "'/proc/nowhere/bag' cannot be written"),
    ],
)
def test_wrong_use_of_export_is_reported_and_writes_nothing(folder, tmp_path, capsys, words, said):
    names = {"run": folder, "tmp": tmp_path}
    assert exit_code("export", *(word.format(**names) for word in words)) == 2
    assert said in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.nightly
def test_a_bag_makes_way_for_a_bag_when_forced_to(folder, tmp_path, capsys):
    words = ["export", str(folder), "--bag", str(tmp_path / "bag")]
    assert main([*words, "--storage", "sqlite3"]) == 0
    assert main([*words, "--force"]) == 0
    assert [file.suffix for file in (tmp_path / "bag").glob("bag.*")] == [".mcap"]
    assert [file.name for file in tmp_path.iterdir()] == ["bag"]
    assert "wrote" in capsys.readouterr().out
