"""ROS 2 over plain DDS (Cyclone DDS from PyPI), without a ROS installation.

Other ROS 2 nodes see an ordinary publisher or subscriber. This module follows the rules of the ROS 2 middlewares:
- The DDS topic of ``/imu`` is ``rt/imu``; the type of ``comms/msg/Imu`` is ``comms::msg::dds_::Imu_``.
- Samples are plain XCDR1, as `roverlink.runtime.core.cdr` writes them.
- The node's name is announced on the topic ``ros_discovery_info`` (module `discovery`).
"""

from __future__ import annotations

import atexit
import logging
import os
import threading
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property, partial
from typing import Any

from cyclonedds.core import DDSException, GuardCondition, Listener, ReadCondition, WaitSet
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy
from cyclonedds.qos import Qos as DdsQos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from roverlink.runtime.core.errors import MiddlewareError
from roverlink.runtime.core.handler import Qos, RowService
from roverlink.runtime.core.messages import Message
from roverlink.runtime.core.tap import Tap
from roverlink.runtime.middleware.cyclone import (
    EVERYTHING,
    MatchedReaders,
    MatchedWriters,
    NativeWaitSet,
    RawReader,
    RawWriter,
    delete,
    reading_functions,
)
from roverlink.runtime.middleware.dds_graph import DdsGraph
from roverlink.runtime.middleware.dds_services import DdsClient, DdsServices
from roverlink.runtime.middleware.dds_types import dds_qos, dds_type
from roverlink.runtime.middleware.discovery import GraphAnnouncer
from roverlink.runtime.middleware.joined_addresses import JoinedAddresses, is_local
from roverlink.runtime.middleware.parameter_services import ParameterServices, parameter_events
from roverlink.runtime.middleware.protocol import (
    Callback,
    Endpoint,
    Middleware,
    NodeIdentity,
    NodeParameters,
    Respond,
)
from roverlink.runtime.middleware.ros_domain import ros_domain
from roverlink.runtime.middleware.serving import ServedTopic, has_ended, serve
from roverlink.runtime.native import bridge_layout as native
from roverlink.runtime.native.core import NativeCore
from roverlink.runtime.native.lending import LentTopic
from roverlink.runtime.native.topic_loop import TopicLoop

_LOCALHOST_ONLY = (
    '<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces></General>'
    '<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="localhost"/></Peers></Discovery>'
    "</Domain></CycloneDDS>"
)
# Otherwise the deletion of each writer waits for a subscriber that hangs. And Fast DDS, which reads nothing but the key
# hash of what is disposed, would show our node for ten seconds after it has left.
_LEAVE_AT_ONCE = (
    "<CycloneDDS><Domain><Internal><WriterLingerDuration>0 s</WriterLingerDuration>"
    "<GenerateKeyhash>true</GenerateKeyhash></Internal></Domain></CycloneDDS>"
)
# Cyclone DDS refuses the type objects of Fast DDS 3 (ROS 2 Kilted), and then matches none of its endpoints. ROS 2 goes
# by the names of types alone. 1.15 is the vendor id of eProsima.
_WITHOUT_FAST_TYPES = (
    "<CycloneDDS><Domain><Compatibility><IgnoreTypeInformation>1.15</IgnoreTypeInformation></Compatibility></Domain>"
    "</CycloneDDS>"
)
_RMW, _CYCLONE = "RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp"
_LEAVE_S = 0.3  # time for subscribers to acknowledge the last messages


