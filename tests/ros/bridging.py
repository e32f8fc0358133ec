"""A bridge in a thread, with a node in its domain."""

from contextlib import contextmanager
from pathlib import Path
from threading import Event, Thread

from harness.ros.bridge import BridgeRequest, run_bridge
from harness.ros.domain import free_domain
from harness.session.run_request import RunRequest
from tests.ros.nodes import Node

ROBOT = "{model: open_manipulator_x}"
STEPS = "- external: {until: {joints: {positions: {joint1: 0.2}, tolerance: 0.5 deg}}}"


def scenario(folder, steps=STEPS, rest="expect: [{always: within_limits}]", robot=ROBOT):
    """A scenario file whose arm is handed over."""
    file = Path(folder) / "test.scenario.yaml"
    lines = "\n".join(f"  {line}" for line in steps.splitlines())
    file.write_text(f"scenario: a test\nrobot: {robot}\nsteps:\n{lines}\n{rest}\n")
    return file


@contextmanager
def bridge(file, *, waits=False, **options):
    """A bridge in a thread; yields a node in its domain and, at the end, the result.

    With the block the session ends, or, where it `waits`, with its steps.
    """
    ended = Event()
    with free_domain() as domain:
        run = RunRequest(Path(file), page=False, stills=False, **options.pop("run", {}))
        results = []
        request = BridgeRequest(run, domain, should_end=ended.is_set, **options)
        thread = Thread(target=lambda: results.append(run_bridge(request)))
        thread.start()
        node = Node(domain)
        try:
            yield node, results
        finally:
            if not waits:
                ended.set()
            thread.join(120)
            node.graph.close()
