"""Ends with another transport than UDP: what comes over a serial line or TCP, and what goes there."""

from __future__ import annotations

import asyncio
import contextlib
import io
import itertools
import socket
import threading
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest
from bridge_rig import QUIET, Rig, end, envelope, listener, of_peers, waiting
from google.protobuf.proto import parse_length_prefixed, serialize_length_prefixed
from hypothesis import given
from hypothesis import strategies as st
from lines import Cable, cable, framed
from polling import PATIENCE_S, wait_until

from generated.registry import REGISTRY
from roverlink.heard_bridges import state_of
from roverlink.link_judgement import conditions_of
from roverlink.runtime import Registry
from roverlink.runtime.bridge.ends import LinkState
from roverlink.runtime.client import BlockingPeer, Peer
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.registry import End, EndName
from roverlink.runtime.monitoring import prometheus
from roverlink.runtime.monitoring.diagnostic_array import array_of
from roverlink.runtime.monitoring.monitor import Monitor
from roverlink.runtime.net.carrier import Carrier
from roverlink.runtime.net.transports import serial, transport_at
from roverlink.runtime.net.transports.framing import DelimitedReader, FrameReader, decode_frame, delimited, encode_frame
from roverlink.runtime.text.host_names import hosts_in

_HARDWARE = EndName("hardware")
_IMU, _MODE = envelope(imu_info={"accel_z": 9.81}), envelope(control_mode={})

# --- frames -----------------------------------------------------------------------------------------------------

_DATAGRAMS = st.binary(max_size=600) | st.lists(st.sampled_from([0, 1, 255]), max_size=600).map(bytes)


@given(_DATAGRAMS)
def test_a_frame_is_that_of_others(datagram: bytes) -> None:
    """COBS of another package, and the CRC whose check value a catalogue has, make the same frame of any datagram."""
    assert encode_frame(datagram) == framed(datagram)
    assert decode_frame(framed(datagram)[:-1]) == datagram
    assert encode_frame(b"123456789").endswith(b"\x29\xb1\0")


@given(st.lists(st.tuples(_DATAGRAMS, st.binary(max_size=40)), max_size=8), st.integers(1, 50))
def test_a_reader_finds_its_place_after_noise(sent: list[tuple[bytes, bytes]], piece: int) -> None:
    """Noise costs the frame into which it falls, and no other, in whatever pieces the bytes arrive."""
    line = b"".join(noise + b"\0" + framed(datagram) for datagram, noise in sent)
    reader = FrameReader(600)
    read = [one for at in range(0, len(line), piece) for one in reader.take(line[at : at + piece])]
    assert read == [datagram for datagram, _ in sent]
    assert reader.refused == sum(len([*filter(None, noise.split(b"\0"))]) for _, noise in sent)


def test_a_line_that_never_ends_a_frame_needs_no_memory() -> None:
    """It is one damaged frame, however long; and the next one is read."""
    reader = FrameReader(100)
    for _ in range(1000):
        assert reader.take(b"\xff" * 1000) == []
    assert reader.refused == 1
    assert reader.take(b"\xff\0" + framed(b"next")) == [b"next"]
    assert reader.refused == 1


