"""Commands on a pseudo-terminal: what they write, and when."""

import fcntl
import os
import pty
import re
import struct
import subprocess
import sys
import termios
import time
from dataclasses import dataclass
from itertools import pairwise

from tests.waiting import HANG

HARNESS = [sys.executable, "-m", "harness.cli"]
STYLING = re.compile(r"\x1b\[\d+m|\x1b\]8;;[^\x1b]*\x1b\\")


@dataclass(frozen=True)
class Session:
    """A command that has ended.

    Attributes:
        code: Its exit code.
        text: Everything it wrote.
        moments: Seconds since its start of everything it wrote, its end included.
    """

    code: int
    text: str
    moments: list[float]

    @property
    def is_never_silent(self):
        """Whether no pause is as long as two seconds, or a fifth of a session that a busy
        machine draws out."""
        longest = max(after - before for before, after in pairwise([0.0, *self.moments]))
        return longest < max(2.0, self.moments[-1] / 5)

    @property
    def lines(self):
        """What stays on the screen: rewritten lines are left out, colours too."""
        return screen_lines(self.text)

    @property
    def rewritten(self):
        """Everything that the last line of the screen said."""
        return [part.partition("\n")[0] for part in self.text.split("\r\x1b[2K")[1:]]


def screen_lines(text):
    """Lines of a terminal that has been written to; colours are left out."""
    lines = STYLING.sub("", text).replace("\r\n", "\n").split("\n")
    return [line.rpartition("\x1b[2K")[2] for line in lines]


def run_in_terminal(arguments, folder, columns=80, on_text=None, **environment):
    """Run a command of the harness on a terminal.

    Args:
        on_text: Called with the process and everything written so far, whenever it writes.
    """
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 40, columns, 0, 0))
    known = {
        name: value for name, value in os.environ.items() if name not in ("COLUMNS", "NO_COLOR")
    }
    known |= {"TERM": "xterm", **environment}
    begin, text, moments = time.monotonic(), b"", []
    with subprocess.Popen(
        [*HARNESS, *arguments], cwd=folder, stdin=theirs, stdout=theirs, stderr=theirs, env=known,
        start_new_session=True,
    ) as process:  # fmt: skip
        os.close(theirs)
        while True:
            try:
                text += os.read(ours, 65536)
            except OSError:  # Linux: the other end is gone
                break
            moments.append(time.monotonic() - begin)
            if moments[-1] > HANG:
                process.kill()
            if on_text is not None:
                on_text(process, text.decode(errors="replace"))
    moments.append(time.monotonic() - begin)
    os.close(ours)
    return Session(process.returncode, text.decode(errors="surrogateescape"), moments)
