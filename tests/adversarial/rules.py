"""The rules of the scenes: what each says, with which limits, and where it must not fire."""

from __future__ import annotations

from dataclasses import dataclass

GRADING = "../guides/grading.md"
EXPECTATIONS = "expectations.md"


@dataclass(frozen=True)
class Rule:
    """A rule, and the scenes that show it.

    Attributes:
        title: What it is about.
        text: Definition, quantities and limits, with their reasons; links to what says more.
        fires: Scenes of the page that it refutes, warns of or withholds points for.
        silent: Scenes in which it must not fire.
    """

    title: str
    text: str
    fires: tuple[str, ...]
    silent: tuple[str, ...]


RULES = (
    Rule(
        "Excused contact has a bound",
        "A contact that gripping, carrying or putting down excuses is a [collision]"
        f"({EXPECTATIONS}#collision) where its mean force over 50 ms exceeds twice the weight and"
        " the grip, plus 1 N, or where the object is dragged by 2 cm along one contact: by the way"
        " of the points at which the two touch. What leaves its support may press it with the grip,"
        " too, for at most 0.1 s in all. 50 ms are"
        " longer than any blow; an object is accelerated with at most gravity's; 1 N is a position"
        " error of a tenth of a millimetre; points of contact wander less than 2 cm while an object"
        " tilts and leaves; the fingers press it onto its support until it is free, which takes two"
        " averages at most.",
        (
            "held box pressed onto a hidden plate",
            "gripped box rammed into what it stands on",
            "gripped box pressed onto its stand with less than the grip",
            "held box dragged along a rug",
            "box dragged bit by bit",
            "plate turned where it lies",
            "can dragged around the arm, with its frame on the arm's axis",
            "welded box that no finger touches hits a beam",
        ),
        (
            "box put down as usual",
            "box gripped twice where it stands",
            "box lifted off the bench that the fingers press it onto",
            "rod raised at one end",
        ),
    ),
    Rule(
        "Held is not struck",
        f"[`lifted`]({EXPECTATIONS}#lifted) and [`grasped`]({EXPECTATIONS}#grasped) require 0.1 s"
        " of hold, the hand's share of the weight (half, friction included), at most 5 mm and"
        " 0.1 rad of motion in the hand, and that its motion raised the object. A blow lasts a few"
        " milliseconds, and what flies past at 0.5 m/s is 5 cm further after 0.1 s; with less than"
        " half of its weight carried an object falls.",
        (
            "ball shot up through the half-open hand",
            "ball thrown up that lands on the fingers",
            "ball cradled on two half-open fingers",
            "ball on a jammed gripper",
            "ball on fingers that grip a rod",
            "plank across both fingers",
            "box raised between the fingers by a block below it",
            "cube nudged up without gravity",
        ),
        (
            "box lifted with a jerk",
            "ball gripped above its middle",
            "ball gripped below its middle",
        ),
    ),
    Rule(
        "A support stands on the ground",
        f"[`placed`]({EXPECTATIONS}#placed), with `on` or without, and [`on`]({EXPECTATIONS}#on)"
        " require half of the weight from below, within 1 % (the forces of equal supports differ)."
        " For `placed` a support is itself carried by something fixed, directly or through others:"
        " each of them takes half of its own weight and of what presses it down. What the robot"
        " holds, what lies on its moving links, and what is stacked on these carries nothing. A"
        " support ends with its last contact.",
        (
            "part on a tray in the hand",
            "part on a cup on a tray in the hand",
            "cube on a plank that lies across both fingers",
            "cube put down with a tenth of it on the goal",
            "table that a step takes away",
        ),
        ("cube put on a block that stands on the floor", "plank on two posts"),
    ),
    Rule(
        "What rides on a held object is carried",
        "Riders are a group of objects that touches nothing but itself, what carries it and the"
        f" hand, each pushed up by something of it. [`lifted`]({EXPECTATIONS}#lifted) leaves them"
        f" out, [`collision`]({EXPECTATIONS}#collision) judges what they hit like what the hand"
        f" holds, and their distances are recorded for [`clearance`]({EXPECTATIONS}#clearance) and"
        " formulas, as those of what the fingers hold without a step that attaches it.",
        (
            "tray lifted with two loads that lean on each other",
            "load on a held tray is pushed against a beam",
            "stack on a held tray is raised against a beam",
            "gripped rod comes within 5 mm of a wall",
        ),
        (
            "tray raised with a plank that lies on a shelf, too",
            "tray with a stack set down again",
        ),
    ),
    Rule(
        "The shapes of a body count, not its origin",
        f"[`in`]({EXPECTATIONS}#in): half of the object's volume is inside, by the middles of its"
        f" shapes. [`static`]({EXPECTATIONS}#static) and `placed`: the speed is that of the fastest"
        " point. [`grasped`]"
        f"({EXPECTATIONS}#grasped): the object slips as its point between the fingers does, and"
        " what is fixed in the world is not held. `displaced`: the way of the centre of mass."
        f" [`lifted`]({EXPECTATIONS}#lifted): the height of the lowest point. Where a"
        " designer put the origin says nothing; the signals x(), y(), z() and speed() of a formula"
        " are those of the origin, and say so. What a step puts somewhere has no speed and no"
        " distance on the way.",
        (
            "hoop on the floor around a bin",
            "cover over a block",
            "part whose origin is in a bin and nothing else of it",
            "plank of 4 m that turns slowly",
            "post fixed in the world between the fingers",
            "part that sags in the grip, with its frame far away",
            "can raised by its frame",
        ),
        (
            "part whose origin is above the bin that it lies in",
            "plank of 4 m that lies still",
            "can raised whose frame sinks",
        ),
    ),
    Rule(
        "Shapes decide, pictures do not",
        f"[`in`]({EXPECTATIONS}#in), [`placed`]({EXPECTATIONS}#placed), distances and widths are"
        " those of collision shapes. Where `visuals` reach further, or less far, by 5 mm and a"
        " tenth of the object's extent, a finding says so: a smaller difference shows the shape.",
        ("ball next to a tray that is shown larger", "post that is shown thinner than it is"),
        ("ball shown as a balloon",),
    ),
    Rule(
        "Pairs that the physics leaves out are measured",
        "Links whose contact the SRDF excludes and that are apart with every joint at zero are a"
        " finding where they overlap by more than 1 mm, and with `count_allowed` a"
        f" [collision]({EXPECTATIONS}#collision): convex hulls are not exact to less. Where they"
        " are nearer than with every joint at zero they count as distances of the robot to itself.",
        (
            "arm folded into its base",
            "hand folded through the upper arm",
            "lower arm through the base",
            "arm folded to within 5 mm of its base",
        ),
        ("links that overlap at their joints",),
    ),
    Rule(
        "What observed nothing does not pass",
        "Each verdict counts the samples, pairs and premises that it observed. With none it is `not"
        " observable` or `not reached`; with few, or where a change was already there, it carries a"
        f" [warning]({EXPECTATIONS}#expectations) that `--strict` turns into a failure. An object"
        " stands where it stood, or where a step put it, up to 5 mm: further than the physics"
        " settles it.",
        (
            "object that only the planner knows",
            "object that comes after the step it is judged over",
            "premise that never holds",
            "until that comes at its first sample",
            "lift before the step that it is expected of",
            "object that stands where it stood",
            "fixture that rises with the box on it",
            "step that takes no time",
            "box that a step puts on the tray",
            "box that a step puts into the bin",
            "bin that a step puts around a box",
            "box that a step removes before the end",
            "pillar that a step removes before the arm moves",
        ),
        (
            "object that a push put there",
            "box that a step lets fall into the bin",
            "box that a step removes after it was judged",
        ),
    ),
    Rule(
        "A variation varies something",
        "`parametrize`, `randomize` and `--set` take names that something reads, and at least one"
        " value: anything else is an error of the file, with exit code 2. Samples with equal"
        " digests are one and the same run, of which two or more show no rate. A suite says how"
        " many files it found, collected and ran.",
        (
            "grid over a parameter that nothing reads",
            "random parameter that nothing reads",
            "grid without values",
        ),
        ("grid over a parameter that a step reads",),
    ),
    Rule(
        "Nothing is known in a gap",
        "Between two messages further apart than ten periods of their topic (0.1 s at least, 1.5 s"
        " at most) nothing is interpolated, and a verdict that the gap could change is `not"
        " observable`: a burst of lost messages is shorter, and a topic at 1 Hz has no gaps. Points"
        " for what several publishers, /tf, frames, clocks, jumps, single poses or chosen steps"
        " make [doubtful](../guides/grading.md#points) are withheld.",
        (
            "hole of 0.6 s in the joint states",
            "hole of 2 s in the poses of the box",
            "clock that jumps an hour ahead",
            "joint states that fall silent",
            "two publishers of the box",
            "/tf that contradicts the joint states",
            "steps that the student chose",
            "boxes exchanged on the way",
            "box that was seen once",
        ),
        (
            "four lost messages",
            "/tf that is 20 ms late",
            "velocities that come 40 ms late",
            "box that slides 8 cm",
        ),
    ),
    Rule(
        "A window does not cut a definition short",
        f"[`static`]({EXPECTATIONS}#static) and `placed` look 50 ms back, beyond the start of the"
        " step; where less was recorded of an object they are `not reached`. At the turning point"
        " of a throw an object is slower than 5 mm/s for 1 ms. In the first 50 ms of an object, and"
        " after a step has put it somewhere, its speed is what it has moved since, over 50 ms: what"
        " is put exactly on its support falls for one step of the physics before they touch.",
        ("turning point of a throw", "let go in the air", "can that rolls through the tray"),
        ("box that stands still during a step of 2 ms", "can that stays in the tray"),
    ),
    Rule(
        "A contact is not broken by a gap of 10 ms",
        f"[`in_contact`]({EXPECTATIONS}#in_contact) and [`collision`]({EXPECTATIONS}#collision)"
        " last through gaps of at most 10 ms, as supports do: stiff bodies that rub or"
        " rattle part for some steps of the physics again and again, so that `never ... for 50 ms`"
        " would pass, and `always` fail. A gap is closed between two contacts alone: a blow lasts"
        " no longer for it. In 10 ms of fall a body comes 0.5 mm away.",
        ("box that slides fast along the floor", "box that slides fast along a bench"),
        ("box that hops",),
    ),
    Rule(
        "A distance beyond the recording is not known",
        "Distances are recorded up to a cutoff, in a formula up to 2 m at most; at the cutoff they"
        " are at least as much. A formula that only the exact distance could decide is `not"
        " observable`: it is judged with the cutoff and with an infinite distance.",
        (
            "pillar further away than distances are recorded",
            "nearer of two pillars called the further one",
        ),
        ("pillar within 2 m",),
    ),
    Rule(
        "Distances between samples are bounded",
        f"A [clearance]({EXPECTATIONS}#clearance) is measured wherever the motion of the two bodies"
        " could make it smaller by more than 2 mm until the next sample, at interpolated positions"
        " too. Bodies at rest are measured every 5 ms, and 2 mm is the stated error.",
        (
            "ball that passes the gripper between two samples",
            "ball that passes the gripper at 100 m/s",
        ),
        ("slow ball that passes the gripper at a distance",),
    ),
    Rule(
        "A grasp is between the fingers",
        f"Two sides [press]({EXPECTATIONS}#grasped) from directions more than 90 degrees apart, at"
        " places as far from each other as the object is thick, and close: two contacts with"
        " coefficients of friction of at most 1 cannot balance each other otherwise.",
        (
            "closed tips on a larger box",
            "closed tips against the front of a crate",
            "box leans against the gripper, which grasps nothing",
            "box pinched between links of the arm",
        ),
        ("ball gripped above its middle", "ball shown as a balloon"),
    ),
    Rule(
        "Names and units mean one thing",
        "No object is called `robot`, `gripper`, `any`, `tcp`, `world` or like a link or a joint. A"
        " number with a unit of another dimension is an error; so is one beyond every value that"
        " the quantity has, such as 5 rad of lean, or one further beyond a joint's limits than they"
        " are apart.",
        (
            "object called `any`",
            "object called like a link",
            "length for a joint that turns",
            "degrees without a unit",
            "tolerance of 5 rad",
            "degrees for a joint's position",
        ),
        (
            "angles and lengths where they belong",
            "position a little beyond the joint's limit",
        ),
    ),
    Rule(
        "A run that was written over is called so",
        "`harness judge` and `harness compare` compute the digest of signals, trajectories and"
        " verdicts again, and the checksum of run.json and the resolved scenario, and say which of"
        " them differs. They judge what is there; runs of different robots are compared by name.",
        (
            "verdict turned round",
            "recorded positions written over",
            "digest written over as well",
        ),
        ("folder that was moved", "run of another robot"),
    ),
    Rule(
        "Every recorded message is judged",
        "The samples of a recording are the times of"
        f" [all messages]({GRADING}#how-recordings-are-read) about joints and objects. What stands"
        " still is known between messages that are up to ten periods of their topic apart, at most"
        " 1.5 s; a motion is interpolated over at most 0.25 s.",
        ("hop between two joint states", "box that is seen once a second"),
        ("box that stands and is seen once a second", "four lost messages"),
    ),
    Rule(
        "A recording that contradicts itself earns nothing",
        f"Points are withheld for each [doubt]({GRADING}#points): positions that contradict"
        " velocities, jumps and flips that no joint or body makes, topics that contradict each"
        " other, and poses that were sent once. The grader may allow each of them.",
        (
            "velocities that are all 0",
            "arm put at its goal by a program",
            "box that flips in each message",
            "/tf that contradicts the poses of the box",
            "box glued to the hand by /tf_static",
        ),
        (
            "box that tips over",
            "/tf that agrees with the poses of the box",
            "/tf that is 20 ms late",
        ),
    ),
    Rule(
        "What holds at the end holds by itself",
        "A joint or an object is where it is at the end, wherever it was before; of a joint that"
        " moves there a warning says so. What"
        f" [`placed`]({EXPECTATIONS}#placed) finds at rest on a surface that runs is kept there by"
        " something else, and it passes with a warning. Of what two hands hold, nothing is"
        " released.",
        (
            "box that a wall holds on a running belt",
            "lid that fell shut",
            "lid that is falling shut",
            "drawer that a spring closed",
            "rod that both hands hold",
        ),
        ("box at the wall of a belt that was stopped",),
    ),
    Rule(
        "What is not checked is said",
        "`contact may be missed` is a warning where a point of an object moves between two samples"
        " by more than both least widths: it is before the other at one and past it at the next;"
        " and where a link overlaps an object there, and no contact was recorded. An inertia beyond"
        " that of the whole mass at the far end of the shapes is a note. The"
        " [list below](#what-the-verdicts-do-not-claim) has the rest.",
        (
            "ball that passes through a plate between two samples",
            "ball at 200 m/s through a cube",
            "rod that seems to rest",
        ),
        ("ball that misses the plate at 5 m/s", "rod that falls"),
    ),
    Rule(
        "The environment decides nothing",
        "Files are UTF-8 whatever the locale, the terminal gets what its encoding has, and a"
        " graphics library is looked for when there is a picture to draw.",
        (
            "ASCII alone",
            "locale that is not installed",
            "graphics library that is missing",
        ),
        ("environment as it is",),
    ),
)


def rule_row(rule: Rule) -> str:
    """A rule's line of the table."""
    fires, silent = ("<br>".join(titles) for titles in (rule.fires, rule.silent))
    return f"| **{rule.title}.** {rule.text} | {fires} | {silent} |"
