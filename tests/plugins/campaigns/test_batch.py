"""A batch of cases on a node: the same results as on the machine that sends it."""

import json
import os
import shutil
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import pytest
import trimesh

from harness.cli.main import main
from harness.core.resources import data_folder
from harness.plugins.campaigns.cluster.batch import Batch, Files, run_batch, unpack_report
from harness.plugins.campaigns.cluster.named_files import named_files
from harness.session.run_request import RunRequest
from harness.suite.installation import Installation, installation
from tests.commands import forked

WORLD = """\
world: table
objects:
  - {name: table, box: {size: [0.4, 0.4, 0.02]}, pose: {xyz: [0.3, 0, -0.1]}, static: true}
"""
SCENARIO = """\
scenario: Wait at a table
robot: open_manipulator_x
world: ../worlds/table.world.yaml
params: {time: 2 ms}
steps:
  - wait: "${time}"
expect:
  - duration: {at_most: 3 ms}
parametrize:
  time: [1 ms, 5 ms]
"""


def run_elsewhere(batch, files, cwd):
    """Run a batch as a node does: in another process, in another folder."""
    ended = forked(run_batch_in, cwd, batch, files)
    assert ended.code == 0, ended.traceback
    return ended.result


def run_batch_in(cwd, batch, files, _notify):
    os.chdir(cwd)
    return run_batch(batch, files)


@pytest.fixture
def suite(tmp_path, monkeypatch):
    """A scenario that names a world in another folder, and the results of a local run."""
    (tmp_path / "worlds").mkdir()
    (tmp_path / "cases").mkdir()
    (tmp_path / "worlds/table.world.yaml").write_text(WORLD)
    (tmp_path / "cases/wait.scenario.yaml").write_text(SCENARIO)
    monkeypatch.chdir(tmp_path / "cases")
    main(["run", "wait.scenario.yaml", "--report-dir", "local", "--no-page"])
    lines = Path("local/results.jsonl").read_text().splitlines()
    results = [json.loads(each)["result"] for each in lines if '"result"' in each]
    return {result["case"]: result for result in results}


@pytest.mark.nightly
@pytest.mark.parametrize("is_absolute", [False, True])
def test_a_node_without_the_files_computes_the_same(suite, tmp_path, is_absolute):
    file = Path("wait.scenario.yaml")
    contents = {os.path.abspath(path): data for path, data in named_files(file)}  # noqa: PTH100
    assert sorted(Path(path).name for path in contents) == [
        "table.world.yaml",
        "wait.scenario.yaml",
    ]
    sent = file.resolve() if is_absolute else file
    cases = tuple(
        (index, RunRequest(sent, {"time": time}, case=name, report_dir=Path(f"remote/{name}")))
        for index, (name, time) in enumerate((("1_ms", "1 ms"), ("5_ms", "5 ms")))
    )
    files = Files(contents, str(Path.cwd()), {})
    for path in contents:
        Path(path).unlink()
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    result = run_elsewhere(Batch(cases, installation(), None), files, elsewhere)
    assert len(result.results) == 2
    for index, case, packed in result.results:
        local = suite[case.case]
        assert (case.outcome, case.digest) == (local["outcome"], local["digest"])
        assert case.file == str(sent)
        assert case.report_dir == f"remote/{case.case}"
        unpack_report(packed, cases[index][1].report_dir)
        assert json.loads(Path(case.report_dir, "run.json").read_text())["digest"] == case.digest
    assert not list(Path(tempfile.gettempdir()).glob("harness-batch-*/*/elsewhere"))


ARM = """\
scenario: An arm in a folder
robot: {model: %s}
objects: [{name: part, mesh: {file: part.glb}, pose: {xyz: [1, 0, 0]}, static: true}]
steps: [{wait: 2 ms}]
"""


def arm_in_a_folder(tmp_path, monkeypatch, name):
    """A scenario whose robot has a folder, and the files that a node gets of it."""
    (tmp_path / "cases").mkdir()
    monkeypatch.chdir(tmp_path / "cases")
    shutil.copytree(data_folder("robots") / "open_manipulator_x", "arm")
    trimesh.creation.box((0.1, 0.1, 0.1)).export("part.glb")
    file = Path("a.scenario.yaml")
    file.write_text(ARM % name)
    return file, {os.path.abspath(path): data for path, data in named_files(file)}  # noqa: PTH100


@pytest.mark.parametrize("name", ["./arm", "'../cases/arm'"])
def test_the_folder_of_a_robot_is_sent_however_it_is_named(tmp_path, monkeypatch, name):
    _, contents = arm_in_a_folder(tmp_path, monkeypatch, name)
    here = Path.cwd()
    files = {str(path) for path in here.rglob("*") if path.is_file() and path.suffix != ".md"}
    assert files <= {*contents}


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["./arm", "arm", "'../cases/arm'"])
def test_a_node_gets_the_folder_of_a_robot(tmp_path, monkeypatch, name):
    file, contents = arm_in_a_folder(tmp_path, monkeypatch, name)
    files = Files(contents, str(Path.cwd()), {})
    shutil.rmtree(tmp_path / "cases")
    (tmp_path / "elsewhere").mkdir()
    batch = Batch(((0, RunRequest(file)),), installation(), None)
    [(_, case, _)] = run_elsewhere(batch, files, tmp_path / "elsewhere").results
    assert case.outcome == "passed", (case.problems, case.message)


def test_words_that_are_too_long_for_a_path_are_no_files(tmp_path):
    file = tmp_path / "a.scenario.yaml"
    file.write_text(f"scenario: {'a' * 5000}\nworld: {'b' * 5000}.yaml\n")
    assert [path for path, _ in named_files(file)] == [file]


@pytest.mark.nightly
def test_problems_of_a_file_are_reported_with_the_path_of_the_sender(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file = Path("wait.scenario.yaml").resolve()
    file.write_text(SCENARIO.replace("duration", "duratoin"))
    contents = {str(file): file.read_bytes()}
    batch = Batch(((3, RunRequest(file)),), installation(), None)
    result = run_elsewhere(batch, Files(contents, str(Path.cwd()), {}), tmp_path)
    [(index, case, packed)] = result.results
    assert (index, case.outcome, packed) == (3, "invalid", b"")
    assert {problem.path for problem in case.problems} == {str(file)}


@pytest.mark.nightly(but=["changed0-version"])
@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"version": "0.0.1"}, "version"),
        ({"source": "0" * 64}, "source"),
        ({"libraries": {"mujoco": "3.0"}}, "mujoco"),
    ],
)
def test_a_node_with_another_installation_runs_nothing(tmp_path, changed, says):
    other: Installation = replace(installation(), **changed)
    batch = Batch(((0, RunRequest(Path("nothing.yaml"))),), other, None)
    result = run_elsewhere(batch, Files({}, str(tmp_path), {}), tmp_path)
    assert result.results == ()
    assert f"has {says} " in result.refusal


def test_a_cluster_that_does_not_exist_is_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("wait.scenario.yaml").write_text(SCENARIO)
    assert main(["run", "wait.scenario.yaml", "--on", "kubernetes"]) == 2
    assert "write ray, or ray://HOST:PORT" in capsys.readouterr().err


def test_a_missing_ray_is_named_with_the_way_to_install_it(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "ray", None)
    Path("wait.scenario.yaml").write_text(SCENARIO)
    assert main(["run", "wait.scenario.yaml", "--on", "ray"]) == 2
    assert "-m pip install 'ray[client]>=2.40'" in capsys.readouterr().err
    assert not Path("reports").exists()
