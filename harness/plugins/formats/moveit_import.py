"""Scenarios from MoveIt's PlanningScene and MotionPlanRequest files."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from harness.core.errors import Problem, SpecError
from harness.language.files.source import Located, Place, Source, located
from harness.language.files.yaml_text import yaml_text
from harness.language.scenario import RobotSpec
from harness.plugins.formats.moveit_messages import request as requests
from harness.plugins.formats.moveit_messages import scene as scenes
from harness.plugins.formats.moveit_messages.request import MoveItRequest, read_request
from harness.plugins.formats.moveit_messages.scene import MoveItScene, read_scene
from harness.plugins.formats.stl import stl_bytes
from harness.plugins.formats.world_text import world_text
from harness.plugins.formats.yaml_data import read_data
from harness.robot.description import RobotDescription
from harness.robot.load import load_robot
from harness.robot.packages import PackagePath
from harness.robot.robot_source import RobotSource
from harness.world.imported import Note

OnProgress = Callable[[str, int, int], None]
SOURCE_KEYS = ("urdf", "xacro", "mjcf", "sdf", "srdf")  # keys of `robot:` that hold a path


@dataclass(frozen=True)
class Imported:
    """Files to write, and notes on what they leave out."""

    files: dict[Path, bytes] = field(default_factory=dict[Path, bytes])
    notes: list[Note] = field(default_factory=list[Note])


def import_moveit(
    paths: Sequence[Path],
    robot: RobotSource,
    folder: Path,
    on_progress: OnProgress = lambda *_: None,
) -> Imported:
    """World files of scenes, and a scenario for each request.

    A request belongs to the scene whose name ends in the same number, or to the only scene.

    Args:
        paths: PlanningScene and MotionPlanRequest files.
        robot: The robot that they are about.
        folder: Where the files will be.
        on_progress: Is called with a stage, the number of files that are done, and of all.

    Raises:
        SpecError: A file has mistakes, or names joints that the robot does not have; of all files.
        RobotError: The robot cannot be used.
    """
    words = robot.words()
    description = load_robot(RobotSpec.of_options(words))
    given = [Path(each) for each in robot.packages]
    found, problems = Imported(), list[Problem]()
    all_scenes: dict[Path, MoveItScene] = {}
    all_requests: dict[Path, MoveItRequest] = {}
    for done, path in enumerate(paths):
        on_progress("reading", done, len(paths))
        try:
            content = read_data(path, (*scenes.KEYS, *requests.KEYS), "MoveIt message").mapping()
            if any(key in content for key in scenes.KEYS):
                around = PackagePath.of_file(path, given)
                all_scenes[path] = read_scene(path, {description.base_link}, around)
            else:
                all_requests[path] = read_request(path)
        except SpecError as error:
            problems += error.problems
    for path, scene in all_scenes.items():
        _add_world(found, path, scene, folder)
    for done, (path, request) in enumerate(all_requests.items()):
        on_progress("converting", done, len(all_requests))
        scene_path = _scene_of(path, list(all_scenes))
        scene = None if scene_path is None else all_scenes[scene_path]
        try:
            start = _start(request.start or ({} if scene is None else scene.start), description)
        except SpecError as error:
            problems += error.problems
            continue
        content = _scenario(path, request, scene_path, scene, description)
        content["robot"] = _robot_words(words, folder, request, start)
        found.files[folder / f"{path.stem}.scenario.yaml"] = _text(content, path)
        found.notes.extend(request.notes)
    if problems:
        raise SpecError(problems)
    return found


def _add_world(found: Imported, path: Path, scene: MoveItScene, folder: Path) -> None:
    text = world_text(scene.world, folder, f"From {path.name}")
    found.files[folder / f"{path.stem}.world.yaml"] = text.encode()
    found.files.update({folder / name: stl_bytes(mesh) for name, mesh in scene.meshes.items()})
    found.notes.extend(scene.notes)


def _scene_of(request: Path, all_scenes: Sequence[Path]) -> Path | None:
    """The scene of a request: of the same number in the same folder, else the only one."""
    number = re.findall(r"\d+", request.stem)[-1:]
    for scene in all_scenes:
        if number and re.findall(r"\d+", scene.stem)[-1:] == number:
            return scene
    return all_scenes[0] if len(all_scenes) == 1 else None


def _start(
    positions: Mapping[str, tuple[float, Located]], description: RobotDescription
) -> dict[str, float]:
    """Positions of the joints that move by themselves; those of fixed ones are left out."""
    start: dict[str, float] = {}
    for name, (value, place) in positions.items():
        joint = description.joint_by_name.get(name)
        if joint is None:
            known = ", ".join(description.joint_names)
            message = f"'{description.name}' has no joint '{name}'"
            raise SpecError([place.place.problem(message, f"joints: {known}")])
        if joint.is_movable and joint.mimic is None:
            start[name] = value
    return start


def _scenario(
    path: Path,
    request: MoveItRequest,
    scene_path: Path | None,
    scene: MoveItScene | None,
    description: RobotDescription,
) -> dict[str, Any]:
    goal = dict(request.goals[0])
    if len(request.goals) > 1:
        goal = {"any_of": [dict(each) for each in request.goals]}
    step: dict[str, Any] = {"move_to": goal, "id": "motion"}
    if request.group:
        step["group"] = request.group
    pairs = [] if scene is None else _further_pairs(scene, description)
    content: dict[str, Any] = {"scenario": path.stem, "robot": {}}
    if scene_path is not None:
        content["world"] = f"{scene_path.stem}.world.yaml"
    if request.planning:
        content["planning"] = request.planning
    steps = [{"allow_collisions": {"pairs": pairs, "during": [step]}}] if pairs else [step]
    expectation: dict[str, Any] = {"never": "collision"}
    if pairs:
        expectation = {"always": "within_limits"}
    return {**content, "steps": steps, "expect": [expectation]}


def _further_pairs(scene: MoveItScene, description: RobotDescription) -> list[list[str]]:
    """Pairs that the scene lets touch and the robot's SRDF does not, of bodies that there are."""
    objects = {obj.name for obj in scene.world.objects}
    known = objects | {link.name for link in description.links if link.collisions}
    return [
        list(pair)
        for pair in sorted(scene.allowed)
        if set(pair) <= known
        and not set(pair) <= objects
        and pair not in description.allowed_collisions
    ]


def _robot_words(
    words: Mapping[str, Any], folder: Path, request: MoveItRequest, start: Mapping[str, float]
) -> dict[str, Any]:
    def named(value: str) -> str:
        is_file = not value.startswith("package://") and Path(value).exists()
        return Path(os.path.relpath(value, folder)).as_posix() if is_file else value

    robot: dict[str, Any] = {}
    for key, value in words.items():
        if key == "packages":
            robot[key] = [named(each) for each in value]
        else:
            robot[key] = named(value) if key in SOURCE_KEYS else value
    if request.group and "model" not in robot:
        robot.setdefault("group", request.group)
    if start:
        robot["start_state"] = {"joints": dict(start)}
    return robot


def _text(content: dict[str, Any], path: Path) -> bytes:
    plain = located(content, Place(Source("")))
    return f"# From {path.name}\n{yaml_text(plain, block_keys=('steps', 'expect'))}".encode()
