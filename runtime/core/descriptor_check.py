"""Check, when a program starts, that the loaded protobuf descriptors are those from which the code was generated.

The generated module ``checks.py`` calls this check. If two copies of one .proto tree at different commits are on the
import path, a program can load the wrong copy and then read fields by the wrong numbers. No other check would notice
this.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, TypeVar

from google.protobuf import descriptor_pool
from google.protobuf.descriptor import FieldDescriptor

from roverlink.runtime.core.errors import RegistryError
from roverlink.runtime.core.protobuf_versions import is_repeated

if TYPE_CHECKING:
    from google.protobuf.descriptor import Descriptor, EnumDescriptor

# Descriptors have a number for each scalar type (descriptor.proto, FieldDescriptorProto.Type): 13 is uint32.
_SCALARS = {
    value: name.removeprefix("TYPE_").lower()
    for name, value in vars(FieldDescriptor).items()
    if name.startswith("TYPE_") and isinstance(value, int)
}


Fields = tuple[tuple[int, str, str], ...]
"""Number, name and type of each field of a message, such as ``(1, "corners", "repeated float")``."""
Values = tuple[tuple[int, str], ...]
"""Number and name of each value of an enum, such as ``(0, "NO_FIX")``."""
Parts = TypeVar("Parts", Fields, Values)


def check_descriptors(messages: Mapping[str, Fields], enums: Mapping[str, Values]) -> None:
    """Compare the loaded protobuf messages and enums with those from which the code was generated.

    ``messages`` and ``enums`` hold, by full name, the fields and values at the time of generation. Raises
    `RegistryError` with a list of the differences.
    """
    pool = descriptor_pool.Default()
    # All differences are listed, since one of them alone rarely shows which copy of the protos was loaded.
    differences = [
        *_differences(messages, lambda name: describe(pool.FindMessageTypeByName(name))),
        *_differences(enums, lambda name: describe_enum(pool.FindEnumTypeByName(name))),
    ]
    if differences:
        raise RegistryError(
            "the loaded protobuf modules are not those from which this code was generated:\n  "
            + "\n  ".join(differences)
            + "\nrun `roverlink generate`, and look for a second copy of the modules on the import path"
        )


def _differences(generated: Mapping[str, Parts], load: Callable[[str], Parts]) -> Iterator[str]:
    for name, expected in generated.items():
        try:
            loaded = load(name)
        except KeyError:
            yield f"{name}: not loaded"
            continue
        yield from (
            f"{name}: the generated code has {_shown(part)}, the loaded module does not"
            for part in expected
            if part not in loaded
        )
        yield from (
            f"{name}: the loaded module has {_shown(part)}, the generated code does not"
            for part in loaded
            if part not in expected
        )


def _shown(part: tuple[object, ...]) -> str:
    """Return a field as text, such as ``'1 latitude double'``, or an enum value, such as ``'0 NO_FIX'``."""
    return f"'{' '.join(map(str, part))}'"


def describe(descriptor: Descriptor) -> Fields:
    """Return number, name and type of each field of a loaded message."""
    return tuple(_describe_field(field) for field in sorted(descriptor.fields, key=lambda field: field.number))


def describe_enum(descriptor: EnumDescriptor) -> Values:
    """Return number and name of each value of a loaded enum."""
    return tuple((value.number, value.name) for value in sorted(descriptor.values, key=lambda v: v.number))


def _describe_field(field: FieldDescriptor) -> tuple[int, str, str]:
    repeated = "repeated " if is_repeated(field) else ""
    named = field.message_type or field.enum_type
    return field.number, field.name, f"{repeated}{named.full_name if named else scalar_name(field)}"


def scalar_name(field: FieldDescriptor) -> str:
    """Return the type of a scalar field as it is written in a .proto file, such as ``uint32``."""
    return _SCALARS[field.type]
