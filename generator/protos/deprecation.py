"""What is marked `deprecated` in a .proto file."""

from __future__ import annotations

from google.protobuf.descriptor_pb2 import EnumValueOptions, FieldOptions, MessageOptions

from roverlink.generator.protos.schema import Declared, ProtoEnumValue, ProtoField

MARK = "Deprecated."


def commented(declared: Declared) -> str:
    """The comment of what a .proto file declares, with a mark where it is deprecated."""
    if not _is_deprecated(declared):
        return declared.comment
    return f"{declared.comment}\n\n{MARK}" if declared.comment else MARK


def _is_deprecated(declared: Declared) -> bool:
    if isinstance(declared, ProtoField):
        return FieldOptions.FromString(declared.options).deprecated
    if isinstance(declared, ProtoEnumValue):
        return EnumValueOptions.FromString(declared.options).deprecated
    return MessageOptions.FromString(declared.options).deprecated  # of an enum, the same field of EnumOptions
