"""The text of an unexpected exception: a plug-in's mistake is located in the plug-in."""

from __future__ import annotations

import traceback
from pathlib import Path

from harness.core.extras import missing_extra
from harness.core.registry import plugin_files

OWN_FOLDER = Path(__file__).resolve().parents[1]


def error_text(error: BaseException) -> str:
    """The traceback of an exception; of one that left a plug-in's code, only the plug-in's part.

    Of a package of an extra that is not installed it says how to install it, and of memory that is
    not there that alone.

    The frames of this program say nothing to the author of a plug-in, whose line is the last one
    of the author's own.
    """
    if isinstance(error, MemoryError):
        return "harness: there is not enough memory"
    if missing := missing_extra(error):
        return missing
    files = plugin_files()
    frames = traceback.extract_tb(error.__traceback__)
    first = next(
        (index for index, frame in enumerate(frames) if Path(frame.filename).resolve() in files),
        None,
    )
    if first is None:
        return "".join(traceback.format_exception(error))
    own = [frame for frame in frames[first:] if not _is_of_harness(frame.filename)]
    lines = traceback.format_list(own) + traceback.format_exception_only(error)
    return "a plug-in raised an exception:\n" + "".join(lines)


def _is_of_harness(filename: str) -> bool:
    return Path(filename).resolve().is_relative_to(OWN_FOLDER)
