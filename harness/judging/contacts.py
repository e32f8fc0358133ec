"""Forces between sets of bodies, debounced.

A contact between stiff bodies flickers from sample to sample. Gaps of up to `DEBOUNCE` seconds
between two contacts do not end it, and the robot touches for that much longer.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from harness.core.antipodal import least_thickness
from harness.core.types import BoolArray, FloatArray
from harness.judging.body_motion import balls_of
from harness.judging.facts import fact
from harness.judging.hands import every_hand_link, gripper_of, own_links
from harness.judging.poses import present
from harness.judging.temporal import trailing_max, without_gaps
from harness.judging.window import NotObservable, object_record, put_samples
from harness.recording.run import Run
from harness.recording.verdict import VerdictWarning
from harness.robot.end_effector import seal_words

TOUCH_FORCE = 1e-3  # a tenth of the weight of one gram; less is no support and no grip [N]
OVERLAP = 0.001  # [m]; what is less deep is rounding: convex hulls are off by as much
FORCE_WINDOW = 0.010
"""Time over which a force is averaged before it is compared with a limit [s], unless a file says
otherwise: longer than the vibrations of a stiff contact, shorter than a motion or a person's push.
"""
SUCTION = "suction"  # the one side of a gripper with suction cups
DEBOUNCE = 0.010  # longest gap inside one contact [s]: ten physics steps of 1 ms


def force_between(run: Run, firsts: Collection[str], seconds: Collection[str]) -> FloatArray:
    """Sum of the normal forces between two sets of bodies at each sample [N], shape (N,)."""
    total = np.zeros(len(run.signals.times))
    forces = run.signals.contact_forces
    for a, b in sorted(forces):
        if (a in firsts and b in seconds) or (b in firsts and a in seconds):
            total = total + forces[a, b]
    return total


def debounced(run: Run, force: FloatArray) -> FloatArray:
    """Largest force of the last `DEBOUNCE` seconds [N], shape (N,)."""
    return trailing_max(force, run.signals.times, DEBOUNCE)


def touched(run: Run, name: str, but: Collection[str] = ()) -> list[str]:
    """Bodies that ever touched another one, without some, sorted."""
    bodies = {b if a == name else a for a, b in run.signals.contact_forces if name in (a, b)}
    return sorted(bodies.difference(but))


def bodies_touching(run: Run, name: str, but: Collection[str] = ()) -> dict[str, FloatArray]:
    """Force of every body that ever touched an object [N], shape (N,) each.

    Gaps of up to `DEBOUNCE` between two contacts are closed; nothing outlasts its last contact.
    """
    times = run.signals.times
    return {
        other: without_gaps(force_between(run, {name}, {other}), times, DEBOUNCE)
        for other in touched(run, name, but)
    }


@fact
def side_forces(run: Run, name: str) -> dict[str, FloatArray]:
    """Debounced force of each finger side on an object, by side name [N], shape (N,) each.

    Of suction cups it is one side: the force of their vacuum.
    """
    sides = gripper_of(run).sides
    if gripper_of(run).cups:
        return {SUCTION: debounced(run, np.linalg.norm(pull_on(run, name), axis=1))}
    return {
        side: debounced(run, force_between(run, frozenset(sides[side]), {name}))
        for side in sorted(sides)
    }


def pull_on(run: Run, name: str) -> FloatArray:
    """Force of the vacuum of the hand's cups on an object, in world axes [N], shape (N, 3)."""
    cups = {cup.link for cup in gripper_of(run).cups}
    pulls = [
        rows[:, :3] for key, rows in run.signals.pulls.items() if key[0] in cups and key[1] == name
    ]
    return np.sum(pulls, axis=0) if pulls else np.zeros((len(run.signals.times), 3))


def side_words(side: str) -> str:
    """A finger side, or the suction of cups, in a verdict: `left finger`."""
    return side if side == SUCTION else f"{side} finger"


def why_unsealed(run: Run, name: str, sample: int) -> str:
    """Why suction cups do not hold an object at a sample; empty for fingers, and where they do."""
    cups = gripper_of(run).cups
    if not cups or pull_on(run, name)[sample].any():
        return ""
    at = {cup.name: run.signals.pulls.get((cup.link, name)) for cup in cups}
    words = {
        cup: seal_words(None if rows is None else int(rows[sample, 3])) for cup, rows in at.items()
    }
    valve = run.robot.joint_index[gripper_of(run).joint]
    position, hand = run.signals.joint_positions[sample, valve], gripper_of(run)
    if abs(position - hand.open_position) < abs(position - hand.closed_position):
        return "the suction is off"
    return "; ".join(f"{cup}: {why}" for cup, why in words.items())


