"""Where the bridge sends: boards, several hosts, names, learned addresses, multicast groups, and IPv6."""

from __future__ import annotations

import contextlib
import dataclasses
import logging
import socket
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from google.protobuf.message import DecodeError
from needs import needs_linux
from polling import PATIENCE_S, wait_until
from tables import changed, unguarded

from generated.registry import REGISTRY
from roverlink.runtime import Bridge, Qos, Registry, SetupError
from roverlink.runtime.bridge.bridge import Handle, Send
from roverlink.runtime.bridge.ends import LinkState
from roverlink.runtime.core import cdr
from roverlink.runtime.core.registry import End, EndName
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.net import host_watch, hosts
from roverlink.runtime.ros_arguments import parameters
from roverlink.runtime.ros_arguments.live_parameters import LiveParameters
from roverlink.runtime.text.host_names import LEARN

_LOGGER = logging.getLogger("test_ends")
_QUIET = unguarded(REGISTRY)
_ARM, _DRIVING = EndName("hardware", "ArmBoard"), EndName("hardware", "DrivingBoard")
_HARDWARE, _BASE = EndName("hardware"), EndName("basestation")


def _end(name: str, host: str, port: int = 9, **more: Any) -> dict[str, Any]:
    return {"host": host, "host_parameter": f"{name}_host", "port_parameter": f"{name}_port", "port": port, **more}


def _registry(of_hardware: dict[str, Any] | None = None, of_base: dict[str, Any] | None = None) -> Registry:
    """The sample's registry, whose peers have further settings."""
    changes = {"hardware": of_hardware or {}, "basestation": of_base or {}}
    peers = tuple(dataclasses.replace(peer, **changes[peer.name]) for peer in _QUIET.peers)
    return dataclasses.replace(_QUIET, peers=peers)


def _with_boards(**hosts_of: str) -> Registry:
    boards = tuple(End(name, **_end(name.lower(), host)) for name, host in hosts_of.items())
    return _registry({"boards": boards, "port_parameter": ""})


def _listener(host: str = "127.0.0.1", port: int = 0) -> socket.socket:
    sock = socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET, socket.SOCK_DGRAM)
    sock.bind((host, port))
    sock.settimeout(PATIENCE_S)
    return sock


def _port(sock: socket.socket) -> int:
    return int(sock.getsockname()[1])


def _envelope(**payloads: Any) -> bytes:
    return bytes(REGISTRY.envelope(**payloads).SerializeToString())


class _Handled:
    """Counts the datagrams that the bridge has published, forwarded and learned from, or dropped."""

    count = 0

    def receiving(self, handle: Handle) -> Handle:
        """Count a batch after the bridge has handled it."""

        def counted(batch: list[bytes]) -> None:
            handle(batch)
            self.count += len(batch)

        return counted

    def sending(self, peer: str, send: Send) -> Send:  # of the interface
        """Change nothing."""
        return send


class _Rig:
    """A bridge between sockets of the test and topics in memory."""

    def __init__(self, registry: Registry, listen_address: str = "127.0.0.1", **given: Any) -> None:
        values = {"listen_port": 0, "listen_address": listen_address, "dst_a_port": 9, **given}
        values = {name: value for name, value in values.items() if name in parameters.declarations(registry)}
        settings = parameters.read(registry, values)
        graph = Graph()
        self._handled = _Handled()
        memory = MemoryMiddleware(graph)
        self.bridge = Bridge(registry, settings, memory, lambda topic: f"/{topic}", _LOGGER, [self._handled])
        self.live = LiveParameters(registry, settings, _LOGGER)
        self.live.on_change(self.bridge.change)
        self.account = self.bridge.account
        self._registry, self._node = registry, MemoryMiddleware(graph)

    def __enter__(self) -> _Rig:
        self.bridge.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self.bridge.stop()
        self.bridge.__exit__(None, None, None)
        assert self.account.discrepancies() == []

    def publish(self, row: str) -> bytes:
        """Publish an empty message of a row to a peer, and return the datagram that carries it."""
        handler = self._registry.by_name[row]
        publisher = self._node.publisher(f"/{handler.route.topic}", handler.message_type, Qos())
        publisher.publish([cdr.encode(handler.message_type())])
        return _envelope(**{row: handler.payload_type()})

    def receive(self, sock: socket.socket, *datagrams: bytes, to: str = "127.0.0.1") -> None:
        """Send datagrams to the bridge, and wait until it has handled them."""
        before = self.account.received
        for datagram in datagrams:
            sock.sendto(datagram, (to, self.bridge.port))
        wait_until(lambda: self.account.received >= before + len(datagrams), "the datagrams")
        wait_until(self._is_settled, "a bridge without work")

    def _is_settled(self) -> bool:
        # A datagram of an unknown source is dropped before any observer sees it.
        return self._handled.count + self.account.dropped["unknown_source"] == self.account.received

    def state(self, end: EndName) -> LinkState:
        """The addresses of an end, with their state."""
        return self.bridge.link_states()[end]


