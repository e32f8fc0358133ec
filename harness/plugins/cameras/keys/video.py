"""The key `videos` of a scenario."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from harness.language.base import Name, Rate
from harness.language.plugin_field import KeyModel


class VideoSpec(KeyModel):
    """A camera that is recorded all through the run, as a video of its own size."""

    key: ClassVar[str] = "video"
    short = "camera"

    camera: Name = Field(description="The name of the camera.")
    rate: Annotated[Rate, Field(gt=0, le=120)] | None = Field(
        default=None,
        description="The frames in a second; the default is the camera's `update_rate`.",
    )
