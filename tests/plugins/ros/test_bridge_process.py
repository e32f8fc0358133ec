"""The process of `harness bridge`, which forks to plan."""

import os
import signal
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest

from harness.plugins.ros.domain import free_domain
from harness.suite.environment import ONE_THREAD
from tests.plugins.ros.bridging import scenario
from tests.plugins.ros.move_group_client import UR, MoveGroupClient, joint_goal, request
from tests.plugins.ros.nodes import Node
from tests.waiting import HANG


@pytest.mark.nightly
def test_the_bridge_has_one_thread_so_that_its_forks_inherit_no_lock(tmp_path):
    file = scenario(tmp_path, "- external: {}", robot=UR)
    command = [sys.executable, "-c", "from harness.cli.main import entry; entry()"]
    environment = {name: value for name, value in os.environ.items() if name not in ONE_THREAD}
    with free_domain() as domain:
        program = subprocess.Popen(
            [*command, "bridge", str(file), "--no-report", "--domain", str(domain)], env=environment
        )
        node = Node(domain)
        with closing(node.graph):
            client = MoveGroupClient(node)
            goal = request(joint_goal({"elbow_joint": 0.1}))
            client.call("plan_kinematic_path", "GetMotionPlan", motion_plan_request=goal)
            threads = [*Path(f"/proc/{program.pid}/task").iterdir()]
            program.send_signal(signal.SIGINT)
            assert program.wait(HANG) == 0
    assert len(threads) == 1