@pytest.fixture
def sock() -> Iterator[socket.socket]:
    """A socket of a peer."""
    with _listener() as sock:
        yield sock


@pytest.fixture
def other() -> Iterator[socket.socket]:
    """A socket of another peer, or of the same peer later."""
    with _listener() as sock:
        yield sock


class _Names:
    """A resolver of the test: the names that it knows, and how often it was asked."""

    def __init__(self) -> None:
        self.known: dict[str, str] = {}
        self.asked = 0
        self.blocks = threading.Event()
        self.blocks.set()

    def look_up(self, host: str, port: int) -> list[Any]:
        """Look up a name in what is known; an address is itself."""
        self.asked += 1
        if host[0].isalpha():
            self.blocks.wait(PATIENCE_S)
            if host not in self.known:
                raise socket.gaierror(socket.EAI_NONAME, "Name or service not known")
            host = self.known[host]
        return [(host, port)]


@pytest.fixture
def names(monkeypatch: pytest.MonkeyPatch) -> _Names:
    """The resolver in place of the system's, which is asked again after a moment."""
    names = _Names()
    monkeypatch.setattr(hosts, "look_up", names.look_up)
    for interval in ("_FOUND_S", "_MISSING_S", "_AGAIN_S", "_LOOK_S"):
        monkeypatch.setattr(host_watch, interval, 0.01)
    return names


def test_a_row_goes_to_its_board_and_no_other() -> None:
    """Boards have one port and addresses of their own."""
    with _listener("127.0.0.21") as arm, _listener("127.0.0.22", _port(arm)) as driving:
        given = {"armboard_port": _port(arm), "drivingboard_port": _port(arm)}
        with _Rig(_with_boards(ArmBoard="127.0.0.21", DrivingBoard="127.0.0.22"), **given) as rig:
            command, drive = rig.publish("arm_ctrl"), rig.publish("drive_motor")
            assert (arm.recv(2000), driving.recv(2000)) == (command, drive)
            for board in (arm, driving):
                board.setblocking(False)
                with pytest.raises(BlockingIOError):
                    board.recv(2000)


def test_all_hosts_of_a_peer_get_every_datagram(sock: socket.socket) -> None:
    """Two laptops listen to the same rows, and a datagram for both counts once."""
    with _listener("127.0.0.5", _port(sock)) as second:
        registry = _registry(of_base=_end("base", "127.0.0.1,127.0.0.5", _port(sock)))
        with _Rig(registry) as rig:
            datagram = _envelope(imu_info={"accel_x": 1.0})
            rig.receive(second, datagram)
            assert sock.recv(2000) == second.recv(2000) == datagram
            assert rig.account.forwarded == {"basestation": 1}


# --- names ------------------------------------------------------------------------------------------------------


def test_a_name_that_appears_later_is_found(
    names: _Names, sock: socket.socket, caplog: pytest.LogCaptureFixture
) -> None:
    """Until then nothing is sent and everything counted; both events are logged once."""
    caplog.set_level("INFO")
    with _Rig(_registry(_end("hw", "arm.local", _port(sock)))) as rig:
        wait_until(lambda: names.asked > 5, "several look-ups")
        rig.publish("drive_motor")
        assert rig.account.unsent == {"hardware": 1}
        assert rig.state(_HARDWARE) == LinkState((), "not_resolved")
        names.known["arm.local"] = "127.0.0.1"
        wait_until(lambda: rig.state(_HARDWARE).state == "ok", "the name")
        datagram = rig.publish("drive_motor")
        assert sock.recv(2000) == datagram
    events = {event: count for (_, _, event), count in rig.account.link_events.items()}
    assert events == {"not_resolved": 1, "resolved": 1}
    assert [record.message for record in caplog.records if "arm.local" in record.message] == [
        "hardware: arm.local cannot be resolved: Name or service not known",
        f"hardware: arm.local is 127.0.0.1:{_port(sock)}",
    ]


