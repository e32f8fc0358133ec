"""Objects that look different from what they collide as, or are seen only."""

from harness.core.geometry import Box, Sphere
from harness.session.prepare import prepare
from tests.session.front_door import file_of, run

LOOKS = """
objects:
  - name: sign
    static: true
    pose: {xyz: [0.3, 0, 1.3]}
    visuals: [{box: {size: [0.2, 0.2, 0.02]}, color: [1, 0, 0, 1]}]
  - name: block
    pose: {xyz: [0.5, 0, 0.05]}
    mass: 0.2
    shapes: [{box: {size: [0.1, 0.1, 0.1]}, friction: 0.3}]
    visuals: [{sphere: {radius: 0.05}}]
"""


def test_visuals_are_drawn_in_place_of_shapes(tmp_path):
    program = prepare(file_of(tmp_path, "- wait: 0.1 s", rest=LOOKS)).program
    objects = {obj.name: obj for obj in program.world.objects}
    assert objects["sign"].shapes == ()
    assert objects["sign"].visuals[0].geometry == Box((0.2, 0.2, 0.02))
    assert objects["sign"].visuals[0].rgba == (1, 0, 0, 1)
    assert objects["block"].visuals[0].geometry == Sphere(0.05)
    assert objects["block"].shapes[0].friction.sliding == 0.3


def test_what_is_only_seen_stops_no_motion(tmp_path):
    steps = "- move_to: up\n- move_to: {position: {xyz: [0.3, 0, 1.3]}}"
    result, record = run(tmp_path, steps, rest=LOOKS + "expect: [{never: collision}]\n")
    assert result.outcome == "passed"
    assert {obj.name for obj in record.objects} >= {"sign", "block"}
