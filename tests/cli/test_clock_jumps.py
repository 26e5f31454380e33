"""A recording during which the computer's clock was set: `record` notes it, `info`, `export` and `replay` cope."""

from __future__ import annotations

import csv
import itertools
import json
import logging
import re
import socket
import time
from datetime import datetime
from pathlib import Path

import pytest
from mcap.reader import make_reader
from needs import needs_dds
from polling import PATIENCE_S, wait_until
from programs import Start
from terminals import Terminal

from generated.registry import REGISTRY
from roverlink import standard_types
from roverlink.__main__ import main
from roverlink.runtime.interfaces.rosgraph_msgs import Clock
from roverlink.runtime.recording.message_definitions import definition_of
from roverlink.runtime.recording.queued_file import Settings
from roverlink.runtime.recording.reader import Recording
from roverlink.runtime.recording.recorder import Recorder

_SECOND = 1_000_000_000
_COUNT = 100
_BEGIN = int(datetime(2026, 5, 31, 12).timestamp()) * _SECOND
_HOUR = 3600 * _SECOND
_DECADE = 3652 * 24 * _HOUR


def _datagram(number: int) -> bytes:
    return REGISTRY.envelope(imu_info={"accel_x": float(number)}).SerializeToString()


def _number(datagram: bytes) -> int:
    return int(REGISTRY.envelope.FromString(datagram).imu_info.accel_x)  # type: ignore[attr-defined]


