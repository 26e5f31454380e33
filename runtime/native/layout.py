"""The structs of native/include/roverlink/native.h, with the same names and the same numbers."""

from __future__ import annotations

import ctypes
from enum import IntEnum, IntFlag

INTERFACE = 5
"""Version of the interface that this module describes."""
NONE = 0xFFFFFFFF
"""No index, or no bound."""


class Code(IntEnum):
    """Operation of a program."""

    COPY = 0
    NARROW = 1
    COMPUTE = 2
    TEXT = 3
    CHOICE = 4
    OCTETS = 5
    LIST = 6
    MAP = 7
    BYTES = 8
    PRESENCE = 9
    WHICH = 10
    STAMP = 11
    TIME = 12
    DURATION = 13
    QUATERNION = 14
    MOMENT = 15
    FIELD = 16
    CASE = 17
    MESSAGE = 18
    REPEAT = 19
    PACKED = 20
    ANGLES = 21


class Flag(IntFlag):
    """Flag of an operation."""

    ARRAY = 1
    TEXT_KEY = 2
    SIGNED_KEY = 4
    IMPLICIT = 8
    FRAMES = 16
    UNIQUE = 32


class FieldFlag(IntFlag):
    """Flag of a proto field."""

    REPEATED = 1
    UTF8 = 2
    OPAQUE = 4


class Number(IntEnum):
    """Kind of the number with which an expression begins."""

    SIGNED = 0
    UNSIGNED = 1
    SINGLE = 2
    DOUBLE = 3
    NANOSECONDS = 4


class ExpressionFlag(IntFlag):
    """Flag of an expression."""

    ROUND = 1
    CHECK_SINGLE = 2


class Field(ctypes.Structure):
    """Field of a proto message."""

    _fields_ = (
        ("number", ctypes.c_uint32),
        ("type", ctypes.c_uint8),
        ("flags", ctypes.c_uint8),
        ("unused", ctypes.c_uint16),
        ("slot", ctypes.c_uint32),
        ("extent", ctypes.c_uint32),
        ("oneof", ctypes.c_uint32),
        ("layout", ctypes.c_uint32),
    )


class Layout(ctypes.Structure):
    """Proto message."""

    _fields_ = tuple((name, ctypes.c_uint32) for name in ("first_field", "fields", "slots", "defaults", "is_entry"))


class Op(ctypes.Structure):
    """Operation of a program."""

    _fields_ = (
        ("code", ctypes.c_uint8),
        ("type", ctypes.c_uint8),
        ("flags", ctypes.c_uint16),
        *((name, ctypes.c_uint32) for name in ("slot", "a", "b", "size", "number", "condition", "expected")),
    )


class Expression(ctypes.Structure):
    """Number computed from a slot."""

    _fields_ = (
        ("source", ctypes.c_uint8),
        ("flags", ctypes.c_uint8),
        ("steps", ctypes.c_uint16),
        *((name, ctypes.c_uint32) for name in ("slot", "presence", "first_step", "cases", "otherwise")),
    )


class Step(ctypes.Structure):
    """Operation on a number."""

    _fields_ = (
        ("code", ctypes.c_uint32),
        ("is_whole", ctypes.c_uint32),
        ("real", ctypes.c_double),
        ("whole", ctypes.c_int64),
    )


class Translation(ctypes.Structure):
    """Conversion of one message in both directions."""

    _fields_ = tuple(
        (name, ctypes.c_uint32)
        for name in (
            *("layout", "to_cdr", "to_cdr_size", "from_cdr", "from_cdr_size", "cdr_slots"),
            *("to_proto", "to_proto_size"),
        )
    )


class Table(ctypes.Structure):
    """All arrays of a table."""

    _fields_ = (
        ("fields", ctypes.POINTER(Field)),
        ("layouts", ctypes.POINTER(Layout)),
        ("ops", ctypes.POINTER(Op)),
        ("expressions", ctypes.POINTER(Expression)),
        ("steps", ctypes.POINTER(Step)),
        ("translations", ctypes.POINTER(Translation)),
        ("words", ctypes.POINTER(ctypes.c_uint64)),
        ("bytes", ctypes.POINTER(ctypes.c_uint8)),
        *(
            (f"n_{name}", ctypes.c_uint32)
            for name in ("fields", "layouts", "ops", "expressions", "steps", "translations", "words", "bytes")
        ),
    )
