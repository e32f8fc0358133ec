"""What exists while a file is read from top to bottom, and the problems found on the way."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from contextlib import contextmanager

from harness.core.camera import Camera
from harness.core.errors import Problem, SpecError
from harness.core.limits import LONGEST_RUN
from harness.core.spatial import SE3
from harness.core.state_words import stated_name
from harness.core.suggestion import did_you_mean
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.language.files.mistakes import MistakeError
from harness.language.files.source import Loc, SourceMap
from harness.language.poses import Pose
from harness.language.reading.partial import Prerequisite
from harness.language.units import in_si
from harness.robot.description import RobotDescription
from harness.robot.tree import is_rigid

EVERYTHING: tuple[Prerequisite, ...] = ("robot", "world")


class Problems:
    """Collects located problems, so that all of a file's are reported at once.

    Every problem says what it needs to be known: where the robot cannot be loaded, a joint's name
    cannot be judged, but a planner's name can.
    """

    def __init__(
        self,
        lines: SourceMap,
        missing: frozenset[Prerequisite] = frozenset(),
        doubtful: frozenset[str] = frozenset(),
    ) -> None:
        """Collect nothing yet.

        Args:
            doubtful: Names in what could not be read; problems with them may follow from that.
        """
        self._lines = lines
        self._missing = missing
        self._found: dict[Loc, Problem] = {}
        self._unusable = set(doubtful)

    def add(
        self,
        loc: Loc,
        message: str,
        hint: str = "",
        *,
        needs: tuple[Prerequisite, ...] = EVERYTHING,
    ) -> None:
        """Note a problem at a place of the file; others at the same place follow from the first."""
        if not self._missing.intersection(needs) and not self._is_unusable(loc):
            self._found.setdefault(loc, self._lines.problem(loc, message, hint))

    def _is_unusable(self, loc: Loc) -> bool:
        """Whether the file has a name at a place whose own problem is reported."""
        value = self._lines.find(loc).item.value
        return isinstance(value, str) and value in self._unusable

    def add_unusable(self, name: str) -> None:
        """Note that an object's own problem is reported: uses of its name follow from that."""
        self._unusable.add(name)

    def unknown(
        self,
        loc: Loc,
        what: str,
        name: str,
        known: Iterable[str],
        *,
        is_key: bool = False,
        start: int | None = None,
        needs: tuple[Prerequisite, ...] = EVERYTHING,
    ) -> None:
        """Note a name that nothing has, with the nearest that something has, then the rest.

        Args:
            start: The name is a part of the text there and begins at this character, from 0.
            needs: What must be loaded to know the names.
        """
        if self._missing.intersection(needs) or name in self._unusable:
            return
        message, names = f"there is no {what} '{name}'", tuple(known)
        hint = did_you_mean(name, names, "known") if names else "there is none of another name"
        if start is not None:
            problem = self._lines.problem_in_text(loc, start, len(name), message, hint)
            self._found.setdefault((*loc, start), problem)
            return
        locate = self._lines.problem_at_key if is_key else self._lines.problem
        self._found.setdefault(loc, locate(loc, message, hint))

    def add_in_text(self, loc: Loc, start: int, message: str, hint: str = "") -> None:
        """Note a problem at a character of a text, from 0, that follows from robot and world."""
        if not self._missing:
            self._found.setdefault(
                (*loc, start), self._lines.problem_in_text(loc, start, 1, message, hint)
            )

    def check_unit(
        self, loc: Loc, unit: str, *, needs: tuple[Prerequisite, ...] = EVERYTHING
    ) -> None:
        """Note a value whose written unit has another dimension than an SI unit."""
        value = self._lines.find(loc).item.value
        if not isinstance(value, str):
            return
        try:
            in_si(value, (unit,))
        except MistakeError as mistake:
            self.add(loc, mistake.message, mistake.hint, needs=needs)

    def raise_if_any(self) -> None:
        """Raise SpecError with everything found, if anything was."""
        if self._found:
            raise SpecError(self._found.values())


