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
from harness.ros.graph import Publisher, Reply, ServiceClient
from harness.ros.interfaces import CANCEL, decoded, encoded
from harness.ros.names import Names

_PARTS = ("SendGoal", "GetResult")


@dataclass
class _Codec:
    """Converts messages of one type, through their serialised form."""

    kind: str
    ros_type: Any
    serialization: Any

    def to_ros(self, content: Any) -> Any:
        data = encoded(content, self.kind)
        return self.serialization.deserialize_message(data, self.ros_type)

    def from_ros(self, content: Any) -> Any:
        return decoded(self.serialization.serialize_message(content), self.kind)


class _Silent:
    """Takes the place of a publisher whose message package is not installed."""

    subscribers = 0

    def publish(self, message: Any) -> None:
        """Publish nothing."""


@dataclass
class _Publisher:
    publisher: Any
    codec: _Codec

    @property
    def subscribers(self) -> int:
        return self.publisher.get_subscription_count()

    def publish(self, message: Any) -> None:
        self.publisher.publish(self.codec.to_ros(message))


@dataclass
class _Client:
    client: Any
    request: _Codec
    response: _Codec

    @property
    def is_ready(self) -> bool:
        return self.client.service_is_ready()

    def call(self, request: Any, on_response: Callable[[Any], None]) -> None:
        future = self.client.call_async(self.request.to_ros(request))
        future.add_done_callback(lambda done: on_response(self.response.from_ros(done.result())))


class RclpyGraph:
    """A node of rclpy; callbacks run inside `spin`."""

    def __init__(
        self,
        domain: int,
        *,
        node: str,
        is_local: bool = True,
        say: Callable[[str], None] = lambda _: None,
    ) -> None:
        """Join a domain.

        Args:
            domain: The number of the ROS domain.
            node: The name of the node.
            is_local: Whether it talks to this machine alone.
            say: Receives a note for each topic that cannot be published.

        Raises:
            SpecError: rclpy or a message package cannot be imported.
        """
        if is_local:
            os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
        try:
            rclpy = importlib.import_module("rclpy")
            self._serialization = importlib.import_module("rclpy.serialization")
            self._qos = importlib.import_module("rclpy.qos")
            task = importlib.import_module("rclpy.task")
        except ImportError as error:
            said = f"rclpy cannot be imported: {error}"
            raise SpecError([Problem("--adapter rclpy", 0, 0, said)]) from error
        self._say = say
        self._published: set[str] = set()
        self._subscribed: set[str] = set()
        self._context = rclpy.Context()
        rclpy.init(context=self._context, domain_id=domain)
        self._node = rclpy.create_node(node, context=self._context)
        executors = importlib.import_module("rclpy.executors")
        self._executor = executors.SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._future: Any = task.Future

    def advertise(
        self,
        topic: str,
        kind: str,
        *,
        latched: bool = False,
        depth: int = 10,
    ) -> Publisher:
        package, folder, _ = kind.split("/")
        if folder == "msg" and importlib.util.find_spec(package) is None:
            self._say(f"note: --adapter rclpy: {topic} is not published: {_advice(package)}")
            return _Silent()
        self._published.add(topic)
        codec = self._codec(kind)
        profile = self._profile(latched, True, depth)
        return _Publisher(self._node.create_publisher(codec.ros_type, topic, profile), codec)

    def subscribe(
        self,
        topic: str,
        kind: str,
        on_message: Callable[[Any], None],
        *,
        latched: bool = False,
        reliable: bool = True,
    ) -> None:
        self._subscribed.add(topic)
        codec, profile = self._codec(kind), self._profile(latched, reliable, 10)

        def take(content: Any) -> None:
            on_message(codec.from_ros(content))

        self._node.create_subscription(codec.ros_type, topic, take, profile)

    def serve(self, name: str, kind: str, on_request: Callable[[Any, Reply], None]) -> None:
        service, request, response = self._service(kind)

        async def answer(content: Any, _: Any) -> Any:
            replied = self._future(executor=self._executor)
            on_request(request.from_ros(content), replied.set_result)
            return response.to_ros(await replied)

        self._node.create_service(service, name, answer)

    def client(self, name: str, kind: str) -> ServiceClient:
        service, request, response = self._service(kind)
        return _Client(self._node.create_client(service, name), request, response)

    def names(self) -> tuple[Names, Names]:
        node, own = self._node, Names.of(self._published, self._subscribed)
        topics = [name for name, _ in node.get_topic_names_and_types()]
        published = [n for n in topics if node.count_publishers(n) > (n in own.published)]
        subscribed = [n for n in topics if node.count_subscribers(n) > (n in own.subscribed)]
        return own, Names.of(published, subscribed)

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

    def _codec(self, kind: str) -> _Codec:
        package, folder, name = kind.split("/")
        module = _imported(f"{package}.{folder}")
        action, _, part = name.partition("_")
        if folder == "action" and part == "FeedbackMessage":
            return _Codec(kind, getattr(module, action).Impl.FeedbackMessage, self._serialization)
        return _Codec(kind, getattr(module, name), self._serialization)

    def _service(self, kind: str) -> tuple[Any, _Codec, _Codec]:
        """The service of an action, and the codecs of its request and response."""
        if kind == CANCEL:
            service = _imported("action_msgs.srv").CancelGoal
        else:
            package, folder, name = kind.split("/")
            action, _, part = name.partition("_")
            if part not in _PARTS:
                raise ValueError(f"{kind} is no service of an action")
            service = getattr(
                getattr(_imported(f"{package}.{folder}"), action).Impl, f"{part}Service"
            )
        request = _Codec(f"{kind}_Request", service.Request, self._serialization)
        response = _Codec(f"{kind}_Response", service.Response, self._serialization)
        return service, request, response


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
