"""Rows that are requests, and the rows that answer them (table key ``request``).

- A request to a peer comes from a ROS 2 service. It is sent again until the response comes, and each call gets exactly
  one answer: the response, or an error. Messages on the request's topic are sent once, as those of any other row.
- A request from a peer is passed on once: to the topic, or to a ROS 2 service if the table names one. If the peer
  repeats it, the bridge sends the stored response again. A service replaces the topic, because a node at the topic and
  one at the service would both carry out the request.

The receiving thread, the timekeeper and threads of the middleware use these rows. While a service, a client or a
subscriber is called, the lock of the exchange is not held.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

from roverlink.numerals import counted
from roverlink.runtime.bridge.to_peer import OutboundRow, PublisherWatch
from roverlink.runtime.bridge.to_topic import InboundRow
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError, DatagramError, Reason
from roverlink.runtime.core.handler import RowRequest, RowService
from roverlink.runtime.core.messages import Message, fields_of
from roverlink.runtime.core.registry import AnyHandler, Registry
from roverlink.runtime.core.repeater import Fate, Repeater, Responses
from roverlink.runtime.middleware import Middleware, Respond, ServiceClient, Subscription

_ERROR = "error"  # field of each service's response
_STOPPING = "the bridge stops"
_IN_PYTHON = "requests and responses are matched in Python"


class _Call(NamedTuple):
    """Call of a service, whose response comes from a peer."""

    service: RowService
    respond: Respond

    def fail(self, error: str) -> None:
        """End the call without a response of the peer."""
        response = self.service.response()
        setattr(response, _ERROR, error)
        self.respond(cdr.encode(response))


class Exchange:
    """Request and the response that answers it: what the rows of both share."""

    response_row: ResponseToPeer
    """Row of the responses to a peer, if the request comes from there."""

    def __init__(self, request: AnyHandler, response: AnyHandler, settings: RowRequest) -> None:
        self.request, self.response, self.settings = request, response, settings
        self.lock = threading.Lock()
        """Lock to hold while `calls` or `responses` is used."""
        self.calls: Repeater[_Call] = Repeater(settings)
        """Calls of the service that wait for a response of the peer."""
        self.responses = Responses(settings)
        """Requests that the peer has sent, with the datagrams of their responses."""
        self.wake: Callable[[], None] = lambda: None
        """Function that wakes the timekeeper."""


def exchanges(registry: Registry) -> dict[str, Exchange]:
    """Return the exchange of each row that is a request or answers one, by the row's name."""
    found: dict[str, Exchange] = {}
    for handler in registry.handlers:
        if (settings := handler.route.request) is not None:
            exchange = Exchange(handler, registry.by_name[settings.response], settings)
            found |= {handler.route.name: exchange, settings.response: exchange}
    return found


def in_python(exchanges: Mapping[str, Exchange]) -> dict[str, str]:
    """Return why the native core must not handle a row, by the row's name, for the rows of some exchanges."""
    # The messages on the topic of a request to a peer are sent as those of any other row.
    outgoing = {one.request.route.name for one in exchanges.values() if not one.request.route.inbound}
    return dict.fromkeys([name for name in exchanges if name not in outgoing], _IN_PYTHON)


def inbound_row(exchange: Exchange, handler: AnyHandler, *given: Any) -> InboundRow:
    """Return the row of a request or of a response that comes from a peer; ``given`` is what an `InboundRow` needs."""
    kind = RequestFromPeer if handler is exchange.request else ResponseFromPeer
    return kind(exchange, handler.route, *given)


def outbound_row(exchange: Exchange, handler: AnyHandler, *given: Any) -> OutboundRow:
    """Return the row of a request or of a response that goes to a peer; ``given`` is what an `OutboundRow` needs."""
    kind = RequestToPeer if handler is exchange.request else ResponseToPeer
    return kind(exchange, handler, *given)


def _converted(data: bytes, source: type[Message], target: type[Message], number: int = 0) -> bytes:
    """Return a serialized message as another type: fields have the values of the source's fields of the same name.

    A field of the target that the source lacks is the correlation field, which gets ``number``, or the error.
    """
    message, names = cdr.decode(source, data), {field.name for field in fields_of(source)}
    values = {
        field.name: getattr(message, field.name) if field.name in names else "" if field.name == _ERROR else number
        for field in fields_of(target)
    }
    return cdr.encode(target(**values))


