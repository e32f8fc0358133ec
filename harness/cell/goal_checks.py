"""Goals of motion steps, checked against the robot and the scene at their place in the file."""

from __future__ import annotations

from harness.cell.scope import At
from harness.language.goals import GoalFields


def check_goal(goal: GoalFields, group_name: str | None, at: At) -> None:
    """Report names that a goal's group, states, joints, frames or links do not have."""
    scope = at.scope
    group = scope.check_group(group_name, at.key("group"))
    if goal.named_target is not None:
        scope.check_state(group, goal.named_target, at.key("named_target"))
    for name in goal.joints or {}:
        scope.check_joint(name, at.key("joints", name), group)
    if goal.pose is not None:
        at.check_pose(goal.pose, "pose")
    if goal.position is not None:
        scope.check_frame(goal.position.frame, at.key("position", "frame"))
    scope.check_link_or_held(goal.link, at.key("link"))
    if goal.position is not None and goal.link in scope.attached:
        scope.problems.add(
            at.key("link"),
            f"`position` is a goal for a link, and '{goal.link}' is an attached object",
            "give its `pose`, with a wide `tolerance` where the orientation is open",
        )
    description = scope.description
    has_no_tip = group in description.groups and not description.groups[group].tip_link
    if (goal.pose or goal.position) and has_no_tip:
        scope.problems.add(
            at.loc, f"the group '{group}' is no chain, so it has no link to send to a pose"
        )
