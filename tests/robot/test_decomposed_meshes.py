"""Mistakes are reported before meshes are cut, hulls are not cut, and long work is reported."""

from functools import partial

import pytest

from harness.cli.main import main
from harness.core.errors import RobotError, SpecError
from harness.core.slow_work import reported, reported_to
from harness.robot.collision_shapes import mesh_shapes
from harness.robot.decomposed_meshes import decompose_meshes
from tests.robot.arm_files import INERTIAL, SHAPE, SRDF, URDF, load_arm, write_arm
from tests.robot.vessels import vessel, write_obj
from tests.waiting import wait_for

MESH = '<collision><geometry><mesh filename="bin.obj"/></geometry></collision>'
HOLLOW = URDF.replace(SHAPE, MESH)


@pytest.fixture(autouse=True)
def cut(tmp_path, monkeypatch):
    """Says whether a mesh was cut into parts, or its hull was computed."""
    cache = tmp_path / "cache"
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache))
    write_obj(tmp_path / "bin.obj", *vessel(4, 0.1, 0.09, 0.1, 0.01))
    return lambda kind="parts": list(cache.glob(f"armharness/convex_{kind}/*"))


LIMITS = "joint_limits:\n  bond:\n    has_velocity_limits: true\n    max_velocity: 1\n"


@pytest.mark.parametrize(
    ("urdf", "srdf", "options", "message"),
    [
        (HOLLOW.replace('upper="0.2"', 'upper="wide"'), SRDF, {}, "is not a finite number"),
        (HOLLOW, SRDF.replace('tip_link="tool"', 'tip_link="tol"'), {}, "no chain leads from"),
        (HOLLOW, SRDF.replace('name="bend"', 'name="bond"'), {}, "unknown joint 'bond'"),
        (HOLLOW, SRDF, {"tcp_link": "tol"}, "the robot has no link 'tol'"),
        (HOLLOW, SRDF, {"moveit": {"joint_limits": "limits.yaml"}}, "bond"),
    ],
)
def test_what_needs_no_shapes_is_checked_before_a_mesh_is_read(
    tmp_path, cut, urdf, srdf, options, message
):
    (tmp_path / "limits.yaml").write_text(LIMITS)
    write_arm(tmp_path, urdf, srdf)
    with pytest.raises((SpecError, RobotError), match=message):
        load_arm(tmp_path, **options)
    assert not cut()
    assert not cut("hulls")


@pytest.mark.nightly
def test_a_mesh_that_collides_as_its_hull_is_not_cut(tmp_path, cut):
    write_arm(tmp_path, HOLLOW)
    arm = load_arm(tmp_path, collision="hull")
    assert cut("hulls")
    assert not cut()
    found = mesh_shapes({link.name: link.collisions for link in arm.links})
    assert {each.parts for each in found} == {1}
    assert all(each.excess > 0.02 for each in found), "the inside of the bin"
    load_arm(tmp_path)
    assert cut(), "by default it is"


@pytest.mark.nightly
def test_only_the_links_that_collide_as_hulls_are_spared(tmp_path, cut):
    write_arm(tmp_path, HOLLOW)
    arm = load_arm(tmp_path, collision={"upper": "hull"})
    assert cut()
    parts = {link.name: len(link.collisions) for link in arm.links}
    assert parts["upper"] == 1 < parts["lower"]


def test_a_mesh_that_is_only_seen_is_not_cut_for_its_mass(tmp_path, cut):
    seen = MESH.replace("collision", "visual")
    write_arm(tmp_path, HOLLOW.replace(INERTIAL, "").replace(MESH, seen))
    load_arm(tmp_path)
    assert cut("hulls")
    assert not cut()


def test_a_damaged_mesh_is_reported_at_its_element_after_the_rest(tmp_path):
    (tmp_path / "bin.obj").write_text("v 0 0 0")
    write_arm(tmp_path, HOLLOW)
    with pytest.raises(SpecError, match=r"link 'upper': mesh bin\.obj has no triangles") as caught:
        load_arm(tmp_path)
    assert caught.value.problems[0].line == 4


def test_work_that_takes_long_is_reported_on_stderr(capfd):
    said = ""

    def heard():
        nonlocal said
        said += capfd.readouterr().err
        return said

    with reported("computing convex shapes of bin.obj, 1 of 1", after=0.01):
        wait_for(heard)
    with reported("not this", after=600):
        pass
    assert heard() == "computing convex shapes of bin.obj, 1 of 1\n"


def test_work_that_takes_long_is_reported_to_a_listener(capfd):
    reports = []
    with reported_to(reports.append):
        with reported("computing", after=0.01):
            wait_for(lambda: reports)
        with reported("not this", after=600):
            pass
    assert (reports, capfd.readouterr().err) == (["computing"], "")


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("form", "words"), [("full", ("--in-process",)), ("full", ()), ("json", ())]
)
def test_a_run_into_a_pipe_says_what_takes_long(tmp_path, monkeypatch, capfd, form, words):
    """In the other processes, too: a finely divided bin takes them longer than the patience."""
    if words:
        monkeypatch.setattr("harness.world.objects.reported", partial(reported, after=0.0))
    else:
        write_obj(tmp_path / "bin.obj", *vessel(400, 0.1, 0.09, 0.1, 0.01))
    file = tmp_path / "a.scenario.yaml"
    file.write_text(
        "scenario: a bin\nrobot: open_manipulator_x\nsteps: [{wait: 0.1}]\n"
        "objects: [{name: bin, static: true, mesh: {file: bin.obj}, pose: {xyz: [1, 0, 0]}}]\n"
    )
    assert main(["run", str(file), "--no-report", "--format", form, *words]) == 0
    assert "computing convex shapes of 'bin'\n" in capfd.readouterr().err


def test_no_meshes_are_no_work():
    decompose_meshes([], {})
