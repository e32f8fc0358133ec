"""Loads the robot of a scenario's `robot:`, by name, folder or file."""

from __future__ import annotations

import importlib.util
from collections import ChainMap
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from harness.core.errors import RobotError, RobotOptionError
from harness.core.files import is_dir
from harness.core.geometry import CollisionMode
from harness.core.inputs import is_there
from harness.core.limits import XML_FILE
from harness.core.registry import broken_plugins
from harness.core.resources import data_folder
from harness.core.suggestion import did_you_mean
from harness.language.files.xml_file import XmlElement, read_xml
from harness.language.files.yaml_file import read_text
from harness.language.scenario import RobotSpec, ScenarioContent
from harness.robot.bare_arm import without_gripper
from harness.robot.collision_shapes import with_collision_modes, with_collision_shapes
from harness.robot.compose import RobotPart, compose_robot
from harness.robot.decomposed_meshes import decompose_meshes, without_undrawable
from harness.robot.description import RobotDescription
from harness.robot.estimated_masses import with_estimated_masses
from harness.robot.find_file import find_folder
from harness.robot.folder_names import refuse_incomplete_states, unknown_names
from harness.robot.mechanism import Joint
from harness.robot.options import with_options
from harness.robot.packages import PackagePath
from harness.robot.robot_collection import collected_robots
from harness.robot.robot_format import FORMATS, render_xacro, robot_format
from harness.robot.robot_option import options_of, robot_option
from harness.robot.robot_yaml import RobotYaml, XacroFile, read_robot_yaml, robot_yaml_error
from harness.robot.srdf.read import read_srdf
from harness.robot.urdf.urdf import parse_urdf
from harness.robot.xacro_file import arguments_of

OF_FILES = ("srdf", "packages", "group", "tcp_link", "flange_link")


@lru_cache(maxsize=1)
def _catalogue() -> dict[str, tuple[Path, RobotYaml]]:
    """Every bundled model name (variants instead of families) with its folder and robot.yaml."""
    models: dict[str, tuple[Path, RobotYaml]] = {}
    for path in sorted(data_folder("robots").glob("*/robot.yaml")):
        facts = read_robot_yaml(path.parent)
        for name in facts.variants or (facts.robot,):
            models[name] = (path.parent, facts)
    return models


def robot_names() -> tuple[str, ...]:
    """Names of the robots that `model` accepts, grippers included: bundled, then installed ones."""
    return tuple(_every_model())


def _every_model() -> dict[str, tuple[Path, RobotYaml]]:
    """Bundled models, then those of installed collections, which cannot replace a bundled one."""
    bundled = _catalogue()
    return {**bundled, **{k: v for k, v in collected_robots().items() if k not in bundled}}


def read_bundled(names: Collection[str]) -> None:
    """Read bundled robots and grippers in advance, for this process and its forks."""
    for name in _catalogue():
        if name in names:
            _bundled(name, ())


def load_ahead(scenario: ScenarioContent) -> None:
    """Load robots without files of the user in advance, for this process and its forks.

    Raises:
        RobotError: An option does not fit the robot.
    """
    one = () if scenario.robot is None else (scenario.robot,)
    for spec in (*one, *(scenario.robots or {}).values()):
        if _is_bundled(spec):
            load_robot(spec, collision=scenario.collision)


def gripper_names() -> tuple[str, ...]:
    """Names of the grippers that `gripper` accepts: bundled, then installed ones."""
    return tuple(name for name, (_, facts) in _every_model().items() if facts.kind == "gripper")


def load_scenario_robot(scenario: ScenarioContent, base_dir: Path) -> RobotDescription:
    """The robot of a scenario: its `robot`, or the arms of its `robots` as one.

    Raises:
        RobotError: A robot is unknown, its files cannot be used, or an option does not fit it.
    """
    if scenario.robot is not None:
        return load_robot(scenario.robot, base_dir, scenario.collision)
    arms: dict[str, RobotDescription] = {}
    for name, spec in (scenario.robots or {}).items():
        try:
            arms[name] = load_robot(spec, base_dir, scenario.collision)
        except RobotOptionError as error:
            raise RobotOptionError(f"{name}.{error.key}", error.reason, "robots") from error
        except RobotError as error:
            raise RobotOptionError(name, str(error), "robots") from error
    return robot_option("robots").joined(arms)


