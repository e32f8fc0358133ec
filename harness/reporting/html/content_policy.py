"""What a page may load and run: its own scripts and styles, and pictures that it holds itself."""

from __future__ import annotations

import base64
import hashlib
import re
from string import Template

_SCRIPTS = re.compile(r"<script>(.*?)</script>", re.DOTALL)
_STYLES = re.compile(r"<style>(.*?)</style>", re.DOTALL)


def content_policy(skeleton: str, *, script: str, style: str) -> str:
    """The Content-Security-Policy of a page [1].

    Nothing is fetched, embedded or sent anywhere, and no script or style runs but those of the
    skeleton, by their hashes. Attributes may style an element, which is how bars get their length.

    Args:
        skeleton: The page's template, which no data of a run is in yet.
        script: What is put in for `$script`.
        style: What is put in for `$style`.

    References:
        [1] W3C, "Content Security Policy Level 3".
    """
    page = Template(skeleton).safe_substitute(script=script, style=style)
    scripts, styles = (_hashes(found.findall(page)) for found in (_SCRIPTS, _STYLES))
    return (
        f"default-src 'none'; script-src {scripts}; style-src {styles};"
        " style-src-attr 'unsafe-inline'; img-src data: blob:; media-src blob:;"
        " base-uri 'none'; form-action 'none'"
    )


def _hashes(texts: list[str]) -> str:
    digests = (hashlib.sha256(text.encode()).digest() for text in texts)
    return " ".join(f"'sha256-{base64.b64encode(digest).decode()}'" for digest in digests)
