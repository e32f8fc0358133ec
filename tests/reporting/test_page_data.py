"""What a page carries, without a browser: small, whole, the same every time."""

import base64
import gzip
import json
import re
import struct
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from harness.core.geometry import Box, Mesh
from harness.recording.drawings import MeshRecord
from harness.recording.run import Finding
from harness.recording.stored_run import StoredRun
from harness.recording.verdict import Verdict
from harness.reporting.html import bundle
from harness.reporting.html.groups import groups_of
from harness.reporting.html.packing import Packer, thin
from harness.reporting.html.scene import pack_mesh
from harness.reporting.html.story import last_line, ordered_steps
from harness.reporting.html.write import Page
from tests.judging.synthetic_run import at, lift_run, make_run, step, thing

VALUES = st.one_of(st.just(float("nan")), st.floats(-1e6, 1e6))
SIGNALS = arrays(float, array_shapes(min_dims=2, max_dims=2, max_side=60), elements=VALUES)


def page_html(stored):
    return Page(stored.run, stored.verdicts).html(stored)


def stored(run=None, verdicts=(), outcome="passed"):
    return StoredRun(run or lift_run(), tuple(verdicts), outcome, "0" * 64, {})


def unpacked(page):
    data = gzip.decompress(base64.b64decode(re.search(r'id="data">([^<]*)<', page)[1]))
    length = struct.unpack("<I", data[:4])[0]
    head = json.loads(data[4 : 4 + length])
    start = 4 + length

    def buffer(name, kind):
        offset, size = head["buffers"][name]
        return np.frombuffer(data[start + offset : start + offset + size], kind)

    return head["run"], buffer


def from_differences(coded, rows):
    columns = coded.reshape(-1, rows).astype(np.uint64)
    return (np.cumsum(columns, axis=1) % 65536).astype(np.uint16)


def test_a_blow_between_two_frames_is_kept():
    blow = np.full((200, 6), np.nan)
    blow[57] = (0.3, -0.2, 0.1, 0.0, 0.0, 400.0)
    run = lift_run(presses={("left_finger", "box"): blow, ("palm", "box"): blow * np.nan})
    run, buffer = unpacked(page_html(stored(run)))
    (press,) = run["presses"]
    assert (press["link"], press["body"], press["count"]) == ("left_finger", "box", 1)
    assert press["first"] * run["frames"]["step"] == pytest.approx(0.57, abs=0.02)
    columns = from_differences(buffer(press["buffer"], np.uint16), 1).astype(np.int16)[:, 0]
    assert columns[:3] * press["units"][0] == pytest.approx([0.3, -0.2, 0.1], abs=1e-4)
    assert columns[3:] * press["units"][1] == pytest.approx([0, 0, 400], rel=1e-4)


def test_every_recorded_signal_has_a_plot():
    n = 200
    turning = at(n, (0.0, 0.0, 0.02))
    angle = np.linspace(0, np.pi / 2, n)
    turning[:, 0] = np.linspace(0, 0.05, n)
    turning[:, 3], turning[:, 6] = np.cos(angle / 2), np.sin(angle / 2)
    run = lift_run(
        object_poses={"box": turning},
        tcp_pose=turning,
        frames={"palm": turning},
        clearances={("robot", "box"): np.full(n, 0.03)},
        planned_clearances={("robot", "box"): np.full(n, 0.02)},
        joint_command_velocities=np.full((n, len(lift_run().robot.movable_joints)), 0.5),
    )
    groups = {group.id: group for group in groups_of(run)}
    assert groups["planned_clearance"].series["robot and box"] == pytest.approx(20.0)
    assert groups["tcp_turn"].series["turn"][-1] == pytest.approx(90.0)
    assert groups["turn"].series["box"][-1] == pytest.approx(90.0)
    assert groups["frame"].series["palm"][-1] == pytest.approx(50.0)
    assert all(
        values == pytest.approx(np.full(n, values[0]))
        for values in groups["velocity_error"].series.values()
    )
    arm = set(run.robot.arm_joints)
    others = {joint.name for joint in run.robot.movable_joints} - arm
    assert set(groups["other_position"].series) == others


