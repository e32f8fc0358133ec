"""What arms hold: attached in the planning scene, gripped or welded in the physics."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from harness.cell.scene_state import SceneState
from harness.core.errors import StepFailed
from harness.recording.run import AttachmentRecord
from harness.recording.step_results import Attachment


class Held(NamedTuple):
    """An object that a `grasp` closed on, and the arm of a robot with several."""

    object: str
    arm: str


@dataclass(kw_only=True)
class Holding(SceneState):
    """The scene, and what is attached to links of the robot.

    Attributes:
        held: Objects that grippers have closed on, in the order of their grasps.
    """

    attachments: list[AttachmentRecord] = field(default_factory=list[AttachmentRecord])
    held: list[Held] = field(default_factory=list["Held"])

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

        Raises:
            StepFailed: INVALID_OBJECT_NAME, where this gripper holds it already.
        """
        if self.description.selected_arm in self.holders(name):
            raise StepFailed("INVALID_OBJECT_NAME", f"'{name}' is attached already")
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
