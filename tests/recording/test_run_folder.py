"""A run's folder: whole or not there, and read back equal."""

import errno
import json
import zipfile
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from harness.core.camera import Camera
from harness.core.errors import HarnessError
from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Plane, Shape, Sphere
from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.judging.expectations.grasped import Grasped
from harness.judging.expectations.lifted import Lifted
from harness.judging.judge import judge
from harness.judging.placed import PlacedExpectation
from harness.plugins.arms.expectations.clearance import Clearance
from harness.plugins.objects.expectations.static import Static
from harness.recording.arrays import arrays_of
from harness.recording.digest import digest
from harness.recording.drawings import Drawings, MeshRecord
from harness.recording.explanation import recorded_explanation
from harness.recording.older_runs import FORMAT
from harness.recording.plain import to_plain
from harness.recording.read_run import read_run
from harness.recording.run import Finding
from harness.recording.signals import CaptureRecord, VideoRecord
from harness.recording.step_results import SavedDetails, SavedResult
from harness.recording.stored_run import StoredRun
from harness.recording.write_run import run_folder, write_run
from harness.robot.mechanism import Inertial, Link
from tests.judging.synthetic_run import ROBOT, attachment, lift_run, make_run, step, thing

EXPECTED = [
    PlacedExpectation(Lifted(object="box", above=0.05), "", 3),
    PlacedExpectation(Lifted(object="box", above=0.5), "lift", 4),
    PlacedExpectation(Grasped(object="box"), "", 5),
    PlacedExpectation(Clearance(at_least=0.01), "", 6),
    PlacedExpectation(Static(), "unknown", 7),
]

TRIANGLE = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.25, 0.0]])
RED = (1.0, 0.0, 0.0, 1.0)
PICTURE = cv2.imencode(".png", np.zeros((2, 3, 3), np.uint8))[1].tobytes()


def full_run():
    """A run with something in every field."""
    run = lift_run(attachments=[attachment("box", 60, 200)])
    shapes = (Cylinder(0.1, 0.2), Sphere(0.1), Capsule(0.1, 0.3), Plane(), Mesh(Path("a/b.stl")))
    pose = SE3.from_xyz_rpy((0.1, 0.2, 0.3), (0.4, 0.5, 0.6))
    odd = replace(
        thing("ödd|na%me", Box((1, 2, 3))),
        shapes=tuple(Shape(geometry, pose, name="part") for geometry in shapes),
    )
    palm = Link("palm", Inertial(0.5, np.zeros(3), np.eye(3)), odd.shapes, odd.shapes[:1])
    links = tuple(palm if each.name == "palm" else each for each in ROBOT.links)
    robot = replace(
        ROBOT,
        urdf="<robot/>",
        links=links,
        cameras={"eye": Camera("eye", "palm", pose, width=4, height=2)},
        position_only_groups=frozenset({"arm"}),
    )
    first, *others = run.steps
    times = np.array([0.0, 0.1])
    first = replace(
        first,
        trajectory=JointTrajectory(
            ("shoulder",), times, np.array([[0.1], [1 / 3]]), *np.zeros((2, 2, 1))
        ),
        planner=SavedDetails(saved={"checks": 12, "length": float("inf"), "note": None}),
        explanation=SavedDetails(
            saved={"solutions": [{"positions": [0.1, float("nan")], "pair": ["a", "b"]}]}
        ),
        result=SavedResult(verb=first.verb, saved={"stalled": True}),
        expected_error="GOAL_IN_COLLISION",
    )
    signals = replace(
        run.signals,
        frames={"arm_link": run.signals.tcp_pose},
        clearances={("robot", "ödd|na%me"): np.where(run.signals.times < 1, 0.03, 0.02)},
        clearance_links={("robot", "ödd|na%me"): np.arange(200) % 4 - 1},
        clearance_cutoff=0.2,
    )
    return replace(
        run,
        robot=robot,
        objects=(*run.objects, odd),
        steps=(first, *others),
        signals=signals,
        allowed_contacts=(("palm", "arm_link"),),
        findings=(Finding("note", "ran without a renderer", values={"tried": ["egl"]}),),
        source="scenario: by hand\n",
        versions={"mujoco": "4.0.0"},
        ended_early="because",
        cameras=(Camera("eye", "palm", pose, width=4, height=2),),
        captures=(
            CaptureRecord(
                "eye",
                0.5,
                50,
                "look",
                files={"color": "cameras/eye/1.png"},
                pose=(0.1, 0, 0, 1, 0, 0, 0),
                labels={"box": 1},
                outlines={"box": 7},
            ),
        ),
        files={"cameras/eye/1.png": PICTURE},
    )


