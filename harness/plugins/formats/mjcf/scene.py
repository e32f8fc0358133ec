"""Imports MJCF scenes: bodies without joints and free bodies become objects."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import ValidationError

from harness.core.spatial import SE3
from harness.language.files.xml_file import XmlElement
from harness.language.world import LightSpec, ObjectSpec, PartKey, PhysicsSpec, WorldSpec
from harness.plugins.formats.fixture_words import PartJoint, on_fixture, part_model
from harness.plugins.formats.mjcf.elements import Elements
from harness.plugins.formats.mjcf.shapes import GeomReader
from harness.plugins.formats.mjcf_robot.compiled import compile_mjcf, driven_trees
from harness.plugins.formats.mjcf_robot.files import read_tree
from harness.plugins.formats.mjcf_robot.joints import mjcf_pose
from harness.plugins.formats.mjcf_robot.mjcf import UNNAMED
from harness.plugins.formats.notes import Notes
from harness.plugins.formats.object_words import MassProperties, look_words, mass_words, together
from harness.plugins.formats.plain_values import first_mistake, pose_spec, rounded
from harness.plugins.formats.sdf.values import validated
from harness.plugins.formats.sdf.world import LONGEST_STEP, SHORTEST_STEP
from harness.robot.packages import PackagePath
from harness.robot.tree import free_name
from harness.world.imported import ImportedWorld

LONGEST_NAME = 100
KINDS: dict[int, Literal["hinge", "slide"]] = {2: "slide", 3: "hinge"}  # of mjtJoint


class _Folders(PackagePath):
    """The folders that a scene may read."""

    def outside(self, name: str, path: Path) -> str:
        return (
            f"'{name}' lies outside the scene's folder {self.home}; if it may be read, add "
            f"{path.parent} to `model_path` of `world:`, or to --model-path of `harness import`"
        )


def load_mjcf(path: Path, folders: Sequence[Path] = ()) -> ImportedWorld:
    """The world of an MJCF scene, as MuJoCo compiles it.

    Args:
        folders: Folders that may be read besides the file's.

    Raises:
        SpecError: A file cannot be read, MuJoCo refuses it, or a geom that touches is not
            supported; at line and column where known.
    """
    packages = _Folders.of_file(path, folders)
    roots = read_tree(path, packages)
    unread: list[str] = []
    spec, model = compile_mjcf(path, roots, packages, unread)
    elements, notes = Elements(roots), Notes()
    for text in unread:
        notes.add(elements.root.place, text)
    elements.note_unread(notes)
    title = model.names.split(b"\0")[0].decode()
    scene = _Scene.of(GeomReader(spec, model, path.parent, elements, notes))
    world = WorldSpec(
        world=(path.stem if title in ("", UNNAMED) else title)[:100],
        objects=tuple(scene.objects()),
        lights=tuple(scene.lights()),
        physics=scene.physics(),
    )
    return ImportedWorld(world, path, notes.all())


@dataclass(eq=False)
class _Scene:
    """Converts a compiled scene.

    Attributes:
        data: The scene at the positions of its file.
        bodies: The bodies of the MjSpec, by their numbers.
        names: Names of the bodies, by their numbers.
        touching: The geoms of objects that can be in contact.
    """

    reader: GeomReader
    data: Any
    bodies: Mapping[int, Any]
    names: dict[int, str]
    touching: list[int] = field(default_factory=list[int])

    @classmethod
    def of(cls, reader: GeomReader) -> _Scene:
        import mujoco

        data = mujoco.MjData(reader.model)
        for stage in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_camlight):
            stage(reader.model, data)
        bodies = {body.id: body for body in reader.spec.bodies}
        names = {number: body.name for number, body in bodies.items() if body.name}
        for number in bodies.keys() - names.keys():
            names[number] = free_name(f"body_{number}", names.values())
        return cls(reader, data, bodies, names)

    def objects(self) -> list[ObjectSpec]:
        """The objects: geoms of the world body, bodies without joints, free bodies."""
        reader, model = self.reader, self.reader.model
        found: list[ObjectSpec | None] = []
        taken = set(self.names.values())
        for geom in self._geoms([0]):
            pose, element = reader.pose(geom), reader.element(geom)
            given = reader.name(geom)
            name = free_name(given or reader.kind(geom), taken)
            taken.add(name)
            if given and name != given:
                message = f"the geom '{given}' is called '{name}' here: a body has its name"
                reader.notes.add(element.place, message)
            found.append(self._object(name, element, pose, [(geom, pose.inverse())], {}))
        left_out = self._left_out()
        for body in range(1, model.nbody):
            root = int(model.body_weldid[body])
            if root in (0, body) and body not in left_out:
                fixed = np.flatnonzero(model.body_weldid == body) if root else [body]
                welded = [int(each) for each in fixed]
                found.append(self._body(body, welded, is_static=root == 0))
        objects = self._with_parts([item for item in found if item is not None])
        if len({tuple(model.geom_friction[geom]) for geom in self.touching}) > 1:
            message = "a contact takes the smaller friction of its two geoms, not the larger"
            reader.notes.add(reader.elements.root.place, message)
        return objects

    def _body(self, body: int, welded: Sequence[int], *, is_static: bool) -> ObjectSpec | None:
        """A body, with those that are fixed to it, as an object."""
        model, notes, element = self.reader.model, self.reader.notes, self._element(body)
        name = self.names[body]
        if model.body_mocapid[body] >= 0:
            notes.add(element.place, "a mocap body is fixed where the file puts it")
        on_object = {each: self._pose(body).inverse() @ self._pose(each) for each in welded}
        parts = [(geom, on_object[int(model.geom_bodyid[geom])]) for geom in self._geoms(welded)]
        if not parts:
            if not is_static:
                notes.add(element.place, f"the free body '{name}' is left out: it has no geoms")
            return None
        if is_static:
            return self._object(name, element, self._pose(body), parts, {})
        if model.body_gravcomp[welded].any():
            notes.add(element.place, "gravcomp is left out: gravity acts on all objects")
        whole = together([self._mass(each).placed(on_object[each]) for each in welded])
        return self._object(name, element, self._pose(body), parts, mass_words(whole))

    def _object(
        self,
        name: str,
        element: XmlElement,
        pose: SE3,
        parts: Sequence[tuple[int, SE3]],
        mass: dict[str, Any],
    ) -> ObjectSpec | None:
        """An object of geoms, each with the pose of its body on the object; static without mass."""
        reader = self.reader
        if len(name) > LONGEST_NAME:
            element.refuse(f"the name '{name}' has more than {LONGEST_NAME} characters")
        try:
            shapes = {geom: reader.shape(geom, placed) for geom, placed in parts}
            at = pose_spec(pose)
        except ValidationError as error:  # of a pose
            element.refuse(f"'{name}': {first_mistake(error)}")
        self.touching += [geom for geom, _ in parts if reader.touches(geom)]
        touching = [s for geom, s in shapes.items() if s is not None and reader.touches(geom)]
        drawn = [s for geom, s in shapes.items() if s is not None and reader.is_drawn(geom)]
        if not touching and not drawn:
            reader.notes.add(element.place, f"'{name}' is left out: nothing of it touches or shows")
            return None
        looks = [shape.model_copy(update={"friction": None}) for shape in drawn]
        words = {"name": name, "pose": at, **(mass or {"static": True})}
        words |= self._surface(
            [part for part in parts if reader.touches(part[0])], name, element, mass
        )
        return validated(ObjectSpec, {**words, **look_words(touching, looks)}, element)

    def _surface(
        self,
        parts: Sequence[tuple[int, SE3]],
        name: str,
        element: XmlElement,
        mass: Mapping[str, Any],
    ) -> dict[str, Any]:
        """The motion of an object's surface, which all of its geoms have, in words of a file."""
        model = self.reader.model
        motions = np.zeros((len(parts), 6))
        for row, (geom, placed) in enumerate(parts):
            on_object = placed @ mjcf_pose(model.geom_pos[geom], model.geom_quat[geom])
            turning = on_object.rotation @ model.geom_surfacevel[geom, 3:]
            along = on_object.rotation @ model.geom_surfacevel[geom, :3]
            motions[row] = [*(along - np.cross(turning, on_object.translation)), *turning]
        if not motions.any():
            return {}
        why = ""
        if mass:
            why = "surfaces of objects that stand still move, and this one does not"
        elif not np.allclose(motions, motions[0]):
            why = "all surfaces of an object have one motion"
        elif np.abs(motions[0, 3:5]).max() > 1e-9:
            why = "surfaces turn about the object's z axis"
        if why:
            self.reader.notes.add(element.place, f"surfacevel of '{name}' is left out: {why}")
            return {}
        velocity, turn = tuple(rounded(each) for each in motions[0, :3]), rounded(motions[0, 5])
        words: dict[str, Any] = {"surface_velocity": velocity} if any(velocity) else {}
        return words | ({"surface_rotation": turn} if turn else {})

    def _left_out(self) -> set[int]:
        """Bodies that are no rigid objects, and the bases of robots; with notes."""
        model = self.reader.model
        driven, left_out = driven_trees(model), set[int]()
        joint_trees = [int(model.body_rootid[body]) for body in model.jnt_bodyid]
        bases = {
            int(model.body_parentid[body])
            for body in model.jnt_bodyid
            if int(model.body_rootid[body]) in driven
        } - {0}
        robots = set[int]()
        for body in range(1, model.nbody):  # parents come first
            tree, parent = int(model.body_rootid[body]), int(model.body_parentid[body])
            is_jointed = model.body_jntnum[body] > 0
            is_free = is_jointed and int(model.jnt_type[model.body_jntadr[body]]) == 0
            is_object = is_free and joint_trees.count(tree) == 1 and tree not in driven
            if parent in left_out or body in bases or (is_jointed and not is_object):
                left_out.add(body)
                if self._is_part(body, driven):
                    continue
                if tree not in driven and parent not in left_out:
                    why = "objects are rigid, and it has joints or carries bodies with joints"
                    self._note(body, why)
                elif tree in driven and tree not in robots:
                    robots.add(tree)
                    self._note(body, "a robot is read with `robot: {mjcf: FILE}`")
        return left_out

    def _is_part(self, body: int, driven: Collection[int]) -> bool:
        """Whether a body turns or slides on what stands still, and nothing drives it."""
        model = self.reader.model
        if int(model.body_jntnum[body]) != 1 or int(model.body_rootid[body]) in driven:
            return False
        kind = int(model.jnt_type[model.body_jntadr[body]])
        return kind in KINDS and int(model.body_weldid[model.body_parentid[body]]) == 0

    def _with_parts(self, objects: Sequence[ObjectSpec]) -> list[ObjectSpec]:
        """The objects, with the bodies on hinges and slides as the joints of what carries them."""
        model, driven = self.reader.model, driven_trees(self.reader.model)
        whole = {item.name: item for item in objects}
        for body in range(1, model.nbody):
            if not self._is_part(body, driven):
                continue
            parent = int(model.body_parentid[body])
            fixture = self.names[parent] if parent and self.names[parent] in whole else ""
            base = self._pose(parent if fixture else body)
            joint = self._part(body, base)
            if joint is None:
                continue
            name = fixture or self.names[body]
            words: dict[str, Any] = {"name": name, "pose": pose_spec(base), "static": True}
            item = whole.get(name) or ObjectSpec.model_construct(**words)
            update = {"joints": (*item.joints, joint)}
            whole[name] = item.model_copy(update=update)
        return list(whole.values())

    def _part(self, body: int, base: SE3) -> PartKey | None:
        """A body and what it carries as a part on its joint; None where nothing of it touches."""
        model, reader, element = self.reader.model, self.reader, self._element(body)
        carried = [each for each in range(body, model.nbody) if self._is_below(each, body)]
        for each in carried[1:]:
            if model.body_jntnum[each]:
                message = f"the body '{self.names[each]}' is held where the file puts it"
                reader.notes.add(self._element(each).place, f"{message}: a part has one joint")
        on_base = {each: base.inverse() @ self._pose(each) for each in carried}
        geoms = self._geoms(carried)
        shapes = {geom: reader.shape(geom, on_base[int(model.geom_bodyid[geom])]) for geom in geoms}
        touching = [s for geom, s in shapes.items() if s is not None and reader.touches(geom)]
        drawn = [s for geom, s in shapes.items() if s is not None and reader.is_drawn(geom)]
        if not touching:
            self._note(body, "nothing of it touches")
            return None
        self.touching += [geom for geom in geoms if reader.touches(geom)]
        joint = self._joint(body, on_base[body])
        if joint.limits != joint.usable_limits:
            lower, upper = joint.usable_limits
            unit = "rad" if joint.kind == "hinge" else "m"
            text = (
                f"the joint '{joint.name}' turns or slides from {lower:g} to {upper:g} {unit} here"
            )
            reader.notes.add(element.place, text)
        mass = together([self._mass(each).placed(on_base[each]) for each in carried])
        looks = [shape.model_copy(update={"friction": None}) for shape in drawn]
        same = len(looks) == len(touching) and looks == touching
        return validated(part_model(), joint.words(touching, [] if same else looks, mass), element)

    def _is_below(self, body: int, top: int) -> bool:
        while body > top:
            body = int(self.reader.model.body_parentid[body])
        return body == top

    def _joint(self, body: int, on_base: SE3) -> PartJoint:
        model = self.reader.model
        number = int(model.body_jntadr[body])
        place, dof = int(model.jnt_qposadr[number]), int(model.jnt_dofadr[number])
        axis, point = on_fixture(on_base, model.jnt_axis[number], model.jnt_pos[number])
        zero, endless = float(model.qpos0[place]), not model.jnt_limited[number]
        lower, upper = (-np.inf, np.inf) if endless else model.jnt_range[number] - zero
        return PartJoint(
            name=self.reader.model.joint(number).name or "joint",
            kind=KINDS[int(model.jnt_type[number])],
            axis=axis,
            point=point,
            limits=(float(lower), float(upper)),
            friction=float(model.dof_frictionloss[dof]),
            damping=float(np.ravel(model.dof_damping[dof])[0]),
            stiffness=float(np.ravel(model.jnt_stiffness[number])[0]),
            rest=float(model.qpos_spring[place]) - zero,
        )

    def _note(self, body: int, why: str) -> None:
        message = f"the body '{self.names[body]}' and what it carries are left out: {why}"
        self.reader.notes.add(self._element(body).place, message)

    def _geoms(self, bodies: Sequence[int]) -> list[int]:
        return [
            int(geom) for geom in np.flatnonzero(np.isin(self.reader.model.geom_bodyid, bodies))
        ]

    def _element(self, body: int) -> XmlElement:
        return self.reader.elements.of(self.bodies[body], "body")

    def _pose(self, body: int) -> SE3:
        return mjcf_pose(self.data.xpos[body], self.data.xquat[body])

    def _mass(self, body: int) -> MassProperties:
        model = self.reader.model
        tensor = np.diag(model.body_inertia[body])
        pose = mjcf_pose(model.body_ipos[body], model.body_iquat[body])
        return MassProperties(float(model.body_mass[body]), np.zeros(3), tensor).placed(pose)

    def lights(self) -> list[LightSpec]:
        """The directional lights that stand still."""
        reader, model, found = self.reader, self.reader.model, list[LightSpec]()
        for light in reader.spec.lights:
            number = light.id
            element = reader.elements.of(light, "light")
            is_still = int(model.body_weldid[model.light_bodyid[number]]) == 0
            if int(model.light_type[number]) != 1 or not is_still:
                reader.notes.add(element.place, "a light is left out: worlds have directional ones")
            elif model.light_active[number]:
                x, y, z = (rounded(value) for value in self.data.light_xdir[number])
                red, green, blue = (
                    round(float(v), 6) for v in model.light_diffuse[number].clip(0, 1)
                )
                words = {"direction": (x, y, z), "diffuse": (red, green, blue, 1.0)}
                words |= {"casts_shadow": bool(model.light_castshadow[number])}
                found.append(validated(LightSpec, words, element))
        return found

    def physics(self) -> PhysicsSpec:
        """Gravity and time step."""
        import mujoco

        option, root = self.reader.model.opt, self.reader.elements.root
        is_off = option.disableflags & int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
        x, y, z = (0.0, 0.0, 0.0) if is_off else (rounded(part) for part in option.gravity)
        words: dict[str, Any] = {"gravity": (x, y, z)}
        step = rounded(option.timestep)
        if SHORTEST_STEP <= step <= LONGEST_STEP:
            words["timestep"] = step
        else:
            supported = f"{SHORTEST_STEP:g} to {LONGEST_STEP:g} s are supported"
            taken = PhysicsSpec().timestep
            message = f"a step of {step:g} s is taken as {taken:g} s: {supported}"
            self.reader.notes.add(root.place, message)
        return validated(PhysicsSpec, words, root)
