"""Runs to record: what a bridge would hand to a recorder."""

from __future__ import annotations

import logging
import sys
import time
from pathlib import Path
from typing import Any

from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime.recording.queued_file import Settings
from roverlink.runtime.recording.recorder import Recorder

ROWS = {f"/{handler.route.topic}": handler.route.name for handler in REGISTRY.handlers}
LOGGER = logging.getLogger("test_recording")


def recorder(path: Path, **settings: Any) -> Recorder:
    """A recorder of this repository's own table."""
    return Recorder(path, REGISTRY, ROWS, LOGGER, Settings(**settings))


def record_everything(path: Path, turns: int = 20, **settings: Any) -> dict[str, list[bytes]]:
    """Record all payloads so many times, as datagrams and as topics; what was handed over, by topic."""
    handed: dict[str, list[bytes]] = {}
    writing = recorder(path, **settings)
    taps: dict[str, Any] = {"/datagrams/received": writing.datagrams("received")}
    for peer in REGISTRY.peers:
        taps[f"/datagrams/sent/{peer.name}"] = writing.datagrams(f"sent/{peer.name}")
    for handler in REGISTRY.handlers:
        topic = f"/{handler.route.topic}"
        taps[topic] = writing.topic(topic, handler.message_type, handler.route.qos)
    with writing:
        for turn in range(turns):
            for handler in REGISTRY.handlers:
                payload = payload_at(handler.payload_type, turn * 0.1)
                datagram = REGISTRY.envelope(**{handler.route.name: payload}).SerializeToString()
                way = "received" if handler.route.inbound else f"sent/{handler.route.peer}"
                for topic, message in (
                    (f"/datagrams/{way}", datagram),
                    (f"/{handler.route.topic}", handler.to_cdr(payload)),
                ):
                    taps[topic]([message])
                    handed.setdefault(topic, []).append(message)
    return handed


def _record_until_killed(path: Path) -> None:
    """Record numbered datagrams, a thousand a second, and print each number once it was handed over."""
    writing = recorder(path)
    received = writing.datagrams("received")
    with writing:
        number = 0
        while True:
            number += 1
            received([REGISTRY.envelope(imu_info={"accel_x": float(number)}).SerializeToString()])
            if number % 10 == 0:
                print(number, time.time_ns(), flush=True)
                time.sleep(0.01)  # the rate, which makes of the numbers a measure of time


def _record_until_full(path: Path) -> None:
    """Record what does not compress until the disk is full, and on; then end as a bridge does."""
    import os

    logging.basicConfig(level=logging.INFO, stream=sys.stdout, format="%(levelname)s %(message)s")
    writing = recorder(path)
    received = writing.datagrams("received")
    with writing:
        while writing.failure is None:
            received([os.urandom(1400) for _ in range(100)])
            time.sleep(0.05)  # a rate that the queue holds, so that the disk is what ends the recording
        received([b"late"])
    print(f"lost {writing.lost}")


if __name__ == "__main__":
    runs = {"killed": _record_until_killed, "full": _record_until_full}
    runs[sys.argv[1]](Path(sys.argv[2]))
