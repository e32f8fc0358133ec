"""A layout for Foxglove: the scene, cameras, joints and log of a run, side by side."""

from __future__ import annotations

import json
from typing import Any

from harness.recording.run import Run
from harness.reporting.rosbag.frames import WORLD
from harness.reporting.rosbag.topics import (
    EVENTS,
    JOINT_STATES,
    ROBOT_DESCRIPTION,
    ROSOUT,
    SCENE_MARKERS,
    TCP_PATH,
    camera_topics,
)

SCENE, LOG, EVENT_LIST = "3D!scene", "RosOut!log", "RawMessages!events"
PLOTS = ("position", "velocity", "effort")


def foxglove_layout(run: Run) -> str:
    """The layout as the JSON file that Foxglove imports.

    The layer of the robot description is off there by default, so it is switched on by name.
    """
    panels: dict[str, Any] = {SCENE: _scene(run)}
    panels |= {f"Plot!{field}": _plot(run, field) for field in PLOTS}
    cameras = {f"Image!{video.camera}": _image(video.camera) for video in run.videos}
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
    base = run.robot.static_link_poses.get(run.robot.base_link, (0.0, 0.0, 0.0))
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
            topic.name: {"visible": True} for topic in (ROBOT_DESCRIPTION, SCENE_MARKERS, TCP_PATH)
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
        for column, joint in enumerate(run.robot.joints)
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