def test_a_name_with_another_address_is_followed(
    names: _Names, sock: socket.socket, caplog: pytest.LogCaptureFixture
) -> None:
    """A board that got another address is found without a restart; if its name disappears, the address stays."""
    names.known["arm.local"] = "127.0.0.1"
    with _listener("127.0.0.9", _port(sock)) as moved, _Rig(_registry(_end("hw", "arm.local", _port(sock)))) as rig:
        wait_until(lambda: rig.state(_HARDWARE).state == "ok", "the name")
        datagram = rig.publish("drive_motor")
        assert sock.recv(2000) == datagram
        names.known["arm.local"] = "127.0.0.9"
        wait_until(lambda: rig.state(_HARDWARE).addresses == (f"127.0.0.9:{_port(sock)}",), "the new address")
        rig.publish("drive_motor")
        assert moved.recv(2000) == datagram
        del names.known["arm.local"]
        wait_until(lambda: rig.state(_HARDWARE).state == "not_resolved", "the end of the name")
        rig.publish("drive_motor")
        assert moved.recv(2000) == datagram
    assert rig.account.link_events["hardware", "", "address_changed"] == 1
    port = _port(sock)
    assert f"the address is now 127.0.0.9:{port} (it was 127.0.0.1:{port})" in caplog.text


def test_a_look_up_that_blocks_delays_nothing_else(names: _Names, sock: socket.socket) -> None:
    """Neither the start nor the stop of the bridge, nor the datagrams of others."""
    names.blocks.clear()
    registry = _registry(_end("hw", "slow.local"), _end("base", "127.0.0.1", _port(sock)))
    started = time.monotonic()
    with _Rig(registry) as rig:
        rig.receive(sock, _envelope(imu_info={}))
        assert sock.recv(2000) == _envelope(imu_info={})
    assert time.monotonic() - started < PATIENCE_S / 2
    names.blocks.set()


def test_the_name_of_this_computer_needs_no_fake(sock: socket.socket) -> None:
    """`localhost` is IPv4 for a bridge that listens on IPv4, whatever the resolver prefers."""
    with _Rig(_registry(_end("hw", "localhost", _port(sock)))) as rig:
        wait_until(lambda: rig.state(_HARDWARE) == LinkState((f"127.0.0.1:{_port(sock)}",), "ok"), "localhost")


# --- learned addresses ------------------------------------------------------------------------------------------


def test_an_address_is_learned_from_valid_datagrams(
    sock: socket.socket, other: socket.socket, caplog: pytest.LogCaptureFixture
) -> None:
    """What is malformed, of another peer, or of the wrong direction teaches nothing."""
    caplog.set_level("INFO")
    with _Rig(_registry(_end("hw", LEARN, 0))) as rig:
        rig.publish("drive_motor")
        assert rig.account.unsent == {"hardware": 1}
        assert rig.state(_HARDWARE) == LinkState((), "not_learned")
        rig.receive(other, b"rubbish", _envelope(control_mode={}), _envelope(drive_motor={}), b"")
        assert rig.state(_HARDWARE).state == "not_learned"
        rig.receive(sock, _envelope(imu_info={}))
        rig.receive(other, _envelope(control_mode={}))
        datagram = rig.publish("drive_motor")
        assert sock.recv(2000) == datagram
        rig.receive(other, _envelope(gps_info={}))
        rig.publish("drive_motor")
        assert other.recv(2000) == datagram
    assert rig.account.link_events == {("hardware", "", "learned"): 1, ("hardware", "", "address_changed"): 1}
    assert caplog.text.count("learned the address") == 1


