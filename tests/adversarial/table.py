"""The page of naive against our verdicts, from real runs. Run as a script, it renews the page."""

import re
import sys
import tempfile
from pathlib import Path

from harness.recording.read_run import read_run
from harness.session.check import check_file
from tests.adversarial.carried_scenes import CARRIED_SCENES
from tests.adversarial.cell_scenes import CELL_SCENES
from tests.adversarial.contact_scenes import CONTACT_SCENES
from tests.adversarial.container_scenes import CONTAINER_SCENES
from tests.adversarial.file_scenes import FILES
from tests.adversarial.fixture_scenes import FIXTURE_SCENES
from tests.adversarial.folder_scenes import ENVIRONMENTS, FOLDERS, ROBOTS, report_on, saved_run
from tests.adversarial.frame_scenes import FRAME_SCENES
from tests.adversarial.overlap_scenes import OVERLAP_SCENES
from tests.adversarial.recording_scenes import RECORDINGS, graded_scene, recorded_run
from tests.adversarial.rules import RULES, rule_row
from tests.adversarial.scenes import SCENES, WEIGHTLESS
from tests.adversarial.trick_scenes import TRICK_SCENES
from tests.adversarial.window_scenes import WINDOW_SCENES
from tests.running import run_case

ALL_SCENES = (
    *SCENES,
    *CONTACT_SCENES,
    *OVERLAP_SCENES,
    *CONTAINER_SCENES,
    *WINDOW_SCENES,
    *TRICK_SCENES,
    *FIXTURE_SCENES,
    *CARRIED_SCENES,
    *FRAME_SCENES,
    *CELL_SCENES,
)

