"""Reader that uses Linux's recvmmsg(2), which reads many datagrams with one system call.

`socket.recv` needs one call for each datagram and releases the interpreter lock each time. Under load this means a
thread switch for each datagram. A call through `ctypes.PyDLL` keeps the lock. The call never blocks, because of
``MSG_DONTWAIT``.

The structures follow recvmmsg(2) and recvmsg(2).
"""

from __future__ import annotations

import ctypes
import errno
import os
import socket
import sys
from typing import Any

from roverlink.runtime.net import hosts
from roverlink.runtime.net.hosts import Sender

AVAILABLE = sys.platform == "linux"


# ctypes lays out these structures as C does, with the padding of the platform. iovec and msghdr are in recvmsg(2),
# mmsghdr in recvmmsg(2).
class _Iovec(ctypes.Structure):
    _fields_ = [("base", ctypes.c_void_p), ("length", ctypes.c_size_t)]


class _Msghdr(ctypes.Structure):
    _fields_ = [
        ("name", ctypes.c_void_p),
        ("namelen", ctypes.c_uint32),
        ("iov", ctypes.POINTER(_Iovec)),
        ("iovlen", ctypes.c_size_t),
        ("control", ctypes.c_void_p),
        ("controllen", ctypes.c_size_t),
        ("flags", ctypes.c_int),
    ]


class _Mmsghdr(ctypes.Structure):
    _fields_ = [("header", _Msghdr), ("length", ctypes.c_uint)]


class BatchReader:
    """Reads the datagrams that have arrived at a UDP socket, at most ``slots`` at a time.

    The kernel cuts a datagram longer than ``size`` bytes. Set ``size`` to one byte more than the longest allowed
    datagram: then a datagram that is read with ``size`` bytes was too long.
    """

    def __init__(self, sock: socket.socket, size: int, slots: int) -> None:
        self._descriptor = sock.fileno()
        self._size, self._slots = size, slots
        self._buffer: Any = (ctypes.c_char * (size * slots))()  # Any: the stubs do not know that slices of it are bytes
        self._iovecs = (_Iovec * slots)()
        self._headers = (_Mmsghdr * slots)()
        start = ctypes.addressof(self._buffer)
        for slot in range(slots):
            # Set once: the kernel reads the iovecs, and writes only the buffer and the length of each header.
            self._iovecs[slot] = _Iovec(start + slot * size, size)
            self._headers[slot].header.iov = ctypes.pointer(self._iovecs[slot])
            self._headers[slot].header.iovlen = 1
        self._lengths = self._length_column()
        # PyDLL(None) is dlopen(NULL): the program itself, with the C library in it. use_errno keeps a copy of errno,
        # which other Python code could change before it is read.
        self._recvmmsg = ctypes.PyDLL(None, use_errno=True).recvmmsg

    def _length_column(self) -> memoryview:
        """Return a view of the datagram length in every header; it is faster to read than the headers' attributes."""
        words = memoryview(self._headers).cast("B").cast("I")
        stride = ctypes.sizeof(_Mmsghdr) // words.itemsize
        return words[_Mmsghdr.length.offset // words.itemsize :: stride]

    def _receive(self) -> int:
        """Read datagrams into the buffer and return how many were read."""
        count: int = self._recvmmsg(self._descriptor, self._headers, self._slots, socket.MSG_DONTWAIT, None)
        if count >= 0:
            return count
        code = ctypes.get_errno()
        # Nothing has arrived, or a signal came first: both mean that there is nothing to read now.
        if code in (errno.EAGAIN, errno.EINTR):
            return 0
        raise OSError(code, os.strerror(code))

    def read(self) -> list[bytes]:
        """Return the datagrams that have arrived, oldest first; an empty list if none has arrived.

        Never blocks. Raises `OSError` in the same cases as `socket.socket.recv`.
        """
        count = self._receive()
        buffer, size = self._buffer, self._size
        return [
            buffer[start : start + length] for start, length in zip(range(0, count * size, size), self._lengths[:count])
        ]


_MAPPED = bytes(10) + b"\xff\xff"  # an IPv4 address as IPv6 begins with this (RFC 4291, section 2.5.5.2)


class SourceReader(BatchReader):
    """Reads datagrams together with the addresses of their senders."""

    def __init__(self, sock: socket.socket, size: int, slots: int) -> None:
        super().__init__(sock, size, slots)
        self._length = hosts.SOCKADDR[socket.AddressFamily(sock.family)]
        self._names: Any = (ctypes.c_char * (self._length * slots))()
        start = ctypes.addressof(self._names)
        for slot in range(slots):
            self._headers[slot].header.name = start + slot * self._length
            # msg_namelen is a value-result argument (recvmsg(2)). For a socket of one family the result is always the
            # same, so it stays right.
            self._headers[slot].header.namelen = self._length

    def read_with_sources(self) -> list[tuple[bytes, bytes]]:
        """Return the same datagrams as `read`, each with the IP address of its sender.

        An IPv4 address has four bytes, and an IPv6 address sixteen.
        """
        datagrams = self.read()
        names, length = self._names, self._length
        if length != hosts.SOCKADDR[socket.AF_INET]:
            starts = range(8, len(datagrams) * length, length)
            return [(datagram, _unmapped(names[start : start + 16])) for datagram, start in zip(datagrams, starts)]
        starts = range(4, len(datagrams) * length, length)
        return [(datagram, names[start : start + 4]) for datagram, start in zip(datagrams, starts)]

    def read_with_senders(self) -> list[tuple[bytes, Sender]]:
        """Return the same datagrams as `read`, each with its sender's address and port."""
        datagrams = self.read()
        names, length = self._names, self._length
        starts = range(0, len(datagrams) * length, length)
        return [
            (datagram, hosts.sender_of(names[start : start + length])) for datagram, start in zip(datagrams, starts)
        ]


def _unmapped(ip: bytes) -> bytes:
    return ip[12:] if ip.startswith(_MAPPED) else ip