def finger_gap(run: Run) -> FloatArray:
    """Gap between the pads at each sample [m], shape (N,).

    Raises:
        NotObservable: The gripper's widths are not known.
    """
    hand = gripper_of(run)
    column = run.robot.joint_index.get(hand.joint)
    if not len(hand.widths) or column is None:
        raise NotObservable("the gripper's widths are not known")
    return hand.gap_at(run.signals.joint_positions[:, column])


def attached(run: Run, name: str) -> BoolArray:
    """Samples at which an arm holds an object, or its stand-in, in the planning scene, (N,)."""
    times, links = run.signals.times, own_links(run.robot)
    mask = np.zeros(len(times), dtype=bool)
    for record in run.attachments:
        if name in (record.object, record.represents) and record.link in links:
            mask |= (times >= record.start_time) & (times < record.end_time)
    return mask


def welded(run: Run, name: str) -> BoolArray:
    """Samples at which a grasp with `mode: weld` has an object fixed to a hand, shape (N,)."""
    times, links = run.signals.times, own_links(run.robot)
    mask = np.zeros(len(times), dtype=bool)
    for record in run.attachments:
        is_own = name in (record.object, record.represents) and record.link in links
        if is_own and record.welded:
            begin, end = record.welded
            mask |= (times >= begin) & (times < end)
    return mask


def robot_contact(run: Run, name: str) -> tuple[FloatArray, FloatArray]:
    """Debounced force of all links on an object [N], and 1 where it is attached, (N,) each."""
    links = own_links(run.robot)
    force = np.zeros(len(run.signals.times))
    for link in touched(run, name):
        if link in links:
            force = force + debounced(run, force_between(run, {link}, {name}))
    return force, attached(run, name).astype(float)


def was_in_robot(run: Run, name: str, samples: slice) -> bool:
    """Whether the robot touched an object, or a weld held it, at some of a run's samples."""
    force, _ = robot_contact(run, name)
    return bool((force[samples] > TOUCH_FORCE).any() or welded(run, name)[samples].any())


def bodies(run: Run, word: str) -> frozenset[str]:
    """Links and objects that a word of `between` names: `robot`, an arm, `gripper`, `any`, a name.

    Raises:
        NotObservable: The run knows no such body, or only the planner knows it.
    """
    robot = run.robot
    links = frozenset(robot.link_names)
    objects = frozenset(record.name for record in run.objects)
    match word:
        case "robot":
            return links
        case "gripper" if robot.grippers:
            return every_hand_link(run)
        case "any":
            return links | objects | {name for pair in run.signals.contact_forces for name in pair}
        case _ if word in links or word in objects:
            if any(record.name == word and not record.in_simulation for record in run.objects):
                raise NotObservable(f"{word} is not in the physics: nothing can touch it")
            return frozenset({word})
        case _ if word in robot.of_arm:
            return frozenset(link for link, arm in robot.arm_of_link.items() if arm == word)
        case _:
            raise NotObservable(f"there is no body '{word}' in this run")


def could_touch(run: Run, pairs: Collection[tuple[str, str]]) -> BoolArray:
    """Samples at which both bodies of a pair are in the physics, for some of the pairs, (N,)."""
    here = {name: is_there(run, name) for name in sorted({name for pair in pairs for name in pair})}
    together = np.zeros(len(run.signals.times), dtype=bool)
    for first, second in pairs:
        together |= here[first] & here[second]
    return together


def pairs_of(firsts: Collection[str], seconds: Collection[str]) -> frozenset[tuple[str, str]]:
    """Pairs of two different bodies, one of each set, each pair once."""
    return frozenset(
        (min(first, second), max(first, second))
        for first in firsts
        for second in seconds
        if first != second
    )


def unseen_contacts(run: Run, pairs: Collection[tuple[str, str]]) -> tuple[VerdictWarning, ...]:
    """Warnings of contacts between bodies that the physics cannot have, or may have missed."""
    names = {name for pair in pairs for name in pair}
    return (*shapeless(run, names), *_skipped_contacts(run, pairs), *_skipped_by_links(run, pairs))


