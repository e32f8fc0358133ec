"""All mistakes inside one step, one expectation or one object are reported at once."""

import random
import re

import pytest

from harness.core.errors import SpecError
from harness.session.prepare import prepare
from tests.plugins.commands import harness

HEAD = "scenario: two\nrobot: {model: ur3e, gripper: rh_p12_rn_a}\nworld: lesson_ur\n"
STEPS = "steps:\n  - wait: 0.1\n"
FIELD = re.compile(r"<([^|<>]*)\|([^|<>]*)\|([^<>]*)>")
"""A value as `<right|wrong|what the message has>`."""

ITEMS = {
    "joints": "steps: [move_to: {joints: {<elbow_joint|elbow|no joint of>: 0,"
    " wrist_1_joint: <0|3 kg|`3 kg` is a mass>}}]",
    "a pose": "steps: [move_to: {pose: {xyz: [0.3, <0.1|2 s|`2 s` is a time>, 1.3],"
    " rpy: [0, 0, 0], frame: <world|nowhere|no frame 'nowhere'>},"
    " link: <tool0|tool9|no link 'tool9'>}]",
    "a direction": "steps: [move_relative: {direction: {xyz: [0, 0, <1|0|some length>],"
    " frame: <world|nowhere|no frame 'nowhere'>}, distance: <0.1|-1|must be more than 0>,"
    " link: <tool0|tool9|no link 'tool9'>}]",
    "a fault": "steps: [inject: {push: {<red_box|ghost|no object 'ghost'>: [1, 2, 3]},"
    " push_duration: <0.1|-1|must be at least 0>}]",
    "repeated steps": "steps: [repeat: {times: <2|-1|at least 1>, steps: ["
    "wait: <0.1|-3|at least 0>, remove_object: <red_box|ghost|no object 'ghost'>]}]",
    "an attached object": "steps: [attach_object: {object: <red_box|5|is text>,"
    " link: <tool0|tool9|no link 'tool9'>, touch_links: [<tool0|tool8|no link 'tool8'>]}]",
    "an object of a step": "steps: [add_object: {objects: [{name: new, sphere:"
    " {radius: <0.1|-1|more than 0>}, pose: {xyz: [1, 0, 1], frame: <world|nowhere|no frame>}}]}]",
    "a name of what is missing": "steps: [move_object: {object: <red_box|ghost|no object 'ghost'>,"
    " pose: {xyz: <[1, 0, 1]|up|`xyz`>, frame: <world|nowhere|no frame 'nowhere'>}}]",
    "a step and its expectation": "steps: [{wait: <0.1|-1|at least 0>, expect: ["
    "in_contact: {between: [<robot|roboot|'roboot'>, Table], min_force: <0|-1|at least 0>}]}]",
    "two goals": "steps: [lin: {pose: {xyz: [0.3, 0, 1.4], rpy: [0, 0, 0],"
    " frame: <world|nowhere|no frame 'nowhere'>}<|, joints: {elbow_joint: 0}|exactly one of>}]",
    "a rule and a field of a goal": "steps: [lin: {pose: {xyz: [0.3, <0|2 s|`2 s` is a time>, 1.4],"
    " rpy: [0, 0, 0]}<|, named_target: home|exactly one of>}]",
    "a rule and a field of a gripper": "steps: [gripper: {<named_target: open|position: 2 s|`2 s`>"
    "<|, width: 3 cm|exactly one of>}]",
    "a rule and a field of an object": "objects: [{name: a, box: {size: [1, <1|-1|more than 0>, 1]}"
    ", pose: {xyz: [1, 0, 2]}<|, sphere: {radius: 1}|exactly one of>}]\n" + STEPS,
    "a temporal word": STEPS + "expect: [always: {clearance: {between: [robot,"
    " <Table|Tabel|no object 'Tabel'>], at_least: <0|-1|at least 0>}}]",
    "a joint's tolerance": STEPS + "expect: [joints: {positions: {<elbow_joint|elbow|no joint>: 1},"
    " tolerance: <0.1|-1|more than 0>, during: <settle|walk|no step with the id>}]",
    "a container": STEPS + "expect: [in: {object: <red_box|ghost|no object 'ghost'>,"
    " container: <Table|Tablee|no object 'Tablee'>, max_lean: <0.1|-1|more than 0>}]",
    "two predicates": STEPS + "expect: [{always: {upright: {object: <red_box|gho|no object 'gho'>,"
    " tolerance: <0.1|-1|more than 0>}}, until: {lifted: {object:"
    " <red_box|ghost|no object 'ghost'>, above: <0.1|5 kg|`5 kg` is a mass>}}}]",
    "an object": "objects: [{name: a, box: {size: [0.1, <0.1|-1|more than 0>, 0.1]}, pose:"
    " {xyz: [1, 0, 2], frame: <world|nowhere|no frame>}, mass: <1|-3|more than 0>}]\n" + STEPS,
    "a reserved name": "objects: [{name: <a|tool0|a robot link's name>,"
    " sphere: {radius: <0.1|2 s|`2 s` is a time>}, pose: {xyz: [1, 0, 2]}}]\n" + STEPS,
    "a mesh": "objects: [{name: a, <box: {size: [0.1, 0.1, 0.1]}|mesh: {file: no.stl,"
    " scale: [1, x, 1]}|no mesh file>, static: true, pose: {xyz: [1, <0|2 s|is a time>, 2]}}]\n"
    + STEPS,
}  # fmt: skip


