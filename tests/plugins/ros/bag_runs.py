"""A run with something for every topic of a bag: cameras, an object that comes, motions."""

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from tests.running import run_case

EPOCH = 1_800_000_000 * 10**9

EVERYTHING = """\
scenario: Something for every topic
robot:
  model: ur3e
  gripper: rh_p12_rn_a
  base: {xyz: [0, 0, 1.02]}
  wrench_sensors: {ft: {link: rh_p12_rn_base, xyz: [0, 0, 0.01], rate: 50, force_noise: 0.1}}
world: lesson_ur
seed: 3
cameras:
  - name: over_view
    pose: {xyz: [1.3, 0.4, 1.7]}
    look_at: [0.3, 0, 1.1]
    image: {width: 64, height: 48}
    update_rate: 5
  - name: wrist
    pose: {frame: tool0, xyz: [0, 0.06, 0.02], rpy: [0, -1.5707963, 0]}
    image: {width: 32, height: 24, format: L8}
videos:
  - over_view
steps:
  - move_to: mogi_home
    id: home
  - add_object:
      name: shelf
      box: {size: [0.1, 0.2, 0.02]}
      pose: {xyz: [0.0, 0.5, 1.3]}
      static: true
      in: planning
  - capture: {camera: wrist, kinds: [color, depth]}
    id: look
  - ptp: {joints: {shoulder_pan_joint: -0.6}}
    id: swing
    expect:
      - duration: {at_most: 0.2}
  - remove_object: shelf
  - wait: 0.3 s
  - move_to: {pose: {frame: base_link, xyz: [0.9, 0, 0.3], quat_wxyz: [1, 0, 0, 0]}}
    id: too_far
  - wait: 1 s
    id: never
expect:
  - static: red_box
"""


def everything(folder, **options):
    """The folder of a saved run of it."""
    file = folder / "everything.scenario.yaml"
    file.write_text(EVERYTHING)
    result = run_case(file, report_dir=folder / "run", stills=False, page=False, **options)
    assert result.outcome == "failed", result.message
    assert [step.status for step in result.steps].count("not reached") == 1
    return folder / "run"


def decoded(bag):
    """Every message of an MCAP by topic, as (time [s], message): read by Foxglove's own reader."""
    messages = {}
    with next(bag.glob("*.mcap")).open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for _, channel, message, content in reader.iter_decoded_messages():
            time = (message.log_time - EPOCH) / 1e9
            messages.setdefault(channel.topic, []).append((time, content))
    return messages
