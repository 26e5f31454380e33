"""Payloads with plausible example values, for the documentation, the demo and the simulation.

The values follow from the names and types of the fields in protobuf's descriptors.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage

P = TypeVar("P", bound="ProtoMessage")

EXAMPLE_S = 1.0
"""Time, in seconds, at which the payloads of the documentation's examples are computed."""
_PERIOD_S = 6.0
_LIST_LENGTH = 3
_ANY = "google.protobuf.Any"
_SIGNALS = {
    "latitude": (50.0647, 0.0005),
    "longitude": (19.945, 0.0005),
    "altitude": (219.0, 3.0),
    "heading": (180.0, 90.0),
    "hdop": (1.2, 0.4),
    "vdop": (1.8, 0.5),
    "satellites": (9.0, 3.0),
    "temperature": (31.0, 6.0),
    "voltage": (24.0, 1.5),
    "rpm": (300.0, 280.0),
    "ph": (7.0, 0.6),
    "pressure": (101.3, 0.8),
    "mass": (212.5, 20.0),
    "confidence": (0.8, 0.15),
    "gyro": (0.0, 0.3),
    "mag": (0.0, 40.0),
    "speed": (0.6, 0.5),
    "distance": (6.0, 5.0),
    "radius": (2.5, 1.5),
    "length": (40.0, 20.0),
    "width": (30.0, 15.0),
    "height": (30.0, 15.0),
    "force": (2.1, 0.2),
    "scale": (0.01, 0.001),
    "timestamp": (1_750_000_000.0, 3.0),
    "index": (1.0, 1.0),
    "total": (4.0, 1.0),
    "id": (3.0, 2.0),
}
"""Mean value and amplitude of a field, by a word in its name. Other float fields have 0 and 10, integers 50 and 50."""
_NO_ERROR = frozenset({"NO", "NONE", "OK"})
"""Words in the name of an error code that reports no error."""
_GRAVITY = -9.81  # m/s^2


def payload_at(payload_type: type[P], seconds: float) -> P:
    """Return a payload with example values for a time in seconds.

    Over time, its numbers oscillate, booleans toggle, and enums step through their values. An enum field whose name
    contains ``error`` gets a value such as ``OK`` or ``NONE``, unless it is the only field of its message.
    """
    payload = payload_type()
    _fill(payload, seconds, frozenset())
    return payload


def _fill(payload: ProtoMessage, seconds: float, inside: frozenset[str]) -> None:
    """Set the fields of a payload, and of the messages in it, to example values.

    ``inside`` has the full names of the messages around the payload. A field with one of these types stays empty,
    because a message that contains itself would never end.
    """
    inside |= {payload.DESCRIPTOR.full_name}
    for field in payload.DESCRIPTOR.fields:
        message = field.message_type
        if message is not None and (message.GetOptions().map_entry or message.full_name in (*inside, _ANY)):
            continue  # left empty
        if not _is_chosen(field, seconds):
            continue
        if message is not None and not field.is_repeated:
            nested = getattr(payload, field.name)
            nested.SetInParent()
            _fill(nested, seconds, inside)
        elif message is not None:
            for index in range(_LIST_LENGTH):
                _fill(getattr(payload, field.name).add(), seconds + index, inside)
        elif field.is_repeated:
            getattr(payload, field.name).extend(_value(field, seconds + index) for index in range(_LIST_LENGTH))
        else:
            setattr(payload, field.name, _value(field, seconds))


def _is_chosen(field: Any, seconds: float) -> bool:
    """Return True if a field is set at a time.

    A field outside a oneof is always set. Members of a oneof are set one after another, for one second each.
    """
    members = field.containing_oneof.fields if field.containing_oneof else [field]
    return bool(members[int(seconds) % len(members)].number == field.number)


def _value(field: Any, seconds: float) -> Any:
    phase = 2 * math.pi * seconds / _PERIOD_S + field.number
    # The field number shifts the phase, so that fields of one message differ.
    swing = math.sin(phase)
    if field.enum_type is not None:
        values = field.enum_type.values
        if "error" in field.name.split("_") and len(field.containing_type.fields) > 1:
            return next((value for value in values if _NO_ERROR & {*value.name.split("_")}), values[0]).number
        return values[int(seconds) % len(values)].number
    if field.cpp_type in (field.CPPTYPE_FLOAT, field.CPPTYPE_DOUBLE):
        middle, width = _signal(field.name) or (0.0, 10.0)
        return round(middle + width * swing, 6)
    if field.cpp_type == field.CPPTYPE_BOOL:
        return swing > 0
    if field.type == field.TYPE_STRING:
        return f"{field.name} {int(seconds)}"
    if field.type == field.TYPE_BYTES:
        return int(100 + 100 * swing).to_bytes(2, "little")
    middle, width = _signal(field.name) or (50.0, 50.0)
    return int(middle + width * swing)


def _signal(name: str) -> tuple[float, float] | None:
    """Return mean value and amplitude of a field by its name; None if the name contains no known word."""
    if name == "accel_z":
        return _GRAVITY, 0.4
    return next((_SIGNALS[word] for word in name.split("_") if word in _SIGNALS), None)
