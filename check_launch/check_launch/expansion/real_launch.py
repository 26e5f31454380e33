"""The real Python packages launch and launch_ros, where they are installed: their classes, which note what is created.

A launch file gets a subclass of each class that has a stand-in. Its constructor calls the real one, which refuses what
ROS 2 refuses, and creates the stand-in from the same arguments. So the check goes on with the stand-ins, which have
places and do not need the values of all arguments. Everything else in the packages is the real thing. Where the
packages are not installed, a launch file can derive classes from the stand-ins.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, ItemsView, Iterator, Mapping
from functools import cache
from types import ModuleType
from typing import Any

from check_launch.expansion.substitutions import Substitution, UnknownSubstitution

_PACKAGES = ("launch", "launch_ros.actions")
_OWN = frozenset({"ament_index_python", "ament_index_python.packages"})
"""Modules that are never real: they would not find packages whose sources are in the repository."""
_OF_FUNCTIONS = frozenset({"args", "kwargs"})
"""Options of OpaqueFunction that go back to the launch file, which creates real objects with them."""
_ATTRIBUTE = "stand_in_of_check_launch"


@cache
def is_installed() -> bool:
    """Return true if launch files can use the real packages."""
    return all(_real(name) is not None for name in _PACKAGES)


def recording(name: str, stand_ins: Mapping[str, Any]) -> ModuleType | None:
    """Return a copy of a real module whose classes create stand-ins; None if there is no real module.

    ``stand_ins`` are the constructors of the stand-ins by the names of the classes.
    """
    real = None if name in _OWN else _real(name)
    if real is None:
        return None
    module = ModuleType(name)
    vars(module).update(vars(real))
    for attribute, value in vars(real).items():
        make = stand_ins.get(attribute, UnknownSubstitution if _is_substitution(value) else None)
        if isinstance(value, type) and make is not None:
            vars(module)[attribute] = _recorded(value, make)
    return module


def derived(stand_in: Any) -> Any:
    """Return a stand-in that the real classes accept, although it has no real counterpart."""
    if is_installed() and isinstance(stand_in, type) and issubclass(stand_in, Substitution):
        base = importlib.import_module("launch").Substitution
        accepting = type(base.__name__, (base,), {"__init__": lambda self, *_, **__: base.__init__(self)})
        return _recorded(accepting, stand_in)
    return stand_in


class _Creating(type):
    """Type of a class that a call does not create an object of, but a stand-in."""

    _make: Callable[..., Any]
    _kinds: set[type]
    """Types of the stand-ins so far."""

    def __call__(cls, *arguments: Any, **options: Any) -> Any:
        if "_make" not in vars(cls):  # the launch file has derived it
            return super().__call__(*arguments, **options)
        stand_in = cls._make(*arguments, **options)
        cls._kinds.add(type(stand_in))
        return stand_in

    def __instancecheck__(cls, instance: Any) -> bool:
        return super().__instancecheck__(instance) or type(instance) in vars(cls).get("_kinds", ())


def derivable(name: str, make: Callable[..., Any]) -> type:
    """Return a class whose call creates a stand-in; an object of a class that is derived from it has a stand-in."""

    def create(self: Any, *arguments: Any, **options: Any) -> None:
        setattr(self, _ATTRIBUTE, make(*arguments, **options))

    def attribute(self: Any, name: str) -> Any:
        return getattr(getattr(self, _ATTRIBUTE), name)

    names = {"__init__": create, "__getattr__": attribute, _ATTRIBUTE: None}
    return _Creating(name, (), {**names, "_make": staticmethod(make), "_kinds": set()})


def stand_in_of(value: Any) -> Any:
    """Return a value with the stand-ins in place of the real objects."""
    if hasattr(type(value), _ATTRIBUTE):
        return getattr(value, _ATTRIBUTE)
    if type(value) in (list, tuple):
        return type(value)(map(stand_in_of, value))
    if type(value) is dict:
        return {stand_in_of(name): stand_in_of(part) for name, part in value.items()}
    if is_installed() and isinstance(value, importlib.import_module("launch").LaunchDescription):
        return [stand_in_of(entity) for entity in value.entities]
    return value


def _real(name: str) -> ModuleType | None:
    try:
        return importlib.import_module(name)
    except Exception:  # noqa: BLE001  # also what an installation that is broken raises
        return None


def _is_substitution(value: Any) -> bool:
    base = importlib.import_module("launch").Substitution
    return isinstance(value, type) and issubclass(value, base) and value is not base


class _Recording(type):
    """Type of the subclasses. The real packages import classes while a launch file runs, and get a subclass then."""

    def __instancecheck__(cls, instance: Any) -> bool:
        return isinstance(instance, cls.__bases__) if _ATTRIBUTE in vars(cls) else super().__instancecheck__(instance)

    def __subclasscheck__(cls, subclass: type) -> bool:
        return issubclass(subclass, cls.__bases__) if _ATTRIBUTE in vars(cls) else super().__subclasscheck__(subclass)


def _recorded(real: type, make: Callable[..., Any]) -> type:
    """Return a subclass of a real class whose objects have a stand-in, and answer as it does."""

    def create(self: Any, *arguments: Any, **options: Any) -> None:
        arguments = tuple(map(_lasting, arguments))
        options = {name: _lasting(option) for name, option in options.items()}
        real.__init__(self, *arguments, **options)  # type: ignore[misc]  # its signature is not known here
        converted = {name: option if name in _OF_FUNCTIONS else stand_in_of(option) for name, option in options.items()}
        stand_in = make(*map(stand_in_of, arguments), **converted)
        setattr(self, _ATTRIBUTE, stand_in)

    def answer(name: str) -> Callable[..., Any]:
        return lambda self, *arguments: getattr(getattr(self, _ATTRIBUTE), name)(*map(stand_in_of, arguments))

    methods = {name: answer(name) for name in dir(make) if not name.startswith("__") and hasattr(real, name)}
    return _Recording(real.__name__, (real,), {**methods, "__init__": create, _ATTRIBUTE: None})


def _lasting(value: Any) -> Any:
    """Return a list in place of an iterator, which can be read once only."""
    return list(value) if isinstance(value, Iterator | ItemsView) else value
