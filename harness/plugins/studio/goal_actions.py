"""Goals and plans: the ways to a pose, motions that are shown before they are made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.errors import StepFailed
from harness.core.printable import printable
from harness.core.spatial import SE3
from harness.core.trajectory import path_length
from harness.core.types import FloatArray
from harness.language.step import STEPS
from harness.plugins.studio.files import StudioFiles
from harness.plugins.studio.live_cell import LiveCell
from harness.plugins.studio.live_studio import LiveStudio
from harness.plugins.studio.messages import failure_message
from harness.plugins.studio.reach import Reach, ReachStudy, way_names
from harness.plugins.studio.scene_view import GOAL, REFUSED, Ghost
from harness.plugins.studio.session import Message, RefusedError
from harness.plugins.studio.texts import MOTIONS, joint_keys, of_arm, pose_keys, step_text
from harness.ports.motion_planning import MotionPlan
from harness.recording.plan_statistics import PlanStatistics
from harness.recording.step_record import StepRecord

MOST_POINTS = 120  # points of a drawn path


@dataclass(frozen=True, eq=False)
class Preview:
    """A motion as it would be executed, or why there is none.

    Attributes:
        positions: Joint positions along it, description order, shape (N, n); None without one.
        tcp_path: Positions of the TCP along it, shape (N, 3).
        duration: The time it takes [s].
        length: The length of the path of the TCP [m].
        record: The failed step; None where there is a motion.
    """

    positions: FloatArray | None
    tcp_path: FloatArray | None
    duration: float = 0.0
    length: float = 0.0
    planner: str = ""
    record: StepRecord | None = None


def preview(cell: LiveCell, text: str) -> Preview:
    """Plan the motion of a step with the options and the seed that its execution has.

    Raises:
        SpecError: The step has a mistake.
    """
    plans: list[MotionPlan] = []

    def keep(plan: MotionPlan) -> None:
        plans.append(plan)
        raise StepFailed("PREEMPTED", "it is only planned")

    record = cell.planned_only(text, keep)
    if not plans:
        return Preview(None, None, record=record)
    plan = plans[0]
    description, trajectory = cell.description, plan.trajectory
    count = len(trajectory.positions)
    drawn = np.unique(np.linspace(0, count - 1, MOST_POINTS).astype(int))
    rows = np.repeat(cell.cell.planning_start()[None], len(drawn), axis=0)
    index = [description.joint_index[name] for name in trajectory.joint_names]
    rows[:, index] = trajectory.positions[drawn]
    positions = np.array([description.with_mimics(row) for row in rows])
    path = cell.prepared.ports.kinematics.link_poses(positions, [description.tcp_link])[:, 0, :3]
    length = path_length(path)
    statistics = plan.statistics.find(PlanStatistics)
    planner = "" if statistics is None else statistics.planner_id
    return Preview(positions, path, trajectory.duration, length, planner)


class GoalActions(LiveStudio):
    """What a goal and the button `Plan` do."""

    def __init__(self, files: StudioFiles, text: str, notice: str = "") -> None:
        super().__init__(files, text, notice)
        self._goal = SE3.identity()

    def do_follow(self, message: Message) -> Message:
        """Let the arm follow the handle, or not."""
        self.follows = bool(message["on"])
        return {}

    def answer_pose(self, pose: SE3, *, explain: bool = True, frame: str = "world") -> Reach:
        """Find the ways to a TCP pose, and show them as ghosts.

        Args:
            explain: Whether to look for the nearest pose that can be reached.
            frame: The frame in which the page shows the pose.
        """
        if self.study is None:
            self.study = ReachStudy(self.cell, self.cell.description.default_group)
        near = self.chosen
        if near is None and self.reach is not None and self.reach.best is not None:
            near = self.reach.best.positions
        reach = self.study.answer(pose, near, explain=explain)
        self.reach, self.chosen, self._goal = reach, None, pose
        best = reach.best
        if self.follows and best is not None:
            self.target = best.positions
        ghosts = [
            Ghost(way.positions, REFUSED if way.refusal else GOAL, way is best, number)
            for number, way in enumerate(reach.ways)
        ]
        if reach.nearest is not None:
            ghosts.append(Ghost(reach.nearest, REFUSED))
        self.view.show_plan(None)
        self.view.show_ghosts(ghosts)
        self.put_handle(pose)
        shown = self.cell.cell.frame(frame).inverse() @ pose
        self.session.broadcast(
            {
                "type": "reach",
                "pose": [round(float(value), 9) for value in shown.as_vector()],
                "frame": frame,
                "refusal": printable(reach.refusal),
                "ways": [
                    {"name": name, "refusal": printable(way.refusal)}
                    for name, way in zip(way_names(self.cell, reach.ways), reach.ways, strict=True)
                ],
                "best": -1 if best is None else reach.ways.index(best),
            }
        )
        return reach

    def do_goal(self, message: Message) -> Message:
        """Put the handle on the TCP, or on a pose that is given by numbers in a frame."""
        frame = str(message.get("frame", "world"))
        pose = self.cell.tcp_pose() if message.get("here") else self._typed(message, frame)
        reach = self.answer_pose(pose, frame=frame)
        return {"refusal": printable(reach.refusal), "ways": len(reach.ways)}

    def _typed(self, message: Message, frame: str) -> SE3:
        xyz = np.array([float(value) for value in message["xyz"]])
        turn = np.array([float(value) for value in message["rpy"]])
        if message.get("unit") == "deg":
            turn = np.radians(turn)
        if not (np.isfinite(xyz).all() and np.isfinite(turn).all()) or len(xyz) + len(turn) != 6:
            raise RefusedError("a goal has three coordinates and three angles")
        return self.cell.cell.frame(frame) @ SE3.from_xyz_rpy(xyz, turn)

    def do_choose(self, message: Message) -> Message:
        """Choose one of the ways to the pose."""
        if self.reach is None:
            raise RefusedError("drag the handle first")
        return {"refusal": printable(self._choose(int(message["way"])))}

    def _choose(self, number: int) -> str:
        """Take a way as the goal; returns what forbids it."""
        if self.reach is None or not 0 <= number < len(self.reach.ways):
            return ""
        way = self.reach.ways[number]
        self.chosen = way.positions
        self.view.show_ghosts([Ghost(way.positions, REFUSED if way.refusal else GOAL, way=number)])
        self.session.broadcast({"type": "chosen", "way": number})
        return way.refusal

    def do_discard(self, _: Message) -> Message:
        """Take the planned motion away; the goal stays."""
        self.view.show_plan(None)
        return {}

    # -- plans --------------------------------------------------------------------------------

    def do_plan(self, message: Message) -> Message:
        """Plan a motion without moving; its path and its end are shown as a ghost."""
        text = self.motion_text(message)
        found = preview(self.cell, text)
        if found.record is not None:
            return {"step": text, **failure_message(found.record)}
        self.view.show_plan(found.positions, found.tcp_path, found.duration)
        return {
            "step": text,
            "duration": round(found.duration, 3),
            "length": round(found.length, 4),
            "planner": found.planner,
        }

    def motion_text(self, message: Message) -> str:
        """The step that a page's goal is."""
        verb = str(message.get("verb") or MOTIONS[0])
        if verb not in MOTIONS:
            raise RefusedError(f"a motion is one of {', '.join(MOTIONS)}")
        description = self.cell.description
        group = description.default_group
        keys: Any
        if message.get("state"):
            keys = {"named_target": str(message["state"])}
        elif message.get("here"):
            keys = joint_keys(description, group, self.cell.cell.planning_start())
        elif message.get("joints"):
            keys = {"joints": self._joint_list(message)}
        elif self.chosen is not None:
            keys = joint_keys(description, group, self.chosen)
        elif self.reach is not None:
            frame = str(message.get("frame", "world"))
            pose = self.cell.cell.frame(frame).inverse() @ self._goal
            keys = pose_keys(description, group, pose, frame)
        elif self.cell.is_by_hand:  # the sliders have moved the arm to its goal
            keys = joint_keys(description, group, self.cell.cell.planning_start())
        else:
            raise RefusedError(
                "there is no goal: move a joint, drag the handle, or choose a named state"
            )
        if STEPS[verb].is_arc:
            keys["interim"] = _interim(message)
        if message.get("planner"):
            given = str(message["planner"])
            planning = given if ":" in given else f"planner_id: {given}"
            text = f"{step_text(verb, keys)}\nplanning: {{{' '.join(planning.split())}}}"
            return of_arm(description, text)
        if set(keys) == {"named_target"}:
            keys = keys["named_target"]
        return of_arm(description, step_text(verb, keys))

    def _joint_list(self, message: Message) -> dict[str, Any]:
        """The joints of the arm with the positions that a page lists, in degrees or radians."""
        description = self.cell.description
        names = description.groups[description.default_group].joint_names
        values = [float(value) for value in message["joints"]]
        if len(values) != len(names) or not np.isfinite(values).all():
            raise RefusedError(f"list {len(names)} positions: {', '.join(names)}")
        turns = [description.joint_by_name[name].kind != "prismatic" for name in names]
        factor = np.where(turns, np.pi / 180 if message.get("unit") == "deg" else 1.0, 1.0)
        positions = self.cell.cell.planning_start()
        positions[[description.joint_index[name] for name in names]] = factor * values
        return joint_keys(description, description.default_group, positions)["joints"]


def _interim(message: Message) -> dict[str, Any]:
    """The point that an arc passes through, in the frame of the goal."""
    point = [float("nan" if value is None else value) for value in message["interim"]]
    if len(point) != 3 or not np.isfinite(point).all():
        raise RefusedError("an arc passes through a point: write its x, y and z")
    frame = str(message.get("frame", "world"))
    place: dict[str, Any] = {} if frame == "world" else {"frame": frame}
    return {**place, "xyz": [round(value, 5) for value in point]}
