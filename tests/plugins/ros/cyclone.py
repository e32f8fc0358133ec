"""An action client of GripperCommand on the real Cyclone DDS, framed as rmw_cyclonedds frames it.

Its services have the identity of a request in the content: two numbers before the message.
"""

import time
import uuid
from dataclasses import dataclass, field

from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float64, int8, int32, int64, sequence, uint8, uint32, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from tests.waiting import HANG

ACTION = "control_msgs::action::dds_::GripperCommand_"
RELIABLE = Qos(
    Policy.Reliability.Reliable(duration(seconds=1)),
    Policy.History.KeepAll,
    Policy.DataRepresentation(use_cdrv0_representation=True),
)


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32 = 0
    nanosec: uint32 = 0


@dataclass
class GoalInfo(IdlStruct, typename="action_msgs::msg::dds_::GoalInfo_"):
    goal_id: array[uint8, 16]
    stamp: Time = field(default_factory=Time)


@dataclass
class SendGoal(IdlStruct, typename=f"{ACTION}SendGoal_Request_"):
    client: uint64
    number: int64
    goal_id: array[uint8, 16]
    position: float64
    max_effort: float64


@dataclass
class SendGoalResponse(IdlStruct, typename=f"{ACTION}SendGoal_Response_"):
    client: uint64
    number: int64
    accepted: bool
    stamp: Time


@dataclass
class GetResult(IdlStruct, typename=f"{ACTION}GetResult_Request_"):
    client: uint64
    number: int64
    goal_id: array[uint8, 16]


@dataclass
class GetResultResponse(IdlStruct, typename=f"{ACTION}GetResult_Response_"):
    client: uint64
    number: int64
    status: int8
    position: float64
    effort: float64
    stalled: bool
    reached_goal: bool


@dataclass
class Cancel(IdlStruct, typename="action_msgs::srv::dds_::CancelGoal_Request_"):
    client: uint64
    number: int64
    goal_info: GoalInfo


@dataclass
class CancelResponse(IdlStruct, typename="action_msgs::srv::dds_::CancelGoal_Response_"):
    client: uint64
    number: int64
    return_code: int8
    goals_canceling: sequence[GoalInfo]


class Service:
    """A client of one service."""

    def __init__(self, participant, name, request, response):
        def topic(full, kind):
            return Topic(participant, full, kind, qos=RELIABLE)

        self.writer = DataWriter(participant, topic(f"rq{name}Request", request), qos=RELIABLE)
        self.reader = DataReader(participant, topic(f"rr{name}Reply", response), qos=RELIABLE)
        self.request, self.number = request, 0

    @property
    def is_ready(self):
        return bool(self.writer.get_matched_subscriptions()) and bool(
            self.reader.get_matched_publications()
        )

    def call(self, *fields):
        self.number += 1
        self.writer.write(self.request(4711, self.number, *fields))

    def response(self):
        end = time.monotonic() + HANG
        while time.monotonic() < end:
            for sample in self.reader.take(1):
                if (sample.client, sample.number) == (4711, self.number):
                    return sample
            time.sleep(0.01)
        raise TimeoutError("no response")


class GripperClient:
    """Sends goals of GripperCommand, requests results, and cancels."""

    def __init__(self, domain, name):
        self.participant = DomainParticipant(domain)
        base = f"{name}/_action"
        self.goals = Service(self.participant, f"{base}/send_goal", SendGoal, SendGoalResponse)
        self.results = Service(self.participant, f"{base}/get_result", GetResult, GetResultResponse)
        self.cancels = Service(self.participant, f"{base}/cancel_goal", Cancel, CancelResponse)

    @property
    def is_ready(self):
        return all(each.is_ready for each in (self.goals, self.results, self.cancels))

    def send(self, position, max_effort=0.0):
        goal = list(uuid.uuid4().bytes)
        self.goals.call(goal, position, max_effort)
        return goal, self.goals.response().accepted

    def result(self, goal):
        self.results.call(goal)
        return self.results.response()

    def cancel(self, goal):
        self.cancels.call(GoalInfo(goal))
        return self.cancels.response()


class CancelServer:
    """Answers every request to cancel with the same code."""

    def __init__(self, domain, name):
        self.participant = DomainParticipant(domain)

        def topic(full, kind):
            return Topic(self.participant, full, kind, qos=RELIABLE)

        requests = topic(f"rq{name}Request", Cancel)
        self.reader = DataReader(self.participant, requests, qos=RELIABLE)
        responses = topic(f"rr{name}Reply", CancelResponse)
        self.writer = DataWriter(self.participant, responses, qos=RELIABLE)

    def answer(self, code):
        for request in self.reader.take(10):
            self.writer.write(CancelResponse(request.client, request.number, code, []))
