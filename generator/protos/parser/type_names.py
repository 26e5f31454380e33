"""Resolution of type names: finds the declared type that a name in a field means, by protobuf's scoping rules."""

from __future__ import annotations

import re
from collections.abc import Set
from functools import lru_cache

_SCALARS = "double float int32 int64 uint32 uint64 sint32 sint64 fixed32 fixed64 sfixed32 sfixed64 bool string bytes"
SCALARS = frozenset(_SCALARS.split())
_MAP = re.compile(r"map<(\w+), (.+)>")


def map_types(type_name: str) -> tuple[str, str] | None:
    """Return the types of the keys and the values of a map, as the file writes them; None for another type.

    >>> map_types("map<string, pkg.Wheel>")
    ('string', 'pkg.Wheel')
    """
    found = _MAP.fullmatch(type_name)
    return (found[1], found[2]) if found else None


def resolve_type(type_name: str, scope: str, declared_names: Set[str]) -> str | None:
    """Return the full name of the message or enum that a field's type name means; None if it is not declared.

    ``scope`` is the full name of the message that contains the field. The search goes from this scope outwards, and the
    first scope that declares the first part of the name decides: if it lacks the rest, the result is None.

    >>> resolve_type("B", "pkg.A", {"pkg.A", "pkg.A.B", "pkg.B"})
    'pkg.A.B'
    >>> resolve_type(".pkg.B", "pkg.A", {"pkg.A", "pkg.A.B", "pkg.B"})
    'pkg.B'
    >>> resolve_type("A.C", "pkg.A", {"pkg.A", "pkg.A.A", "pkg.A.C"}) is None
    True
    """
    declared = frozenset(declared_names)
    if type_name.startswith("."):
        return type_name[1:] if type_name[1:] in declared else None
    if type_name in SCALARS:
        return None
    first, dot, rest = type_name.partition(".")
    # The first part of a dotted name may be a package or an outer message, so these decide, too. A name without a dot
    # can only be a type.
    deciding = declared | _scopes(declared) if dot else declared
    while True:
        candidate = f"{scope}.{first}" if scope else first
        if candidate in deciding:
            found = candidate + dot + rest
            return found if found in declared else None
        if not scope:
            return None
        scope = scope.rpartition(".")[0]


@lru_cache(maxsize=16)
def _scopes(declared: frozenset[str]) -> frozenset[str]:
    """Return the full names of all messages and packages that contain one of the declared names, at any depth."""
    parts = (name.split(".") for name in declared)
    return frozenset(".".join(part[:length]) for part in parts for length in range(1, len(part)))
