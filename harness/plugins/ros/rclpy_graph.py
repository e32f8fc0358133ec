"""The port to ROS 2 through the rclpy of an installation, or of its wheels."""

from __future__ import annotations

import importlib
import importlib.util
import os
import time
from collections.abc import Callable
from typing import Any

from harness.core.errors import Problem, SpecError
from harness.plugins.ros.graph import DEFAULT, Client, OnMessage, Publisher, Qos, Reply, Use
from harness.plugins.ros.interfaces import decoded, encoded


class RclpyGraph:
    """A node of rclpy; callbacks run inside `spin`."""

    def __init__(
        self, domain: int, *, node: str, is_local: bool = True, say: Callable[[str], None]
    ) -> None:
        """Join a domain, as `open_graph` says."""
        if is_local:
            os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
        try:
            self._rclpy: Any = importlib.import_module("rclpy")
            for part in ("executors", "qos", "serialization", "task"):
                importlib.import_module(f"rclpy.{part}")
        except ImportError as error:
            reason = f"rclpy cannot be imported: {error}"
            raise SpecError([Problem("--adapter rclpy", 0, 0, reason)]) from error
        self._say, self._context = say, self._rclpy.Context()
        self._rclpy.init(context=self._context, domain_id=domain)
        self._node = self._rclpy.create_node(node, context=self._context)
        self._executor = self._rclpy.executors.SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)

    def advertise(self, topic: str, kind: str, qos: Qos = DEFAULT) -> Publisher:
        package, folder, _ = kind.split("/")
        if folder == "msg" and importlib.util.find_spec(package) is None:
            self._say(f"--adapter rclpy: {topic} is not published: {_advice(package)}")
            return Publisher(kind, lambda _: None, lambda: 0)
        made = self._node.create_publisher(_message_type(kind), topic, self._profile(qos))
        return Publisher(kind, made.publish, made.get_subscription_count, qos.is_latched)

    def subscribe(self, topic: str, kind: str, on_message: OnMessage, qos: Qos = DEFAULT) -> None:
        def take(payload: bytes) -> None:
            content = decoded(payload, kind)
            if content is not None:
                on_message(content)

        ros_type, profile = _message_type(kind), self._profile(qos)
        self._node.create_subscription(ros_type, topic, take, profile, raw=True)

    def serve(self, name: str, kind: str, on_request: Callable[[Any, Reply], None]) -> None:
        service = _service_type(kind)

        async def answer(content: Any, _: Any) -> Any:
            replied = self._rclpy.task.Future(executor=self._executor)
            on_request(self._from_ros(content, f"{kind}_Request"), replied.set_result)
            return self._to_ros(await replied, f"{kind}_Response", service.Response)

        self._node.create_service(service, name, answer)

    def client(self, name: str, kind: str) -> Client:
        service = _service_type(kind)
        client = self._node.create_client(service, name)

        def call(request: Any, on_response: OnMessage) -> None:
            def answered(done: Any) -> None:
                on_response(self._from_ros(done.result(), f"{kind}_Response"))

            content = self._to_ros(request, f"{kind}_Request", service.Request)
            client.call_async(content).add_done_callback(answered)

        return Client(client.service_is_ready, call)

    def uses(self) -> tuple[list[Use], list[Use]]:
        node, qos = self._node, self._rclpy.qos
        own: list[Use] = []
        others: list[Use] = []
        for topic, _ in node.get_topic_names_and_types():
            writers = node.get_publishers_info_by_topic(topic)
            for each in (*writers, *node.get_subscriptions_info_by_topic(topic)):
                is_reliable = each.qos_profile.reliability == qos.ReliabilityPolicy.RELIABLE
                is_latched = each.qos_profile.durability == qos.DurabilityPolicy.TRANSIENT_LOCAL
                quality = Qos(is_reliable, is_latched)
                use = Use(topic, each.topic_type, each in writers, quality)
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

    def _profile(self, requested: Qos) -> Any:
        qos, profile = self._rclpy.qos, self._rclpy.qos.QoSProfile(depth=requested.depth)
        if not requested.is_reliable:
            profile.reliability = qos.ReliabilityPolicy.BEST_EFFORT
        if requested.is_latched:
            profile.durability = qos.DurabilityPolicy.TRANSIENT_LOCAL
        return profile

    def _to_ros(self, content: Any, kind: str, ros_type: Any) -> Any:
        return self._rclpy.serialization.deserialize_message(encoded(content, kind), ros_type)

    def _from_ros(self, content: Any, kind: str) -> Any:
        return decoded(self._rclpy.serialization.serialize_message(content), kind)


def _message_type(kind: str) -> Any:
    """The class of a message in rclpy; feedback of an action has one too."""
    package, folder, name = kind.split("/")
    action, _, part = name.partition("_")
    owner = _imported(f"{package}.{folder}")
    return getattr(getattr(owner, action).Impl, part) if part else getattr(owner, name)


def _service_type(kind: str) -> Any:
    """The class of a service in rclpy; those of an action have other names there."""
    return _message_type(kind if "/srv/" in kind else f"{kind}Service")


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
