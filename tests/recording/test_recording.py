"""A run that is recorded is on disk, equal to the byte, in files that other people's tools read."""

from __future__ import annotations

import contextlib
import ctypes
import dataclasses
import os
import resource
import signal
import struct
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.reader import make_reader
from mcap.records import Chunk
from mcap.stream_reader import StreamReader
from needs import needs_native
from polling import PATIENCE_S, wait_until
from runs import ROWS, record_everything, recorder

from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import Qos, SetupError
from roverlink.runtime.core import cdr
from roverlink.runtime.native.bridge_layout import RAW
from roverlink.runtime.native.core import LIBRARY, load_library
from roverlink.runtime.native.observer_ring import RingBlock
from roverlink.runtime.recording.mcap_file import MAGIC, Channel, McapFile
from roverlink.runtime.recording.reader import Recording
from roverlink.runtime.text.values import message_to_values

_ROOT = Path(__file__).parents[2]


def _read_by_mcap(*paths: Path) -> dict[str, list[bytes]]:
    """Every message by topic, as the mcap package reads it, checksums and all."""
    found: defaultdict[str, list[bytes]] = defaultdict(list)
    for path in paths:
        with path.open("rb") as file:
            for _, channel, message in make_reader(file, validate_crcs=True).iter_messages():
                found[channel.topic].append(message.data)
    return dict(found)


def _read(path: Path) -> dict[str, list[bytes]]:
    found: defaultdict[str, list[bytes]] = defaultdict(list)
    for message in Recording(path).messages():
        found[message.channel.topic].append(message.data)
    return dict(found)


# --- what is on disk --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("compression", ["zstd", "lz4", "none"])
def test_every_message_is_read_back_by_the_mcap_package(tmp_path: Path, compression: str) -> None:
    """Both files hold what was handed over, in order, whatever the compression; so do we read it."""
    path = tmp_path / "run.mcap"
    handed = record_everything(path, compression=compression)
    assert _read_by_mcap(path, tmp_path / "run.datagrams.mcap") == handed
    assert _read(path) == handed


@pytest.mark.slow
def test_every_message_is_read_back_by_rosbags(tmp_path: Path) -> None:
    """Rosbags opens the file of topics as it opens rosbag2's, and reads the messages of the payloads."""
    from rosbags.highlevel import AnyReader  # here, not where tests are collected: it brings a whole YAML library

    record_everything(tmp_path / "run.mcap", turns=3)
    counts: dict[str, int] = defaultdict(int)
    with AnyReader([tmp_path / "run.mcap"]) as bag:
        for connection, _, data in bag.messages():
            handler = REGISTRY.by_topic[connection.topic.removeprefix("/")]
            expected = handler.to_ros(payload_at(handler.payload_type, counts[connection.topic] * 0.1))
            assert data == cdr.encode(expected)
            fields = dataclasses.asdict(bag.deserialize(data, connection.msgtype)).keys() - {"__msgtype__"}
            assert fields == message_to_values(expected).keys()
            counts[connection.topic] += 1
    assert counts == dict.fromkeys(ROWS, 3)


def test_the_file_of_topics_is_what_rosbag2_reads(tmp_path: Path) -> None:
    """Profile, encodings and quality of service are as rosbag2 writes them, and no channel is anything but CDR."""
    from rosbags.highlevel import AnyReader  # here, as above

    writing = recorder(tmp_path / "run.mcap")
    handler = REGISTRY.by_name["imu_info"]
    tap = writing.topic("/imu_data", handler.message_type, Qos("best_effort", "transient_local", "keep_all", 7))
    writing.datagrams("received")
    with writing:
        tap([handler.to_cdr(handler.payload_type())])
    with (tmp_path / "run.mcap").open("rb") as file:
        reader = make_reader(file)
        assert reader.get_header().profile == "ros2"
        summary = reader.get_summary()
    assert summary is not None
    (channel,) = summary.channels.values()
    (schema,) = summary.schemas.values()
    assert (channel.message_encoding, schema.encoding) == ("cdr", "ros2msg")
    assert schema.name == "comms/msg/ImuSensorInformation"
    with AnyReader([tmp_path / "run.mcap"]) as bag:
        (qos,) = bag.connections[0].ext.offered_qos_profiles  # type: ignore[union-attr]
    assert (qos.history.name, qos.depth) == ("KEEP_ALL", 7)
    assert (qos.reliability.name, qos.durability.name) == ("BEST_EFFORT", "TRANSIENT_LOCAL")


