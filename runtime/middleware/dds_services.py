"""Services over plain DDS, for ROS 2 clients that use Cyclone DDS (rmw_cyclonedds_cpp).

A service ``/node/x`` has the DDS topics ``rq/node/xRequest`` and ``rr/node/xReply``. A Cyclone client puts two fields
before those of the request, and the response repeats them: the client's identification and the request's number.

A Fast DDS client needs the same two values elsewhere, in the inline QoS of the response (PID_RELATED_SAMPLE_IDENTITY).
Cyclone DDS 11 neither writes this parameter nor tells the sequence number of a received sample. A Fast DDS client
therefore never gets a response.
"""

from __future__ import annotations

import itertools
import secrets
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from cyclonedds.core import GuardCondition, ReadCondition, WaitSet
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Int64, Message, UInt64
from roverlink.runtime.middleware.cyclone import EVERYTHING, RawReader, RawWriter
from roverlink.runtime.middleware.dds_types import dds_qos, dds_type
from roverlink.runtime.middleware.discovery import GraphAnnouncer
from roverlink.runtime.middleware.parameter_services import PARAMETERS_QOS, Service, answering
from roverlink.runtime.middleware.protocol import Respond

_TAKE = 16  # most requests taken at a time
_MATCH_S = 0.1  # longest wait for the client's reader, as in rmw_cyclonedds_cpp
_LOOK_S = 0.01
_ENCAPSULATION = 4  # bytes of CDR's own header
_BODY = _ENCAPSULATION + 16
_MOST_WAITING = 256


@dataclass
class _Header(Message):
    """Fields that rmw_cyclonedds_cpp puts before those of a request and of a response (``cdds_request_header_t``)."""

    client: UInt64 = 0
    number: Int64 = 0


def _with_header(message_type: type[Message]) -> Any:
    """Return a message type with the fields of `_Header` before the fields of ``message_type``."""
    # dataclasses and `fields_of` take the fields of the last base first.
    return dataclass(type(message_type.__name__, (message_type, _Header), {}))


class DdsServices:
    """Services of one node and its clients of services, with their own thread: they must not hold up the topics."""

    def __init__(self, participant: DomainParticipant, announcer: GraphAnnouncer) -> None:
        self._participant, self._announcer = participant, announcer
        self._waitset = WaitSet(participant)
        self._stopped = GuardCondition(participant)
        self._waitset.attach(self._stopped)
        self._ends: tuple[_Server | DdsClient, ...] = ()
        self._responses: deque[Callable[[], None]] = deque()
        self._responded = GuardCondition(participant)
        self._waitset.attach(self._responded)
        self._thread = threading.Thread(target=self._take_until_stopped, name="dds-services", daemon=True)
        self._thread.start()

    def answer(self, node: str, services: Sequence[Service]) -> None:
        """Offer services below ``node``, the fully qualified name of the node: ``/rover/bridge/get_parameters``."""
        for service in services:
            self.offer(f"{node}/{service.name}", service.request, service.response, answering(service))

    def offer(
        self,
        name: str,
        request: type[Message],
        response: type[Message],
        answer: Callable[[bytes, Respond], None],
    ) -> None:
        """Offer a service with a fully qualified name; see `Middleware.offer`."""
        self._add(_Server(self._participant, self._announcer, name, (request, response), answer, self._do_later))

    def client(self, name: str, request: type[Message], response: type[Message]) -> DdsClient:
        """Create a client of the service with a fully qualified name."""
        client = DdsClient(self._participant, self._announcer, name, (request, response))
        self._add(client)
        return client

    def close(self) -> None:
        """Stop the thread; later requests get no response."""
        self._stopped.set(True)
        self._thread.join()

    def _add(self, end: _Server | DdsClient) -> None:
        self._ends = (*self._ends, end)  # before the thread is woken for it
        self._waitset.attach(end.condition)

    def _do_later(self, respond: Callable[[], None]) -> None:
        """Let the thread write a response: it may have to wait for the client's reader, which no other thread may."""
        self._responses.append(respond)
        self._responded.set(True)

    def _take_until_stopped(self) -> None:
        while not self._stopped.read():
            self._waitset.wait(duration(infinite=True))
            self._responded.set(False)
            for end in self._ends:
                end.take()
            while self._responses:
                self._responses.popleft()()


