"""Protobuf schema of a recording: stores the descriptors of the envelope, and makes message classes from them again."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from google.protobuf import descriptor_pb2, descriptor_pool
from google.protobuf.message import DecodeError

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.protobuf_versions import message_class

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage


def descriptor_set_of(message_type: type[ProtoMessage]) -> bytes:
    """Return the serialized ``FileDescriptorSet`` with the .proto file of a message class and all imported files.

    A file stands after all files that it imports.
    """
    files: dict[str, descriptor_pb2.FileDescriptorProto] = {}
    _add(message_type.DESCRIPTOR.file, files)
    return descriptor_pb2.FileDescriptorSet(file=files.values()).SerializeToString(deterministic=True)


def _add(file: Any, files: dict[str, descriptor_pb2.FileDescriptorProto]) -> None:
    if file.name in files:
        return
    # Imports first: a DescriptorPool accepts a file only after the files that it imports.
    for imported in file.dependencies:
        _add(imported, files)
    files[file.name] = descriptor_pb2.FileDescriptorProto()
    file.CopyToProto(files[file.name])


def message_type_from(name: str, descriptor_set: bytes) -> type[ProtoMessage]:
    """Make a message class from the descriptors in a recording; ``name`` is the full name of the message.

    Raises `SetupError` if the descriptors are invalid.
    """
    pool = descriptor_pool.DescriptorPool()
    try:
        for file in descriptor_pb2.FileDescriptorSet.FromString(descriptor_set).file:
            pool.Add(file)
        return message_class(pool.FindMessageTypeByName(name))
    except (DecodeError, KeyError, TypeError) as error:
        raise SetupError(f"cannot use the recorded protobuf schema of {name}: {error}") from error
