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

    def read(self) -> list[bytes]:
        """The datagrams that have arrived, oldest first; empty where there are none. Never waits.

        Raises `OSError` as `socket.socket.recv` does.
        """
        count: int = self._recvmmsg(self._descriptor, self._headers, self._slots, socket.MSG_DONTWAIT, None)
        if count < 0:
            code = ctypes.get_errno()
            if code in (errno.EAGAIN, errno.EINTR):
                return []
            raise OSError(code, os.strerror(code))
        buffer, size = self._buffer, self._size
        return [
            buffer[start : start + length] for start, length in zip(range(0, count * size, size), self._lengths[:count])
        ]