class DdsPublisher:
    """DDS writer for serialized messages."""

    def __init__(self, writer: RawWriter, readers: MatchedReaders, keeps_samples: bool) -> None:
        """Write through ``writer``; ``readers`` tells if the writer has matching readers.

        ``keeps_samples`` is true if the writer keeps samples for readers that come later.
        """
        self._writer, self._readers, self._writes_always = writer, readers, keeps_samples

    def publish(self, messages: Sequence[bytes], /) -> int:
        """Write serialized messages; return how many were accepted."""
        # Without a reader, Cyclone DDS discards a sample. To find this out it takes 3 us of CPU with warm caches, and
        # 15 us at 1,000 single messages per second.
        if self._readers.exist or self._writes_always:
            return self._writer.write(messages)
        return len(messages)

    def lend_to(self, topic: native.Topic, functions: native.MiddlewareFunctions) -> Sequence[Tap]:
        """Let the native core publish through this publisher (see `NativePublisher`)."""
        self._writer.lend_to(topic, functions)
        if not self._writes_always:
            self._readers.tell(topic)
        return ()

    def leave(self, seconds: float) -> None:
        """Wait until every subscriber has acknowledged all messages, at most ``seconds``.

        Call it just before the node leaves the graph. After that, `publish` accepts no message.
        """
        self._writes_always = True
        self._writer.wait_for_acknowledgement(seconds)

    def has_subscribers(self) -> bool:
        """Return true if DDS has found a reader that matches this writer."""
        return self._readers.exist


class DdsSubscription:
    """DDS reader for serialized messages."""

    def __init__(
        self,
        reader: RawReader,
        writers: MatchedWriters,
        lend: Callable[[NativeCore, LentTopic], None],
        close: Callable[[], None],
    ) -> None:
        self.has_publishers = reader.has_publishers
        self.watch = partial(writers.left.__setitem__, reader.reference)
        self.lend_to = lend
        self.close = close


