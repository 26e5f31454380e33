"""The options that nanopb knows: names, numbers and types, those of nanopb.proto as of nanopb 0.4.9.1.

They become a message type of our own: protobuf can read them with that in both their spellings, and a project that does
not use nanopb needs no nanopb.proto.
"""

from __future__ import annotations

from collections.abc import Mapping

from google.protobuf.descriptor_pb2 import DESCRIPTOR, FieldDescriptorProto, FileDescriptorProto
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message import Message
from google.protobuf.message_factory import GetMessageClass

EXTENSION = 1010
"""nanopb's number in the options of files, messages, enums and fields, by protobuf's registry of extensions."""

_DEPRECATED = 3  # in MessageOptions, EnumOptions and FieldOptions of descriptor.proto

_ENUMS: Mapping[str, Mapping[str, int]] = {
    "FieldType": {
        "FT_DEFAULT": 0,
        "FT_CALLBACK": 1,
        "FT_STATIC": 2,
        "FT_IGNORE": 3,
        "FT_POINTER": 4,
        "FT_INLINE": 5,
    },
    "IntSize": {"IS_DEFAULT": 0, "IS_8": 8, "IS_16": 16, "IS_32": 32, "IS_64": 64},
    "TypenameMangling": {"M_NONE": 0, "M_STRIP_PACKAGE": 1, "M_FLATTEN": 2, "M_PACKAGE_INITIALS": 3},
    "DescriptorSize": {"DS_AUTO": 0, "DS_1": 1, "DS_2": 2, "DS_4": 4, "DS_8": 8},
}
_OPTIONS: Mapping[str, Mapping[str, int]] = {
    "int32": {"max_size": 1, "max_count": 2, "max_length": 14},
    "uint32": {"msgid": 9},
    "bool": {
        "long_names": 4,
        "packed_struct": 5,
        "skip_message": 6,
        "no_unions": 8,
        "packed_enum": 10,
        "anonymous_oneof": 11,
        "proto3": 12,
        "enum_to_string": 13,
        "fixed_length": 15,
        "fixed_count": 16,
        "proto3_singular_msgs": 21,
        "submsg_callback": 22,
        "default_has": 23,
        "sort_by_tag": 28,
        "enum_validate": 32,
        "discard_unused_automatic_types": 33,
        "discard_deprecated": 35,
    },
    "string": {"callback_datatype": 18, "callback_function": 19, "package": 25, "initializer": 30},
    "repeated string": {"include": 24, "exclude": 26},
    "FieldType": {"type": 3, "fallback_type": 29},
    "IntSize": {"int_size": 7, "enum_intsize": 34},
    "TypenameMangling": {"mangle_names": 17},
    "DescriptorSize": {"descriptorsize": 20},
    "google.protobuf.FieldDescriptorProto.Type": {"type_override": 27},
    "google.protobuf.FieldDescriptorProto.Label": {"label_override": 31},
}

NAMES: Mapping[int, str] = {number: name for options in _OPTIONS.values() for name, number in options.items()}
"""The options by their numbers."""

SIZES = frozenset(_OPTIONS["int32"])
"""The options that count something, and of which a negative value is none."""

_PACKAGE = "roverlink.nanopb"
_OPTIONS_TYPE = f".{_PACKAGE}.Options"
_SCALARS = {
    "int32": FieldDescriptorProto.TYPE_INT32,
    "uint32": FieldDescriptorProto.TYPE_UINT32,
    "bool": FieldDescriptorProto.TYPE_BOOL,
    "string": FieldDescriptorProto.TYPE_STRING,
}


def _declarations() -> FileDescriptorProto:
    file = FileDescriptorProto(name="roverlink/nanopb.proto", package=_PACKAGE, dependency=[DESCRIPTOR.name])
    options = file.message_type.add(name="Options")
    for enum_name, values in _ENUMS.items():
        enum = options.enum_type.add(name=enum_name)
        for value, number in values.items():
            enum.value.add(name=value, number=number)
    for kind, names in _OPTIONS.items():
        options.field.extend(_field(name, number, kind) for name, number in names.items())
    carrier = file.message_type.add(name="Carrier")
    carrier.field.append(_field("deprecated", _DEPRECATED, "bool"))
    message = carrier.field.add(name="options", number=EXTENSION, label=FieldDescriptorProto.LABEL_OPTIONAL)
    message.type, message.type_name = FieldDescriptorProto.TYPE_MESSAGE, _OPTIONS_TYPE
    return file


def _field(name: str, number: int, kind: str) -> FieldDescriptorProto:
    label = FieldDescriptorProto.LABEL_REPEATED if kind.startswith("repeated ") else FieldDescriptorProto.LABEL_OPTIONAL
    field = FieldDescriptorProto(name=name, number=number, label=label)
    if scalar := _SCALARS.get(kind.removeprefix("repeated ")):
        field.type = scalar
    else:
        field.type = FieldDescriptorProto.TYPE_ENUM
        field.type_name = f"{_OPTIONS_TYPE}.{kind}" if kind in _ENUMS else f".{kind}"
    return field


def _message_types() -> tuple[type[Message], type[Message]]:
    pool = DescriptorPool()
    pool.AddSerializedFile(DESCRIPTOR.serialized_pb)
    pool.AddSerializedFile(_declarations().SerializeToString())
    options, carrier = (pool.FindMessageTypeByName(f"{_PACKAGE}.{name}") for name in ("Options", "Carrier"))
    return GetMessageClass(options), GetMessageClass(carrier)


Options, Carrier = _message_types()
"""A set of options; and what stands for the options of anything in a .proto file, nanopb's among them."""
