"""A configuration for RViz 2 that shows what the bag holds."""

from __future__ import annotations

from typing import Any

import yaml

from harness.recording.run import Run
from harness.reporting.rosbag.frames import WORLD
from harness.reporting.rosbag.topics import (
    DISPLAY_PLANNED_PATH,
    ROBOT_DESCRIPTION,
    SCENE_MARKERS,
    TCP_PATH,
    Topic,
    camera_topics,
)


def rviz_configuration(run: Run) -> str:
    """The .rviz file: robot, frames, scene, path, MoveIt's planned path, cameras."""
    displays = [
        _display("Grid", "Grid", {"Cell Size": 0.5, "Plane Cell Count": 10}),
        _display(
            "RobotModel", "RobotModel",
            {"Description Source": "Topic", "Description Topic": _topic(ROBOT_DESCRIPTION)},
        ),
        _display("MarkerArray", "Scene", {"Topic": _topic(SCENE_MARKERS)}),
        _display("Path", "TCP path", {"Topic": _topic(TCP_PATH), "Line Width": 0.005}),
        _display("TF", "TF", {"Show Names": True, "Marker Scale": 0.3}, is_shown=False),
        # of MoveIt's RViz plugin: where that is not installed it stays off and does no harm
        {
            "Class": "moveit_rviz_plugin/Trajectory",
            "Name": "Planned path",
            "Enabled": False,
            "Robot Description": ROBOT_DESCRIPTION.name.lstrip("/"),
            "Trajectory Topic": DISPLAY_PLANNED_PATH.name,
        },
        *(
            _display(
                "Image", f"Camera {video.camera}",
                {"Topic": _topic(camera_topics(video.camera).compressed)},
            )
            for video in run.videos
        ),
    ]  # fmt: skip
    base = run.robot.static_link_poses.get(run.robot.base_link, (0.0, 0.0, 0.0))
    focus = dict(zip("XYZ", (float(x) for x in base[:3]), strict=True))
    document = {
        "Panels": [
            {"Class": "rviz_common/Displays", "Name": "Displays"},
            {"Class": "rviz_common/Time", "Name": "Time"},
        ],
        "Visualization Manager": {
            "Class": "",
            "Displays": displays,
            "Enabled": True,
            "Global Options": {"Fixed Frame": WORLD, "Frame Rate": 30},
            "Name": "root",
            "Tools": [{"Class": "rviz_default_plugins/Interact"}],
            "Value": True,
            "Views": {
                "Current": {
                    "Class": "rviz_default_plugins/Orbit", "Name": "Current View",
                    "Distance": 2.5, "Focal Point": focus, "Pitch": 0.45, "Yaw": 0.8,
                    "Target Frame": WORLD,
                },
                "Saved": None,
            },
        },
        "Window Geometry": {"Width": 1400, "Height": 900},
    }  # fmt: skip
    return yaml.safe_dump(document, sort_keys=False, allow_unicode=True)


def _display(
    kind: str, name: str, settings: dict[str, Any], *, is_shown: bool = True
) -> dict[str, Any]:
    head = {"Class": f"rviz_default_plugins/{kind}", "Name": name, "Enabled": is_shown}
    return {**head, **settings, "Value": is_shown}


def _topic(topic: Topic) -> dict[str, Any]:
    """A subscription that gets what the topic's publisher offers."""
    return {
        "Value": topic.name,
        "Depth": topic.depth,
        "Durability Policy": "Transient Local" if topic.is_latched else "Volatile",
        "History Policy": "Keep Last",
        "Reliability Policy": "Reliable" if topic.is_reliable else "Best Effort",
    }