def test_a_datagram_that_is_no_plain_protobuf_is_kept_as_it_came(tmp_path: Path) -> None:
    """Stripped, padded and broken ones are on a channel without a schema; in a folder, a run is named by its time."""
    plain = REGISTRY.envelope(imu_info={"accel_x": 1.0}).SerializeToString()
    odd = [plain + bytes(3), b"\x5a", b"\xff\xff", b"\x6a\x50"]
    writing = recorder(tmp_path)
    received = writing.datagrams("received")
    with writing:
        received([plain, *odd, plain])
    assert (writing.path.parent, writing.path.name[:2], writing.path.suffix) == (tmp_path, "20", ".mcap")
    assert _read(writing.path) == {"/datagrams/received": [plain] * 2, "/datagrams/received/raw": odd}


@needs_native
def test_the_native_core_gives_the_same_bytes(tmp_path: Path) -> None:
    """A block of its records, between messages of Python, makes the same file as messages of Python alone."""
    channels = (ctypes.c_uint16 * 4)(3, 0, 5, 8)  # 0: not for this file
    made = [(at * at % 4, at % 3 == 0, at, os.urandom(at % 90)) for at in range(1000)]
    ring = b"".join(
        struct.pack("=IIq", len(data), channel | is_raw * RAW, at) + data + bytes(-len(data) % 8)
        for channel, is_raw, at, data in made
    )
    entries = [
        (50 + at, 70 + at, channels[channel] + is_raw, data) for channel, is_raw, at, data in made if channels[channel]
    ]
    block = RingBlock(load_library(LIBRARY), ring, channels)
    files = [McapFile(tmp_path / name, "", "zstd", {}) for name in ("block", "messages")]
    for file, between in zip(files, (lambda: files[0].add_block(block, 50, 70), lambda: files[1].add(entries))):
        file.add(entries[:9])
        between()
        file.add(entries[9:])
        file.finish()
    assert block.count == len(entries)
    assert files[0].path.read_bytes() == files[1].path.read_bytes()


@pytest.mark.slow
def test_it_rotates_by_size(tmp_path: Path) -> None:
    """Files of about the size that was asked for, each complete and with its own schemas; together they are the run."""
    path = tmp_path / "run.mcap"
    writing = recorder(path, rotate_bytes=50_000, compression="none")
    received = writing.datagrams("received")
    sent = [os.urandom(1400) for _ in range(2010)]
    with writing:
        for start in range(0, 2000, 500):
            received(sent[start : start + 500])
            wait_until(lambda: not writing.waiting, "the disk")
        received(sent[2000:])  # too little for a part of its own, so that the last part is not empty
    parts = sorted(tmp_path.glob("run*.datagrams.mcap"))
    assert len(parts) >= 2
    assert {len(_read_by_mcap(part)) for part in parts} == {1}
    assert _read(path) == {"/datagrams/received/raw": sent}
    assert Recording(path).complete


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("run.bag", "the name of a recording must end with .mcap"),
        ("run.datagrams.mcap", "the name of a recording must end with .mcap"),
        ("nowhere/run.mcap", "does not exist"),
        ("there.mcap", "there.mcap: exists already; move it away or choose another name"),
        ("half.mcap", "half.datagrams.mcap: exists already"),
    ],
)
def test_a_place_where_it_cannot_be_is_told(tmp_path: Path, name: str, expected: str) -> None:
    """Before anything is written, and never over an older recording."""
    (tmp_path / "there.mcap").touch()
    (tmp_path / "half.datagrams.mcap").touch()
    with pytest.raises(SetupError, match=expected):
        recorder(tmp_path / name)


# --- when it goes wrong -----------------------------------------------------------------------------------------


def _run_of(what: str, path: Path, **options: Any) -> subprocess.Popen[str]:
    command = [sys.executable, str(Path(__file__).with_name("runs.py")), what, str(path)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(_ROOT), os.environ.get("PYTHONPATH", "")])}
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment, **options)


