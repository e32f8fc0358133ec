"""Who touched whom, as lines for the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from harness.recording.run import ContactRecord
from harness.reporting.terminal import PLAIN, Style


def contact_lines(contacts: Sequence[ContactRecord], style: Style = PLAIN) -> Iterator[str]:
    """A table, the first to touch first; what is a collision is marked."""
    if not contacts:
        yield "contacts: none"
        return
    names = [" and ".join(contact.pair) for contact in contacts]
    width = max(map(len, names))
    yield style.strong(f"{'contacts':<{width}}  {'first':>9}  {'for':>9}  {'at most':>10}")
    for name, contact in zip(names, contacts, strict=True):
        times = f"{contact.first_time:>7.3f} s  {contact.duration:>7.3f} s"
        mark = style.bad("  collision") if contact.is_collision else ""
        yield f"{name:<{width}}  {times}  {contact.peak_force:>8.2f} N{mark}"
