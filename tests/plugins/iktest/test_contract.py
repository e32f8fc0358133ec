"""What a function may be called with and may return, and how mistakes in it are reported."""

# ruff: noqa: ARG001, ARG005

import re
from math import acos, atan2

import numpy as np
import pytest

from harness.core.spatial import SE3, rotation_from_rpy
from harness.plugins.iktest.calls import call, read_answers
from harness.plugins.iktest.contract import (
    WORDS,
    UnusableSolver,
    call_arguments,
    parameter_words,
    task_of_parameters,
)
from harness.plugins.iktest.worker import find_function

TARGET = SE3(rotation_from_rpy((0.3, -0.2, 1.1)), np.array([0.3, -0.1, 0.2]))


def test_every_word_says_the_same_target():
    values = call_arguments(tuple(WORDS), TARGET, np.array([0.5, 0.25]))
    assert (
        [values["x"], values["y"], values["z"]] == values["position"].tolist() == [0.3, -0.1, 0.2]
    )
    x, y, z, w = values["quat_xyzw"]
    assert [w, x, y, z] == values["quat_wxyz"].tolist()
    assert (
        SE3.from_xyz_quat((0, 0, 0), values["quat_wxyz"]).distance_to(
            SE3(values["rotation"], np.zeros(3))
        )[1]
        < 1e-12
    )
    assert values["matrix"][:3, :3].tolist() == values["rotation"].tolist()
    assert values["matrix"][:3, 3].tolist() == [0.3, -0.1, 0.2]
    assert values["seed"].tolist() == [0.5, 0.25]
    down = SE3(rotation_from_rpy((0, 0.4, 0.9)), np.zeros(3))
    assert call_arguments(("pitch",), down, np.zeros(1))["pitch"] == pytest.approx(0.4)


def test_parameters_say_what_is_requested():
    assert task_of_parameters(parameter_words(lambda x, y, z: None)) == "position"
    assert task_of_parameters(parameter_words(lambda position, pitch: None)) == "position and pitch"
    assert task_of_parameters(parameter_words(lambda position, quat_xyzw: None)) == "pose"
    assert task_of_parameters(parameter_words(lambda matrix, seed: None)) == "pose"
    assert parameter_words(lambda pose, elbow=1, *, iterations=5: None) == ("pose",)


@pytest.mark.parametrize(
    ("function", "reported"),
    [
        (lambda goal: None, r"no argument is known for the parameter `goal`; names: x, y, z, "),
        (lambda matrx: None, r"`matrx`; did you mean `matrix`\?"),
        (lambda x, y: None, "does not receive the target's position"),
        (lambda quat_wxyz: None, "does not receive the target's position"),
        (dict, "cannot be read; wrap it|`.*`"),
    ],
)
def test_unknown_parameters_are_reported(function, reported):
    with pytest.raises(UnusableSolver, match=reported):
        parameter_words(function)


def test_answers_are_none_one_or_many():
    assert read_answers(None, 4).kind == "refused"
    assert read_answers([], 4).kind == "refused"
    assert read_answers(np.zeros((0, 4)), 4).kind == "refused"
    assert len(read_answers((1, 2, 3, 4), 4).answers) == 1
    assert len(read_answers([[1, 2, 3, 4]] * 3, 4).answers) == 3
    for returned, said in (
        ([1, 2, 3], "3 numbers"),
        (np.zeros((4, 3)), "4 x 3 numbers"),
        (7.0, "one numbers"),
        ({"joint1": 1.0}, "dict {'joint1': 1.0}"),
    ):
        text = read_answers(returned, 4).text
        assert text.startswith(f"returned {said}; it must return 4 joint positions")
    assert read_answers([[1, 2, 3, 4], [1]], 4).kind == "unreadable"


class OutOfReach(ValueError):
    pass


def test_an_exception_of_ones_own_class_refuses_and_others_are_found_with_their_line():
    def refuses(x, y, z):
        raise OutOfReach(x)

    def breaks(x, y, z):
        return [atan2(y, x), acos(2.0 + z)]

    arguments = {"x": 1.0, "y": 0.0, "z": 0.5}
    assert call(refuses, arguments, 2).kind == "refused"
    outcome = call(breaks, arguments, 2)
    assert outcome.kind == "raised"
    assert outcome.text.startswith("ValueError: ")
    assert re.fullmatch(r"test_contract\.py:\d+", outcome.place)


def test_a_numpy_warning_is_no_error_but_its_nan_is_an_answer():
    outcome = call(lambda x: np.arccos(np.array([2.0, x])), {"x": 0.5}, 2)
    assert outcome.kind == "answered"
    assert np.isnan(outcome.answers[0][0])


@pytest.mark.parametrize(
    ("name", "text", "reported"),
    [
        ("ik", "", "'ik' is not module:function or file.py:function"),
        ("nowhere.py:ik", "", "no such file: 'nowhere.py'"),
        ("no_such_module:ik", "", r"no module 'no_such_module'.*my_ik\.py:ik"),
        ("mine.py:slove", "def solve(x): ...", r"no function 'slove'; did you mean `solve`\? "
         "functions there: solve"),
        ("mine.py:LIMIT", "LIMIT = 3", "is a int, not a function"),
        ("mine.py:ik", "import nothing_of_that_name", r"mine\.py:1: ModuleNotFoundError"),
        ("mine.py:ik", "def ik(:", r"mine\.py:1: SyntaxError"),
        ("mine.py:ik", "exit()", "SystemExit"),
    ],
)  # fmt: skip
def test_a_function_that_cannot_be_imported_is_reported(
    tmp_path, monkeypatch, name, text, reported
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.path", ["", *__import__("sys").path])
    (tmp_path / "mine.py").write_text(text)
    with pytest.raises(UnusableSolver, match=reported):
        find_function(name)