@given(st.lists(st.binary(max_size=300), max_size=8), st.integers(1, 50))
def test_tcp_has_the_lengths_of_protobuf(sent: list[bytes], piece: int) -> None:
    """What protobuf's own functions write is read, and they read what is written."""
    messages = [QUIET.envelope.FromString(envelope(imu_info={"accel_z": len(one)})) for one in sent]
    stream = io.BytesIO()
    for message in messages:
        serialize_length_prefixed(message, stream)
    reader = DelimitedReader(65_507)
    line = stream.getvalue()
    read = [one for at in range(0, len(line), piece) for one in reader.take(line[at : at + piece])]
    assert read == [message.SerializeToString() for message in messages]
    back = io.BytesIO(b"".join(map(delimited, read)))
    assert [parse_length_prefixed(QUIET.envelope, back) for _ in messages] == messages
    for wrong in (b"\x80\x80\x04", b"\x80\x80\x80\x80\x80"):
        with pytest.raises(ValueError, match="behind their lengths"):
            reader.take(wrong)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        *((good, "") for good in ("serial:/dev/ttyACM*?baud=921600", "tcp:[fd00::1]:7000", "tcp:0.0.0.0:7?listen")),
        ("serial:", "write an address such as serial:/dev/ttyACM0"),
        ("serial:/dev/x?baud=fast", "'fast' is no value of the option 'baud'"),
        ("serial:/dev/x?bauds=1", "no option 'bauds'; did you mean 'baud'"),
        ("serial:/dev/x?", "write an address"),
        ("tcp:10.0.0.7", "write an address such as tcp:10.0.0.7:7000"),
        ("tcp:10.0.0.7:0", "write an address"),
        ("can:can0?send=0x1", "it lacks the option 'receive'"),
        ("can:can0?send=101&receive=0x102", "'101' is no value of the option 'send'"),
        ("can:can0?send=0x20000000&receive=0x102", "is no value of the option 'send'"),
        ("can:can0?send=0x101&receive=0x101", "each direction needs an identifier of its own"),
        ("can:can0?send=0x101&receive=0x102&fd=2", "'2' is no value of the option 'fd'"),
        ("can:can0?send=0x101&receive=0x102&brs=1", "can has no option 'brs'"),
        ("serial:/dev/x,10.0.0.1", "cannot stand beside other hosts"),
    ],
)
def test_addresses_of_lines(text: str, reason: str) -> None:
    """A wrong address says what is wrong with it."""
    with pytest.raises(ValueError, match=reason.replace("*", r"\*")) if reason else contextlib.nullcontext():
        assert hosts_in(text) == (text,)


# --- a bridge ---------------------------------------------------------------------------------------------------


def _on_line(host: object, **more: object) -> Registry:
    """The sample's registry, whose hardware has a line."""
    return of_peers(QUIET, hardware=end("hw", str(host), **more))


@pytest.fixture
def plugged(tmp_path: Path) -> Iterator[Cable]:
    """A cable that is plugged in."""
    with cable(tmp_path / "ttyACM0") as plugged:
        yield plugged


def _state(rig: Rig) -> LinkState:
    return rig.bridge.link_states()[_HARDWARE]


def _is_connected(rig: Rig) -> None:
    wait_until(lambda: _state(rig).state == "ok", "a connection")


def _arrives(rig: Rig, topic: str, count: int) -> None:
    wait_until(lambda: len(rig.on_topic[topic]) >= count, f"{count} messages on {topic}")


def test_a_board_on_a_serial_port(plugged: Cable) -> None:
    """Its datagrams reach topics and other peers, commands reach it, and noise is counted and costs nothing else."""
    name = f"serial:{plugged.path}?baud=921600"
    with Rig(_on_line(name)) as rig:
        _is_connected(rig)
        plugged.write(b"\x07boot: v1\r\n\0")
        plugged.send(_IMU, envelope(ph_info={}))
        _arrives(rig, "imu_data", 1)
        assert rig.arrived("basestation", at_least=2) == [_IMU, envelope(ph_info={})]
        assert rig.publish("drive_motor") == plugged.receive()
        assert _state(rig) == LinkState((name,), "ok")
        assert rig.bridge.account.damaged == {("hardware", ""): 1}
        assert rig.bridge.account.as_dict()["undelivered"] == {}
        text = prometheus.text_of(Monitor("bridge", rig.registry, rig.bridge).state())
        assert 'roverlink_damaged_total{board="",peer="hardware"} 1.0' in text


def test_the_stops_leave_before_the_line_closes(plugged: Cable) -> None:
    """A bridge that ends tells the board three times to stop, and the line takes all of them."""
    hardware = {"host": f"serial:{plugged.path}", "host_parameter": "hw_host"}
    with Rig(of_peers(REGISTRY, hardware=hardware)) as rig:
        _is_connected(rig)
        command = rig.publish("drive_motor", rig.registry.by_name["drive_motor"].payload_type(distance_to_go=1))
        wait_until(lambda: rig.account.sent["drive_motor"], "the command")
    while plugged.receive() != command:
        pass
    stops = 0
    while stops < 3:
        stops += plugged.receive() == envelope(drive_motor={})


