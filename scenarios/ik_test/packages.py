"""Solvers of Python packages on a UR3e, as functions that `harness ik-test` calls.

They are used as their own examples use them, with their default tolerances. A package is imported
where its function is first called, so that each works without the others.
"""

import tempfile
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.plugins.iktest.strategies import Chain, load_chain

FloatArray = NDArray[np.float64]


@lru_cache(maxsize=1)
def ur3e() -> Chain:
    """The arm that all of them solve."""
    return load_chain("ur3e")


@lru_cache(maxsize=1)
def urdf_file() -> str:
    """The arm's URDF as a file."""
    path = Path(tempfile.mkdtemp()) / "ur3e.urdf"
    path.write_text(ur3e().description.urdf, encoding="utf-8")
    return str(path)


@lru_cache(maxsize=1)
def eaik_robot() -> tuple[Any, FloatArray]:
    """EAIK's robot from the axes of the joints at zero, and the tool's rotation there."""
    from eaik.IK_HP import HPRobot

    zero = np.zeros(6)
    chain = ur3e()
    tip = chain.link_pose(zero)
    axes, points = [], [np.zeros(3)]
    pose = np.eye(4)
    for before, axis in zip(chain.before, chain.axes, strict=True):
        pose = pose @ before.matrix()
        axes.append(pose[:3, :3] @ axis)
        points.append(pose[:3, 3])
    points.append(tip.translation)
    return HPRobot(np.array(axes), np.diff(np.array(points), axis=0)), tip.rotation


def eaik(matrix: FloatArray) -> list[FloatArray]:
    """EAIK: every solution that it does not call a least-squares approximation."""
    robot, tool = eaik_robot()
    target = np.array(matrix)
    target[:3, :3] = matrix[:3, :3] @ tool.T  # its tool is turned as the base
    found = robot.IK(target)
    return [q for q, is_approximate in zip(found.Q, found.is_LS, strict=True) if not is_approximate]


@lru_cache(maxsize=1)
def tracik_solver() -> Any:
    """TRAC-IK with the timeout and the tolerance of its own default."""
    from trac_ik import TracIK

    return TracIK("world", "tool0", urdf_file())


def pytracik(position: FloatArray, rotation: FloatArray, seed: FloatArray) -> FloatArray | None:
    """TRAC-IK: one solution near a seed, or None after 5 ms."""
    return tracik_solver().ik(position, rotation, seed_jnt_values=seed)


@lru_cache(maxsize=1)
def ikpy_chain() -> tuple[Any, list[int]]:
    """IKPy's chain, and which of its links are the arm's joints."""
    from ikpy.chain import Chain as IkpyChain

    way = ur3e().way
    elements = ["world", *(name for joint in way for name in (joint.name, joint.child))]
    moving = [False, *(joint.is_movable for joint in way)]  # its first link is the base
    chain = IkpyChain.from_urdf_file(urdf_file(), base_elements=elements, active_links_mask=moving)
    return chain, [number for number, moves in enumerate(moving) if moves]


def ikpy(matrix: FloatArray, seed: FloatArray) -> FloatArray:
    """IKPy: the least-squares optimum from a seed, with the whole orientation."""
    chain, joints = ikpy_chain()
    start = np.zeros(len(chain.links))
    start[joints] = seed
    found = chain.inverse_kinematics_frame(matrix, initial_position=start, orientation_mode="all")
    return np.asarray(found)[joints]


def ikpy_checked(matrix: FloatArray, seed: FloatArray) -> FloatArray | None:
    """IKPy, as its callers must use it: an optimum that is not at the target is refused."""
    answer = ikpy(matrix, seed)
    chain, joints = ikpy_chain()
    whole = np.zeros(len(chain.links))
    whole[joints] = answer
    return answer if np.abs(chain.forward_kinematics(whole) - matrix).max() < 1e-4 else None
