"""Every row of docs/reference/robot_formats.md."""

import pytest

from harness.core.errors import SpecError
from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot
from tests.robot.format_rows import Row
from tests.robot.format_tables import FILES, NEXT_TO_THEM, TABLES, words

ROWS = [(file, row) for file, (_, _, rows) in TABLES.items() for row in rows]


def load(folder, file, row=None):
    """The arm that a file is part of, with the row's change in it."""
    for name, text in (FILES | NEXT_TO_THEM).items():
        if row is not None and name == file:
            assert row.old in text, "the row changes nothing"
            text = text.replace(row.old, row.new)
        (folder / name).parent.mkdir(exist_ok=True)
        binary = name.endswith((".ply", ".glb"))
        (folder / name).write_text(text, encoding="latin-1" if binary else "utf-8", newline="")
    return load_robot(RobotSpec.model_validate(words(file)), folder)


@pytest.mark.parametrize(
    ("file", "row"), ROWS, ids=[f"{file} {row.here} {row.word}" for file, row in ROWS]
)
def test_a_word_is_treated_as_the_table_says(tmp_path, file, row: Row):
    if row.here == "refused":
        with pytest.raises(SpecError, match=row.reported) as caught:
            load(tmp_path, file, row)
        assert caught.value.problems[0].path == str(tmp_path / file)
        assert caught.value.problems[0].line > 0
        return
    unchanged, arm = load(tmp_path, file), load(tmp_path, file, row)
    if row.here == "read":
        assert row.holds(arm)
        assert not row.holds(unchanged), "true of any arm"
        return
    assert (arm.urdf, arm.srdf) == (unchanged.urdf, unchanged.srdf)
    assert arm.start_state == unchanged.start_state
    new = [note for note in arm.notes if note not in unchanged.notes]
    assert {row.reported in note for note in new} == ({True} if row.reported else set())
