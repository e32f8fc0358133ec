"""The page on reliability: each promise with its test, limits of readers, counts of campaigns."""

import json

from docs import ROOT
from harness.core.limits import READERS, READING_MEMORY

COUNTS = ROOT / "tests" / "campaigns" / "counts.json"

PROMISES = (
    (
        "Bad input ends with exit code 2 and a mistake at its line, never with a traceback",
        ("tests/campaigns/test_fuzz.py", "tests/damaged", "tests/robot/test_bad_input.py"),
    ),
    (
        "A small file that states a huge size is refused before it is unpacked, in bounded memory",
        ("tests/system/test_bombs.py", "tests/robot/test_damaged_meshes.py"),
    ),
    (
        "Grading a recording takes time and memory linear in its messages, with two publishers too",
        ("tests/plugins/grading/test_large_bags.py",),
    ),
    (
        "A native crash, a hang or an endless call costs one case or one command, and is named",
        ("tests/suite/test_isolation.py", "tests/cli/test_native_crashes.py"),
    ),
    (
        "A full disk leaves the older file whole, and no half of the new one",
        ("tests/recording/test_run_folder.py", "tests/plugins/studio/test_guard.py"),
    ),
    (
        "A folder that cannot be read or written is named",
        ("tests/suite/test_odd_environments.py", "tests/recording/test_run_folder.py"),
    ),
    (
        "A signal at any moment ends a command without a traceback, and leaves no half of a file",
        ("tests/cli/test_interruptions.py",),
    ),
    (
        "Runs into one folder at the same time leave one whole run",
        ("tests/recording/test_run_folder.py", "tests/system/test_runs.py"),
    ),
    (
        "A clock that is set back changes no verdict: time is simulated, or recorded",
        ("tests/plugins/grading/test_recorded_times.py", "tests/system/test_determinism.py"),
    ),
    (
        "A graphics library or an optional package that is missing stops no run that does not"
        " need it",
        ("tests/cli/test_interruptions.py", "tests/core/test_extras.py"),
    ),
    (
        "Locales, spaces and other characters in paths change nothing",
        ("tests/cli/test_locales.py", "tests/suite/test_odd_environments.py"),
    ),
    (
        "No home folder, and a cache that cannot be written, cost time alone",
        ("tests/core/test_user_cache.py",),
    ),
    (
        "No network is used: what listens does so on the loopback",
        ("tests/plugins/studio/test_strangers.py", "tests/reporting/test_content_policy.py"),
    ),
    (
        "Strangers and pages of other sites can neither save nor run in the studio",
        ("tests/plugins/studio/test_strangers.py", "tests/plugins/studio/test_guard.py"),
    ),
    (
        "Packets, nodes and clients of ROS 2 end no bridge, and fill no memory",
        ("tests/plugins/ros/test_robustness.py", "tests/plugins/ros/test_poses_of_messages.py"),
    ),
    (
        "Valid scenarios of random steps end with an outcome, and with the same digest again",
        ("tests/campaigns/test_generated_scenarios.py",),
    ),
    (
        "The planning scene is what a simple model says after any attach, detach, add and remove",
        ("tests/campaigns/test_scene_model.py",),
    ),
)
"""Promises, and the tests that hold them."""

HEAD = """# Reliability

What armharness promises of bad input, crashes, memory and strangers, and the test or campaign
of each promise. The [threat model](../../SECURITY.md) says what is trusted;
[determinism](determinism.md) and [verdicts](verdicts.md) have pages of their own.

## Promises

The tests run before each change; exhaustive ones each night (`.ci/nightly`)."""

LIMITS = """## Limits of each reader

They are in one module, [limits.py](../../harness/core/limits.py). Reading a file adds at most
{memory:g} GB of memory to the process; a folder of a run is the exception, whose arrays may take
2 GiB, because a run may record as much."""

CAMPAIGNS = """## Campaigns

`python -m tests.campaigns.fuzz [READER ...] --minutes N --seed S` changes good files for each
reader: documents as documents (values, keys and elements exchanged), the rest as text and bytes.
Each reader is a process of its own; a crash, a hang, a warning of NumPy, or any other end than a
located error is a finding. Each finding so far was repaired for its whole class and became a
test. "Refused" are those that ended in a located error; the others were read. The last run of
each:"""

LAST = """{total:,} executions in all runs so far, which is not the millions that a fuzzer of bytes
needs. The searches are not guided by coverage."""


def reliability_page() -> str:
    """The page, from the counts of the last campaigns."""
    counts = json.loads(COUNTS.read_text(encoding="utf-8"))
    rows = [
        f"| {name} | {each['executions']:,} | {each['refused']:,} | {each['seconds']} s"
        f" | {each['peak_megabytes']} MB | {each['seed']} | {each['findings']} |"
        for name, each in sorted(counts.items())
    ]
    total = sum(each["all_executions"] for each in counts.values())
    parts = [
        HEAD,
        _table("promise | tests", "--- | ---", [_promise(*each) for each in PROMISES]),
        LIMITS.format(memory=READING_MEMORY / 1e9),
        _table(
            "files | size | counted",
            "--- | --- | ---",
            [f"| {each.reads} | {each.size} | {each.counted} |" for each in READERS],
        ),
        CAMPAIGNS,
        _table(
            "reader | executions | refused | time | largest process | seed | findings",
            "--- | ---: | ---: | ---: | ---: | ---: | ---:",
            rows,
        ),
        LAST.format(total=total),
    ]
    return "\n\n".join(parts) + "\n"


def _promise(promise: str, tests: tuple[str, ...]) -> str:
    places = ", ".join(f"[{each.rpartition('/')[2]}](../../{each})" for each in tests)
    return f"| {promise} | {places} |"


def _table(head: str, rule: str, rows: list[str]) -> str:
    return "\n".join([f"| {head} |", f"| {rule} |", *rows])