@given(SIGNALS, st.integers(1, 40))
def test_thinning_keeps_every_extreme_and_invents_nothing(columns, stretches):
    thinned = thin(columns, stretches)
    assert thinned.values.shape[1] <= 2 * max(1, stretches)
    for kept, offsets, column in zip(thinned.values, thinned.offsets, columns, strict=True):
        if np.isfinite(column).any():
            assert np.nanmin(kept) == np.nanmin(column)
            assert np.nanmax(kept) == np.nanmax(column)
        places = np.arange(len(kept)) // 2 * thinned.bin + offsets
        assert (np.diff(places) >= 0).all(), "in the order of time"
        inside = places < len(column)
        np.testing.assert_array_equal(kept[inside], column[places[inside]])


def test_the_rise_is_that_of_the_lowest_point_since_it_appeared_or_was_put():
    """A cube of 40 mm turns onto its edge about its middle, and is put 0.5 m higher."""
    quarter = np.pi / 8
    poses = at(200, (0.0, 0.0, 0.02))
    poses[50:, 3:] = (np.cos(quarter), np.sin(quarter), 0.0, 0.0)
    poses[100:, 2] += 0.5
    poses[150:, 2] += 0.01
    poses[:20] = np.nan
    box = replace(thing("box"), present=((0.2, 0.995), (0.995, 9.0)))
    groups = {
        each.id: each for each in groups_of(make_run(objects=(box,), object_poses={"box": poses}))
    }
    rise = groups["height"].series["box"]
    sunk = 20 - 20 * np.sqrt(2)
    assert np.isnan(rise[:20]).all()
    assert rise[[20, 60, 99, 100, 160]] == pytest.approx([0, sunk, sunk, 0, 10])


def test_plotted_values_are_the_recorded_ones():
    run = lift_run()
    head, buffer = unpacked(page_html(stored(run)))
    group = next(each for each in head["groups"] if each["id"] == "contact")
    assert group["unit"] == "N"
    coded = from_differences(buffer("contact.values", np.uint16), group["points"])
    number = [each["name"] for each in group["series"]].index("left_finger and box")
    span = group["series"][number]
    shown = span["low"] + span["size"] * coded[number] / 65534
    recorded = run.signals.contact_forces["left_finger", "box"]
    assert shown.max() == pytest.approx(recorded.max(), abs=1e-3)
    offsets = from_differences(buffer("contact.offsets", np.uint16), group["points"])[number]
    places = np.arange(group["points"]) // 2 * group["bin"] + offsets
    np.testing.assert_allclose(shown, recorded[np.minimum(places, 199)], atol=1e-3)


def test_replayed_poses_are_the_recorded_ones():
    run = lift_run()
    head, buffer = unpacked(page_html(stored(run)))
    box = next(body for body in head["bodies"] if body["name"] == "box")
    frames = head["frames"]
    columns = from_differences(buffer("poses", np.uint16), frames["count"]).astype(np.int16)
    heights = columns[7 * box["column"] + 2] * frames["unit"]
    times = np.arange(frames["count"]) * frames["step"]
    recorded = np.interp(times, run.signals.times, run.signals.object_poses["box"][:, 2])
    np.testing.assert_allclose(heights, recorded, atol=3e-3)
    assert heights[-1] == pytest.approx(run.signals.object_poses["box"][-1, 2], abs=1e-4)


