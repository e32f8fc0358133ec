"""`--on ray`: the same results as locally, whatever is killed meanwhile."""

import contextlib
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from tests.suite.ball import RATE, ball
from tests.waiting import HANG, wait_for

pytestmark = [pytest.mark.needs_cluster, pytest.mark.timeout(HANG)]

ENVIRONMENT = {**os.environ, "RAY_AUTH_MODE": "disabled", "RAY_USAGE_STATS_ENABLED": "0"}


def command(*words):
    return [sys.executable, "-m", "harness.cli", "run", "ball.scenario.yaml", "--no-page", *words]


def harness(folder, *words, **environment):
    return subprocess.run(
        command(*words), cwd=folder, capture_output=True, text=True, check=False,
        env={**ENVIRONMENT, **environment},
    )  # fmt: skip


def scenario(folder, count, rest=RATE):
    (folder / "ball.scenario.yaml").write_text(ball(count, rest))


def journal(folder):
    """Case -> outcome and digest; every case stands there once."""
    lines = (folder / "results.jsonl").read_text().splitlines()
    results = [entry["result"] for line in lines if "result" in (entry := json.loads(line))]
    assert max(Counter(each["case"] for each in results).values()) == 1
    return {each["case"]: (each["outcome"], each["digest"]) for each in results}


def document(folder):
    found = json.loads((folder / "results.json").read_text())
    return found["rates"], [case["worst_margin"] for case in found["cases"]]


def lines_in(folder):
    file = folder / "results.jsonl"
    return len(file.read_text().splitlines()) if file.exists() else 0


def ray_workers():
    """Ray's processes that run batches."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if path.read_bytes().startswith(b"ray::run_batch"):
                found.append(int(path.parent.name))
        except OSError:
            continue
    return found


@pytest.fixture(scope="module")
def local(tmp_path_factory):
    """200 cases on this machine."""
    folder = tmp_path_factory.mktemp("local")
    scenario(folder, 200)
    done = harness(folder, "-j", "2", "--report-dir", "local")
    assert done.returncode == 0, done.stderr
    return folder


def test_two_ray_processes_give_the_results_of_a_local_run(local):
    done = harness(local, "-j", "2", "--on", "ray", "--report-dir", "ray")
    assert done.returncode == 0, done.stderr
    assert journal(local / "ray") == journal(local / "local")
    assert document(local / "ray") == document(local / "local")
    failed = [case for case, (outcome, _) in journal(local / "ray").items() if outcome == "failed"]
    for case in failed:
        assert (local / "ray/ball" / case / "run.json").is_file()


def test_a_sequential_test_ends_the_sampling_at_the_same_sample(tmp_path):
    scenario(tmp_path, 200, RATE.replace("false", "true"))
    harness(tmp_path, "-j", "2", "--report-dir", "local")
    harness(tmp_path, "-j", "2", "--on", "ray", "--report-dir", "ray")
    assert document(tmp_path / "ray") == document(tmp_path / "local")
    assert lines_in(tmp_path / "ray") < 200


@pytest.mark.parametrize("folder", ["/proc/none", "/etc/hostname", 120 * "x"])
def test_a_cluster_that_does_not_start_is_reported_in_one_line(tmp_path, folder):
    scenario(tmp_path, 2)
    done = harness(tmp_path, "--on", "ray", RAY_TMPDIR=str(tmp_path / folder))
    assert done.returncode == 3
    [line] = done.stderr.splitlines()
    assert line.startswith("harness: the Ray cluster on this machine cannot be reached: ")


def test_a_killed_worker_loses_and_repeats_no_case(local):
    running = subprocess.Popen(
        command("-j", "2", "--on", "ray", "--report-dir", "killed"), cwd=local, env=ENVIRONMENT
    )
    wait_for(lambda: lines_in(local / "killed") > 20 and ray_workers())
    os.kill(ray_workers()[0], signal.SIGKILL)
    assert running.wait() == 0
    assert journal(local / "killed") == journal(local / "local")


def test_after_a_killed_driver_resume_runs_the_rest(local):
    words = ("-j", "2", "--on", "ray", "--report-dir", "resumed")
    running = subprocess.Popen(command(*words), cwd=local, env=ENVIRONMENT)
    wait_for(lambda: lines_in(local / "resumed") > 20)
    running.kill()
    running.wait()
    kept = lines_in(local / "resumed")
    wait_for(lambda: not ray_workers())
    done = harness(local, *words, "--resume")
    assert done.returncode == 0, done.stderr
    assert f"{kept} of them were known" in done.stdout or kept == 200
    assert journal(local / "resumed") == journal(local / "local")


@pytest.fixture
def cluster():
    """A head without processors, to which nodes are added."""
    from ray.cluster_utils import Cluster

    os.environ["RAY_AUTH_MODE"] = "disabled"
    started = Cluster(
        initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False}
    )
    yield started
    started.shutdown()
    del os.environ["RAY_AUTH_MODE"]


def test_a_killed_node_loses_and_repeats_no_case(local, cluster):
    lost = cluster.add_node(num_cpus=1, include_dashboard=False)
    cluster.add_node(num_cpus=1, include_dashboard=False)
    running = subprocess.Popen(
        command("--on", "ray", "--report-dir", "node"),
        cwd=local,
        env={**ENVIRONMENT, "RAY_ADDRESS": cluster.address},
    )
    wait_for(lambda: lines_in(local / "node") > 20)
    cluster.remove_node(lost, allow_graceful=False)
    assert running.wait() == 0
    assert journal(local / "node") == journal(local / "local")


# Ends the first server that Ray starts for a client, as an error of Ray's does now and then.
DIES_ONCE = """
import os, pathlib, sys
mark = pathlib.Path(__file__).with_name("died")
if "specific-server" in " ".join(sys.orig_argv) and "_worker" not in sys.orig_argv[1]:
    if not mark.exists():
        mark.touch()
        os._exit(1)
