"""Lock between threads of Python and of the native core."""

from __future__ import annotations

import ctypes

from roverlink.runtime.native.core import NoCoreError


class SharedLock:
    """Mutex that threads of Python and of the native core take. A context manager."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self._library = library
        self.address: int | None = library.rl_lock_new()
        if self.address is None:
            raise NoCoreError("there is not enough memory for the native core")

    def acquire(self, blocking: bool = True) -> bool:  # as that of threading.Lock
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
