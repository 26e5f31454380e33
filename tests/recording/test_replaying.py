"""A recording is replayed in today's schema, and what means something else today is not replayed."""

from __future__ import annotations

import dataclasses
import math
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from bridge_rig import QUIET, Rig, end, of_peers
from google.protobuf import descriptor_pb2
from polling import wait_until
from runs import LOGGER, ROWS, record_everything

from generated.messages import ImuSensorInformation
from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.runtime import Registry, SetupError
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Float32, Message
from roverlink.runtime.recording import schemas
from roverlink.runtime.recording.adapting import Adapter
from roverlink.runtime.recording.message_definitions import definition_of, message_type_from
from roverlink.runtime.recording.playback import Playback
from roverlink.runtime.recording.reader import Recording
from roverlink.runtime.recording.recorder import Recorder
from roverlink.runtime.recording.replaying import BoardReplay, RosReplay, Timed

_IMU = REGISTRY.by_name["imu_info"]


def _message(files: Any, name: str) -> Any:
    return next(message for file in files for message in file.message_type if message.name == name)


def _field(message: Any, name: str) -> Any:
    return next(field for field in message.field if field.name == name)


def _older(change: Callable[[Any], None]) -> Any:
    """The envelope of an older schema: today's, changed."""
    described = descriptor_pb2.FileDescriptorSet.FromString(schemas.descriptor_set_of(REGISTRY.envelope))
    change(described.file)
    return schemas.message_type_from("PBEnvelope", described.SerializeToString())


def _record(path: Path, envelope: Any, datagram: bytes, handler: Any = _IMU, message_type: Any = None) -> Recording:
    """A run with one inbound datagram, and a message of its topic where it had another type."""
    older: Registry = dataclasses.replace(REGISTRY, envelope=envelope)
    writing = Recorder(path, older, ROWS, LOGGER)
    received = writing.datagrams("received")
    topic = writing.topic(f"/{handler.route.topic}", message_type or handler.message_type, handler.route.qos)
    with writing:
        received([datagram])
        topic([cdr.encode((message_type or handler.message_type)())])
    return Recording(path)


# --- the same schema --------------------------------------------------------------------------------------------


def test_as_board_it_reproduces_the_original_datagrams(tmp_path: Path) -> None:
    """Every datagram that the bridge received, byte by byte and in order, plain or not."""
    handed = record_everything(tmp_path / "run.mcap")
    replay = BoardReplay(Recording(tmp_path / "run.mcap"), REGISTRY)
    assert [message.data for message in replay.messages()] == handed["/datagrams/received"]
    assert (replay.notes, replay.refused) == ([], {})


def test_one_peer_is_replayed_over_its_line(tmp_path: Path, free_port: int) -> None:
    """A bridge takes nothing from another peer over a line."""
    record_everything(tmp_path / "run.mcap", turns=2)
    line = f"tcp:127.0.0.1:{free_port}"
    rows = [one.route.name for one in REGISTRY.handlers if one.route.inbound and one.route.peer == "hardware"]
    with Rig(of_peers(QUIET, hardware=end("hw", f"{line}?listen"))) as rig:
        given = ["--project", str(Path(__file__).parents[2]), "--peer", "hardware", "--to", line]
        assert main(["recording", "replay", str(tmp_path / "run.mcap"), *given]) == 0
        wait_until(lambda: rig.account.received == 2 * len(rows), "all datagrams")
        assert rig.account.published == dict.fromkeys(rows, 2)
    with pytest.raises(SetupError, match="unknown peer 'hardwar'; did you mean 'hardware'"):
        BoardReplay(Recording(tmp_path / "run.mcap"), REGISTRY, "hardwar")


def test_as_ros_it_publishes_the_recorded_topics(tmp_path: Path) -> None:
    """Each inbound topic's messages as they were; what commands the rover, or one topic alone, if that is asked for."""
    handed = record_everything(tmp_path / "run.mcap", turns=3)
    inbound = {f"/{handler.route.topic}" for handler in REGISTRY.handlers if handler.route.inbound}
    for topics, commands, wanted in (
        (None, False, inbound),
        (None, True, set(ROWS)),
        ({"/imu_data"}, False, {"/imu_data"}),
    ):
        replay = RosReplay(Recording(tmp_path / "run.mcap"), REGISTRY, *filter(None, [topics]), commands=commands)
        found: defaultdict[str, list[bytes]] = defaultdict(list)
        for message in replay.messages():
            found[message.topic].append(message.data)
        assert found == {topic: handed[topic] for topic in wanted}
        assert topics or len(replay.left_out) == (0 if commands else 6)


