"""Every row of robots/FORMATS.md."""

import pytest

from harness.core.errors import SpecError
from harness.robot.load import load_robot
from harness.spec.scenario import RobotSpec
from tests.importers.sdf_files import ASCII_STL, COLLADA, TETRAHEDRON
from tests.robot.format_rows import FILES, TABLES, Row

ROWS = [(file, row) for file, (_, _, rows) in TABLES.items() for row in rows]
MESHES = {"part.stl": ASCII_STL, "part.obj": TETRAHEDRON, "part.dae": COLLADA, "part.ply": "ply"}


def load(folder, file="", row=None):
    """The arm, with the row's change in its file."""
    for name, text in (FILES | MESHES).items():
        if name == file:
            assert row.old in text, "the row changes nothing"
            text = text.replace(row.old, row.new)
        (folder / name).write_text(text, encoding="utf-8")
    moveit = {"joint_limits": "limits.yaml", "kinematics": "kinematics.yaml"}
    words = {"urdf": "arm.urdf", "srdf": "arm.srdf", "moveit": moveit}
    return load_robot(RobotSpec.model_validate(words), folder)


@pytest.mark.parametrize(
    ("file", "row"), ROWS, ids=[f"{file} {row.here} {row.word}" for file, row in ROWS]
)
def test_a_word_is_treated_as_the_table_says(tmp_path, file, row: Row):
    if row.here == "refused":
        with pytest.raises(SpecError, match=row.told) as caught:
            load(tmp_path, file, row)
        assert caught.value.problems[0].path == str(tmp_path / file)
        assert caught.value.problems[0].line > 0
        return
    plain, arm = load(tmp_path), load(tmp_path, file, row)
    if row.here == "read":
        assert row.holds(arm)
        assert not row.holds(plain), "true of any arm"
        return
    assert (arm.urdf, arm.srdf, arm.start_state) == (plain.urdf, plain.srdf, plain.start_state)
    new = [note for note in arm.notes if note not in plain.notes]
    assert {row.told in note for note in new} == ({True} if row.told else set())