PAGE = Path(__file__).parents[2] / "docs/reference/verdicts.md"
RENEW = "python -m tests.adversarial.table"
HEAD = """# Verdicts that cannot lie

The test suite runs each of these {count} scenes (`tests/adversarial`). The naive check is common in
success functions, and it passes in every scene; the expectation, judged from the same recording,
does not, or it passes with a warning that `--strict` turns into a failure. The last column lists
expectations that hold in the same run, so that no scene is simply rejected as a whole, and for each
rule there is a scene in which it must not fire. A naive check marked as too strict raises a false
alarm where the expectations pass. `python -m tests.adversarial.table` writes this page from the
runs.

## Rules

| rule | scenes that it refutes | scenes in which it must not fire |
| --- | --- | --- |
{rules}

## Scenes in the physics

| scene | naive check: passes | expectation: does not pass | holds |
| --- | --- | --- | --- |
"""
RECORDED = """
## Recordings

One run, as a student's recorder saw it in Gazebo, and what was done to the recording. Points that
are withheld can be awarded with `harness grade --allow`.

| recording | the naive check: passes | expectation: earns no points | earns its points |
| --- | --- | --- | --- |
"""
WRITTEN = """
## Files

Every key of these files is known, and a check of the keys alone accepts them.

| file | result |
| --- | --- |
"""
SAVED = """
## Saved runs

A run whose one expectation fails, and what was done to its folder. `harness judge` judges the
recorded signals again, whatever run.json says.

| folder | naive check: passes | `harness judge` or `harness compare` |
| --- | --- | --- |
"""
STARTED = """
## Environments

`harness run` of a scenario with an arm whose files are YAML and xacro, in environments of other
machines: nothing on standard error, and the exit code of any other run.

| environment | variables | exit code |
| --- | --- | --- |
"""
LIMITS = """
## What the verdicts do not claim

- **Between two samples** (1 ms of physics) contacts are not looked for. Where a point of an object
  moves by more than its own and the other's least width in one, or a link overlaps an object by
  more than 1 mm without a recorded contact, `never: in_contact` and `never: collision` carry the
  warning `contact may be missed`. Distances are interpolated there, to within 2 mm: what is thinner
  than that together with a link may pass without a warning, and an object of triangles
  (`collision: exact`) has none of its own motion.
- **Resting** is slow motion, at most 5 mm/s and 0.05 rad/s for 50 ms, not a proof of equilibrium:
  what creeps more slowly rests.
- **`sees`** reads pictures. What a transparent body covers is hidden in the segmentation
  too, although a person sees it through the body; nothing is refracted or mirrored.
- **"Below" and "up"** are along the world's z axis. Under gravity in another direction `on`,
  `placed`, `upright` and `lifted` keep that meaning.
- **`force` in formulas, and `min_force` of `in_contact`**, are the normal force as its mean over
  the last 10 ms, or over `force_window`. A blow of 1 ms counts with a tenth of its peak; its
  impulse is right, the peak is that of the contact's stiffness, which no file states.
- **`on` on slopes**: forces are counted by their upward part; on a slope steeper than 45 degrees
  less than half of the weight may be carried as normal force, and friction is not counted.
- **Distances of the robot to itself** leave out links that a joint connects, that touch with every
  joint at zero, or that a hand consists of, and of other pairs that the SRDF excludes what is not
  nearer than with every joint at zero.
- **`robot` in `clearance` and distance()** means its links: what it holds is named on its own, and
  where it comes nearer a warning says so. What is taken from an object, or put on it, has none.
- **force()** is a sum of normal forces: on a slope it is less than the weight, in a vice more than
  the resultant, and friction is no part of it.
- **Supports by friction** carry nothing for `placed` and `on`: what a vice clamps rests on nothing.
- **Origins**: a formula's x(), y(), z() and speed() are those of the object's origin. `in` counts
  shapes by their middles; of a mesh that collides as triangles it is not known what they surround.
- **Forces below 0.001 N** are no contact: what weighs less than 0.2 g rests on nothing, and touches
  nothing where it lies.
- **Two objects in one grip** touch one finger each: neither is between the fingers, so that neither
  is `grasped` or `lifted`, and closing on them is a `collision`.
- **Steps of the physics above 2 ms** make contacts softer and blows longer: gripping may then press
  harder than `collision` excuses.
- **Efforts** are those of the motors, which the simulation clamps at their limits: `effort` and
  `within_limits` see that a motor reached its limit, not what it would have needed.
- **Planner's beliefs** are not judged as facts: where an object of the planning scene alone stands
  is not observable, but for distances, which are distances to the belief.
- **A forged recording** is judged as it is: events, stamps and poses are what programs wrote.
"""
CORRUPTED = """
Recordings can be wrong as well. `tests/judging/test_mutations.py` traces the signals that each
predicate reads; it shifts, freezes and drops each of them, fills it with NaN or with holes, mixes
it with a second source, exchanges it with another from the start or from some moment on, and glues
objects to the hand. No corrupted recording may pass.
`tests/judging/test_metamorphic.py` shifts, turns and renames the world; no verdict may change
(852 cases, and six in the physics with more friction, mass or grip). `pytest -m nightly` runs all.

A second opinion comes from a slow and simple judge (`tests/second_opinion`) that shares no code
with the verdicts: geometry and a balance of forces from MuJoCo's raw states, on random pick, push,
drop and throw runs of a gantry with two fingers. On 1,000 runs both answered 7,771 questions, and
no answer differed. Of 2,813 answers in the first 360 runs seven had: two where the judge did not
yet count slip since the grasp began, and five blows of 150 N and more, of which states do not show
how much the grip explains; it now counts the one and has no opinion of the other.

| question | holds | does not hold |
| --- | --- | --- |
| `grasped` | 111 | 615 |
| `lifted` | 442 | 326 |
| `placed` | 502 | 224 |
| `on` a bin, `on` the floor | 554 | 847 |
| `in` | 147 | 579 |
| `released` | 592 | 134 |
| `collision` of hand and thing, hand and wall, held thing and wall | 77 | 1,624 |
| `clearance` | 897 | 100 |

Three runs are part of each test run; `pytest -m nightly` compares a thousand.

The package's own tests notice errors in this code (`tests/code_mutation`): cosmic-ray changes one
operator, number or name of expectations, observation, verification, digest or engine at random, and
the tests that execute the line must fail. Of 66 mutants of the first draw 41 were noticed, and of
255 of four later ones 227, 89 %. Whole classes were alive: numbers of messages, limits at their
exact values, defaults that only imports execute. All numbers of the verdicts, findings and problems
of hand-made runs and files are compared now (`tests/approved.txt`). Of 110 mutants of the next draw
(seed 20261128), which no test was written against, 103 were noticed and three change nothing:
103 of 107, 96 %; of 200 of three later draws (seeds 20261201, 20261123, 20261123142) 189 were, and
four change nothing. `survivors.yaml` lists what changes nothing, with the reasons.
`pytest -m needs_mutation` draws more; it requires 95 %.
"""


def run_scene(scene, folder):
    """The case's result and its recorded run."""
    (folder / "weightless.yaml").write_text(WEIGHTLESS)
    for name, text in scene.files.items():
        (folder / name).write_text(text)
    path = folder / "scene.scenario.yaml"
    path.write_text(scene.scenario("weightless.yaml"))
    result = run_case(path, report_dir=folder / "report", stills=False, page=False, strict=True)
    expected = "failed" if scene.expect or scene.warned else "passed"
    assert result.outcome == expected, (result.outcome, result.problems, result.message)
    return result, read_run(folder / "report").run


