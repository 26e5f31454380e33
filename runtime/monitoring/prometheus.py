"""The state of a bridge in Prometheus's text format, and the port where it is scraped."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from http.server import BaseHTTPRequestHandler
from typing import Any

from runtime.http_server import HttpServer
from runtime.monitoring.histogram import BOUNDS_S, Latencies
from runtime.monitoring.state import State

CONTENT_TYPE = "text/plain; version=0.0.4; charset=utf-8"

Samples = list[tuple[Mapping[str, Any], float]]


def text_of(state: State) -> str:
    """Every counter, rate and age, as Prometheus reads them."""
    return "".join(f"{line}\n" for line in _lines(state))


def _lines(state: State) -> Iterator[str]:
    for name, kind, help, samples in _families(state):
        yield f"# HELP roverlink_{name} {help}"
        yield f"# TYPE roverlink_{name} {kind}"
        yield from (f"roverlink_{name}{_labels(labels)} {value:.12g}" for labels, value in samples)
    yield from _histogram(state.latencies)


def _families(state: State) -> Iterator[tuple[str, str, str, Samples]]:
    """Name, kind, help and samples of every metric but the histogram."""
    yield "info", "gauge", "The node and the table it bridges by.", [
        ({"node": state.node, "fingerprint": state.fingerprint}, 1)
    ]
    yield "received_total", "counter", "Datagrams taken from the socket.", [({}, state.received)]
    yield "kernel_drops_total", "counter", "Datagrams that the kernel dropped.", [({}, state.kernel_drops)]
    yield "dropped_total", "counter", "Datagrams that were not bridged.", _by("reason", state.dropped)
    yield "forwarded_total", "counter", "Raw datagrams handed on.", _by("peer", state.forwarded)
    yield "unsent_total", "counter", "Datagrams that the network refused.", _by("peer", state.unsent)
    yield "socket_waiting_bytes", "gauge", "Bytes that wait in the socket.", [({}, state.socket_waiting)]
    yield "socket_size_bytes", "gauge", "Bytes that the socket holds at most.", [({}, state.socket_size)]
    rows = [({"row": row.name, "number": row.number, "direction": row.direction}, row) for row in state.rows]
    yield "crossed_total", "counter", "Messages that crossed.", [(labels, row.count) for labels, row in rows]
    yield "row_dropped_total", "counter", "Messages of a row that did not cross.", [
        ({**labels, "reason": reason}, count) for labels, row in rows for reason, count in row.dropped.items()
    ]
    yield "rate", "gauge", "Messages a second, over two seconds.", [(labels, row.rate) for labels, row in rows]
    yield "age_seconds", "gauge", "Time since the last message.", [
        (labels, row.age) for labels, row in rows if row.age is not None
    ]
    yield "expected_rate", "gauge", "Messages a second that the table expects.", [
        (labels, row.expect_rate) for labels, row in rows if row.expect_rate is not None
    ]
    yield "level", "gauge", "0 OK, 1 WARN, 2 ERROR, 3 STALE.", [(labels, row.level) for labels, row in rows]
    if recording := state.recording:
        yield "recording_bytes_total", "counter", "Bytes of the recording on disk.", [({}, recording.bytes)]
        yield "recording_waiting", "gauge", "Messages that wait for the disk.", [({}, recording.waiting)]
        yield "recording_lost_total", "counter", "Messages that were not recorded.", [({}, recording.lost)]
        yield "recording_failed", "gauge", "1 once the recording has ended before its time.", [
            ({}, recording.failure is not None)
        ]


def _by(label: str, counts: Mapping[str, int]) -> Samples:
    return [({label: name}, count) for name, count in sorted(counts.items())]


def _histogram(latencies: Latencies) -> Iterator[str]:
    name = "roverlink_handling_seconds"
    yield f"# HELP {name} From when a datagram was read until its batch was published and forwarded."
    yield f"# TYPE {name} histogram"
    below = 0
    for bound, count in zip((*BOUNDS_S, float("inf")), latencies.counts):
        below += count
        yield f'{name}_bucket{{le="{"+Inf" if bound == float("inf") else f"{bound:g}"}"}} {below}'
    yield f"{name}_sum {latencies.sum_s:.9g}"
    yield f"{name}_count {below}"


def _labels(labels: Mapping[str, Any]) -> str:
    pairs = ",".join(f'{name}="{_escaped(str(value))}"' for name, value in labels.items())
    return f"{{{pairs}}}" if pairs else ""


def _escaped(value: str) -> str:
    return value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")


class MetricsServer(HttpServer):
    """An HTTP server with one page, ``/metrics``. A context manager."""

    def __init__(self, address: str, port: int, state: Callable[[], State]) -> None:
        """Port 0 takes a free one. Raises `SetupError` where the port cannot be had."""

        class Page(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                known = self.path.partition("?")[0] in ("/", "/metrics")
                body = text_of(state()).encode() if known else b"the metrics are at /metrics\n"
                self.send_response(200 if known else 404)
                self.send_header("Content-Type", CONTENT_TYPE if known else "text/plain")
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, *_: object) -> None:
                """Scrapes are no news."""

        super().__init__(address, port, "metrics", Page)
