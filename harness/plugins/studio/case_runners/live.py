"""A case that is shown while it runs."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING, ClassVar

from harness.suite.case_runner import CaseRunner

if TYPE_CHECKING:
    from harness.reporting.result import CaseResult
    from harness.session.progress import Notify
    from harness.session.run_request import RunRequest


class LiveRunner(CaseRunner):
    """Run a case that sends its poses to a Unix socket while it runs."""

    name: ClassVar[str] = "live"

    def run(self, request: RunRequest, notify: Notify) -> CaseResult:
        """Run the case and send each event and pose."""
        from harness.plugins.studio.live_stream import LiveStream
        from harness.session.run_case import run_case

        with closing(LiveStream(request.live)) as stream:
            return run_case(request, stream.with_events(notify), start=stream.start_case)
