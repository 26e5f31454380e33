"""ROS 2 over plain DDS (Cyclone DDS from PyPI): no ROS has to be installed.

To a ROS 2 node we are an ordinary publisher and subscriber: topic ``rt/...``, type ``pkg::msg::dds_::Name_``, plain
XCDR1.
"""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

from cyclonedds.core import DDSException, GuardCondition, ReadCondition, WaitSet
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy
from cyclonedds.qos import Qos as DdsQos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from roverlink.runtime.core.errors import MiddlewareError
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.middleware.cyclone import EVERYTHING, RawReader, RawWriter, delete, delete_at_exit
from roverlink.runtime.middleware.dds_types import dds_qos, dds_type
from roverlink.runtime.middleware.discovery import GraphAnnouncer
from roverlink.runtime.middleware.protocol import Callback, NodeIdentity

_LOCALHOST_ONLY = (
    '<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces></General>'
    '<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="localhost"/></Peers></Discovery>'
    "</Domain></CycloneDDS>"
)
# Else every single writer that is deleted would wait for a subscriber that hangs.
_NO_LINGERING = (
    "<CycloneDDS><Domain><Internal><WriterLingerDuration>0 s</WriterLingerDuration></Internal></Domain></CycloneDDS>"
)
_LARGEST_DOMAIN = 232  # the ports of a larger one would lie beyond 65535 (RTPS 2.2, 9.6.1)
_TAKE = 64  # samples taken at a time
_TAKE_BEHIND = 8  # of a topic that others come before: they wait as long as these take
_LEAVE_S = 0.3  # that subscribers have to acknowledge what was written last


class DdsPublisher:
    """A DDS writer that is given serialized messages."""

    def __init__(self, writer: DataWriter[Any], raw_writer: RawWriter) -> None:
        self._writer = writer
        self.publish = raw_writer.write

    def has_subscribers(self) -> bool:
        """Whether any reader matches."""
        return bool(self._writer.get_matched_subscriptions())


class _Topic(NamedTuple):
    """A topic that is read."""

    reader: RawReader
    callback: Callback
    priority: int

    def serve(self, most: int) -> None:
        """Hand on the oldest messages that have come."""
        if messages := self.reader.take(most):
            self.callback(messages)


class DdsMiddleware:
    """One DDS participant that shows itself as a ROS 2 node, and a thread that takes what its readers receive."""

    def __init__(self, node: NodeIdentity) -> None:
        domain_id = _domain_id()
        try:
            _configure(domain_id)
            self._participant = DomainParticipant(domain_id, qos=DdsQos(Policy.Userdata(b"enclave=/;")))
        except DDSException as error:
            raise MiddlewareError(f"Cyclone DDS cannot join domain {domain_id}: {error}") from error
        self._announcer = GraphAnnouncer(self._participant, node)
        self._waitset = WaitSet(self._participant)
        self._stopped = GuardCondition(self._participant)
        self._waitset.attach(self._stopped)
        self._writers: list[RawWriter] = []
        self._topics: tuple[_Topic, ...] = ()
        self._conditions: list[ReadCondition] = []
        self._open = True
        self._thread = threading.Thread(target=self._take_until_stopped, name="dds-take", daemon=True)
        self._thread.start()

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> DdsPublisher:
        """A writer on a fully qualified topic."""
        policies = dds_qos(qos, writing=True, type_hash=message_type.__typehash__)
        writer = DataWriter(self._participant, self._topic(topic, message_type), qos=policies)
        self._announcer.add_writer(writer)
        raw_writer = RawWriter(writer)
        self._writers.append(raw_writer)
        return DdsPublisher(writer, raw_writer)

    def subscribe(
        self, topic: str, message_type: type[Message], qos: Qos, callback: Callback, priority: int = 0
    ) -> RawReader:
        """Call ``callback`` with the serialized messages of a fully qualified topic, from the taking thread."""
        policies = dds_qos(qos, writing=False, type_hash=message_type.__typehash__)
        reader = DataReader(self._participant, self._topic(topic, message_type), qos=policies)
        condition = ReadCondition(reader, EVERYTHING)
        raw_reader = RawReader(reader)
        read = _Topic(raw_reader, callback, priority)
        self._topics = tuple(sorted((*self._topics, read), key=lambda one: one.priority, reverse=True))
        self._conditions.append(condition)
        self._waitset.attach(condition)
        self._announcer.add_reader(reader)
        return raw_reader

    def close(self) -> None:
        """Take the node away, once subscribers have had a moment to acknowledge what was written last."""
        if not self._open:
            return
        self._open = False
        self._stopped.set(True)
        self._thread.join()
        deadline = time.monotonic() + _LEAVE_S
        for writer in self._writers:
            writer.wait_for_acknowledgement(max(0.0, deadline - time.monotonic()))
        delete(self._participant)

    def __enter__(self) -> DdsMiddleware:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _topic(self, topic: str, message_type: type[Message]) -> Topic[Any]:
        return Topic(self._participant, f"rt{topic}", dds_type(message_type))

    def _take_until_stopped(self) -> None:
        while not self._stopped.read():
            self._waitset.wait(duration(infinite=True))
            _serve(self._topics)


def _serve(topics: Sequence[_Topic]) -> None:
    """A batch of each in turn: a topic that is never empty delays no other, and not the end.

    Before each, those of a higher priority have another turn, so that they wait for one small batch and no more.
    """
    for index, topic in enumerate(topics):
        urgent = [other for other in topics[:index] if other.priority > topic.priority]
        for other in urgent:
            other.serve(_TAKE_BEHIND)
        topic.serve(_TAKE_BEHIND if urgent else _TAKE)


def _domain_id() -> int:
    text = os.environ.get("ROS_DOMAIN_ID", "") or "0"
    if not text.isdecimal() or int(text) > _LARGEST_DOMAIN:
        raise MiddlewareError(f"ROS_DOMAIN_ID is {text!r}; it must be a number from 0 to {_LARGEST_DOMAIN}")
    return int(text)


def _configure(domain_id: int) -> None:
    """Keep to this host where ROS 2's environment says so, and no Cyclone DDS configuration of the user's own does."""
    users_own = os.environ.get("CYCLONEDDS_URI", "")
    reach = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE")
    local = os.environ.get("ROS_LOCALHOST_ONLY") == "1" or reach == "LOCALHOST"
    _domain(domain_id, users_own or (_LOCALHOST_ONLY if local else ""))


@cache
def _domain(domain_id: int, configuration: str) -> Domain | None:
    """A domain is configured once a process, before its first participant, and lives as long as the process."""
    try:
        domain = Domain(domain_id, ",".join(filter(None, (_NO_LINGERING, configuration))))
    except DDSException as error:
        # Another part of the program was in the domain before us, and has configured it.
        logging.getLogger("roverlink").warning("DDS domain %d keeps the configuration it has: %s", domain_id, error)
        return None
    delete_at_exit(domain)
    return domain
