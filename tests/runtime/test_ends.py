"""Where the bridge sends: boards, several hosts, names, learned addresses, multicast groups, and IPv6."""

from __future__ import annotations

import errno
import socket
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from bridge_rig import QUIET, Rig, changed, end, envelope, listener, of_peers, port_of, waiting
from needs import needs_linux
from polling import PATIENCE_S, wait_until

from roverlink.runtime import Registry
from roverlink.runtime.bridge.ends import LinkState
from roverlink.runtime.core.registry import End, EndName
from roverlink.runtime.net import host_watch, hosts
from roverlink.runtime.text.host_names import LEARN

_ARM, _DRIVING = EndName("hardware", "ArmBoard"), EndName("hardware", "DrivingBoard")
_HARDWARE = EndName("hardware")
_IMU, _MODE = envelope(imu_info={}), envelope(control_mode={})


def _hw(host: str, port: int = 9, **more: Any) -> Registry:
    """The sample's registry, whose hardware has a host of its own."""
    return of_peers(QUIET, hardware=end("hw", host, port, **more))


def _state(rig: Rig, end: EndName = _HARDWARE) -> LinkState:
    return rig.bridge.link_states()[end]


def _is_told(rig: Rig, sock: socket.socket) -> bool:
    """True if a command to the hardware arrives at a socket."""
    return rig.publish("drive_motor") == sock.recv(2000)


@pytest.fixture
def sock() -> Iterator[socket.socket]:
    """A socket of a peer."""
    with listener() as sock:
        yield sock


@pytest.fixture
def other() -> Iterator[socket.socket]:
    """A socket of another peer, or of the same peer later."""
    with listener() as sock:
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


def test_a_row_goes_to_its_board_and_a_forward_to_all_of_them() -> None:
    """Boards have addresses of their own; a command is for one of them."""
    hosts = {"ArmBoard": "127.0.0.21", "DrivingBoard": "127.0.0.22"}
    with listener(hosts["ArmBoard"]) as arm, listener(hosts["DrivingBoard"], port_of(arm)) as driving:
        boards = tuple(End(name, **end(name, host, port_of(arm))) for name, host in hosts.items())
        registry = of_peers(QUIET, hardware={"boards": boards, "port_parameter": ""})
        registry = changed(registry, "control_mode", forward=("hardware",))
        with Rig(registry) as rig:
            command, drive = rig.publish("arm_ctrl"), rig.publish("drive_motor")
            assert (arm.recv(2000), driving.recv(2000)) == (command, drive)
            assert waiting(arm) == waiting(driving) == []
            rig.receive(_MODE)
            assert arm.recv(2000) == driving.recv(2000) == _MODE


# --- names ------------------------------------------------------------------------------------------------------


def test_a_name_that_appears_later_is_found_and_followed(
    names: _Names, sock: socket.socket, caplog: pytest.LogCaptureFixture
) -> None:
    """Without an address nothing is sent and all counted; a name that disappears keeps its last address."""
    caplog.set_level("INFO")
    port = port_of(sock)
    with listener("127.0.0.9", port) as moved, Rig(_hw("arm.local", port)) as rig:
        wait_until(lambda: names.asked > 5, "several look-ups")
        rig.publish("drive_motor")
        assert rig.account.unsent == {"hardware": 1}
        assert _state(rig) == LinkState((), "not_resolved")
        names.known["arm.local"] = "127.0.0.1"
        wait_until(lambda: _state(rig).state == "ok", "the name")
        assert _is_told(rig, sock)
        names.known["arm.local"] = "127.0.0.9"
        wait_until(lambda: _state(rig).addresses == (f"127.0.0.9:{port}",), "the new address")
        assert _is_told(rig, moved)
        events = {event: count for (_, _, event), count in rig.account.link_events.items()}
        assert events == {"not_resolved": 1, "resolved": 1, "address_changed": 1}
        del names.known["arm.local"]
        wait_until(lambda: _state(rig).state == "not_resolved", "the end of the name")
        assert _is_told(rig, moved)
    told = [message for message in caplog.messages if message.startswith("hardware: ")]
    assert told[:2] == [
        "hardware: arm.local cannot be resolved: Name or service not known",
        f"hardware: arm.local is 127.0.0.1:{port}",
    ]
    assert f"the address is now 127.0.0.9:{port} (it was 127.0.0.1:{port})" in told[2]


