"""The planning group of a robot without an SRDF: the longest chain, without the hand's fingers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import combinations, takewhile

from harness.plugins.formats.robot_files.inferred_gripper import SHARED_RANGE, is_gripper
from harness.robot.mechanism import Joint
from harness.robot.srdf.srdf import Srdf, SrdfGroup
from harness.robot.tree import carriers, joints_to
from harness.robot.urdf.urdf import Urdf

DEFAULT_GROUP = "arm"  # Name of the group of a robot without an SRDF

FINGER_NAMES = re.compile(r"jaw|finger|claw|pinch", re.IGNORECASE)
"""Names by which a single movable jaw differs from an arm's last joint.

A whole tool that a wrist turns can be called a gripper too: a jaw is then carried by a hand, or
closes on the link that carries it.
"""

HAND_NAMES = re.compile(r"grip|hand|palm", re.IGNORECASE)  # Names of the body of a hand
LEAST_ARM = 2  # Fewest joints that remain when a jaw is left out
MOST_FINGER_JOINTS = 4  # Most joints of a finger, as of an Allegro hand


def default_srdf(urdf: Urdf, tip_link: str = "") -> Srdf:
    """One group from the root to a tip: the given link, else the end of the chain of most joints.

    Fingers that mimic each other, and a jaw that closes on its palm, are not part of a chain. If
    several chains are longest, the group ends where fingers that move alone branch; of several
    arms it is the first.
    """
    if tip_link in {joint.child for joint in urdf.joints}:
        tips = [tip_link]
    else:
        chains = [_with_a_body(joints_to(link.name, urdf.joints), urdf) for link in urdf.links]
        tips = _tips([_without_fingers(each, urdf) for each in chains], urdf)
        tips = tips or _tips(chains, urdf)
    if not tips:
        return Srdf()
    notes = ["no SRDF: only neighbouring links may touch"]
    if len(tips) > 1:
        others = ", ".join(tips[1:])
        notes.append(
            f"several chains are as long: the group ends at '{tips[0]}'; other choices of"
            f" tcp_link: {others}"
        )
    group = SrdfGroup(DEFAULT_GROUP, chains=((urdf.root, tips[0]),))
    return Srdf((*_sides(tips, urdf), group), notes=tuple(notes))


def _sides(tips: Sequence[str], urdf: Urdf) -> list[SrdfGroup]:
    """A group for each of several arms, from where they part; none where they are no arms.

    Its name is what the names of its joints begin with, up to a separator: `left` of `left_elbow`.
    """
    chains = [joints_to(tip, urdf.joints) for tip in tips]
    shared = sum(len({joint.name for joint in row}) == 1 for row in zip(*chains, strict=False))
    own = [chain[shared:] for chain in chains]
    if len(tips) < 2 or any(len(_driven(chain)) <= MOST_FINGER_JOINTS for chain in own):
        return []
    names = [_shared_words([joint.name for joint in _driven(chain)]) for chain in own]
    if len({*names, "", DEFAULT_GROUP}) < len(names) + 2:
        names = [f"{DEFAULT_GROUP}_{number}" for number in range(1, len(names) + 1)]
    ends = zip(names, own, tips, strict=True)
    return [SrdfGroup(name, chains=((chain[0].parent, tip),)) for name, chain, tip in ends]


def _shared_words(names: Sequence[str]) -> str:
    """What names have in common at their beginning, up to a separator: `left` of `left_elbow`."""
    rows = takewhile(lambda row: len(set(row)) == 1, zip(*names, strict=False))
    return re.sub(r"[^A-Za-z0-9]*[A-Za-z0-9]*$", "", "".join(row[0] for row in rows))


def _with_a_body(chain: Sequence[Joint], urdf: Urdf) -> Sequence[Joint]:
    """The chain up to the last joint that moves a mass or a shape; all of it where none does.

    Joints after it move empty frames, as those that only carry the number of a gripper's width.
    """
    bodies = {link.name for link in urdf.links if link.inertial or link.visuals or link.collisions}
    moved = {joint.name for body in bodies for joint in joints_to(body, urdf.joints)}
    empty = [n for n, joint in enumerate(chain) if joint.is_movable and joint.name not in moved]
    return chain[: empty[0]] if empty and bodies else chain


def _without_fingers(chain: Sequence[Joint], urdf: Urdf) -> Sequence[Joint]:
    """The chain without its last joints that move together with joints outside the chain.

    A hand closes several fingers by one joint. A joint farther up that others mimic, as in an arm
    with a parallel linkage, belongs to the arm: joints that move alone follow it.
    """
    inside = {joint.name for joint in chain}
    leaders = {j.mimic.joint for j in urdf.joints if j.mimic and j.name not in inside}
    end = len(chain)
    for number in range(len(chain) - 1, -1, -1):
        joint = chain[number]
        if not joint.is_movable:
            continue
        leader = joint.mimic.joint if joint.mimic else joint.name
        if leader in inside and leader not in leaders:
            break
        end = number
    movable = [number for number in range(end) if chain[number].is_movable]
    if len(movable) > LEAST_ARM:
        *others, last = (chain[number] for number in movable)
        is_finger = all(FINGER_NAMES.search(f"{each.name} {each.child}") for each in others)
        if not is_finger and _is_jaw(last, urdf):
            end = movable[-1]
        for number in movable[LEAST_ARM:][-MOST_FINGER_JOINTS:]:
            if _is_next_to_fingers(chain[number], inside, urdf):
                return chain[: min(number, end)]
    return chain[:end]


def _is_next_to_fingers(joint: Joint, chain: set[str], urdf: Urdf) -> bool:
    """Whether a joint hangs on a rigid body on which fingers that follow each other hang too.

    Such a joint and what it carries are parts of the hand, as the wheel that shows how the
    gripper's motor turns, or a slider with its screw.
    """
    carrier = carriers(urdf.joints, urdf.root)
    joints = {each.name: each for each in urdf.joints}
    return any(
        carrier[follower.parent] == carrier[leader.parent] == carrier[joint.parent]
        for follower in urdf.joints
        if follower.mimic and not chain & {follower.name, follower.mimic.joint}
        for leader in [joints[follower.mimic.joint]]
    )


def _is_jaw(joint: Joint, urdf: Urdf) -> bool:
    """Whether a chain's last joint is a jaw that closes on the link that carries it."""
    carrier = carriers(urdf.joints, urdf.root)
    carried = [each for each in urdf.joints if carrier[each.parent] == carrier[joint.child]]
    if any(each.is_movable for each in carried):
        return False
    names = f"{joint.name} {joint.child}"
    if FINGER_NAMES.search(names):
        return True
    if "grip" not in names.lower():
        return False
    return HAND_NAMES.search(joint.parent) is not None or is_gripper(urdf, (joint.name,))


