"""Classes for the state of a bridge at one moment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum

from roverlink.runtime.bridge.handling_times import Latencies
from roverlink.runtime.bridge.link_exchange import EndReport
from roverlink.runtime.core.board_clock import ClockReport
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.monitoring.liveness import Liveness


class Level(IntEnum):
    """Level of a diagnostic status, with the same numbers as in diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@dataclass(frozen=True)
class RowState:
    """State of one row of the table."""

    number: int
    name: str
    direction: str
    topic: str
    peer: str
    board: str
    """Board of the peer that sends or receives the row's messages; empty if the table names none."""
    count: int
    """Messages bridged since the start."""
    rate: float
    """Messages a second, averaged over the last two seconds."""
    age: float | None
    """Seconds since the last message; None if there was none."""
    expect_rate: float | None
    """Messages a second that the table expects at least; None for no expectation."""
    dropped: Mapping[str, int]
    """Messages that were not bridged, by reason.

    A row to a peer is not charged with datagrams that came from a peer: only the node's drops count those.
    """
    deadman_after: float | None
    """Silence in seconds after which the bridge tells the peer to stop; None if the row has no deadman."""
    stops: int | None
    """Stops sent because the topic was silent (table key ``deadman``); None if the row has no deadman."""
    stopping: bool
    """True if the bridge has sent a stop after the row's last message, so the peer is told to stand still."""
    qos_mismatches: int
    """Number of publishers or subscriptions of other nodes whose QoS does not match the row's."""
    level: Level
    message: str
    """Reason for the level; empty if there is nothing to tell."""


@dataclass(frozen=True)
class EndState:
    """State of a peer, or of a board of a peer."""

    end: EndName
    addresses: tuple[str, ...]
    """Addresses with their ports to which datagrams go now; empty if none is known."""
    link: str
    """State of the address: ``ok``, ``not_learned``, ``not_resolved``, ``not_connected`` or ``unreachable``."""
    liveness: Liveness
    level: Level
    message: str
    fault: str = ""
    """Reason why the line of the end does not work; empty if it works, or if the end has none."""
    clock: ClockReport | None = None
    """Clock of the board; None if the table uses it for no stamp."""


@dataclass(frozen=True)
class Budget:
    """Budget of a peer, in bytes a second with the headers of IP and UDP."""

    limit: int
    used: float
    """Bytes sent a second, averaged over the last two seconds."""
    sent: int
    """Bytes sent since the start."""


@dataclass(frozen=True)
class Recording:
    """State of the recording that a bridge makes."""

    path: str
    waiting: int
    """Messages waiting to be written."""
    lost: int
    """Messages that were not recorded."""
    bytes: int
    """Bytes written to disk."""
    failure: str | None
    """Reason why the recording failed; None while it works."""


@dataclass(frozen=True)
class State:
    """State of a bridge at one moment."""

    node: str
    fingerprint: str
    rows: tuple[RowState, ...]
    received: int
    """Datagrams read from the socket."""
    received_rate: float
    """Datagrams a second, averaged over the last two seconds."""
    forwarded: Mapping[str, int]
    """Received datagrams that were sent on unchanged to another peer, by this peer."""
    unsent: Mapping[str, int]
    """Datagrams that the network refused, by peer."""
    dropped: Mapping[str, int]
    """Datagrams that were not bridged, by reason, including datagrams whose row is unknown."""
    qos_mismatches: Mapping[str, int]
    """Number of publishers and subscriptions of other nodes whose QoS does not match, by topic in the table."""
    kernel_drops: int
    """Datagrams that the kernel dropped because the socket's receive buffer was full."""
    socket_waiting: int
    """Bytes waiting in the socket's receive buffer."""
    socket_size: int
    """Size of the socket's receive buffer in bytes."""
    level: Level
    """Level of the bridge as a whole."""
    message: str
    """Reason for the level of the bridge."""
    ends: tuple[EndState, ...] = ()
    undelivered: Mapping[tuple[str, str, str], int] = field(default_factory=dict)
    """Datagrams to an end that did not leave, because of its line or budget, by peer, board and reason."""
    damaged: Mapping[tuple[str, str], int] = field(default_factory=dict)
    """Frames that were damaged on the line of an end, by peer and board."""
    unforwarded: Mapping[str, int] = field(default_factory=dict)
    """Datagrams that were too long to be forwarded to a peer, by this peer."""
    budgets: Mapping[str, Budget] = field(default_factory=dict)
    """Budget of each peer that has one."""
    withheld: Mapping[tuple[str, str, str], int] = field(default_factory=dict)
    """Datagrams that limits of `forward` kept from a peer, by peer, payload and reason."""
    clocks_ahead: Mapping[str, int] = field(default_factory=dict)
    """Signed datagrams that were accepted more than a minute ahead of this computer's clock, by who signed them."""
    link_events: Mapping[tuple[str, str, str], int] = field(default_factory=dict)
    """Events of the addresses of peers, by peer, board and event."""
    latencies: Latencies = field(default=Latencies((), 0.0))
    recording: Recording | None = None
    links: tuple[EndReport, ...] = ()
    """Result of the link messages of each end; empty for a table without the link message."""
