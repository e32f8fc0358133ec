"""named_target: the joints of a group stand at a state of the SRDF."""

from harness.plugins.arms.expectations.named_target import NamedTarget
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.synthetic_run import make_run

EVIDENCE = Evidence(
    three_runs=(
        Three(
            NamedTarget(state="home"),
            make_run(),
            shared.with_joint(joint_positions=-0.0105),
            -5e-4,
            "rad",
        ),
    ),
    mutation_cases=((NamedTarget(state="home"), shared.late(**shared.MOVING), "late"),),
    picture=(("pick", "{state: open, group: gripper}"), ("wall", "home")),
    free_shifts=(Free("the other group's joints", "named_target", "joint_positions", "+-finger"),),
)
