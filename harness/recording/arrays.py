"""Recorded arrays under flat names, and a file of them with the same bytes every time.

`times`, `tcp_pose` ... as they are; those of a mapping as `frames/<link>`, `object_poses/<object>`,
`wrenches/<sensor>`, `surfaces/<object>`,
`contact_forces/<body>|<body>`, `presses/<link>|<body>`, `frictions/<link>|<body>`,
`pulls/<cup>|<body>`,
`support_forces/<a>|<b>`, `slides/<a>|<b>`, `clearances/<a>|<b>`, `clearance_links/<a>|<b>`,
`planned_clearances/<a>|<b>`, `link_overlaps/<a>|<b>`.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import IO, Any

import numpy as np

from harness.core.types import Pair
from harness.recording.signals import Signals

Array = np.ndarray[Any, Any]
BY_NAME = ("frames", "object_poses", "wrenches", "surfaces")
BY_PAIR = (
    "contact_forces",
    "presses",
    "frictions",
    "pulls",
    "support_forces",
    "slides",
    "clearances",
    "clearance_links",
    "planned_clearances",
    "link_overlaps",
)
GROUPS = frozenset(entry.name for entry in fields(Signals)) - {"clearance_cutoff"}
COMPRESSION = 1  # Deflate level: 6 takes three times as long and saves a tenth on recorded doubles


def arrays_of(signals: Signals) -> dict[str, Array]:
    """Every array of a run's signals under its flat name."""
    arrays: dict[str, Array] = {}
    for entry in fields(signals):
        value = getattr(signals, entry.name)
        if entry.name in BY_NAME:
            arrays |= {f"{entry.name}/{_escaped(name)}": value[name] for name in value}
        elif entry.name in BY_PAIR:
            arrays |= {f"{entry.name}/{_escaped(a)}|{_escaped(b)}": value[a, b] for a, b in value}
        elif isinstance(value, np.ndarray):
            arrays[entry.name] = value
    return arrays


def is_signal(name: str) -> bool:
    """Whether an array under a flat name belongs to `Signals`."""
    return name.partition("/")[0] in GROUPS


def signals_from(arrays: Mapping[str, Array], clearance_cutoff: float) -> Signals:
    """Inverse of `arrays_of`; arrays under names it does not know are left out.

    Raises:
        KeyError: An array that every run has is missing.
    """
    named: dict[str, dict[str, Array]] = {group: {} for group in BY_NAME}
    paired: dict[str, dict[Pair, Array]] = {group: {} for group in BY_PAIR}
    for name, array in arrays.items():
        group, _, rest = name.partition("/")
        if group in named:
            named[group][_plain(rest)] = array
        elif group in paired:
            first, _, second = rest.partition("|")
            paired[group][_plain(first), _plain(second)] = array
    plain = {
        entry.name: arrays[entry.name]
        for entry in fields(Signals)
        if entry.name not in (*BY_NAME, *BY_PAIR, "clearance_cutoff")
    }
    return Signals(**plain, **named, **paired, clearance_cutoff=clearance_cutoff)  # pyright: ignore[reportArgumentType]


def write_npz(path: Path | IO[bytes], arrays: Mapping[str, Array]) -> None:
    """Write arrays as NumPy's .npz: sorted and without a clock, equal bytes for equal arrays."""
    with zipfile.ZipFile(path, "w") as archive:
        for name in sorted(arrays):
            entry = zipfile.ZipInfo(f"{name}.npy")  # its time is 1980-01-01
            entry.create_system, entry.external_attr = 3, 0o644 << 16
            stream = io.BytesIO()
            array = np.ascontiguousarray(arrays[name])
            np.lib.format.write_array(stream, array, version=(1, 0), allow_pickle=False)
            archive.writestr(entry, stream.getbuffer(), zipfile.ZIP_DEFLATED, COMPRESSION)


def _escaped(name: str) -> str:
    return name.replace("%", "%25").replace("|", "%7C")


def _plain(name: str) -> str:
    return name.replace("%7C", "|").replace("%25", "%")
