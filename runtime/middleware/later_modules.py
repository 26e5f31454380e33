"""Modules that the package cyclonedds imports, and that we hardly ever use: they are imported when they are used.

They are its compiler of types, which is needed once for each type (`dds_types`), and asyncio. Together they take two
thirds of the package's import.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any

_TYPES = "cyclonedds.idl._typesupport.DDS.XTypes"


class _LaterModule(ModuleType):
    def __getattr__(self, name: str) -> Any:
        """Import the module, which then has the attribute."""
        if name == "__path__":  # the import system asks for it
            raise AttributeError(name)
        if sys.modules.get(self.__name__) is self:  # it is used in the block already
            del sys.modules[self.__name__]
        module = importlib.import_module(self.__name__)
        vars(self).update(vars(module))
        return getattr(module, name)


@contextmanager
def put_off() -> Iterator[None]:
    """Put off the import of these modules in the block, unless they or the package have been imported already."""
    later = [
        _LaterModule(name)
        for name in ("asyncio", "cyclonedds.dynamic", _TYPES)
        if name not in sys.modules and "cyclonedds" not in sys.modules
    ]
    for module in later:
        sys.modules[module.__name__] = module
        if module.__name__ == _TYPES:  # ids of the types of other nodes, at which we do not look
            vars(module)["TypeIdentifier"] = None
    try:
        yield
    finally:
        for module in later:  # other importers get the modules themselves
            if sys.modules.get(module.__name__) is module:
                del sys.modules[module.__name__]
