"""Small files that SDFormat calls valid or bad: the program agrees, or the page lists why not."""

import pytest

from harness.core.errors import SpecError
from harness.plugins.formats.sdf.world import load_sdf

LINK = "<link name='{}'/>"
TWO = LINK.format("a") + LINK.format("b")


def model(content):
    return f"<model name='m'>{TWO}{content}</model>"


def joint(parent, child):
    return f"<joint name='j' type='fixed'><parent>{parent}</parent><child>{child}</child></joint>"


BAD = {
    "an unreferenced frame on an unknown one": (
        model("<frame name='f' attached_to='nowhere'/>"), "there is no frame 'nowhere' here",
    ),
    "an unreferenced pose in an unknown frame": (
        model("<link name='c'><pose relative_to='nowhere'/></link>"),
        "there is no frame 'nowhere' here",
    ),
    "frames in a circle": (
        model("<frame name='f' attached_to='g'/><frame name='g' attached_to='f'/>"),
        "is relative to itself in a cycle",
    ),
    "frames of the world in a circle": (
        "<frame name='f'><pose relative_to='g'/></frame><frame name='g'><pose relative_to='f'/>"
        "</frame>",
        "is relative to itself in a cycle",
    ),
    "a frame on itself": (
        model("<frame name='f' attached_to='f'/>"), "is relative to itself in a cycle",
    ),
    "parent and child are one": (
        model(joint("a", "a")), "'m::a' is parent and child of this joint",
    ),
    "parent and child are one by a frame": (
        model("<frame name='f' attached_to='a'/>" + joint("a", "f")),
        "'m::a' is parent and child of this joint",
    ),
    "a canonical link that is none": (
        model("").replace("name='m'", "name='m' canonical_link='gone'"),
        "there is no link or frame 'gone' here",
    ),
    "a model without a link": ("<model name='m'/>", "the model 'm' has no link"),
    "two collisions of one name": (
        model("<link name='c'><collision name='s'/><collision name='s'/></link>"),
        "another <collision> of this link is called 's'",
    ),
    "colons in a name": (
        model("").replace("name='m'", "name='m::n'"), "a name has no '::' since SDF 1.8",
    ),
    "a joint to an unknown parent": (
        model(joint("gone", "a")), "there is no link or frame 'gone' here",
    ),
    "a joint to an unknown child": (model(joint("a", "gone")), "there is no"),
    "the world as child": (
        model(joint("a", "world")), "the child of a joint cannot be the world",
    ),
    "two links of one name": (model(LINK.format("a")), "'a' is defined twice"),
    "a second world of the same name": (
        "</world><world name='w'>", "another <world> has this name",
    ),
}  # fmt: skip

VALID = {
    "the world as parent": (model(joint("world", "a")), ""),
    "a frame on a frame on a link": (
        model("<frame name='f' attached_to='g'/><frame name='g' attached_to='b'/>"), "",
    ),
    "a joint between frames": (
        model("<frame name='f' attached_to='a'/>" + joint("f", "b")), "",
    ),
    "a static model without a link": ("<model name='m'><static>1</static></model>", ""),
    "a second world of another name": ("</world><world name='v'>", "a second <world> is left out"),
    "a step of 0.1 s": (
        "<physics type='ode'><max_step_size>0.1</max_step_size></physics>",
        "a step of 0.1 s is taken as 0.001 s",
    ),
    "an included actor": (
        "<include><uri>model://walker</uri></include>", "an included <actor> is left out",
    ),
    "an included light in a model": (
        model("<include><uri>model://lamp</uri></include>"), "an included <light> is left out",
    ),
}  # fmt: skip


def loaded(folder, content):
    for name, element in (("walker", "<actor name='w'/>"), ("lamp", "<light name='l'/>")):
        (folder / name).mkdir()
        (folder / name / "model.sdf").write_text(f"<sdf version='1.9'>{element}</sdf>")
    path = folder / "world.sdf"
    path.write_text(f"<sdf version='1.9'><world name='w'>{content}</world></sdf>")
    return load_sdf(path)


@pytest.mark.parametrize("case", BAD)
def test_a_bad_file_is_refused(tmp_path, case):
    content, message = BAD[case]
    with pytest.raises(SpecError) as caught:
        loaded(tmp_path, content)
    assert message in caught.value.problems[0].message


@pytest.mark.parametrize("case", VALID)
def test_a_valid_file_is_read(tmp_path, case):
    content, note = VALID[case]
    found = loaded(tmp_path, content)
    assert any(note in str(each) for each in (*found.notes, ""))
