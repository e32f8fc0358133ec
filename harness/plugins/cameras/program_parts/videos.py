"""The cameras that are recorded all through a run."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from typing import ClassVar

from harness.cell.program_part import ProgramPart
from harness.cell.scope import Scope
from harness.core.extras import install_command
from harness.language.scenario import ScenarioContent
from harness.plugins.cameras.keys.video import VideoSpec
from harness.plugins.cameras.known import check_camera


class Videos(ProgramPart):
    """Frames a second of every camera that is recorded, by its name."""

    name: ClassVar[str] = "videos"

    def resolve(self, scenario: ScenarioContent, scope: Scope) -> Mapping[str, float]:
        """The rates; a camera that does not exist, or is named twice, is reported."""
        rates: dict[str, float] = {}
        videos = [each for each in scenario.videos if isinstance(each, VideoSpec)]
        if videos and find_spec("av") is None:
            hint = f"install it by: {install_command('video')}"
            scope.problems.add(
                ("videos",), "the Python package av, which films, is not installed", hint
            )
        for index, spec in enumerate(videos):
            loc = ("videos", index, "camera")
            if spec.camera in rates:
                scope.problems.add(loc, f"'{spec.camera}' is recorded already", "name it once")
            check_camera(spec.camera, scope, loc)
            camera = scope.cameras.get(spec.camera)
            if camera is None:
                continue
            rates[spec.camera] = spec.rate or camera.update_rate
            if rates[spec.camera] > camera.update_rate:
                scope.problems.add(
                    ("videos", index, "rate"),
                    f"'{spec.camera}' takes {camera.update_rate:g} pictures a second, not"
                    f" {rates[spec.camera]:g}",
                    "lower `rate`, or raise the camera's `update_rate`",
                )
        return rates
