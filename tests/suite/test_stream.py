"""What a result follows from, so that a run that goes on computes what changed."""

import pytest

from harness.reporting.result import CaseResult
from harness.session.run_request import RunRequest
from harness.suite.stream import Stream, fingerprint


def test_a_line_that_was_cut_off_leaves_the_others_whole(cell, tmp_path):
    """A process that was killed while it wrote leaves half a line."""
    one, two = cell("one"), cell("two", b"other")
    stream = Stream(tmp_path)
    for job in (one, two):
        stream.write(job, CaseResult(str(job.file), "", "t", "passed"))
    stream.close()
    stream.path.write_bytes(stream.path.read_bytes()[:-40])
    again = Stream(tmp_path, resume=True)
    assert again.known(one) is not None
    assert again.known(two) is None
    again.write(two, CaseResult(str(two.file), "", "t", "failed"))
    again.close()
    place, head = Stream(tmp_path, resume=True).known(two)
    assert head.outcome == "failed"
    assert stream.path.read_bytes()[place.offset :].startswith(b'{"format"')


@pytest.fixture
def cell(tmp_path):
    """A scenario that names a robot, which names a mesh; returns its job."""

    def write(name, mesh=b"solid", quote='"'):
        folder = tmp_path / name
        (folder / "my meshes").mkdir(parents=True)
        (folder / "my meshes/arm.stl").write_bytes(mesh)
        (folder / "arm.urdf").write_text('<mesh filename="my meshes/arm.stl"/>')
        path = folder / "one.scenario.yaml"
        path.write_text(f"robot: {{urdf: {quote}arm.urdf{quote}}}\n")
        return RunRequest(path)

    return write


def test_the_same_inputs_are_the_same_wherever_they_stand(cell):
    assert fingerprint(cell("here")) == fingerprint(cell("there"))


@pytest.mark.parametrize("quote", ["", "'", '"'])
def test_what_a_named_file_names_counts(cell, quote):
    before, after = cell("before", quote=quote), cell("after", b"other", quote)
    assert fingerprint(before) != fingerprint(after)
