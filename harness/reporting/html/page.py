"""The whole page as text."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from string import Template

from harness.recording.stored_run import StoredRun
from harness.reporting.html import bundle
from harness.reporting.html.bundle import content_policy
from harness.reporting.html.groups import pack_groups
from harness.reporting.html.packing import Packer
from harness.reporting.html.paths import pack_plan, pack_tcp_path
from harness.reporting.html.pictures import pack_cameras
from harness.reporting.html.presses import pack_presses
from harness.reporting.html.scene import pack_scene
from harness.reporting.html.story import (
    contact_facts,
    environment,
    findings_facts,
    joint_facts,
    ordered_steps,
    step_facts,
    verdict_facts,
)
from harness.reporting.html.summary import SummaryPicture, header_facts, outcome_pill, summary_html


def page_html(stored: StoredRun, pictures: Sequence[SummaryPicture] = ()) -> str:
    """One self-contained page; equal text for equal runs but for their wall times."""
    skeleton, style, script = bundle.skeleton(), bundle.style(), bundle.script()
    text = Template(skeleton).substitute(
        policy=content_policy(skeleton, script=script, style=style),
        title=escape(f"{stored.outcome}: {stored.run.scenario}"),
        style=style,
        script=script,
        summary=summary_html(stored, pictures),
        pill=outcome_pill(stored),
        name=escape(stored.run.scenario),
        facts="".join(
            f'<span title="{escape(value)}">{escape(name)} <b>{escape(_short(value))}</b></span>'
            for name, value in header_facts(stored)
            if value
        ),
        data=_data(stored),
    )
    return text.encode(errors="replace").decode()  # names of files may have half characters


def _short(value: str) -> str:
    """A path's last part, or the value."""
    return value.replace("\\", "/").rstrip("/").rpartition("/")[2] or value


def _data(stored: StoredRun) -> str:
    run, packer = stored.run, Packer()
    pack_tcp_path(run, packer)
    steps = [
        step_facts(run, step, stored.verdicts) | pack_plan(run, step, index, packer)
        for index, step in enumerate(ordered_steps(run))
    ]
    return packer.text(
        {
            "title": run.scenario,
            "outcome": stored.outcome,
            "duration": float(run.signals.times[-1]),
            "steps": steps,
            "verdicts": [verdict_facts(verdict) for verdict in stored.verdicts],
            "findings": findings_facts(run),
            "contacts": contact_facts(run),
            "joints": joint_facts(run),
            "environment": environment(stored),
            "source": run.source,
            "groups": pack_groups(run, stored.verdicts, packer),
            "cameras": pack_cameras(run, packer),
            "presses": pack_presses(run, packer),
            **pack_scene(run, packer),
        }
    )
