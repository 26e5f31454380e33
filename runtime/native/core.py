"""The native core of a registry: its library, its table, and the translation of single messages."""

from __future__ import annotations

import ctypes
import json
import sys
import weakref
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from roverlink.runtime.core.errors import RoverlinkError
from roverlink.runtime.core.registry import AnyHandler, AnyStandardHandler, Registry
from roverlink.runtime.interfaces import Time
from roverlink.runtime.native import bridge_layout
from roverlink.runtime.native import layout as native
from roverlink.runtime.native.cdr_reading import CdrReading, RosFrame
from roverlink.runtime.native.cdr_writing import CdrWriting
from roverlink.runtime.native.payload_layouts import PayloadLayouts, UnsupportedError
from roverlink.runtime.native.payload_writing import PayloadWriting
from roverlink.runtime.native.table_parts import TableParts

LIBRARY = Path(__file__).with_name("libroverlink_native.so")
"""Library that hatch_build.py compiles where roverlink is installed, or that its wheel contains."""
REINSTALL = "install roverlink again where a C++ compiler is"

_WORKSPACE = 4 << 20
_LARGEST = 1 << 20
"""Bytes of the largest message. A datagram with 64 KiB of small numbers becomes 8 times as long."""


class NoCoreError(RoverlinkError):
    """Reason why there is no native core, and Python translates all messages."""


def open_core(registry: Registry) -> NativeCore:
    """Load the library, and make the table of a registry. Raises `NoCoreError`."""
    return NativeCore(registry, load_translations(registry), load_library(LIBRARY))


def load_library(path: Path) -> ctypes.CDLL:
    """Load the native library, with the types of its functions. Raises `NoCoreError`."""
    if not path.is_file():
        raise NoCoreError(f"the native library is not installed; {REINSTALL}")
    try:
        library = ctypes.CDLL(str(path))
        interface = library.rl_interface()
    except (OSError, AttributeError) as error:
        raise NoCoreError(f"{path} cannot be loaded ({error}); {REINSTALL}") from error
    if interface != native.INTERFACE:
        raise NoCoreError(f"{path} has interface {interface}, not {native.INTERFACE}; {REINSTALL}")
    pointer, size, table = ctypes.c_void_p, ctypes.c_size_t, ctypes.POINTER(native.Table)
    message = (table, ctypes.c_uint32, pointer, ctypes.c_char_p, size)
    result = (pointer, ctypes.POINTER(size))
    library.rl_workspace_new.argtypes, library.rl_workspace_new.restype = (size,), pointer
    library.rl_workspace_free.argtypes, library.rl_workspace_free.restype = (pointer,), None
    for use in (library.rl_lock_take, library.rl_lock_try, library.rl_lock_leave):
        use.argtypes = (pointer,)
    library.rl_lock_take.restype = library.rl_lock_leave.restype = None
    library.rl_check.argtypes = (table,)
    library.rl_check_bridge.argtypes = library.rl_receive.argtypes = (ctypes.POINTER(bridge_layout.Bridge),)
    library.rl_serve.argtypes = (ctypes.POINTER(bridge_layout.Server),)
    recording, runs = ctypes.POINTER(bridge_layout.Recording), ctypes.POINTER(bridge_layout.Run)
    library.rl_newest_records.argtypes = (ctypes.c_char_p, size, ctypes.POINTER(ctypes.c_uint64))
    library.rl_newest_records.restype = None
    library.rl_count_records.argtypes = (recording, runs)
    library.rl_record.argtypes = (recording, runs, ctypes.c_uint32, ctypes.c_uint64, pointer, pointer)
    library.rl_record.restype = library.rl_take_records.restype = size
    library.rl_to_cdr.argtypes = (*message, ctypes.c_int32, ctypes.c_uint32, *result)
    library.rl_to_proto.argtypes = (*message, *result)
    return library


def load_translations(registry: Registry) -> Any:
    """Return the content of ``translations.json`` of the package with a registry's handlers. Raises `NoCoreError`."""
    if not registry.handlers:
        return {"messages": {}, "topics": []}
    package = type(registry.handlers[0]).__module__.rsplit(".", 2)[0]  # of generated.handlers.imu_info
    path = Path(str(sys.modules[package].__file__)).with_name("translations.json")
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise NoCoreError(f"{path} cannot be read ({error}); run `roverlink generate`") from error


