"""Gathers what becomes known of a case, and makes its `Run`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from harness.cameras.camera_recorder import Captures
from harness.core.versions import library_versions
from harness.language.reading.resolve import resolved_text
from harness.ports.simulation import RecordingSimulator
from harness.recording.commands import CommandRecord
from harness.recording.run import Finding, Run
from harness.recording.signals import ContactRecord, Signals
from harness.session.execute import Execution
from harness.session.observation.beliefs import believed_poses
from harness.session.observation.contacts import contact_records
from harness.session.observation.findings import notes_of_files, overlap_findings
from harness.session.observation.observe import observed_signals, report_findings
from harness.session.observation.observer import observed
from harness.session.pictures import with_picture_names
from harness.session.prepare import Prepared
from harness.session.run_request import RunRequest


class RunBuilder:
    """Gathers what becomes known of a case, and makes its `Run` once.

    Attributes:
        record: What was executed and recorded; observers and cameras read it.
        resolved: Text of the resolved scenario; empty where no report is requested.
    """

    def __init__(
        self,
        request: RunRequest,
        prepared: Prepared,
        execution: Execution,
        simulator: RecordingSimulator,
        commands: Sequence[CommandRecord] = (),
    ) -> None:
        self._request, self._prepared = request, prepared
        self.record = _recorded(request, prepared, execution, simulator, commands)
        self.resolved = ""
        self._signals: Signals = self.record.signals
        self._findings: tuple[Finding, ...] = ()
        self._contacts: tuple[ContactRecord, ...] = ()

    def observe(self) -> None:
        """Measure distances; for a report, find what only it shows besides pictures."""
        prepared = self._prepared
        self._signals = observed_signals(prepared, self.record)
        folder = self._request.report_dir
        if folder is None:
            return
        self._findings = report_findings(prepared, self.record, self._signals)
        self._contacts = contact_records(self.record)
        self.resolved = resolved_text(prepared.loaded, folder=folder)

    def build(self, captures: Captures) -> Run:
        """The whole run, with the pictures that its cameras took."""
        return replace(
            self.record,
            signals=self._signals,
            findings=(*self.record.findings, *self._findings),
            contacts=self._contacts,
            captures=captures[0],
            files=captures[1],
        )


def _recorded(
    request: RunRequest,
    prepared: Prepared,
    execution: Execution,
    simulator: RecordingSimulator,
    commands: Sequence[CommandRecord],
) -> Run:
    program, kinematics, recorded = prepared.program, prepared.ports.kinematics, simulator.finish()
    believed = believed_poses(execution.beliefs, recorded.joint_positions, kinematics)
    signals = replace(recorded, object_poses={**recorded.object_poses, **believed})
    robot = program.description
    steps, seen = observed(execution.steps, signals, robot, execution.objects)
    if request.stills and request.report_dir is not None:
        steps = with_picture_names(steps)
    return Run(
        scenario=program.title,
        file=request.shown_file,
        case=request.case,
        seed=program.seed,
        robot=robot,
        objects=execution.objects,
        attachments=execution.attachments,
        steps=steps,
        signals=signals,
        gravity=program.world.gravity,
        timestep=simulator.timestep,
        allowed_contacts=tuple(sorted(program.description.allowed_collisions)),
        findings=(
            *prepared.about_file,
            *notes_of_files(prepared.notes),
            *overlap_findings(simulator.overlaps_at_start),
            *seen,
        ),
        source=prepared.loaded.text,
        versions=library_versions(),
        ended_early=execution.ended_early,
        unrecorded=simulator.unrecorded,
        cameras=tuple(program.cameras.values()),
        commands=tuple(commands),
        options=request.options,
    )
