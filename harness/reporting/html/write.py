"""The whole page of a run as text, and in its folder."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

from harness.recording.explanation import recorded_explanation
from harness.recording.files import write_file
from harness.recording.read_run import read_run
from harness.recording.run import Run
from harness.recording.stored_run import PAGE, StoredRun, blames_changes
from harness.recording.verdict import Verdict
from harness.reporting.html import bundle
from harness.reporting.html.bundle import rendered
from harness.reporting.html.first_view import Framing, decisive_time
from harness.reporting.html.groups import pack_groups
from harness.reporting.html.packing import Packer
from harness.reporting.html.paths import explained_points, pack_plan, pack_tcp_path
from harness.reporting.html.pictures import pack_cameras
from harness.reporting.html.presses import pack_presses
from harness.reporting.html.scene import pack_scene
from harness.reporting.html.still import small_still
from harness.reporting.html.story import (
    command_again,
    contact_facts,
    environment,
    findings_facts,
    joint_facts,
    ordered_steps,
    step_facts,
    verdict_facts,
)
from harness.reporting.html.summary import (
    SummaryPicture,
    header_facts,
    summary_facts,
    summary_tables,
)


class Page:
    """One self-contained page; equal text for equal runs but for their wall times.

    What does not depend on the run's pictures is packed at once, while they are being drawn.
    """

    def __init__(self, run: Run, verdicts: Sequence[Verdict]) -> None:
        self._packer = Packer()
        pack_tcp_path(run, self._packer)
        self._plans = [
            pack_plan(run, step, index, self._packer)
            for index, step in enumerate(ordered_steps(run))
        ]
        self._facts = {
            "groups": pack_groups(run, verdicts, self._packer),
            "presses": pack_presses(run, self._packer),
        }
        bundle.templates(bundle.TEMPLATE.parent)

    def html(self, stored: StoredRun, pictures: Sequence[SummaryPicture] = ()) -> str:
        """The text of the page, which is made once."""
        statuses = [verdict.status for verdict in stored.verdicts]
        unseen = statuses.count("not observable") if stored.outcome == "passed" else 0
        text = rendered(
            bundle.TEMPLATE,
            script=bundle.script(),
            style=bundle.style(),
            run=stored.run,
            verdicts=stored.verdicts,
            title=stored.run.scenario,
            outcome=f"{unseen} not observable" if unseen else stored.outcome,
            tone="open" if unseen else "good" if stored.outcome == "passed" else "bad",
            header=[(name, value, _short(value)) for name, value in header_facts(stored) if value],
            facts=summary_facts(stored),
            pictures=pictures,
            tables=summary_tables(stored),
            data=self.data(stored),
        )
        return text.encode(errors="replace").decode()  # names of files may have half characters

    def data(self, stored: StoredRun, decisive: tuple[float, float] | None = None) -> str:
        """What the page's scripts show, as text that `payload.js` unpacks.

        Args:
            decisive: The interval on which the page opens [s]; None for the first failure.
        """
        run, packer = stored.run, self._packer
        steps = [
            step_facts(run, step, stored.verdicts) | plan
            for step, plan in zip(ordered_steps(run), self._plans, strict=True)
        ]
        verdicts = [verdict_facts(run, verdict) for verdict in stored.verdicts]
        blamed = {
            name for each in verdicts if each["status"] != "passed" for name in each["bodies"]
        }
        framing = Framing(blamed, explained_points(self._plans), decisive or decisive_time(stored))
        return packer.text(
            {
                "title": run.scenario,
                "robot": run.robot.name,
                "outcome": stored.outcome,
                "duration": float(run.signals.times[-1]),
                "steps": steps,
                "verdicts": verdicts,
                "findings": findings_facts(run),
                "contacts": contact_facts(run),
                "joints": joint_facts(run),
                "environment": environment(stored),
                "again": command_again(run),
                "options": shlex.join(run.options),
                "source": run.source,
                **self._facts,
                "cameras": pack_cameras(stored, packer),
                **pack_scene(run, stored.drawings.meshes, packer, framing),
            }
        )


def _short(value: str) -> str:
    """A path's last part, or the value."""
    return value.replace("\\", "/").rstrip("/").rpartition("/")[2] or value


PICTURES = 6  # of steps in the summary, failed ones first: a row of the page
WIDTH = 360  # [pixels]
WHY = "-why"  # how names of pictures end that show what explains a failure


def write_page(folder: Path, stored: StoredRun | None = None, begun: Page | None = None) -> Path:
    """Write `report.html` into a run's folder, from the saved run if none is given.

    Args:
        stored: The run that is shown; read from the folder if none is given.
        begun: Its page, which was begun before.

    Raises:
        HarnessError: The folder holds no run.
    """
    stored = stored or read_run(folder)
    page = folder / PAGE
    with blames_changes(folder, stored):
        text = (begun or Page(stored.run, stored.verdicts)).html(stored, _pictures(folder, stored))
    write_file(page, text)
    return page


def _pictures(folder: Path, stored: StoredRun) -> list[SummaryPicture]:
    """A few of the stills that the folder has: failures, the end, and between them."""
    executed = [step for step in stored.run.steps if step.status != "not reached"]
    stills = {
        int(file.name.partition("-")[0]) - 1: f"images/{file.name}"
        for file in (folder / "images").glob("[0-9]*-*.jpg")
        if not file.stem.endswith(WHY)
    }
    there = [number for number in sorted(stills) if number < len(executed)]
    failed = [number for number in there if executed[number].status == "failed"]
    moving = [n for n in there if executed[n].end_time > executed[n].start_time]
    ends = {executed[number].end_time: number for number in moving or there}
    rest = [number for _, number in sorted(ends.items()) if number not in failed]
    chosen = sorted(
        {*failed[:PICTURES], *_spread(rest, PICTURES - len(failed))},
        key=lambda number: (executed[number].end_time, number),
    )
    captioned = [
        (stills[n], f"{executed[n].summary}, t = {executed[n].end_time:.2f} s") for n in chosen
    ]
    captioned += [
        (picture, f"why: {step.summary}")
        for step in executed
        if step.status == "failed"
        and (picture := recorded_explanation(step.explanation).picture) is not None
    ]
    return [
        SummaryPicture(caption, small)
        for name, caption in captioned
        if (small := small_still(folder, name, WIDTH)) is not None
    ]


def _spread(numbers: Sequence[int], count: int) -> list[int]:
    if count <= 0 or not numbers:
        return []
    return [numbers[round((len(numbers) - 1) * (i + 1) / count)] for i in range(count)]