def test_a_look_up_that_blocks_delays_nothing_else(names: _Names, sock: socket.socket) -> None:
    """Neither the start nor the stop of the bridge, nor the datagrams of others."""
    names.blocks.clear()
    registry = of_peers(_hw("slow.local"), basestation=end("base", "127.0.0.1", port_of(sock)))
    started = time.monotonic()
    with Rig(registry) as rig:
        rig.receive(_IMU)
        assert sock.recv(2000) == _IMU
    assert time.monotonic() - started < PATIENCE_S / 2
    names.blocks.set()


# --- learned addresses ------------------------------------------------------------------------------------------


def test_an_address_is_learned_from_valid_datagrams(
    sock: socket.socket, other: socket.socket, caplog: pytest.LogCaptureFixture
) -> None:
    """What is malformed, of another peer, or of the wrong direction teaches nothing."""
    caplog.set_level("INFO")
    with Rig(_hw(LEARN, 0)) as rig:
        rig.publish("drive_motor")
        assert rig.account.unsent == {"hardware": 1}
        rig.receive(b"rubbish", _MODE, envelope(drive_motor={}), b"", via=other)
        assert _state(rig) == LinkState((), "not_learned")
        rig.receive(_IMU, via=sock)
        rig.receive(_MODE, via=other)
        assert _is_told(rig, sock)
        rig.receive(envelope(gps_info={}), via=other)
        assert _is_told(rig, other)
    assert rig.account.link_events == {("hardware", "", "learned"): 1, ("hardware", "", "address_changed"): 1}
    assert caplog.text.count("learned the address") == 1


def test_a_port_of_the_table_is_not_learned(sock: socket.socket, other: socket.socket) -> None:
    """A board that sends from any port listens on the port that the table names."""
    with Rig(_hw(LEARN, port_of(other))) as rig:
        rig.receive(_IMU, via=sock)
        assert _is_told(rig, other)


# --- IPv6 and multicast -----------------------------------------------------------------------------------------


def _has_ipv6() -> bool:
    try:
        with listener("::1"):
            return True
    except OSError:
        return False


needs_ipv6 = pytest.mark.skipif(not _has_ipv6(), reason="needs IPv6")


@needs_ipv6
@pytest.mark.parametrize("host", ["::1", LEARN])
def test_a_peer_with_ipv6(host: str) -> None:
    """A bridge on `::` hears it, and sends to its address, learned or not."""
    with listener("::1") as peer, Rig(_hw(host, port_of(peer)), listen_address="::") as rig:
        rig.receive(_IMU, via=peer)
        assert _state(rig) == LinkState((f"[::1]:{port_of(peer)}",), "ok")
        assert _is_told(rig, peer)


@needs_ipv6
def test_a_bridge_on_ipv6_knows_ipv4_by_its_address(sock: socket.socket) -> None:
    """What the kernel shows as `::ffff:127.0.0.1` is 127.0.0.1: for sources, and for a learned address."""
    registry = of_peers(_hw(LEARN, 0, sources=("127.0.0.1",)), basestation={"sources": ("fd00::/64",)})
    with listener("::1") as stranger, Rig(registry, listen_address="::") as rig:
        rig.receive(_IMU, via=stranger)
        assert rig.account.dropped == {"unknown_source": 1}
        rig.receive(_IMU, via=sock)
        assert _state(rig) == LinkState((f"127.0.0.1:{port_of(sock)}",), "ok")


