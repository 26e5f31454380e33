"""ROS 2 over zenoh, as a node of rmw_zenoh_cpp, without a ROS installation (module `zenoh_keys` has the conventions).

- A publisher never waits: zenoh discards a message for which a link has no room, and does not tell.
- Zenoh's threads call our callbacks directly, and these only put messages into bounded queues. With zenoh's own queues,
  one slow callback would hold up all topics of the session.
- The configuration is that of rmw_zenoh: ``ZENOH_SESSION_CONFIG_URI`` and ``ZENOH_CONFIG_OVERRIDE``.
"""

from __future__ import annotations

import contextlib
import itertools
import logging
import queue
import sys
import threading
import time
from collections import defaultdict, deque
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import zenoh

from roverlink.numerals import counted
from roverlink.runtime.core.errors import MiddlewareError
from roverlink.runtime.core.handler import Qos, RowService
from roverlink.runtime.core.messages import Message
from roverlink.runtime.core.type_hash import service_hash, type_hash
from roverlink.runtime.middleware.dds_names import dds_type_name
from roverlink.runtime.middleware.late_messages import LATE_NS, Delay
from roverlink.runtime.middleware.parameter_services import (
    PARAMETERS_QOS,
    ParameterServices,
    answering,
    parameter_events,
)
from roverlink.runtime.middleware.protocol import (
    Callback,
    Endpoint,
    Middleware,
    NodeIdentity,
    NodeParameters,
    Respond,
)
from roverlink.runtime.middleware.ros_domain import ros_domain
from roverlink.runtime.middleware.serving import KEPT_TO_READ, ServedTopic, has_ended, serve
from roverlink.runtime.middleware.zenoh_config import open_session, reason_of
from roverlink.runtime.middleware.zenoh_graph import ZenohGraph
from roverlink.runtime.middleware.zenoh_keys import (
    CLIENT,
    DEFAULT_QOS,
    NODE,
    PUBLISHER,
    SERVICE,
    SUBSCRIPTION,
    Attachment,
    Attachments,
    Entity,
    hash_in_key,
)

_HEARTBEAT_S = 0.5  # as in rmw_zenoh
# Between two rounds of our thread, so that it takes the messages of a flood together. Two threads that hand each other
# the interpreter for every message spend twice the CPU.
_ROUND_S = 0.002
_SWITCH_S = 0.0005  # longest wait of zenoh's threads for the interpreter, once for each message; Python's own is 5 ms
_WARN_S = 2.0
_NAMED = 3  # topics in a warning

_Later = Callable[[Callable[[], None]], None]


class ZenohPublisher:
    """Publisher of one topic."""

    def __init__(self, publisher: Any, attachments: Attachments, has_subscribers: Callable[[], bool]) -> None:
        self._put, self._attachments = publisher.put, attachments
        self.has_subscribers = has_subscribers

    def publish(self, messages: Sequence[bytes], /) -> int:
        """Publish serialized messages; return how many were accepted: all of them until the session is closed."""
        for accepted, message in enumerate(messages):
            try:
                self._put(message, attachment=self._attachments.next())
            except zenoh.ZError:
                return accepted
        return len(messages)


class ZenohSubscription:
    """Subscription of one topic, and the messages that wait for the thread of the middleware."""

    def __init__(
        self,
        topic: str,
        qos: Qos,
        exact_depth: bool,
        late: Callable[[], None] | None,
        wake: Callable[[ZenohSubscription], None],
        has_publishers: Callable[[], bool],
    ) -> None:
        depth = None if qos.history == "keep_all" else qos.depth if exact_depth else max(qos.depth, KEPT_TO_READ)
        self.waiting: deque[bytes] = deque(maxlen=depth)
        self.topic, self._late, self._wake, self.has_publishers = topic, late, wake, has_publishers
        # What was published before the subscription began is wanted, and old.
        self._delays = None if qos.durability == "transient_local" else defaultdict[bytes, Delay](Delay)
        self.lags = False
        """True if a message was late since the last warning."""
        self.replaced = 0
        """Number of messages that newer ones have replaced since the last warning, unless this is what was wanted."""
        self._counts_replaced = not exact_depth
        self.close: Callable[[], None] = lambda: None

    def put(self, sample: Any) -> None:
        """Let a message wait, unless it is late and must not be delivered then. Called by zenoh's threads."""
        if self._is_late(sample.attachment):
            if self._late is not None:
                self._late()
                return
            self.lags = True
        if self._counts_replaced and len(self.waiting) == self.waiting.maxlen:
            self.replaced += 1
        self.waiting.append(sample.payload.to_bytes())
        self._wake(self)

    def take(self, most: int) -> list[bytes]:
        """Take at most ``most`` messages, the oldest first."""
        return [self.waiting.popleft() for _ in range(min(most, len(self.waiting)))]

    def _is_late(self, data: Any) -> bool:
        if data is None or self._delays is None or (attachment := Attachment.unpacked(data.to_bytes())) is None:
            return False
        return self._delays[attachment.gid].of(attachment.sent, time.monotonic_ns()) > LATE_NS