class Scope:
    """Names that a step or an expectation may use.

    Attributes:
        objects: Every object known so far, by name, whether it is in the scene now or not.
        present: Objects in the scene at this point of the file, as far as the file says.
        added: Objects that steps added and nothing removed.
        requested_time: Simulated time that steps have requested as a number [s].
        requested_pictures: The number of camera pictures that steps have requested; a picture
            beyond HD counts by its pixels.
        link_pose: T_world_link at joint positions in description order.
        gravity: The gravitational acceleration of the world [m/s^2].
    """

    def __init__(
        self,
        description: RobotDescription,
        problems: Problems,
        link_pose: Callable[[FloatArray, str], SE3] | None = None,
    ) -> None:
        self.description = description
        self.problems = problems
        self.link_pose = link_pose
        self.objects: dict[str, WorldObject] = {}
        self.present: dict[str, None] = {}
        self.attached: dict[str, None] = {}
        self.added: dict[str, None] = {}
        self.cameras: dict[str, Camera] = {}
        self.gravity = 9.8
        self.requested_time = 0.0
        self.requested_pictures = 0.0
        self.step_ids: dict[str, str] = {}  # with the arm of each
        self._arm_key: str = "robot"
        self._lacks_gripper = False

    @contextmanager
    def with_arm(self, arm: str, key: str = "robot") -> Generator[None]:
        """Select an arm of a robot with several, or none with an empty name.

        Args:
            key: The key that names an arm in what is checked.
        """
        whole, before = self.description, self._arm_key
        self.description, self._arm_key = (whole.of_arm[arm] if arm else whole), key
        try:
            yield
        finally:
            self.description, self._arm_key = whole, before

    def add_object(self, obj: WorldObject, *, present: bool = False) -> None:
        """Make an object known; `present` when it is in the scene from the start."""
        self.objects[obj.name] = obj
        if present:
            self.present[obj.name] = None

    def claim_step_id(self, step_id: str, arm: str = "") -> bool:
        """Claim an id for a step of an arm; returns whether it was free."""
        if step_id in self.step_ids:
            return False
        self.step_ids[step_id] = arm
        return True

    # -- names --------------------------------------------------------------------------------

    def check_frame(self, name: str, loc: Loc, *, of: str = "") -> None:
        """Report an unknown frame, and one in which the body `of` can never move."""
        links = self.description.link_names
        frames = ("world", *links)
        if name not in frames and name not in self.objects:
            self.problems.unknown(loc, "frame", name, (*frames, *self.objects))
        are_links = name in links and of in links and name != "world"
        if name == of or (are_links and is_rigid(self.description, name, of)):
            self.problems.add(
                loc,
                f"'{of}' never moves in the frame '{name}': its pose there says nothing",
                "name the frame of another body, or `world`",
            )

    def check_link(self, name: str | None, loc: Loc) -> None:
        """Report a name that is no link of the robot."""
        if name is not None and name not in self.description.link_names:
            self.problems.unknown(loc, "link", name, self.description.link_names, needs=("robot",))

    def check_link_or_held(self, name: str | None, loc: Loc) -> None:
        """Report a name of no link and no object attached here (Task Constructor's ik_frame)."""
        if name is not None and name not in self.attached:
            self.check_link(name, loc)

    def take_time(self, seconds: float, loc: Loc) -> None:
        """Add simulated time that a step requests; the sum must fit into a run."""
        before, self.requested_time = self.requested_time, self.requested_time + seconds
        if before <= LONGEST_RUN < self.requested_time:
            self.problems.add(
                loc,
                f"the steps up to here request {self.requested_time:g} s, and a run may take"
                f" {LONGEST_RUN:g} s of simulated time",
                "shorten it, or make it several scenarios",
                needs=(),
            )

    def check_group(self, name: str | None, loc: Loc) -> str:
        """Check the planning group at a key of a step; returns its name, or the default group's."""
        if name is None:
            self.check_arm(loc[:-1])
            return self.description.default_group
        if name not in self.description.groups:
            self.problems.unknown(
                loc, "planning group", name, self.description.groups, needs=("robot",)
            )
        return name

    def arm_of(self, robot: str | None, group: str | None, loc: Loc, key: str = "robot") -> str:
        """The arm that a step or an expectation is about: as stated, of its group, or the default.

        Reports a name of no arm, and a group of other joints than the arm's.
        """
        description = self.description
        arms, of_group = description.of_arm, description.arm_of_group(group or "")
        if robot is None:
            return of_group if of_group or group else description.default_arm
        if not arms:
            self.problems.add(
                (*loc, key),
                f"the robot has one arm, and '{robot}' selects one of several",
                f"leave out `{key}`; `robots: {{{robot}: ...}}` in place of `robot` names arms",
                needs=("robot", "arms"),
            )
        elif robot not in arms:
            self.problems.unknown((*loc, key), "arm", robot, arms, needs=("robot",))
        elif group is not None and of_group != robot and group in description.groups:
            self.problems.add(
                (*loc, "group"), f"'{group}' is not a group of the arm '{robot}'", needs=("robot",)
            )
        return robot if robot in arms else next(iter(arms), "")

    def check_arm(self, loc: Loc, key: str = "") -> bool:
        """Whether it is known which arm is intended; reports where the robot has several."""
        if not self.description.needs_arm:
            return True
        names = [arm.name for arm in self.description.arms]
        self.problems.add(
            loc,
            f"the robot has several arms: {', '.join(names)}; this does not say which",
            f"add `{key or self._arm_key}: {names[0]}` or another one's name",
            needs=("robot",),
        )
        return False

    def check_object(
        self, name: str, loc: Loc, *, simulated: bool = False, is_key: bool = False
    ) -> None:
        """Report an unknown object; with `simulated`, also one that the physics does not know."""
        obj = self.objects.get(name)
        if obj is None:
            self.problems.unknown(
                loc, "object", name, self.objects, is_key=is_key, needs=("world",)
            )
        elif simulated and not obj.in_simulation:
            self.problems.add(
                loc,
                f"'{name}' is known to the planner alone, so the physics has no record of it",
                "name an object that is `in: both` or `in: simulation`",
            )

    def check_present(self, name: str, loc: Loc) -> None:
        """Report an object that is not in the scene at this point of the file."""
        if name not in self.objects:
            self.check_object(name, loc)
        elif name not in self.present:
            self.problems.add(
                loc, f"'{name}' is not in the scene at this step", "add it first", needs=("world",)
            )

    def check_no_fixture(self, name: str, loc: Loc) -> None:
        """Report an object with joints, or a part of one, that a step would take away."""
        fixtures = {obj.joint.fixture for obj in self.objects.values() if obj.joint is not None}
        joint = self.objects[name].joint if name in self.objects else None
        if name in fixtures:
            message, hint = f"'{name}' is a fixture: its parts hang on it", "it stays where it is"
        elif joint is not None:
            message = f"'{name}' hangs on '{joint.fixture}'"
            hint = "`open` brings it to a position of its joint"
        else:
            return
        self.problems.add(loc, message, hint, needs=("world",))

    def check_body(self, name: str, loc: Loc, *, special: tuple[str, ...]) -> None:
        """Report a name of no link, object or arm of several, and none of some special words."""
        description = self.description
        arms = description.of_arm if special else ()
        known = (*special, *arms, *self.objects, *description.link_names)
        if name not in known:
            self.problems.unknown(loc, "object or link", name, known)

    def check_state(self, group: str, state: str, loc: Loc) -> None:
        """A named state of a group."""
        states = self.description.states_of(group)
        if not states and group in self.description.groups:
            message = f"there is no named state '{state}': the group '{group}' has no named states"
            hint = "write joint positions, or add a <group_state> to the SRDF"
            self.problems.add(loc, message, hint, needs=("robot",))
        elif stated_name(state, states) not in states and group in self.description.groups:
            self.problems.unknown(
                loc, f"named state of {group} called", state, states, needs=("robot",)
            )

    def check_joint(
        self, name: str, loc: Loc, group: str | None = None, *, is_key: bool = True
    ) -> None:
        """Report a name that is no movable joint, of a group if one is given."""
        names = self.description.joint_names
        where = "joint"
        if group is not None and group in self.description.groups:
            names = self.description.groups[group].joint_names
            where = f"joint of '{group}'"
        if name not in names:
            self.problems.unknown(loc, where, name, names, is_key=is_key, needs=("robot",))
        elif is_key:
            self.check_joint_unit(name, loc)

    def check_joint_unit(self, name: str, loc: Loc) -> None:
        """Report a value that is no angle for a joint that turns, or no length for another one."""
        unit = self.description.joint_by_name[name].position_unit
        self.problems.check_unit(loc, unit, needs=("robot",))

    def check_gripper(self, loc: Loc, what: str) -> bool:
        """Whether the arm has a gripper, which `what` needs; reports the first use without."""
        if len(self.description.grippers) > 1 and not self.check_arm(loc):
            return False
        if self.description.gripper is None:
            if self._lacks_gripper:
                return False
            self._lacks_gripper = True
            reasons = self.description.rejected_grippers
            self.problems.add(
                loc,
                f"{what} needs a gripper, and {self.description.name} has none",
                "; ".join([*reasons, "`gripper: rh_p12_rn_a` under `robot` mounts one"]),
                needs=("robot",),
            )
            return False
        return True


class At:
    """The scope at a step, and the step's place in the file."""

    def __init__(self, scope: Scope, loc: Loc) -> None:
        self.scope = scope
        self.loc = loc

    def key(self, *keys: str | int) -> Loc:
        """Place of something inside the step."""
        return (*self.loc, *keys)

    def check_pose(self, pose: Pose, *keys: str | int) -> None:
        """Report an unknown frame of the pose under these keys of the step."""
        self.scope.check_frame(pose.frame, self.key(*keys, "frame"))
