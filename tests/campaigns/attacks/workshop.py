"""A folder with something for every command, and the commands that read and write it.

In the words of a command `@NAME` is a file or a folder that it reads, and `>NAME` one that it
writes; both are paths in the folder of the attack.
"""

from __future__ import annotations

import contextlib
import io
import json
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.core.resources import data_folder

SHORT = """\
scenario: Short
robot: open_manipulator_x
params: {x: 0.1}
steps: [{move_to: {joints: {joint1: "${x}"}}}, {wait: 10 ms}]
expect: [{always: within_limits}]
"""
MANY = SHORT.replace("steps:", "randomize: {x: {uniform: [0.1, 0.2]}}\nsamples: 3\nsteps:")
HELD = SHORT.replace("steps: [", "steps: [{external: {until: {settled: 10 ms}}}, ")
URDF = """\
<robot name="arm"><link name="base"/><link name="tip"><collision><geometry><box size="0.1 0.1 0.1"/>
</geometry></collision></link><joint name="turn" type="revolute"><parent link="base"/>
<child link="tip"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="9"/></joint>
</robot>
"""
SRDF = """\
<robot name="arm"><group name="arm"><chain base_link="base" tip_link="tip"/></group>
<group_state name="home" group="arm"><joint name="turn" value="0"/></group_state></robot>
"""
XACRO = URDF.replace('<robot name="arm">', '<robot name="arm" xmlns:xacro="http://x">')
MJCF = """\
<mujoco><worldbody><geom name="floor" type="box" size="1 1 .05" pos="0 0 -.05"/>
<body name="block" pos=".2 0 .03"><freejoint/><geom type="box" size=".02 .02 .03"/></body>
</worldbody></mujoco>
"""
SDF = """\
<sdf version="1.7"><world name="w"><model name="box"><static>true</static><link name="l">
<collision name="c"><geometry><box><size>.1 .1 .1</size></box></geometry></collision>
</link></model></world></sdf>
"""
SCENE = """\
box
* box
0.3 0 0.05
0 0 0 1
1
box
0.1 0.1 0.1
0 0 0
0 0 0 1
0 0 0 0
0
.
"""
WORLD = (
    "objects: [{name: w, box: {size: [1 cm, 1 cm, 1 cm]}, static: true, pose: {xyz: [1, 0, 0]}}]\n"
)
ASSIGNMENT = """\
assignment: Reach it
scenario: exercise.scenario.yaml
points: 2
hidden: [{set: {params.x: 0.2}}]
limits: {simulated_time: 10 s}
"""
EXERCISE = SHORT.replace("within_limits}", "within_limits, points: 1}")
CSV = "time,joint1,joint2,joint3,joint4,gripper\n" + "".join(
    f"{n / 100},{0.001 * n},0,0,0,0\n" for n in range(30)
)
REQUEST = json.dumps(
    {
        "jsonrpc": "2.0",
        "id": 1,
        "method": "initialize",
        "params": {
            "protocolVersion": "2025-03-26",
            "capabilities": {},
            "clientInfo": {"name": "a", "version": "1"},
        },
    }
)


@dataclass(frozen=True)
class Command:
    """A command of `harness`.

    Attributes:
        words: With `@` before what it reads and `>` before what it writes.
        stdin: What it reads from standard input.
        serves: It serves until it is ended.
    """

    words: tuple[str, ...]
    stdin: str = ""
    serves: bool = False

    @property
    def name(self) -> str:
        """Its words without the marks."""
        return " ".join(self.plain())

    def plain(self) -> list[str]:
        """The words as a user writes them."""
        return [word[1:] if word[:1] in "@>" else word for word in self.words]

    def slots(self) -> list[int]:
        """The places of its paths among the words."""
        return [number for number, word in enumerate(self.words) if word[:1] in "@>"]


def _of(line: str, stdin: str = "", *, serves: bool = False) -> Command:
    return Command(tuple(line.split()), stdin, serves)


