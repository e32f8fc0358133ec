"""The text of an unexpected exception."""

from __future__ import annotations

import traceback

from harness.core.extras import missing_extra


def error_text(error: BaseException) -> str:
    """The traceback of an exception.

    Of a package of an extra that is not installed it says how to install it, and of memory that is
    not there that alone.
    """
    if isinstance(error, MemoryError):
        return "harness: there is not enough memory"
    return missing_extra(error) or "".join(traceback.format_exception(error))
