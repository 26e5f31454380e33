"""Classes of standard ROS 2 messages, made at run time from the definitions in the rosbags package."""

from __future__ import annotations

import dataclasses
import os
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.messages import PRIMITIVES, Bound, Length, Message, UInt8, default_of, type_of

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

_PLACEHOLDER = "structure_needs_at_least_one_member"


def full_name(type_name: str) -> str:
    """Return ``sensor_msgs/msg/Imu`` for ``sensor_msgs/Imu`` or for itself. Raises `SetupError` for any other form."""
    parts = type_name.split("/")
    if len(parts) == 2:
        parts.insert(1, "msg")
    if len(parts) != 3 or not all(parts):
        raise SetupError(f"{type_name!r} is not the name of a ROS 2 type, such as sensor_msgs/msg/Imu")
    return "/".join(parts)


@cache
def message_type(type_name: str) -> type[Message]:
    """Return the class of a standard message by its full name.

    Raises `SetupError` if rosbags does not know the type.
    """
    store = _store()
    if type_name not in store.fielddefs:
        from roverlink.runtime.core.errors import nearest

        raise SetupError(f"unknown ROS 2 type {type_name!r}; {nearest(type_name, store.fielddefs)}")
    _, definitions = store.fielddefs[type_name]
    # rosidl adds the placeholder to messages without fields; our codec writes it by itself.
    fields = [_field(name, definition) for name, definition in definitions if name != _PLACEHOLDER]
    name = type_name.rpartition("/")[2]
    known = {"__msgtype__": type_name, "__typehash__": store.hash_rihs01(type_name)}
    return dataclasses.make_dataclass(name, fields, bases=(Message,), namespace=known)


@cache
def _store() -> Typestore:
    from rosbags.typesys import Stores, get_typestore  # here: it is an optional package

    # Some standard messages differ between distributions, and with them their type hashes.
    distribution = os.environ.get("ROS_DISTRO", "humble").upper()
    return get_typestore(getattr(Stores, f"ROS2_{distribution}", Stores.ROS2_HUMBLE))


def _field(name: str, definition: Any) -> tuple[str, Any, Any]:
    annotation = _annotation(definition)
    return name, annotation, dataclasses.field(default_factory=default_of(type_of(annotation)))


def _annotation(definition: Any) -> Any:
    """Return the annotation for the type of a field; rosbags describes the type as a kind and details of the kind."""
    kind, detail = definition
    if kind.name == "NAME":
        return message_type(detail)
    if kind.name == "BASE":
        base, bound = detail
        if base in ("string", "wstring"):
            return _text(base, bound)
        # rosbags uses the names of IDL, in which `byte` of a .msg file is `octet`.
        return PRIMITIVES["byte" if base == "octet" else base]
    element, count = _annotation(detail[0]), detail[1]
    container: Any = bytes if element is UInt8 else list.__class_getitem__(element)
    if kind.name == "ARRAY":
        return Annotated[container, Length(count)]
    return Annotated[container, Bound(count)] if count else container


def _text(base: str, bound: int) -> Any:
    if base == "wstring":
        raise SetupError("the message type has a wide string (wstring), which is not supported")
    return Annotated[str, Bound(bound)] if bound else str
