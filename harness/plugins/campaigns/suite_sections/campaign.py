"""The section `campaign`."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

from harness.reporting.suite.columns import Columns
from harness.reporting.suite.record import SuiteRecord
from harness.reporting.suite.section import SuiteSection


class CampaignSection(SuiteSection):
    """A map of the runs, margins, and sensitivities, where something varies."""

    name: ClassVar[str] = "campaign"

    def content(self, record: SuiteRecord, columns: Columns, folder: Path) -> Any:
        """The map, the margins and the sensitivities."""
        from harness.plugins.campaigns.effects.campaign import campaign_of

        return campaign_of(columns, record.cases, folder)
