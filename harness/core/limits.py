"""How much each reader of files that others wrote accepts: bytes, memory, and counted work."""

from __future__ import annotations

from dataclasses import dataclass

MB, MIB, GB = 10**6, 2**20, 10**9

READING_MEMORY = GB
"""Most memory that reading one file adds to the process [bytes], where a file's size does not
bound it: meshes and JSON documents. Linux enforces it."""

LONGEST_RUN = 600.0  # [s], simulated: a file cannot fill the machine's memory or its day

YAML_FILE = 2 * MB
YAML_VALUES = 100_000  # aliases expanded, included files counted
YAML_LEVELS = 50  # of lists and mappings inside each other

XML_FILE = 16 * MB  # the largest robot descriptions are under 1 MB
XML_ELEMENTS = 200_000  # of one file
XML_ATTRIBUTES = 200  # of one element; MuJoCo's reader takes hours for a million
LONGEST_NAME = 100  # characters of a link, joint, group or object

XML_LEVELS = 200  # of elements inside each other

XACRO_FILES = 64 * MB  # of all files of a rendering
XACRO_STEPS = 1_000_000  # parts of expressions, elements, items of lists; a PR2 needs 90,000

MESH_FILE = 64 * MB
COLLADA_NODES = 100_000  # where a node counts as often as it is repeated

MJCF_FILES = 200  # that a model includes
MJCF_COPIES = 1000  # made by all `<replicate>` together

SDF_MODELS = 2000  # of a world, with those of included files

SCENE_FILE = 8 * MB
SCENE_SHAPES = 10_000  # of a MoveIt scene
SCENE_CORNERS = 200_000  # vertices of one mesh, and triangles: the limit of the physics

BAG_FILE = 16 * 2**30  # unpacked, of a file that is compressed as a whole
BAG_RECORD = 256 * MIB  # one message or chunk of messages, unpacked
BAG_HEADER = MIB  # of a record of ROS 1; it has a handful of names and numbers
BAG_METADATA = 4 * MIB
BAG_TOPICS = 10_000  # of one bag
BAG_NUMBERS = 20_000_000  # that are kept (160 MB); an hour of ten joints at 100 Hz has half
BAG_SIGNALS = 40_000_000
"""Numbers of all signals of the judged run (320 MB; judging takes three times as much): ten minutes
of twelve joints at 500 Hz and of five objects at 100 Hz."""

CSV_FILE = 64 * MB  # an hour of ten joints at 100 Hz has 40 MB

RUN_DOCUMENT = 64 * MB
RUN_ARRAYS = 2 * 2**30  # unpacked; what a run records itself is bounded by 1 GiB of states
PICTURE_FILE = 64 * MB
PICTURE_PIXELS = 50_000_000  # unpacked, 150 MB

RESULTS_DOCUMENT = 256 * MB
RESULTS_LINE = 16 * MB

SUBMISSION_FILES = 5000  # a ROS workspace with its build folder has a few thousand

STUDIO_MESSAGE = 4 * MIB  # a scenario as JSON
STUDIO_PAGES = 32  # that are open at the same time
STUDIO_REQUESTS = 200  # that wait for the cell

MCP_TEXT = 200_000  # characters of an answer or a written file: what a model reads at once
MCP_COMMANDS = 2  # at the same time; each takes 0.2 GB and a core

RTPS_SAMPLE = 64 * MIB
RTPS_WAITING = 4096  # samples of one writer that wait for an earlier one
RTPS_PARTIAL = 4  # samples of one writer of which fragments are missing
RTPS_MEMORY = 4 * RTPS_SAMPLE  # of the samples of one writer that wait
RTPS_PEERS = 120  # as many as a domain has ports for
RTPS_ENDPOINTS = 2000  # of one peer; a robot with MoveIt has 300


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
"""What `docs/explanation/reliability.md` shows."""
