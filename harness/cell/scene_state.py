"""Where a step finds things, and what the planner believes of the scene."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from harness.cell.program import ProgramStep
from harness.core.details import Detail, Details
from harness.core.errors import StepFailed
from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.language.poses import Direction, Pose
from harness.ports.kinematics import Kinematics
from harness.ports.scene import PlanningScene
from harness.ports.simulation import Simulator
from harness.recording.run import ObjectRecord
from harness.recording.step_results import CELL_RESULTS, SceneChange
from harness.robot.description import RobotDescription
from harness.robot.end_effector import Gripper


@dataclass
class Presence:
    """When an object was in the scene, and where it appeared."""

    obj: WorldObject
    pose: SE3
    intervals: list[list[float]] = field(default_factory=list[list[float]])
    added_by_step: bool = False

    @property
    def is_there(self) -> bool:
        """Whether it is in the scene now."""
        return bool(self.intervals) and self.intervals[-1][1] == float("inf")

    def record(self, time: float) -> ObjectRecord:
        """The object as verdicts and reports need it, with when it was there up to a time [s]."""
        present = tuple((start, min(end, time)) for start, end in self.intervals)
        return ObjectRecord.of(self.obj, present, self.pose)


@dataclass(frozen=True, eq=False)
class Belief:
    """Where the planning scene has an object from a sample on.

    Attributes:
        sample: Index into the recorded samples.
        link: The link that carries it; empty when it stands in the world.
        pose: T_link_object, or T_world_object; None when it is in the scene no more.
    """

    sample: int
    link: str
    pose: SE3 | None


@dataclass
class StepNotes:
    """What a step leaves in its record."""

    trajectory: JointTrajectory | None = None
    planner: Details = field(default_factory=Details)
    explanation: Details = field(default_factory=Details)
    result: Details = field(default_factory=Details)


@dataclass(kw_only=True)
class SceneState:
    """The robot and the objects around it, in the physics and in the planning scene.

    Attributes:
        step: The step that is carried out; None before the first.
        beliefs: Where objects of the planning scene alone stood, by name.
        expected: T_world_object of objects that plans take to be elsewhere than they are.
        unpadded: Pairs of bodies without padding, of each gripper that is about to grasp.
        waiting: Motions that begin together once all of them are planned; None: each begins at
            once.
    """

    robot: RobotDescription
    scene: PlanningScene
    kinematics: Kinematics
    simulator: Simulator
    later_objects: Mapping[str, WorldObject]
    step: ProgramStep | None = None
    presence: dict[str, Presence] = field(default_factory=dict[str, Presence])
    beliefs: dict[str, list[Belief]] = field(default_factory=dict[str, list[Belief]])
    notes: StepNotes = field(default_factory=StepNotes)
    expected: dict[str, SE3] = field(default_factory=dict[str, SE3])
    unpadded: list[list[tuple[str, str]]] = field(default_factory=list[list[tuple[str, str]]])
    waiting: list[JointTrajectory] | None = None

    @property
    def description(self) -> RobotDescription:
        """The robot, with the arm of the current step selected."""
        arm = "" if self.step is None else self.step.arm
        return self.robot.of_arm[arm] if arm else self.robot

    @property
    def gripper(self) -> Gripper:
        """The gripper of the step's arm; compile has made sure that there is one."""
        gripper = self.description.gripper
        if gripper is None:
            raise StepFailed("INVALID_GROUP_NAME", f"{self.description.name} has no gripper")
        return gripper

    def with_open_gripper(self, joint_positions: FloatArray) -> FloatArray:
        """Joint positions of the whole robot with the gripper open."""
        opened = joint_positions.copy()
        opened[self.description.joint_index[self.gripper.joint]] = self.gripper.open_position
        return self.description.with_mimics(opened)

    @contextmanager
    def unpadded_gripper(self, name: str) -> Generator[None]:
        """Apply no padding between the gripper and an object that it is about to grasp."""
        pairs = [(link, name) for link in (self.gripper.palm_link, *self.gripper.links)]
        self.unpadded.append(pairs)
        try:
            self.scene.set_unpadded([pair for each in self.unpadded for pair in each])
            yield
        finally:
            self.unpadded.remove(pairs)
            self.scene.set_unpadded([pair for each in self.unpadded for pair in each])

    def report(self, part: Detail) -> None:
        """Leave a part of the step's result in its record, in place of an earlier one of its type.

        Args:
            part: The part; its type is one of `results` of the step's class.

        Raises:
            TypeError: The step's class does not list the type, so that a saved run would lose it.
        """
        kind, step = type(part), self.step
        if step is not None and kind not in (*CELL_RESULTS, *step.spec.results):
            raise TypeError(
                f"`{step.spec.verb}` reports {kind.__name__}, which is not in `results`"
            )
        self.notes.result = self.notes.result.replaced(part)

    def planning_start(self) -> FloatArray:
        """Where motions start: set points of arms, measured positions of grippers."""
        start = self.simulator.commanded_positions()
        measured = self.simulator.joint_positions()
        for gripper in self.robot.grippers:
            index = self.robot.joint_index[gripper.joint]
            start[index] = measured[index]
        for motion in self.waiting or ():
            start[[self.robot.joint_index[name] for name in motion.joint_names]] = motion.positions[
                -1
            ]
        return self.robot.with_mimics(start)

    def measured_pose(self, name: str) -> SE3:
        """T_world_object as the physics has it now, or as it is expected later."""
        return self.expected.get(name) or self.simulator.object_pose(name)

    def frame(self, name: str) -> SE3:
        """T_world_frame of `world`, a link, or an object as the physics has it now."""
        if name == "world":
            return SE3.identity()
        if name in self.description.link_names:
            return self.kinematics.link_pose(self.planning_start(), name)
        presence = self.presence.get(name)
        if presence is None or not presence.is_there:
            raise StepFailed("FRAME_TRANSFORM_FAILURE", f"'{name}' is not in the scene now")
        if presence.obj.in_simulation:
            return self.measured_pose(name)
        return self.scene.object_pose(name, self.planning_start())

    def world_pose(self, pose: Pose) -> SE3:
        """T_world_x of a pose that a file gives in some frame."""
        return self.frame(pose.frame) @ pose.se3()

    def world_direction(self, direction: Direction) -> FloatArray:
        """Unit vector in the world of a direction that a file gives in some frame, shape (3,)."""
        vector = self.frame(direction.frame).rotation @ direction.xyz
        return vector / float((vector @ vector) ** 0.5)

    def sync_scene(self) -> None:
        """Copy the physics' poses of the objects that are not held to the planning scene."""
        held = self.scene.attached()
        for name in self.scene.object_names():
            presence = self.presence.get(name)
            if presence is None or name in held or presence.obj.is_static:
                continue
            if presence.obj.in_simulation:
                self.scene.move_object(name, self.measured_pose(name))

    def add_to_scene(self, obj: WorldObject, pose: SE3) -> None:
        """Let an object appear in the planning scene, the physics, or both; record since when."""
        known = self.presence.get(obj.name)
        if known is None:
            known = self.presence[obj.name] = Presence(obj, pose, added_by_step=True)
        self._report_change(added=obj.name)
        known.pose = pose
        known.intervals.append([self.simulator.time, float("inf")])
        self.believe(obj.name, pose)
        if obj.in_simulation:
            self.simulator.add_object(obj.name, pose)
        if obj.in_planning:
            self.scene.add_object(obj, pose)

    def remove_from_scene(self, name: str) -> None:
        """Take an object out of the planning scene and the physics."""
        presence = self._free_object(name)
        self._report_change(removed=name)
        presence.intervals[-1][1] = self.simulator.time
        self.believe(name, None)
        if name in self.scene.object_names():
            self.scene.remove_object(name)
        if presence.obj.in_simulation:
            self.simulator.remove_object(name)

    def move_in_scene(self, name: str, pose: SE3) -> None:
        """Put an object somewhere else, at rest, in planning scene and physics."""
        presence = self._free_object(name)
        self._report_change(moved=name)
        presence.pose = pose
        presence.intervals[-1][1] = self.simulator.time
        presence.intervals.append([self.simulator.time, float("inf")])
        self.believe(name, pose)
        if presence.obj.in_simulation:
            self.simulator.move_object(name, pose)
        if name in self.scene.object_names():
            self.scene.move_object(name, pose)

    def _report_change(self, **change: str) -> None:
        """Add an object to the changes of the scene that the step reports."""
        known = self.notes.result.find(SceneChange) or SceneChange()
        names = {kind: (*(getattr(known, kind) or ()), name) for kind, name in change.items()}
        self.report(replace(known, **names))

    def _free_object(self, name: str) -> Presence:
        """An object that is in the scene, and not attached."""
        presence = self.presence.get(name)
        if presence is None or not presence.is_there:
            raise StepFailed("INVALID_OBJECT_NAME", f"'{name}' is not in the scene now")
        if name in self.scene.attached():
            raise StepFailed("INVALID_OBJECT_NAME", f"'{name}' is attached: detach it first")
        return presence

    def believe(self, name: str, pose: SE3 | None, link: str = "") -> None:
        """Note where an object of the planning scene alone stands from now on."""
        presence = self.presence.get(name)
        if presence is None or presence.obj.in_simulation:
            return
        # what is gone was still there at the present sample, what comes is there already
        sample = self.simulator.sample_count - (0 if pose is None else 1)
        self.beliefs.setdefault(name, []).append(Belief(sample, link, pose))
