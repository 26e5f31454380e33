"""Does what is loaded agree with what the code was generated from? Called by ``generated/checks.py`` at start.

Two copies of one .proto tree at two commits, both importable, are enough to make a program read bytes with numbers
that its code does not mean; nothing else would notice.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING

from google.protobuf import descriptor_pool
from google.protobuf.descriptor import FieldDescriptor

from roverlink.runtime.core.errors import RegistryError

if TYPE_CHECKING:
    from google.protobuf.descriptor import Descriptor, EnumDescriptor

_SCALARS = {
    value: name.removeprefix("TYPE_").lower()
    for name, value in vars(FieldDescriptor).items()
    if name.startswith("TYPE_") and isinstance(value, int)
}


def check_descriptors(messages: Mapping[str, tuple[str, ...]], enums: Mapping[str, tuple[str, ...]]) -> None:
    """Compare what is loaded with what it was at generation.

    ``messages`` maps a message's full name to its fields, each as ``"<number> <name> [repeated ]<type>"``, ``enums``
    an enum's to its values, each as ``"<number> <name>"``; both in the order of the numbers. Raises `RegistryError`
    that lists every difference.
    """
    pool = descriptor_pool.Default()
    differences = [
        *_differences(messages, lambda name: describe(pool.FindMessageTypeByName(name))),
        *_differences(enums, lambda name: describe_enum(pool.FindEnumTypeByName(name))),
    ]
    if differences:
        raise RegistryError(
            "the protobuf modules that are loaded are not those from which this code was generated:\n  "
            + "\n  ".join(differences)
            + "\nrun `roverlink generate`, and look for a second copy of the modules on the import path"
        )


def _differences(generated: Mapping[str, tuple[str, ...]], load: Callable[[str], tuple[str, ...]]) -> Iterator[str]:
    for name, expected in generated.items():
        try:
            loaded = load(name)
        except KeyError:
            yield f"{name}: not loaded at all"
            continue
        yield from (f"{name}: {part!r} was generated, but is not loaded" for part in expected if part not in loaded)
        yield from (f"{name}: {part!r} is loaded, but was not generated" for part in loaded if part not in expected)


def describe(descriptor: Descriptor) -> tuple[str, ...]:
    """A loaded message's fields, in the spelling of `check_descriptors`."""
    return tuple(_describe_field(field) for field in sorted(descriptor.fields, key=lambda field: field.number))


def describe_enum(descriptor: EnumDescriptor) -> tuple[str, ...]:
    """A loaded enum's values, in the spelling of `check_descriptors`."""
    return tuple(f"{value.number} {value.name}" for value in sorted(descriptor.values, key=lambda v: v.number))


def _describe_field(field: FieldDescriptor) -> str:
    repeated = "repeated " if field.is_repeated else ""
    named = field.message_type or field.enum_type
    return f"{field.number} {field.name} {repeated}{named.full_name if named else scalar_name(field)}"


def scalar_name(field: FieldDescriptor) -> str:
    """The type of a scalar field, as a .proto spells it."""
    return _SCALARS[field.type]
