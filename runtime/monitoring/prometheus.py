"""Conversion of a bridge's state to Prometheus metrics, and the HTTP server from which Prometheus reads the metrics."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from itertools import accumulate
from typing import Any

from prometheus_client import CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, HistogramMetricFamily, Metric
from prometheus_client.registry import Collector
from prometheus_client.utils import floatToGoString

from roverlink.runtime.bridge.handling_times import BOUNDS_S, Latencies
from roverlink.runtime.bridge.link_exchange import UNKNOWN
from roverlink.runtime.core.board_clock import ClockReport
from roverlink.runtime.monitoring.state import State
from roverlink.runtime.net.http_server import HttpServer
from roverlink.runtime.net.page_requests import Answer, is_this_computer, not_found, refusal

# The version of the text format (prometheus.io, "Exposition formats").
CONTENT_TYPE = "text/plain; version=0.0.4; charset=utf-8"

Samples = list[tuple[Mapping[str, Any], float]]


def text_of(state: State) -> str:
    """Return all metrics of a state in the Prometheus text format."""
    # A new registry for each scrape: the global one would add metrics of this process, and two bridges would clash.
    registry = CollectorRegistry()
    registry.register(_StateCollector(state))
    return generate_latest(registry).decode()


class _StateCollector(Collector):
    """Collector, in the sense of prometheus_client, of the metrics of one state."""

    def __init__(self, state: State) -> None:
        self._state = state

    def collect(self) -> Iterator[Metric]:
        """Yield all metrics; prometheus_client calls this. The names begin with ``roverlink_``."""
        for name, help, samples in _families(self._state):
            family = CounterMetricFamily if name.endswith("_total") else GaugeMetricFamily
            metric = family(f"roverlink_{name}", help, labels=list(samples[0][0]) if samples else ())
            for labels, value in samples:
                metric.add_metric([str(label) for label in labels.values()], value)
            yield metric
        yield _histogram(self._state.latencies)


def _families(state: State) -> Iterator[tuple[str, str, Samples]]:
    """Yield name, help text and samples of each metric except the histogram. Names of counters end in ``_total``."""
    yield (
        "info",
        "Node name, and fingerprint of its table.",
        [({"node": state.node, "fingerprint": state.fingerprint}, 1)],
    )
    yield "received_total", "Datagrams read from the socket.", [({}, state.received)]
    yield (
        "kernel_drops_total",
        "Datagrams that the kernel dropped because the receive buffer was full.",
        [({}, state.kernel_drops)],
    )
    yield "dropped_total", "Datagrams that were not bridged.", _by("reason", state.dropped)
    yield "forwarded_total", "Raw datagrams forwarded to a peer.", _by("peer", state.forwarded)
    yield "unsent_total", "Datagrams that the network refused to send.", _by("peer", state.unsent)
    yield "unforwarded_total", "Datagrams that were too long to be forwarded to a peer.", _by("peer", state.unforwarded)
    budgets = state.budgets.items()
    yield "budget_bytes_per_second", "Budget of a peer.", [({"peer": name}, one.limit) for name, one in budgets]
    sent = "Bytes sent to a peer with a budget, with the headers of IP and UDP."
    yield "budget_sent_bytes_total", sent, [({"peer": name}, one.sent) for name, one in budgets]
    yield (
        "withheld_total",
        "Datagrams that limits of forwards kept from a peer.",
        [
            ({"peer": peer, "payload": payload, "reason": reason}, count)
            for (peer, payload, reason), count in sorted(state.withheld.items())
        ],
    )
    yield (
        "undelivered_total",
        "Datagrams to a peer or board that did not leave, because of its line or budget.",
        [
            ({"peer": peer, "board": board, "reason": reason}, count)
            for (peer, board, reason), count in sorted(state.undelivered.items())
        ],
    )
    yield (
        "damaged_total",
        "Frames that were damaged on the line of a peer or board.",
        [({"peer": peer, "board": board}, count) for (peer, board), count in sorted(state.damaged.items())],
    )
    ahead = "Signed datagrams that were accepted more than a minute ahead of this computer's clock."
    yield "clocks_ahead_total", ahead, _by("signer", state.clocks_ahead)
    yield (
        "link_events_total",
        "Events of the addresses of peers and boards.",
        [
            ({"peer": peer, "board": board, "event": event}, count)
            for (peer, board, event), count in sorted(state.link_events.items())
        ],
    )
    ends = [({"peer": end_state.end.peer, "board": end_state.end.board}, end_state) for end_state in state.ends]
    yield (
        "link_ok",
        "1 if the address of the peer or board is known and reachable, else 0.",
        [(labels, end.link == "ok") for labels, end in ends],
    )
    yield (
        "silent",
        "1 if the peer or board has sent messages, but is silent now, else 0.",
        [(labels, end.liveness.state == "silent") for labels, end in ends],
    )
    yield from _clock_families([(labels, end.clock) for labels, end in ends if end.clock is not None])
    yield (
        "qos_mismatches",
        "Publishers and subscriptions of other nodes whose QoS does not match.",
        _by("topic", state.qos_mismatches),
    )
    yield "socket_waiting_bytes", "Bytes waiting in the socket's receive buffer.", [({}, state.socket_waiting)]
    yield "socket_size_bytes", "Size of the socket's receive buffer.", [({}, state.socket_size)]
    rows = [({"row": row.name, "number": row.number, "direction": row.direction}, row) for row in state.rows]
    yield "crossed_total", "Messages bridged, by row.", [(labels, row.count) for labels, row in rows]
    yield (
        "row_dropped_total",
        "Messages of a row that were not bridged.",
        [({**labels, "reason": reason}, count) for labels, row in rows for reason, count in row.dropped.items()],
    )
    yield "rate", "Messages a second, averaged over two seconds.", [(labels, row.rate) for labels, row in rows]
    yield (
        "age_seconds",
        "Seconds since the row's last message.",
        [(labels, row.age) for labels, row in rows if row.age is not None],
    )
    yield (
        "expected_rate",
        "Messages a second that the table expects (expect_rate).",
        [(labels, row.expect_rate) for labels, row in rows if row.expect_rate is not None],
    )
    yield "level", "State of the row: 0 OK, 1 WARN, 2 ERROR, 3 STALE.", [(labels, row.level) for labels, row in rows]
    guarded = [(labels, row) for labels, row in rows if row.stops is not None]
    yield (
        "stops_total",
        "Stops sent because the row's topic was silent (deadman).",
        [(labels, row.stops or 0) for labels, row in guarded],
    )
    yield (
        "stopping",
        "1 if a stop was sent after the row's last message, else 0.",
        [(labels, row.stopping) for labels, row in guarded],
    )
    yield from _link_families(state)
    if recording := state.recording:
        yield "recording_bytes_total", "Bytes of the recording written to disk.", [({}, recording.bytes)]
        yield "recording_waiting", "Messages waiting to be written to the recording.", [({}, recording.waiting)]
        yield "recording_lost_total", "Messages that were not recorded.", [({}, recording.lost)]
        yield "recording_failed", "1 if the recording failed, else 0.", [({}, recording.failure is not None)]


_CLOCK_HELP = {
    "offset_seconds": "Clock of the board minus the clock of this computer.",
    "drift": "Clock of the board against the clock of this computer.",
    "uncertainty_seconds": "Largest usual error of stamps by the clock of the board.",
}


def _clock_families(clocks: Sequence[tuple[Mapping[str, Any], ClockReport]]) -> Iterator[tuple[str, str, Samples]]:
    """Yield the metrics of the clocks of boards that stamp messages. Their names begin with ``board_clock_``."""
    if not clocks:
        return
    yield (
        "board_clock_known",
        "1 if stamps are times of measuring, by the clock of the board, else 0.",
        [(labels, not clock.problem) for labels, clock in clocks],
    )
    yield (
        "board_clock_restarts_total",
        "Starts of the board after the first one, as its clock shows.",
        [(labels, clock.restarts) for labels, clock in clocks],
    )
    for name, help in _CLOCK_HELP.items():
        found = [(labels, getattr(clock, name.removesuffix("_seconds"))) for labels, clock in clocks]
        yield f"board_clock_{name}", help, [(labels, value) for labels, value in found if value is not None]


_LINK_HELP = {
    "messages_total": "Link messages received from the end.",
    "reordered_total": "Link messages that arrived after a later one.",
    "duplicates_total": "Link messages that arrived before.",
    "lost_in_total": "Datagrams from the end that were lost.",
    "loss_in": "Share of the end's datagrams that was lost, in the last 16 link messages.",
    "lost_out_total": "Datagrams to the end that were lost.",
    "loss_out": "Share of the datagrams to the end that was lost, in the last 16 link messages.",
    "jitter_seconds": "Jitter of the link messages (RFC 3550).",
    "round_trip_seconds": "Time of the way to the end and back.",
    "clock_offset_seconds": "Clock of the end minus the clock of this computer.",
    "age_seconds": "Seconds since the end's last link message.",
}


def _link_families(state: State) -> Iterator[tuple[str, str, Samples]]:
    """Yield the metrics of the link messages. Their names begin with ``link_``."""
    if not state.links:
        return
    ends = [({"peer": report.end.peer, "board": report.end.board}, report) for report in state.links]
    yield (
        "link_schema_differs",
        "Rows whose schema differs at the end.",
        [(labels, len(report.differing)) for labels, report in ends if report.schema != UNKNOWN],
    )
    yield (
        "link_restarts_total",
        "Starts of the end's program after the first one.",
        [(labels, report.restarts) for labels, report in ends],
    )
    for name, help in _LINK_HELP.items():
        key = name.removesuffix("_total").removesuffix("_seconds")
        yield (
            f"link_{name}",
            help,
            [(labels, measured[key]) for labels, report in ends if key in (measured := report.measured())],
        )


def _by(label: str, counts: Mapping[str, int]) -> Samples:
    return [({label: name}, count) for name, count in sorted(counts.items())]


def _histogram(latencies: Latencies) -> HistogramMetricFamily:
    bounds = [*map(floatToGoString, BOUNDS_S), "+Inf"]
    return HistogramMetricFamily(
        "roverlink_handling_seconds",
        "Time from reading a datagram until its batch was published and forwarded.",
        # Prometheus's buckets are cumulative: each holds everything up to its bound.
        buckets=list(zip(bounds, accumulate(latencies.counts))),
        sum_value=latencies.sum_s,
    )


class MetricsServer(HttpServer):
    """HTTP server with one page, ``/metrics``, for Prometheus. A context manager."""

    def __init__(self, address: str, port: int, state: Callable[[], State]) -> None:
        """Bind the port; for port 0, the system selects a free port.

        Raises `SetupError` if the port is not available.
        """

        class Page(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                if not is_this_computer(self.headers["Host"]):
                    answer = refusal("this is not the address of the metrics")
                elif self.path.partition("?")[0] in ("/", "/metrics"):
                    answer = Answer(HTTPStatus.OK, CONTENT_TYPE, text_of(state()).encode())
                else:
                    answer = not_found("not found; the metrics are at /metrics")
                self.send_response(answer.status)
                self.send_header("Content-Type", answer.type)
                self.send_header("Content-Length", str(len(answer.body)))
                self.end_headers()
                self.wfile.write(answer.body)

        super().__init__(address, port, "metrics", Page)
