"""ROS 2 serialization by an independent implementation, rosbags, which reads the generated .msg files."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from roverlink.runtime.core.messages import Array, FieldType, Message, Primitive, Sequence, fields_of

_DTYPES = {"?": "bool", "b": "i1", "B": "u1", "h": "i2", "H": "u2", "i": "i4", "I": "u4", "q": "i8", "Q": "u8"}
_DTYPES |= {"f": "f4", "d": "f8"}


@cache
def _store() -> Typestore:
    store = get_typestore(Stores.ROS2_HUMBLE)
    types: dict[str, Any] = {}
    for path in sorted(_interface_package().glob("msg/*.msg")):
        types.update(get_types_from_msg(path.read_text(encoding="utf-8"), f"comms/msg/{path.stem}"))
    store.register(types)
    return store


def _interface_package() -> Path:
    return Path(__file__).parents[2] / "generated" / "ros" / "comms"


def field_names(message_type: type[Message]) -> list[str]:
    """The fields of a message as its .msg file has them."""
    _, fields = _store().fielddefs[message_type.__msgtype__]
    return [name for name, _ in fields]


def constants(message_type: type[Message]) -> dict[str, object]:
    """The constants of a message as its .msg file has them."""
    values, _ = _store().fielddefs[message_type.__msgtype__]
    return {name: value for name, _, value in values}


def register(type_name: str, text: str) -> None:
    """Make a type of a test's own known."""
    if type_name not in _store().fielddefs:
        _store().register(get_types_from_msg(text, type_name))


def serialize(message: Message, *, little_endian: bool = True) -> bytes:
    """The serialized form of a message, header included, in either byte order."""
    theirs = _to_theirs(message, type(message))
    return bytes(_store().serialize_cdr(theirs, message.__msgtype__, little_endian=little_endian))


def _to_theirs(value: Any, field_type: FieldType) -> Any:
    if isinstance(field_type, type):
        their_type = _store().types[field_type.__msgtype__]
        return their_type(**{f.name: _to_theirs(getattr(value, f.name), f.type) for f in fields_of(field_type)})
    if isinstance(field_type, (Sequence, Array)):
        if isinstance(field_type.element, Primitive):
            return numpy.array(list(value), dtype=_DTYPES[field_type.element.format])
        return [_to_theirs(element, field_type.element) for element in value]
    if isinstance(field_type, Primitive) and field_type.name == "byte":
        return (value ^ 0x80) - 0x80  # rosbags has ROS's byte for signed; on the wire they are the same
    return value
