"""Linux's recvmmsg(2): many datagrams for one system call.

`socket.recv` costs one call a datagram and gives the interpreter lock away each time, which under load means a thread
switch a datagram. Called through `ctypes.PyDLL` the lock is kept; the call never blocks (``MSG_DONTWAIT``).
"""

from __future__ import annotations

import ctypes
import errno
import os
import socket
import sys
from typing import Any

AVAILABLE = sys.platform == "linux"


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
    """Reads what a UDP socket holds, up to ``slots`` datagrams at a time.

    A datagram longer than ``size`` bytes comes cut to ``size``; give one byte more than the longest that is wanted, and
    a length of ``size`` means too long.
    """

    def __init__(self, sock: socket.socket, size: int, slots: int) -> None:
        self._descriptor = sock.fileno()
        self._size, self._slots = size, slots
        self._buffer: Any = (ctypes.c_char * (size * slots))()  # slices of it are bytes, which its stubs do not say
        self._iovecs = (_Iovec * slots)()
        self._headers = (_Mmsghdr * slots)()
        start = ctypes.addressof(self._buffer)
        for slot in range(slots):
            self._iovecs[slot] = _Iovec(start + slot * size, size)
            self._headers[slot].header.iov = ctypes.pointer(self._iovecs[slot])
            self._headers[slot].header.iovlen = 1
        self._lengths = self._length_column()
        self._recvmmsg = ctypes.PyDLL(None, use_errno=True).recvmmsg

    def _length_column(self) -> memoryview:
        """The ``length`` of each header, as one strided view."""
        words = memoryview(self._headers).cast("B").cast("I")
        stride = ctypes.sizeof(_Mmsghdr) // words.itemsize
        return words[_Mmsghdr.length.offset // words.itemsize :: stride]

    def _receive(self) -> int:
        """How many datagrams were read into the slots."""
        count: int = self._recvmmsg(self._descriptor, self._headers, self._slots, socket.MSG_DONTWAIT, None)
        if count >= 0:
            return count
        code = ctypes.get_errno()
        if code in (errno.EAGAIN, errno.EINTR):
            return 0
        raise OSError(code, os.strerror(code))

    def read(self) -> list[bytes]:
        """The datagrams that have arrived, oldest first; empty where there are none. Never waits.

        Raises `OSError` as `socket.socket.recv` does.
        """
        count = self._receive()
        buffer, size = self._buffer, self._size
        return [
            buffer[start : start + length] for start, length in zip(range(0, count * size, size), self._lengths[:count])
        ]


_SOCKADDR = 16  # bytes of a sockaddr_in
_ADDRESS_AT = 4  # behind family and port


class SourceReader(BatchReader):
    """Reads with each datagram where it comes from."""

    def __init__(self, sock: socket.socket, size: int, slots: int) -> None:
        super().__init__(sock, size, slots)
        self._names: Any = (ctypes.c_char * (_SOCKADDR * slots))()
        start = ctypes.addressof(self._names)
        for slot in range(slots):
            self._headers[slot].header.name = start + slot * _SOCKADDR
            self._headers[slot].header.namelen = _SOCKADDR

    def read_with_sources(self) -> list[tuple[bytes, bytes]]:
        """As `read`; each datagram with the IPv4 address of its sender, four bytes."""
        datagrams = self.read()
        names = self._names
        starts = range(_ADDRESS_AT, len(datagrams) * _SOCKADDR, _SOCKADDR)
        return [(datagram, names[start : start + 4]) for datagram, start in zip(datagrams, starts)]
