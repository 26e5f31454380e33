"""Features of Cyclone DDS that its Python package does not offer. Only this module uses private parts of the package.

- *Raw writes and reads*: the package's writers and readers convert sample objects, while we have bytes.
- *Batching*: a writer collects samples until it is flushed, and sends them in one packet. Sending a packet and waking
  the subscriber cost several times as much as all other work for a sample.
- *Acknowledgement*: in version 11.0.1, the package's function that waits for it fails where it should return False.
- *Types*: the package compiles the type of a topic from a class. Its C part needs only a name and some bytes of it.
- *Deletion*: the package deletes an entity when its last reference is gone. At the end of a program this may never
  happen; other nodes then see the node for ten more seconds. Or it happens while Python shuts down. Then a thread of
  Cyclone DDS that needs Python to free a topic's type is ended by Python, and joining that thread blocks forever.
"""

from __future__ import annotations

import ctypes
import json
import threading
from collections.abc import Callable, Mapping, Sequence
from itertools import repeat
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cyclonedds
from cyclonedds._clayer import ddspy_take, ddspy_write
from cyclonedds.core import DDSException, Entity, InstanceState, Listener, SampleState, ViewState
from cyclonedds.idl import IdlStruct
from cyclonedds.internal import DDS, dds_c_t
from cyclonedds.pub import DataWriter
from cyclonedds.qos import BasePolicy, _CQos
from cyclonedds.sub import DataReader
from cyclonedds.util import duration

from roverlink.runtime.core.errors import MiddlewareError
from roverlink.runtime.native.bridge_layout import MiddlewareFunctions, Reading, Topic

_library: Any = DDS._dll_handle
_flush = _library.dds_write_flush
_flush.argtypes, _flush.restype = (dds_c_t.entity,), dds_c_t.returnv
_set_batching = _library.dds_qset_writer_batching
_set_batching.argtypes, _set_batching.restype = (dds_c_t.qos_p, ctypes.c_bool), None

_wait_for_acks = _library.dds_wait_for_acks
_wait_for_acks.argtypes, _wait_for_acks.restype = (dds_c_t.entity, dds_c_t.duration), dds_c_t.returnv
_count_matched = _library.dds_get_matched_publications
_count_matched.argtypes, _count_matched.restype = (dds_c_t.entity, ctypes.c_void_p, ctypes.c_size_t), dds_c_t.returnv
_delete = _library.dds_delete
_delete.argtypes, _delete.restype = (dds_c_t.entity,), dds_c_t.returnv

_WORD = 4  # bytes; Cyclone DDS takes serialized samples in multiples of this
EVERYTHING = SampleState.Any | ViewState.Any | InstanceState.Any
"""Mask that selects all samples of a reader."""

_PADDING = tuple(bytes(-length % _WORD) for length in range(_WORD))  # by a sample's length modulo _WORD


class WriterBatching(BasePolicy):  # type: ignore[no-untyped-call]  # its base declares no types
    """QoS policy of a writer: collect samples until the writer is flushed, and then send them in one packet."""

    __scope__ = "WriterBatching"


def _set_policy(_: object, qos: Any, __: WriterBatching) -> None:
    _set_batching(qos, True)


# The package finds the setter of a policy by the name of its scope.
_CQos._set_p_writerbatching = classmethod(_set_policy)  # type: ignore[attr-defined]  # added here


COMPILER = Path(str(cyclonedds.__file__)).with_name("idl") / "_xt_builder.py"
"""The package's compiler of types, which another version of the package replaces."""
_compiling = threading.Lock()


def describe(struct: type[IdlStruct]) -> bytes:
    """Return the description of a type that Cyclone DDS needs for a topic."""
    idl: Any = struct.__idl__
    # After an error, or for a second thread, the package takes a type for described that has no bytes yet.
    with _compiling:
        idl._xt_data = None, None
        idl.fill_type_data()
    return json.dumps(
        {
            "idl_transformed_typename": idl.idl_transformed_typename,
            "data_type_props": int(idl.data_type_props),
            "supported_versions": int(idl.supported_versions),
            "_xt_bytedata": [data.hex() for data in idl._xt_bytedata],
        }
    ).encode()


class DescribedType(IdlStruct):
    """Type of topics of which there is only a description."""

    @classmethod
    def of(cls, description: bytes) -> type[DescribedType]:
        """Return the type with a description that `describe` has made."""
        facts = json.loads(description)
        data = tuple(map(bytes.fromhex, facts.pop("_xt_bytedata")))
        done = dict.fromkeys(("populate", "fill_type_data"), lambda: None)
        kind: Any = type("DescribedType", (cls,), {})
        kind.__idl__ = SimpleNamespace(**facts, **done, _xt_bytedata=data)
        described: type[DescribedType] = kind
        return described


class MatchedReaders(Listener):
    """Listener of a writer; its attribute ``exist`` is true while at least one reader matches the writer.

    To read the attribute is faster than to ask Cyclone DDS before each write.
    """

    def __init__(self) -> None:
        super().__init__()  # type: ignore[no-untyped-call]  # its base declares no types
        self.exist = False
        self._topic: Topic | None = None

    def tell(self, topic: Topic) -> None:
        """Set ``wanted`` of the native core's topic now, and whenever a first reader comes or the last one goes."""
        self._topic = topic
        topic.wanted = self.exist

    def on_publication_matched(self, _: object, status: Any) -> None:
        """Store whether a reader matches. Cyclone DDS calls this for each reader that it finds or loses."""
        self.exist = status.current_count > 0
        if self._topic is not None:
            self._topic.wanted = self.exist