class _Clocks:
    """Clocks of a computer that stand still until they are moved."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self.steady, self.shown = 7 * _SECOND, _BEGIN
        patch.setattr(time, "monotonic_ns", lambda: self.steady)
        patch.setattr(time, "time_ns", lambda: self.shown)

    def pass_time(self, nanoseconds: int) -> None:
        self.steady += nanoseconds
        self.shown += nanoseconds


def _record(path: Path, jump: int, caplog: pytest.LogCaptureFixture) -> Path:
    """Record a datagram and a message a second, for 100 s; between the first and the second half the clock is set."""
    handler = REGISTRY.by_name["imu_info"]
    with pytest.MonkeyPatch.context() as patch:
        clocks = _Clocks(patch)
        recorder = Recorder(path, REGISTRY, {"/imu_data": "imu_info"}, logging.getLogger("jumps"))
        received = recorder.datagrams("received")
        published = recorder.topic("/imu_data", handler.message_type, handler.route.qos)
        with recorder:
            for number in range(_COUNT):
                if number == _COUNT // 2:
                    clocks.shown += jump
                    wait_until(lambda: "the computer's clock jumped by" in caplog.text, "the jump")
                received([_datagram(number)])
                published([handler.to_cdr(handler.payload_type(accel_x=number))])
                clocks.pass_time(_SECOND)
    return path


@pytest.fixture(params=[_DECADE, -_HOUR], ids=["ahead", "back"])
def jump(request: pytest.FixtureRequest) -> int:
    """Nanoseconds by which the clock is set."""
    return int(request.param)


@pytest.fixture
def run(tmp_path: Path, jump: int, caplog: pytest.LogCaptureFixture) -> Path:
    """A recorded run of 100 s, in the middle of which the clock was set."""
    return _record(tmp_path / "run.mcap", jump, caplog)


def _to(peer: socket.socket) -> tuple[str, str]:
    return "--to", f"127.0.0.1:{peer.getsockname()[1]}"


def _numbers(peer: socket.socket, count: int) -> list[int]:
    return [_number(peer.recv(65_536)) for _ in range(count)]


def test_a_recording_carries_steady_and_wall_time(run: Path, jump: int) -> None:
    """Other readers, too, find the messages in order and a second apart, beside what the clock showed."""
    from rosbags.highlevel import AnyReader  # here, not where tests are collected: it brings a whole YAML library

    with run.with_suffix(".datagrams.mcap").open("rb") as file:
        found = [message for _, _, message in make_reader(file).iter_messages()]
    assert [_number(message.data) for message in found] == list(range(_COUNT))
    assert [message.log_time for message in found] == [_BEGIN + number * _SECOND for number in range(_COUNT)]
    half = _COUNT // 2
    assert [message.publish_time - message.log_time for message in found] == [0] * half + [jump] * half
    with AnyReader([run]) as bag:
        times = [time for _, time, _ in bag.messages()]
    assert times == [message.log_time for message in found]


@pytest.mark.slow
def test_every_part_of_a_recording_knows_the_jump(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """A part that begins after the jump says it, too, and all parts together say it once."""
    with pytest.MonkeyPatch.context() as patch:
        clocks = _Clocks(patch)
        settings = Settings(rotate_bytes=1)
        recorder = Recorder(tmp_path / "run.mcap", REGISTRY, {}, logging.getLogger("jumps"), settings)
        received = recorder.datagrams("received")
        with recorder:
            clocks.shown -= _HOUR
            wait_until(lambda: "the computer's clock jumped by" in caplog.text, "the jump")
            part = tmp_path / "run_2.datagrams.mcap"
            wait_until(lambda: received([_datagram(0)]) or part.exists(), "another part")
    assert [jump.by for jump in Recording(tmp_path / "run.mcap").jumps] == [-_HOUR]
    alone = tmp_path / "alone.mcap"
    part.rename(alone)
    assert [jump.by for jump in Recording(alone).jumps] == [-_HOUR]


def _said(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    """What a command prints that ends well."""
    assert main([*map(str, arguments)]) == 0
    return capsys.readouterr().out


def test_info_says_where_the_clock_jumped(run: Path, jump: int, capsys: pytest.CaptureFixture[str]) -> None:
    """The duration is that of the run; the jump is told with its size, both times and its place."""
    output = _said(capsys, "recording", "info", run)
    assert "start     2026-05-31 12:00:00, for 99.0 s" in output
    size, to = ("+3652 days, 0:00:00", "2036-05-30 ") if jump > 0 else ("-1:00:00", "2026-05-31 11:00:50")
    assert f"clock     jumped by {size}, from 2026-05-31 12:00:50 to {to}" in output
    assert ", 50.0 s after the first message\n" in output
    (told,) = json.loads(_said(capsys, "recording", "info", run, "--json"))["clock_jumps"]
    assert (told["after_seconds"], told["by_seconds"]) == (50.0, jump / 1e9)


def test_an_export_has_both_times_and_says_where_they_part(
    run: Path, jump: int, capsys: pytest.CaptureFixture[str]
) -> None:
    """A column counts on steadily, another shows what the clock showed; a note names the jump."""
    assert main(["recording", "export", str(run), "--topic", "imu_data"]) == 0
    assert re.search(r"the computer's clock jumped by .*, 50.0 s after the first message;", capsys.readouterr().err)
    with run.with_suffix(".imu_data.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [int(row["time_ns"]) for row in rows] == [_BEGIN + number * _SECOND for number in range(_COUNT)]
    assert int(rows[-1]["wall_ns"]) - int(rows[-1]["time_ns"]) == jump


def test_a_replay_keeps_order_and_pace(run: Path, capsys: pytest.CaptureFixture[str], peer: socket.socket) -> None:
    """A hundred seconds, a thousand times as fast, are a tenth of a second; a decade would be days."""
    output = _said(capsys, "recording", "replay", run, "--speed", 1000, *_to(peer))
    took = float(output.removeprefix(f"replayed {_COUNT} datagrams in ").removesuffix(" s\n"))
    assert 0.09 <= took < PATIENCE_S
    assert _numbers(peer, _COUNT) == list(range(_COUNT))


@pytest.mark.parametrize("jump", [-_HOUR], indirect=True)
def test_a_replay_begins_where_it_is_told(run: Path, capsys: pytest.CaptureFixture[str], peer: socket.socket) -> None:
    """What was before is left out; a start after the end is an error that names the length."""
    assert _said(capsys, "recording", "replay", run, "--start", 90, "--speed", 1000, *_to(peer)).startswith(
        "replayed 10 datagrams"
    )
    assert _numbers(peer, 10) == list(range(90, _COUNT))
    assert main(["recording", "replay", str(run), "--start", "1000", *_to(peer)]) == 2
    assert capsys.readouterr().err == "roverlink: --start 1000: the recording has only 99.0 s\n"


@needs_dds
@pytest.mark.parametrize("jump", [-_HOUR], indirect=True)
@pytest.mark.slow
def test_a_replay_publishes_the_clock(run: Path, start: Start, jump: int) -> None:
    """Nodes hear the time of the run as its clock showed it, jump included, so that it fits the stamps of messages."""
    options = ("--as", "ros", "--clock", "--topic", "imu_data", "--middleware", "dds")
    listener = start("echo", "clock", "--type", "rosgraph_msgs/msg/Clock", "--json", "--middleware", "dds")
    replay = start("recording", "replay", run, *options, "--speed", 20, "--loop", "--wait", 0)

    def jumped() -> bool:
        stamps = _stamps(listener.output)
        return any(late - early < -_HOUR / 2 and early > 0 for early, late in itertools.pairwise(stamps))

    wait_until(jumped, "the jump of the clock")
    assert replay.interrupt() == 0
    assert listener.interrupt() == 0
    stamps = _stamps(listener.output)
    for stamp in stamps:
        assert 0 <= stamp - _BEGIN <= 51 * _SECOND or 0 <= stamp - _BEGIN - jump - 49 * _SECOND <= 51 * _SECOND
    assert definition_of(Clock) == definition_of(standard_types.message_type("rosgraph_msgs/msg/Clock"))
    assert main(["recording", "replay", str(run), "--clock"]) == 2


def _stamps(lines: list[str]) -> list[int]:
    clocks = [json.loads(line)["clock"] for line in list(lines)]
    return [clock["sec"] * _SECOND + clock["nanosec"] for clock in clocks]


@pytest.mark.slow
@pytest.mark.parametrize("jump", [-_HOUR], indirect=True)
def test_a_replay_shows_its_progress_and_obeys_keys(run: Path, peer: socket.socket) -> None:
    """The arrows seek, space pauses and continues, and at the end the terminal is as it was."""
    with Terminal("recording", "replay", run, *_to(peer)) as terminal:
        terminal.wait_for(r"0\.\d of 99\.0 s \(0%\); space pauses, arrow keys seek")
        assert _numbers(peer, 1) == [0]
        terminal.type(" ")
        terminal.wait_for("paused")
        terminal.type("\x1b[A\x1b[C\x1b[C\x1b[C\x1b[C")
        terminal.wait_for(r"99\.0 of 99\.0 s \(100%\), paused")
        terminal.type("x\x1b[D")  # x means nothing
        terminal.wait_for(r"89\.0 of 99\.0 s \(90%\), paused")
        terminal.type("\x1b[D")
        terminal.wait_for(r"79\.0 of 99\.0 s")
        terminal.type("\x1bOC")  # an arrow in the terminal's other mode
        terminal.wait_for(r"89\.0 of 99\.0 s")
        terminal.type(" ")
        played = wait_until(lambda: [one for one in _numbers(peer, 1) if one >= 89], "the rest")
        assert played in ([89], [90])  # 89.0 is rounded
        terminal.type("\x1b[C")
        assert terminal.end() == 0
        terminal.wait_for(r"replayed \d+ datagrams in ")
        assert terminal.left_as_it_was()
