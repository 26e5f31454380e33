"""What Cyclone DDS can do and its Python package does not offer: the one place that reaches beneath its public API.

- *Raw writes and takes*: the package's writers and readers make bytes of sample objects, and those of bytes; here bytes
  are all that is wanted.
- *Batching*: a writer that collects samples until it is flushed, then sends them in one packet. The packet, and waking
  the subscriber for it, cost several times as much as everything else that is done for a sample.
- *Acknowledgement*: the package's own function for it (11.0.1) fails where it should return False.
- *Deleting*: the package deletes an entity when nothing refers to it any more, which at the end of a program is never,
  so that others would see it for ten more seconds; or it is when Python has begun to go. A thread of Cyclone DDS that
  then asks for Python, to free the type of a topic, is ended by it, and who waits for that thread waits for ever.
"""

from __future__ import annotations

import atexit
import ctypes
from collections.abc import Sequence
from itertools import repeat
from typing import Any

from cyclonedds._clayer import ddspy_take, ddspy_write
from cyclonedds.core import DDSException, Entity, InstanceState, SampleState, ViewState
from cyclonedds.internal import DDS, dds_c_t
from cyclonedds.pub import DataWriter
from cyclonedds.qos import BasePolicy, _CQos
from cyclonedds.sub import DataReader
from cyclonedds.util import duration

from roverlink.runtime.core.errors import MiddlewareError

_library: Any = DDS._dll_handle
_flush = _library.dds_write_flush
_flush.argtypes, _flush.restype = (dds_c_t.entity,), dds_c_t.returnv
_set_batching = _library.dds_qset_writer_batching
_set_batching.argtypes, _set_batching.restype = (dds_c_t.qos_p, ctypes.c_bool), None

_wait_for_acks = _library.dds_wait_for_acks
_wait_for_acks.argtypes, _wait_for_acks.restype = (dds_c_t.entity, dds_c_t.duration), dds_c_t.returnv
_delete = _library.dds_delete
_delete.argtypes, _delete.restype = (dds_c_t.entity,), dds_c_t.returnv

_WORD = 4  # bytes; Cyclone DDS takes samples in whole words
EVERYTHING = SampleState.Any | ViewState.Any | InstanceState.Any
"""Which samples of a reader are meant."""

_PADDING = tuple(bytes(-length % _WORD) for length in range(_WORD))  # by what a sample is longer than whole words


class WriterBatching(BasePolicy):  # type: ignore[no-untyped-call]  # its base declares no types
    """The writer collects samples until it is flushed."""

    __scope__ = "WriterBatching"


def _set_policy(_: object, qos: Any, __: WriterBatching) -> None:
    _set_batching(qos, True)


# The package turns a policy into a call by the name of its scope.
_CQos._set_p_writerbatching = classmethod(_set_policy)  # type: ignore[attr-defined]  # added here


class RawWriter:
    """Writes serialized samples through a writer that batches."""

    def __init__(self, writer: DataWriter[Any]) -> None:
        self._writer = writer  # which would delete itself where nobody held it
        self._reference = writer._ref
        self._topic = writer.topic.name

    def write(self, samples: Sequence[bytes]) -> int:
        """Write samples and send them; returns how many were accepted, in order, before one would have had to wait.

        Raises `MiddlewareError` where Cyclone DDS fails.
        """
        accepted = 0
        whole = [sample + _PADDING[len(sample) % _WORD] for sample in samples]
        for code in map(ddspy_write, repeat(self._reference), whole):
            if code == DDSException.DDS_RETCODE_TIMEOUT:
                break
            if code < 0:
                raise MiddlewareError(f"Cyclone DDS does not write on {self._topic}: {DDSException(code)}")
            accepted += 1
        _flush(self._reference)
        return accepted

    def wait_for_acknowledgement(self, seconds: float) -> bool:
        """Wait until every reliable reader has acknowledged all that was written; False where one has not."""
        return bool(_wait_for_acks(self._reference, duration(seconds=seconds)) == 0)


class RawReader:
    """Takes serialized samples."""

    def __init__(self, reader: DataReader[Any]) -> None:
        self._reader = reader  # which would delete itself where nobody held it
        self._reference = reader._ref
        self._topic = reader.topic.name

    def take(self, most: int) -> list[bytes]:
        """The oldest samples that have come, and take them away. Raises `MiddlewareError` where Cyclone DDS fails."""
        taken = ddspy_take(self._reference, EVERYTHING, most)
        if isinstance(taken, int):
            raise MiddlewareError(f"Cyclone DDS does not read {self._topic}: {DDSException(taken)}")
        # One without valid data is an instance's end, which ROS does not know.
        return [data for data, info in taken if info.valid_data]

    def has_publishers(self) -> bool:
        """Whether any writer matches."""
        return bool(self._reader.get_matched_publications())


def delete(entity: Entity) -> None:
    """Delete an entity, and all that was made from it, now."""
    _delete(entity._ref)


def delete_at_exit(entity: Entity) -> None:
    """Delete an entity when the program ends, while Python still runs."""
    atexit.register(delete, entity)
