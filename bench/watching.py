"""Section `watching`: CPU cost of recording, diagnostics and Foxglove on the bridge's own thread."""

import logging
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from bench.errors import BenchError
from bench.lab import Lab
from bench.result import Group, SectionResult, Table
from bench.wire import imu_datagram
from generated.registry import REGISTRY
from roverlink.runtime import SetupError
from roverlink.runtime.monitoring.foxglove_server import FoxgloveServer

MESSAGES, QUICK_MESSAGES = 1_000_000, 100_000
BATCH = 8
RATE = 20_000  # messages a second; far more than a rover has, far less than a disk can store
PAUSE_EVERY = 50  # batches

Take = Callable[[list[bytes]], object]

NOTE = (
    f"CPU time of the calling thread per message, in batches of {BATCH} at {RATE:,} a second. If a feature is off, its"
    " cost is zero: it is not in the call chain."
)


def measure(lab: Lab) -> SectionResult:
    """Pass a million messages to each."""
    count = QUICK_MESSAGES if lab.quick else MESSAGES
    rows, data = [], []
    for name, opened in (
        ("recorder", _recorder),
        ("Foxglove, no viewer", _foxglove),
    ):
        try:
            with opened() as (take, facts):
                own = _cost(take, count)
            found = {"watcher": name, "us": own, **facts()}
        except (SetupError, BenchError) as error:
            lab.say(f"{name} is left out: {error}")
            continue
        lab.say(f"{name:>20} {own:.2f} us")
        rows.append([name, f"{own:.2f}", str(found.get("lost", "-"))])
        data.append(found)
    table = Table(
        "Watching a bridge", ("", "us per message", "lost"), [Group(f"{count:,} messages each", rows)], [NOTE]
    )
    return SectionResult(tables=[table], charts=[], data={"costs": data})


def _cost(take: Take, count: int) -> float:
    """Return the CPU microseconds of this thread per message, without those of the loop around it."""
    batch = [imu_datagram()] * BATCH
    return max(0.0, _timed(take, batch, count) - _timed(lambda _: None, batch, count // 10))


def _timed(take: Take, batch: list[bytes], count: int) -> float:
    spent, start = 0.0, time.monotonic()
    for first in range(0, count // BATCH, PAUSE_EVERY):
        before = time.thread_time()
        for _ in range(PAUSE_EVERY):
            take(batch)
        spent += time.thread_time() - before
        time.sleep(max(0.0, start + (first + PAUSE_EVERY) * BATCH / RATE - time.monotonic()))
    return spent / count * 1e6


@contextmanager
def _recorder() -> Iterator[tuple[Take, Callable[[], dict[str, Any]]]]:
    from roverlink.runtime.recording.recorder import Recorder

    with tempfile.TemporaryDirectory() as folder:
        recorder = Recorder(Path(folder) / "run.mcap", REGISTRY, {}, logging.getLogger("bench"))
        received = recorder.datagrams("received")
        with recorder:
            yield received, lambda: {"lost": recorder.lost, "bytes": recorder.bytes}


@contextmanager
def _foxglove() -> Iterator[tuple[Take, Callable[[], dict[str, Any]]]]:
    handler = REGISTRY.by_name["imu_info"]
    with FoxgloveServer("bench", "127.0.0.1", 0) as server:
        yield server.topic("/imu_data", handler.message_type, handler.route.qos), dict
