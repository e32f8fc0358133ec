"""Real runs whose pages are opened."""

import pytest

HOSTILE = """\
scenario: "<script>document.title = 'taken over'</script> & <b>bold</b>"
# </script><script>document.title = 'taken over'</script>
robot: {model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 1.02]}}
world: lesson_ur
seed: 3
steps:
  - move_to: mogi_home
    id: <img src=x onerror=alert(1)>
  - move_to: {pose: {frame: base_link, xyz: [0.9, 0, 0.3], quat_wxyz: [1, 0, 0, 0]}}
    id: too_far
    expect_error: NO_IK_SOLUTION
  - ptp: {joints: {shoulder_pan_joint: -1.2}}
    id: swing
    expect:
      - duration: {at_most: 0.2}
  - gripper: closed
expect:
  - named_target: mogi_home
  - tracking_error: {max: 0.05}
  - clearance: {at_least: 0.01}
"""


@pytest.fixture(scope="session")
def failed_run(recorded_run):
    """The folder of a run of which one step's and one final expectation do not hold."""
    return recorded_run(HOSTILE, "failed", page=True, stills=True) / "run"