def parts_of(scene, result):
    """The verdicts that must be refuted, those with a warning, and those that hold."""
    first, second = len(scene.expect), len(scene.expect) + len(scene.warned)
    return result.verdicts[:first], result.verdicts[first:second], result.verdicts[second:]


def row_of(scene, result):
    """A scene's line of the table."""
    refuted, warned, kept = parts_of(scene, result)
    said = [f"`{v.expectation}`: {v.status}: {v.reason}" for v in refuted]
    said += [f"`{v.expectation}`: warning, {v.warnings[0]}" for v in warned]
    ours = "<br>".join(said) or "all of it passes"
    holds = "<br>".join(f"`{verdict.expectation}`" for verdict in kept)
    return f"| **{scene.title}**: {scene.happens} | {scene.naive} | {ours} | {holds} |"


def recording_row(scene, grade):
    """A recording's line of the table."""
    lost, kept = recording_parts(scene, grade)
    said = "<br>".join(
        f"`{row.verdict.expectation}`: {row.verdict.status}"
        + (f", withheld: {row.withheld[0]}" if row.withheld else f": {row.verdict.reason}")
        for row in lost
    )
    holds = "<br>".join(f"`{row.verdict.expectation}`" for row in kept)
    ours = said or "all of it earns its points"
    return f"| **{scene.title}**: {scene.happens} | {scene.naive} | {ours} | {holds} |"


def recording_parts(scene, grade):
    """The rows that must earn nothing, and those that must earn their points."""
    return grade.rows[: len(scene.expect)], grade.rows[len(scene.expect) :]


def file_row(scene, problems):
    """A file's line of the table."""
    line = scene.varied or (f"name: {scene.name}" if scene.name != "cube" else scene.expect)
    said = problems[0].message if problems else "accepted"
    return f"| **{scene.title}**: `{line}` | {said} |"


def folder_row(scene, text):
    """A saved run's line of the table."""
    said = [line for line in text.splitlines() if scene.said and scene.said in line]
    answer = " ".join(said[0].split()) if said else "nothing was changed"
    return f"| **{scene.title}** | {scene.naive} | {answer} |"


def environment_row(scene, code):
    """An environment's line of the table."""
    words = " ".join(f"`{name}={value}`" for name, value in scene.variables.items())
    return f"| {scene.title} | {words} | {code} |"


def checked(scene, folder):
    """The problems of a file."""
    path = folder / "file.scenario.yaml"
    path.write_text(scene.text())
    return check_file(path).problems


def without_numbers(text):
    """A page without its numbers: they may differ in the last place from machine to machine."""
    return re.sub(r"-?\d+(\.\d+)?", "#", re.sub(r"\b[0-9a-f]{12}\b", "#", text))


def page(rows, recordings, files, folders, environments):
    """The whole page."""
    count = sum(map(len, (rows, recordings, files, folders, environments)))
    rules = "\n".join(map(rule_row, RULES))
    tables = [
        HEAD.replace("{count}", str(count)).replace("{rules}", rules),
        *(f"{row}\n" for row in rows),
        RECORDED,
    ]
    tables += [*(f"{row}\n" for row in recordings), WRITTEN, *(f"{row}\n" for row in files)]
    tables += [SAVED, *(f"{row}\n" for row in folders)]
    tables += [STARTED, *(f"{row}\n" for row in environments)]
    return "".join([*tables, LIMITS, CORRUPTED])


def main():
    """Run every scene and write the page."""
    rows, recordings = [], []
    for scene in ALL_SCENES:
        with tempfile.TemporaryDirectory() as folder:
            result, _ = run_scene(scene, Path(folder))
        rows.append(row_of(scene, result))
    with tempfile.TemporaryDirectory() as folder:
        run = recorded_run(Path(folder))
        for scene in RECORDINGS:
            recordings.append(recording_row(scene, graded_scene(scene, run, Path(folder))[1]))
        files = [file_row(scene, checked(scene, Path(folder))) for scene in FILES]
        runs = {robot: saved_run(Path(folder), robot) for robot in ROBOTS}
        folders = [folder_row(scene, report_on(scene, runs, Path(folder))[1]) for scene in FOLDERS]
        started = [environment_row(each, each.exit_code(Path(folder))) for each in ENVIRONMENTS]
    PAGE.write_text(page(rows, recordings, files, folders, started), encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
