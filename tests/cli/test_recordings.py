"""`roverlink record`, `info`, `export` and `replay`, as operators use them in the evening."""

from __future__ import annotations

import contextlib
import csv
import json
import logging
import socket
from pathlib import Path
from typing import Any

import pytest
from needs import NO_PYARROW
from polling import wait_until
from programs import Start
from running import Bridge

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.recording.reader import Recording
from roverlink.runtime.recording.recorder import Recorder
from roverlink.runtime.recording.replaying import RosReplay

_COUNT = 40


def _datagram(number: int) -> bytes:
    payload = payload_at(REGISTRY.by_name["imu_info"].payload_type, number * 0.1)
    return REGISTRY.envelope(imu_info=payload).SerializeToString()


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """A recorded run."""
    handler = REGISTRY.by_name["imu_info"]
    recorder = Recorder(tmp_path / "run.mcap", REGISTRY, {"/imu_data": "imu_info"}, logging.getLogger("run"))
    received = recorder.datagrams("received")
    published = recorder.topic("/imu_data", handler.message_type, handler.route.qos)
    with recorder:
        for number in range(_COUNT):
            received([_datagram(number)])
            published([handler.to_cdr(payload_at(handler.payload_type, number * 0.1))])
    return recorder.path


def _recorded_messages(path: Path, topic: str) -> int:
    with contextlib.suppress(SetupError):  # the file has no beginning yet
        return Recording(path).channels().get(topic, (None, 0))[1]
    return 0


@pytest.mark.slow
def test_a_bridge_is_recorded(bridge: Bridge, peer: socket.socket, tmp_path: Path) -> None:
    """Every datagram and every message is on disk, in order; diagnostics are replayed only where they are asked for."""
    path = tmp_path / "run.mcap"
    program, port = bridge(path, command="record")
    for number in range(_COUNT):
        peer.sendto(_datagram(number), ("127.0.0.1", port))
    wait_until(lambda: _recorded_messages(path, "/diagnostics"), "a message of diagnostics on disk")
    assert program.interrupt() == 0
    assert f"recording to {path}" in str(program)
    assert f"received {_COUNT}, published {_COUNT}" in str(program)
    found: dict[str, list[bytes]] = {}
    for message in Recording(path).messages():
        found.setdefault(message.channel.topic, []).append(message.data)
    stops = found.pop("/datagrams/sent/hardware")  # nobody commands the rover
    fed = [f"/{handler.route.topic}" for handler in REGISTRY.extra_topics if handler.route.name == "imu_info"]
    assert {topic: len(found.pop(topic)) for topic in fed} == dict.fromkeys(fed, _COUNT)
    diagnostics = found.pop("/diagnostics")
    of_topics, datagrams = _COUNT * (1 + len(fed)) + len(diagnostics), _COUNT + len(stops)
    assert f"recorded {of_topics} messages of topics and {datagrams} datagrams to {path}" in str(program)
    handler = REGISTRY.by_name["imu_info"]
    sent = [_datagram(number) for number in range(_COUNT)]
    assert found == {
        "/datagrams/received": sent,
        "/imu_data": [
            handler.to_cdr(REGISTRY.envelope.FromString(datagram).imu_info)  # type: ignore[attr-defined]
            for datagram in sent
        ],
    }
    assert "/diagnostics" not in RosReplay(Recording(path), REGISTRY).endpoints
    replay = RosReplay(Recording(path), REGISTRY, {"/diagnostics"})
    array: Any = cdr.decode(replay.endpoints["/diagnostics"].message_type, next(replay.messages()).data)
    assert array.status[0].name == "udp_forwarder"


@pytest.mark.slow
def test_a_replay_begins_again_until_it_is_interrupted(run: Path, start: Start, peer: socket.socket) -> None:
    """With `--loop`, the first datagram follows the last."""
    program = start("recording", "replay", run, "--speed", 100, "--loop", "--to", f"127.0.0.1:{peer.getsockname()[1]}")
    received = [peer.recv(65_536) for _ in range(2 * _COUNT + 1)]
    assert received[_COUNT] == received[2 * _COUNT] == _datagram(0)
    assert program.interrupt() == 0


def test_what_is_in_a_recording(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """For people, and as JSON; with the table's fingerprint, and whether the run was ended."""
    assert main(["recording", "info", str(run)]) == 0
    output = capsys.readouterr().out
    assert f"table     {REGISTRY.fingerprint}" in output
    assert "/imu_data" in output
    assert f"  {_COUNT}  " in output
    assert main(["recording", "info", str(run.with_suffix(".datagrams.mcap")), "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["complete"] is True
    assert {topic["topic"]: topic["count"] for topic in facts["topics"] if topic["count"]} == {
        "/datagrams/received": _COUNT,
        "/imu_data": _COUNT,
    }


@pytest.mark.parametrize("format", ["csv", "parquet"])
def test_a_topic_as_csv_and_parquet(run: Path, capsys: pytest.CaptureFixture[str], format: str) -> None:
    """A row a message, a column a field, nested ones by their dotted names, and the time."""
    file = run.with_suffix(f".imu_data.{format}")
    if format == "parquet":
        parquet = pytest.importorskip("pyarrow.parquet", reason=NO_PYARROW)
    assert main(["recording", "export", str(run), "--topic", "imu_data", "--to", format]) == 0
    assert capsys.readouterr().out.startswith(f"wrote {_COUNT} messages of imu_data to {file}")
    rows = [*csv.DictReader(file.open())] if format == "csv" else parquet.read_table(file).to_pylist()
    payload = payload_at(REGISTRY.by_name["imu_info"].payload_type, 0.1 * (_COUNT - 1))
    assert len(rows) == _COUNT
    assert list(rows[0])[:3] == ["time_ns", "wall_ns", "accel_x"]
    assert float(rows[-1]["accel_x"]) == payload.accel_x
    assert int(rows[-1]["state.state"]) == payload.state
    assert int(rows[-1]["time_ns"]) > 0


def test_an_export_that_fails_leaves_what_was_there(run: Path, tmp_path: Path) -> None:
    """The file of the evening before is not lost for a topic that is misspelt, and nothing else is left behind."""
    kept = tmp_path / "kept.csv"
    kept.write_text("precious")
    before = set(tmp_path.iterdir())
    assert main(["recording", "export", str(run), "--topic", "imu_dat", "--out", str(kept)]) == 2
    assert kept.read_text() == "precious"
    assert set(tmp_path.iterdir()) == before
    assert main(["recording", "export", str(run), "--topic", "imu_data", "--out", str(kept)]) == 0
    assert kept.read_text().startswith("time_ns,")
    assert set(tmp_path.iterdir()) == before