def load_robot(
    spec: RobotSpec, base_dir: Path = Path(), collision: CollisionMode | None = None
) -> RobotDescription:
    """The robot of a scenario, composed and with its options applied.

    Args:
        collision: How meshes collide whose link the robot's `collision` does not have.

    Raises:
        RobotError: The robot is unknown, its files cannot be used, or an option does not fit it.
    """
    if _is_bundled(spec):
        return _loaded_once(_Bundled(spec.model_dump_json(), spec), collision)
    return _loaded(spec, base_dir, collision)


def _is_bundled(spec: RobotSpec) -> bool:
    """Whether a robot follows from its specification alone, without files of the user."""
    keys = (*FORMATS, "kinematics", "moveit", "args")
    files = any(getattr(spec, key) for key in keys)
    names = {name for name in (spec.model, spec.gripper) if name is not None}
    return not files and names <= _catalogue().keys()


@dataclass(frozen=True)
class _Bundled:
    text: str
    spec: RobotSpec = field(compare=False)


@lru_cache(maxsize=8)
def _loaded_once(bundled: _Bundled, collision: CollisionMode | None) -> RobotDescription:
    return _loaded(bundled.spec, Path(), collision)


def _loaded(spec: RobotSpec, base_dir: Path, collision: CollisionMode | None) -> RobotDescription:
    main, tool = _parts(spec, base_dir, collision)
    description = compose_robot(main, tool, spec.base.se3())
    known = frozenset[str]()
    for option in options_of(spec):
        description, stated = option.robot(description, spec, base_dir)
        known |= stated
    if spec.model is None and main is not None:
        description = robot_format(spec).with_options(description, spec, known)
    else:
        description = with_options(description, spec)
    links = spec.collision
    if not isinstance(links, str):
        own: dict[str, CollisionMode] = {}
        for part in filter(None, (main, tool)):
            own |= part.facts.collision
        links = own | (links or {})
    described = with_collision_modes(description.links, links, collision)
    elements = [part.urdf.mesh_elements for part in (main, tool) if part is not None]
    decompose_meshes(described, dict(ChainMap(*map(dict, elements))))
    return with_collision_shapes(without_undrawable(description), links, collision)


def _parts(
    spec: RobotSpec, base_dir: Path, collision: CollisionMode | None
) -> tuple[RobotPart | None, RobotPart | None]:
    """The arm, without the gripper that another one replaces, and the gripper.

    Raises:
        RobotError: One of them is unknown, or they do not fit each other.
    """
    if spec.base.frame != "world":
        raise RobotOptionError(
            "base", f"it is a pose in the frame 'world', not in '{spec.base.frame}'"
        )
    main, tool = _main(spec, base_dir, collision), None
    if spec.gripper is not None and not (main and _is_own(main, spec.gripper)):
        own = [group.name for group in main.srdf.groups] if main and spec.model is None else []
        tool = _part(spec.gripper, "gripper", {}, base_dir, own)
    if tool is not None and tool.facts.kind != "gripper":
        raise RobotOptionError(
            "gripper", f"'{spec.gripper}' is an arm; grippers: {', '.join(gripper_names())}"
        )
    if main is not None and main.facts.kind == "gripper":
        if tool is not None:
            raise RobotOptionError("model", f"'{spec.model}' is a gripper and carries no other one")
        main, tool = None, main
    if main is not None and tool is not None:
        main = without_gripper(main)
    for option in options_of(spec):
        main = option.part(main, spec, base_dir)
    return main, tool


def _main(spec: RobotSpec, base_dir: Path, collision: CollisionMode | None) -> RobotPart | None:
    """The arm, or a gripper without an arm; None when only `gripper` is given."""
    if any(getattr(spec, key) is not None for key in FORMATS):
        return robot_format(spec).read(spec, base_dir, collision)
    for key in OF_FILES:
        if getattr(spec, key):
            raise RobotOptionError(key, f"it requires a robot's file: {', '.join(FORMATS)}")
    return None if spec.model is None else _part(spec.model, "model", spec.args, base_dir)


def _is_own(main: RobotPart, gripper: str) -> bool:
    """Whether a name is that of an imported arm's integrated gripper."""
    return main.facts.gripper is not None and main.srdf.has_gripper(gripper)


