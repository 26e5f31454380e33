"""Check at start that the loaded protobuf descriptors are those from which the code was generated.

``generated/checks.py`` calls it. If two copies of one .proto tree at different commits are importable, a program can
load the wrong one and then read fields by the wrong numbers; no other check would notice.
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
    """Compare the loaded descriptors with those at generation.

    ``messages`` maps each message's full name to its fields, each as ``"<number> <name> [repeated ]<type>"``. ``enums``
    maps each enum's full name to its values, each as ``"<number> <name>"``. Both are sorted by number. Raises
    `RegistryError` that lists every difference.
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


def _differences(generated: Mapping[str, tuple[str, ...]], load: Callable[[str], tuple[str, ...]]) -> Iterator[str]:
    for name, expected in generated.items():
        try:
            loaded = load(name)
        except KeyError:
            yield f"{name}: not loaded"
            continue
        yield from (
            f"{name}: the generated code has {part!r}, the loaded module does not"
            for part in expected
            if part not in loaded
        )
        yield from (
            f"{name}: the loaded module has {part!r}, the generated code does not"
            for part in loaded
            if part not in expected
        )


def describe(descriptor: Descriptor) -> tuple[str, ...]:
    """Return a loaded message's fields as `check_descriptors` spells them."""
    return tuple(_describe_field(field) for field in sorted(descriptor.fields, key=lambda field: field.number))


def describe_enum(descriptor: EnumDescriptor) -> tuple[str, ...]:
    """Return a loaded enum's values as `check_descriptors` spells them."""
    return tuple(f"{value.number} {value.name}" for value in sorted(descriptor.values, key=lambda v: v.number))


def _describe_field(field: FieldDescriptor) -> str:
    repeated = "repeated " if field.is_repeated else ""
    named = field.message_type or field.enum_type
    return f"{field.number} {field.name} {repeated}{named.full_name if named else scalar_name(field)}"


def scalar_name(field: FieldDescriptor) -> str:
    """Return the type of a scalar field as a .proto file spells it."""
    return _SCALARS[field.type]