class _Player:
    """Plays messages at these seconds of a recording, with a clock that only a wait moves."""

    def __init__(self, times: tuple[float, ...], speed: float = 1.0, start: float = 0.0) -> None:
        self._now = 100.0
        self._messages = [Timed(int(at * 1e9), "", b"") for at in times]
        bounds = self._messages[0].time, self._messages[-1].time
        self.playback = Playback(self._since, bounds, int(start * 1e9), speed, lambda: self._now)

    def _since(self, time: int) -> Iterator[Timed]:
        return (message for message in self._messages if message.time >= time)

    def wait(self, seconds: float) -> None:
        """Let time pass without taking a message."""
        self._now += seconds

    def rest(self) -> list[tuple[float, float]]:
        """Play to the end: how long each message was waited for, and its time."""
        played = []
        while (due := self.playback.due()) is not None:
            self.wait(max(0.0, due))
            played.append((round(max(0.0, due), 6), self.playback.take().time / 1e9))
        return played


def test_it_keeps_the_timing_of_the_run() -> None:
    """Each message waits for its time, twice as fast if that is asked for; a wait that was too long moves nothing."""
    assert _Player((7.0, 7.5, 7.5, 9.0), speed=2.0).rest() == [(0.0, 7.0), (0.25, 7.5), (0.0, 7.5), (0.75, 9.0)]
    late = _Player((0.0, 1.0, 2.0))
    late.wait(1.5)
    assert late.rest() == [(0.0, 0.0), (0.0, 1.0), (0.5, 2.0)]


def test_a_pause_moves_all_that_follows() -> None:
    """While it pauses nothing is due and the position stands still; then it goes on where it was."""
    player = _Player((0.0, 1.0))
    player.playback.take()
    player.wait(0.25)
    player.playback.toggle_pause()
    player.wait(60)
    assert (player.playback.due(), player.playback.position) == (math.inf, 250_000_000)
    player.playback.toggle_pause()
    assert player.rest() == [(0.75, 1.0)]


def test_it_seeks_forward_and_back() -> None:
    """What is skipped is not played, what is sought is played again; no seek leaves the recording."""
    player = _Player((0.0, 20.0, 40.0))
    player.playback.seek(15)
    assert player.playback.due() == 5.0
    player.playback.seek(-100)
    assert player.playback.position == 0
    player.playback.seek(100)
    player.playback.toggle_pause()
    player.playback.seek(-5)
    assert player.playback.position == 35_000_000_000
    player.playback.toggle_pause()
    assert player.rest() == [(5.0, 40.0)]


# --- an older schema --------------------------------------------------------------------------------------------


def _rename(files: Any) -> None:
    imu = _message(files, "SensorBoardIMUInfo")
    _field(imu, "accel_x").name = "acceleration_x"
    imu.field.remove(_field(imu, "error_code"))


def _swap(files: Any) -> None:
    imu = _message(files, "SensorBoardIMUInfo")
    x, y = _field(imu, "accel_x"), _field(imu, "accel_y")
    x.number, y.number = y.number, x.number


def _retype(files: Any) -> None:
    imu = _message(files, "SensorBoardIMUInfo")
    _field(imu, "accel_x").type = descriptor_pb2.FieldDescriptorProto.TYPE_DOUBLE
    _field(imu, "accel_y").type = descriptor_pb2.FieldDescriptorProto.TYPE_STRING


@pytest.mark.parametrize(
    ("change", "then", "now"),
    [
        (_rename, {"acceleration_x": 1.5}, {"accel_x": 1.5}),  # protobuf itself keeps them compatible
        (_swap, {"accel_x": 1.0, "accel_y": 2.0}, {"accel_x": 1.0, "accel_y": 2.0}),
        (_swap, {}, {}),  # an empty payload is still there
        (_retype, {"accel_x": 1.5, "accel_y": "up", "accel_z": 3.0}, {"accel_x": 1.5, "accel_z": 3.0}),
    ],
)
def test_fields_of_an_older_schema_are_carried_by_name(change: Any, then: dict[str, Any], now: dict[str, Any]) -> None:
    """Values follow names that are there then and now; a value of a type that does not fit stays at its default."""
    older = _older(change)
    adapter = Adapter(older, REGISTRY)
    assert (not adapter.changed and not adapter.refused) is (change is _rename)
    adapted = adapter.adapt(older(imu_info=then).SerializeToString())
    assert REGISTRY.envelope.FromString(adapted) == REGISTRY.envelope(imu_info=now)


