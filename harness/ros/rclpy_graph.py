"""The port to ROS 2 through the rclpy of an installation, or of its wheels."""

from __future__ import annotations

import importlib
import importlib.util
import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from harness.core.errors import Problem, SpecError
from harness.ros.graph import OnMessage, Publisher, Reply
from harness.ros.interfaces import CANCEL, decoded, encoded
from harness.ros.names import Use


@dataclass
class _Client:
    client: Any
    kind: str

    @property
    def is_ready(self) -> bool:
        return self.client.service_is_ready()

    def call(self, request: Any, on_response: OnMessage) -> None:
        ros_type = self.client.srv_type.Request
        future = self.client.call_async(_to_ros(request, f"{self.kind}_Request", ros_type))
        future.add_done_callback(
            lambda done: on_response(_from_ros(done.result(), f"{self.kind}_Response"))
        )


class RclpyGraph:
    """A node of rclpy; callbacks run inside `spin`."""

    def __init__(
        self, domain: int, *, node: str, is_local: bool = True, say: Callable[[str], None]
    ) -> None:
        """Join a domain, as `open_graph` says."""
        if is_local:
            os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
        try:
            rclpy = importlib.import_module("rclpy")
            self._qos = importlib.import_module("rclpy.qos")
            executors = importlib.import_module("rclpy.executors")
            self._future: Any = importlib.import_module("rclpy.task").Future
        except ImportError as error:
            said = f"rclpy cannot be imported: {error}"
            raise SpecError([Problem("--adapter rclpy", 0, 0, said)]) from error
        self._say = say
        self._context = rclpy.Context()
        rclpy.init(context=self._context, domain_id=domain)
        self._node = rclpy.create_node(node, context=self._context)
        self._executor = executors.SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)

    def advertise(
        self, topic: str, kind: str, *, latched: bool = False, depth: int = 10
    ) -> Publisher:
        package, folder, _ = kind.split("/")
        if folder == "msg" and importlib.util.find_spec(package) is None:
            self._say(f"--adapter rclpy: {topic} is not published: {_advice(package)}")
            return Publisher(kind, lambda _: None, lambda: 0)
        profile = self._profile(latched, True, depth)
        made = self._node.create_publisher(_message_type(kind), topic, profile)
        return Publisher(kind, made.publish, made.get_subscription_count, latched)

    def subscribe(
        self,
        topic: str,
        kind: str,
        on_message: OnMessage,
        *,
        latched: bool = False,
        reliable: bool = True,
    ) -> None:
        def take(payload: bytes) -> None:
            content = decoded(payload, kind)
            if content is not None:
                on_message(content)

        profile = self._profile(latched, reliable, 10)
        self._node.create_subscription(_message_type(kind), topic, take, profile, raw=True)

    def serve(self, name: str, kind: str, on_request: Callable[[Any, Reply], None]) -> None:
        service = _service_type(kind)

        async def answer(content: Any, _: Any) -> Any:
            replied = self._future(executor=self._executor)
            on_request(_from_ros(content, f"{kind}_Request"), replied.set_result)
            return _to_ros(await replied, f"{kind}_Response", service.Response)

        self._node.create_service(service, name, answer)

    def client(self, name: str, kind: str) -> _Client:
        return _Client(self._node.create_client(_service_type(kind), name), kind)

    def uses(self) -> tuple[list[Use], list[Use]]:
        node, qos = self._node, self._qos
        own: list[Use] = []
        others: list[Use] = []
        for topic, _ in node.get_topic_names_and_types():
            for publishes, known in (
                (True, node.get_publishers_info_by_topic(topic)),
                (False, node.get_subscriptions_info_by_topic(topic)),
            ):
                for each in known:
                    profile = each.qos_profile
                    use = Use(
                        topic,
                        each.topic_type,
                        publishes,
                        profile.reliability == qos.ReliabilityPolicy.RELIABLE,
                        profile.durability == qos.DurabilityPolicy.TRANSIENT_LOCAL,
                    )
                    (own if each.node_name == node.get_name() else others).append(use)
        return own, others

    def spin(self, until: float) -> None:
        self._executor.spin_once(timeout_sec=0.0)
        while (left := until - time.monotonic()) > 0:
            self._executor.spin_once(timeout_sec=left)

    def close(self) -> None:
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()

    def _profile(self, latched: bool, reliable: bool, depth: int) -> Any:
        qos = self._qos
        reliability, durability = qos.ReliabilityPolicy, qos.DurabilityPolicy
        return qos.QoSProfile(
            depth=depth,
            reliability=reliability.RELIABLE if reliable else reliability.BEST_EFFORT,
            durability=durability.TRANSIENT_LOCAL if latched else durability.VOLATILE,
        )


def _message_type(kind: str) -> Any:
    """The class of a message in rclpy; feedback of an action has one too."""
    package, folder, name = kind.split("/")
    action, _, part = name.partition("_")
    owner = _imported(f"{package}.{folder}")
    return getattr(getattr(owner, action).Impl, part) if part else getattr(owner, name)


def _service_type(kind: str) -> Any:
    """The class in rclpy of a service of an action."""
    if kind == CANCEL:
        return _imported("action_msgs.srv").CancelGoal
    return _message_type(f"{kind}Service")


def _to_ros(content: Any, kind: str, ros_type: Any) -> Any:
    serialization = importlib.import_module("rclpy.serialization")
    return serialization.deserialize_message(encoded(content, kind), ros_type)


def _from_ros(content: Any, kind: str) -> Any:
    return decoded(importlib.import_module("rclpy.serialization").serialize_message(content), kind)


def _imported(module: str) -> Any:
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        problem = Problem("--adapter rclpy", 0, 0, _advice(module.partition(".")[0]))
        raise SpecError([problem]) from error


def _advice(package: str) -> str:
    """How a package of messages that is not installed gets installed."""
    distribution = os.environ.get("ROS_DISTRO", "DISTRO")
    debian = f"ros-{distribution}-{package.replace('_', '-')}"
    return f"the package `{package}` is not installed; install {debian}, or build it from source"
