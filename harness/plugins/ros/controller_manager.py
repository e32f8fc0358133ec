"""The services of ros2_control's controller manager, and the state topics of its controllers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from harness.core.types import FloatArray
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.control.cell import ExternalCell
from harness.plugins.ros.control.controller import Controller
from harness.plugins.ros.endpoints import Publisher
from harness.plugins.ros.interfaces import header, register_move_group
from harness.plugins.ros.rtps.graph import Graph

SRV = "controller_manager_msgs/srv/"
STATE = "control_msgs/msg/JointTrajectoryControllerState"
TRAJECTORY = "joint_trajectory_controller/JointTrajectoryController"
GRIPPER = "position_controllers/GripperActionController"
BROADCASTER = "joint_state_broadcaster/JointStateBroadcaster"
ACTIVE = message("lifecycle_msgs/msg/State", id=3, label="active")
UPDATES = 100
"""Updates of the controllers in a second of simulated time."""


def controller_managers(graph: Graph, cell: ExternalCell) -> list[ControllerManager]:
    """A manager of the whole robot, and one in each namespace that has controllers."""
    register_move_group()
    spaces: dict[str, dict[str, Controller]] = {"": {}}
    for name, controller in cell.controllers.items():
        space, slash, own = name.rpartition("/")
        spaces.setdefault(slash + space, {})[own] = controller
    return [ControllerManager(graph, cell, space, own) for space, own in spaces.items()]


class ControllerManager:
    """Lists the controllers, which are all active and stay so, and publishes their states."""

    def __init__(
        self, graph: Graph, cell: ExternalCell, space: str, controllers: Mapping[str, Controller]
    ) -> None:
        """Serve the controllers of a namespace, such as `/left`, by their names in it."""
        self._cell, self._controllers = cell, controllers
        self._joints = cell.description.movable_joints
        if space:
            own = {joint.name for each in controllers.values() for joint in each.joints}
            self._joints = tuple(
                joint
                for joint in self._joints
                if joint.name in own or (joint.mimic and joint.mimic.joint in own)
            )
        for name, answer in (
            ("ListControllers", self._list),
            ("ListControllerTypes", self._types),
            ("SwitchController", self._switch),
            ("LoadController", self._is_there),
            ("ConfigureController", self._is_there),
            ("UnloadController", lambda _: {"ok": False}),
            ("ReloadControllerLibraries", lambda _: {"ok": False}),
            ("CleanupController", lambda _: {"ok": False}),
            ("ListHardwareComponents", self._components),
            ("ListHardwareInterfaces", lambda _: self._interfaces()),
            ("SetHardwareComponentState", lambda _: {"ok": False, "state": ACTIVE}),
        ):
            kind = SRV + name
            graph.serve(
                f"{space}/controller_manager/{_snake(name)}",
                kind,
                lambda request, reply, answer=answer, kind=kind: reply(
                    message(f"{kind}_Response", **answer(request))
                ),
            )
        self._states: dict[str, Publisher] = {
            name: graph.advertise(f"{space}/{name}/controller_state", STATE)
            for name, controller in controllers.items()
            if controller.gripper is None
        }

    def publish(self) -> None:
        """Publish the desired and the measured motion of each trajectory controller."""
        for name, publisher in self._states.items():
            if publisher.subscribers:
                controller = self._controllers[name]
                desired, measured = self._cell.motion_of(controller)
                error = desired[: len(measured)] - measured
                publisher.publish(
                    message(
                        STATE,
                        header=header(self._cell.time),
                        joint_names=[joint.name for joint in controller.joints],
                        reference=_point(desired),
                        feedback=_point(measured),
                        error=_point(error),
                        output=_point(desired[:1]),
                        speed_scaling_factor=1.0,
                    )
                )

    def _list(self, _request: Any) -> dict[str, Any]:
        known = [_state(name, each) for name, each in self._controllers.items()]
        return {"controller": [_described("joint_state_broadcaster", BROADCASTER, ()), *known]}

    def _interfaces(self) -> dict[str, list[Any]]:
        """The interfaces of the joints: a position to command, and three states."""
        moved = self._joints
        driven = [joint.name for joint in moved if joint.mimic is None]
        states = ("position", "velocity", "effort")
        read = [_interface(f"{joint.name}/{each}") for joint in moved for each in states]
        commanded = [_interface(f"{name}/position", is_claimed=True) for name in driven]
        return {"command_interfaces": commanded, "state_interfaces": read}

    def _components(self, _request: Any) -> dict[str, Any]:
        """The simulated robot, as one component."""
        robot = message(
            "controller_manager_msgs/msg/HardwareComponentState",
            name=self._cell.description.name,
            type="system",
            rw_rate=UPDATES,
            plugin_name="armharness/Simulation",
            state=ACTIVE,
            **self._interfaces(),
        )
        return {"component": [robot]}

    def _types(self, _request: Any) -> dict[str, Any]:
        types = [TRAJECTORY, GRIPPER, BROADCASTER]
        return {"types": types, "base_classes": ["controller_interface::ControllerInterface"] * 3}

    def _switch(self, request: Any) -> dict[str, Any]:
        """Accept what changes nothing: all controllers are active."""
        unknown = [name for name in request.activate_controllers if not self._knows(str(name))]
        stopped = [name for name in request.deactivate_controllers if self._knows(str(name))]
        reason = ""
        if unknown:
            reason = f"there is no controller '{str(unknown[0])[:80]}'"
        elif stopped:
            reason = f"'{stopped[0]}' stays active: the controllers of a scenario cannot be stopped"
        return {"ok": not reason, "message": reason}

    def _is_there(self, request: Any) -> dict[str, Any]:
        return {"ok": self._knows(str(request.name))}

    def _knows(self, name: str) -> bool:
        return name in self._controllers or name == "joint_state_broadcaster"


def _state(name: str, controller: Controller) -> Any:
    interfaces = [f"{joint.name}/position" for joint in controller.joints]
    kind = TRAJECTORY if controller.gripper is None else GRIPPER
    return _described(name, kind, interfaces)


def _described(name: str, kind: str, interfaces: Iterable[str]) -> Any:
    claimed = list(interfaces)
    return message(
        "controller_manager_msgs/msg/ControllerState",
        name=name,
        state="active",
        type=kind,
        update_rate=UPDATES,
        claimed_interfaces=claimed,
        required_command_interfaces=claimed,
    )


def _interface(name: str, *, is_claimed: bool = False) -> Any:
    kind = "controller_manager_msgs/msg/HardwareInterface"
    return message(kind, name=name, data_type="double", is_available=True, is_claimed=is_claimed)


def _point(rows: FloatArray) -> Any:
    """A JointTrajectoryPoint of positions, and as many derivatives as there are rows."""
    keys = ("positions", "velocities", "accelerations")
    values = {key: np.array(row) for key, row in zip(keys, rows, strict=False)}
    return message("trajectory_msgs/msg/JointTrajectoryPoint", **values)


def _snake(name: str) -> str:
    """`ListControllers` is `list_controllers`."""
    return "".join(f"_{c.lower()}" if c.isupper() else c for c in name).lstrip("_")
