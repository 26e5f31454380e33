"""The structs of native/include/roverlink/bridge.h, with the same names. The header says what their members are."""

from __future__ import annotations

import ctypes
from typing import Any

from roverlink.runtime.core.signing import KEY_BYTES, SigningClock, Stream
from roverlink.runtime.native.layout import Table

BUCKETS = 16
RAW = 0x8000_0000
"""Flag of a record's channel."""
DESTINATIONS = 64
"""Largest number of destinations of a bridge."""


def _words(*names: str) -> tuple[tuple[str, Any], ...]:
    return tuple((name, ctypes.c_uint32) for name in names)


class Datagram(ctypes.Structure):
    """Bytes that have arrived."""

    _fields_ = (
        ("data", ctypes.c_void_p),
        ("size", ctypes.c_size_t),
        ("sender", ctypes.c_void_p),
        ("sender_size", ctypes.c_size_t),
    )


def bytes_of(datagram: Datagram) -> bytes:
    """Return a copy of the bytes."""
    return ctypes.string_at(datagram.data, datagram.size)


class Ring(ctypes.Structure):
    """Copies of messages and datagrams for observers."""

    _fields_ = (
        ("memory", ctypes.c_void_p),
        ("room", ctypes.c_uint64),
        ("written", ctypes.c_uint64),
        ("read", ctypes.c_uint64),
    )


class Recording(ctypes.Structure):
    """Records of a ring, and what a file gets of them."""

    _fields_ = (
        ("records", ctypes.c_char_p),
        ("size", ctypes.c_size_t),
        ("channels", ctypes.POINTER(ctypes.c_uint16)),
        ("log_time", ctypes.c_int64),
        ("publish_time", ctypes.c_int64),
    )


class Run(ctypes.Structure):
    """Records of one channel of a file."""

    _fields_ = (*_words("channel", "count"), ("first", ctypes.c_uint64))


class Signer(ctypes.Structure):
    """Key with which the bridge signs."""

    _fields_ = (
        ("id", ctypes.c_uint8),
        ("secret", ctypes.c_uint8 * KEY_BYTES),
        ("last", ctypes.c_uint64),
        ("clock", ctypes.POINTER(SigningClock)),
        ("lock", ctypes.c_void_p),
        *_words("number", "strips_zeros"),
    )


class MiddlewareFunctions(ctypes.Structure):
    """Addresses of functions of the middleware's library: those of Cyclone DDS, or those of rcl."""

    _fields_ = tuple(
        (name, ctypes.c_void_p) for name in ("serdata", "write", "flush", "publish", "count_subscriptions")
    )


class Topic(ctypes.Structure):
    """Topic on which a row's payloads are published."""

    _fields_ = (
        *_words("translation", "wanted"),
        ("writer", ctypes.c_int32),
        *_words("observed"),
        ("sertype", ctypes.c_void_p),
        ("publisher", ctypes.c_void_p),
        ("pacer", ctypes.c_void_p),
        ("paused_until", ctypes.c_int64),
        ("published", ctypes.c_uint64),
        ("published_at", ctypes.c_int64),
    )


class Row(ctypes.Structure):
    """Inbound row, or the link message."""

    _fields_ = (
        *_words("number", "native", "at_once", "first_topic", "topics", "longest", "is_signed", "unused"),
        ("signers", ctypes.c_uint64 * 4),
        ("forward", ctypes.c_uint64),
        ("forward_pacers", ctypes.POINTER(ctypes.c_void_p)),
        ("handled", ctypes.c_uint64),
    )


class Destination(ctypes.Structure):
    """End of the link to which datagrams are forwarded."""

    _fields_ = (
        ("socket", ctypes.POINTER(ctypes.c_int32)),
        ("signer", ctypes.POINTER(Signer)),
        ("forwarded", ctypes.c_uint64),
        *_words("segments", "unused"),
    )


Handle = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(Datagram), ctypes.c_uint32)
OfTopic = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_uint32)
Admit = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_uint32, ctypes.POINTER(Datagram))
Send = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_uint32, ctypes.POINTER(Datagram), ctypes.c_uint32)


class Calls(ctypes.Structure):
    """Calls of Python."""

    _fields_ = (("handle", Handle), ("not_published", OfTopic), ("wait", OfTopic), ("send", Send), ("admit", Admit))


class Bridge(ctypes.Structure):
    """All that the receiving thread needs."""

    _fields_ = (
        ("table", ctypes.POINTER(Table)),
        ("workspace", ctypes.c_void_p),
        ("topics", ctypes.POINTER(Topic)),
        ("rows", ctypes.POINTER(Row)),
        ("destinations", ctypes.POINTER(Destination)),
        ("streams", ctypes.POINTER(ctypes.POINTER(Stream))),
        ("middleware", MiddlewareFunctions),
        ("calls", Calls),
        ("observers", ctypes.POINTER(Ring)),
        ("bounds", ctypes.POINTER(ctypes.c_double)),
        ("latencies", ctypes.c_uint64 * BUCKETS),
        ("latency_sum", ctypes.c_double),
        ("received", ctypes.c_uint64),
        *_words("n_topics", "n_rows", "n_destinations", "n_bounds", "n_streams", "signature"),
        ("socket", ctypes.c_int32),
        ("wake", ctypes.c_int32),
        *_words("largest", "observed", "checks_senders", "senders", "forwards_all", "is_ordered", "stopping"),
    )


class Reading(ctypes.Structure):
    """Addresses of functions of the middleware's library: those of Cyclone DDS, or the one of rcl."""

    _fields_ = tuple(
        (name, ctypes.c_void_p)
        for name in (
            *("wait", "take", "size", "bytes", "unref", "take_one"),
            *("new_listener", "on_data_available", "set_listener", "delete_listener", "set_guard"),
        )
    )


class Subscription(ctypes.Structure):
    """Topic whose messages go to a peer."""

    _fields_ = (
        *_words("translation", "number"),
        ("reader", ctypes.c_int32),
        *_words("native"),
        ("socket", ctypes.POINTER(ctypes.c_int32)),
        ("signer", ctypes.POINTER(Signer)),
        ("pacer", ctypes.c_void_p),
        *_words("segments", "observed", "strips_zeros", "is_direct"),
        ("taken", ctypes.c_uint64),
        ("sent", ctypes.c_uint64),
        ("sent_at", ctypes.c_int64),
        ("subscription", ctypes.c_void_p),
        *_words("arrived"),
        ("wake", ctypes.c_int32),
    )


Serve = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_uint32, ctypes.c_uint32)
Pass = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_uint32, ctypes.POINTER(Datagram))


class ServingCalls(ctypes.Structure):
    """Calls of Python."""

    _fields_ = (("serve", Serve), ("take", Pass), ("wait", OfTopic), ("send", Pass))


class Server(ctypes.Structure):
    """All that the thread needs that takes messages from topics."""

    _fields_ = (
        ("table", ctypes.POINTER(Table)),
        ("workspace", ctypes.c_void_p),
        ("topics", ctypes.POINTER(ctypes.POINTER(Subscription))),
        ("priorities", ctypes.POINTER(ctypes.c_int32)),
        ("reading", Reading),
        ("calls", ServingCalls),
        ("observers", ctypes.POINTER(Ring)),
        ("direct_workspace", ctypes.c_void_p),
        *_words("n_topics"),
        ("waitset", ctypes.c_int32),
        ("wake", ctypes.c_int32),
        *_words("stopping"),
    )
