"""Valid scenario files, which shrink to small ones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from hypothesis import strategies as st

from harness.plugins.iktest.chain import Chain
from harness.plugins.iktest.strategies.poses import Target, reachable_poses
from harness.plugins.iktest.strategies.positions import joint_positions, load_chain

Document = dict[str, Any]  # the content of a scenario's YAML file; `yaml.safe_dump` writes it


def scenarios(
    robots: Sequence[str] = ("open_manipulator_x", "ur3e"), *, max_steps: int = 4
) -> st.SearchStrategy[Document]:
    """Scenarios of one arm in an empty world; every name and number in them is valid.

    Their goals are reachable. A step whose goal is in self-collision fails.

    Args:
        robots: Bundled names to choose from, the simplest first.
    """
    return st.sampled_from(list(robots)).flatmap(lambda robot: _of_robot(robot, max_steps))


def _of_robot(robot: str, max_steps: int) -> st.SearchStrategy[Document]:
    chain = load_chain(robot)
    waits = st.integers(1, 5).map(lambda tenths: {"wait": tenths / 10})
    step = st.one_of(waits, _states(chain), *_moves(chain))
    steps = st.lists(step, min_size=1, max_size=max_steps)
    return st.builds(
        lambda steps, seed: {
            "scenario": f"Drawn for {robot}",
            "robot": {"model": robot},
            "seed": seed,
            "steps": steps,
            "expect": [{"always": "within_limits"}],
        },
        steps,
        st.integers(0, 99),
    )


def _states(chain: Chain) -> st.SearchStrategy[Document]:
    description = chain.description
    known = list(description.states_of(description.arm_group))
    moves = [{"move_to": name} for name in known]
    if description.gripper is not None:
        moves += [{"gripper": name} for name in description.states_of(description.gripper.group)]
    return st.sampled_from(moves)


def _moves(chain: Chain) -> list[st.SearchStrategy[Document]]:
    def to_joints(verb: str, positions: Any) -> Document:
        joints = zip(chain.joint_names, map(float, positions), strict=True)
        return {verb: {"joints": dict(joints)}}

    def to_position(target: Target) -> Document:
        return {
            "move_to": {"position": {"xyz": [round(float(v), 6) for v in target.pose.translation]}}
        }

    positions = joint_positions(chain, margin=0.01)
    verbs = st.sampled_from(["move_to", "ptp"])
    return [st.builds(to_joints, verbs, positions), reachable_poses(chain).map(to_position)]
