"""Run-time library of the rover: converts protobuf datagrams to ROS 2 messages, and ROS 2 messages to datagrams."""

if __name__ != "roverlink.runtime":
    raise ImportError("'runtime' is a folder of this repository, not a package; import roverlink.runtime")


import importlib
from typing import TYPE_CHECKING, Any

from roverlink.runtime.core.errors import (
    ConversionError,
    DatagramError,
    MiddlewareError,
    Reason,
    RegistryError,
    RoverlinkError,
    SetupError,
)

if TYPE_CHECKING:
    from roverlink.runtime.bridge.bridge import NODE, Bridge
    from roverlink.runtime.core.handler import Handler, Qos, Route
    from roverlink.runtime.core.registry import Peer, Registry, load_registry
    from roverlink.runtime.core.translator import Translator

__all__ = [
    "NODE",
    "Bridge",
    "ConversionError",
    "DatagramError",
    "Handler",
    "MiddlewareError",
    "Peer",
    "Qos",
    "Reason",
    "Registry",
    "RegistryError",
    "Route",
    "RoverlinkError",
    "SetupError",
    "Translator",
    "load_registry",
]


_MODULES = {
    **dict.fromkeys(("NODE", "Bridge"), "bridge.bridge"),
    **dict.fromkeys(("Handler", "Qos", "Route"), "core.handler"),
    **dict.fromkeys(("Peer", "Registry", "load_registry"), "core.registry"),
    "Translator": "core.translator",
}


def __getattr__(name: str) -> Any:
    """Import a name when it is first used: most commands need only the errors, and the rest is slow to import."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_MODULES[name]}"), name)
