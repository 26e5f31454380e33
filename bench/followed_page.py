"""The page of `top --web` without ROS 2, with made-up states: for the pictures of docs/operations.md and the tests."""

from __future__ import annotations

import contextlib
import dataclasses
import logging
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from bench.watched_link import lines_of, url_in
from generated.registry import REGISTRY
from roverlink import link_page
from roverlink.heard_bridges import HeardBridges
from roverlink.link_page.followed_bridges import FollowedBridges
from roverlink.link_page.live_page import LivePage
from roverlink.runtime.bridge.account import Account
from roverlink.runtime.bridge.ends import LinkState
from roverlink.runtime.bridge.handling_times import HandlingTimes, Latencies
from roverlink.runtime.bridge.link_exchange import DIFFERS, SAME, UNKNOWN, EndReport
from roverlink.runtime.core import cdr
from roverlink.runtime.core.board_clock import ClockReport
from roverlink.runtime.core.link_message import LinkMessage
from roverlink.runtime.core.link_statistics import LinkStatistics
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.monitoring import diagnostic_array
from roverlink.runtime.monitoring.liveness import Liveness
from roverlink.runtime.monitoring.monitor import Monitor
from roverlink.runtime.monitoring.state import EndState, Level
from roverlink.runtime.net.udp import SocketState

MOST = 4
"""Most bridges of the page."""


def _exchanged(lost: int) -> LinkStatistics:
    """Return the statistics of an end after twenty link messages, without ``lost`` of 400 datagrams."""
    statistics = LinkStatistics()
    for number in range(1, 21):
        sent_us, late_us = number * 1_000_000, number % 4 * 300
        message = LinkMessage(1, number, 20 * number, 20 * number, sent_us + 2_400, sent_us, 1_000, {})
        statistics.take(message, sent_us + 3_100 + late_us, 20 * number - lost * number // 20, 20 * number)
    return statistics


def _report(board: str, lost: int, *differing: str) -> EndReport:
    statistics = _exchanged(lost)
    losses = {"lost_in": lost, "loss_in": statistics.inbound.recent, "lost_out": 0, "loss_out": 0.0}
    offset = statistics.clock_offset_us
    known: dict[str, Any] = {"statistics": statistics, "clock_offset_us": offset, "senders": 1, "age": 0.4, **losses}
    return EndReport(EndName("hardware", board), DIFFERS if differing else SAME, differing, (), **known)


LINKS = (
    _report("SensorBoard", 9),
    EndReport(EndName("hardware", "ArmBoard"), UNKNOWN, (), ("arm_pos",)),
    _report("DrivingBoard", 0, "drive_diag", "drive_motor"),
)
"""Results of link messages: of a board that loses datagrams, one that has sent none, and one with another schema."""
ENDS = tuple(
    EndState(EndName("hardware", board), addresses, link, Liveness("alive", 0.1, 3.0), level, "")
    for board, addresses, link, level in (
        ("SensorBoard", ("192.168.0.23:8",), "ok", Level.OK),
        ("ArmBoard", (), "not_resolved", Level.WARN),
        ("DrivingBoard", ("192.168.0.22:9",), "ok", Level.OK),
    )
)
"""Ends of the link: the host of a board does not resolve."""


class _Bridge:
    """Bridge that has done nothing yet."""

    def __init__(self) -> None:
        self.account = Account()

    def link_states(self) -> dict[EndName, LinkState]:
        """Return no end of the link."""
        return {}

    def socket_state(self) -> SocketState:
        """Return the state of an empty socket."""
        return SocketState(0, 4096, 0)

    def latencies(self) -> Latencies:
        """Return a histogram without datagrams."""
        return HandlingTimes().latencies

    def link_reports(self) -> list[EndReport]:
        """Return no report: the table has no link message."""
        return []

    def clock_reports(self) -> dict[EndName, ClockReport]:
        """Return no report: the table uses the clock of no board."""
        return {}


class FollowedPage:
    """The page, with the bridges that it hears."""

    def __init__(self, page: LivePage, url: str, now: list[float]) -> None:
        self.url, self.page, self._now = url, page, now
        self.heard = HeardBridges(clock=lambda: self._now[0], most=MOST)
        self.bridges = FollowedBridges(self.heard, page)
        self._idle = Monitor("bridge", REGISTRY, _Bridge()).state()

    def hear(
        self, name: str, after: float = 0.1, ages: dict[str, float] | None = None, links: bool = False, **origin: Any
    ) -> None:
        """Hear the state of a bridge, ``after`` seconds after the last one; ``ages`` are those of rows with messages.

        With ``links``, the bridge tells `ENDS` and `LINKS`. ``origin`` are ``instance``, ``host`` and ``pid`` of its
        process.
        """
        self._now[0] += after
        rows = tuple(
            dataclasses.replace(row, age=ages[row.name], count=7, rate=10.0) if ages and row.name in ages else row
            for row in self._idle.rows
        )
        state = dataclasses.replace(self._idle, node=name, rows=rows, message="nothing lost")
        if links:
            state = dataclasses.replace(state, ends=ENDS, links=LINKS)
        own = {"full_name": f"/{name}", "instance": name, "host": "rover", "pid": 1, **origin}
        self.heard.take(cdr.encode(diagnostic_array.array_of(state, time.time_ns(), own)))
        self.bridges.update()


@contextlib.contextmanager
def followed_page(token_file: Path | None = None) -> Iterator[FollowedPage]:
    """Serve the page on a free port; with ``token_file``, alarms can be acknowledged for all browsers."""
    logger = logging.Logger("top", logging.INFO)
    told = lines_of(logger)
    with contextlib.ExitStack() as stack:
        page = LivePage(logger)
        link_page.serve(page, ("127.0.0.1", 0), token_file, stack, logger)
        yield FollowedPage(page, url_in(told), [1000.0])