def test_a_cable_that_comes_back_under_another_name(tmp_path: Path, plugged: Cable) -> None:
    """The state says what is missing; commands of that time are counted as not sent, and none comes later."""
    with Rig(_on_line(f"serial:{tmp_path}/ttyACM*")) as rig:
        _is_connected(rig)
        plugged.pull()
        wait_until(lambda: _state(rig).state == "not_connected", "the end of the connection")
        wait_until(lambda: f"there is no {tmp_path}/ttyACM*" in _state(rig).fault, "the reason")
        rig.publish("drive_motor")
        assert rig.bridge.account.unsent == {"hardware": 1}
        state = state_of(array_of(Monitor("bridge", rig.registry, rig.bridge).state(), 0, {}))
        assert state is not None
        told = conditions_of(state)["link hardware"]
        assert told.text == f"hardware gets no commands: there is no {tmp_path}/ttyACM*; connect the cable"
        with cable(tmp_path / "ttyACM1") as other:
            _is_connected(rig)
            other.send(_IMU)
            _arrives(rig, "imu_data", 1)
            command = rig.publish("arm_ctrl")
            assert other.receive() == command
        events = rig.bridge.account.link_events
        assert (events["hardware", "", "connected"], events["hardware", "", "disconnected"] >= 1) == (2, True)


def test_nobody_on_the_network_speaks_for_a_line(plugged: Cable) -> None:
    """A row of the board is refused from every other sender, also a valid one; other peers speak as before."""
    with Rig(_on_line(f"serial:{plugged.path}")) as rig:
        _is_connected(rig)
        rig.receive(_IMU, _MODE)
        rig.receive(_IMU, via=rig.peers["hardware"])
        account = rig.bridge.account
        assert (account.dropped, account.published) == ({"wrong_source": 2}, {"control_mode": 1})
        plugged.send(_MODE, _IMU)
        _arrives(rig, "imu_data", 1)
        assert rig.bridge.account.dropped == {"wrong_source": 3}


def test_a_board_speaks_over_its_own_line_alone(plugged: Cable) -> None:
    """One board of a peer on a line, the other one on the network: neither speaks for the other."""
    boards = (End("ArmBoard", **end("arm", f"serial:{plugged.path}")), End("DrivingBoard", **end("drive", "127.0.0.2")))
    registry = of_peers(QUIET, hardware={"boards": boards, "port_parameter": ""})
    arm, drive = envelope(arm_diag={}), envelope(drive_diag={})
    with Rig(registry) as rig:
        wait_until(lambda: rig.bridge.link_states()[EndName("hardware", "ArmBoard")].state == "ok", "a connection")
        rig.receive(arm, drive)
        plugged.send(drive, arm)
        _arrives(rig, "arm_diag", 1)
        assert rig.bridge.account.published == {"drive_diag": 1, "arm_diag": 1}
        assert rig.bridge.account.dropped == {"wrong_source": 2}


def test_a_host_that_becomes_a_line(plugged: Cable) -> None:
    """The parameter changes the transport while the bridge runs, and a wrong one changes nothing."""
    with listener() as board, Rig(_on_line("127.0.0.1", port=board.getsockname()[1])) as rig:
        assert rig.publish("drive_motor") == board.recv(2000)
        rig.receive(_IMU)
        for wrong in ("serial:/dev/x?bad=1", f"serial:{plugged.path},10.0.0.1"):
            with pytest.raises(SetupError, match="'hw_host'"):
                rig.live.change({"hw_host": wrong})
        with pytest.raises(SetupError, match="several ends may have this host; write `host: tcp:x:1` at one peer"):
            rig.live.change({"dst_ip": "tcp:x:1"})
        rig.live.change({"hw_host": f"serial:{plugged.path}"})
        _is_connected(rig)
        assert rig.publish("drive_motor") == plugged.receive()
        rig.receive(_IMU)
        assert rig.bridge.account.dropped == {"wrong_source": 1}
        rig.live.change({"hw_host": "127.0.0.1"})
        assert rig.publish("drive_motor") == board.recv(2000)
        rig.receive(_IMU)
        assert (rig.bridge.account.published["imu_info"], waiting(board)) == (2, [])