class RequestToPeer(OutboundRow):
    """Row of requests to a peer: a timed task that sends each request again until it is answered."""

    is_timed = True

    def __init__(self, exchange: Exchange, *given: Any) -> None:
        super().__init__(*given)
        self._exchange, self._is_open = exchange, True

    def connect(self, subscription: Subscription, wake: Callable[[], None]) -> PublisherWatch | None:
        """Store ``wake``, as any row does."""
        self._exchange.wake = wake
        return super().connect(subscription, wake)

    def offer(self, middleware: Middleware, topic: Callable[[str], str]) -> None:
        """Offer the service, if the table names one; ``topic`` returns its full name."""
        if (service := self._exchange.settings.service) is not None:
            middleware.offer(topic(service.name), service, partial(self._ask, service))

    def _ask(self, service: RowService, data: bytes, respond: Respond) -> None:
        """Send the request of a call; the middleware calls this. ``respond`` is called once, with the response."""
        call = _Call(service, respond)
        if error := self._add(data, call):
            call.fail(error)
        else:
            self.run_due(time.monotonic())
            self.wake()

    def _add(self, data: bytes, call: _Call) -> str:
        """Add a call to those that wait; return the reason if that is not possible."""
        calls = self._exchange.calls
        with self.lock, self._exchange.lock:
            self._account.taken[self.name] += 1
            if not self._is_open or calls.is_full:
                self._account.superseded[self.name] += 1
                return "too many calls wait" if self._is_open else _STOPPING
            if self.refused:
                self._account.refused[self.name] += 1
                return self._of_another_schema()
            try:
                number = calls.new_number()
                message = _converted(data, call.service.request, self._handler.message_type, number)
                calls.add(number, self._translator.send(self._handler, message), call)
            except ConversionError as error:
                self._account.refused[self.name] += 1
                return str(error)
        return ""

    def run_due(self, now: float) -> None:
        """Send what is due, and answer the calls whose request was sent often enough without a response."""
        # Whoever holds the lock sends just now; the next round looks again.
        if not self.lock.acquire(blocking=False):
            return
        try:
            if self.refused:
                ended, error = self._withdrawn(), self._of_another_schema()
            else:
                ended, error = self._send_due(now), self._unanswered()
        finally:
            self.lock.release()
        for call in ended:
            self._warnings.warn(f"unanswered {self.name}", error)
            call.fail(error)

    def _send_due(self, now: float) -> list[_Call]:
        """Send what is due, and return the calls that end without a response."""
        with self._exchange.lock:
            datagrams, unanswered = self._exchange.calls.take_due(now)
        for datagram, again in datagrams:
            if again:
                self._account.repeated[self.name] += self._send([datagram])
            else:
                self._send_and_count([datagram])
        self._account.unanswered[self.name] += len(unanswered)
        return unanswered

    @property
    def next_due(self) -> float:
        """Time at which a request must be sent again, or counts as unanswered; at once if requests are refused."""
        with self._exchange.lock:
            due = self._exchange.calls.next_due
        return -math.inf if self.refused and due < math.inf else due

    def end_calls(self) -> None:
        """Answer all calls that wait, and those to come, with an error. Call it when no timekeeper runs any more."""
        with self.lock:
            self._is_open = False
            ended = self._withdrawn()
        for call in ended:
            call.fail(_STOPPING)

    def _withdrawn(self) -> list[_Call]:
        """Forget all requests, and return their calls."""
        with self._exchange.lock:
            withdrawn = self._exchange.calls.withdraw()
        self._account.superseded[self.name] += sum(not was_sent for _, was_sent in withdrawn)
        return [call for call, _ in withdrawn]

    def _unanswered(self) -> str:
        peer, attempts = self._handler.route.peer, self._exchange.settings.attempts
        return f"{peer} has not answered {self.name}, which was sent {counted(attempts, 'time')}"

    def _of_another_schema(self) -> str:
        return f"{self._handler.route.peer} has another schema of {self.name}"


