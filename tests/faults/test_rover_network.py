"""A whole bridge on the network of a rover: boards with their own addresses on one port, a router, and a bad radio."""

from __future__ import annotations

import contextlib
import json
import re
import select
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from linked import write_project
from network import RoverNetwork, arrived, bound, inside, ip, why_not
from polling import wait_until
from programs import Start
from relay import Relay

from roverlink.runtime.net.transports.framing import DelimitedReader

pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(why_not()), reason=why_not())]

_BOARD_PORT, _BASE_PORT, _PORT = 8, 6000, 5000
_TABLE = f"""
version: 1
proto: {{root: proto}}
envelope: {{file: envelope.proto, message: Envelope, oneof: payload}}
ros: {{package: rover}}
peers:
  hardware:
    port: {_BOARD_PORT}
    boards:
      ArmBoard: {{host: {RoverNetwork.SWITCH}.21}}
      DrivingBoard: {{host: driving.rover}}
      SensorBoard: {{host: learn}}
  basestation: {{host: BASE, port: {_BASE_PORT}}}
messages:
  - {{number: 1, name: arm, proto: ArmBoardGoal, topic: arm, direction: ros_to_hardware, deadman: DEADMAN}}
  - {{number: 2, name: drive, proto: DrivingBoardGoal, topic: drive, direction: ros_to_hardware, deadman: DEADMAN}}
  - {{number: 3, name: probe, proto: Goal, topic: probe, direction: ros_to_hardware, board: SensorBoard,
     deadman: DEADMAN}}
  - {{number: 4, name: wind, proto: SensorBoardWind, topic: wind, direction: hardware_to_ros, forward: [basestation]}}
"""
_DEADMAN = "{after: 100ms, send: {x: 0}, repeat: 100ms}"
_PROTO = """
syntax = "proto3";
message ArmBoardGoal { int32 x = 1; }
message DrivingBoardGoal { int32 x = 1; }
message Goal { int32 x = 1; }
message SensorBoardWind { int32 x = 1; }
"""


class _Board:
    """A board's socket."""

    def __init__(self, namespace: str, address: str, port: int = _BOARD_PORT) -> None:
        self.socket = inside(namespace, lambda: bound((address, port)))

    def arrived(self) -> list[bytes]:
        """What has arrived since the last call."""
        return list(arrived(self.socket))


class _Rover:
    """`roverlink run` on the rover, and the boards."""

    def __init__(self, network: RoverNetwork, start: Start, project: Path) -> None:
        words = ("run", "--json", "--middleware", "memory", "--project", project)
        self.hosts = project.parent / "hosts"
        self.hosts.write_text("127.0.0.1 localhost\n")
        self.program = inside(network.rover, lambda: start(*words), self.hosts)
        ready = json.loads(self.program.wait_for('"port"', self.program.output))
        assert ready["port"] == _PORT
        self.arm = _Board(network.arm, f"{network.SWITCH}.21")
        self.driving = _Board(network.driving, f"{network.SWITCH}.22")
        self.sensor = _Board(network.sensor, f"{network.SWITCH}.23")

    def stop(self) -> dict[str, Any]:
        """Stop the bridge; return its account."""
        assert self.program.interrupt() == 0
        account: dict[str, Any] = json.loads("\n".join(self.program.output[1:]))
        return account

    def close(self) -> None:
        """Close the sockets of the boards."""
        for board in (self.arm, self.driving, self.sensor):
            board.socket.close()

    def say_wind(self, number: int) -> bytes:
        """Send a padded datagram of the sensor board; return the envelope in it."""
        wind = b"\x22\x02\x08" + bytes([number % 127 + 1])
        self.sensor.socket.sendto(wind + bytes(20), (RoverNetwork.ROVER, _PORT))
        return wind

    def meets_sensor(self, number: int) -> None:
        """Let the sensor board say something, as a board does again and again, until the bridge answers it."""
        wait_until(lambda: self.say_wind(number) and self.sensor.arrived(), "a datagram for the sensor board")


Begin = Callable[..., _Rover]


@pytest.fixture
def network() -> Iterator[RoverNetwork]:
    """The namespaces."""
    with RoverNetwork() as network:
        yield network


