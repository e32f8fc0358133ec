"""What a running case shows of itself while it runs; nothing of the run depends on it."""

from __future__ import annotations

import pickle
import select
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Client, Connection
from typing import TYPE_CHECKING

from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.reporting.progress_events import ProgressEvent, StepFinished
from harness.robot.description import RobotDescription

if TYPE_CHECKING:  # whoever shows a case needs no planner
    from harness.plugins.studio.live_simulator import LiveSimulator
    from harness.session.progress import Notify
    from harness.session.run_request import RunRequest
    from harness.session.start import Start
    from harness.session.timing import Clock

FRAME = 1 / 25  # wall time between two frames, at least [s]


@dataclass(frozen=True, eq=False)
class LiveCase:
    """A case that begins.

    Attributes:
        description: The pickled description of the robot, which is equal for equal robots.
        objects: Every object that is ever in the scene.
    """

    name: str
    description: bytes
    objects: tuple[WorldObject, ...]
    steps: int

    def robot(self) -> RobotDescription:
        """The description of the robot."""
        return pickle.loads(self.description)


@dataclass(frozen=True, eq=False)
class LiveFrame:
    """Where everything is at a moment.

    Attributes:
        time: The simulated time of the frame [s].
        joint_positions: Measured positions in description order [rad or m], shape (n,).
        objects: T_world_object (xyz, quat wxyz) of the objects in the scene, shape (7,) each.
    """

    time: float
    joint_positions: FloatArray
    objects: Mapping[str, FloatArray]


class LiveStream:
    """Sends the poses and the events of one case to a process that shows them.

    Frames that the other side does not take in time are left out; where there is no other side,
    nothing is sent.
    """

    def __init__(self, address: str) -> None:
        """Connect to a Unix socket."""
        self._connection: Connection | None = None
        self._start: Start[LiveSimulator] | None = None
        self._due = 0.0
        with suppress(OSError):
            self._connection = Client(address, "AF_UNIX")

    def close(self) -> None:
        """Send no more."""
        if self._connection is not None:
            self._connection.close()

    def start_case(self, request: RunRequest, clock: Clock) -> Start[LiveSimulator]:
        """Prepare a case as a run does, and show it from now on.

        Raises:
            SpecError: The file has mistakes.
        """
        from harness.plugins.studio.live_simulator import LiveSimulator
        from harness.session.start import start_case

        self._start = start = start_case(request, clock, LiveSimulator)
        program = start.prepared.program
        name = f"{request.file.name} [{request.case}]" if request.case else request.file.name
        objects = tuple(program.all_objects())
        robot = pickle.dumps(program.description)
        self._send(LiveCase(name, robot, objects, len(program.steps)))
        start.simulator.pace = self._show
        self._show()
        return start

    def with_events(self, notify: Notify) -> Notify:
        """A function that sends each event, and passes it on."""

        def heard(event: ProgressEvent) -> None:
            if isinstance(event, StepFinished):
                self._due = 0.0
                self._show()
            self._send(event)
            notify(event)

        return heard

    def _show(self, _samples: int = 0) -> bool:
        """Send a frame, if one is due and can be sent without waiting; the motion goes on."""
        now = time.monotonic()
        if self._start is None or self._connection is None or now < self._due:
            return True
        self._due = now + FRAME
        if select.select([], [self._connection], [], 0)[1]:
            self._send(_frame(self._start))
        return True

    def _send(self, message: LiveCase | LiveFrame | ProgressEvent) -> None:
        if self._connection is not None:
            try:
                self._connection.send(message)
            except OSError:  # whoever watched is gone
                self._connection = None


def _frame(start: Start[LiveSimulator]) -> LiveFrame:
    simulator, scene = start.simulator, start.prepared.ports.scene
    positions = simulator.joint_positions()
    objects = dict(simulator.objects_now())
    for name in scene.object_names():
        if name not in simulator.physics.objects:  # only the planner knows it
            objects[name] = scene.object_pose(name, positions).as_vector()
    return LiveFrame(simulator.time, positions, objects)
