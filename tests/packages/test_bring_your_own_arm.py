"""Every command of the page `Bring your own arm` does what the page says."""

import contextlib
import io
import re
import shlex

import cv2
import numpy as np
import pytest

from docs import ROOT
from harness.cli.main import main
from harness.language.reading.load import load_scenario
from harness.language.scenario import RobotSpec
from harness.plugins.authoring.pair_statistics import self_touches
from harness.recording.read_run import read_run
from harness.robot.load import load_robot
from harness.robot.random_positions import sample_robot_positions
from harness.robot.robot_source import RobotSource, load_source

pytestmark = pytest.mark.needs_packages

PAGE = (ROOT / "docs/guides/bring_your_own_arm.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"(?ms)^```(sh|text|yaml)\n(.*?)^```$", PAGE)
TIME = re.compile(r"  t=\d.*")
PROGRESS = re.compile(r"\r\x1b\[2K(  [^\r\n]*(?=\r))?")


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    """The folder after all commands, and for each shown text what the command before it said."""
    folder = tmp_path_factory.mktemp("walk")
    shown, said = [], ""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setenv("COLUMNS", "200")
        patch.setenv("NO_COLOR", "1")
        for language, text in BLOCKS:
            if language == "sh":
                said = "".join(_run(line) for line in text.splitlines() if "pip" not in line)
            elif language == "text":
                shown.append((text, said))
    return folder, shown


class Terminal(io.TextIOWrapper):
    """Text for somebody who watches: a run is quiet in a pipe."""

    def isatty(self):
        return True


def _run(line):
    program, *arguments = shlex.split(line)
    assert program == "harness"
    stream = Terminal(io.BytesIO(), encoding="utf-8", write_through=True)
    with contextlib.redirect_stdout(stream), contextlib.redirect_stderr(stream):
        code = main(arguments)
    said = stream.buffer.getvalue().decode()
    assert code == 0, f"{line}\n{said}"
    return PROGRESS.sub("", said)


def test_each_shown_line_is_said_in_that_order(walked):
    _, shown = walked
    assert len(shown) == 3
    for text, said in shown:
        lines = iter(TIME.sub("", line) for line in said.splitlines())
        for line in text.splitlines():
            assert line == "..." or any(each.startswith(line) for each in lines), line


def test_the_picture_shows_the_arm(walked):
    picture = cv2.imread(str(walked[0] / "panda.png"))
    assert picture.shape == (800, 800, 3)
    dark = (picture.max(axis=2) < 90).mean()  # the dark caps of its joints, the shadow
    white = (picture.min(axis=2) > 245).mean()  # its shells
    assert dark > 0.005
    assert white > 0.005


def test_the_scenario_names_the_robot_that_the_page_shows(walked):
    [robot] = [text for language, text in BLOCKS if language == "yaml"]
    written = (walked[0] / "panda/first.scenario.yaml").read_text(encoding="utf-8")
    assert robot in written
    assert load_scenario(walked[0] / "panda/first.scenario.yaml").scenario.steps[0].verb == "pick"


def test_the_folder_is_the_same_robot(walked):
    scenario = load_scenario(walked[0] / "panda/first.scenario.yaml").scenario
    theirs = load_robot(scenario.robot, walked[0] / "panda")
    ours = load_robot(RobotSpec(model="arm"), walked[0] / "panda")
    assert ours.joint_names == theirs.joint_names
    assert ours.tcp_link == theirs.tcp_link == "panda_hand_tcp"
    assert ours.gripper.sides == theirs.gripper.sides
    assert ours.allowed_collisions.keys() == theirs.allowed_collisions.keys()


def test_the_run_really_lifted_the_box_between_the_fingers(walked):
    stored = read_run(walked[0] / "reports/panda/first")
    run = stored.run
    assert all(verdict.status == "passed" for verdict in stored.verdicts)
    signals = run.signals
    height = signals.object_poses["box"][:, 2]
    assert height[-1] - height[0] > 0.09
    for finger in ("panda_leftfinger", "panda_rightfinger"):
        assert signals.contact_forces[finger, "box"][-500:].min() > 0
    looks = {mesh.path.suffix for mesh in stored.drawings.meshes}
    assert looks == {".dae"}


def test_the_proposed_pairs_leave_nothing_that_the_real_srdf_would_check_and_that_touches(walked):
    """Random configurations that the package's SRDF calls free are so under the proposal."""
    words = re.findall(r"package://\S+panda\.(?:urdf|srdf)", PAGE)
    theirs = load_source(RobotSource(words[0], srdf=words[1]))
    ours = load_source(RobotSource(words[0], srdf=str(walked[0] / "panda.srdf")))
    rows = sample_robot_positions(theirs, 1000, np.random.default_rng(11))
    index = [theirs.joint_index[name] for name in ours.joint_names]
    mine = self_touches(ours, rows[:, index]).is_free
    free = self_touches(theirs, rows).is_free
    assert (mine == free).mean() > 0.995
