"""Lock between threads of Python and of the native core."""

from __future__ import annotations

import ctypes


class SharedLock:
    """Lock that threads of Python and of the native core take (`rl_lock` in bridge.h). A context manager."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self._library, self._state = library, ctypes.c_uint32()
        self.address = ctypes.addressof(self._state)

    def acquire(self, blocking: bool = True) -> bool:
        """Take the lock; without ``blocking``, return false if another thread has it."""
        if not blocking:
            return bool(self._library.rl_lock_try(self.address))
        self._library.rl_lock_take(self.address)
        return True

    def release(self) -> None:
        """Leave the lock to others."""
        self._library.rl_lock_leave(self.address)

    def __enter__(self) -> None:
        self.acquire()

    def __exit__(self, *_: object) -> None:
        self.release()