class _Endpoints:
    """Writer and reader of one end of a service."""

    def __init__(
        self,
        participant: DomainParticipant,
        announcer: GraphAnnouncer,
        written: tuple[str, type[Message]],
        read: tuple[str, type[Message]],
    ) -> None:
        """Open the topics; each comes with the type of its messages."""
        topics: list[Topic[Any]] = [
            Topic(participant, name, dds_type(_with_header(message_type))) for name, message_type in (written, read)
        ]
        self.writer = DataWriter(participant, topics[0], qos=dds_qos(PARAMETERS_QOS, writing=True))
        self.reader = DataReader(participant, topics[1], qos=dds_qos(PARAMETERS_QOS, writing=False))
        self.condition = ReadCondition(self.reader, EVERYTHING)
        self.raw_reader, self.raw_writer = RawReader(self.reader), RawWriter(self.writer)
        announcer.add_writer(self.writer)
        announcer.add_reader(self.reader)

    def taken(self) -> Iterator[tuple[bytes, bytes]]:
        """Yield the header of each message that has arrived, and the message without it."""
        for data in self.raw_reader.take(_TAKE):
            if len(data) >= _BODY:
                yield data[_ENCAPSULATION:_BODY], data[:_ENCAPSULATION] + data[_BODY:]

    def write(self, header: bytes, message: bytes) -> bool:
        """Write a message with a header; return false if DDS does not accept it."""
        # The header has 16 bytes, so that the fields behind it keep their alignment.
        data = message[:_ENCAPSULATION] + header + message[_ENCAPSULATION:]
        return self.raw_writer.write([data]) == 1


class _Server:
    """One service: a reader of requests and a writer of responses."""

    def __init__(
        self,
        participant: DomainParticipant,
        announcer: GraphAnnouncer,
        name: str,
        types: tuple[type[Message], type[Message]],
        answer: Callable[[bytes, Respond], None],
        do_later: Callable[[Callable[[], None]], None],
    ) -> None:
        self._answer, self._do_later = answer, do_later
        self._ends = _Endpoints(participant, announcer, (f"rr{name}Reply", types[1]), (f"rq{name}Request", types[0]))
        self.condition = self._ends.condition

    def take(self) -> None:
        """Answer the requests that have arrived, or let them be answered later."""
        for header, request in self._ends.taken():
            self._answer(request, partial(self._respond_later, header))

    def _respond_later(self, header: bytes, response: bytes) -> None:
        self._do_later(partial(self._respond, header, response))

    def _respond(self, header: bytes, response: bytes) -> None:
        self._wait_for_the_clients_reader()
        self._ends.write(header, response)

    def _wait_for_the_clients_reader(self) -> None:
        """Wait until each client that can send a request can also receive the response, at most 0.1 s.

        DDS may discover the client's reader of responses after the client's writer of requests.
        """
        deadline = time.monotonic() + _MATCH_S
        writer, reader = self._ends.writer, self._ends.reader
        while time.monotonic() < deadline and len(writer.get_matched_subscriptions()) < len(
            reader.get_matched_publications()
        ):
            time.sleep(_LOOK_S)


class DdsClient:
    """Client of one service: a writer of requests and a reader of responses. Several threads may call."""

    def __init__(
        self,
        participant: DomainParticipant,
        announcer: GraphAnnouncer,
        name: str,
        types: tuple[type[Message], type[Message]],
    ) -> None:
        self._ends = _Endpoints(participant, announcer, (f"rq{name}Request", types[0]), (f"rr{name}Reply", types[1]))
        self.condition = self._ends.condition
        self._identity = secrets.randbits(64)
        self._numbers = itertools.count(1)
        self._waiting: dict[bytes, Respond] = {}

    def call(self, request: bytes, done: Respond) -> bool:
        """Send a request; return false if no node offers the service."""
        ends = self._ends
        if not (ends.writer.get_matched_subscriptions() and ends.reader.get_matched_publications()):
            return False
        header = cdr.encode(_Header(self._identity, next(self._numbers)))[_ENCAPSULATION:]
        self._waiting[header] = done
        if len(self._waiting) > _MOST_WAITING:  # a node that does not answer must not fill the memory
            self._waiting.pop(next(iter(self._waiting)), None)
        return ends.write(header, request)

    def take(self) -> None:
        """Pass on the responses that have arrived. Those to other clients of the service arrive, too."""
        for header, response in self._ends.taken():
            if (done := self._waiting.pop(header, None)) is not None:
                done(response)
