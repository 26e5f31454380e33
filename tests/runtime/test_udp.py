"""Sockets on loopback: reading in batches, stopping, and what is said where the network does not do as it is told."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from types import SimpleNamespace

import pytest

from roverlink.runtime.core.errors import FailedThreadError
from roverlink.runtime.net import udp

_SIZE = 100
_BUFFER = 1024 * 1024


@pytest.fixture
def listener() -> Iterator[socket.socket]:
    """A socket that listens on a free port of the loopback interface."""
    with udp.bind("127.0.0.1", 0, _BUFFER) as sock:
        yield sock


@pytest.fixture
def sender(listener: socket.socket) -> Iterator[socket.socket]:
    """A socket that sends to the listener."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.connect(listener.getsockname())
        yield sock


# --- readers ----------------------------------------------------------------------------------------------------


def test_a_reader_takes_what_has_arrived_in_order(
    listener: socket.socket, sender: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Oldest first, without waiting, no more than the limit at a time; an empty datagram is one, a long one is cut."""
    monkeypatch.setattr(udp, "_SLOTS", 4)
    read = udp.reader(listener, _SIZE)
    assert read() == []
    sent = [bytes([number]) * (number + 1) for number in range(6)]
    sent += [b"", b"a" * (_SIZE - 1), b"b" * _SIZE, b"c" * 5000, b"d"]
    for datagram in sent:
        sender.send(datagram)
    batches = [read() for _ in range(4)]
    assert [len(batch) for batch in batches] == [4, 4, 3, 0]
    assert [datagram for batch in batches for datagram in batch] == [datagram[:_SIZE] for datagram in sent]


def test_a_closed_socket_is_an_error(listener: socket.socket) -> None:
    """A reader does not take a socket that is gone for one that is silent."""
    read = udp.reader(listener, _SIZE)
    listener.close()
    with pytest.raises(OSError, match="Bad file descriptor"):
        read()


# --- the receiver -----------------------------------------------------------------------------------------------


def test_what_the_function_raises_is_raised_by_join(listener: socket.socket, sender: socket.socket) -> None:
    """An error in the thread is not lost with it."""

    def handle(_: list[bytes]) -> None:
        raise ValueError("of the function")

    with udp.Receiver(listener, _SIZE, handle) as receiver:
        sender.send(b"x")
        with pytest.raises(FailedThreadError, match="thread udp-receive failed: ValueError: of the function"):
            receiver.join()


# --- binding ----------------------------------------------------------------------------------------------------


def test_the_receive_buffer_is_as_large_as_it_was_asked_for(listener: socket.socket) -> None:
    """The size is set, and read back in the measure in which it was asked for."""
    assert udp.receive_buffer(listener) <= _BUFFER
    with udp.bind("127.0.0.1", 0, 100_000) as small:
        assert udp.receive_buffer(small) == 100_000


# --- destinations -----------------------------------------------------------------------------------------------


def test_a_name_resolves() -> None:
    """Names and addresses become IPv4 addresses, and IPv6 addresses if there is no other."""
    assert udp.resolve("::1", 6000) == ("::1", 6000)
    assert udp.resolve("127.0.0.1", 6000) == ("127.0.0.1", 6000)
    assert udp.resolve("localhost", 6001) == ("127.0.0.1", 6001)


def test_what_there_is_no_time_for_at_the_end_is_counted(
    listener: socket.socket, sender: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Stopping does not wait for a slow function longer than half a second; what it leaves is not forgotten.

    The clock goes on while the rest is counted, too: a starved computer may need long for it.
    """
    now = 0.0

    def monotonic() -> float:
        nonlocal now
        now += 0.1
        return now

    monkeypatch.setattr(udp, "time", SimpleNamespace(monotonic=monotonic))
    handled: list[bytes] = []

    def handle(batch: list[bytes]) -> None:
        nonlocal now
        handled.extend(batch)
        now += 0.3

    for number in range(200):
        sender.send(b"%d" % number)
    receiver = udp.Receiver(listener, _SIZE, handle)
    receiver.stop()
    with receiver:
        pass
    assert 0 < len(handled) < 200
    assert len(handled) + receiver.left == 200
