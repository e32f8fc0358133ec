"""Motion steps of a file: what is refused at its line, and what a step reports."""

import pytest

from tests.session.front_door import check, problems, run

ARM = "{model: ur3e, gripper: rh_p12_rn_a}"
START = "{pose: {xyz: [0.25, -0.17, 0.22], quat_xyzw: [0.924, -0.383, 0, 0]}}"


def overlap(tmp_path, first, second, radii):
    steps = f"""
    - sequence:
        - lin: {first}
          blend_radius: {radii[0]}
        - lin: {second}
          blend_radius: {radii[1]}
        - ptp: up
    """
    return problems(tmp_path, steps, robot=ARM)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("{pose: {xyz: [0.3, 0, 0.3]}}", "{position: [0.3, 0.06, 0.3]}"),
        (
            "{pose: {frame: base_link, xyz: [0.3, 0, 0.3]}}",
            "{pose: {frame: base_link, xyz: [0.3, 0.06, 0.3]}}",
        ),
    ],
)
def test_blends_that_overlap_are_refused_at_their_line(tmp_path, first, second):
    ((line, message),) = overlap(tmp_path, first, second, ("4 cm", "3 cm"))
    assert line == 7
    assert message.startswith("the blend radii overlap: 40 mm here and 30 mm at the next motion")
    assert "60 mm away" in message
    assert not overlap(tmp_path, first, second, ("3 cm", "2 cm"))


def test_the_last_motion_of_a_sequence_has_nothing_to_blend_into(tmp_path):
    steps = "- sequence:\n    - ptp: home\n    - ptp: up\n      blend_radius: 1 cm"
    ((line, message),) = problems(tmp_path, steps, robot=ARM)
    assert (line, message) == (8, "the last motion of a sequence has nothing to blend into")


def test_names_inside_a_sequence_are_checked_at_their_place(tmp_path):
    steps = """
    - sequence:
        - ptp: hoome
        - circ:
            position: {frame: bse_link, xyz: [0, 0, 0]}
            center: {frame: tabel, xyz: [0, 0, 0]}
    - cartesian_path: {waypoints: [{frame: bse_link, xyz: [0, 0, 0]}]}
    """
    found = problems(tmp_path, steps, robot=ARM)
    assert [line for line, _ in found] == [6, 8, 9, 10]
    assert "hoome" in found[0][1]


def test_an_arc_needs_one_of_interim_and_center(tmp_path):
    ((line, message),) = problems(tmp_path, "- circ: {position: [0.3, 0, 0.3]}", robot=ARM)
    assert line == 5
    assert message == "exactly one of `interim` and `center` is needed"


def test_check_reports_what_stops_a_path_without_physics(tmp_path):
    steps = f"""
    - move_to: {START}
    - circ: {{position: [0.25, -0.1, 0.22], interim: [0.25, -0.135, 0.22]}}
    - cartesian_path: {{waypoints: [{{xyz: [0.9, -0.17, 0.22]}}]}}
    - sequence: [lin: {{position: [0.25, -0.1, 0.22]}}, lin: {{position: [0.9, 0, 0.2]}}]
    """
    predicted = check(tmp_path, steps, robot=ARM).predicted
    assert [problem.line for problem in predicted] == [6, 7, 8]
    codes = [problem.message.split(":")[0] for problem in predicted]
    assert codes == ["INVALID_MOTION_PLAN", "PLANNING_FAILED", "NO_IK_SOLUTION"]


def test_a_cartesian_path_reports_its_figures_whether_it_is_followed_or_refused(tmp_path):
    steps = f"""
    - move_to: {START}
    - cartesian_path: {{waypoints: [{{xyz: [0.7, -0.17, 0.22]}}], min_fraction: 0.1}}
    - cartesian_path: {{waypoints: [{{xyz: [0.9, -0.17, 0.22]}}], min_fraction: 0.9}}
      expect_error: PLANNING_FAILED
    """
    result, record = run(tmp_path, steps, robot=ARM)
    assert result.outcome == "passed", [step.message for step in result.steps]
    followed, refused = (step.result.plain() for step in record.steps[1:3])
    assert 0.1 < followed["fraction"] < 1
    assert 0 <= refused["fraction"] < 0.9
    assert set(followed) >= {"fraction", "largest_joint_step", "deviation"}
    assert followed["deviation"] < 1e-3
