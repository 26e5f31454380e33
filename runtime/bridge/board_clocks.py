"""Clocks of all boards whose rows stamp messages with the time of measuring (table key ``clock: board``)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from roverlink.runtime.core.board_clock import BoardClock, ClockReport
from roverlink.runtime.core.handler import Stamps
from roverlink.runtime.core.link_statistics import Exchange
from roverlink.runtime.core.registry import AnyHandler, EndName, Registry
from roverlink.runtime.interfaces import Time
from roverlink.runtime.ros_time.clock import MONOTONIC_CLOCK, SYSTEM_CLOCK, Clock

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage


class BoardClocks:
    """Clocks of the boards of a table. The receiving thread uses it; another thread may ask for the reports."""

    def __init__(self, registry: Registry, clock: Clock) -> None:
        """``clock`` shows the time of stamps."""
        routes = [registry.by_name[name].route for name in registry.board_stamps]
        self._clocks = {EndName(route.peer, route.board): BoardClock() for route in routes}
        self._clock = clock
        # Nobody can set it. A simulation has only one clock.
        self._arrivals = MONOTONIC_CLOCK if clock is SYSTEM_CLOCK else clock

    def stamps(self) -> Stamps:
        """Return the stamps of messages that arrive now."""
        now = self._clock.now()
        received = Time.since_1970(now)
        return partial(self._stamp, received, now, self._arrivals.now()) if self._clocks else received

    def _stamp(self, received: Time, now: int, arrived: int, handler: AnyHandler, payload: ProtoMessage) -> Time:
        stamp, route = handler.board_stamp, handler.route
        if stamp is None:
            return received
        age = self._clocks[EndName(route.peer, route.board)].age(stamp, stamp.count(payload), arrived)
        return received if age is None else Time.since_1970(now - age)

    def exchanged(self, end: EndName, exchanges: Sequence[Exchange]) -> None:
        """Take the last exchanges of link messages with an end."""
        for name, clock in self._clocks.items():
            if end in (name, EndName(name.peer)):
                clock.take_exchanges(exchanges)

    def reports(self) -> dict[EndName, ClockReport]:
        """Return what is known of each clock."""
        ahead = self._arrivals.now() - self._clock.now()
        return {end: clock.report(ahead) for end, clock in self._clocks.items()}