@pytest.fixture
def begin(network: RoverNetwork, start: Start, tmp_path: Path) -> Iterator[Begin]:
    """A function that starts the bridge, with the address of the basestation, and with more keys in the table."""
    with contextlib.ExitStack() as held:

        def begin(base: str = f"{RoverNetwork.RADIO}.2", *, more: str = "") -> _Rover:
            rover = _Rover(network, start, _project(tmp_path / "rover", base, more))
            held.callback(rover.close)
            return rover

        yield begin


def _project(folder: Path, base: str = f"{RoverNetwork.RADIO}.2", more: str = "", proto: str = _PROTO) -> Path:
    """Make a project, with more keys in its table; its folder."""
    return write_project(folder, _TABLE.replace("BASE", base).replace("DEADMAN", _DEADMAN) + more, proto)


def _hear(*boards: _Board) -> None:
    """Wait until each of the boards gets a datagram after now."""
    for board in boards:
        board.arrived()
    for board in boards:
        wait_until(board.arrived, "a datagram for a board")


def test_each_row_reaches_its_board_and_no_other(network: RoverNetwork, begin: Begin) -> None:
    """One by its address, one by its name once the name is known, and one once it has spoken."""
    rover = begin()
    rover.program.wait_for("DrivingBoard of hardware: driving.rover cannot be resolved")
    rover.hosts.write_text(f"{network.SWITCH}.22 driving.rover\n")
    wait_until(rover.driving.arrived, "the driving board")
    assert rover.sensor.arrived() == []
    rover.meets_sensor(1)
    heard: list[list[bytes]] = [[], [], []]

    def often() -> bool:
        for datagrams, board in zip(heard, (rover.arm, rover.driving, rover.sensor)):
            datagrams += board.arrived()
        return min(map(len, heard)) > 5

    wait_until(often, "several datagrams for each board")
    numbers = [{datagram[0] >> 3 for datagram in datagrams} for datagrams in heard]  # a payload of zeros is `tag 00`
    assert numbers == [{1}, {2}, {3}]
    events = {"DrivingBoard not_resolved": 1, "DrivingBoard resolved": 1, "SensorBoard learned": 1}
    assert rover.stop()["link_events"] == {f"hardware {event}": count for event, count in events.items()}


def test_boards_that_change_their_addresses_are_found_again(network: RoverNetwork, begin: Begin) -> None:
    """One by its name, which is looked up every 30 s, and one by what it says; nothing is restarted."""
    rover = begin()
    rover.hosts.write_text(f"{network.SWITCH}.22 driving.rover\n")
    rover.meets_sensor(1)
    _hear(rover.driving)
    network.move(network.driving, 22, 32)
    network.move(network.sensor, 23, 33)
    rover.close()
    rover.arm = _Board(network.arm, f"{network.SWITCH}.21")
    rover.driving = _Board(network.driving, f"{network.SWITCH}.32")
    rover.sensor = _Board(network.sensor, f"{network.SWITCH}.33")
    rover.hosts.write_text(f"{network.SWITCH}.32 driving.rover\n")
    rover.meets_sensor(2)
    _hear(rover.driving)
    events = rover.stop()["link_events"]
    assert events["hardware DrivingBoard address_changed"] == events["hardware SensorBoard address_changed"] == 1


def test_a_cable_that_is_pulled_and_put_back(network: RoverNetwork, begin: Begin) -> None:
    """The rover's own cable: each board is unreachable once and reachable again once, and gets its stops again."""
    rover = begin()
    rover.hosts.write_text(f"{network.SWITCH}.22 driving.rover\n")
    _hear(rover.arm, rover.driving)
    ip("-n", network.rover, "link", "set", "cable", "down")
    rover.program.wait_for("ArmBoard of hardware: cannot send to")
    ip("-n", network.rover, "link", "set", "cable", "up")
    ip("-n", network.rover, "route", "replace", "default", "via", "10.98.0.1")
    _hear(rover.arm, rover.driving)
    account = rover.stop()
    assert account["link_events"]["hardware ArmBoard unreachable"] == 1
    assert account["link_events"]["hardware ArmBoard reachable_again"] == 1
    assert account["unsent"]["hardware"] > 0