class DdsMiddleware(Middleware):
    """DDS participant that appears as a ROS 2 node.

    One thread takes the samples that its readers have received, and calls the callbacks of the topics.
    """

    def __init__(self, node: NodeIdentity, parameters: NodeParameters | None = None) -> None:
        self._domain_id = domain_id = ros_domain()
        self._writers = MatchedWriters()
        try:
            self._participant = _join(domain_id, self._writers)
        except DDSException as error:
            raise MiddlewareError(f"Cyclone DDS cannot join domain {domain_id}: {error}") from error
        # Cyclone DDS calls the listeners of what was not deleted until the domain has gone, so Python must keep them.
        _unfinished.add(self)
        self._joined_addresses = JoinedAddresses()
        self._announcer = GraphAnnouncer(self._participant, node)
        self._waitset = WaitSet(self._participant)
        self._stopped = GuardCondition(self._participant)
        self._waitset.attach(self._stopped)
        self._publishers: list[DdsPublisher] = []
        self._topics: tuple[ServedTopic, ...] = ()
        self._serving = threading.RLock()  # held while readers are taken from, so that none is deleted meanwhile
        self._changing = threading.RLock()  # held while the topics change; before `_serving`
        self._conditions: dict[int, ReadCondition] = {}
        self._native: TopicLoop | None = None
        self._changed = GuardCondition(self._participant)
        self._services: DdsServices | None = None
        self._parameters: NodeParameters | ParameterServices | None = parameters
        # A Fast DDS client would see the services, but wait forever for a response (module `dds_services`).
        if parameters is not None and os.environ.get(_RMW) == _CYCLONE:
            self._parameters = ParameterServices(parameters, parameter_events(self, node))
            self._opened_services().answer(node.full_name, self._parameters.services())
        self._open = True
        self._thread = threading.Thread(target=self._take_until_stopped, name="dds-take", daemon=True)
        self._thread.start()

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> DdsPublisher:
        """Create a DDS writer for a fully qualified topic."""
        policies = dds_qos(qos, writing=True, type_hash=message_type.__typehash__)
        readers = MatchedReaders()
        writer = DataWriter(self._participant, self._topic(topic, message_type), qos=policies, listener=readers)
        self._announcer.add_writer(writer)
        publisher = DdsPublisher(RawWriter(writer), readers, keeps_samples=qos.durability == "transient_local")
        self._publishers.append(publisher)
        return publisher

    def subscribe(
        self,
        topic: str,
        message_type: type[Message],
        qos: Qos,
        callback: Callback,
        priority: int = 0,
        exact_depth: bool = False,
        late: Callable[[], None] | None = None,  # noqa: ARG002  # DDS keeps no more than the depth
    ) -> DdsSubscription:
        """Call ``callback`` with the serialized messages of a fully qualified topic, on the middleware's thread."""
        policies = dds_qos(qos, writing=False, type_hash=message_type.__typehash__, exact_depth=exact_depth)
        reader = DataReader(self._participant, self._topic(topic, message_type), qos=policies)
        condition = ReadCondition(reader, EVERYTHING)
        raw_reader = RawReader(reader)
        # The package deletes an entity in DDS when Python collects it (see `cyclone`), so everything is kept here.
        self._conditions[id(raw_reader)] = condition
        self._waitset.attach(condition)
        with self._changing:
            self._set_topics((*self._topics, ServedTopic(raw_reader, callback, priority)))
        self._announcer.add_reader(reader)

        def others() -> list[ServedTopic]:
            return [topic for topic in self._topics if topic.reader is not raw_reader]

        def lend(core: NativeCore, lent: LentTopic) -> None:
            with self._changing:
                self._native = self._native or TopicLoop(core, reading_functions())
                lent.struct.reader = raw_reader.reference
                self._set_topics((*others(), ServedTopic(raw_reader, callback, priority, lent)))

        def close() -> None:
            with self._changing:
                self._set_topics(others())
                with self._serving:
                    self._announcer.remove_reader(reader)
                    self._waitset.detach(condition)
                    del self._conditions[id(raw_reader)]
                    self._writers.left.pop(raw_reader.reference, None)
                    delete(reader)

        return DdsSubscription(raw_reader, self._writers, lend, close)

    def offer(self, name: str, service: RowService, answer: Callable[[bytes, Respond], None]) -> None:
        """Offer a service for clients that use Cyclone DDS; log a warning if those of this computer do not."""
        if os.environ.get(_RMW) == _CYCLONE:
            self._opened_services().offer(name, service.request, service.response, answer)
            return
        logging.getLogger("roverlink").warning(
            "the service %s is not offered: with the middleware dds, only clients with %s=%s get a response; "
            "set it, or use --middleware rclpy",
            name,
            _RMW,
            _CYCLONE,
        )

    def client(self, name: str, service: RowService) -> DdsClient:
        """Create a client of a service, which a node must offer that uses Cyclone DDS."""
        return self._opened_services().client(name, service.request, service.response)

    def _opened_services(self) -> DdsServices:
        self._services = self._services or DdsServices(self._participant, self._announcer)
        return self._services

    def endpoints(self, topic: str, publishing: bool) -> list[Endpoint]:
        """Return the publishers or the subscriptions of a fully qualified topic that DDS has found so far."""
        return self._graph.endpoints(topic, publishing)

    def topics(self) -> Mapping[str, str]:
        """Return the topics with publishers that DDS has found so far, each with its message type."""
        return self._graph.topics()

    def address_changes(self) -> str:
        """Return a text about addresses that have changed since the node joined ROS 2; empty if none have."""
        return self._joined_addresses.changes()

    def set_parameters(self, changes: Mapping[str, Any]) -> None:
        """Change parameters of the own node."""
        if self._parameters is not None:
            self._parameters.change(changes)

    def close(self) -> None:
        """Leave the ROS 2 graph. First wait up to 0.3 s for subscribers to acknowledge the last messages."""
        if not self._open:
            return
        self._open = False
        # The guard conditions wake the taking thread, which else waits without a limit.
        self._stopped.set(True)
        self._wake_native()
        if not has_ended(self._thread):
            return
        if self._native is not None:
            self._native.close()
        if self._services is not None:
            self._services.close()
        # One deadline for all writers together: leaving must not take longer with more topics.
        deadline = time.monotonic() + _LEAVE_S
        for publisher in self._publishers:
            publisher.leave(max(0.0, deadline - time.monotonic()))
        _leave(self._participant, self._domain_id)
        _unfinished.discard(self)

    @cached_property
    def _graph(self) -> DdsGraph:
        # Made when it is first used, because most commands never ask for it.
        return DdsGraph(self._participant, self._announcer.topic, self._announcer.types.participant)

    def _topic(self, topic: str, message_type: type[Message]) -> Topic[Any]:
        # ROS 2 marks its topics with the prefix `rt`, and services with `rq` and `rr` (design.ros2.org, "Topic and
        # Service name mapping to DDS"). `topic` begins with a slash.
        return Topic(self._participant, f"rt{topic}", dds_type(message_type))

    def _set_topics(self, topics: Iterable[ServedTopic]) -> None:
        self._topics = tuple(sorted(topics, key=lambda topic: topic.priority, reverse=True))
        self._wake_native()

    def _wake_native(self) -> None:
        """Make the native core, if it takes the messages, return to the thread."""
        if self._native is not None:
            self._native.stop()
        self._changed.set(True)

    def _take_until_stopped(self) -> None:
        # A guard condition stays triggered until it is taken, so a stop before the wait ends it, too.
        while not self._stopped.read():
            if self._native is not None:
                self._serve_natively(self._native)
                continue
            self._waitset.wait(duration(infinite=True))
            with self._serving:
                serve(self._topics, self._topics)

    def _serve_natively(self, server: TopicLoop) -> None:
        """Let the native core serve the topics until they change, or until the thread has to end."""
        with self._changing:
            self._changed.set(False)
            topics = self._topics
            conditions = {
                index: self._conditions[id(topic.reader)]
                for index, (topic, is_direct) in enumerate(zip(topics, server.prepare(topics)))
                if not is_direct
            }
            self._serving.acquire()
        try:
            if not self._stopped.read():
                with NativeWaitSet(self._participant, conditions, self._changed) as waitset:
                    server.run(waitset.reference, waitset.wake)
        finally:
            self._serving.release()


