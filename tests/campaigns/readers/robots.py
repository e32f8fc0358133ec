"""Readers of robots: robot.yaml, URDF, SRDF, xacro, MJCF, SDF, joint limits and meshes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import count
from pathlib import Path

from harness.core.errors import HarnessError
from harness.core.resources import data_folder
from tests.campaigns import mutation
from tests.campaigns.mutation import Random
from tests.campaigns.reader import Read, Reader, bundled, of_data, put, text_of


def _robot_yaml(folder: Path) -> Read:
    import shutil

    from harness.language.scenario import RobotSpec
    from harness.robot.load import load_robot

    robots = data_folder("robots")
    for name in ("open_manipulator_x", "rh_p12_rn_a"):
        shutil.copytree(robots / name, folder / name, dirs_exist_ok=True)

    def read(folder: Path, data: bytes) -> None:
        name = "rh_p12_rn_a" if b"rh_p12" in data else "open_manipulator_x"
        put(folder / name, "robot.yaml", data)
        words = (
            {"model": "ur3e", "gripper": f"./{name}"} if name[0] == "r" else {"model": f"./{name}"}
        )
        load_robot(RobotSpec.model_validate(words), folder)

    return read


def _arm(changed: str, **words: str) -> Callable[[Path], Read]:
    """An arm of a URDF and an SRDF with one changed file."""

    def begin(_: Path) -> Read:
        from tests.robot.arm_files import load_arm, write_arm

        def read(folder: Path, data: bytes) -> None:
            write_arm(folder)
            put(folder, changed, data)
            load_arm(folder, **words)

        return read

    return begin


def _urdfs(folder: Path) -> list[bytes]:
    from tests.robot.arm_files import URDF

    del folder
    return [URDF.encode(), *bundled("robots", "*.urdf")]


def _srdfs(folder: Path) -> list[bytes]:
    from tests.robot.arm_files import SRDF

    del folder
    return [SRDF.encode()] * 2 + bundled("robots", "*.srdf")


def _xacros(folder: Path) -> list[bytes]:
    from tests.robot.test_xacro import ARM, LIMB

    del folder
    inline = ARM.replace(ARM[ARM.index("  <xacro:include") : ARM.index('  <link name="base')], "")
    macro = LIMB[LIMB.index("  <xacro:macro") : LIMB.index("</robot>")]
    whole = inline.replace('  <link name="base', f'{macro}  <link name="base', 1)
    more = """  <xacro:property name="length_of" value="$(arg length)"/>
  <xacro:property name="a" value="${pi / 2}"/>
  <xacro:property name="b" value="${[1, 2.5, 'x'] + list(range(3))}"/>
  <xacro:if value="${a > 1 and len(b) == 6}">
    <xacro:property name="c" value="${dict(d=1)}"/>
  </xacro:if>
  <xacro:unless value="${length_of == 0.2}">
    <link name="${'-'.join(b[2:3])}_${c['d']}"/>
  </xacro:unless>
"""
    return [whole.encode(), whole.replace("  <xacro:limb", f"{more}  <xacro:limb", 1).encode()]


def _sdfs(folder: Path) -> list[bytes]:
    from tests.robot.sdf_format_rows import FOLLOWS, SDF

    del folder
    frame = "<frame name='tool' attached_to='wrist'/></model>"
    more = SDF.replace("</model>", frame).replace(
        "<xyz>0 -1 0</xyz>", f"<xyz>0 -1 0</xyz>{FOLLOWS}"
    )
    return [SDF.encode(), more.encode()]


def _begin_sdf(_: Path) -> Read:
    from harness.language.scenario import RobotSpec
    from harness.robot.load import load_robot

    def read(folder: Path, data: bytes) -> None:
        put(folder, "arm.sdf", data)
        load_robot(RobotSpec.model_validate({"sdf": "arm.sdf"}), folder)

    return read


def _mjcfs(folder: Path) -> list[bytes]:
    from tests.robot.mjcf_arm import MJCF

    del folder
    return [MJCF.encode()]


def _begin_mjcf(folder: Path) -> Read:
    from harness.language.scenario import RobotSpec
    from harness.robot.load import load_robot
    from tests.robot.mjcf_arm import TIP

    (folder / "assets").mkdir(exist_ok=True)
    put(folder / "assets", "t.obj", TIP.encode())

    def read(folder: Path, data: bytes) -> None:
        put(folder, "arm.xml", data)
        load_robot(RobotSpec.model_validate({"mjcf": "arm.xml"}), folder)

    return read


JOINT_LIMITS = b"""\
default_velocity_scaling_factor: 0.1
joint_limits:
  turn: {has_velocity_limits: true, max_velocity: 1.5, max_acceleration: 4.0}
  bend: {has_position_limits: true, min_position: -1.5, max_position: !degrees 80.0}
  reach: {has_effort_limits: true, max_effort: 20, has_jerk_limits: false}
