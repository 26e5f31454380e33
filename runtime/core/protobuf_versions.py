"""Facts about messages that protobuf tells differently from version to version; 3.20 is the oldest.

A rover's other programs may need an old version, such as that of its distribution. The descriptors have no types here,
because the stubs of one version lack the attributes of others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from google.protobuf import json_format, message_factory
from google.protobuf.descriptor import FieldDescriptor

if TYPE_CHECKING:
    from google.protobuf.descriptor import Descriptor
    from google.protobuf.message import Message as ProtoMessage

_KEYWORDS = json_format.MessageToDict.__code__.co_varnames
ZEROS_TOO: dict[str, Any] = {
    (
        "always_print_fields_with_no_presence"
        if "always_print_fields_with_no_presence" in _KEYWORDS
        else "including_default_value_fields"
    ): True
}
"""Option of `json_format.MessageToDict` for which fields that are zero are included (renamed in 5.26)."""


def is_repeated(field: Any) -> bool:
    """Return true for a repeated field. Before 6.31, its label tells, which newer versions warn of."""
    try:
        return bool(field.is_repeated)
    except AttributeError:
        return bool(field.label == FieldDescriptor.LABEL_REPEATED)


def is_packed(field: Any) -> bool:
    """Return true if the elements of a repeated field are packed; before 6.31, its options or the syntax tell."""
    try:
        return bool(field.is_packed)
    except AttributeError:
        options = field.GetOptions()
        packable = is_repeated(field) and field.cpp_type not in (
            FieldDescriptor.CPPTYPE_STRING,
            FieldDescriptor.CPPTYPE_MESSAGE,
        )
        packed = options.packed if options.HasField("packed") else _is_proto3(field.file)
        return bool(packable and packed)


def is_closed(enum: Any) -> bool:
    """Return true for an enum without other values than those declared; before 4.22, the syntax tells."""
    try:
        return bool(enum.is_closed)
    except AttributeError:
        return not _is_proto3(enum.file)


def message_class(descriptor: Descriptor) -> type[ProtoMessage]:
    """Return the class of a message. Before 4.22, a factory makes it."""
    if hasattr(message_factory, "GetMessageClass"):
        return message_factory.GetMessageClass(descriptor)
    factory: Any = message_factory.MessageFactory
    made: type[ProtoMessage] = factory(descriptor.file.pool).GetPrototype(descriptor)
    return made


def _is_proto3(file: Any) -> bool:
    return bool(file.syntax == "proto3")