class NativeCore:
    """Translation of a registry's rows and extra topics by the native library. For one thread at a time."""

    def __init__(self, registry: Registry, translations: Mapping[str, Any], library: ctypes.CDLL) -> None:
        """Make the table. Raises `NoCoreError` if ``translations`` are not those of the registry."""
        self.unsupported: dict[str, str] = {}
        """Reason why Python translates the messages of a row or an extra topic, by its topic in the table."""
        self.library = library
        self._index: dict[int, int] = {}
        try:
            self.table = self._made(registry, translations)
        except (KeyError, TypeError, AttributeError, AssertionError, StopIteration) as error:
            raise NoCoreError(
                f"translations.json is not that of the table ({error!r}); run `roverlink generate`"
            ) from error
        if library.rl_check(ctypes.byref(self.table)):
            raise NoCoreError("the native library refuses the table; report this as a bug of roverlink")
        self.workspace = self.new_workspace(self)
        self._out = ctypes.create_string_buffer(_LARGEST)

    def _made(self, registry: Registry, translations: Mapping[str, Any]) -> native.Table:
        parts = TableParts(translations["messages"], PayloadLayouts())
        topics = {(one["number"], one["topic"]): one for one in translations["topics"]}
        ops: list[native.Op] = []
        made: list[native.Translation] = []
        for handler in (*registry.handlers, *registry.extra_topics):
            topic = topics.get((handler.route.number, handler.route.topic))
            self._index[id(handler)] = len(made)
            made.append(self._translation(parts, handler, topic, ops))
        payloads = parts.payloads
        arrays = [
            _array(native.Field, payloads.fields),
            _array(native.Layout, payloads.layouts),
            _array(native.Op, ops),
            _array(native.Expression, parts.expressions),
            _array(native.Step, parts.steps),
            _array(native.Translation, made),
            _array(ctypes.c_uint64, payloads.words),
            _array(ctypes.c_uint8, payloads.constants),
        ]
        return native.Table(*arrays, *map(len, arrays))

    def _translation(
        self, parts: TableParts, handler: AnyHandler | AnyStandardHandler, topic: Any, ops: list[native.Op]
    ) -> native.Translation:
        """Return the translation of a handler: one direction alone, if the core does not support the other one."""
        descriptor, message = handler.payload_type.DESCRIPTOR, handler.message_type
        made = native.Translation(layout=native.NONE, cdr_slots=native.NONE)
        reasons = {True: "", False: ""}
        try:
            if topic is None:
                forth = CdrWriting(parts).to_cdr(message, descriptor)
            else:
                forth = CdrWriting(parts).standard_to_cdr(message, topic["fields"], descriptor)
            made.layout, made.to_cdr, made.to_cdr_size = parts.payloads.of(descriptor), len(ops), len(forth)
            ops += forth
        except UnsupportedError as error:
            reasons[True] = str(error)
        try:
            if topic is None or topic["back"] is not None:
                frame = RosFrame()
                if topic is None:
                    reading = CdrReading(parts).from_cdr(message, frame, "", descriptor)
                    back = PayloadWriting(parts).to_proto(message, descriptor, frame, "")
                else:
                    reading = CdrReading(parts).from_cdr(message, frame, "")
                    angles, back = PayloadWriting(parts).standard_to_proto(message, topic["back"], descriptor, frame)
                    reading += angles
                made.from_cdr, made.from_cdr_size, made.cdr_slots = len(ops), len(reading), frame.size
                made.to_proto, made.to_proto_size = len(ops) + len(reading), len(back)
                ops += reading + back
            else:
                reasons[False] = "the message does not determine the payload"
        except UnsupportedError as error:
            reasons[False] = str(error)
        if handler.board_stamp is not None:
            reasons[True] = "its stamps are by the clock of the board"
        if reason := reasons[handler.route.inbound]:
            self.unsupported[handler.route.topic] = reason
        return made

    def new_workspace(self, owner: object) -> ctypes.c_void_p:
        """Return memory for another thread, which is freed when nothing refers to ``owner`` any more.

        Raises `NoCoreError` if there is not enough.
        """
        workspace = ctypes.c_void_p(self.library.rl_workspace_new(_WORKSPACE))
        if not workspace:
            raise NoCoreError("there is not enough memory for the native core")
        # Not when the program ends: a thread that hangs may still use it.
        weakref.finalize(owner, self.library.rl_workspace_free, workspace).atexit = False
        return workspace

    def index_of(self, handler: AnyHandler | AnyStandardHandler) -> int:
        """Return the index of a handler's translation."""
        return self._index[id(handler)]

    def reason(self, handler: AnyHandler | AnyStandardHandler) -> str:
        """Return the reason why the core cannot translate the messages of a handler; empty if it can."""
        return self.unsupported.get(handler.route.topic, "")

    def to_cdr(self, handler: AnyHandler | AnyStandardHandler, payload: bytes, stamp: Time) -> bytes | None:
        """Return the serialized ROS 2 message of a serialized payload; None if Python has to convert it."""
        size = ctypes.c_size_t(_LARGEST)
        message = (ctypes.byref(self.table), self.index_of(handler), self.workspace, payload, len(payload))
        if self.library.rl_to_cdr(*message, stamp.sec, stamp.nanosec, self._out, ctypes.byref(size)):
            return None
        return ctypes.string_at(self._out, size.value)

    def to_proto(self, handler: AnyHandler | AnyStandardHandler, data: bytes) -> bytes | None:
        """Return the serialized payload of a serialized ROS 2 message; None if Python has to convert it."""
        size = ctypes.c_size_t(_LARGEST)
        message = (ctypes.byref(self.table), self.index_of(handler), self.workspace, data, len(data))
        if self.library.rl_to_proto(*message, self._out, ctypes.byref(size)):
            return None
        return ctypes.string_at(ctypes.addressof(self._out) + _LARGEST - size.value, size.value)


def _array(kind: Any, values: Iterable[Any]) -> Any:
    listed = list(values)
    return (kind * len(listed))(*listed)