def shapeless(run: Run, names: Collection[str]) -> tuple[VerdictWarning, ...]:
    """A warning where some of the bodies are links that nothing can touch."""
    lacking = [link for link in run.robot.shapeless_links if link in names]
    if not lacking:
        return ()
    which = f"{', '.join(lacking[:5])}{', ...' if len(lacking) > 5 else ''}"
    return (VerdictWarning("no collision shapes", f"nothing can touch these links: {which}"),)


def _skipped_contacts(run: Run, pairs: Collection[tuple[str, str]]) -> tuple[VerdictWarning, ...]:
    """A warning for each object that may have passed through another between two samples.

    Contacts are looked for at each sample: an object that moves by more than the least widths of
    both bodies together is before the other at one sample and after it at the next.
    """
    found: list[VerdictWarning] = []
    for name in sorted({name for pair in pairs for name in pair}):
        poses = run.signals.object_poses.get(name)
        width = _least_known_width(run, name)
        if poses is None or not width:
            continue
        balls = balls_of(object_record(run, name))
        others = [first if second == name else second for first, second in pairs
                  if name in (first, second)]  # fmt: skip
        thinnest = min((_least_known_width(run, other) for other in others), default=0.0)
        is_far = balls.moved_at_most(poses[:-1], poses[1:]) > width + thinnest
        put = put_samples(run, name)
        is_far[put[put > 0] - 1] = False
        samples = np.flatnonzero(is_far)
        moved = balls.moved(poses[samples], poses[samples + 1])
        if len(moved) and moved.max() > width + thinnest:
            most = float(moved.max())
            time = float(run.signals.times[int(samples[moved.argmax()]) + 1])
            found.append(
                VerdictWarning(
                    "contact may be missed",
                    f"{name} moves by {1000 * most:.0f} mm between two samples at t={time:.3f} s"
                    f" and is {1000 * width:.0f} mm thick: it may have passed through something",
                )
            )
    return tuple(found)


def _skipped_by_links(run: Run, pairs: Collection[tuple[str, str]]) -> tuple[VerdictWarning, ...]:
    """A warning for each object that a link of the robot overlapped without a recorded contact.

    Distances are interpolated between two samples where bodies are fast, contacts are not.
    """
    if "clearances" in run.unrecorded or "contact_forces" in run.unrecorded:
        return ()
    links, every = run.robot.link_names, set(run.robot.link_names)
    physical = {record.name for record in run.objects if record.in_simulation}
    found: list[VerdictWarning] = []
    for (first, name), distance in sorted(run.signals.clearances.items()):
        if first != "robot" or name == "robot" or name not in physical:
            continue
        nearest = run.signals.clearance_links.get((first, name), np.full(len(distance), -1))
        among = [links.index(link) for link in every if (min(link, name), max(link, name)) in pairs]
        touching = np.append(force_between(run, every, {name}) > 0, False)
        missed = (distance < -OVERLAP) & np.isin(nearest, among)
        missed &= ~(touching[:-1] | touching[1:])
        if missed.any():
            worst = int(np.argmin(np.where(missed, distance, 0.0)))
            found.append(
                VerdictWarning(
                    "contact may be missed",
                    f"{links[int(nearest[worst])]} is {-1000 * float(distance[worst]):.1f} mm"
                    f" inside {name} between two samples at t={run.signals.times[worst]:.3f} s,"
                    " and no contact was recorded",
                )
            )
    return tuple(found)


def _least_known_width(run: Run, name: str) -> float:
    """The least width of an object [m]; 0 of a link, and of triangles."""
    shapes = [record.shapes for record in run.objects if record.name == name]
    return least_thickness(shapes[0]) if shapes else 0.0


def is_there(run: Run, name: str) -> BoolArray:
    """Samples at which a body is in the physics: a link always, an object while it is present."""
    for record in run.objects:
        if record.name == name:
            never = np.zeros(len(run.signals.times), dtype=bool)
            return present(run, name) if record.in_simulation else never
    return np.ones(len(run.signals.times), dtype=bool)


def sample_time(run: Run) -> float:
    """Between two samples of a run [s]; 0 when it has one."""
    times = run.signals.times
    return float(np.median(np.diff(times))) if len(times) > 1 else 0.0