"""


@pytest.fixture
def head(tmp_path):
    """The address of a cluster that is reached through Ray's client, at the second try."""
    ray = Path(sys.executable).with_name("ray")
    (tmp_path / "sitecustomize.py").write_text(DIES_ONCE, encoding="utf-8")
    started = subprocess.Popen(
        [ray, "start", "--head", "--block", "--node-ip-address=127.0.0.1", "--port=26379",
         "--ray-client-server-port=21001", "--num-cpus=2", "--include-dashboard=false"],
        env={**ENVIRONMENT, "PYTHONPATH": str(tmp_path)},
        start_new_session=True, stdout=subprocess.DEVNULL,
    )  # fmt: skip
    wait_for(lambda: answers(21001))
    yield "ray://127.0.0.1:21001"
    assert (tmp_path / "died").exists()
    os.killpg(started.pid, signal.SIGTERM)
    started.wait()


def answers(port):
    with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), 1.0):
        return True
    return False


def test_a_cluster_that_a_client_reaches_gives_the_results_of_a_local_run(local, head):
    done = harness(local, "--on", head, "--report-dir", "client")
    assert done.returncode == 0, done.stderr
    assert journal(local / "client") == journal(local / "local")
    assert document(local / "client") == document(local / "local")


def test_a_node_with_other_sources_is_refused(local, cluster, tmp_path, monkeypatch):
    source = Path(__file__).parents[2] / "harness"
    shutil.copytree(source, tmp_path / "harness", ignore=shutil.ignore_patterns("__pycache__"))
    with (tmp_path / "harness/steps/wait.py").open("a") as file:
        file.write("# a change\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    cluster.add_node(num_cpus=1, include_dashboard=False)
    monkeypatch.delenv("PYTHONPATH")
    done = harness(local, "--on", "ray", "--report-dir", "mixed", RAY_ADDRESS=cluster.address)
    assert done.returncode == 3
    assert "has source " in done.stderr
    assert "results of different installations are not mixed" in done.stderr
    assert lines_in(local / "mixed") == 0
