"""Comparison of the interface packages that are installed in ROS 2 with the message classes of roverlink.

rclpy publishes our serialized messages unchanged. If the installed package is older than the generated code, then
subscribers read the bytes by the old definition, and get wrong values without an error.

The comparison reads names and types of all fields. It needs no type hashes (ROS 2 has them since Iron): messages with
equal fields have equal hashes, and of two different hashes nobody could tell which field differs.
"""

from __future__ import annotations

import importlib
from typing import Any

from roverlink.runtime.core.errors import MiddlewareError
from roverlink.runtime.core.messages import (
    Array,
    FieldType,
    Message,
    Primitive,
    Sequence,
    Text,
    fields_of,
    how_to_install,
    messages_in,
)

# rosidl_generator_py spells these types as IDL does.
_IDL_NAMES = {"bool": "boolean", "byte": "octet", "char": "uint8", "float32": "float", "float64": "double"}


def installed_class(message_type: type[Message]) -> Any:
    """Return the class that rosidl generated for a message, from the installed interface package.

    Raises `MiddlewareError` if the message or a message inside it is not installed, or differs from our class.
    """
    for part in (message_type, *messages_in(message_type)):
        if difference := _difference(part):
            raise MiddlewareError(
                f"the installed interface {message_type.__msgtype__} is not the one that roverlink uses: {difference}; "
                f"{how_to_install(part)}"
            )
    return _import(message_type)


def installed_service(request: type[Message]) -> Any:
    """Return the class that rosidl generated for a service, by the type of its request.

    Raises `MiddlewareError` if it is not installed.
    """
    return _import(request, of_service=True)


def _import(message_type: type[Message], of_service: bool = False) -> Any:
    """Return an installed class: of a message, or of a part of a service or the whole service."""
    package, kind, name = message_type.__msgtype__.split("/")
    service, _, part = name.partition("_")  # rosidl has the class of ``Trigger_Request`` as ``Trigger.Request``
    try:
        found = getattr(importlib.import_module(f"{package}.{kind}"), service)
        return getattr(found, part) if part and not of_service else found
    except (ImportError, AttributeError) as error:
        raise MiddlewareError(
            f"the interface {message_type.__msgtype__} is not installed ({error}); {how_to_install(message_type)}"
        ) from error


def _difference(message_type: type[Message]) -> str:
    """Return the first difference between the fields of the installed class and ours; an empty text if they agree."""
    installed: dict[str, str] = _import(message_type).get_fields_and_field_types()
    ours = {field.name: _spelled(field.type) for field in fields_of(message_type)}
    name = message_type.__msgtype__
    for field, kind in ours.items():
        if field not in installed:
            return f"{name} has no field {field}"
        if installed[field] != kind:
            return f"the field {field} of {name} has the type {installed[field]} instead of {kind}"
    if extra := next((field for field in installed if field not in ours), ""):
        return f"{name} has a field {extra} that is unknown here"
    return "" if list(installed) == list(ours) else f"the fields of {name} have another order"


def _spelled(field_type: FieldType) -> str:
    """Return the name of a field type as ``get_fields_and_field_types()`` of the installed classes spells it.

    Examples are ``double``, ``string<8>``, ``sequence<float, 4>`` and ``std_msgs/Header``.
    """
    if isinstance(field_type, Primitive):
        return _IDL_NAMES.get(field_type.name, field_type.name)
    if isinstance(field_type, Text):
        return "string" if field_type.bound is None else f"string<{field_type.bound}>"
    if isinstance(field_type, Array):
        return f"{_spelled(field_type.element)}[{field_type.length}]"
    if isinstance(field_type, Sequence):
        most = "" if field_type.bound is None else f", {field_type.bound}"
        return f"sequence<{_spelled(field_type.element)}{most}>"
    return field_type.__msgtype__.replace("/msg/", "/")
