"""Import statements of a generated module, in isort's order, because black does not sort imports."""

from __future__ import annotations

import re
from collections.abc import Iterable

from roverlink.generator.emit.python_format import LINE_LENGTH

Import = tuple[str, str]
"""Module, and a name that is imported from it: ``("roverlink.runtime.core", "cdr")``. The name may be ``cdr as c``."""


def import_lines(imports: Iterable[Import]) -> list[str]:
    """Return the import statements, one for each module. Statements for protobuf's library form the first block."""
    names: dict[str, set[str]] = {}
    aliased = set()
    for module, name in imports:
        if " as " in name:  # isort writes an alias as a separate statement
            aliased.add((module, name))
        else:
            names.setdefault(module, set()).add(name)
    statements = [(module, ", ".join(sorted(found, key=_member_order))) for module, found in names.items()]
    statements = sorted([*statements, *aliased], key=lambda statement: [natural_order(part) for part in statement])
    lines = [_statement(module, imported) for module, imported in statements]
    google = [line for line in lines if line.startswith("from google.")]
    ours = [line for line in lines if line not in google]
    return [*google, "", *ours] if google and ours else lines


def _statement(module: str, imported: str) -> str:
    """Return an import as black lays it out: a name in each line if one line is too short for all."""
    line = f"from {module} import {imported}"
    if len(line) <= LINE_LENGTH:
        return line
    return "\n".join([f"from {module} import (", *(f"    {name}," for name in imported.split(", ")), ")"])


def _member_order(name: str) -> tuple[int, list[tuple[str, int]]]:
    """Return isort's sort key of an imported name: constants, then classes, then other names."""
    kind = 0 if name.isupper() and len(name) > 1 else 1 if name[:1].isupper() else 2
    return kind, natural_order(name)


def natural_order(name: str) -> list[tuple[str, int]]:
    """Return a sort key that compares digits as numbers: ``UInt8`` comes before ``UInt32``."""
    return [(text.lower(), int(digits or 0)) for text, digits in re.findall(r"(\D*)(\d*)", name)]