def _part(
    name: str, key: str, args: Mapping[str, Any], base_dir: Path, own: Sequence[str] = ()
) -> RobotPart:
    """A bundled robot or gripper, or the one in a folder.

    Args:
        key: The key of `robot` that states it, for messages.
    """
    if name in _catalogue():
        return _bundled(name, tuple(sorted((k, str(v)) for k, v in args.items())))
    folder = base_dir / name
    if is_there(folder / "robot.yaml"):
        return _read(folder, read_robot_yaml(folder), "", args)
    if name in collected_robots():
        folder, facts = collected_robots()[name]
        return _read(folder, facts, name if facts.variants else "", args)
    if key == "gripper":
        kinds = "grippers and groups" if own else "grippers"
        known = did_you_mean(name, [*gripper_names(), *own], kinds)
    else:
        known = did_you_mean(name, robot_names(), "robots")
    kind = suffix if (suffix := folder.suffix[1:]) in FORMATS else "urdf"
    own = f"a robot of your own is named by its file: `robot: {{{kind}: FILE}}`"
    hints = [known, *[own] * (key == "model"), *broken_plugins()]
    if "/" in name or name.startswith(".") or is_dir(folder):
        hints.insert(0, f"{folder} has no robot.yaml")
    raise RobotOptionError(key, f"'{name}' is not known; {'; '.join(hints)}")


@lru_cache(maxsize=32)
def _bundled(name: str, args: tuple[tuple[str, str], ...]) -> RobotPart:
    folder, facts = _catalogue()[name]
    return _read(folder, facts, name if facts.variants else "", dict(args))


def _read(folder: Path, facts: RobotYaml, variant: str, args: Mapping[str, Any]) -> RobotPart:
    """URDF and SRDF of a folder, with the limits of its robot.yaml."""
    name = variant or facts.robot
    if facts.xacro is not None:
        path = folder / facts.xacro.file
        document = _rendered(path, facts.xacro, variant, args)
    else:
        path = folder / (facts.urdf or "")
        document = _text(path)
        if args:
            raise RobotOptionError("args", f"'{name}' is not a xacro file and takes no arguments")
    packages = PackagePath.of_file(path, [find_folder(each, folder) for each in facts.packages])
    urdf = parse_urdf(document, folder, str(path), packages)
    urdf = replace(urdf, joints=tuple(_with_facts(joint, facts) for joint in urdf.joints))
    srdf_path = folder / facts.srdf
    around = PackagePath.of_file(srdf_path, packages.given)
    srdf = read_srdf(srdf_path, _text(srdf_path), args, around)
    unknown = [*unknown_names(facts, urdf, srdf)]
    if unknown:
        raise robot_yaml_error(folder, unknown)
    refuse_incomplete_states(srdf, urdf, facts)
    urdf = with_estimated_masses(urdf)
    notes = (*urdf.notes, *srdf.notes)
    return RobotPart(name, facts, urdf, srdf, str(folder), notes)


def _text(path: Path) -> str:
    return read_text(path, kind="robot description", largest=XML_FILE)


def _rendered(
    path: Path, xacro_file: XacroFile, variant: str, args: Mapping[str, Any]
) -> XmlElement:
    """The URDF of a xacro file."""
    declared = arguments_of(read_xml(path))
    for key in args:
        if key not in declared or key == xacro_file.variant_arg:
            known = ", ".join(sorted(filter(None, declared - {xacro_file.variant_arg})))
            raise RobotOptionError(
                "args", f"{path.name} takes no argument '{key}'; known are {known}"
            )
    mappings = dict(args)
    if xacro_file.variant_arg and variant:
        mappings[xacro_file.variant_arg] = variant
    if xacro_file.mesh_arg and xacro_file.mesh_arg not in mappings:
        has_meshes = variant in xacro_file.mesh_variants and (
            importlib.util.find_spec(xacro_file.mesh_package or "") is not None
        )
        mappings[xacro_file.mesh_arg] = str(has_meshes).lower()
    return render_xacro(path, mappings, PackagePath.of_file(path))


def _with_facts(joint: Joint, facts: RobotYaml) -> Joint:
    """A joint with the limits of robot.yaml."""
    if not joint.is_movable:
        return joint
    known = facts.joints.get(joint.name)
    joint = replace(joint, acceleration=facts.max_acceleration, effort_source=facts.effort_source)
    if known is None:
        return joint
    return replace(
        joint,
        velocity=known.max_velocity or joint.velocity,
        acceleration=known.max_acceleration or joint.acceleration,
        effort=known.max_effort or joint.effort,
        effort_source=known.effort_source or joint.effort_source,
    )