RESOLVED = "scenario: by hand\r\nseed: 0 # ü\n"
DRAWINGS = Drawings(
    meshes=(
        MeshRecord(Path("a/b.stl"), (1.0, 1.0, 1.0), TRIANGLE, np.array([[0, 1, 2]])),
        MeshRecord(Path("a/c.obj"), (2.0, 1.0, 1.0), TRIANGLE, np.array([[2, 1, 0]]), RED),
    ),
    videos=(VideoRecord("eye", "cameras/eye/all.webm", (0.0, 0.1), 10.0, 4, 2, "rays"),),
    files={"cameras/eye/all.webm": b"film"},
)


def written(folder, run=None):
    run = run or full_run()
    verdicts = judge(run, EXPECTED)
    stored = StoredRun(
        run, verdicts, "failed", digest(run, verdicts), {"plan": 0.25}, RESOLVED, DRAWINGS
    )
    write_run(folder, stored)
    return run, verdicts


def unjudged(run):
    return StoredRun(run, (), "passed", "", {})


def names_in(folder):
    return sorted(path.name for path in folder.iterdir())


def assert_equal_runs(a, b):
    left, right = (to_plain(replace(run, signals=None, steps=(), files={})) for run in (a, b))
    assert left == right
    assert dict(a.files) == dict(b.files)
    for one, other in zip(a.steps, b.steps, strict=True):
        assert to_plain(replace(one, trajectory=None)) == to_plain(replace(other, trajectory=None))
        assert (one.trajectory is None) == (other.trajectory is None)
        if one.trajectory is not None:
            assert one.trajectory.joint_names == other.trajectory.joint_names
            for key in ("times", "positions", "velocities", "accelerations"):
                there, back = getattr(one.trajectory, key), getattr(other.trajectory, key)
                np.testing.assert_array_equal(back, there)
    arrays, others = arrays_of(a.signals), arrays_of(b.signals)
    assert arrays.keys() == others.keys()
    for name, array in arrays.items():
        assert array.dtype == others[name].dtype
        np.testing.assert_array_equal(array, others[name])
    assert a.signals.clearance_cutoff == b.signals.clearance_cutoff


def assert_equal_drawings(a, b):
    assert (a.videos, dict(a.files)) == (b.videos, dict(b.files))
    for one, other in zip(a.meshes, b.meshes, strict=True):
        assert (one.path, one.scale, one.rgba) == (other.path, other.scale, other.rgba)
        np.testing.assert_array_equal(one.vertices, other.vertices)
        np.testing.assert_array_equal(one.faces, other.faces)


def test_a_run_read_back_is_equal_and_judged_equally(tmp_path):
    run, verdicts = written(tmp_path / "run")
    stored = read_run(tmp_path / "run")
    assert_equal_runs(run, stored.run)
    assert_equal_drawings(DRAWINGS, stored.drawings)
    assert type(stored.run.objects[2].shapes[4].geometry) is Mesh
    assert stored.run.objects[2].shapes[0].pose.rotation.dtype == float
    assert to_plain(stored.verdicts) == to_plain(verdicts)
    assert to_plain(judge(stored.run, EXPECTED)) == to_plain(verdicts)
    assert {verdict.status for verdict in verdicts} == {"passed", "failed", "not reached"}
    assert stored.digest == digest(stored.run, stored.verdicts)
    assert (stored.outcome, stored.wall_times) == ("failed", {"plan": 0.25})


