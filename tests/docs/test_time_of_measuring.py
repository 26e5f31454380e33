"""docs/conversions.md, the time of measuring: its example is a project, and the stamps are what the page says."""

from __future__ import annotations

import random
import time
from pathlib import Path
from typing import Any

import pytest
from bridge_rig import Rig
from case_file import usual_table
from page import ROOT, blocks

from roverlink.generator.pipeline import compile_table
from roverlink.runtime import Registry, load_registry
from roverlink.runtime.core import cdr, link_message
from roverlink.runtime.core.board_clock import ClockReport
from roverlink.runtime.core.link_message import LinkWriter
from roverlink.runtime.native.core import LIBRARY, open_core
from roverlink.runtime.ros_time.clock import MONOTONIC_CLOCK, SYSTEM_CLOCK
from roverlink.runtime.ros_time.headers import stamp_of
from roverlink.simulation.scenarios import World

pytestmark = pytest.mark.slow
_S, _MS, _US = 10**9, 10**6, 10**3
# Each table with a link message has the same message roverlink.Link. A process can load it from one path only, which is
# that of the other project of the tests (`linked`).
_TABLE = """\
envelope: {file: linked/depth_envelope.proto, message: linked.DepthEnvelope, oneof: payload}
ros: {package: depth_msgs}
python: {package: depth_rover}
peers: {board: {}}
link: {number: 9}
"""


@pytest.fixture(scope="module")
def registry(tmp_path_factory: pytest.TempPathFactory) -> Registry:
    """The project of the page."""
    shown = {one.language: one.text for one in blocks(ROOT / "docs" / "conversions.md", "The time of measuring")}
    folder = tmp_path_factory.mktemp("depth")
    proto = shown["proto"].splitlines()[0].removeprefix("// ")
    _write(folder, {"mapping.yaml": usual_table(f"{_TABLE}messages:\n") + shown["yaml"], proto: shown["proto"]})
    _write(folder, compile_table(folder / "mapping.yaml").files)
    return load_registry(folder, "depth_rover")


def _write(folder: Path, files: Any) -> None:
    for path, text in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")


class _Board:
    """A board that measures ten times a second, and a bridge whose clocks a test moves."""

    def __init__(self, registry: Registry, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now, self.date, self.began = 0, 1_700_000_000 * _S, 12 * _S - 2**32 * _US
        self.delays = random.Random(5)  # noqa: S311  # repeatable, not secret
        monkeypatch.setattr(SYSTEM_CLOCK, "now", lambda: self.date + self.now)
        monkeypatch.setattr(MONOTONIC_CLOCK, "now", lambda: self.now)
        self.rig = Rig(registry)
        self.rig.listen("depth/point")

    def arrive(self, measured: int, delay: int) -> int:
        """Let a measurement arrive after a delay; return how much its stamp is later than that."""
        count = (measured - self.began) // _US % 2**32
        self.now = measured + delay
        self.rig.receive(self.rig.registry.envelope(depth={"uptime_us": count}).SerializeToString())
        return stamp_of(self.last.header) - self.date - measured

    def measure(self, count: int) -> list[tuple[int, int]]:
        """Measure a few times; return how late each stamp and each datagram is."""
        found = list[tuple[int, int]]()
        for _ in range(count):
            measured, delay = (self.now // (100 * _MS) + 1) * 100 * _MS, self.delays.randrange(5 * _MS)
            found.append((self.arrive(measured, delay), delay))
        return found

    @property
    def last(self) -> Any:
        """The last message on the topic."""
        (topic,) = self.rig.registry.extra_topics
        return cdr.decode(topic.message_type, self.rig.on_topic[topic.route.topic][-1])

    @property
    def clock(self) -> ClockReport:
        """What the bridge knows of the clock."""
        (report,) = self.rig.bridge.clock_reports().values()
        return report


def _is_receipt(found: list[tuple[int, int]]) -> bool:
    return all(stamp == delay for stamp, delay in found)


def _is_measuring(found: list[tuple[int, int]]) -> bool:
    return all(abs(stamp) < _MS for stamp, _ in found)


def test_the_topic_has_the_time_of_measuring(registry: Registry, monkeypatch: pytest.MonkeyPatch) -> None:
    """The events of the page: a start, a wrap, a set clock, an old datagram, a new start and a silence."""
    board = _Board(registry, monkeypatch)
    with board.rig:
        assert _is_receipt(board.measure(20))
        assert board.clock.problem == "stamps are times of receipt: messages came in 2 of 5 intervals of 2 s"
        board.measure(80)
        assert _is_measuring(board.measure(50))  # the counter wraps after 12 s
        board.date += 3600 * _S
        assert _is_measuring(board.measure(5))
        assert board.clock.uncertainty is not None
        assert board.clock.uncertainty < 1e-3
        assert board.clock.offset == pytest.approx(-(board.date + board.began) / _S, abs=1e-3)
        assert board.arrive(board.now - 100 * _S, 101 * _S) == 101 * _S
        assert _is_measuring(board.measure(5))
        board.began = board.now - 3 * _S
        assert _is_receipt(board.measure(60))
        assert board.clock.restarts == 1
        board.measure(40)
        assert _is_measuring(board.measure(50))
        board.now += 25 * _S
        assert _is_receipt(board.measure(5))


def test_link_messages_tell_the_shortest_delay(registry: Registry, monkeypatch: pytest.MonkeyPatch) -> None:
    """Half of the shortest round trip is taken off each stamp, and is a part of the uncertainty."""
    monkeypatch.setattr(link_message, "PERIOD_S", 0.01)
    board = _Board(registry, monkeypatch)
    assert registry.link is not None
    writer = LinkWriter(registry.envelope, 7, registry.link.hashes)
    with board.rig as rig:
        board.measure(110)
        before, alone = board.arrive(board.now + 100 * _MS, 5 * _MS), board.clock
        assert (alone.round_trip, alone.problem) == (None, "")
        while board.clock.round_trip is None:
            told: Any = registry.envelope.FromString(rig.peers["board"].recv(2000))
            now_us = time.monotonic_ns() // _US
            writer.note_heard(link_message.read(told.link), now_us, 0)
            rig.receive(writer.write(now_us))
        after, with_link = board.arrive(board.now + 100 * _MS, 5 * _MS), board.clock
        assert with_link.round_trip is not None
        assert alone.uncertainty is not None
        assert with_link.uncertainty is not None
        assert before - after == pytest.approx(with_link.round_trip / 2 * _S, abs=_MS / 10)
        assert with_link.uncertainty > with_link.round_trip / 2


@pytest.mark.skipif(not LIBRARY.is_file(), reason="the native core is not compiled")
def test_the_native_core_leaves_such_a_topic_to_python(registry: Registry) -> None:
    """Only the topic with the stamp, which is the reason for its row."""
    reasons = [open_core(registry).reason(topic) for topic in (*registry.handlers, *registry.extra_topics)]
    assert reasons == ["", "its stamps are by the clock of the board"]


def test_a_simulated_board_counts(registry: Registry) -> None:
    """Its counter is the time since its start, and wraps as that of a board does."""
    world = World(registry, random.Random(1), 1472)  # noqa: S311  # repeatable, not secret
    counts = [registry.envelope.FromString(world.datagram("depth", at)) for at in (1.5, 2**32 / 1e6 + 2)]
    assert [count.depth.uptime_us for count in counts] == [1_500_000, 2_000_000]  # type: ignore[attr-defined]
