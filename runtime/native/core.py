"""The native core of a registry: its table, and the translation of single messages."""

from __future__ import annotations

import ctypes
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from roverlink.runtime.core.registry import AnyHandler, AnyStandardHandler, Registry
from roverlink.runtime.interfaces import Time
from roverlink.runtime.native import layout as native
from roverlink.runtime.native.payload_layouts import PayloadLayouts, UnsupportedError
from roverlink.runtime.native.programs import Programs, RosFrame

_WORKSPACE = 4 << 20
_LARGEST = 1 << 20


class NativeCore:
    """Translation of a registry's rows and extra topics by the native library."""

    def __init__(self, registry: Registry, translations: Mapping[str, Any], library: Path) -> None:
        self.library = ctypes.CDLL(str(library))
        self.library.rl_workspace_new.restype = ctypes.c_void_p
        self.workspace = ctypes.c_void_p(self.library.rl_workspace_new(ctypes.c_size_t(_WORKSPACE)))
        self._out = ctypes.create_string_buffer(_LARGEST)
        self.unsupported: dict[str, str] = {}
        self._index: dict[int, int] = {}
        self.table = self._made(registry, translations)
        if self.library.rl_check(ctypes.byref(self.table)):
            raise ValueError("wrong table")

    def _made(self, registry: Registry, translations: Mapping[str, Any]) -> native.Table:
        programs = Programs(translations["messages"], PayloadLayouts())
        topics = {(one["number"], one["topic"]): one for one in translations["topics"]}
        ops: list[native.Op] = []
        made: list[native.Translation] = []
        for handler in (*registry.handlers, *registry.extra_topics):
            topic = topics.get((handler.route.number, handler.route.topic))
            try:
                one = self._translation(programs, handler, topic, ops)
            except UnsupportedError as error:
                self.unsupported[f"{handler.route.name} {handler.route.topic}"] = str(error)
            else:
                self._index[id(handler)] = len(made)
                made.append(one)
        payloads = programs.payloads
        arrays = [
            _array(native.Field, payloads.fields),
            _array(native.Layout, payloads.layouts),
            _array(native.Op, ops),
            _array(native.Expression, programs.expressions),
            _array(native.Step, programs.steps),
            _array(native.Translation, made),
            _array(ctypes.c_uint64, payloads.words),
            _array(ctypes.c_uint8, programs.bytes),
        ]
        return native.Table(*arrays, *map(len, arrays))

    @staticmethod
    def _translation(
        programs: Programs, handler: AnyHandler | AnyStandardHandler, topic: Any, ops: list[native.Op]
    ) -> native.Translation:
        descriptor, message = handler.payload_type.DESCRIPTOR, handler.message_type
        layout = programs.payloads.of(descriptor)
        frame, back = RosFrame(), []
        if topic is None:
            forth = programs.to_cdr(message, descriptor)
            reading = programs.from_cdr(message, frame, "", programs.octet_lists(message))
            back = programs.to_proto(message, descriptor, frame, "")
        else:
            forth = programs.standard_to_cdr(message, topic["fields"], descriptor)
            reading = []
            if topic["back"] is not None:
                reading = programs.from_cdr(message, frame, "", frozenset())
                angles, back = programs.standard_to_proto(message, topic["back"], descriptor, frame)
                reading += angles
        made = native.Translation(layout, len(ops), len(forth))
        ops += forth
        made.from_cdr, made.from_cdr_size, made.cdr_slots = len(ops), len(reading), frame.size
        ops += reading
        if topic is not None and topic["back"] is None:
            made.cdr_slots = native.NONE
        made.to_proto, made.to_proto_size = len(ops), len(back)
        ops += back
        return made

    def new_workspace(self) -> ctypes.c_void_p:
        """Return memory for one thread."""
        return ctypes.c_void_p(self.library.rl_workspace_new(ctypes.c_size_t(_WORKSPACE)))

    def index_of(self, handler: AnyHandler | AnyStandardHandler) -> int:
        """Return the index of a handler's translation."""
        return self._index[id(handler)]

    def reason(self, handler: AnyHandler | AnyStandardHandler) -> str:
        """Return the reason why the core cannot translate the messages of a handler; empty if it can."""
        return self.unsupported.get(f"{handler.route.name} {handler.route.topic}", "")

    def to_cdr(self, handler: Any, payload: bytes, stamp: Time) -> bytes | None:
        """Return the serialized ROS 2 message of a serialized payload; None if Python has to convert it."""
        index = self._index.get(id(handler))
        size = ctypes.c_size_t(_LARGEST)
        if index is None or self.library.rl_to_cdr(
            ctypes.byref(self.table),
            index,
            self.workspace,
            payload,
            ctypes.c_size_t(len(payload)),
            ctypes.c_int32(stamp.sec),
            ctypes.c_uint32(stamp.nanosec),
            self._out,
            ctypes.byref(size),
        ):
            return None
        return self._out.raw[: size.value]

    def to_proto(self, handler: Any, data: bytes) -> bytes | None:
        """Return the serialized payload of a serialized ROS 2 message; None if Python has to convert it."""
        index = self._index.get(id(handler))
        size = ctypes.c_size_t(_LARGEST)
        if index is None or self.library.rl_to_proto(
            ctypes.byref(self.table),
            index,
            self.workspace,
            data,
            ctypes.c_size_t(len(data)),
            self._out,
            ctypes.byref(size),
        ):
            return None
        return self._out.raw[_LARGEST - size.value :]


def _array(kind: Any, values: Iterable[Any]) -> Any:
    listed = list(values)
    return (kind * len(listed))(*listed)


def load_translations(folder: Path) -> Any:
    """Return the content of ``translations.json`` of a generated package."""
    return json.loads((folder / "translations.json").read_text(encoding="utf-8"))


def load_core(registry: Registry) -> NativeCore | str:
    """Return the core of a registry, or the reason why there is none."""
    import os
    import sys

    lib = os.environ.get("N40")
    if not lib:
        return "none"
    module = sys.modules[type(registry.handlers[0]).__module__.split(".")[0]]
    return NativeCore(registry, load_translations(Path(module.__path__[0])), Path(lib))
