"""Dotted paths: in `--set`, in `parametrize`, in `randomize`."""

from pathlib import Path

import pytest

from harness.core.errors import SpecError
from harness.language.reading.load import parse_scenario

FILE = """\
scenario: Paths
robot: open_manipulator_x
params: {time: 0.1 s, speed: 1}
objects:
  - {name: cube, box: {size: [3 cm, 3 cm, 3 cm]}, pose: {xyz: [0.2, 0, 0.015]}}
  - name: post.left
    cylinder: {radius: 1 cm, length: 10 cm}
    pose: {xyz: [0.2, 0.1, 0.05], quat_xyzw: [0, 0, 0, 1]}
cameras:
  - {name: top, pose: {xyz: [0, 0, 1]}}
steps:
  - {wait: "${time}", id: first}
  - move_to: home
"""
LINE = FILE.count("\n") + 1


def parse(lines="", **overrides):
    return parse_scenario(FILE + lines, Path("f.yaml"), overrides).scenario


def problems(lines="", overrides=None):
    with pytest.raises(SpecError) as caught:
        parse_scenario(FILE + lines, Path("f.yaml"), overrides)
    return caught.value.problems


@pytest.mark.parametrize("cube", ["0", "cube"])
def test_a_part_of_what_the_file_leaves_out_is_set_from_its_default(cube):
    scenario = parse(**{f"objects.{cube}.pose.rpy.2": "90 deg"})
    assert scenario.objects[0].pose.rpy == pytest.approx((0, 0, 1.5707963267948966))
    assert scenario.objects[0].pose.xyz == (0.2, 0, 0.015)


def test_lists_and_mappings_that_the_file_leaves_out_are_begun():
    scenario = parse(
        **{
            "robot.base.xyz.2": "1 m",
            "objects.cube.center_of_mass.1": "0.01",
            "objects.cube.friction.sliding": "0.5",
            "planning.parameters.range": "0.2",
        }
    )
    assert scenario.robot.base.xyz == (0, 0, 1)
    assert scenario.objects[0].center_of_mass == (0, 0.01, 0)
    assert scenario.objects[0].friction.sliding == 0.5
    assert scenario.planning.parameters == {"range": 0.2}


def test_objects_cameras_and_steps_are_found_by_name():
    scenario = parse(
        **{
            "objects.post.left.cylinder.radius": "2 cm",
            "cameras.top.pose.xyz.2": "2",
            "steps.first.timeout": "3 s",
            "steps.1.move_to.named_target": "init",
        }
    )
    assert scenario.objects[1].cylinder.radius == 0.02
    assert scenario.cameras[0].pose.xyz[2] == 2
    assert scenario.steps[0].timeout == 3
    assert scenario.steps[1].named_target == "init"


WRONG = [
    ("objects.cubee.mass", "`cubee` in `objects.cubee.mass` is no index", "did you mean `cube`?"),
    ("objects.2.mass", "`2` in `objects.2.mass` is no index of this list of 2", "indices: 0 to 1"),
    ("objects.table.mass", "and no name in it", "with `replace: true`"),
    (
        "objects.cube.color.0",
        "does not say `objects.cube.color`, and it has no default",
        "write it",
    ),
    ("objects.cube.pose.xyz.3", "`3` in `objects.cube.pose.xyz.3` is no index", "0 to 2"),
    ("params.z", "no parameter is called `z`", "params: time, speed"),
    ("params.spede", "no parameter is called `spede`", "did you mean `speed`?"),
    ("scenario.x", "`scenario` is `Paths`; it has no `x`", "set the whole of it"),
    ("stps.0.timeout", "the file has no `stps` to set", "did you mean `steps`?"),
]


@pytest.mark.parametrize(("path", "message", "hint"), WRONG)
@pytest.mark.parametrize(
    "line",
    [
        "randomize: {§PATH: {uniform: [1, 2]}}",
        "parametrize: {§PATH: [1, 2]}",
        "parametrize: [{§PATH: 1}]",
    ],
)
def test_a_path_that_leads_nowhere_is_reported_in_the_file_and_never_as_an_option(
    path, message, hint, line
):
    (problem,) = problems(line.replace("§PATH", path))
    assert (problem.path, problem.line, problem.column) == ("f.yaml", LINE, line.index("§") + 1)
    assert message in problem.message
    assert hint in problem.hint
    assert "--set" not in str(problem)
    case = {path: "1"} if line.startswith("param") else {}
    assert [(p.line, p.message) for p in problems(line.replace("§PATH", path), case)] == [
        (LINE, problem.message)
    ]


@pytest.mark.parametrize(("path", "message", "hint"), WRONG)
def test_a_path_that_leads_nowhere_is_reported_at_the_option(path, message, hint):
    (problem,) = problems(overrides={path: "1"})
    assert problem.path == f"--set {path}=1"
    assert message in problem.message
    assert hint in problem.hint


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("{objects.cube.mass: {uniform: [§-1, 3]}}", "can be drawn as `-1`: `mass` must be more"),
        ("{objects.cube.mass: {uniform: [1, §3 cm]}}", "one unit"),
        ("{objects.cube.mass: {normal: {mean: 1, std: 1, low: §-1}}}", "as `-1`: `mass` must be"),
        (
            "{objects.cube.in: {choice: [both, §none]}}",
            "as `none`: `in` cannot be `none`",
        ),
        ("{objects.cube.mass: {uniform: [§1 cm, 3 cm]}}", "as `1 cm`: `1 cm` is a length"),
        ("{§objects.cube.pos.xyz.0: {uniform: [1, 3]}}", "cannot vary: unknown key `pos`"),
        ("{§objects.post.left.pose.rpy.2: {uniform: [0, 1]}}", "cannot vary: a pose has one rot"),
        ("{time: {choice: [1 s, §up]}}", "`time` can be drawn as `up`: a time is a number"),
    ],
)
def test_what_cannot_be_drawn_is_known_before_anything_is_run(line, message):
    (problem,) = problems("randomize: " + line.replace("§", ""))
    assert problem.line == LINE
    if "one unit" not in message:
        assert problem.column == line.index("§") + len("randomize: ") + 1
    assert message in problem.message


def test_a_drawn_value_that_does_not_fit_is_reported_where_it_is_drawn():
    line = "randomize: {objects.cube.mass: {normal: {mean: 1, std: 1}}}"
    (problem,) = problems(line, {"objects.cube.mass": "-0.25", "seed": "3"})
    assert (problem.path, problem.line, problem.column) == ("f.yaml", LINE, 32)
    assert "`mass` must be more than 0, not `-0.25`" in problem.message


def test_what_fits_can_be_drawn_in_the_same_paths():
    line = (
        "randomize: {objects.cube.pose.rpy.2: {uniform: [-1, 1]}, objects.cube.mass:"
        " {uniform: [1 g, 2 g]}, robot.model: {choice: [ur3e, ur5e]}}"
    )
    assert parse(line).randomize.keys() >= {"objects.cube.mass"}


@pytest.mark.parametrize("line", ["parametrize: {seed: []}", "parametrize: []", "parametrize: {}"])
def test_a_variation_without_any_case_is_a_mistake(line):
    (problem,) = problems(line)
    assert problem.line == LINE