@needs_ipv6
@pytest.mark.parametrize("sources", [("::1", "127.0.0.1"), ("::/0", "127.0.0.0/8")])
def test_sources_of_both_families(sources: tuple[str, ...]) -> None:
    """Without a learned address too, each datagram comes with its sender's address."""
    registry = of_peers(QUIET, hardware={"sources": sources}, basestation={"sources": ("10.0.0.1",)})
    with listener("::1") as sixth, Rig(registry, listen_address="::") as rig:
        rig.receive(_IMU, via=sixth)
        rig.receive(_IMU)
        assert rig.account.published == {"imu_info": 2}


@needs_ipv6
def test_a_peer_that_cannot_be_heard_is_a_warning(caplog: pytest.LogCaptureFixture) -> None:
    """A bridge that listens only on IPv4 sends to an IPv6 address, and tells what to do."""
    with listener("::1") as peer, Rig(_hw("::1", port_of(peer))) as rig:
        assert _is_told(rig, peer)
    assert "cannot hear it; start the bridge with -p listen_address:=\"'::'\"" in caplog.text


@needs_linux
@needs_ipv6
@pytest.mark.parametrize("group", ["239.7.7.7", "ff15::77"])
def test_a_multicast_group(group: str) -> None:
    """Everyone who has joined the group on that interface gets the datagrams."""
    interfaces = [line.split()[-1] for line in Path("/proc/net/if_inet6").read_text().splitlines()]
    interface = next((name for name in interfaces if name != "lo"), "") if ":" in group else "lo"
    if not interface:
        pytest.skip("needs a network interface with IPv6")  # the loopback interface has no route to IPv6 groups
    with listener(group) as member:
        index = socket.if_nametoindex(interface).to_bytes(4, sys.byteorder)
        if ":" in group:
            joining = socket.inet_pton(socket.AF_INET6, group) + index
            member.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_JOIN_GROUP, joining)
        else:
            joining = socket.inet_aton(group) + bytes(4) + index
            member.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, joining)
        with Rig(_hw(group, port_of(member), interface=interface, ttl=1)) as rig:
            wait_until(lambda: _state(rig).state == "ok", "the interface")
            assert _is_told(rig, member)


# --- what a datagram may not do ---------------------------------------------------------------------------------


def test_the_receiving_peers_limit_holds(sock: socket.socket, caplog: pytest.LogCaptureFixture) -> None:
    """An envelope that is longer than the peer's `max_size` is counted and told; its padding does not count."""
    short, long = envelope(imu_info={"accel_x": 1.0}), envelope(imu_info={"accel_x": 1.0, "accel_y": 2.0})
    with Rig(of_peers(QUIET, basestation=end("base", "127.0.0.1", port_of(sock), max_size=len(short)))) as rig:
        rig.receive(long, short + bytes(50))
        assert sock.recv(2000) == short
        assert (rig.account.forwarded, rig.account.unforwarded) == ({"basestation": 1}, {"basestation": 1})
    assert f"a datagram of {len(long)} bytes, but the peer's max_size is {len(short)}" in caplog.text


def test_an_address_without_a_route_is_told_once(sock: socket.socket, caplog: pytest.LogCaptureFixture) -> None:
    """It is unreachable until a datagram goes out again, however often the bridge tries."""
    caplog.set_level("INFO")

    def gone(*_: object) -> int:
        raise OSError(errno.ENETUNREACH, "Network is unreachable")

    with Rig(_hw("127.0.0.1", port_of(sock))) as rig:
        with pytest.MonkeyPatch.context() as unplugged:
            for way in ("send", "sendto", "sendmsg"):
                unplugged.setattr(socket.socket, way, gone)
            for _ in range(3):
                rig.publish("drive_motor")
        assert _state(rig).state == "unreachable"
        assert rig.account.failed == {"drive_motor": 3}
        for _ in range(3):
            assert _is_told(rig, sock)
        assert _state(rig).state == "ok"
    assert rig.account.link_events == {("hardware", "", "unreachable"): 1, ("hardware", "", "reachable_again"): 1}
    address = f"127.0.0.1:{port_of(sock)}"
    assert [message for message in caplog.messages if address in message] == [
        f"hardware: cannot send to {address}: Network is unreachable",
        f"hardware: {address} is reachable again",
    ]