def test_a_mesh_comes_back_within_a_sixteen_bit_step():
    rng = np.random.default_rng(0)
    vertices, faces = rng.normal(size=(40, 3)), rng.integers(0, 40, (70, 3))
    packer = Packer()
    head = pack_mesh(MeshRecord("a", (1, 1, 1), vertices, faces), 0, packer)
    page = f'id="data">{packer.text({})}<'
    _, buffer = unpacked(page)
    count = len(buffer(head["vertices"], np.uint16)) // 3
    shares = from_differences(buffer(head["vertices"], np.uint16), count).T / 65535
    positions = np.array(head["low"]) + shares * np.array(head["size"])
    coded = buffer(head["faces"], np.uint32 if head["wide"] else np.uint16).astype(np.int64)
    indices = np.cumsum((coded >> 1) ^ -(coded & 1))
    drawn, given = positions[indices], vertices[faces.ravel()]
    np.testing.assert_allclose(drawn, given, atol=2 * np.ptp(vertices, axis=0).max() / 65535)


def test_the_page_of_equal_runs_is_the_same_text():
    assert page_html(stored()) == page_html(stored())


def test_whatever_a_user_names_is_escaped_in_the_markup():
    evil = "</script><script>alert(1)</script>&\"'"
    run = lift_run(objects=(thing(evil, Box((1, 1, 1))), thing("box")))
    steps = [replace(each, id=evil, summary=evil, message=evil) for each in run.steps]
    run = replace(
        run, scenario=evil, file=evil, case=evil, ended_early=evil, source=f"# {evil}",
        steps=tuple(steps), findings=(Finding(evil, evil, 0.5, evil),), versions={evil: evil},
    )  # fmt: skip
    verdicts = [Verdict(evil, "failed", -1.0, evil, 0.5, 1, evil, evil)]
    page = page_html(stored(run, verdicts, "failed"))
    assert "alert(1)</script>" not in page
    assert page.count("<script") == 3
    assert page.count("&lt;/script&gt;&lt;script&gt;alert(1)") > 8
    head, _ = unpacked(page)
    assert head["title"] == evil


def test_runs_of_nothing_and_of_an_instant_have_a_page():
    for count in (1, 2):
        run = make_run(count, objects=())
        head, _ = unpacked(page_html(stored(run)))
        assert head["frames"]["count"] >= 2
        assert head["duration"] == pytest.approx(0.01 * (count - 1))


def test_a_mesh_whose_triangles_are_not_there_is_left_out():
    shapes = thing("box", Mesh("somewhere/else.obj"))
    head, _ = unpacked(page_html(stored(lift_run(objects=(shapes,)))))
    [body] = [body for body in head["bodies"] if body["name"] == "box"]
    assert body["shapes"][0]["parts"] == []


def test_steps_stand_before_those_nested_in_them():
    run = make_run(
        50,
        steps=(
            replace(step("home", 0, 10), path="steps[0]"),
            replace(step("reach", 10, 20), path="steps[1].reach"),
            replace(step("lift", 20, 30), path="steps[1].lift"),
            replace(step("pick", 10, 30), path="steps[1]"),
            replace(step("end", 30, 50), path="steps[10]"),
        ),
    )
    assert [each.id for each in ordered_steps(run)] == ["home", "pick", "reach", "lift", "end"]


def test_a_step_ends_where_the_next_item_of_its_list_begins():
    source = "steps:\n  - wait: 1\n    id: a\n\n    # of a\n  - wait: 2\nexpect: []\n"
    assert [last_line(source, line) for line in (2, 6, 7)] == [3, 6, 7]
    assert last_line(source, 99) == 99


def test_scripts_name_only_what_they_import_and_hold_no_closing_tag():
    text = bundle.script()
    assert "</script" not in text
    assert "import {" not in text
    assert "export " not in text
    assert not re.search(r"https?://", text)


def test_a_long_run_has_a_lower_replay_rate_and_stays_small():
    count = 60_001
    phase = np.linspace(0, 300, count)
    run = lift_run(count, joint_positions=np.stack([np.sin(phase), np.cos(phase)], axis=1))
    page = page_html(stored(run))
    head, _ = unpacked(page)
    assert head["duration"] == pytest.approx(600)
    assert head["frames"]["step"] == pytest.approx(0.1, rel=0.01)
    assert len(page) < 2_000_000
