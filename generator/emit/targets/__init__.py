"""Targets: the kinds of output that a table can be compiled to, found by name.

Each module of this folder is a target with the module's name. Its `emit` is a function from the IR to files (path and
text); it writes nothing to disk. Installed packages add targets through the entry-point group `roverlink.targets`. The
table lists the targets of a project; no other code of the generator knows a target by name.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from importlib.metadata import EntryPoint, entry_points
from typing import cast

from roverlink.generator import ir
from roverlink.generator.emit.render import Files

Target = Callable[[ir.Bridge], Files]
"""Function that generates the files of a target from the IR."""

GROUP = "roverlink.targets"
"""Entry-point group in which other packages register their targets."""


def built_in(name: str) -> Target | None:
    """Return the function `emit` of the built-in target ``name``; None if roverlink has no such target."""
    if name not in _modules():
        return None
    return cast(Target, importlib.import_module(f"{__name__}.{name}").emit)


def installed(name: str) -> EntryPoint | None:
    """Return the entry point of the target ``name`` from another package; None if no installed package has it.

    The package is not imported.
    """
    return next(iter(entry_points(group=GROUP, name=name)), None)


def names() -> list[str]:
    """Return the names of all targets: the built-in ones, and those of other packages."""
    return sorted({*_modules(), *(entry.name for entry in entry_points(group=GROUP))})


def _modules() -> list[str]:
    return [module.name for module in pkgutil.iter_modules(__path__)]