class MatchedWriters(Listener):
    """Listener of a participant; calls a function when the last writer that matches one of its readers has left."""

    def __init__(self) -> None:
        super().__init__()  # type: ignore[no-untyped-call]  # its base declares no types
        self.left: dict[int, Callable[[], None]] = {}
        """The functions, by the reference of the reader."""

    def on_subscription_matched(self, reader: Entity | None, status: Any) -> None:
        """Cyclone DDS calls this for each writer that it finds or loses; there is no reader while it is made."""
        if reader is not None and status.current_count == 0 and (left := self.left.get(int(reader._ref))) is not None:
            left()


class RawWriter:
    """Writes serialized samples through a DDS writer whose QoS has `WriterBatching`."""

    def __init__(self, writer: DataWriter[Any]) -> None:
        self._writer = writer  # deletes itself without a reference
        self._reference = writer._ref

    def write(self, samples: Sequence[bytes]) -> int:
        """Write samples and send them at once; return how many were accepted.

        If the queue of a reliable writer is full, the remaining samples are not accepted, because the writer would have
        to wait. The same holds if Cyclone DDS reports an error.
        """
        accepted = 0
        whole = [sample + _PADDING[len(sample) % _WORD] for sample in samples]
        for code in map(ddspy_write, repeat(self._reference), whole):
            # max_blocking_time is 0 (`dds_qos`), so a full queue of a reliable writer returns at once with a timeout.
            if code < 0:
                break
            accepted += 1
        # One packet and one wake-up of the subscriber for the whole batch, see "Batching" above.
        _flush(self._reference)
        return accepted

    def lend_to(self, topic: Topic, functions: MiddlewareFunctions) -> None:
        """Let the native core write through this writer. Raises AttributeError if the library lacks a function."""
        sertype = ctypes.c_void_p()
        if _library.dds_get_entity_sertype(self._reference, ctypes.byref(sertype)) < 0:
            raise AttributeError("a writer of Cyclone DDS without a type")
        topic.writer, topic.sertype = self._reference, sertype
        functions.serdata = ctypes.cast(_library.ddsi_serdata_from_ser_iov, ctypes.c_void_p)
        functions.write = ctypes.cast(_library.dds_writecdr, ctypes.c_void_p)
        functions.flush = ctypes.cast(_flush, ctypes.c_void_p)

    def wait_for_acknowledgement(self, seconds: float) -> bool:
        """Wait until every reliable reader has acknowledged all samples.

        Return false if this takes longer than ``seconds``.
        """
        return bool(_wait_for_acks(self._reference, duration(seconds=seconds)) == 0)


class RawReader:
    """Takes received samples, in serialized form, from a DDS reader."""

    def __init__(self, reader: DataReader[Any]) -> None:
        self._reader = reader  # deletes itself without a reference
        self._reference = reader._ref
        self._topic = reader.topic.name

    def take(self, most: int) -> list[bytes]:
        """Take at most ``most`` samples, the oldest first. Raises `MiddlewareError` if Cyclone DDS reports an error."""
        taken = ddspy_take(self._reference, EVERYTHING, most)
        if isinstance(taken, int):
            raise MiddlewareError(f"Cyclone DDS cannot read {self._topic}: {DDSException(taken)}")
        # A sample without valid data says that an instance was disposed; ROS topics have no instances.
        return [data for data, info in taken if info.valid_data]

    @property
    def reference(self) -> int:
        """Entity of the reader in Cyclone DDS."""
        return int(self._reference)

    def has_publishers(self) -> bool:
        """Return true if DDS has found a writer that matches this reader."""
        # The package's function makes a list of them, and asks twice for it.
        return bool(_count_matched(self._reference, None, 0) > 0)


class NativeWaitSet:
    """Wait set for the native core. A context manager, which deletes the wait set on exit."""

    def __init__(self, participant: Entity, conditions: Mapping[int, Entity], wake: Entity) -> None:
        """Trigger with the key of a condition, and with -1 for ``wake``."""
        self.reference, self.wake = int(_library.dds_create_waitset(participant._ref)), int(wake._ref)
        for key, condition in {**conditions, -1: wake}.items():
            _library.dds_waitset_attach(self.reference, condition._ref, key)

    def __enter__(self) -> NativeWaitSet:
        return self

    def __exit__(self, *_: object) -> None:
        _delete(self.reference)


def reading_functions() -> Reading:
    """Return the functions by which the native core takes samples. Raises AttributeError if the library lacks one."""
    functions = {
        "wait": _library.dds_waitset_wait,
        "take": _library.dds_takecdr,
        "size": _library.ddsi_serdata_size,
        "bytes": _library.ddsi_serdata_to_ser,
        "unref": _library.ddsi_serdata_unref,
        "new_listener": _library.dds_create_listener,
        "on_data_available": _library.dds_lset_data_available,
        "set_listener": _library.dds_set_listener,
        "delete_listener": _library.dds_delete_listener,
        "set_guard": _library.dds_set_guardcondition,
    }
    return Reading(**{name: ctypes.cast(function, ctypes.c_void_p).value for name, function in functions.items()})


def delete(entity: Entity) -> None:
    """Delete a DDS entity and everything that was created from it, without waiting for Python's garbage collector."""
    _delete(entity._ref)
