"""Belts and turntables of MJCF scenes: `surfacevel` becomes the motion of an object's surface."""

import mujoco
import numpy as np
import pytest

from harness.plugins.formats.mjcf.scene import load_mjcf
from harness.recording.read_run import read_run
from tests.running import run_case

SCENE = """<mujoco><option timestep="0.001" cone="elliptic" integrator="implicitfast"/>
 <default><geom friction="0.8 0.005 0.0001"/></default>
 <worldbody>
 {belt}
 <body name="box" pos="{box}"><freejoint/><geom type="box" size=".03 .03 .03" mass="0.2"/></body>
 </worldbody></mujoco>
"""
BELTS = {
    "of the world": '<geom name="belt" type="box" size=".5 .2 .05" pos=".6 .3 .05" '
    'surfacevel=".2 0 0 0 0 0"/>',
    "turned geom of a body": '<body name="belt" pos=".6 .3 0" euler="0 0 30"><geom type="box" '
    'size=".5 .5 .05" pos="0 0 .05" euler="0 0 60" surfacevel="0 -.15 0 0 0 0"/></body>',
    "turntable": '<geom name="belt" type="cylinder" size=".4 .05" pos=".6 .3 .05" '
    'surfacevel="0 0 0 0 0 .8"/>',
    "turntable off its body": '<body name="belt" pos=".4 .3 0"><geom type="cylinder" '
    'size=".4 .05" pos=".2 0 .05" surfacevel="0 0 0 0 0 .8"/></body>',
}


def imported(folder, belt, box=".7 .35 .13"):
    path = folder / "scene.xml"
    path.write_text(SCENE.format(belt=belt, box=box), encoding="utf-8")
    return path, load_mjcf(path)


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize("kind", BELTS)
def test_a_box_is_carried_as_in_mujoco(kind, tmp_path):
    path, _ = imported(tmp_path, BELTS[kind])
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    text = "scenario: x\nrobot: {model: open_manipulator_x, base: {xyz: [-1, -1, 0]}}\n"
    scenario = tmp_path / "a.scenario.yaml"
    scenario.write_text(f"{text}world: scene.xml\nsteps: [{{wait: 0.8 s}}]\n", encoding="utf-8")
    run_case(scenario, report_dir=tmp_path / "run", stills=False, page=False)
    ours = read_run(tmp_path / "run").run.signals.object_poses["box"][-1, :3]
    mujoco.mj_step(model, data, 800)
    theirs = data.body("box").xpos
    assert np.linalg.norm(theirs[:2] - [0.7, 0.35]) > 0.05
    assert ours == pytest.approx(theirs, abs=3e-3)


@pytest.mark.parametrize(
    ("belt", "why"),
    [
        ('<geom name="belt" type="box" size=".1 .1 .1" surfacevel="0 0 0 1 0 0"/>', "z axis"),
        (
            '<body name="belt"><geom size=".1" surfacevel="1 0 0 0 0 0"/><geom size=".2"/></body>',
            "one motion",
        ),
        (
            '<body name="belt" pos="0 0 2"><freejoint/><geom size=".1" surfacevel="1 0 0 0 0 0"/>'
            "</body>",
            "stand still",
        ),
    ],
)
def test_other_motions_are_left_out_with_a_note(belt, why, tmp_path):
    _, world = imported(tmp_path, belt)
    belt = next(each for each in world.world.objects if each.name == "belt")
    assert belt.surface_motion is None
    assert [why in note.message for note in world.notes if "surfacevel" in note.message] == [True]
