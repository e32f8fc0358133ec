"""Files of robots that cannot be read are located mistakes, whatever is wrong with them."""

import os

import pytest

from harness.core.errors import SpecError
from harness.language.files.xml_file import parse_xml
from tests.session.front_door import problems

ARM = """<?xml version="1.0" encoding="{encoding}"?>
<robot name="r">
  <link name="base"/>
  <link name="{link}"/>
  <joint name="{joint}" type="revolute">
    <parent link="base"/><child link="{link}"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="5" velocity="1"/>
  </joint>
</robot>
"""


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"encoding": "klingon"}, "unknown encoding: klingon"),
        ({"encoding": "base64"}, "base64"),
        ({"link": "l" * 101}, "a name has at most 100 characters, this one 101"),
        ({"joint": "j" * 5000}, "a name has at most 100 characters, this one 5000"),
    ],
)
def test_a_urdf_that_cannot_be_read_is_a_located_mistake(changed, message, tmp_path):
    words = {"encoding": "utf-8", "link": "tip", "joint": "turn", **changed}
    (tmp_path / "arm.urdf").write_text(ARM.format(**words))
    [(_, said)] = problems(tmp_path, "- wait: 0.1 s", robot="{urdf: arm.urdf}")
    assert message in said


@pytest.mark.parametrize(
    "srdf",
    [
        "<group name='{long}'><joint name='turn'/></group>",
        "<group name='arm'><joint name='turn'/></group>"
        "<group_state name='{long}' group='arm'><joint name='turn' value='0'/></group_state>",
    ],
)
def test_a_long_name_in_an_srdf_is_a_located_mistake(srdf, tmp_path):
    (tmp_path / "arm.urdf").write_text(ARM.format(encoding="utf-8", link="tip", joint="turn"))
    (tmp_path / "arm.srdf").write_text(f"<robot name='r'>{srdf.format(long='x' * 200)}</robot>")
    robot = "{urdf: arm.urdf, srdf: arm.srdf}"
    [(_, said)] = problems(tmp_path, "- wait: 0.1 s", robot=robot)
    assert "a name has at most 100 characters" in said


@pytest.mark.parametrize("encoding", ["klingon", "rot13", "idna", "gbk", "shift_jis"])
def test_an_encoding_of_xml_is_known_or_refused_at_the_first_line(encoding):
    text = f'<?xml version="1.0" encoding="{encoding}"?><robot name="r"/>'
    with pytest.raises(SpecError) as caught:
        parse_xml(text.encode(), "arm.urdf")
    assert caught.value.problems[0].line == 1


@pytest.mark.parametrize("kind", ["folder", "pipe", "circle"])
def test_what_is_there_and_is_no_file_is_not_called_missing(kind, tmp_path):
    path = tmp_path / "arm.urdf"
    match kind:
        case "folder":
            path.mkdir()
        case "pipe":
            os.mkfifo(path)
        case _:
            path.symlink_to(path)
    [(_, said)] = problems(tmp_path, "- wait: 0.1 s", robot="{urdf: arm.urdf}")
    assert said.endswith("arm.urdf is no file that can be read")
