"""The server, as a client of the protocol's own SDK meets it."""

import base64
import json
import sys

import pytest

mcp = pytest.importorskip("mcp")

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
    """A client that calls tools and reads their answers."""

    def __init__(self, client):
        self.client = client

    async def text(self, tool, **arguments):
        result = await self.client.call_tool(tool, arguments)
        return result.is_error, result.content[0].text

    async def answer(self, tool, **arguments):
        is_error, text = await self.text(tool, **arguments)
        assert not is_error, text
        return json.loads(text)

    async def refusal(self, tool, **arguments):
        is_error, text = await self.text(tool, **arguments)
        assert is_error, text
        return text


@pytest.fixture
def converse(tmp_path):
    """Run a coroutine function with a client whose server works in `tmp_path`."""
    import anyio
    from mcp import Client, StdioServerParameters
    from mcp.client.stdio import stdio_client

    words = ["-P", "-m", "harness.cli", "mcp", "--root", str(tmp_path)]
    server = StdioServerParameters(command=sys.executable, args=words)

    def talked(talk):
        async def session():
            async with Client(stdio_client(server)) as client:
                return await talk(Assistant(client))

        return anyio.run(session)

    return talked


def test_an_assistant_writes_repairs_and_passes_a_pick(converse, tmp_path):
    async def talk(assistant):
        [case] = await assistant.answer("write", file="mine.scenario.yaml", text=WRONG)
        assert case["outcome"] == "invalid"
        text = WRONG
        for problem in case["problems"]:  # as an assistant does: the line and the advice
            assert problem["source_line"] in text
            begin = problem["column"] - 1
            wrong = problem["source_line"][begin : begin + problem["length"]]
            text = text.replace(wrong, problem["hint"].split("`")[1])
        [case] = await assistant.answer("write", file="mine.scenario.yaml", text=text)
        assert case["outcome"] == "passed", case
        [run] = await assistant.answer("run", file="mine.scenario.yaml")
        assert run["outcome"] == "passed", run
        assert run["verdicts"][0]["margin"] > 0
        picture = await assistant.client.call_tool("picture", {"report": run["report_dir"]})
        assert base64.b64decode(picture.content[0].data)[:2] == b"\xff\xd8"
        lift = {"report": run["report_dir"], "step": "steps[1].lift"}
        assert not (await assistant.client.call_tool("picture", lift)).is_error

    converse(talk)
    assert (tmp_path / "mine.scenario.yaml").is_file()


def test_nothing_outside_the_folder_is_read_or_written(converse, tmp_path):
    outside = tmp_path.parent / f"{tmp_path.name}_outside.scenario.yaml"
    outside.write_text(WRONG)
    (tmp_path / "link.scenario.yaml").symlink_to(outside)
    names = [f"../{outside.name}", str(outside), "link.scenario.yaml", "/etc/passwd", "a\0b", ""]

    async def talk(assistant):
        for tool in ("check", "run", "read", "explain", "search"):
            for name in names[:-1]:
                await assistant.refusal(tool, file=name)
        for name in (*names, "mine.py", "x/../../y.yaml", "n" * 300 + ".yaml"):
            await assistant.refusal("write", file=name, text="scenario: x")
        await assistant.refusal("write", file="long.yaml", text="x" * 300_000)
        await assistant.refusal("picture", report="..")

    converse(talk)
    assert outside.read_text() == WRONG
    assert [file.name for file in tmp_path.iterdir()] == ["link.scenario.yaml"]


def test_a_python_file_of_the_folder_is_not_imported(converse, tmp_path):
    (tmp_path / "yaml.py").write_text("raise SystemExit('imported')")

    async def talk(assistant):
        [case] = await assistant.answer("check", file="lessons/04_ur_pick_by_friction")
        return case["outcome"]

    assert converse(talk) == "passed"


def test_the_language_and_a_cell_are_described(converse):
    async def talk(assistant):
        keys = await assistant.answer("schema")
        assert {"steps", "expect", "robot"} <= set(keys)
        pick = await assistant.answer("schema", name="move_to")
        assert pick["description"].startswith("Plan")
        assert "pick" in await assistant.refusal("schema", name="pik")
        is_error, steps = await assistant.text("list", kind="steps")
        assert not is_error
        assert "move_to" in steps
        is_error, program = await assistant.text("explain", file="lessons/04_gripper_alone")
        assert not is_error
        assert "duration, at most 10.0 s" in program
        facts = await assistant.answer("describe", file="lessons/04_gripper_alone")
        assert facts["robot"]["name"] == "rh_p12_rn_a"

    converse(talk)