@pytest.mark.slow
def test_a_kill_costs_at_most_the_last_second(tmp_path: Path) -> None:
    """After SIGKILL everything is readable, in order and without a gap, but for what was younger than a second."""
    path = tmp_path / "run.mcap"
    with _run_of("killed", path) as child:
        assert child.stdout is not None
        handed = [int(child.stdout.readline().split()[0]) for _ in range(150)]
        # Ten times the second that it takes on an idle machine.
        wait_until(lambda: _numbers(path)[-1:] >= [handed[-1]], "what was handed over to be in the file", patience_s=10)
        child.send_signal(signal.SIGKILL)
        last = max([*handed, *(int(line.split()[0]) for line in child.stdout if line.count(" ") == 1)])
    numbers = _numbers(path)
    assert numbers == list(range(1, len(numbers) + 1))
    assert handed[-1] <= numbers[-1] <= last + 10
    assert not Recording(path).complete
    with path.with_suffix(".datagrams.mcap").open("rb") as file:  # the package reads it, too, up to where it ends
        read = sum(1 for _ in _until_it_ends(StreamReader(file)))
    assert read >= len(numbers)


def _numbers(path: Path) -> list[float]:
    """Read what a recording of numbered datagrams holds so far; nothing before it begins."""
    with contextlib.suppress(SetupError):
        return [
            REGISTRY.envelope.FromString(message.data).imu_info.accel_x  # type: ignore[attr-defined]
            for message in Recording(path).messages()
        ]
    return []


def _until_it_ends(reader: StreamReader) -> Iterator[Any]:
    from mcap.exceptions import EndOfFile

    try:
        yield from reader.records
    except EndOfFile:
        return


@pytest.fixture
def small_disk(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Path]:
    """A disk of 3 MB, or of the size that the test gives."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={getattr(request, 'param', '3m')}", "tmpfs", str(place)]
    if os.geteuid() or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("need to mount a disk (as root)")
    yield place
    subprocess.run(["umount", str(place)], check=True)


@pytest.mark.slow
def test_a_full_disk_ends_the_recording_and_nothing_else(small_disk: Path) -> None:
    """It is told before and when it happens; what was recorded is readable; what came later is counted as lost."""
    path = small_disk / "run.mcap"
    with _run_of("full", path) as child:
        output, _ = child.communicate(timeout=PATIENCE_S)
    assert child.returncode == 0, output
    assert "WARNING the disk is nearly full: " in output
    assert f" MB free for {path}, enough for " in output
    assert "ERROR the recording failed (No space left on device); the bridge continues. recorded 0 messages" in output
    assert int(output.rpartition("lost ")[2]) >= 1
    messages = list(Recording(path).messages())
    assert len(messages) > 1000
    assert {len(message.data) for message in messages} == {1400}


def test_the_warning_says_how_long_the_room_lasts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """At the rate of the last half second, a disk with 100 MB is full in less than five minutes."""
    monkeypatch.setattr(os, "statvfs", lambda _: SimpleNamespace(f_bavail=10**5, f_frsize=1000))
    writing = recorder(tmp_path / "run.mcap", compression="none")
    writing.datagrams("received")([bytes(10**6)])
    with writing:
        wait_until(lambda: "the disk is nearly full: 100.0 MB free" in caplog.text, "the warning")
        assert f", enough for {0.5 * 1e8 / writing.bytes:.0f} s; then the recording stops" in caplog.text


@pytest.mark.slow
def test_any_limit_leaves_a_file_with_an_end_or_none(tmp_path: Path) -> None:
    """Wherever in a file the room ends: it has an end and holds what it counts, or it could not be made at all."""
    none, empty, some = 0, 0, 0
    channel = Channel(1, "/x", "", "x", "text", b"a schema that takes some room" * 10)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    for limit in range(60, 6000, 51):
        path = tmp_path / f"{limit}.mcap"
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, before[1]))
        try:
            file = McapFile(path, "", "none", {"some": "facts"})
        except OSError:
            none += 1
            assert not path.exists()
            continue
        else:
            lost = _fill(file, channel)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
        found = sum(map(len, _read_by_mcap(path).values()))
        assert (found, found + lost) == (file.counts.total(), 20 * 5)
        empty, some = empty + (not found), some + bool(found)
    assert min(none, empty, some) >= 2


def _fill(file: McapFile, channel: Channel) -> int:
    """Write 20 chunks of 5 messages, as far as there is room, and end the file; return how many are lost."""
    written = 0
    with contextlib.suppress(OSError):
        file.add_channel(channel)
        for _ in range(20):
            written += 5
            file.add([(time.time_ns(), time.time_ns(), 1, bytes(50))] * 5)
            file.flush()
    return 100 - written + file.finish_anyway()


@pytest.mark.parametrize("small_disk", ["4k"], indirect=True)
def test_a_disk_without_room_for_two_files_is_told(small_disk: Path) -> None:
    """The bridge does not start, and the file that could be made is not left behind."""
    with pytest.raises(OSError, match="No space left on device"):
        recorder(small_disk / "run.mcap")
    assert list(small_disk.iterdir()) == []


def test_what_the_disk_does_not_keep_up_with_is_counted(tmp_path: Path) -> None:
    """The queue has an end: the bridge never waits, and memory does not grow."""
    writing = recorder(tmp_path / "run.mcap", queue=10)
    received = writing.datagrams("received")
    for _ in range(30):
        received([b"x"])
    with writing:
        pass
    assert (writing.lost, writing.waiting) == (20, 0)
    assert len(_read(tmp_path / "run.mcap")["/datagrams/received/raw"]) == 10
    assert writing.summary().endswith("; 20 lost because the disk was too slow")


def test_a_defect_of_the_recorder_does_not_reach_the_bridge(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Whatever fails in the writing thread ends the recording with an error, and the taps go on to return."""
    writing = recorder(tmp_path / "run.mcap")
    received: Any = writing.datagrams("received")
    with writing:
        received(["no bytes"])
        wait_until(lambda: writing.failure is not None, "the failure")
        received([b"late"])
    assert "the recording failed (TypeError" in caplog.text
    assert writing.lost == 1
    assert (tmp_path / "run.mcap").read_bytes().endswith(b"\x89MCAP0\r\n")  # the file has an end


