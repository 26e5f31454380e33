"""Classes for the state of a bridge at one moment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum

from roverlink.runtime.monitoring.histogram import Latencies


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
    count: int
    """Messages bridged since the start."""
    rate: float
    """Messages a second, averaged over the last two seconds."""
    age: float | None
    """Seconds since the last message; None if there was none."""
    expect_rate: float | None
    """Messages a second that the table expects at least."""
    dropped: Mapping[str, int]
    """Messages that were not bridged, by reason."""
    qos_mismatches: int
    """Number of publishers or subscriptions of other nodes whose QoS does not match the row's."""
    level: Level
    message: str


@dataclass(frozen=True)
class Recording:
    """State of the recording that a bridge makes."""

    path: str
    waiting: int
    lost: int
    bytes: int
    failure: str | None


@dataclass(frozen=True)
class State:
    """State of a bridge at one moment."""

    node: str
    fingerprint: str
    rows: tuple[RowState, ...]
    received: int
    received_rate: float
    forwarded: Mapping[str, int]
    """Raw datagrams forwarded, by peer."""
    unsent: Mapping[str, int]
    """Datagrams that the network refused, by peer."""
    dropped: Mapping[str, int]
    """Datagrams that were not bridged, by reason, including those of no known row."""
    qos_mismatches: Mapping[str, int]
    """Number of publishers and subscriptions of other nodes whose QoS does not match, by topic in the table."""
    kernel_drops: int
    socket_waiting: int
    """Bytes waiting in the socket's receive buffer."""
    socket_size: int
    """Size of the socket's receive buffer in bytes."""
    level: Level
    """Level of the bridge as a whole."""
    message: str
    latencies: Latencies = field(default=Latencies((), 0.0))
    recording: Recording | None = None