_domains: dict[int, tuple[Domain, str]] = {}
"""Domains that this process has configured, each with the configuration."""
_joining = threading.Lock()
_unfinished: set[DdsMiddleware] = set()
"""Nodes that have not left their domain, perhaps because a thread hangs."""


def _join(domain_id: int, listener: Listener) -> DomainParticipant:
    """Join a DDS domain, which gets our configuration if this process has not joined it yet.

    DDS stays on this host if ROS 2's environment variables ask for it and CYCLONEDDS_URI is not set.
    """
    # A user's own configuration has priority.
    users_own = os.environ.get("CYCLONEDDS_URI", "") or (_LOCALHOST_ONLY if is_local() else "")
    configuration = ",".join(filter(None, (_LEAVE_AT_ONCE, _WITHOUT_FAST_TYPES, users_own)))
    with _joining:
        if _domains.get(domain_id, ("", ""))[1] != configuration:
            _configure(domain_id, configuration)
        # The user data that ROS 2 sets on its participants: the default security enclave.
        return DomainParticipant(domain_id, DdsQos(Policy.Userdata(b"enclave=/;")), listener)


def _configure(domain_id: int, configuration: str) -> None:
    try:
        domain = Domain(domain_id, configuration)
    except DDSException as error:
        # We, or another part of the program, have joined the domain before and have configured it.
        logging.getLogger("roverlink").warning(
            "DDS domain %d is in use by this process already and keeps its configuration: %s", domain_id, error
        )
        return
    _domains[domain_id] = domain, configuration


def _leave(participant: DomainParticipant, domain_id: int) -> None:
    """Leave a DDS domain. The domain's threads and ports go with the last participant of this process."""
    with _joining:
        delete(participant)
        domain, _ = _domains.get(domain_id, (None, ""))
        if domain is not None and not domain.get_participants():
            delete(domain)
            del _domains[domain_id]


@atexit.register
def _leave_all() -> None:
    """Delete the domains before Python shuts down (see "Deletion" in `cyclone`)."""
    for domain, _ in _domains.values():
        delete(domain)
