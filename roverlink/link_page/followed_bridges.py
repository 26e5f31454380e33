"""Bridges of a page that shows those that `HeardBridges` hears, for ``roverlink top --web``."""

from __future__ import annotations

import logging
import threading
import time
from collections import deque

from roverlink.heard_bridges import HeardBridge, HeardBridges, full_name, instance, place, running_together
from roverlink.link_page.live_link import LiveLink
from roverlink.link_page.live_page import LivePage
from roverlink.runtime.interfaces.rcl_interfaces import Log

_EARLY_LINES = 1000


class FollowedBridges:
    """Links of a page, one for each bridge that is heard. A bridge that was started again keeps its link.

    So its alarms and curves go on, and a browser that is pinned to it by its name follows it.
    """

    def __init__(self, heard: HeardBridges, page: LivePage) -> None:
        self._heard, self._page = heard, page
        self._links: dict[tuple[str, str], LiveLink] = {}
        # A bridge's log comes before its state, since ROS 2 keeps the last lines for those who subscribe late.
        self._early: deque[Log] = deque(maxlen=_EARLY_LINES)
        self._lock = threading.Lock()

    def update(self) -> None:
        """Pass the newest states to the page, add links for new bridges, and remove those of bridges that are gone."""
        with self._lock:
            self._update()

    def _update(self) -> None:
        bridges = {(full_name(bridge.state), instance(bridge.state)): bridge for bridge in self._heard.bridges}
        for key, bridge in bridges.items():
            if link := self._links.get(key) or self._started_again(key, bridges) or self._new(key, bridges):
                self._links[key] = link
                link.take_state(bridge.state)
        for key in self._links.keys() - bridges.keys():
            self._page.remove(self._links.pop(key).id)
        self._page.warnings = self._heard.warnings()

    def take_log(self, log: Log) -> None:
        """Add a message of ``/rosout`` to the log of its bridge; any thread may call this.

        Bridges with one name share their log.
        """
        with self._lock:
            links = [link for (name, _), link in self._links.items() if _logger_of(name) == log.name]
            if not links:
                self._early.append(log)
            for link in links:
                _add_line(link, log)

    def _started_again(self, key: tuple[str, str], bridges: dict[tuple[str, str], HeardBridge]) -> LiveLink | None:
        """Return the link of a bridge with this name that is no longer heard."""
        gone = next((old for old in self._links if old[0] == key[0] and old not in bridges), None)
        if gone is None:
            return None
        link = self._links.pop(gone)
        link.log.add(time.time(), logging.WARNING, f"the bridge was started again: {place(bridges[key].state)}")
        return link

    def _new(self, key: tuple[str, str], bridges: dict[tuple[str, str], HeardBridge]) -> LiveLink | None:
        """Return a new link; None while it is not known whether the bridge runs beside another one with its name."""
        name, process = key
        if not any(other == name for other, _ in self._links):
            link = self._page.add(name)
            for log in self._early:
                if log.name == _logger_of(name):
                    _add_line(link, log)
            return link
        same = [bridge for (other, _), bridge in bridges.items() if other == name]
        return self._page.add(f"{name}~{process}") if bridges[key] in running_together(same) else None


def _logger_of(name: str) -> str:
    """Return the name of a node's logger: that of /rover/udp_forwarder is rover.udp_forwarder."""
    return name.removeprefix("/").replace("/", ".")


def _add_line(link: LiveLink, log: Log) -> None:
    link.log.add(log.stamp.sec + log.stamp.nanosec / 1e9, log.level, log.msg)
