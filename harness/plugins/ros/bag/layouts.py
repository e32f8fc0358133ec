"""What viewers show of a bag: a layout for Foxglove and a configuration for RViz 2."""

from __future__ import annotations

import json
from typing import Any

import yaml

from harness.core.pose_arrays import IDENTITY
from harness.plugins.ros.bag.frames import WORLD
from harness.plugins.ros.bag.plans import tcp_path_topics
from harness.plugins.ros.bag.topics import (
    DISPLAY_PLANNED_PATH,
    EVENTS,
    JOINT_STATES,
    ROBOT_DESCRIPTION,
    ROSOUT,
    SCENE_MARKERS,
    Topic,
    camera_topics,
)
from harness.recording.run import Run
from harness.recording.stored_run import StoredRun

SCENE, LOG, EVENT_LIST = "3D!scene", "RosOut!log", "RawMessages!events"
PLOTS = ("position", "velocity", "effort")


def foxglove_layout(stored: StoredRun) -> str:
    """The layout as the JSON file that Foxglove imports.

    The layer of the robot description is off there by default, so it is switched on by name.
    """
    run = stored.run
    panels: dict[str, Any] = {SCENE: _scene(run)}
    panels |= {f"Plot!{field}": _plot(run, field) for field in PLOTS}
    cameras = {f"Image!{video.camera}": _image(video.camera) for video in stored.drawings.videos}
    panels |= cameras
    panels[LOG] = {"searchTerms": [], "minLogLevel": 1, "topicToRender": ROSOUT.name}
    panels[EVENT_LIST] = {"topicPath": EVENTS.name, "diffEnabled": False, "expansion": "all"}
    left = _stack([SCENE, *cameras, LOG], "column", 70)
    right = _stack([*(f"Plot!{field}" for field in PLOTS), EVENT_LIST], "column", 30)
    layout = {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": {"direction": "row", "first": left, "second": right, "splitPercentage": 62},
    }
    return json.dumps(layout, indent=1, ensure_ascii=False) + "\n"


def _stack(panels: list[str], direction: str, share: int) -> Any:
    """Panels side by side: the first takes its share of the room, the others the rest."""
    if len(panels) == 1:
        return panels[0]
    rest = _stack(panels[1:], direction, round(100 / max(len(panels) - 1, 2)))
    return {
        "direction": direction, "first": panels[0], "second": rest, "splitPercentage": share
    }  # fmt: skip


def _scene(run: Run) -> dict[str, Any]:
    base = run.robot.static_link_poses.get(run.robot.base_link, IDENTITY)
    return {
        "cameraState": {
            "perspective": True,
            "distance": 2.5,
            "phi": 62,
            "thetaOffset": 45,
            "targetOffset": [float(x) for x in base[:3]],
            "target": [0, 0, 0],
            "targetOrientation": [0, 0, 0, 1],
            "fovy": 45,
            "near": 0.01,
            "far": 5000,
        },
        "followMode": "follow-none",
        "followTf": WORLD,
        "scene": {"enableStats": False, "transforms": {"showLabel": False, "axisScale": 0.3}},
        "transforms": {},
        "topics": {
            topic.name: {"visible": True}
            for topic in (ROBOT_DESCRIPTION, SCENE_MARKERS, *tcp_path_topics(run).values())
        },
        "layers": {"grid": {"layerId": "foxglove.Grid", "visible": True, "frameLocked": True}},
        "imageMode": {},
    }


def _plot(run: Run, field: str) -> dict[str, Any]:
    """One series a joint, against the stamps of the messages."""
    series = [
        {
            "value": f"{JOINT_STATES.name}.{field}[{column}]",
            "label": joint.name,
            "enabled": True,
            "timestampMethod": "headerStamp",
        }
        for column, joint in enumerate(run.robot.movable_joints)
        if not joint.is_mimic
    ]
    return {
        "title": field, "paths": series, "isSynced": True, "xAxisVal": "timestamp",
        "showLegend": True, "legendDisplay": "floating", "showXAxisLabels": True,
        "showYAxisLabels": True, "showPlotValuesInLegend": False, "sidebarDimension": 240,
    }  # fmt: skip


def _image(camera: str) -> dict[str, Any]:
    topics = camera_topics(camera)
    return {
        "imageMode": {
            "imageTopic": topics.compressed.name, "calibrationTopic": topics.info.name,
        },
    }  # fmt: skip


def rviz_configuration(stored: StoredRun) -> str:
    """The .rviz file: robot, frames, scene, path, MoveIt's planned path, cameras."""
    run = stored.run
    displays = [
        _display("Grid", "Grid", {"Cell Size": 0.5, "Plane Cell Count": 10}),
        _display(
            "RobotModel", "RobotModel",
            {"Description Source": "Topic", "Description Topic": _topic(ROBOT_DESCRIPTION)},
        ),
        _display("MarkerArray", "Scene", {"Topic": _topic(SCENE_MARKERS)}),
        *(
            _display("Path", f"{arm} TCP path".strip(), {"Topic": _topic(t), "Line Width": 0.005})
            for arm, t in tcp_path_topics(run).items()
        ),
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
            for video in stored.drawings.videos
        ),
    ]  # fmt: skip
    base = run.robot.static_link_poses.get(run.robot.base_link, IDENTITY)
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