def test_boards_are_learned_each_for_itself(sock: socket.socket, other: socket.socket) -> None:
    """A datagram of one board tells nothing about the others."""
    boards = tuple(End(name, **_end(name.lower(), LEARN, 0)) for name in ("ArmBoard", "DrivingBoard"))
    with _Rig(_registry({"boards": boards})) as rig:
        rig.receive(sock, _envelope(arm_feedback={}))
        assert (rig.state(_ARM).state, rig.state(_DRIVING).state) == ("ok", "not_learned")
        rig.receive(other, _envelope(drive_diag={}))
        command, drive = rig.publish("arm_ctrl"), rig.publish("drive_motor")
        assert (sock.recv(2000), other.recv(2000)) == (command, drive)


def test_a_port_of_the_table_is_not_learned(sock: socket.socket, other: socket.socket) -> None:
    """A board that sends from any port listens on the port that the table names."""
    with _Rig(_registry(_end("hw", LEARN, _port(other)))) as rig:
        rig.receive(sock, _envelope(imu_info={}))
        datagram = rig.publish("drive_motor")
        assert other.recv(2000) == datagram


def test_only_sources_can_be_learned(sock: socket.socket) -> None:
    """A stranger's datagram is dropped, so it cannot take the commands to itself."""
    strangers = _registry({**_end("hw", LEARN, 0), "sources": ("127.0.0.2",)}, {"sources": ("127.0.0.0/8",)})
    with _listener("127.0.0.2") as own, _Rig(strangers) as rig:
        rig.receive(sock, _envelope(imu_info={}))
        assert rig.account.dropped == {"wrong_source": 1}
        assert rig.state(_HARDWARE).state == "not_learned"
        rig.receive(own, _envelope(imu_info={}))
        datagram = rig.publish("drive_motor")
        assert own.recv(2000) == datagram


# --- IPv6 and multicast -----------------------------------------------------------------------------------------


def _has_ipv6() -> bool:
    try:
        with _listener("::1"):
            return True
    except OSError:
        return False


needs_ipv6 = pytest.mark.skipif(not _has_ipv6(), reason="needs IPv6")


@needs_ipv6
@pytest.mark.parametrize("host", ["::1", LEARN])
def test_a_peer_with_ipv6(host: str) -> None:
    """A bridge on `::` hears it, and sends to its address, learned or not."""
    with _listener("::1") as peer, _Rig(_registry(_end("hw", host, _port(peer))), listen_address="::") as rig:
        rig.receive(peer, _envelope(imu_info={}), to="::1")
        assert rig.state(_HARDWARE) == LinkState((f"[::1]:{_port(peer)}",), "ok")
        datagram = rig.publish("drive_motor")
        assert peer.recv(2000) == datagram


@needs_ipv6
def test_a_bridge_on_ipv6_knows_ipv4_by_its_address(sock: socket.socket) -> None:
    """What the kernel shows as `::ffff:127.0.0.1` is 127.0.0.1: for sources, and for a learned address."""
    registry = _registry({**_end("hw", LEARN, 0), "sources": ("127.0.0.1",)}, {"sources": ("fd00::/64",)})
    with _listener("::1") as stranger, _Rig(registry, listen_address="::") as rig:
        rig.receive(stranger, _envelope(imu_info={}), to="::1")
        assert rig.account.dropped == {"unknown_source": 1}
        rig.receive(sock, _envelope(imu_info={}))
        assert rig.state(_HARDWARE) == LinkState((f"127.0.0.1:{_port(sock)}",), "ok")


@needs_ipv6
@pytest.mark.parametrize("sources", [("::1", "127.0.0.1"), ("::/0", "127.0.0.0/8")])
def test_sources_of_both_families(sock: socket.socket, sources: tuple[str, ...]) -> None:
    """Without a learned address too, each datagram comes with its sender's address."""
    registry = _registry({"sources": sources}, {"sources": ("10.0.0.1",)})
    with _listener("::1") as sixth, _Rig(registry, listen_address="::") as rig:
        rig.receive(sixth, _envelope(imu_info={}), to="::1")
        rig.receive(sock, _envelope(imu_info={}))
        assert rig.account.published == {"imu_info": 2}


@needs_ipv6
def test_a_peer_that_cannot_be_heard_is_a_warning(caplog: pytest.LogCaptureFixture) -> None:
    """A bridge that listens only on IPv4 sends to an IPv6 address, and tells what to do."""
    with _listener("::1") as peer, _Rig(_registry(_end("hw", "::1", _port(peer)))) as rig:
        datagram = rig.publish("drive_motor")
        assert peer.recv(2000) == datagram
    assert "cannot hear it; start the bridge with -p listen_address:=\"'::'\"" in caplog.text


