"""The options of nanopb: names, types and values, as the installed nanopb package declares them in its nanopb.proto."""

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
"""The field number of nanopb's options in the options of files, messages, enums and fields."""

HOSTS = ("File", "Message", "Enum", "Field")
"""What can have options in a .proto file, as descriptor.proto names the messages of their options."""

_FILE = Path("generator", "proto", "nanopb.proto")  # below the package


class Vocabulary(NamedTuple):
    """Message types that read options, from a pool of their own: a project may have another nanopb.proto."""

    options: type[Message]
    """nanopb's options alone, as a line of a .options file has them."""
    hosts: Mapping[str, type[Message]]
    """The options of a file, message, enum or field, by `HOSTS`."""
    extensions: Mapping[str, object]
    """The extension with nanopb's options in each of them."""


@cache
def vocabulary() -> Vocabulary:
    """Load the vocabulary. Raises `ModuleNotFoundError` where nanopb is not installed."""
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
    """Return whether serialized options of a file, message, enum or field have options of nanopb, or are broken."""
    try:
        fields = UnknownFieldSet(Empty.FromString(serialized))
    except DecodeError:
        return True
    return any(fields[index].field_number == EXTENSION for index in range(len(fields)))
