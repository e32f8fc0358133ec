"""Where the compiled check of motions is, by what it was compiled from."""

from __future__ import annotations

import hashlib
from pathlib import Path

FOLDER = Path(__file__).parent


def library_path() -> Path:
    """The shared library of the sources as they are now.

    Its name contains a digest of them, so that a library of other sources, whose arrays may be
    arranged differently, is never loaded.
    """
    digest = hashlib.sha256()
    for path in sorted([*FOLDER.glob("*.c"), *FOLDER.glob("*.h")]):
        digest.update(path.read_bytes())
    return FOLDER / f"certify-{digest.hexdigest()[:16]}.so"