COMMANDS = (
    _of("run @a.scenario.yaml --no-report"),
    _of("run @a.scenario.yaml --no-page --report-dir >out"),
    _of("run @a.scenario.yaml --report-dir >out --in-process"),
    _of("run @a.scenario.yaml --no-page --bag --report-dir >out"),
    _of("run @many.scenario.yaml --no-page -j 2 --report-dir >out --keep all"),
    _of("run @many.scenario.yaml --no-page --report-dir >out --history >history"),
    _of("run @many.scenario.yaml --no-page --report-dir >out --conditions @suite/conditions.jsonl"),
    _of("run @a.scenario.yaml --no-page --report-dir >out --ctrf >ctrf.json --comment >c.md"),
    _of("run @a.scenario.yaml --no-page --report-dir >out --baseline @baseline.json"),
    _of("run @many.scenario.yaml --no-page --shard 1/2 --report-dir >out"),
    _of("run @a.scenario.yaml --no-report --plugin @plug.py"),
    _of("run @a.scenario.yaml --no-report --package-path @packages"),
    _of("check @a.scenario.yaml"),
    _of("check @a.scenario.yaml --json"),
    _of("explain @a.scenario.yaml"),
    _of("describe @a.scenario.yaml --json"),
    _of("judge @run/a"),
    _of("judge @run/a --with @a.scenario.yaml"),
    _of("view @run/a --rebuild --no-open"),
    _of("export @run/a --bag >new_bag"),
    _of("export @run/a --bag >new_bag --storage sqlite3"),
    _of("export @run/a --urdf >new.urdf --force"),
    _of("compare @run/a @run2/a --page >page.html"),
    _of("film @run/a --to >films"),
    _of("gate @suite --baseline @baseline.json --ctrf >ctrf.json"),
    _of("gate @suite --baseline >new_baseline.json --update-baseline"),
    _of("merge @shard1 @shard2 --report-dir >out"),
    _of("results @suite --csv >results.csv"),
    _of("results @suite --against @suite --json"),
    _of("bench @a.scenario.yaml --seeds 1 --planners balanced_connect --report-dir >out"),
    _of("ik-test @ik.py:ik --robot open_manipulator_x --examples 5 --report-dir >out"),
    _of("ik-test @ik.py:ik --robot @arm.urdf --srdf @arm.srdf --examples 5 --no-report"),
    _of("search @many.scenario.yaml --runs 6 --batch 2 --report-dir >out"),
    _of("grade @a.scenario.yaml @bag --no-page --report-dir >out --allow all"),
    _of("grade @a.scenario.yaml @joints.csv --no-report"),
    _of("grade-class @assignment @submissions --report-dir >out --roster @roster.csv"),
    _of("robot check @arm.urdf --srdf @arm.srdf --samples 20"),
    _of("robot check @arm.urdf --samples 100 --force --write-srdf >new.srdf"),
    _of("robot show @arm.xacro --image >arm.png"),
    _of("import sdf @world.sdf -o >new.yaml --force"),
    _of("import mjcf @world.xml -o >new.yaml --force"),
    _of("import scene @world.scene -o >new.yaml --force"),
    _of("import srdf @arm.srdf -o >new.yaml --force --robot @arm.urdf"),
    _of("new >new.scenario.yaml"),
    _of("new >new.scenario.yaml --robot @arm.urdf --srdf @arm.srdf"),
    _of("new --project >project"),
    _of("course start 1 >course1"),
    _of("course check @course --no-open --report-dir >out"),
    _of("schema --write >schema.json"),
    _of("list robots"),
    _of("completion bash"),
    _of("skill"),
    _of("bridge @held.scenario.yaml --duration 0.05 --no-page --report-dir >out"),
    _of("mcp --root @.", REQUEST + "\n"),
    _of("studio @a.scenario.yaml --no-open --port 0", serves=True),
)


def build(folder: Path) -> None:
    """Write the files that the commands read."""
    from tests.running import exit_code

    folder.mkdir(parents=True, exist_ok=True)
    texts = {
        "a.scenario.yaml": SHORT, "many.scenario.yaml": MANY, "held.scenario.yaml": HELD,
        "arm.urdf": URDF, "arm.srdf": SRDF, "arm.xacro": XACRO, "world.xml": MJCF,
        "world.sdf": SDF, "world.scene": SCENE, "world.yaml": WORLD, "joints.csv": CSV,
        "plug.py": '"""Nothing."""\n', "roster.csv": "submission\nfirst\n",
        "assignment/assignment.yaml": ASSIGNMENT, "assignment/exercise.scenario.yaml": EXERCISE,
        "submissions/first.scenario.yaml": SHORT, "submissions/second/b.scenario.yaml": SHORT,
        "packages/some/package.xml": "<package><name>some</name></package>",
    }  # fmt: skip
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    shutil.copy(data_folder("scenarios") / "ik_test/corrected_ik.py", folder / "ik.py")
    with contextlib.chdir(folder), contextlib.redirect_stdout(io.StringIO()):
        for words in (
            "run a.scenario.yaml --no-page --report-dir run",
            "run a.scenario.yaml --no-page --report-dir run2 --set params.x=0.15",
            "run a.scenario.yaml many.scenario.yaml --no-page --report-dir suite",
            "run many.scenario.yaml --no-page --report-dir shard1 --shard 1/2",
            "run many.scenario.yaml --no-page --report-dir shard2 --shard 2/2",
            "gate suite --baseline baseline.json --update-baseline",
            "export run/a --bag bag",
            "course start 1 course",
        ):
            assert exit_code(*words.split()) in (0, 1), words


def chosen(words: Sequence[str]) -> list[Command]:
    """The commands that begin with one of some words; all without words."""
    return [each for each in COMMANDS if not words or each.words[0] in words]