def _interfaces_with_ipv6() -> list[str]:
    """The network interfaces that have an IPv6 address; the loopback interface has no route to IPv6 groups."""
    table = Path("/proc/net/if_inet6")
    names = {line.split()[-1] for line in table.read_text().splitlines()} if table.is_file() else set()
    return sorted(names - {"lo"})


def _member(group: str, interface: str) -> socket.socket:
    """A listener that has joined a group on an interface."""
    member, index = _listener(group), socket.if_nametoindex(interface).to_bytes(4, sys.byteorder)
    if ":" in group:
        joining = socket.inet_pton(socket.AF_INET6, group) + index
        member.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_JOIN_GROUP, joining)
    else:
        member.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(group) + bytes(4) + index)
    return member


@needs_linux
@pytest.mark.parametrize(("group", "interfaces"), [("239.7.7.7", ["lo"]), ("ff15::77", _interfaces_with_ipv6())])
def test_a_multicast_group(group: str, interfaces: list[str]) -> None:
    """Everyone who has joined the group on that interface gets the datagrams."""
    if not interfaces:
        pytest.skip("needs a network interface with IPv6")
    settings = {"interface": interfaces[0], "ttl": 1}
    with _member(group, interfaces[0]) as member, _Rig(_registry(_end("hw", group, _port(member), **settings))) as rig:
        wait_until(lambda: rig.state(_HARDWARE).state == "ok", "the interface")
        datagram = rig.publish("drive_motor")
        assert member.recv(2000) == datagram


@needs_linux
def test_an_interface_that_does_not_exist_is_a_warning(caplog: pytest.LogCaptureFixture) -> None:
    """It may come with the radio that is plugged in later; until then nothing leaves by another interface."""
    with _Rig(_registry(_end("hw", "239.7.7.7", interface="radio7"))) as rig:
        wait_until(lambda: rig.account.link_events.total(), "the warning")
        rig.publish("drive_motor")
        assert rig.account.unsent == {"hardware": 1}
    assert "hardware: 239.7.7.7 cannot be resolved" in caplog.text


# --- forwarding -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("change", [lambda plain: plain + bytes(7), lambda plain: plain.rstrip(b"\0")])
def test_what_is_forwarded_parses_strictly(sock: socket.socket, change: Any) -> None:
    """A decoder that refuses tag 0 and cut fields gets the envelope as protobuf writes it, and nothing malformed."""
    plain = _envelope(imu_info={"accel_x": 1.0}) + _envelope(gps_info={})
    assert plain.endswith(b"\0")
    with pytest.raises(DecodeError):
        REGISTRY.envelope.FromString(change(plain))
    with _Rig(_registry(of_base=_end("base", "127.0.0.1", _port(sock)))) as rig:
        rig.receive(sock, b"\x07rubbish", change(plain), _envelope(drive_motor={}))
        assert sock.recv(2000) == plain
        assert rig.account.forwarded == {"basestation": 1}
        rig.live.change({"forward_policy": "all"})
        rig.receive(sock, b"\x07rubbish")
        assert sock.recv(2000) == b"\x07rubbish"


def test_the_receiving_peers_limit_holds(sock: socket.socket, caplog: pytest.LogCaptureFixture) -> None:
    """An envelope that is longer than the peer's `max_size` is counted and told; its padding does not count."""
    short, long = _envelope(imu_info={"accel_x": 1.0}), _envelope(imu_info={"accel_x": 1.0, "accel_y": 2.0})
    registry = _registry(of_base={**_end("base", "127.0.0.1", _port(sock)), "max_size": len(short)})
    with _Rig(registry) as rig:
        rig.receive(sock, long, short + bytes(50))
        assert sock.recv(2000) == short
        assert (rig.account.forwarded, rig.account.unforwarded) == ({"basestation": 1}, {"basestation": 1})
    assert f"a datagram of {len(long)} bytes, but the peer's max_size is {len(short)}" in caplog.text


