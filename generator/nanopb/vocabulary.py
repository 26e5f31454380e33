"""The vocabulary of nanopb's options: names, types and values, from nanopb.proto in the installed package."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.empty_pb2 import Empty
from google.protobuf.message import DecodeError, Message
from google.protobuf.message_factory import GetMessageClass
from google.protobuf.unknown_fields import UnknownFieldSet

from roverlink.generator.protos.protoc import compile_descriptors

EXTENSION = 1010
"""The field number of nanopb's options in `FileOptions`, `MessageOptions`, `EnumOptions` and `FieldOptions`."""

HOSTS = ("File", "Message", "Enum", "Field")
"""The declarations that may have options, as descriptor.proto names them."""

_FILE = Path("generator", "proto", "nanopb.proto")  # relative to the package


class Vocabulary(NamedTuple):
    """Message types for reading options. Their descriptor pool is separate: a project may have another nanopb.proto."""

    options: type[Message]
    """The message of nanopb's options, which a line of a .options file sets."""
    hosts: Mapping[str, type[Message]]
    """The messages of all options of a declaration, by `HOSTS`."""
    extensions: Mapping[str, object]
    """The extension that holds nanopb's options, by `HOSTS`."""


@cache
def vocabulary() -> Vocabulary:
    """Load the vocabulary. Raises `ModuleNotFoundError` if nanopb is not installed."""
    package = find_spec("nanopb")
    folders = (package.submodule_search_locations if package else None) or ()
    root = next((Path(folder) / _FILE.parent for folder in folders if (Path(folder) / _FILE).is_file()), None)
    if root is None:
        raise ModuleNotFoundError("nanopb is not installed")
    pool = DescriptorPool()
    for file in compile_descriptors(root, [_FILE.name], "nanopb").file:
        pool.AddSerializedFile(file.SerializeToString())
    hosts = {host: pool.FindMessageTypeByName(f"google.protobuf.{host}Options") for host in HOSTS}
    extensions = {host: pool.FindExtensionByNumber(descriptor, EXTENSION) for host, descriptor in hosts.items()}
    return Vocabulary(
        GetMessageClass(pool.FindMessageTypeByName("NanoPBOptions")),
        {host: GetMessageClass(descriptor) for host, descriptor in hosts.items()},
        extensions,
    )


def has_options(serialized: bytes) -> bool:
    """Return True if serialized options contain options of nanopb, or are broken."""
    try:
        # Empty has no fields, so everything in the bytes is an unknown field. No declaration of nanopb's options is
        # needed.
        fields = UnknownFieldSet(Empty.FromString(serialized))
    except DecodeError:
        return True
    return any(fields[index].field_number == EXTENSION for index in range(len(fields)))
