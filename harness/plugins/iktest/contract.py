"""Arguments of a function under test, which the names of its parameters select."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.spatial import SE3, pitch_of, xyzw_from_wxyz
from harness.core.suggestion import did_you_mean
from harness.core.types import FloatArray
from harness.plugins.iktest.strategies.tasks import Task
from harness.suite.discovery import UsageError

Value = float | FloatArray


class UnusableSolver(UsageError):
    """The function cannot be tested: it is not there, or has parameters that are not known."""


@dataclass(frozen=True)
class ParameterWord:
    """A parameter's name.

    Attributes:
        says: What its argument is.
        fixes: Parts of the target that it fixes: x, y, z, pitch, turn; or none.
        value: The value of a target T_world_link and a seed.
    """

    says: str
    fixes: str
    value: Callable[[SE3, FloatArray], Value]


WORDS: dict[str, ParameterWord] = {
    "x": ParameterWord("target's x [m], a float", "x", lambda T, _: float(T.translation[0])),
    "y": ParameterWord("target's y [m], a float", "y", lambda T, _: float(T.translation[1])),
    "z": ParameterWord("target's z [m], a float", "z", lambda T, _: float(T.translation[2])),
    "position": ParameterWord(
        "x, y, z [m], shape (3,)", "x y z", lambda T, _: np.array(T.translation)
    ),
    "pitch": ParameterWord(
        "angle of the link's x axis below the horizontal [rad], -pi/2 to pi/2, a float",
        "pitch",
        lambda T, _: pitch_of(T.rotation),
    ),
    "quat_wxyz": ParameterWord("unit quaternion w, x, y, z", "turn", lambda T, _: T.quat_wxyz),
    "quat_xyzw": ParameterWord(
        "unit quaternion x, y, z, w", "turn", lambda T, _: xyzw_from_wxyz(T.quat_wxyz)
    ),
    "rotation": ParameterWord(
        "rotation matrix, shape (3, 3)", "turn", lambda T, _: np.array(T.rotation)
    ),
    "matrix": ParameterWord(
        "homogeneous matrix, shape (4, 4)", "x y z turn", lambda T, _: T.matrix()
    ),
    "pose": ParameterWord("the same as `matrix`", "x y z turn", lambda T, _: T.matrix()),
    "seed": ParameterWord(
        "joint positions to start from, shape (dof,); home, or the last answer on a line",
        "",
        lambda _, seed: np.array(seed),
    ),
}


def parameter_words(function: Callable[..., Any]) -> tuple[str, ...]:
    """The parameters that receive arguments; those with other names keep their defaults.

    Raises:
        UnusableSolver: A parameter without a default has another name.
    """
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError) as error:
        raise UnusableSolver(
            f"the parameters of {function!r} cannot be read; wrap it: def ik(matrix): ..."
        ) from error
    words: list[str] = []
    for each in parameters:
        if each.name in WORDS and each.kind not in (each.VAR_POSITIONAL, each.VAR_KEYWORD):
            if each.kind is each.POSITIONAL_ONLY:
                raise UnusableSolver(f"parameter `{each.name}` is positional only: drop the `/`")
            words.append(each.name)
        elif each.kind in (each.VAR_POSITIONAL, each.VAR_KEYWORD) or each.default is not each.empty:
            continue
        else:
            raise UnusableSolver(
                f"no argument is known for the parameter `{each.name}`; "
                + did_you_mean(each.name, WORDS, "names")
            )
    task_of_parameters(words)
    return tuple(words)


def task_of_parameters(words: Sequence[str]) -> Task:
    """The task of a function with such parameters.

    Raises:
        UnusableSolver: They do not say where the target is.
    """
    fixed = set(" ".join(WORDS[word].fixes for word in words).split())
    if not {"x", "y", "z"} <= fixed:
        raise UnusableSolver(
            "the function does not receive the target's position: it needs the parameters "
            "`x, y, z`, `position` or `matrix`"
        )
    return "pose" if "turn" in fixed else "position and pitch" if "pitch" in fixed else "position"


def call_arguments(words: Sequence[str], target: SE3, seed: FloatArray) -> dict[str, Value]:
    """What a function is called with, made anew for every call."""
    return {word: WORDS[word].value(target, seed) for word in words}


def call_text(name: str, arguments: dict[str, Value]) -> str:
    """A call as Python, numbers to a billionth."""
    text = ", ".join(f"{word}={_number_text(value)}" for word, value in arguments.items())
    return f"{name}({text})"


def _number_text(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"[{', '.join(_number_text(each) for each in value)}]"
    return repr(round(float(value), 9) + 0.0)