def reported(folder, text):
    path = folder / "item.scenario.yaml"
    path.write_text(HEAD + text)
    try:
        prepare(path)
    except SpecError as error:
        return error.problems
    return []


def written(item, wrong):
    """The item with the fields of some numbers wrong, and what the messages have."""
    numbers = iter(range(100))
    expected = []

    def field(match):
        if next(numbers) not in wrong:
            return match[1]
        expected.append(match[3])
        return match[2]

    return FIELD.sub(field, item), expected


def missed(folder, item, wrong):
    text, expected = written(item, wrong)
    problems = reported(folder, text)
    return [part for part in expected if not any(part in each.message for each in problems)]


@pytest.mark.parametrize("name", ITEMS)
def test_all_mistakes_of_an_item_are_reported_each_once(tmp_path, name):
    wrong = range(len(FIELD.findall(ITEMS[name])))
    assert len(wrong) > 1
    text, expected = written(ITEMS[name], wrong)
    problems = reported(tmp_path, text)
    assert missed(tmp_path, ITEMS[name], wrong) == [], [str(each) for each in problems]
    extra = 1 if name == "a mesh" else 0  # its scale
    assert len(problems) == len(expected) + extra, [str(each) for each in problems]
    places = {(each.line, each.column) for each in problems}
    assert len(places) == len(problems)


@pytest.mark.parametrize("seed", range(12))
def test_any_mistakes_of_an_item_are_reported(tmp_path, seed):
    rng = random.Random(seed)
    item = ITEMS[rng.choice(sorted(ITEMS))]
    count = len(FIELD.findall(item))
    wrong = rng.sample(range(count), rng.randint(1, count))
    assert missed(tmp_path, item, wrong) == []


def test_a_broken_step_has_no_problems_in_the_steps_after_it(tmp_path):
    text = (
        "steps: [attach_object: {object: red_box, link: tool0, touch_links: 5},"
        " detach_object: red_box,"
        " add_object: {objects: [{name: new, sphere: {radius: -1}, pose: {xyz: [1, 0, 1]}}]},"
        " remove_object: new]"
    )
    problems = reported(tmp_path, text)
    assert [each.message for each in problems] == [
        "`touch_links` is a list, not `5`",
        "`radius` must be more than 0, not `-1`",
    ]


FRAGILE = '''
from harness.steps import At, Cell, Name, PositiveLength, Step


class Nudge(Step):
    """Push an object with the tool."""

    verb = "nudge"

    object: Name
    by: PositiveLength
    times: tuple[PositiveLength, ...]

    def check(self, at: At) -> None:
        at.scope.check_object(self.object, at.key("object"))
        1 / (self.times[0] - 0.5)

    def execute(self, cell: Cell) -> None:
        raise NotImplementedError
'''


def test_a_step_of_a_package_has_all_its_mistakes_reported(tmp_path):
    (tmp_path / "nudge.py").write_text(FRAGILE, encoding="utf-8")
    path = tmp_path / "a.scenario.yaml"
    path.write_text(HEAD + "steps: [nudge: {object: ghost, by: -1 cm, times: [0.5]}]")
    printed = harness(tmp_path, "check", path.name, "--plugin", "nudge.py", code=2)
    assert "no object 'ghost'" in printed
    assert "`by` must be more than 0" in printed
    path.write_text(HEAD + "steps: [nudge: {object: red_box, by: 1 cm, times: [0.5]}]")
    printed = harness(tmp_path, "check", path.name, "--plugin", "nudge.py", code=3)
    assert "ZeroDivisionError" in printed