def test_run_json_has_the_keys_that_tools_read(tmp_path):
    written(tmp_path / "run")
    document = json.loads((tmp_path / "run" / "run.json").read_text())
    keys = ["format", "scenario", "file", "case", "outcome", "digest", "seed", "steps", "verdicts"]
    assert list(document)[:12] == [*keys, "findings", "versions", "wall_times"]
    assert document["format"] == FORMAT
    assert list(document["steps"][0])[:5] == ["id", "step", "status", "error_code", "sim_time"]
    assert document["steps"][1]["sim_time"] == pytest.approx(0.4)
    assert document["verdicts"][4]["margin"] == "NaN"
    assert document["steps"][0]["planner"]["length"] == "Infinity"
    resolved = (tmp_path / "run" / "scenario.resolved.yaml").read_bytes()
    assert resolved.decode() == RESOLVED


def test_the_signals_are_the_same_bytes_every_time_and_plain_numpy(tmp_path):
    written(tmp_path / "a")
    written(tmp_path / "b")
    names = ["signals.npz", "run.json"]
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    with np.load(tmp_path / "a" / "signals.npz") as archive:
        assert archive["contact_forces/Table|box"].shape == (200,)
        assert archive["trajectories/0/positions"].tolist() == [[0.1], [1 / 3]]
    with zipfile.ZipFile(tmp_path / "a" / "signals.npz") as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}


def test_a_newer_run_replaces_an_older_one_with_nothing_left_next_to_it(tmp_path):
    written(tmp_path / "run")
    (tmp_path / "run" / "images").mkdir()
    written(tmp_path / "run", replace(full_run(), seed=5))
    assert read_run(tmp_path / "run").run.seed == 5
    assert not (tmp_path / "run" / "images").exists()
    assert names_in(tmp_path) == ["run"]


def test_extra_files_are_there_when_the_folder_appears(tmp_path):
    folder = tmp_path / "deep" / "run"

    with run_folder(folder, full_run()) as target:
        assert not folder.exists()
        (target / "images").mkdir()
        (target / "images" / "a.png").write_bytes(b"x")
    assert (folder / "images" / "a.png").read_bytes() == b"x"


@pytest.mark.parametrize(
    "trouble", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()]
)
def test_when_writing_breaks_off_the_older_run_stays_and_nothing_half_written(tmp_path, trouble):
    written(tmp_path / "run")

    def breaks():
        with run_folder(tmp_path / "run", full_run()) as target:
            (target / "half").write_text("x")
            raise trouble

    expected = HarnessError if isinstance(trouble, OSError) else KeyboardInterrupt
    with pytest.raises(expected) as caught:
        breaks()
    if expected is HarnessError:
        assert "No space left on device" in str(caught.value)
        assert "--report-dir" in str(caught.value)
    assert names_in(tmp_path) == ["run"]
    assert read_run(tmp_path / "run").outcome == "failed"


