"""Modules that Python launch files import: stand-ins of ROS 2's packages, and the Python packages of the workspace."""

from __future__ import annotations

import ast
import itertools
import sys
from collections.abc import Iterator, Mapping, Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import ModuleType
from typing import Any

from check_launch.expansion.launch_context import Packages
from check_launch.expansion.substitutions import RUN_TIME, UnknownTextError

_MOST_CALLS = 1_000_000  # of unknown objects in one process


class _IgnoredType(type):
    """Type of `Ignored`, whose attributes are unknown, too, as those of a class of messages."""

    def __getattr__(cls, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return Ignored()


class Ignored(metaclass=_IgnoredType):
    """An object of a launch file that starts nothing, or that these stand-ins do not know.

    It accepts every use. Its text is known at run time only. A loop that waits for it to change ends with an
    `UnknownTextError`.
    """

    _calls = itertools.count()

    def __init__(self, *arguments: Any, **options: Any) -> None:
        """Accept everything."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return Ignored()

    def __call__(self, *_: Any, **__: Any) -> Ignored:
        """Return the object itself."""
        if next(Ignored._calls) > _MOST_CALLS:
            raise UnknownTextError("an object that a loop calls")
        return self

    def __getitem__(self, key: Any) -> Ignored:
        return Ignored()

    def __setitem__(self, key: Any, value: Any) -> None:
        """Accept every item."""

    def __iter__(self) -> Iterator[Any]:
        return iter(())

    def __enter__(self) -> Ignored:
        return self

    def __exit__(self, *_: object) -> None:
        """Accept every end of a block."""

    def __str__(self) -> str:
        return RUN_TIME

    __fspath__ = __str__

    def __add__(self, other: Any) -> str:
        return RUN_TIME

    __radd__ = __add__

    def __truediv__(self, other: Any) -> Path:
        return Path(RUN_TIME)

    __rtruediv__ = __truediv__


Ignored.__name__ = RUN_TIME  # for the messages of Python; no class of a launch file can have this name


class _Description:
    """A robot description that xacro would make: a file of XML, of which nothing else is known."""

    def toxml(self, *_: Any, **__: Any) -> str:
        """Return the XML."""
        return f'<robot name="{RUN_TIME}"/>'

    toprettyxml = toxml


def _processed(*_: Any, **__: Any) -> _Description:
    return _Description()


_KNOWN: Mapping[str, Mapping[str, Any]] = {
    "xacro": {"process_file": _processed, "parse": _processed, "process": _Description.toxml, "process_doc": _processed}
}
"""Modules of which launch files need texts."""


class LaunchImports(MetaPathFinder, Loader):
    """Finds modules that are not installed.

    - A submodule of a stand-in, such as ``launch.actions.declare_launch_argument``, has the names of the module above.
    - Python packages of the workspace are imported from their sources.
    - Packages of messages, and those of the workspace without Python code, only give classes of messages.
    - Instead of any other module that the launch file itself imports, it gets `Ignored` objects.
    """

    def __init__(self, imported: Mapping[str, int], stand_ins: Mapping[str, ModuleType], packages: Packages) -> None:
        """``imported`` are the modules that the launch file imports (see `imported_modules`)."""
        self._imported, self._stand_ins, self._packages = imported, stand_ins, packages
        self.missing: dict[str, int] = {}
        """Modules that are not there, each with the line of the import."""

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None,  # noqa: ARG002  # of the base
        target: ModuleType | None = None,  # noqa: ARG002
    ) -> ModuleSpec | None:
        """Return the specification of a module that nothing else has found; None if the import is to fail."""
        top, parent = fullname.partition(".")[0], fullname.rpartition(".")[0]
        if parent in self._stand_ins or isinstance(getattr(sys.modules.get(parent), "__loader__", None), LaunchImports):
            return ModuleSpec(fullname, self, is_package=True)
        if "." not in fullname and (folder := self._packages.python_folder(fullname)):
            return PathFinder.find_spec(fullname, [str(folder)])
        if fullname in _KNOWN or top.endswith("_msgs") or self._packages.has(top):
            return ModuleSpec(fullname, self, is_package=True)
        if fullname in self._imported:
            self.missing[fullname] = self._imported[fullname]
            return ModuleSpec(fullname, self, is_package=True)
        return None

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Return a module whose names are those of the stand-in above it, or `Ignored` objects."""
        module = ModuleType(spec.name)
        above = self._stand_ins.get(spec.name.rpartition(".")[0])
        vars(module).update(_KNOWN.get(spec.name, {}))

        def name_of(name: str) -> Any:
            if name.startswith("__"):
                raise AttributeError(name)
            return getattr(above, name) if above else Ignored

        vars(module)["__getattr__"] = name_of
        return module

    def exec_module(self, module: ModuleType) -> None:
        """Do nothing: the module is complete."""


def imported_modules(node: ast.AST) -> Iterator[tuple[str, int]]:
    """Yield the top-level modules that a file imports, with the line; not those whose absence it handles."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Import):
            yield from ((alias.name.partition(".")[0], child.lineno) for alias in child.names)
        elif isinstance(child, ast.ImportFrom) and child.module and not child.level:
            yield child.module.partition(".")[0], child.lineno
        elif not isinstance(child, ast.Try):
            yield from imported_modules(child)