def _other_payload(files: Any) -> None:
    oneof = _message(files, "PBEnvelope")
    field = _field(oneof, "imu_info")
    field.name, field.type_name = "old", _field(oneof, "ph_info").type_name
    field.json_name = "old"


def _one_more_payload(files: Any) -> None:
    oneof = _message(files, "PBEnvelope")
    added = oneof.field.add()
    added.CopyFrom(_field(oneof, "imu_info"))
    added.name, added.json_name, added.number = "old", "old", 77


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (
            _other_payload,
            "number 13 was 'old' (SensorBoardPHInfo) in the recording, and is 'imu_info' (SensorBoardIMUInfo) in the "
            "present table",
        ),
        (_one_more_payload, "number 77, 'old' (SensorBoardIMUInfo) in the recording, is retired in the present table"),
    ],
    ids=["another thing today", "retired today"],
)
def test_a_number_that_means_something_else_today_is_not_replayed(
    tmp_path: Path, change: Callable[[Any], None], reason: str
) -> None:
    """It is told which payload the number had; the bytes are not published as what they are not."""
    older = _older(change)
    today = dataclasses.replace(REGISTRY, retired={77: "old"})
    replay = BoardReplay(_record(tmp_path / "run.mcap", older, older(old={}).SerializeToString()), today)
    assert list(replay.messages()) == []
    assert replay.refused == {reason: 1}


@dataclasses.dataclass
class OlderImu(Message):
    """The message as it was before most of its fields were added."""

    __msgtype__ = "comms/msg/ImuSensorInformation"

    accel_x: Float32 = 0.0


def test_topics_whose_type_has_changed_are_made_anew_from_the_datagrams(tmp_path: Path) -> None:
    """With an older schema on both sides, today's topics carry today's messages."""

    def move(files: Any) -> None:
        _field(_message(files, "SensorBoardIMUInfo"), "accel_x").number = 33

    older = _older(move)
    datagram = older(imu_info={"accel_x": 1.5, "is_calibrated": True}).SerializeToString()
    replay = RosReplay(_record(tmp_path / "run.mcap", older, datagram, message_type=OlderImu), REGISTRY)
    (message,) = replay.messages()
    assert message.topic == "/imu_data"
    assert replay.endpoints["/imu_data"].message_type is ImuSensorInformation
    assert cdr.decode(ImuSensorInformation, message.data) == ImuSensorInformation(accel_x=1.5, is_calibrated=True)
    assert "made again from the recorded datagrams: /imu_data" in replay.notes


def test_without_the_datagrams_a_changed_topic_is_told(tmp_path: Path) -> None:
    """A type of the past is not published as today's."""
    path = tmp_path / "run.mcap"
    _record(path, REGISTRY.envelope, b"", message_type=OlderImu)
    (tmp_path / "run.datagrams.mcap").unlink()
    replay = RosReplay(Recording(path), REGISTRY)
    assert list(replay.messages()) == []
    assert list(replay.refused) == [
        "/imu_data: its message type has changed, and the recording has no datagrams to make the messages from"
    ]


# --- definitions ------------------------------------------------------------------------------------------------


def test_definitions_as_ros2_writes_them_are_understood() -> None:
    """Comments, constants, defaults, bounds, arrays and names without a package."""
    text = """\
# A comment.
uint8 OK=0
string<=5 GREETING="hi"
bool flag true
string<=7 name
float64[3] at
uint8[<=4] raw  # at most four
Inner inner
other_msgs/Thing[] things
================================================================================
MSG: some_msgs/Inner
int32 x
================================================================================
MSG: other_msgs/Thing
string text
"""
    made: Any = message_type_from("some_msgs/msg/Outer", text)
    assert definition_of(made).splitlines()[:6] == [
        "bool flag",
        "string<=7 name",
        "float64[3] at",
        "uint8[<=4] raw",
        "some_msgs/Inner inner",
        "other_msgs/Thing[] things",
    ]


@pytest.mark.parametrize(
    ("text", "expected"),
    [("Nowhere x", "uses some_msgs/Nowhere but does not define it"), ("wstring x", "a wide string")],
)
def test_a_definition_that_cannot_be_read_is_told(text: str, expected: str) -> None:
    """By what is missing."""
    with pytest.raises(SetupError, match=expected):
        message_type_from("some_msgs/msg/Outer", text)