# --- TCP --------------------------------------------------------------------------------------------------------


def _stream(sock: socket.socket) -> io.BufferedReader:
    sock.settimeout(PATIENCE_S)
    return sock.makefile("rb")


def _read(stream: io.BufferedReader) -> bytes:
    message = parse_length_prefixed(QUIET.envelope, stream)  # type: ignore[arg-type]
    assert message is not None
    return message.SerializeToString()


@pytest.mark.parametrize("listens", [True, False])
def test_a_board_behind_tcp(listens: bool) -> None:
    """Whoever listens, both directions work, and a new connection follows one that is closed, or replaces it."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(PATIENCE_S)
        address = server.getsockname()
        if listens:
            server.close()
        with Rig(_on_line(f"tcp:127.0.0.1:{address[1]}" + "?listen" * listens)) as rig:

            def connected() -> socket.socket:
                return _connect(address) if listens else server.accept()[0]

            with connected() as first:
                _is_connected(rig)
                first.sendall(delimited(_IMU))
                _arrives(rig, "imu_data", 1)
                assert rig.publish("drive_motor") == _read(_stream(first))
                if not listens:
                    first.close()
                with connected() as second:
                    second.sendall(delimited(_IMU))
                    _arrives(rig, "imu_data", 2)
                    _is_connected(rig)
                    assert rig.publish("drive_motor") == _read(_stream(second))
            assert rig.bridge.account.dropped == {}


@pytest.mark.slow
def test_a_client_that_leaves_is_counted_once(free_port: int) -> None:
    """That nobody follows it is another reason, and no other event."""
    nobody = f"nobody has connected to TCP port {free_port}"
    with Rig(_on_line(f"tcp:127.0.0.1:{free_port}?listen")) as rig:
        events = rig.bridge.account.link_events
        wait_until(lambda: _state(rig).fault == nobody, "a bridge that waits")
        with _connect(("127.0.0.1", free_port)):
            _is_connected(rig)
        wait_until(lambda: _state(rig).fault == nobody, "a bridge that waits again")
        assert events == {("hardware", "", "connected"): 1, ("hardware", "", "disconnected"): 2}


def test_a_connection_to_itself_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """The kernel may connect a socket to its own port, if it is one of those for outgoing connections."""
    with socket.create_server(("127.0.0.1", 0)) as free:  # nobody may hold it: a client binds to it
        port = free.getsockname()[1]
    own = partial(socket.create_connection, source_address=("127.0.0.1", port))
    monkeypatch.setattr(socket, "create_connection", own)
    with pytest.raises(ConnectionRefusedError, match="Connection refused"):
        transport_at(f"tcp:127.0.0.1:{port}").connect()


def _connect(address: tuple[str, int]) -> socket.socket:
    def attempt() -> socket.socket | None:
        with contextlib.suppress(ConnectionRefusedError):  # the bridge listens in a moment
            return socket.create_connection(address)
        return None

    return wait_until(attempt, "a bridge that listens")


@pytest.mark.slow
def test_behind_a_connection_that_hangs_commands_get_lost_and_not_late() -> None:
    """Commands that waited too long are counted, the connection is given up, and the next one begins with new ones."""
    with socket.socket() as server:
        server.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)
        server.bind(("127.0.0.1", 0))
        server.listen()
        server.settimeout(PATIENCE_S)
        with Rig(_on_line(f"tcp:127.0.0.1:{server.getsockname()[1]}")) as rig:
            hanging, _ = server.accept()
            _is_connected(rig)
            command, numbers = rig.registry.by_name["drive_motor"].payload_type, itertools.count(1.0)

            def publish() -> bool:
                rig.publish("drive_motor", command(distance_to_go=next(numbers)))
                return "not_connected" in {reason for _, _, reason in rig.bridge.account.undelivered}

            wait_until(publish, "a connection that is given up")
            working, _ = server.accept()
            _is_connected(rig)
            last = next(numbers)
            rig.publish("drive_motor", command(distance_to_go=last))
            stream, got = _stream(working), list[float]()
            while not got or got[-1] != last:
                got.append(QUIET.envelope.FromString(_read(stream)).drive_motor.distance_to_go)
            account = rig.bridge.account
            assert got == sorted(got)
            assert account.sent["drive_motor"] > len(got) + account.undelivered.total()
            hanging.close()
            working.close()


# --- programs at the other end ----------------------------------------------------------------------------------


@pytest.mark.slow
def test_both_clients_speak_over_a_line(free_port: int) -> None:
    """They send and receive payloads as over UDP; a client without a connection says so when it sends."""
    imu, command = (QUIET.by_name[name].payload_type for name in ("imu_info", "drive_motor"))
    line = f"tcp:127.0.0.1:{free_port}"
    lonely = BlockingPeer.open("hardware", registry=QUIET, host=line)
    with lonely, pytest.raises(OSError, match="Connection refused"):
        lonely.send(imu())

    async def speak(rig: Rig) -> None:
        async with Peer.open("hardware", registry=QUIET, host=line) as peer:
            peer.send(imu(accel_z=2))
            await asyncio.to_thread(_arrives, rig, "imu_data", 2)
            await asyncio.to_thread(_is_connected, rig)
            rig.publish("drive_motor", command(distance_to_go=2))
            assert (await peer.receive(command)).distance_to_go == 2

    with Rig(_on_line(f"{line}?listen")) as rig:
        with BlockingPeer.open("hardware", registry=QUIET, host=line) as peer:
            peer.send(imu(accel_z=1))
            _arrives(rig, "imu_data", 1)
            _is_connected(rig)
            rig.publish("drive_motor", command(distance_to_go=1))
            assert peer.receive(command, PATIENCE_S).distance_to_go == 1
            assert peer.remote == line
        asyncio.run(speak(rig))


@pytest.mark.slow
def test_a_board_that_hangs_gets_nothing_old(plugged: Cable) -> None:
    """A line that takes nothing for a second is gone; what the kernel held for the board does not come later."""
    told, arrived, reader = list[str](), list[bytes](), FrameReader(1000)

    def has_new() -> bool:
        arrived.extend(reader.take(plugged.read(65_536)))
        return b"new" in arrived

    with listener() as program:
        carrier = Carrier(transport_at(f"serial:{plugged.path}"), program, told.append)
        carrier.start()
        carrier.wait(PATIENCE_S)
        for _ in range(200):
            program.sendto(b"old" * 200, carrier.address)
        wait_until(lambda: any(told), "a line that is gone")
        carrier.wait(PATIENCE_S)
        program.sendto(b"new", carrier.address)
        wait_until(has_new, "what is new")
        carrier.close()
    assert len(arrived) <= 1 + 4096 // 600  # the end of the board in a pseudo-terminal holds 4096 bytes


@pytest.mark.slow
def test_a_flood_of_the_program_gets_what_the_line_carries(plugged: Cable, monkeypatch: pytest.MonkeyPatch) -> None:
    """A line of 1 Mbaud: what waits too long is counted and not sent, the others keep their order, and none is lost."""
    monkeypatch.setattr(serial, "_HANGS_S", PATIENCE_S)  # the thread of the board may wait for a processor
    arrived, ended, reader = list[bytes](), threading.Event(), FrameReader(1000)

    def read_at_1_mbaud() -> None:
        while not ended.wait(0.005):
            arrived.extend(reader.take(plugged.read(500)))

    with listener() as program:
        carrier = Carrier(transport_at(f"serial:{plugged.path}?baud=1000000"), program)
        carrier.start()
        carrier.wait(PATIENCE_S)
        threading.Thread(target=read_at_1_mbaud).start()
        for number in range(3000):
            program.sendto(number.to_bytes(2, "big") * 200, carrier.address)
        wait_until(lambda: len(arrived) + carrier.undelivered.total() == 3000, "all of them")
        carrier.close()
        ended.set()
    assert arrived == sorted(arrived)
    assert carrier.undelivered["stale"] > 0
    assert carrier.undelivered.keys() <= {"stale", "overflow"}
    assert reader.refused == 0