class ZenohClient:
    """Client of one service."""

    def __init__(
        self, get: Callable[..., object], attachments: Attachments, exists: Callable[[], bool], later: _Later
    ) -> None:
        self._get, self._attachments, self._exists, self._later = get, attachments, exists, later

    def call(self, request: bytes, done: Respond) -> bool:
        """Send a request; return false if no node offers the service."""
        if not self._exists():
            return False
        waiting = [done]  # a second server's response is one too many

        def take(reply: Any) -> None:
            if reply.ok is not None and waiting:
                self._later(partial(waiting.pop(), reply.ok.payload.to_bytes()))

        self._get(_directly(take), payload=request, attachment=self._attachments.next())
        return True


class ZenohMiddleware(Middleware):
    """Session of zenoh that appears as a ROS 2 node.

    One thread calls the callbacks of the topics, and a second one serves the services.
    """

    passes_any_qos = True

    def __init__(self, node: NodeIdentity, parameters: NodeParameters | None = None) -> None:
        self._node, self._domain = node, ros_domain()
        self._session = open_session()
        sys.setswitchinterval(min(sys.getswitchinterval(), _SWITCH_S))
        self._numbers = itertools.count()
        self._held: list[Any] = []  # zenoh undeclares what nobody refers to
        self._jobs: queue.Queue[Callable[[], None] | None] = queue.Queue()
        self._topics: dict[ZenohSubscription, ServedTopic] = {}  # begins with the largest priority; never changed
        self._changing = threading.Lock()
        self._ready: dict[ZenohSubscription, None] = {}  # those with messages, in the order of arrival
        self._arrived = threading.Event()
        self._open = True
        self._graph = ZenohGraph(self._session, self._domain, self._jobs.put)
        self._announce(self._entity(NODE))
        self._parameters: NodeParameters | ParameterServices | None = parameters
        if parameters is not None:
            self._parameters = offered = ParameterServices(parameters, parameter_events(self, node))
            for service in offered.services():
                name = f"{node.full_name}/{service.name}"
                self._offer(name, service.request, service.response, answering(service))
        self._services = threading.Thread(target=self._serve_services, name="zenoh-services", daemon=True)
        self._thread = threading.Thread(target=self._take_until_stopped, name="zenoh-take", daemon=True)
        for thread in (self._services, self._thread):
            thread.start()

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> ZenohPublisher:
        """Create a publisher for a fully qualified topic. Raises `MiddlewareError` if zenoh refuses a latched one."""
        entity = self._topic(PUBLISHER, topic, message_type, qos)
        settings: dict[str, Any] = {"congestion_control": zenoh.CongestionControl.DROP}
        if qos.reliability == "best_effort":
            settings["reliability"] = zenoh.Reliability.BEST_EFFORT
        if qos.durability == "transient_local":
            heartbeat = zenoh.ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=_HEARTBEAT_S)
            try:
                made: Any = zenoh.ext.declare_advanced_publisher(
                    self._session,
                    entity.key(self._domain),
                    cache=zenoh.ext.CacheConfig(qos.depth),
                    publisher_detection=True,
                    sample_miss_detection=heartbeat if qos.reliability == "reliable" else None,
                    **settings,
                )
            except zenoh.ZError as error:  # without timestamps
                raise MiddlewareError(f"{topic}: {reason_of(error)}") from error
        else:
            made = self._session.declare_publisher(entity.key(self._domain), **settings)
        self._held.append(made)
        return ZenohPublisher(made, self._announce(entity)[1], partial(self._graph.has, SUBSCRIPTION, entity))

    def subscribe(
        self,
        topic: str,
        message_type: type[Message],
        qos: Qos,
        callback: Callback,
        priority: int = 0,
        exact_depth: bool = False,
        late: Callable[[], None] | None = None,
    ) -> ZenohSubscription:
        """Call ``callback`` with the serialized messages of a fully qualified topic, on the middleware's thread."""
        entity = self._topic(SUBSCRIPTION, topic, message_type, qos)
        subscription = ZenohSubscription(
            topic,
            qos,
            exact_depth,
            late and partial(self._jobs.put, late),
            self._wake,
            partial(self._graph.has, PUBLISHER, entity),
        )
        self._set_topic(subscription, ServedTopic(subscription, callback, priority))
        key, put = entity.key(self._domain), _directly(subscription.put)
        if qos.durability == "transient_local":
            recovery = zenoh.ext.RecoveryConfig(periodic_queries=None, heartbeat=True)
            made: Any = zenoh.ext.declare_advanced_subscriber(
                self._session,
                key,
                put,
                history=zenoh.ext.HistoryConfig(detect_late_publishers=True, max_samples=qos.depth),
                subscriber_detection=True,
                recovery=recovery if qos.reliability == "reliable" else None,
            )
        else:
            made = self._session.declare_subscriber(key, put)
        token, _ = self._announce(entity)
        ends = (token, made)
        self._held += ends

        def close() -> None:
            self._set_topic(subscription, None)
            for end in ends:
                end.undeclare()
                self._held.remove(end)

        subscription.close = close
        return subscription

    def offer(self, name: str, service: RowService, answer: Callable[[bytes, Respond], None]) -> None:
        """Offer a service with a fully qualified name."""
        self._offer(name, service.request, service.response, answer)

    def client(self, name: str, service: RowService) -> ZenohClient:
        """Create a client of the service with a fully qualified name."""
        entity = self._service(CLIENT, name, service.request, service.response)
        querier = self._session.declare_querier(
            entity.key(self._domain),
            target=zenoh.QueryTarget.ALL_COMPLETE,
            consolidation=zenoh.ConsolidationMode.NONE,
        )
        self._held.append(querier)
        exists = partial(self._graph.has, SERVICE, entity)
        return ZenohClient(querier.get, self._announce(entity)[1], exists, self._jobs.put)

    def topics(self) -> Mapping[str, str]:
        """Return the topics with publishers that are known now, each with its message type."""
        return self._graph.topics()

    def endpoints(self, topic: str, publishing: bool) -> list[Endpoint]:
        """Return the publishers or the subscriptions of a fully qualified topic that are known now."""
        return self._graph.endpoints(topic, publishing)

    def set_parameters(self, changes: Mapping[str, Any]) -> None:
        """Change parameters of the own node."""
        if self._parameters is not None:
            self._parameters.change(changes)

    def close(self) -> None:
        """Leave the ROS 2 graph."""
        if not self._open:
            return
        self._open = False
        self._arrived.set()
        self._jobs.put(None)
        if has_ended(self._thread) and has_ended(self._services):
            # Zenoh waits 10 s for a link whose other end does not read.
            closing = threading.Thread(target=self._close_session, name="zenoh-close", daemon=True)
            closing.start()
            has_ended(closing)

    def _close_session(self) -> None:
        with contextlib.suppress(zenoh.ZError):  # it has waited in vain
            self._session.close()

    def _topic(self, kind: str, topic: str, message_type: type[Message], qos: Qos) -> Entity:
        return self._entity(kind, topic, message_type.__msgtype__, type_hash(message_type), qos)

    def _service(self, kind: str, name: str, request: type[Message], response: type[Message]) -> Entity:
        service = request.__msgtype__.removesuffix("_Request")
        return self._entity(kind, name, service, service_hash(request, response), PARAMETERS_QOS)

    def _entity(self, kind: str, name: str = "", type: str = "", hash: str = "", qos: Qos = DEFAULT_QOS) -> Entity:
        session = str(self._session.zid())
        return Entity(kind, session, self._node, name, type and dds_type_name(type), hash and hash_in_key(hash), qos)

    def _announce(self, entity: Entity) -> tuple[Any, Attachments]:
        """Declare the token of an entity, after the entity itself; return the token and the sender's attachments."""
        text = entity.token(self._domain, next(self._numbers))
        token = self._session.liveliness().declare_token(text)
        self._held.append(token)
        return token, Attachments(text)

    def _offer(
        self, name: str, request: type[Message], response: type[Message], answer: Callable[[bytes, Respond], None]
    ) -> None:
        entity = self._service(SERVICE, name, request, response)
        key = entity.key(self._domain)

        def ask(query: Any) -> None:
            self._jobs.put(partial(_answer, key, query, answer))

        self._held.append(self._session.declare_queryable(key, _directly(ask), complete=True))
        self._announce(entity)

    def _set_topic(self, subscription: ZenohSubscription, topic: ServedTopic | None) -> None:
        with self._changing:
            topics = {**self._topics, subscription: topic}
            kept = [(one, served) for one, served in topics.items() if served is not None]
            self._topics = dict(sorted(kept, key=lambda one: one[1].priority, reverse=True))

    def _wake(self, subscription: ZenohSubscription) -> None:
        self._ready[subscription] = None
        self._arrived.set()

    def _take_until_stopped(self) -> None:
        warn_at = next_round = 0.0
        while self._open:
            self._arrived.wait()
            time.sleep(max(next_round - time.monotonic(), 0.0))
            self._arrived.clear()
            while self._open and self._ready:
                served = self._take_once()
                if time.monotonic() > warn_at and _warn_of_slowness(served):
                    warn_at = time.monotonic() + _WARN_S
            next_round = time.monotonic() + _ROUND_S

    def _take_once(self) -> Sequence[ZenohSubscription]:
        """Serve the topics that have messages now, and return them."""
        topics, arrived = self._topics, [*self._ready]
        for subscription in arrived:
            del self._ready[subscription]
        ready = [subscription for subscription in arrived if subscription in topics]  # the others are closed
        served = sorted((topics[one] for one in ready), key=lambda topic: topic.priority, reverse=True)
        serve(topics.values(), served)
        for subscription in ready:
            if subscription.waiting:
                self._ready[subscription] = None
        return ready

    def _serve_services(self) -> None:
        while (job := self._jobs.get()) is not None:
            job()


