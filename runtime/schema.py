"""Does what is loaded agree with what the code was generated from? Called by ``generated/checks.py`` at start.

Two copies of one .proto tree at two commits, both importable, are enough to make a program read bytes with numbers
that its code does not mean; nothing else would notice.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from google.protobuf import descriptor_pool
from google.protobuf.descriptor import FieldDescriptor

from runtime.errors import RegistryError

if TYPE_CHECKING:
    from google.protobuf.descriptor import Descriptor

_SCALARS = {
    value: name.removeprefix("TYPE_").lower()
    for name, value in vars(FieldDescriptor).items()
    if name.startswith("TYPE_") and isinstance(value, int)
}


def check_descriptors(messages: Mapping[str, tuple[str, ...]]) -> None:
    """Compare loaded messages with the fields they had at generation.

    ``messages`` maps a message's full name to its fields, each as ``"<number> <name> [repeated ]<type>"`` in the order
    of their numbers. Raises `RegistryError` that lists every difference.
    """
    differences = [line for name, fields in messages.items() for line in _differences(name, fields)]
    if differences:
        raise RegistryError(
            "the protobuf modules that are loaded are not those from which this code was generated:\n  "
            + "\n  ".join(differences)
            + "\nrun `roverlink generate`, and look for a second copy of the modules on the import path"
        )


def _differences(name: str, expected: tuple[str, ...]) -> Iterator[str]:
    try:
        descriptor = descriptor_pool.Default().FindMessageTypeByName(name)
    except KeyError:
        yield f"{name}: not loaded at all"
        return
    loaded = describe(descriptor)
    yield from (f"{name}: {field!r} was generated, but is not loaded" for field in expected if field not in loaded)
    yield from (f"{name}: {field!r} is loaded, but was not generated" for field in loaded if field not in expected)


def describe(descriptor: Descriptor) -> tuple[str, ...]:
    """A loaded message's fields, in the spelling of `check_descriptors`."""
    return tuple(_describe_field(field) for field in sorted(descriptor.fields, key=lambda field: field.number))


def _describe_field(field: FieldDescriptor) -> str:
    repeated = "repeated " if field.is_repeated else ""
    named = field.message_type or field.enum_type
    return f"{field.number} {field.name} {repeated}{named.full_name if named else scalar_name(field)}"


def scalar_name(field: FieldDescriptor) -> str:
    """The type of a scalar field, as a .proto spells it."""
    return _SCALARS[field.type]