class ResponseFromPeer(InboundRow):
    """Row of the responses of a peer: each answers the call that waits for it; all are published, but once."""

    def __init__(self, exchange: Exchange, *given: Any) -> None:
        super().__init__(*given)
        self._exchange = exchange

    def take(self, messages: Sequence[bytes]) -> None:
        """Answer the calls, and publish the messages that have not come before."""
        exchange = self._exchange
        for message in messages:
            number = exchange.settings.number_in(exchange.response.from_cdr(message))
            with exchange.lock:
                found = exchange.calls.answered(number, time.monotonic())
            if found is Fate.REPEATED:
                self._account.dropped[Reason.REPEATED.value] += 1
                continue
            if not isinstance(found, Fate):
                found.respond(_converted(message, exchange.response.message_type, found.service.response))
                exchange.wake()  # the next one may be due
            super().take([message])


class RequestFromPeer(InboundRow):
    """Row of the requests of a peer: each is passed on once."""

    def __init__(self, exchange: Exchange, *given: Any) -> None:
        super().__init__(*given)
        self._exchange = exchange
        self._called: tuple[ServiceClient, RowService] | None = None

    def open_client(self, middleware: Middleware, topic: Callable[[str], str]) -> None:
        """Open a client of the service, if the table names one; ``topic`` returns its full name."""
        if (service := self._exchange.settings.service) is not None:
            self._called = middleware.client(topic(service.name), service), service

    def take(self, messages: Sequence[bytes]) -> None:
        """Pass on the requests that are new, and send the stored responses to the others."""
        exchange = self._exchange
        for message in messages:
            number = exchange.settings.number_in(exchange.request.from_cdr(message))
            with exchange.lock:
                found = exchange.responses.take(message, number, time.monotonic())
            if found is not Fate.UNKNOWN:
                self._account.dropped[Reason.REPEATED.value] += 1
                if isinstance(found, bytes):
                    exchange.response_row.repeat(found)
            elif self._called is None:
                super().take([message])
            else:
                self._call(*self._called, message, number)

    def _call(self, client: ServiceClient, service: RowService, message: bytes, number: int) -> None:
        name = self._route.name
        request = _converted(message, self._exchange.request.message_type, service.request)
        if client.call(request, partial(self._answer, service, message, number)):
            self._account.count_published(name, 1)
        else:
            self._forget(message)
            error = f"{name} ({self._route.number}): no node offers the service {service.name}"
            self._drop(DatagramError(Reason.NOT_PUBLISHED, error, name))

    def _answer(self, service: RowService, request: bytes, number: int, data: bytes) -> None:
        """Send the response of the service to the peer. If it is an error, the peer may ask again."""
        exchange = self._exchange
        try:
            error = getattr(cdr.decode(service.response, data), _ERROR)
            message = _converted(data, service.response, exchange.response.message_type, number)
        except ConversionError as misfit:
            error = f"{service.name}: {misfit}"
        if error:
            self._forget(request)
            exchange.response_row.tell(f"the service {service.name} has not answered: {error}")
        else:
            exchange.response_row.take([message])

    def _forget(self, request: bytes) -> None:
        with self._exchange.lock:
            self._exchange.responses.forget(request)


class ResponseToPeer(OutboundRow):
    """Row of the responses to a peer: each is stored, so that it can be sent again if the peer asks again."""

    def __init__(self, exchange: Exchange, *given: Any) -> None:
        super().__init__(*given)
        self._exchange = exchange
        exchange.response_row = self

    def repeat(self, datagram: bytes) -> None:
        """Send a stored response again."""
        with self.lock:
            if self.refused:
                return
            self._account.repeated[self.name] += self._send([datagram])

    def tell(self, error: str) -> None:
        """Log a warning about a request that has no response."""
        self._warnings.warn(f"unanswered {self.name}", error)

    def _send_and_count(self, datagrams: Sequence[bytes]) -> None:
        for datagram in datagrams:
            payload = getattr(self._translator.parse(datagram), self.name)
            with self._exchange.lock:
                self._exchange.responses.store(self._exchange.settings.number_in(payload), datagram)
        super()._send_and_count(datagrams)
