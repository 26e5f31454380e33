"""Protobuf classes that know nanopb's options, made from the file nanopb.proto of the installed nanopb package."""

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
"""The field number of nanopb's extension to `FileOptions`, `MessageOptions`, `EnumOptions` and `FieldOptions`."""

HOSTS = ("File", "Message", "Enum", "Field")
"""The kinds of declarations that may have options. descriptor.proto has a message for each, such as ``FileOptions``."""

_FILE = Path("generator", "proto", "nanopb.proto")  # relative to the package


class Vocabulary(NamedTuple):
    """Protobuf classes with which nanopb's options are read.

    They have a descriptor pool of their own, because a project may contain another version of nanopb.proto.
    """

    options: type[Message]
    """The class `NanoPBOptions`, with nanopb's options. A line of a .options file sets its fields."""
    hosts: Mapping[str, type[Message]]
    """The class with all options of a declaration, such as `FieldOptions`, by the kind of declaration in `HOSTS`."""
    extensions: Mapping[str, object]
    """The extension that contains nanopb's options in such a class, by the kind of declaration in `HOSTS`."""


@cache
def vocabulary() -> Vocabulary:
    """Return the classes for reading nanopb's options. Raises `ModuleNotFoundError` if nanopb is not installed."""
    package = find_spec("nanopb")
    folders = (package.submodule_search_locations if package else None) or ()
    root = next((Path(folder) / _FILE.parent for folder in folders if (Path(folder) / _FILE).is_file()), None)
    if root is None:
        raise ModuleNotFoundError("nanopb is not installed")
    pool = DescriptorPool()
    root = (root / _FILE.name).resolve().parent  # some installers make links to a cache
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
    """Return True if a declaration's serialized options contain options of nanopb, or cannot be read."""
    try:
        # Empty has no fields, so everything in the bytes is an unknown field. No declaration of nanopb's options is
        # needed.
        fields = UnknownFieldSet(Empty.FromString(serialized))
    except DecodeError:
        return True
    return any(fields[index].field_number == EXTENSION for index in range(len(fields)))
