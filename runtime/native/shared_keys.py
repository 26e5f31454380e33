"""Keys and clocks that Python and the native core use together, so that no timestamp is used twice."""

from __future__ import annotations

import ctypes

from roverlink.runtime.core.signing import Signer, SigningClock, Stream
from roverlink.runtime.native import bridge_layout as native
from roverlink.runtime.native.core import NativeCore
from roverlink.runtime.native.shared_lock import SharedLock


class SharedKeys:
    """Keys of one bridge. What is shared gets a lock of the core, so no thread may use it yet."""

    def __init__(self, core: NativeCore) -> None:
        self._library = core.library
        self._signers: dict[int, native.Signer] = {}

    def stream(self, stream: Stream) -> Stream:
        """Share the stream of a key of a peer."""
        self._share_clock(stream.clock)
        return stream

    def signer(self, signer: Signer | None, strips_zeros: bool) -> native.Signer | None:
        """Share a signer; ``strips_zeros`` is true if the peer gets its datagrams without the zeros at their end."""
        if signer is None:
            return None
        if id(signer) not in self._signers:
            self._share_clock(signer.clock)
            signer.lock = lock = SharedLock(self._library)
            secret = (ctypes.c_uint8 * len(signer.key.secret))(*signer.key.secret)
            self._signers[id(signer)] = native.Signer(
                id=signer.key.id,
                secret=secret,
                clock=ctypes.pointer(signer.clock),
                lock=lock.address,
                number=signer.number,
                strips_zeros=strips_zeros,
            )
        return self._signers[id(signer)]

    def _share_clock(self, clock: SigningClock) -> None:
        if clock.shared_lock is None:
            clock.lock = lock = SharedLock(self._library)
            clock.shared_lock = lock.address
