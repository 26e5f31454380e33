"""A whole bridge on the network of a rover: boards with their own addresses on one port, a router, and a bad radio."""

from __future__ import annotations

import contextlib
import json
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from network import RoverNetwork, impair, inside, ip, why_not
from polling import wait_until
from relay import Relay

pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(why_not()), reason=why_not())]

_BOARD_PORT, _BASE_PORT, _PORT = 8, 6000, 5000
_FOUND_AGAIN_S = 45.0  # names are looked up every 30 s
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
_NETEM = ("delay", "10ms", "8ms", "loss", "10%", "reorder", "25%")


class _Board:
    """A board's socket."""

    def __init__(self, namespace: str, address: str, port: int = _BOARD_PORT) -> None:
        self.socket = inside(namespace, lambda: socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 * 1024 * 1024)
        self.socket.bind((address, port))
        self.socket.setblocking(False)

    def arrived(self) -> list[bytes]:
        """What has arrived since the last call."""
        found = []
        with contextlib.suppress(BlockingIOError):
            while True:
                found.append(self.socket.recv(2048))
        return found


class _Rover:
    """`roverlink run` on the rover, and the boards."""

    def __init__(self, network: RoverNetwork, project: Path) -> None:
        self.network = network
        program = [sys.executable, "-m", "roverlink", "run", "--json", "--middleware", "memory", "--project", project]
        self._child = subprocess.Popen(
            ["ip", "netns", "exec", network.rover, *map(str, program)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.log: list[str] = []
        threading.Thread(target=self._read_log, daemon=True).start()
        assert self._child.stdout is not None
        assert json.loads(self._child.stdout.readline())["port"] == _PORT
        self.arm = _Board(network.arm, f"{network.SWITCH}.21")
        self.driving = _Board(network.driving, f"{network.SWITCH}.22")
        self.sensor = _Board(network.sensor, f"{network.SWITCH}.23")

    def _read_log(self) -> None:
        assert self._child.stderr is not None
        self.log.extend(self._child.stderr)

    def logged(self, text: str) -> bool:
        """True if a line of the log contains a text."""
        return any(text in line for line in [*self.log])

    def stop(self) -> dict[str, Any]:
        """Stop the bridge; return its account."""
        self._child.send_signal(signal.SIGINT)
        output, _ = self._child.communicate(timeout=30)
        account: dict[str, Any] = json.loads(output)
        return account

    def close(self) -> None:
        """End the program, and close the boards' sockets."""
        if self._child.poll() is None:
            self._child.kill()
            self._child.wait()
        for board in (self.arm, self.driving, self.sensor):
            board.socket.close()

    def say_wind(self, number: int) -> bytes:
        """Send a padded datagram of the sensor board; return the envelope in it."""
        wind = b"\x22\x02\x08" + bytes([number % 127 + 1])
        self.sensor.socket.sendto(wind + bytes(20), (self.network.ROVER, _PORT))
        return wind


@pytest.fixture
def network() -> Iterator[RoverNetwork]:
    """The namespaces."""
    with RoverNetwork() as network:
        yield network


@pytest.fixture
def start(network: RoverNetwork, tmp_path: Path) -> Iterator[Any]:
    """A function that starts the bridge, with the address of the basestation, and with more keys in the table."""
    started: list[_Rover] = []

    def begin(base: str = f"{RoverNetwork.RADIO}.2", *, more: str = "") -> _Rover:
        started.append(_Rover(network, _project(tmp_path / "rover", base, more)))
        return started[0]

    yield begin
    for rover in started:
        rover.close()


def _project(folder: Path, base: str = "", more: str = "", proto: str = _PROTO) -> Path:
    """Make a project, with more keys in its table; its folder."""
    (folder / "proto").mkdir(parents=True)
    (folder / "proto" / "all.proto").write_text(proto)
    table = _TABLE.replace("BASE", base or f"{RoverNetwork.RADIO}.2").replace("DEADMAN", _DEADMAN)
    (folder / "mapping.yaml").write_text(table + more)
    subprocess.run([sys.executable, "-m", "roverlink", "generate"], cwd=folder, check=True, capture_output=True)
    return folder


def _numbers(datagrams: list[bytes]) -> set[int]:
    """The numbers of the payloads in envelopes; a payload of zeros has the bytes `tag 00`."""
    return {datagram[0] >> 3 for datagram in datagrams}


def _heard(board: _Board) -> bool:
    return bool(board.arrived())


def test_each_row_reaches_its_board_and_no_other(network: RoverNetwork, start: Any) -> None:
    """One by its address, one by its name once the name is known, and one once it has spoken."""
    rover = start()
    wait_until(lambda: rover.logged("DrivingBoard of hardware: driving.rover cannot be resolved"), "the warning")
    network.hosts.write_text(f"{network.SWITCH}.22 driving.rover\n")
    wait_until(lambda: _heard(rover.driving), "the driving board")
    assert rover.sensor.arrived() == []
    rover.say_wind(1)
    wait_until(lambda: _heard(rover.sensor), "the sensor board")
    rover.arm.arrived()
    time.sleep(1)
    boards = (rover.arm, rover.driving, rover.sensor)
    assert [_numbers(board.arrived()) for board in boards] == [{1}, {2}, {3}]
    account = rover.stop()
    events = {"DrivingBoard not_resolved": 1, "DrivingBoard resolved": 1, "SensorBoard learned": 1}
    assert account["link_events"] == {f"hardware {event}": count for event, count in events.items()}


def test_boards_that_change_their_addresses_are_found_again(network: RoverNetwork, start: Any) -> None:
    """One by its name, and one by what it says; nothing is restarted."""
    network.hosts.write_text(f"{network.SWITCH}.22 driving.rover\n")
    rover = start()
    rover.say_wind(1)
    wait_until(lambda: _heard(rover.driving) and _heard(rover.sensor), "the boards")
    network.move(network.driving, 22, 32)
    network.move(network.sensor, 23, 33)
    for board in (rover.driving, rover.sensor):
        board.socket.close()
    rover.driving = _Board(network.driving, f"{network.SWITCH}.32")
    rover.sensor = _Board(network.sensor, f"{network.SWITCH}.33")
    network.hosts.write_text(f"{network.SWITCH}.32 driving.rover\n")
    rover.say_wind(2)
    wait_until(lambda: _heard(rover.sensor), "the sensor board")
    deadline = time.monotonic() + _FOUND_AGAIN_S
    while not _heard(rover.driving):
        assert time.monotonic() < deadline, "the driving board was not found again"
        time.sleep(0.1)
    account = rover.stop()
    assert account["link_events"]["hardware DrivingBoard address_changed"] == 1
    assert account["link_events"]["hardware SensorBoard address_changed"] == 1


def test_a_cable_that_is_pulled_and_put_back(network: RoverNetwork, start: Any) -> None:
    """The rover's own cable: each board is unreachable once and reachable again once, and gets its stops again."""
    network.hosts.write_text(f"{network.SWITCH}.22 driving.rover\n")
    rover = start()
    wait_until(lambda: _heard(rover.arm) and _heard(rover.driving), "the boards")
    ip("-n", network.rover, "link", "set", "cable", "down")
    wait_until(lambda: rover.logged("ArmBoard of hardware: cannot send to"), "the warning")
    time.sleep(1)
    rover.arm.arrived()
    ip("-n", network.rover, "link", "set", "cable", "up")
    ip("-n", network.rover, "route", "replace", "default", "via", "10.98.0.1")
    wait_until(lambda: _heard(rover.arm) and _heard(rover.driving), "the boards again")
    account = rover.stop()
    assert account["link_events"]["hardware ArmBoard unreachable"] == 1
    assert account["link_events"]["hardware ArmBoard reachable_again"] == 1
    assert account["unsent"]["hardware"] > 5


def test_a_basestation_behind_a_bad_radio(network: RoverNetwork, start: Any) -> None:
    """What comes through parses strictly, though the board pads its datagrams, and comes from this row alone."""
    with contextlib.ExitStack() as stack:
        if impair(network.router, f"to{network.base[-6:]}", *_NETEM):  # this kernel has no netem
            sock = inside(network.router, lambda: socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            sock.bind(("10.98.0.1", _BASE_PORT))
            to = (f"{network.RADIO}.2", _BASE_PORT)
            stack.enter_context(Relay(sock, to, 5, loss=0.1, twice=0.0, delay_s=0.02))
            rover = start("10.98.0.1")
        else:
            rover = start()
        base = _Board(network.base, f"{network.RADIO}.2", _BASE_PORT)
        stack.callback(base.socket.close)
        sent = []
        for number in range(1000):
            sent.append(rover.say_wind(number))
            time.sleep(0.001)
        time.sleep(1)
        arrived = base.arrived()
    assert set(arrived) <= set(sent)
    assert 800 < len(arrived) < 1000
    assert arrived != sent[: len(arrived)]
    account = rover.stop()
    assert account["forwarded"] == account["published"] == 1000


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
    network: RoverNetwork, start: Any, tmp_path: Path
) -> None:
    """The board was flashed with other protos; the log names the board and its row, and no other row."""
    rover = start(more=_LINK)
    other = _project(tmp_path / "board", more=_LINK, proto=_PROTO.replace("Goal { int32 x", "Goal { float x", 1))
    program = [sys.executable, "-c", _BOARD_PROGRAM, str(other), network.ROVER]
    with subprocess.Popen(["ip", "netns", "exec", network.arm, *program], stdout=subprocess.PIPE, text=True) as board:
        assert board.stdout is not None
        began = float(board.stdout.readline())
        wait_until(lambda: rover.logged("has another schema of"), "the warning")
        board.kill()
    (warning,) = (line for line in rover.log if "has another schema of" in line)
    assert "ArmBoard of hardware has another schema of arm (1): " in warning
    assert float(re.findall(r"\[([\d.]+)\]", warning)[0]) - began < _NAMED_WITHIN_S
