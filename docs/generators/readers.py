"""How much each reader of untrusted files accepts, as the page on reliability shows it."""

from dataclasses import dataclass

from harness.core.limits import (
    BAG_FILE,
    BAG_NUMBERS,
    BAG_RECORD,
    BAG_SIGNALS,
    BAG_TOPICS,
    COLLADA_NODES,
    CSV_FILE,
    MB,
    MCP_COMMANDS,
    MCP_TEXT,
    MESH_FILE,
    MIB,
    MJCF_COPIES,
    MJCF_FILES,
    PICTURE_FILE,
    PICTURE_PIXELS,
    RESULTS_DOCUMENT,
    RESULTS_LINE,
    RTPS_PARTIAL,
    RTPS_PEERS,
    RTPS_SAMPLE,
    RTPS_WAITING,
    RUN_ARRAYS,
    RUN_DOCUMENT,
    SCENE_CORNERS,
    SCENE_FILE,
    SCENE_SHAPES,
    SDF_MODELS,
    STUDIO_MESSAGE,
    STUDIO_PAGES,
    STUDIO_REQUESTS,
    SUBMISSION_FILES,
    XACRO_FILES,
    XACRO_STEPS,
    XML_ATTRIBUTES,
    XML_ELEMENTS,
    XML_FILE,
    XML_LEVELS,
    YAML_FILE,
    YAML_LEVELS,
    YAML_VALUES,
)


@dataclass(frozen=True)
class Reader:
    """Bounds of one kind of file.

    Attributes:
        reads: The kinds of files that it reads.
        size: Largest size, in words.
        counted: What is counted while they are read, and the largest number.
    """

    reads: str
    size: str
    counted: str


def _of(number: float) -> str:
    """A size in words."""
    if number % MIB == 0:
        return f"{number / 2**30:g} GiB" if number >= 2**30 else f"{number / MIB:g} MiB"
    return f"{number / MB:g} MB"


READERS = (
    Reader(
        "scenario, world, `robot.yaml`, `assignment.yaml`, `joint_limits.yaml` and other YAML",
        _of(YAML_FILE),
        f"{YAML_VALUES:,} values, with aliases expanded and included files;"
        f" {YAML_LEVELS} levels; no tags but units",
    ),
    Reader(
        "URDF, SRDF, SDF, MJCF, `package.xml`",
        _of(XML_FILE),
        f"{XML_ELEMENTS:,} elements, {XML_ATTRIBUTES} attributes of one, {XML_LEVELS} levels;"
        f" no DOCTYPE; MJCF: {MJCF_FILES} files, {MJCF_COPIES:,} copies;"
        f" SDF: {SDF_MODELS:,} models",
    ),
    Reader("xacro", f"{_of(XACRO_FILES)} of all files", f"{XACRO_STEPS:,} steps of a rendering"),
    Reader(
        "meshes (STL, OBJ, DAE, PLY, GLB)",
        _of(MESH_FILE),
        f"{COLLADA_NODES:,} nodes of a COLLADA scene",
    ),
    Reader(
        "MoveIt scenes (`.scene`)",
        _of(SCENE_FILE),
        f"{SCENE_SHAPES:,} shapes of an object, {SCENE_CORNERS:,} vertices of a mesh",
    ),
    Reader(
        "recordings (MCAP, sqlite3, ROS 1)",
        f"any; {_of(BAG_FILE)} if compressed as a whole, {_of(BAG_RECORD)} for a message or chunk",
        f"{BAG_NUMBERS:,} numbers of joints and frames, {BAG_TOPICS:,} topics,"
        f" {BAG_SIGNALS:,} numbers of the judged signals",
    ),
    Reader("CSV of joint values", _of(CSV_FILE), f"{BAG_NUMBERS:,} numbers"),
    Reader(
        "folders of runs",
        f"{_of(RUN_DOCUMENT)} for `run.json`, {_of(RUN_ARRAYS)} of arrays unpacked,"
        f" {_of(PICTURE_FILE)} for a picture or video",
        f"{PICTURE_PIXELS:,} pixels of a picture",
    ),
    Reader(
        "results of suites: shards, streams, conditions, baselines",
        f"{_of(RESULTS_DOCUMENT)}; streams: any",
        f"{_of(RESULTS_LINE)} for one line",
    ),
    Reader(
        "submissions of a class",
        "`limits` of the assignment, counted while they are unpacked",
        f"{SUBMISSION_FILES:,} files; archives in archives: one level",
    ),
    Reader(
        "messages to the studio",
        _of(STUDIO_MESSAGE),
        f"{STUDIO_PAGES} pages, {STUDIO_REQUESTS} requests that wait",
    ),
    Reader(
        "requests to `harness mcp`",
        f"{MCP_TEXT:,} characters",
        f"one process each, {MCP_COMMANDS} at the same time",
    ),
    Reader(
        "ROS 2 messages on the network (RTPS)",
        _of(RTPS_SAMPLE),
        f"{RTPS_WAITING:,} samples of a writer that wait, {RTPS_PARTIAL} of them in fragments;"
        f" {RTPS_PEERS} participants",
    ),
)
