"""Services over plain DDS, for ROS 2 clients that use Cyclone DDS (rmw_cyclonedds_cpp).

A service ``/node/x`` has the DDS topics ``rq/node/xRequest`` and ``rr/node/xReply``. A Cyclone client puts two fields
before those of the request, and the response repeats them: the client's identification and the request's number.

A Fast DDS client needs the same two values elsewhere, in the inline QoS of the response (PID_RELATED_SAMPLE_IDENTITY).
Cyclone DDS 11 neither writes this parameter nor tells the sequence number of a received sample. A Fast DDS client
therefore never gets a response.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cyclonedds.core import GuardCondition, ReadCondition, WaitSet
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Int64, Message, UInt64, fields_of
from roverlink.runtime.middleware.cyclone import EVERYTHING, RawReader, RawWriter
from roverlink.runtime.middleware.dds_types import dds_qos, dds_type
from roverlink.runtime.middleware.discovery import GraphAnnouncer
from roverlink.runtime.middleware.parameter_services import Service

_QOS = Qos(depth=1000)  # rmw_qos_profile_parameters
_TAKE = 16  # most requests taken at a time
_MATCH_S = 0.1  # longest wait for the client's reader, as in rmw_cyclonedds_cpp
_LOOK_S = 0.01


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
    """Services of one node, with their own thread: a request must not hold up the node's topics."""

    def __init__(
        self, participant: DomainParticipant, announcer: GraphAnnouncer, node: str, services: Sequence[Service]
    ) -> None:
        """Offer services below ``node``, the fully qualified name of the node: ``/rover/bridge/get_parameters``."""
        self._waitset = WaitSet(participant)
        self._stopped = GuardCondition(participant)
        self._waitset.attach(self._stopped)
        self._servers = [_Server(participant, announcer, f"{node}/{service.name}", service) for service in services]
        for server in self._servers:
            self._waitset.attach(server.condition)
        self._thread = threading.Thread(target=self._answer_until_stopped, name="dds-services", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stop the thread; later requests get no response."""
        self._stopped.set(True)
        self._thread.join()

    def _answer_until_stopped(self) -> None:
        while not self._stopped.read():
            self._waitset.wait(duration(infinite=True))
            for server in self._servers:
                server.answer_requests()


class _Server:
    """One service: a reader of requests and a writer of responses."""

    def __init__(self, participant: DomainParticipant, announcer: GraphAnnouncer, name: str, service: Service) -> None:
        self._service = service
        self._request, self._response = _with_header(service.request), _with_header(service.response)
        requests: Topic[Any] = Topic(participant, f"rq{name}Request", dds_type(self._request))
        responses: Topic[Any] = Topic(participant, f"rr{name}Reply", dds_type(self._response))
        self._writer = DataWriter(participant, responses, qos=dds_qos(_QOS, writing=True))
        self._reader = DataReader(participant, requests, qos=dds_qos(_QOS, writing=False))
        self.condition = ReadCondition(self._reader, EVERYTHING)
        self._raw_reader, self._raw_writer = RawReader(self._reader), RawWriter(self._writer)
        announcer.add_writer(self._writer)
        announcer.add_reader(self._reader)

    def answer_requests(self) -> None:
        """Answer the requests that have arrived."""
        for data in self._raw_reader.take(_TAKE):
            try:
                request = cdr.decode(self._request, data)
            except ConversionError as error:
                logging.getLogger("roverlink").warning("request to %s ignored: %s", self._service.name, error)
                continue
            answer = self._service.answer(request)
            values = [getattr(answer, field.name) for field in fields_of(self._service.response)]
            self._wait_for_the_clients_reader()
            self._raw_writer.write([cdr.encode(self._response(request.client, request.number, *values))])

    def _wait_for_the_clients_reader(self) -> None:
        """Wait until each client that can send a request can also receive the response, at most 0.1 s.

        DDS may discover the client's reader of responses after the client's writer of requests.
        """
        deadline = time.monotonic() + _MATCH_S
        while time.monotonic() < deadline and len(self._writer.get_matched_subscriptions()) < len(
            self._reader.get_matched_publications()
        ):
            time.sleep(_LOOK_S)
