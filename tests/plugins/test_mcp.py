"""The server, as a client of the protocol's own SDK meets it."""

import base64
import json
import sys
from functools import partial
from importlib.util import find_spec

import pytest

pytestmark = pytest.mark.skipif(find_spec("mcp") is None, reason="the extra `mcp` is not installed")

WRONG = """\
scenario: Pick a cube from the table
robot: {model: ur3e, gripper: rh_p12_rn_a}
objects:
  - {name: cube, box: {size: [0.04, 0.04, 0.04]}, mass: 0.1, pose: {xyz: [0.3, 0.1, 0.02]}}
steps:
  - move_to: hom
  - pik: cube
expect:
  - lifted: {object: cube, above: 50 mm}
"""


class Assistant:
    """A client that calls tools and reads their answers; its server works in the folder `root`."""

    def __init__(self, portal, client, root):
        self._portal, self._client, self.root = portal, client, root

    def call(self, tool, **arguments):
        return self._portal.call(partial(self._client.call_tool, tool, arguments))

    def text(self, tool, **arguments):
        result = self.call(tool, **arguments)
        assert not result.is_error, result.content[0].text
        return result.content[0].text

    def answer(self, tool, **arguments):
        return json.loads(self.text(tool, **arguments))

    def refusal(self, tool, **arguments):
        result = self.call(tool, **arguments)
        assert result.is_error, result.content[0].text
        return result.content[0].text


@pytest.fixture(scope="module")
def assistant(tmp_path_factory):
    """A client of one server, whose folder has a Python file that nothing may import."""
    from anyio.from_thread import start_blocking_portal
    from mcp import Client, StdioServerParameters
    from mcp.client.stdio import stdio_client

    root = tmp_path_factory.mktemp("root")
    (root / "yaml.py").write_text("raise SystemExit('imported')")
    words = ["-P", "-m", "harness.cli", "mcp", "--root", str(root)]
    server = StdioServerParameters(command=sys.executable, args=words)
    with (
        start_blocking_portal() as portal,
        portal.wrap_async_context_manager(Client(stdio_client(server))) as client,
    ):
        yield Assistant(portal, client, root)


@pytest.mark.nightly
def test_an_assistant_writes_repairs_and_passes_a_pick(assistant):
    """Also in a folder with a `yaml.py`: no command imports it instead of the package."""
    [case] = assistant.answer("write", file="mine.scenario.yaml", text=WRONG)
    assert case["outcome"] == "invalid"
    text = WRONG
    for problem in case["problems"]:  # as an assistant does: the line and the advice
        assert problem["source_line"] in text
        begin = problem["column"] - 1
        wrong = problem["source_line"][begin : begin + problem["length"]]
        text = text.replace(wrong, problem["hint"].split("`")[1])
    [case] = assistant.answer("write", file="mine.scenario.yaml", text=text)
    assert case["outcome"] == "passed", case
    [run] = assistant.answer("run", file="mine.scenario.yaml")
    assert run["outcome"] == "passed", run
    assert run["verdicts"][0]["margin"] > 0
    picture = assistant.call("picture", report=run["report_dir"])
    assert base64.b64decode(picture.content[0].data)[:2] == b"\xff\xd8"
    lift = {"report": run["report_dir"], "step": "steps[1].lift"}
    assert not assistant.call("picture", **lift).is_error
    assert (assistant.root / "mine.scenario.yaml").is_file()


def test_nothing_outside_the_folder_is_read_or_written(assistant):
    root = assistant.root
    outside = root.parent / f"{root.name}_outside.scenario.yaml"
    outside.write_text(WRONG)
    (root / "link.scenario.yaml").symlink_to(outside)
    before = sorted(root.rglob("*"))
    names = [f"../{outside.name}", str(outside), "link.scenario.yaml", "/etc/passwd", "a\0b", ""]
    for tool in ("check", "run", "read", "explain", "search"):
        for name in names[:-1]:
            assistant.refusal(tool, file=name)
    for name in (*names, "mine.py", "x/../../y.yaml", "n" * 300 + ".yaml"):
        assistant.refusal("write", file=name, text="scenario: x")
    assistant.refusal("write", file="long.yaml", text="x" * 300_000)
    assistant.refusal("picture", report="..")
    assert outside.read_text() == WRONG
    assert sorted(root.rglob("*")) == before


@pytest.mark.nightly
def test_an_unknown_word_of_the_language_is_refused_with_the_near_ones(assistant):
    assert "pick" in assistant.refusal("schema", name="pik")


@pytest.mark.nightly
def test_the_language_and_a_cell_are_described(assistant):
    assert {"steps", "expect", "robot"} <= set(assistant.answer("schema"))
    assert assistant.answer("schema", name="move_to")["description"].startswith("Plan")
    assert "move_to" in assistant.text("list", kind="steps")
    program = assistant.text("explain", file="lessons/04_gripper_alone")
    assert "duration is at most 10.0 s" in program
    facts = assistant.answer("describe", file="lessons/04_gripper_alone")
    assert facts["robot"]["name"] == "rh_p12_rn_a"