def _tips(chains: Sequence[Sequence[Joint]], urdf: Urdf) -> list[str]:
    """Last link of the longest chain; of several, of the ends of the arms that they are."""
    most = max((len(_driven(chain)) for chain in chains), default=0)
    if most == 0:
        return []
    by_last: dict[str, Sequence[Joint]] = {}
    for each in (chain for chain in chains if len(_driven(chain)) == most):
        last = _driven(each)[-1].name
        by_last[last] = max(by_last.get(last, ()), each, key=len)
    return [chain[-1].child for chain in _arms(list(by_last.values()), urdf)]


def _arms(chains: list[Sequence[Joint]], urdf: Urdf) -> list[Sequence[Joint]]:
    """Chains of equally many joints without the fingers at their ends, the likeliest arm first.

    What branches is a hand if at least two branches are alike and have shapes, and no more joints
    than a finger or the chain before them. Else every branch is part of an arm of its own: a torso
    carries two, and a wrist a flap or a camera next to its last joint. The likeliest branch has
    shapes, the largest effort and the widest range.
    """
    if len(chains) == 1:
        return chains
    common = [row[0] for row in zip(*chains, strict=False) if len({j.name for j in row}) == 1]
    count = len(_driven(common))
    branches: dict[str, list[Sequence[Joint]]] = {}
    for chain in chains:
        branches.setdefault(_driven(chain)[count].name, []).append(chain)
    shaped = {link.name for link in urdf.links if link.collisions or link.visuals}
    rests = {name: _driven(group[0])[count:] for name, group in branches.items()}
    with_shapes = {
        name: rest
        for name, rest in rests.items()
        if not shaped.isdisjoint(joint.child for joint in branches[name][0][len(common) :])
    }
    length = len(_driven(chains[0])) - count
    if length <= min(count, MOST_FINGER_JOINTS) and any(
        all(map(_are_alike, *pair)) for pair in combinations((with_shapes or rests).values(), 2)
    ):
        return [common]

    def rank(name: str) -> tuple[bool, float, float]:
        first = rests[name][0]
        return name not in with_shapes, -first.effort, first.lower - first.upper

    return [arm for name in sorted(branches, key=rank) for arm in _arms(branches[name], urdf)]


def _are_alike(first: Joint, second: Joint) -> bool:
    """Whether two joints can be those of two fingers."""
    pairs = ((j.upper - j.lower, j.effort) for j in (first, second))
    return first.kind == second.kind and all(
        min(values) >= SHARED_RANGE * max(values) for values in zip(*pairs, strict=True)
    )


def _driven(chain: Sequence[Joint]) -> list[Joint]:
    return [joint for joint in chain if joint.is_movable and joint.mimic is None]
