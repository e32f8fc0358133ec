"""Damaged folders of runs are refused at the key, and changed ones are called changed."""

import json
import shutil
import subprocess
import sys
import zipfile

import numpy as np
import pytest

from tests.damaged.front_door import outcome_of
from tests.damaged.mutants import npz_bytes
from tests.damaged.trials import run_trial, tiny_run


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    folder = tmp_path_factory.mktemp("base")
    tiny_run(folder)
    return folder


@pytest.fixture
def run(base, tmp_path):
    return shutil.copytree(base / "run", tmp_path / "run")


def commands(base, run):
    """Every command that reads a run's folder."""
    return {
        "judge": ("judge", run),
        "view": ("view", run, "--rebuild", "--no-open"),
        "compare": ("compare", base / "run", run),
        "export": ("export", run, "--bag", run.parent / "bag"),
    }


def assert_refused(base, run, *said):
    """Every command ends with exit code 2 and names the file and the key."""
    for name, arguments in commands(base, run).items():
        code, printed = outcome_of(*arguments)
        assert code == 2, (name, printed)
        assert printed.startswith(str(run)), (name, printed)
        assert "damaged run: " in printed, (name, printed)
        for word in said:
            assert word in printed, (name, printed)
    assert not (run.parent / "bag").exists()


def arrays_of(run):
    with np.load(run / "signals.npz") as file:
        return dict(file)


def with_array(run, name, change):
    arrays = arrays_of(run)
    changed = change(arrays.pop(name))
    others = arrays if changed is None else {**arrays, name: changed}
    (run / "signals.npz").write_bytes(npz_bytes(others))


@pytest.mark.nightly(but=[0, 1, 3, 6, 9])
@pytest.mark.parametrize(
    ("name", "change", "said"),
    [
        ("joint_positions", lambda a: a[:-5], "expected the shape"),
        ("tcp_pose", lambda a: a[:, :6], "7), found"),
        ("object_poses/block", lambda a: a[0], "expected the shape"),
        ("joint_velocities", lambda a: a.astype(np.float32), "expected float64, found float32"),
        ("clearances/robot|block", lambda a: a.astype(str), "expected float64, found <U"),
        ("joint_commands", lambda a: a.astype(complex), "expected float64, found complex128"),
        ("times", lambda a: a[::-1], "expected finite times that rise"),
        ("times", lambda a: a[:, None], "expected the shape (samples,)"),
        ("times", lambda a: np.append(a[:-1], np.nan), "expected finite times that rise"),
        ("times", lambda _: None, "this array is missing"),
        ("joint_efforts", lambda _: None, "this array is missing"),
        ("clearance_links/robot|block", lambda a: a + 1000, "expected indices from -1 to"),
        ("trajectories/0/times", lambda _: None, "run.json names it as steps[0].trajectory.times"),
        ("trajectories/0/positions", lambda a: a[:-1], "expected the shape"),
        ("trajectories/0/velocities", lambda a: a + np.inf, "expected finite numbers"),
        ("contact_forces/a|b", lambda a: np.array([{"a": 1}] * len(a)), "pickled"),
    ],
)  # fmt: skip
def test_an_array_of_another_length_shape_or_type_is_named(base, run, name, change, said):
    if name.startswith("contact_forces"):
        arrays = arrays_of(run)
        arrays[name] = change(arrays["times"])
        (run / "signals.npz").write_bytes(npz_bytes(arrays))
    else:
        with_array(run, name, change)
    named = name.replace("trajectories/0/", "") if name.endswith(("ons", "ies")) else name
    assert_refused(base, run, said, named)


@pytest.mark.nightly(but=[0, 2, 16])
@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        (("robot", "joints", 1, "lower"), "low", 'joints[1].lower: expected a number, found "low"'),
        (("robot", "joints"), {"a": 1}, "robot.joints: expected a list, found a mapping"),
        (("robot", "groups", "arm", "joint_names"), ["elbow"], "arm: there is no joint 'elbow'"),
        (("robot", "joints", 1, "axis"), [0, 1], "robot.joints[1].axis: expected the shape (3,)"),
        (("robot", "joints", 1, "axis"), [0, [1]], "robot.joints[1].axis: expected lists of one"),
        (("robot", "links", 0, "name"), "earth", "joints[0].parent: there is no link 'world'"),
        (("steps", 0, "end_index"), 10**6, "steps[0].start_index: expected indices within 0 to"),
        (("steps", 0, "status"), "perfect", "steps[0].status: expected one of passed"),
        (("steps", 0, "start_time"), "NaN", "steps[0].start_time: expected finite times"),
        (("steps", 0, "trajectory", "times"), [1], "trajectory.times: expected a mapping"),
        (("steps",), None, "steps: expected a list of mappings"),
        (("seed",), 0.5, "seed: expected a whole number, found 0.5"),
        (("objects", 0, "pose"), [0.1, 0.2], "objects[0].pose: expected the shape (7,)"),
        (("objects", 0, "shapes", 0, "geometry", "kind"), "cone", "kind: expected one of box"),
        (("objects", 0, "shapes", 0, "pose", "rotation"), [1], "rotation: expected 3 items"),
        (("clearance_cutoff",), [], "clearance_cutoff: expected a number, found a list"),
        (("digest",), 7, "digest: expected a text, found 7"),
        (("timestep",), 10**400, "timestep: the number 1000"),
        (("scenario",), "\ud800", "surrogates not allowed"),
    ],
)  # fmt: skip
def test_a_value_of_run_json_that_does_not_fit_is_named(base, run, place, value, said):
    document = json.loads((run / "run.json").read_text())
    inner = document
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    (run / "run.json").write_text(json.dumps(document))
    assert_refused(base, run, "run.json: ", said)