def test_after_a_gap_of_a_tcp_radio_nothing_old_arrives(network: RoverNetwork, begin: Begin) -> None:
    """The connection is given up with what it holds, and the next one begins with what is sent after the gap."""
    base, reader = (f"{network.RADIO}.2", 7000), DelimitedReader(2000)
    with inside(network.base, lambda: socket.create_server(base)) as server:
        rover = begin("tcp:{}:{}".format(*base))
        with server.accept()[0] as before:
            wait_until(lambda: rover.say_wind(0) and before in select.select([before], [], [], 0)[0], "a wind")
            ip("-n", network.router, "link", "set", "tobase", "down")
            gone = "basestation: tcp:10.98.9.2:7000: "
            wait_until(lambda: rover.say_wind(1) and any(gone in line for line in rover.program.errors), "the end")
            rover.say_wind(1)
        ip("-n", network.router, "link", "set", "tobase", "up")
        with server.accept()[0] as after:
            wait_until(lambda: rover.say_wind(2) and after in select.select([after], [], [], 0)[0], "a wind")
            assert set(reader.take(after.recv(2000))) == {rover.say_wind(2)}
    account = rover.stop()
    assert account["link_events"]["basestation disconnected"] >= 1
    assert account["unsent"].get("basestation", 0) + account["undelivered"].get("basestation not_connected", 0) > 0


def test_a_basestation_behind_a_bad_radio(network: RoverNetwork, begin: Begin) -> None:
    """What comes through parses strictly, though the board pads its datagrams, and comes from this row alone."""
    count, burst = 1000, 50
    address = ("10.98.0.1", _BASE_PORT)
    sock = inside(network.router, lambda: bound(address))
    base = _Board(network.base, f"{network.RADIO}.2", _BASE_PORT)
    sent, heard = [], list[bytes]()
    with Relay(sock, (f"{network.RADIO}.2", _BASE_PORT), 5, loss=0.1, twice=0.0, delay_s=0.02) as relay, base.socket:
        rover = begin("10.98.0.1")
        for number in range(count):
            sent.append(rover.say_wind(number))
            if number % burst == burst - 1:  # so few at once that no buffer is full
                relay.wait_for(number + 1)
                wait_until(lambda: heard.extend(base.arrived()) or len(heard) == relay.handed_on, "the burst")
    assert set(heard) <= set(sent)
    assert 0.8 * count < len(heard) < count
    assert heard != sent[: len(heard)]
    account = rover.stop()
    assert account["forwarded"] == account["published"] == count


_LINK = "link: {number: 20}\n"
_BOARD_PROGRAM = """
import sys, time
from roverlink.runtime import load_registry
from roverlink.runtime.client import BlockingPeer
registry = load_registry(sys.argv[1])
with BlockingPeer.open("hardware", board="ArmBoard", registry=registry, host=sys.argv[2], local_port=0) as board:
    print(time.time(), flush=True)
    for _ in board:
        pass
"""
_NAMED_WITHIN_S = 2.0  # an operator must see it before the rover drives


def test_a_board_with_another_schema_is_named_within_two_seconds(
    network: RoverNetwork, begin: Begin, tmp_path: Path
) -> None:
    """The board was flashed with other protos; the log names the board and its row, and no other row."""
    rover = begin(more=_LINK)
    other = _project(tmp_path / "board", more=_LINK, proto=_PROTO.replace("Goal { int32 x", "Goal { float x", 1))
    words = [sys.executable, "-c", _BOARD_PROGRAM, str(other), network.ROVER]
    with inside(network.arm, lambda: subprocess.Popen(words, stdout=subprocess.PIPE, text=True)) as board:
        assert board.stdout is not None
        began = float(board.stdout.readline())
        warning = rover.program.wait_for("has another schema of")
        board.kill()
    assert sum("has another schema of" in line for line in rover.program.errors) == 1
    assert "ArmBoard of hardware has another schema of arm (1): " in warning
    assert float(re.findall(r"\[([\d.]+)\]", warning)[0]) - began < _NAMED_WITHIN_S
