"""The robot cell while a program runs: adapters, beliefs about the scene, attached objects."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from harness.cell.program import ProgramStep, step_seed, with_arm
from harness.core.camera import Camera
from harness.core.details import Detail, Details
from harness.core.errors import PlanningFailed, StepFailed
from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory, together
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.language.poses import Direction, Pose
from harness.language.step import Step
from harness.ports.external import ExternalControl
from harness.ports.kinematics import Kinematics
from harness.ports.motion_planning import MotionPlan, MotionPlanner, MotionRequest, PlanningOptions
from harness.ports.motions import PlannedMotion, TimedMotion
from harness.ports.scene import PlanningScene
from harness.ports.simulation import RecordingSimulator, Simulator
from harness.recording.execution_failures import TimeoutFailure
from harness.recording.run import AttachmentRecord
from harness.recording.step_results import CELL_RESULTS, Attachment, SceneChange
from harness.robot.description import ALL_ARMS, Gripper, RobotDescription

DELAYS = 10  # of a motion of another arm, tried one after the other: tenths of what runs already
SET_POINTS = 0.01  # [s], between set points, of which delays are multiples


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


class Held(NamedTuple):
    """An object that a `grasp` closed on, and the arm of a robot with several."""

    object: str
    arm: str


@dataclass
class StepNotes:
    """What a step leaves in its record."""

    trajectory: JointTrajectory | None = None
    planner: Details = field(default_factory=Details)
    explanation: Details = field(default_factory=Details)
    result: Details = field(default_factory=Details)


@dataclass
class Cell:
    """Everything that steps work with: robot, planning, physics, and the state of the scene."""

    robot: RobotDescription
    scene: PlanningScene
    kinematics: Kinematics
    planner: MotionPlanner
    simulator: Simulator
    later_objects: Mapping[str, WorldObject]
    run_steps: Callable[[Sequence[ProgramStep]], None]
    run_together: Callable[[Sequence[ProgramStep]], tuple[float, ...]]
    presence: dict[str, Presence] = field(default_factory=dict[str, Presence])
    attachments: list[AttachmentRecord] = field(default_factory=list[AttachmentRecord])
    held: list[Held] = field(default_factory=list["Held"])
    allowed: list[Sequence[tuple[str, str]]] = field(
        default_factory=list[Sequence[tuple[str, str]]]
    )
    beliefs: dict[str, list[Belief]] = field(default_factory=dict[str, list[Belief]])
    notes: StepNotes = field(default_factory=StepNotes)
    step: ProgramStep | None = None
    cameras: Mapping[str, Camera] = field(default_factory=dict[str, Camera])
    external: ExternalControl | None = None
    expected: dict[str, SE3] = field(default_factory=dict[str, SE3])
    """T_world_object of objects that plans take to be elsewhere than they are."""
    waiting: list[JointTrajectory] | None = None
    """Motions that begin together once all of them are planned; None: each begins at once."""
    faults: dict[str, int] = field(default_factory=dict[str, int])
    """The faults that were injected, in words, and the line of each in the file."""

    @property
    def current(self) -> ProgramStep:
        """The step being executed."""
        if self.step is None:
            raise RuntimeError("no step is being executed")
        return self.step

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
        links = (self.gripper.palm_link, *self.gripper.links)
        self.scene.set_unpadded([(link, name) for link in links])
        try:
            yield
        finally:
            self.scene.set_unpadded([])

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

    # -- where things are ---------------------------------------------------------------------

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
        """T_world_object as the physics has it now, or as it is expected later.

        Without physics it is where the planner carries what an arm holds.
        """
        if name in self.expected:
            return self.expected[name]
        has_physics = isinstance(self.simulator, RecordingSimulator)
        if not has_physics and name in self.scene.attached():
            return self.scene.object_pose(name, self.planning_start())
        return self.simulator.object_pose(name)

    @contextmanager
    def expecting(self, name: str, pose: SE3) -> Generator[None]:
        """Plan as if an object stood at T_world_object, where a belt will have brought it."""
        self.expected[name] = pose
        self.sync_scene()
        try:
            yield
        finally:
            del self.expected[name]
            self.sync_scene()

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

    # -- the planner's belief -----------------------------------------------------------------

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

    def attach(
        self, name: str, link: str, touch_links: Sequence[str], represents: str | None = None
    ) -> None:
        """Fix an object to a link in the planning scene and note what it stands for."""
        if name not in self.scene.object_names():
            raise StepFailed("INVALID_OBJECT_NAME", f"'{name}' is not in the planning scene now")
        if name in self.scene.attached():
            raise StepFailed("INVALID_OBJECT_NAME", f"'{name}' is attached already")
        pose = self.scene.attach_object(name, link, touch_links, self.planning_start())
        self.believe(name, pose, link)
        if represents is not None and represents in self.scene.object_names():
            self.scene.remove_object(represents)
        record = AttachmentRecord(
            object=name,
            link=link,
            start_time=self.simulator.time,
            end_time=float("inf"),
            pose_in_link=tuple(float(value) for value in pose.as_vector()),
            represents=represents or name,
        )
        self.attachments.append(record)
        self.report(Attachment(name, link, tuple(touch_links), represents))

    def weld(self, name: str, link: str) -> None:
        """Fix an attached object to a link in the physics, too."""
        self.simulator.weld(name, link)
        self._record_weld(name, (self.simulator.time, float("inf")))

    def _record_weld(self, name: str, welded: tuple[float, float]) -> None:
        """Note in an object's present attachment from when to when it is welded."""
        for index, record in enumerate(self.attachments):
            if record.object == name and record.end_time == float("inf"):
                self.attachments[index] = replace(record, welded=welded)

    def detach(self, name: str) -> None:
        """Let go of an attached object and its weld; what it stood for is in the scene again."""
        self.unweld(name)
        self.believe(name, self.scene.detach_object(name, self.planning_start()))
        for index, record in enumerate(self.attachments):
            if record.object == name and record.end_time == float("inf"):
                self.attachments[index] = replace(record, end_time=self.simulator.time)
                self._return_represented(record)
        self.held[:] = [each for each in self.held if each.object != name]

    @property
    def held_objects(self) -> tuple[str, ...]:
        """The objects that the gripper of the step's arm holds, in the order of their grasps."""
        arm = self.description.selected_arm
        return tuple(each.object for each in self.held if each.arm == arm)

    def holders(self, name: str) -> tuple[str, ...]:
        """The arms that hold an object."""
        return tuple(each.arm for each in self.held if each.object == name)

    def take_hold(self, name: str, weld: bool) -> None:
        """Attach an object that the gripper has closed on; it may be in another gripper, too.

        The planner carries it with the arm that grasped it last.

        Args:
            name: The name of the object.
            weld: Whether the physics fixes it to the hand.
        """
        before = [each for each in self.held if each.object == name]
        if before:
            self.detach(name)
        touched = [self.robot.of_arm[each.arm].gripper for each in before]
        links = [link for hand in (self.gripper, *touched) if hand for link in hand.links]
        self.attach(name, self.description.tcp_link, links)
        if weld:
            self.weld(name, self.gripper.palm_link)
        self.held += [*before, Held(name, self.description.selected_arm)]

    def let_go(self, name: str) -> None:
        """Detach an object that the gripper has released; another one that holds it keeps it."""
        arm = self.description.selected_arm
        others = [each for each in self.held if each.object == name and each.arm != arm]
        if not others:
            self.detach(name)
            return
        keeper, start = self.robot.of_arm[others[-1].arm], self.planning_start()
        hands = [self.robot.of_arm[each.arm].gripper for each in others]
        links = [link for hand in hands if hand for link in hand.links]
        if self.is_carried_by_other(name):
            self.scene.detach_object(name, start)
            self.scene.attach_object(name, keeper.tcp_link, links, start)
        else:
            self.detach(name)
            self.sync_scene()
            self.attach(name, keeper.tcp_link, links)
        self.held[:] = [*(each for each in self.held if each.object != name), *others]

    def is_carried_by_other(self, name: str) -> bool:
        """Whether the planner carries an object with another arm than the step's."""
        link = self.scene.attached().get(name)
        return len(self.holders(name)) > 1 and link != self.description.tcp_link

    def unweld(self, name: str) -> None:
        """End the weld of an attached object, if it has one; it stays attached."""
        if name not in self.scene.attached():
            raise StepFailed("INVALID_OBJECT_NAME", f"'{name}' is not attached")
        if self.presence[name].obj.in_simulation:
            self.simulator.unweld(name, self.scene.object_pose(name, self.planning_start()))
        for record in self.attachments:
            if record.object == name and record.welded and record.end_time == float("inf"):
                begin, end = record.welded
                self._record_weld(name, (begin, min(end, self.simulator.time)))

    def _return_represented(self, record: AttachmentRecord) -> None:
        presence = self.presence.get(record.represents)
        if presence is None or not presence.is_there or not presence.obj.in_planning:
            return
        if record.represents not in self.scene.object_names():
            pose = self.measured_pose(record.represents)
            self.scene.add_object(presence.obj, pose)

    # -- nested steps -------------------------------------------------------------------------

    def child(self, name: str, spec: Step, summary: str) -> ProgramStep:
        """A step that the current one is made of, with a seed of its own."""
        parent = self.current
        path = f"{parent.path}.{name}"
        options = replace(parent.options, seed=step_seed(parent.options.root_seed, path))
        return ProgramStep(
            f"{parent.id}.{name}",
            path,
            spec,
            with_arm(parent.arm, summary),
            parent.line,
            options,
            arm=parent.arm,
        )

    @contextmanager
    def inside(self, step: ProgramStep) -> Generator[None]:
        """Select the arm of a step that the current one is made of."""
        current, self.step = self.step, step
        try:
            yield
        finally:
            self.step = current

    def run_children(self, children: Sequence[ProgramStep] | None = None) -> None:
        """Run the steps that the current one is made of; its own notes go on after them."""
        current, notes = self.current, self.notes
        try:
            self.run_steps(current.children if children is None else children)
        finally:
            self.step, self.notes = current, notes

    # -- motion -------------------------------------------------------------------------------

    def motion(
        self, group: str, motion: PlannedMotion, options: PlanningOptions | None = None
    ) -> MotionRequest:
        """The request of a motion from where the arm is now; the step's options by default.

        Raises:
            StepFailed: START_STATE_INVALID, when an arm that it moves holds an object together with
                another one.
        """
        self.refuse_joint_hold(self.robot.group_joints(group))
        return MotionRequest(group, self.planning_start(), motion, options or self.current.options)

    def move(
        self, group: str, motion: PlannedMotion, options: PlanningOptions | None = None
    ) -> None:
        """Plan a motion from where the arm is now and follow it; the step's options by default.

        Raises:
            PlanningFailed: There is no such motion.
            StepFailed: The motion takes longer than the step may, or the arm cannot follow it.
        """
        self.carry_out(self.planner.plan(self.motion(group, motion, options)))

    def carry_out(
        self,
        plan: MotionPlan,
        follow: Callable[[JointTrajectory], JointTrajectory] | None = None,
    ) -> None:
        """Note a plan, check it against the step's timeout, then follow it.

        Args:
            plan: A plan that starts where the arm is.
            follow: Follows the trajectory in its own way and returns what it commanded; by default
                the simulator tracks the whole.

        Raises:
            StepFailed: START_STATE_INVALID, as of `motion`; TIMED_OUT, when it takes longer than
                the step may; or the arm cannot follow it.
        """
        self.refuse_joint_hold(plan.trajectory.joint_names)
        self.notes.trajectory = plan.trajectory
        self.notes.planner += plan.statistics
        self.notes.explanation = plan.explanation
        for part in plan.result:
            self.report(part)
        timeout = self.current.spec.timeout
        if timeout is not None and plan.trajectory.duration > timeout:
            raise StepFailed(
                "TIMED_OUT",
                f"the motion takes {plan.trajectory.duration:.2f} s, the step's timeout is"
                f" {timeout:g} s; raise the timeout or the velocity scaling",
                TimeoutFailure(plan.trajectory.duration, timeout),
            )
        if self.waiting is not None:
            self.waiting.append(plan.trajectory)
        elif follow is None:
            self.simulator.track(plan.trajectory)
        else:
            self.notes.trajectory = follow(plan.trajectory)

    def follow_together(self, motions: Sequence[JointTrajectory]) -> tuple[float, ...]:
        """Follow motions of different arms at once; returns when each begins [s].

        Each was planned around the arms before it at their ends. It begins as soon as the timed
        motion of all of them is free, in tenths of the motion before, at the latest when that has
        ended.

        Raises:
            PlanningFailed: INVALID_MOTION_PLAN, the motions are not free one after the other.
        """
        begun, whole = [(motions[0], 0.0)], motions[0]
        for motion in motions[1:]:
            whole, delay = self._earliest(begun, motion, whole.duration)
            begun.append((motion, delay))
        self.notes.trajectory = whole
        self.simulator.track(whole)
        return tuple(delay for _, delay in begun)

    def _earliest(
        self,
        begun: Sequence[tuple[JointTrajectory, float]],
        motion: JointTrajectory,
        longest: float,
    ) -> tuple[JointTrajectory, float]:
        """Motions of arms and one more, and the earliest begin at which they are free [s].

        Raises:
            PlanningFailed: INVALID_MOTION_PLAN; none is.
        """
        start, names = self.planning_start(), self.robot.group_joints(ALL_ARMS)
        rest = start[list(self.robot.group_indices(ALL_ARMS))]
        for number in range(DELAYS + 1):
            delay = round(number * longest / DELAYS / SET_POINTS) * SET_POINTS
            if number == DELAYS:
                delay = longest
            whole = together([*begun, (motion, delay)], names, rest)
            try:
                self.planner.plan(self.motion(ALL_ARMS, TimedMotion(whole)))
            except PlanningFailed:
                if number == DELAYS:
                    raise
            else:
                return whole, delay
        raise AssertionError("the last delay is accepted or raises")

    def refuse_joint_hold(self, moved: Sequence[str]) -> None:
        """Refuse to move joints of an arm that holds an object together with another one.

        Raises:
            StepFailed: START_STATE_INVALID.
        """
        for name in dict.fromkeys(each.object for each in self.held):
            arms = self.holders(name)
            joints = {joint for arm in arms for joint in self.robot.group_joints(arm)}
            if len(arms) > 1 and joints.intersection(moved):
                raise StepFailed(
                    "START_STATE_INVALID",
                    f"'{name}' is held by {' and '.join(arms)}, which cannot move while both hold"
                    f" it; put `release: {name}` with `robot: {arms[0]}` before this step",
                )
