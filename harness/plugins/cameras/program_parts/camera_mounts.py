"""What cameras are fixed to, which is known once the objects of every step are."""

from __future__ import annotations

from typing import ClassVar

from harness.cell.program_part import ProgramPart
from harness.cell.scope import Scope
from harness.language.scenario import ScenarioContent


class CameraMounts(ProgramPart):
    """The frame that carries each camera, by the camera's name."""

    name: ClassVar[str] = "camera_mounts"

    def resolve(self, scenario: ScenarioContent, scope: Scope) -> dict[str, str]:
        """The frames; one that nothing has, or only the planner knows, is reported."""
        mounts = {name: camera.frame for name, camera in scope.cameras.items()}
        indices = {spec.name: index for index, spec in enumerate(scenario.cameras)}
        frames = ("world", *scope.description.link_names, *scope.objects)
        for name, frame in mounts.items():
            loc = ("cameras", indices[name], "pose", "frame") if name in indices else ("world",)
            if name in indices:
                scope.check_frame(frame, loc)
            elif frame not in frames:
                scope.problems.add(
                    loc,
                    f"its camera '{name}' is on '{frame}', which is no link of"
                    f" {scope.description.name} and no object",
                    "take another robot or world",
                )
            obj = scope.objects.get(frame)
            if obj is not None and not obj.in_simulation:
                scope.problems.add(
                    loc,
                    f"'{obj.name}' is known to the planner alone: no camera can be on it",
                    "name an object that is `in: both` or `in: simulation`",
                )
        return mounts