@pytest.mark.parametrize("key", ["robot", "steps", "objects", "verdicts", "digest", "wall_times"])
def test_a_key_that_is_missing_in_run_json_is_named(base, run, key):
    document = json.loads((run / "run.json").read_text())
    del document[key]
    (run / "run.json").write_text(json.dumps(document))
    assert_refused(base, run, f"run.json: damaged run: {key}: this key is missing")


@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("run.json", b'{"format": "armharness-run/1",\n "steps": [}', "run.json:2:12: damaged run"),
        ("run.json", b"\xff\xfe", "byte 0 is no UTF-8"),
        ("run.json", b"[" * 100_000, "nested too deeply"),
        ("run.json", b"[1]", "expected a mapping"),
        ("signals.npz", b"PK", "not a zip file"),
        ("signals.npz", None, "signals.npz: damaged run: this file is missing"),
        ("visuals.npz", b"", "not a zip file"),
        ("scenario.resolved.yaml", b"\xff", "byte 0 is no UTF-8"),
    ],
)
def test_a_file_that_is_missing_or_no_longer_of_its_kind_is_named(base, run, name, data, said):
    if name == "visuals.npz":
        document = json.loads((run / "run.json").read_text())
        document["meshes"] = [{"path": "a.stl", "scale": [1, 1, 1], "rgba": None}]
        (run / "run.json").write_text(json.dumps(document))
    if data is None:
        (run / name).unlink()
    else:
        (run / name).write_bytes(data)
    assert_refused(base, run, name, said)


def test_a_changed_signal_is_no_equal_run_and_no_passed_one(base, run):
    """One number in the recording is another; the digest in run.json is the old one."""
    with_array(run, "joint_efforts", lambda a: np.where(np.arange(len(a))[:, None] == 7, 1e-3, a))
    code, printed = outcome_of("compare", base / "run", run)
    assert code == 1
    assert printed.startswith("different")
    assert "second run: signals, trajectories or verdicts were changed after" in printed
    twin = shutil.copytree(run, run.with_name("twin"))
    code, printed = outcome_of("compare", run, twin)
    assert code == 1
    assert "first run: signals" in printed
    assert "second run: signals" in printed
    code, printed = outcome_of("judge", run)
    assert code == 1
    assert "changed  signals, trajectories or verdicts were changed after the run was" in printed
    code, printed = outcome_of("judge", run, "--json")
    assert json.loads(printed)["exit_code"] == code == 1
    assert len(json.loads(printed)["changes"]) == 1


@pytest.mark.parametrize("name", ["run.json", "scenario.resolved.yaml", "trajectory"])
def test_other_changes_of_a_run_are_reported(base, run, name):
    if name == "trajectory":
        with_array(run, "trajectories/0/positions", lambda a: a * 1.001)
    else:
        text = (run / name).read_text()
        assert "1 cm" in text or "0.01" in text
        (run / name).write_text(text.replace("a tiny run", "another run"))
    for command in ("judge", "compare"):
        code, printed = outcome_of(*commands(base, run)[command])
        assert code == 1
        assert "after the run was written" in printed


def test_a_run_as_it_was_written_is_not_called_changed(base, run):
    assert outcome_of("judge", run)[0] == 0
    code, printed = outcome_of("compare", base / "run", run)
    assert (code, printed.partition(":")[0]) == (0, "same  equal digests")


def zeros_npz(path, name, shape):
    """Zeros that are small on disk and huge in memory."""
    with (
        zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
        archive.open(f"{name}.npy", "w", force_zip64=True) as member,
    ):
        header = {"descr": "<f8", "fortran_order": False, "shape": shape}
        np.lib.format.write_array_header_1_0(member, header)
        left = 8 * int(np.prod(shape))
        while left:
            left -= member.write(bytes(min(left, 2**24)))


@pytest.mark.nightly(but=[1])
@pytest.mark.parametrize(
    ("name", "shape", "said"),
    [
        ("object_poses/huge", (12_000_000, 7), "expected the shape"),
        ("other", (300_000_000,), "at most 2147483648 are read"),
    ],
)
def test_arrays_that_unpack_to_gigabytes_are_refused_unread(run, name, shape, said):
    """11 MB on disk would take 2.4 GB; the process that compares them stays below 0.4 GB."""
    zeros_npz(run / "signals.npz", name, shape)
    assert (run / "signals.npz").stat().st_size < 12e6
    program = (
        "import re, sys\n"
        "from pathlib import Path\n"
        "from harness.cli.main import main\n"
        "code = main(['compare', sys.argv[1], sys.argv[1]])\n"
        "status = Path('/proc/self/status').read_text()\n"
        "print(re.search(r'VmHWM:\\s+(\\d+) kB', status)[1])\n"  # ru_maxrss counts the parent's too
        "sys.exit(code)\n"
    )
    command = [sys.executable, "-c", program, str(run)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2, done.stderr
    assert said in done.stderr
    assert int(done.stdout.split()[-1]) * 1024 < 400e6


@pytest.mark.nightly(but=[1, 2, 5])
@pytest.mark.parametrize("seed", range(40))
def test_no_damaged_run_ends_in_a_traceback(base, seed):
    run_trial(base, seed)
