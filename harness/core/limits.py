"""How much each reader of files that others wrote accepts: bytes, memory, and counted work."""

from __future__ import annotations

MB, MIB, GB = 10**6, 2**20, 10**9

READING_MEMORY = GB
"""Most memory that reading one file adds to the process [bytes], where a file's size does not
bound it: meshes and JSON documents. Linux enforces it."""

LONGEST_RUN = 600.0  # [s], simulated: a file cannot fill the machine's memory or its day

CASE_PATTERN = 2000  # characters of `--case`; reading brackets takes the square of their number

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