def test_a_place_that_cannot_be_made_is_reported(tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(HarnessError, match=r"cannot be written to .*file"):
        write_run(tmp_path / "file" / "run", unjudged(full_run()))
    with pytest.raises(HarnessError, match="is a file"):
        write_run(tmp_path / "file", unjudged(full_run()))


def test_a_folder_with_other_files_is_never_replaced(tmp_path):
    precious = tmp_path / "home" / "thesis.tex"
    precious.parent.mkdir()
    precious.write_text("years of work")
    with pytest.raises(HarnessError, match="holds other files"):
        write_run(precious.parent, unjudged(full_run()))
    assert precious.read_text() == "years of work"
    assert names_in(tmp_path) == ["home"]


def test_what_is_no_run_or_a_damaged_one_is_reported(tmp_path):
    with pytest.raises(HarnessError, match=r"is no run: it has no run\.json"):
        read_run(tmp_path)
    folder = tmp_path / "run"
    written(folder)
    text = (folder / "run.json").read_text()
    for damage, said in (
        (text.replace(FORMAT, "armharness-run/9"), "armharness-run/9"),
        (text[:500], "damaged"),
        ("[]", "damaged"),
        (text.replace('"status": "passed"', '"status": "perfect"'), "damaged"),
    ):
        (folder / "run.json").write_text(damage)
        with pytest.raises(HarnessError, match=said):
            read_run(folder)
    (folder / "run.json").write_text(text)
    (folder / "signals.npz").write_bytes(b"no zip")
    with pytest.raises(HarnessError, match="damaged"):
        read_run(folder)
    (folder / "signals.npz").unlink()
    with pytest.raises(HarnessError, match="damaged"):
        read_run(folder)


def test_a_pickle_in_the_signals_is_not_opened(tmp_path):
    written(tmp_path / "run")
    np.savez(tmp_path / "run" / "signals.npz", times=np.array([{"a": 1}], dtype=object))
    with pytest.raises(HarnessError, match="damaged"):
        read_run(tmp_path / "run")


@pytest.mark.parametrize("name", ["../secret.png", "/etc/hostname", "images/../../x", ""])
def test_a_picture_outside_of_the_folder_makes_a_damaged_run(tmp_path, name):
    written(tmp_path / "run")
    document = json.loads((tmp_path / "run" / "run.json").read_text())
    document["captures"][0]["files"]["color"] = name
    (tmp_path / "run" / "run.json").write_text(json.dumps(document))
    with pytest.raises(HarnessError, match="no path inside"):
        read_run(tmp_path / "run")


def test_a_picture_that_links_out_of_the_folder_is_not_read(tmp_path):
    written(tmp_path / "run")
    picture = tmp_path / "run" / "cameras" / "eye" / "1.png"
    picture.unlink()
    (tmp_path / "secret").write_bytes(b"secret")
    picture.symlink_to(tmp_path / "secret")
    with pytest.raises(HarnessError, match="leads out of"):
        read_run(tmp_path / "run").run.files["cameras/eye/1.png"]


def test_a_run_saved_before_there_were_cameras_is_read(tmp_path):
    written(tmp_path / "run")
    document = json.loads((tmp_path / "run" / "run.json").read_text())
    for key in ("cameras", "captures", "videos"):
        del document[key]
    (tmp_path / "run" / "run.json").write_text(json.dumps(document))
    stored = read_run(tmp_path / "run")
    run, drawings = stored.run, stored.drawings
    assert (run.cameras, run.captures, dict(run.files)) == ((), (), {})
    assert (drawings.videos, dict(drawings.files)) == ((), {})


def test_a_run_of_the_first_format_is_read_in_the_present_words(tmp_path):
    steps = (step("go", 0, 1, status="expected error"), step("late", 1, 1, status="not reached"))
    run = make_run(steps=steps)
    write_run(tmp_path / "run", StoredRun(run, (), "passed", digest(run, ()), {}))
    file = tmp_path / "run" / "run.json"
    document = json.loads(file.read_text())
    document["format"] = "armharness-run/1"
    for each, status in zip(document["steps"], ("expected_error", "not_reached"), strict=True):
        each["status"] = status
        each["explanation"] = {"stages": [{"stage": "path", "status": "not reached", "text": ""}]}
    file.write_text(json.dumps(document))
    first, second = read_run(tmp_path / "run").run.steps
    assert (first.status, second.status) == ("expected error", "not reached")
    assert [stage.status for stage in recorded_explanation(first.explanation).stages] == ["skipped"]