@pytest.mark.slow
def test_any_cut_and_any_damage_is_read_up_to_there_or_told(tmp_path: Path) -> None:
    """Cut anywhere, a file gives a beginning of its messages; with any byte changed, that or an error."""
    path = tmp_path / "run.mcap"
    handed = [message for messages in record_everything(path, turns=2).values() for message in messages]
    data = path.read_bytes()
    (tmp_path / "run.datagrams.mcap").unlink()
    for cut in range(8, len(data), 1997):
        path.write_bytes(data[:cut])
        assert {message.data for message in Recording(path).messages()} <= set(handed)
    for place in range(8, len(data), 997):
        path.write_bytes(data[:place] + bytes([data[place] ^ 0x55]) + data[place + 1 :])
        with contextlib.suppress(SetupError):  # and nothing else
            Recording(path).channels()
            list(Recording(path).messages())
    for content in (b"", b"hello, this is text"):
        path.write_bytes(content)
        with pytest.raises(SetupError, match=r"run\.mcap: not an MCAP file"):
            Recording(path)
    path.unlink()
    with pytest.raises(SetupError, match=r"run\.mcap: no such file"):
        Recording(path)


@pytest.mark.parametrize(
    ("size", "zeros", "length", "said"),
    [
        (65 << 20, 65 << 20, None, "chunks of more than 67108864 bytes are not read"),
        (100, 65 << 20, None, "chunks of more than 67108864 bytes are not read"),
        (101, 100, None, "the size or the checksum of a chunk is wrong"),
        (100, 100, b"\xff" * 8, ""),
    ],
)
def test_a_chunk_that_no_memory_holds_is_refused(
    tmp_path: Path, size: int, zeros: int, length: bytes | None, said: str
) -> None:
    """A small file says how large its content is, or lies about it."""
    chunk, path = RecordBuilder(), tmp_path / "bomb.mcap"
    Chunk("zstd", zstandard.compress(bytes(zeros)), 0, 0, 0, size).write(chunk)
    record = bytearray(chunk.end())
    record[45:53] = length or record[45:53]  # of the data
    path.write_bytes(MAGIC + record)
    with pytest.raises(SetupError, match=f": the file is damaged: .*{said}"):
        list(Recording(path).messages())
