"""The run's record: the robot as verdicts and reports need it, versions, signals."""

from __future__ import annotations

from collections.abc import Sequence

from harness.core.versions import library_versions
from harness.language.reading.resolve import resolved_text
from harness.ports.kinematics import Kinematics
from harness.ports.scene import Touch
from harness.recording.robot_record import GripperRecord, JointRecord, LinkPlacement, RobotRecord
from harness.recording.run import Run
from harness.recording.signals import Signals
from harness.robot.description import RobotDescription
from harness.session.execute import Execution
from harness.session.observation.fault_effects import with_receipts
from harness.session.observation.findings import findings_of, notes_of_files, overlap_findings
from harness.session.prepare import Prepared
from harness.session.run_request import RunRequest


def robot_record(description: RobotDescription, kinematics: Kinematics) -> RobotRecord:
    """The robot without its planner and physics."""
    static = tuple(name for name in description.link_names if name in description.static_links)
    start = description.start_positions()
    return RobotRecord(
        name=description.name,
        joints=tuple(
            JointRecord(
                name=joint.name,
                kind=joint.kind,
                lower=joint.lower,
                upper=joint.upper,
                velocity=joint.velocity,
                acceleration=joint.acceleration,
                effort=joint.effort,
                is_mimic=joint.mimic is not None,
            )
            for joint in description.movable_joints
        ),
        groups={name: group.joint_names for name, group in description.groups.items()},
        named_states={
            group: {
                name: dict(state.positions) for name, state in description.states_of(group).items()
            }
            for group in description.groups
        },
        arm_group=description.arm_group,
        tcp_link=description.tcp_link,
        base_link=description.base_link,
        link_names=description.link_names,
        static_links=static,
        gripper=_gripper_record(description),
        link_visuals={link.name: link.visuals for link in description.links if link.visuals},
        urdf=description.urdf,
        srdf=description.srdf,
        static_link_poses={
            name: tuple(float(x) for x in kinematics.link_pose(start, name).as_vector())
            for name in static
        },
        placements=tuple(
            LinkPlacement(
                link=joint.child,
                parent=joint.parent,
                pose=tuple(float(x) for x in joint.pose.as_vector()),
                joint=joint.name if joint.is_movable else "",
                slides=joint.kind == "prismatic",
                axis=tuple(float(x) for x in joint.axis),
            )
            for joint in description.joints
        ),
        shapeless_links=description.shapeless_links,
    )


def _gripper_record(description: RobotDescription) -> GripperRecord | None:
    gripper = description.gripper
    if gripper is None:
        return None
    return GripperRecord(
        group=gripper.group,
        joint=gripper.joint,
        sides={side: tuple(links) for side, links in gripper.sides.items()},
        open_position=gripper.open_position,
        closed_position=gripper.closed_position,
        widths=tuple((float(q), float(width)) for q, width in gripper.widths),
        palm_link=gripper.palm_link,
    )


def resolved_scenario(request: RunRequest, prepared: Prepared) -> str:
    """The scenario as a report has it: every value written out, with the seeds of its steps."""
    program = prepared.program
    seeds = {program.step_locs[step.path]: step.options.seed for step in program.all_steps()}
    return resolved_text(prepared.loaded, seeds, folder=request.report_dir)


def executed_run(
    request: RunRequest,
    prepared: Prepared,
    execution: Execution,
    signals: Signals,
    overlaps: Sequence[Touch],
) -> Run:
    """What was executed and recorded, without what is observed on it and what only a report has.

    Args:
        request: The request of the case.
        prepared: The scenario, ready to be executed.
        execution: What its steps did.
        signals: What the physics recorded, with distances.
        overlaps: Bodies that overlap at the start.
    """
    program = prepared.program
    robot = robot_record(program.description, prepared.ports.kinematics)
    steps, faults = with_receipts(execution.steps, signals, robot, execution.objects)
    return Run(
        scenario=program.title,
        file=str(request.file),
        case=request.case,
        seed=program.seed,
        robot=robot,
        objects=execution.objects,
        attachments=execution.attachments,
        steps=steps,
        signals=signals,
        gravity=program.world.gravity,
        timestep=program.world.timestep,
        allowed_contacts=tuple(sorted(program.description.allowed_collisions)),
        findings=(
            *prepared.about_file,
            *notes_of_files(prepared.notes),
            *overlap_findings(overlaps),
            *findings_of(steps),
            *faults,
        ),
        source=prepared.loaded.text,
        versions=library_versions(),
        ended_early=execution.ended_early,
        cameras=tuple(program.cameras.values()),
    )