def test_a_forward_reaches_all_boards_of_a_peer() -> None:
    """A peer with boards listens at each of them."""
    with _listener("127.0.0.21") as arm, _listener("127.0.0.22", _port(arm)) as driving:
        registry = changed(
            _with_boards(ArmBoard="127.0.0.21", DrivingBoard="127.0.0.22"), "control_mode", forward=("hardware",)
        )
        with _Rig(registry, armboard_port=_port(arm), drivingboard_port=_port(arm)) as rig:
            rig.receive(arm, _envelope(control_mode={}))
            assert arm.recv(2000) == driving.recv(2000) == _envelope(control_mode={})


# --- parameters -------------------------------------------------------------------------------------------------


def test_hosts_change_while_the_bridge_runs(sock: socket.socket, other: socket.socket) -> None:
    """A new host, another port, `learn`, and back: each from the next datagram on."""
    with _Rig(_registry(_end("hw", "127.0.0.1", _port(sock)))) as rig:
        datagram = rig.publish("drive_motor")
        assert sock.recv(2000) == datagram
        rig.live.change({"hw_port": _port(other)})
        rig.publish("drive_motor")
        assert other.recv(2000) == datagram
        rig.live.change({"hw_host": LEARN, "hw_port": 0})
        assert rig.state(_HARDWARE).state == "not_learned"
        rig.receive(sock, _envelope(imu_info={}))
        rig.publish("drive_motor")
        assert sock.recv(2000) == datagram
        rig.live.change({"hw_host": "127.0.0.1,127.0.0.2", "hw_port": _port(other)})
        rig.publish("drive_motor")
        assert other.recv(2000) == datagram


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"hw_host": "no host"}, "'hw_host' is 'no host'; 'no host' is neither an IP address nor the name of a host"),
        ({"hw_host": "127.0.0.1,"}, "'' is neither an IP address"),
        ({"hw_host": "10.0.0.1, learn"}, "'learn' cannot stand beside other hosts"),
        ({"hw_host": "256.1.1.1"}, "'256.1.1.1' is neither"),
        ({"hw_host": 7}, "'hw_host' is 7; it must be of type str"),
        ({"hw_port": 0}, "the parameter 'hw_port' is 0, but 'hw_host' is not 'learn'; set the UDP port of hardware"),
        ({"hw_port": 70_000}, "a UDP port is a number from 1 to 65535"),
    ],
)
def test_wrong_hosts_change_nothing(changes: dict[str, Any], reason: str) -> None:
    """Beside a right change, none of them is applied."""
    with _Rig(_registry(_end("hw", "127.0.0.1"))) as rig:
        before = dict(rig.live.values)
        with pytest.raises(SetupError, match=reason):
            rig.live.change({"forward_policy": "all", **changes})
        assert rig.live.values == before
        assert rig.state(_HARDWARE).addresses == ("127.0.0.1:9",)


# --- the state of the link --------------------------------------------------------------------------------------


def test_an_address_without_a_route_is_told_once(caplog: pytest.LogCaptureFixture) -> None:
    """It is unreachable until a datagram goes out again, however often the bridge tries."""
    caplog.set_level("INFO")

    class _Gone:
        def send(self, *_: object) -> int:
            raise OSError(101, "Network is unreachable")

        sendto = sendmsg = send

    with _Rig(_registry(_end("hw", "127.0.0.1", 9))) as rig:
        (way,) = rig.bridge._ends.destinations[_HARDWARE]._used
        pair = way._pairs[socket.AF_INET]
        way._pairs[socket.AF_INET] = (_Gone(), _Gone())  # type: ignore[assignment]  # sockets that have lost the route
        way._route = _Gone(), None  # type: ignore[assignment]
        for _ in range(3):
            rig.publish("drive_motor")
        assert rig.state(_HARDWARE).state == "unreachable"
        assert rig.account.failed == {"drive_motor": 3}
        way._pairs[socket.AF_INET], way._route = pair, (pair[0], None)
        for _ in range(3):
            rig.publish("drive_motor")
        assert rig.state(_HARDWARE).state == "ok"
        with contextlib.suppress(ConnectionRefusedError):
            pair[0].send(b"")
    assert rig.account.link_events == {("hardware", "", "unreachable"): 1, ("hardware", "", "reachable_again"): 1}
    told = [record.message for record in caplog.records if "127.0.0.1:9" in record.message]
    assert told == [
        "hardware: cannot send to 127.0.0.1:9: Network is unreachable",
        "hardware: 127.0.0.1:9 is reachable again",
    ]
