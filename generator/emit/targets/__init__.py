"""The targets: what a table can be compiled to, each found by its name.

A module of this folder is a target of its name: its `emit` is a function from the IR to files, as path and text, and
writes nothing. Any installed package adds more through the entry-point group `roverlink.targets`. Which targets a
project wants, its table says; nothing in the generator knows one of them by name.
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

GROUP = "roverlink.targets"
"""The entry-point group of the targets that other packages bring."""


def built_in(name: str) -> Target | None:
    """The target of this folder that has a name; None for none."""
    if name not in _modules():
        return None
    return cast(Target, importlib.import_module(f"{__name__}.{name}").emit)


def installed(name: str) -> EntryPoint | None:
    """The target that another package brings under a name, not loaded yet; None for none."""
    return next(iter(entry_points(group=GROUP, name=name)), None)


def names() -> list[str]:
    """Those of all targets."""
    return sorted({*_modules(), *(found.name for found in entry_points(group=GROUP))})


def _modules() -> list[str]:
    return [found.name for found in pkgutil.iter_modules(__path__)]
