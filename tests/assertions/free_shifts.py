"""Shifts that no predicate may notice, by its definition; every other one must be noticed."""

from tests.assertions.evidence import AT_ONCE, DRIFT, Free, collected

TURNS = "+-roll +-pitch +-yaw"
PLACES = "+-x +-y +-z"


HELD = "lifted, grasped, slip, until"
FREE = (
    *(free for evidence in collected().values() for free in evidence.free_shifts),
    Free("higher is lifted too; where, and how it is turned, is not spoken of",
         "lifted, until", "object_poses box", f"+-x +-y +z {TURNS}", (AT_ONCE,)),
    Free("a hand that stands elsewhere, or higher, raises it as much",
         "lifted", "tcp_pose", f"+-x +-y +z {TURNS}", (AT_ONCE,)),
    Free("a hand that stands elsewhere all the time raises it as much",
         "until", "tcp_pose", f"{PLACES} {TURNS}", (AT_ONCE,)),
    Free("friction sideways carries nothing, and more of it upwards carries more",
         "lifted, until", "frictions", "+-x +-y +z"),
    Free("less of a support's force is no support", "lifted", "contact_forces Table", "-"),
    Free("a firmer grip is a grip", HELD, "contact_forces left_finger, contact_forces right_finger",
         "+"),
    Free("where a finger presses is free, only that they press against each other as far apart"
         " as the object is thick",
         HELD, "presses left_finger", "+-x +-z -y +force_y"),
    Free("the same from the other side",
         HELD, "presses right_finger", "+-x +-z +y -force_y"),
    Free("past the other finger: a ring that is held from inside",
         "lifted, slip", "presses left_finger", "+y", (DRIFT,)),
    Free("the same from the other side",
         "lifted, slip", "presses right_finger", "-y", (DRIFT,)),
    Free("an object that was held elsewhere all the time has not moved in the hand",
         "grasped, slip", "object_poses box, tcp_pose", f"{PLACES} {TURNS}", (AT_ONCE,)),
    Free("no force of the fingers is released",
         "released, placed", "contact_forces left_finger, contact_forces right_finger", "-"),
    Free("to stand more heavily is to stand", "placed, on", "contact_forces Table", "+"),
    Free("to stand more heavily is to stand", "placed, on", "support_forces", "+"),
    Free("`placed` requires how upright it stands, and that it rests; about the vertical it may be"
         " turned", "placed", "object_poses box", "+-yaw", (AT_ONCE,)),
    Free("a container that turns about its opening's axis stays upright",
         "in", "object_poses bin", "+-yaw"),
    Free("its origin is what is in something", "in", "object_poses box", TURNS),
    Free("further away, and aside, is displaced too",
         "displaced", "object_poses", f"-x +-y +-z {TURNS}"),
    Free("what stood elsewhere all the time has not moved",
         "static, static 2", "object_poses", f"{PLACES} {TURNS}", (AT_ONCE,)),
    Free("a harder contact is one", "in_contact", "contact_forces", "+"),
    Free("it is to be true once, and was before the force had drifted away",
         "in_contact", "contact_forces", "-", (DRIFT,)),
    Free("less than no contact is none", "collision", "contact_forces", "-"),
    Free("less than no overlap is none", "collision 2", "link_overlaps", "-"),
    Free("contacts decide; how near it came is shown", "collision 3", "clearances", "+-"),
    Free("further away is clear", "clearance, clearance 2, formula 3", "clearances", "+"),
    Free("less was planned than there was", "clearance 2", "planned_clearances", "-"),
    Free("a path has no orientation", "tcp_path, path_length", "tcp_pose", TURNS),
    Free("the same path elsewhere is as long", "path_length", "tcp_pose", PLACES, (AT_ONCE,)),
    Free("the other group's joints", "named_target", "joint_positions", "+-finger"),
    Free("the other group's joints", "gripper, gripper 2", "joint_positions", "+-shoulder"),
    Free("fingers lag their command to press",
         "tracking_error", "joint_positions, joint_commands", "+-finger"),
    Free("acceleration is required of the arm", "within_limits", "joint_command_velocities",
         "+-finger"),
    Free("the formula requires `force > 0.5`", "formula", "contact_forces", "+"),
    Free("the formula requires `z(box) < 0.1` and a tilt",
         "formula", "object_poses", "+-x +-y -z +-yaw"),
    Free("the formula requires `z(tcp) > 0.49`", "formula", "tcp_pose", f"+-x +-y +z {TURNS}"),
    Free("turning is no speed of the origin", "formula 2", "object_poses", TURNS),
    Free("the same motion elsewhere is as fast", "formula 2", "object_poses", PLACES, (AT_ONCE,)),
    Free("the formula does not name the finger", "formula 3",
         "joint_positions, joint_commands, joint_velocities, joint_efforts", "+-finger"),
    Free("the formula requires less than a limit", "formula 3", "joint_velocities, joint_efforts",
         "-shoulder"),
    Free("the support may be lower, elsewhere and turned: `lifted` ends the wait all the same",
         "until", "object_poses Table", f"+-x +-y -z {TURNS}"),
)  # fmt: skip


def free_shifts(case, place):
    """Direction and course of the shifts of an array that this case need not notice."""
    field, key = place
    bodies = key if isinstance(key, tuple) else (key,)
    names = {field, *(f"{field} {body}" for body in bodies)}
    return {
        (sign + column.replace("_", " "), course)
        for free in FREE
        if case in free.cases.split(", ") and names & set(free.signals.split(", "))
        for word in free.directions.split()
        for column in [word.lstrip("+-")]
        for sign in word[: len(word) - len(column)]
        for course in free.courses
    }