"""


def _begin_joint_limits(folder: Path) -> Read:
    from tests.robot.arm_files import load_arm, write_arm

    write_arm(folder)

    def read(folder: Path, data: bytes) -> None:
        put(folder, "joint_limits.yaml", data)
        load_arm(folder, moveit={"joint_limits": "joint_limits.yaml"})

    return read


MESHES = ("stl", "obj", "dae", "ply", "glb")


def _meshes(folder: Path) -> list[bytes]:
    import trimesh

    del folder
    solids = (trimesh.creation.box((0.1, 0.2, 0.3)), trimesh.creation.icosphere(1, 0.1))
    found: list[bytes] = []
    for kind in MESHES:
        for solid in solids:
            content = solid.export(file_type=kind)
            found.append(
                kind.encode() + b":" + (content if isinstance(content, bytes) else content.encode())
            )
    return found


def _mutated_mesh(corpus: Sequence[bytes], rng: Random) -> bytes:
    """A mesh with changed content; its kind stays."""
    kind, _, content = rng.choice(corpus).partition(b":")
    mutate = (
        mutation.of_text if kind in (b"obj", b"dae") and rng.random() < 0.7 else mutation.of_bytes
    )
    return kind + b":" + mutate([content], rng)


def _begin_mesh(folder: Path) -> Read:
    from harness.cameras.meshes import mesh_parts
    from harness.core.geometry import Mesh
    from harness.robot.mesh_file import convex_hull

    numbers = count()  # what was read of a path is kept as long as the process lives
    del folder

    def read(folder: Path, data: bytes) -> None:
        kind, _, content = data.partition(b":")
        path = put(folder, f"{next(numbers)}.{kind.decode()}", content)
        try:
            mesh_parts(Mesh(path, (1.0, 1.0, 1.0)))
            convex_hull(Mesh(path, (1.0, 1.0, 1.0), collision="hull"))
        finally:
            path.unlink()

    return read


EXPRESSIONS = (
    "pi / 2", "-radians(90) * 2.5", "[1, 2.5, 'x'] + list(range(3))", "dict(a=1, b=[1, 2])['b'][0]",
    "'%s_%d' % (text, x)", "x > 1 and not flag or y ** 2 == 6.25", "math.sqrt(x) if flag else 0",
    "text.split()[0:2]", "'{:.3f}'.format(y)", "[each * 2 for each in items if each > 1]",
    "table['far'][-1]", "python.sum(items) // 2 % 5", "'-'.join(['a', 'b'])", "sorted(items)",
)  # fmt: skip


def _begin_expressions(_: Path) -> Read:
    from harness.plugins.formats.xacro.expression import evaluate
    from harness.plugins.formats.xacro.values import Budget, Exhausted, ExpressionError
    from tests.robot.test_xacro_expressions import NAMES

    def read(_: Path, data: bytes) -> None:
        budget = Budget()
        budget.left = 20_000
        try:
            evaluate(text_of(data), NAMES, budget)
        except (ExpressionError, Exhausted) as error:
            raise HarnessError(str(error) or "no steps are left") from error

    return read


def _read_xml(data: bytes) -> None:
    from harness.language.files.xml_file import parse_xml

    parse_xml(data, "a.xml")


READERS: dict[str, Reader] = {
    "robot.yaml": Reader(lambda _: bundled("robots", "robot.yaml"), mutation.of_yaml, _robot_yaml),
    "urdf": Reader(_urdfs, mutation.of_xml, _arm("arm.urdf")),
    "srdf": Reader(_srdfs, mutation.of_xml, _arm("arm.srdf")),
    "xacro": Reader(
        _xacros, mutation.of_xml, _arm("arm.xacro", urdf=None, srdf=None, xacro="arm.xacro")
    ),
    "expression": Reader(
        lambda _: [text.encode() for text in EXPRESSIONS], mutation.of_text, _begin_expressions
    ),
    "robot in sdf": Reader(_sdfs, mutation.of_xml, _begin_sdf),
    "mjcf": Reader(_mjcfs, mutation.of_xml, _begin_mjcf),
    "xml": Reader(
        lambda folder: [*_urdfs(folder)[:1], *_srdfs(folder)[:1], *_xacros(folder)],
        mutation.of_text,
        of_data(_read_xml),
    ),
    "joint_limits": Reader(lambda _: [JOINT_LIMITS], mutation.of_text, _begin_joint_limits),
    "mesh": Reader(_meshes, _mutated_mesh, _begin_mesh, is_named=True),
}