def _warn_of_slowness(subscriptions: Sequence[ZenohSubscription]) -> bool:
    """Log which topics have late messages, or more than can wait; return false if there are none."""
    slow = [subscription for subscription in subscriptions if subscription.lags or subscription.replaced]
    if slow:
        lost = sum(subscription.replaced for subscription in slow)
        logging.getLogger("roverlink").warning(
            "a link or this program is too slow: %s, on %s",
            f"{counted(lost, 'message')} gave way to newer ones" if lost else "messages come more than a second late",
            ", ".join(subscription.topic for subscription in slow[:_NAMED])
            + (f" and {len(slow) - _NAMED} other topics" if len(slow) > _NAMED else ""),
        )
    for subscription in slow:
        subscription.lags, subscription.replaced = False, 0
    return bool(slow)


def _directly(function: Callable[[Any], None]) -> Any:
    """Return a handler with which zenoh's own thread calls a function, without a queue and a thread in between."""
    return zenoh.handlers.Callback(function, indirect=False)


def _answer(key: str, query: Any, answer: Callable[[bytes, Respond], None]) -> None:
    """Let a request be answered; the response repeats the client's number and GID."""
    asked = None if query.attachment is None else Attachment.unpacked(query.attachment.to_bytes())
    if asked is None or query.payload is None:
        logging.getLogger("roverlink").warning("%s: a request without the attachment of rmw_zenoh was ignored", key)
        query.drop()
        return

    def respond(response: bytes) -> None:
        query.reply(key, response, attachment=asked._replace(sent=time.time_ns()).packed())
        query.drop()  # the client waits for it

    answer(query.payload.to_bytes(), respond)
