"""Requests of a peer to the bridge, and of the bridge to the peer (table key ``request``), without socket and clock."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from roverlink.numerals import counted
from roverlink.runtime.core.errors import RoverlinkError, SetupError
from roverlink.runtime.core.handler import RowRequest
from roverlink.runtime.core.registry import AnyHandler, EndName, Registry
from roverlink.runtime.core.repeater import Fate, Repeater, Responses

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage

Done = Callable[["ProtoMessage | RoverlinkError"], None]
"""Function that gets the response to a request, or the error that ends the request. It is called once."""


class UnansweredError(RoverlinkError):
    """Request that was sent as often as the table says, and has no response."""


class Requests:
    """Requests that the peer or board ``end`` sends, and those that it gets."""

    def __init__(self, registry: Registry, end: EndName) -> None:
        self._registry = registry
        self._sent: dict[str, tuple[RowRequest, Repeater[Done]]] = {}
        self._asked_by: dict[int, str] = {}  # name of the request's row, by the number of the response's row
        self._got: dict[int, tuple[RowRequest, Responses]] = {}
        self._answers: dict[str, int] = {}  # number of the request's row, by the name of the response's row
        self._again: list[bytes] = []
        for handler in registry.handlers:
            route = handler.route
            if route.request is None or route.peer != end.peer or end.board not in ("", route.board):
                continue
            if route.inbound:
                self._sent[route.name] = route.request, Repeater(route.request)
                self._asked_by[registry.by_name[route.request.response].route.number] = route.name
            else:
                self._got[route.number] = route.request, Responses(route.request)
                self._answers[route.request.response] = route.number

    def ask(self, handler: AnyHandler, payload: ProtoMessage, done: Done) -> None:
        """Add a request of a row; ``payload`` is not changed. Raises `SetupError` if the row is no request."""
        name = handler.route.name
        if name not in self._sent:
            raise SetupError(f"the row {name!r} is no request; add `request` to it in mapping.yaml")
        settings, repeater = self._sent[name]
        if repeater.is_full:
            raise SetupError(f"too many requests {name!r} wait for a response")
        number, numbered = repeater.new_number(), type(payload)()
        numbered.CopyFrom(payload)
        if settings.field:
            setattr(numbered, settings.field, number)
        repeater.add(number, self._registry.datagram(name, numbered), done)

    def cancel(self, done: Done, now: float) -> None:
        """Send a request no more, because nobody waits for the response."""
        for _, repeater in self._sent.values():
            repeater.cancel(done, now)

    @property
    def next_due(self) -> float:
        """Time at which `take_due` has something to do; infinity if nothing waits."""
        due = [repeater.next_due for _, repeater in self._sent.values()]
        return min([float("-inf")] if self._again else [*due, float("inf")])

    def take_due(self, now: float) -> list[bytes]:
        """Return the datagrams to send now, and end the requests that were sent often enough."""
        datagrams, self._again = self._again, []
        for name, (settings, repeater) in self._sent.items():
            due, unanswered = repeater.take_due(now)
            datagrams += [datagram for datagram, _ in due]
            for done in unanswered:
                times = counted(settings.attempts, "time")
                done(UnansweredError(f"no response to {name}, which was sent {times}"))
        return datagrams

    def take(self, number: int, payload: Any, now: float) -> Fate | None:
        """Take a payload that has arrived.

        Returns None if it was a response that somebody has waited for. A payload that is `Fate.REPEATED` is of no use
        any more; the program must get one that is `Fate.UNKNOWN`.
        """
        if (name := self._asked_by.get(number)) is not None:
            settings, repeater = self._sent[name]
            found = repeater.answered(settings.number_in(payload), now)
            if isinstance(found, Fate):
                return found
            found(payload)
            return None
        if number not in self._got:
            return Fate.UNKNOWN
        settings, responses = self._got[number]
        known = responses.take(payload.SerializeToString(deterministic=True), settings.number_in(payload), now)
        if isinstance(known, Fate):
            return known
        self._again.append(known)
        return Fate.REPEATED

    def store(self, handler: AnyHandler, payload: ProtoMessage, datagram: bytes) -> None:
        """Store a datagram that is sent if it is a response, in case that the request comes again."""
        if (number := self._answers.get(handler.route.name)) is not None:
            settings, responses = self._got[number]
            responses.store(settings.number_in(payload), datagram)

    def withdraw(self, error: RoverlinkError) -> None:
        """End all requests with an error."""
        for _, repeater in self._sent.values():
            for done, _ in repeater.withdraw():
                done(error)
