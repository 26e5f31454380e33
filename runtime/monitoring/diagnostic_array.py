"""Conversion of a bridge's state to a diagnostic_msgs/DiagnosticArray: a status for the node, each row and each end.

An end is a peer or a board. Ends have a status only if the table has the link message.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from socket import gethostname
from typing import Any
from uuid import uuid4

from roverlink.runtime.bridge.account import by_end
from roverlink.runtime.bridge.link_exchange import DIFFERS, SAME, UNKNOWN, EndReport
from roverlink.runtime.core import cdr
from roverlink.runtime.core.board_clock import ClockReport
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces import Time
from roverlink.runtime.interfaces.diagnostic_msgs import DiagnosticArray, DiagnosticStatus, KeyValue
from roverlink.runtime.interfaces.std_msgs import Header
from roverlink.runtime.middleware import Middleware
from roverlink.runtime.monitoring.state import EndState, Level, RowState, State
from roverlink.runtime.ros_time.clock import Clock

TOPIC = "/diagnostics"
QOS = Qos(depth=10)


def publisher(
    middleware: Middleware, full_name: str, topic: str, clock: Clock
) -> Callable[[Callable[[], State]], None]:
    """Return a function that publishes a bridge's state on ``topic`` as a diagnostic_msgs/DiagnosticArray.

    ``full_name`` is the name of the bridge's node with its namespace. It is published with the host, the process and a
    random id, by which a reader tells bridges with the same name apart (containers can share host and process ids).
    ``clock`` shows the time of the stamps.
    Raises `MiddlewareError` if the package diagnostic_msgs is not installed for rclpy.
    """
    array = middleware.publisher(topic, DiagnosticArray, QOS)
    origin = {"full_name": full_name, "host": gethostname(), "pid": os.getpid(), "instance": uuid4().hex[:8]}

    def publish_state(state: Callable[[], State]) -> None:
        # If nobody listens yet, or a queue is full: the next one follows in a second.
        if array.has_subscribers():
            array.publish([cdr.encode(array_of(state(), clock.now(), origin))])

    return publish_state


def array_of(state: State, now: int, origin: Mapping[str, Any]) -> DiagnosticArray:
    """Return the DiagnosticArray for a state. Its stamp is ``now``, in nanoseconds since 1970.

    ``origin`` holds further values of the node: where the bridge runs.
    """
    header = Header(Time.since_1970(now))
    rows = (_row_status(state.node, row) for row in state.rows)
    ends = (_end_status(state.node, end) for end in state.ends)
    links = (_link_status(state.node, report) for report in state.links)
    return DiagnosticArray(header, [_node_status(state, origin), *rows, *ends, *links])


def _node_status(state: State, origin: Mapping[str, Any]) -> DiagnosticStatus:
    values: dict[str, Any] = {
        **origin,
        "fingerprint": state.fingerprint,
        "received": state.received,
        "received_rate": f"{state.received_rate:.2f}",
        **{f"forwarded.{peer}": count for peer, count in state.forwarded.items()},
        **{f"unsent.{peer}": count for peer, count in state.unsent.items()},
        **{f"undelivered.{subject}": count for subject, count in by_end(state.undelivered).items()},
        **{f"damaged.{end}": count for end, count in by_end(state.damaged).items()},
        **{f"clocks_ahead.{end}": count for end, count in state.clocks_ahead.items()},
        **{f"unforwarded.{peer}": count for peer, count in state.unforwarded.items()},
        **{f"budget.{peer}": budget.limit for peer, budget in state.budgets.items()},
        **{f"budget_used.{peer}": f"{budget.used:.0f}" for peer, budget in state.budgets.items()},
        **{f"withheld.{subject}": count for subject, count in by_end(state.withheld).items()},
        **{f"dropped.{reason}": count for reason, count in state.dropped.items()},
        **{f"qos_mismatches.{topic}": count for topic, count in state.qos_mismatches.items()},
        "kernel_drops": state.kernel_drops,
        "socket_waiting_bytes": state.socket_waiting,
        "socket_size_bytes": state.socket_size,
    }
    for share in (50, 99):
        if (quantile := state.latencies.quantile(share / 100)) is not None:
            values[f"handling_p{share}_us"] = f"{quantile * 1e6:.0f}"
    if recording := state.recording:
        values |= {
            "recording": recording.path,
            "recording_bytes": recording.bytes,
            "recording_waiting": recording.waiting,
            "recording_lost": recording.lost,
        }
    return _status(state.level, state.node, state.message, "", values)


def _row_status(node: str, row: RowState) -> DiagnosticStatus:
    values: dict[str, Any] = {
        "number": row.number,
        "direction": row.direction,
        "topic": row.topic,
        **({"board": row.board} if row.board else {}),
        "count": row.count,
        "rate": f"{row.rate:.2f}",
        **({} if row.age is None else {"age": f"{row.age:.2f}"}),
        **({} if row.expect_rate is None else {"expect_rate": f"{row.expect_rate:g}"}),
        **{f"dropped.{reason}": count for reason, count in row.dropped.items()},
        **(
            {}
            if row.deadman_after is None
            else {"deadman_after": f"{row.deadman_after:g}", "stops": row.stops, "stopping": int(row.stopping)}
        ),
        **({"qos_mismatches": row.qos_mismatches} if row.qos_mismatches else {}),
    }
    return _status(row.level, f"{node}: {row.name}", row.message, row.peer, values)


def _end_status(node: str, state: EndState) -> DiagnosticStatus:
    values: dict[str, Any] = {
        **({"board": state.end.board} if state.end.board else {}),
        "address": ", ".join(state.addresses),
        "link": state.link,
        **({"fault": state.fault} if state.fault else {}),
        "state": state.liveness.state,
        **({} if state.liveness.age is None else {"age": f"{state.liveness.age:.2f}"}),
        **({} if state.clock is None else _clock_values(state.clock)),
    }
    clock = state.clock.problem if state.clock is not None else ""
    message = "; ".join(filter(None, [state.message, clock, *state.addresses]))
    return _status(state.level, f"{node}: link to {state.end}", message, state.end.peer, values)


def _clock_values(clock: ClockReport) -> dict[str, Any]:
    values = {
        "stamps": "receipt" if clock.problem else "board",
        "clock_restarts": clock.restarts,
        "clock_offset": clock.offset,
        "clock_drift": clock.drift,
        "clock_uncertainty": clock.uncertainty,
        "clock_round_trip": clock.round_trip,
    }
    spelled = {"clock_offset": ".6f"}  # seconds since 1970 need more digits than the others
    return {
        name: format(value, spelled.get(name, ".6g")) if isinstance(value, float) else value
        for name, value in values.items()
        if value is not None
    }


def _link_status(node: str, report: EndReport) -> DiagnosticStatus:
    values: dict[str, Any] = {
        **({"board": report.end.board} if report.end.board else {}),
        "schema": report.schema,
        **({"differing": ", ".join(report.differing)} if report.differing else {}),
        **({"untold": ", ".join(report.untold)} if report.untold else {}),
        "senders": report.senders,
        "restarts": report.restarts,
        **{name: f"{value:.6g}" for name, value in report.measured().items()},
    }
    differs = report.schema == DIFFERS
    message = f"another schema of {', '.join(report.differing)}" if differs else _SCHEMA_TEXTS[report.schema]
    return _status(Level.WARN if differs else Level.OK, f"{node} link: {report.end}", message, report.end.peer, values)


_SCHEMA_TEXTS = {SAME: "the same schema", UNKNOWN: "no link message yet"}


def _status(level: int, name: str, message: str, hardware: str, values: Mapping[str, Any]) -> DiagnosticStatus:
    pairs = [KeyValue(key, str(value)) for key, value in values.items()]
    return DiagnosticStatus(int(level), name, message, hardware, pairs)
